"""Documents with several systems below their headings, and cases of one system."""

from dataclasses import replace
from pathlib import Path

import pytest

from derive.reading.document import divided
from derive.reading.document_formats import read_document
from derive.verification.documents import judgement
from derive.verification.documents.judgement import OF_OTHER_SUBJECT, judge_document
from derive.verification.documents.pages.verdicts_in_place import FormulaVerdict
from derive.verification.documents.rules.side_verdict import HOLDING
from derive.verification.documents.statements import translated


def judged(folder: Path, text: str) -> list[FormulaVerdict]:
    (folder / "a.md").write_text(text, encoding="utf-8")
    return [*judge_document(read_document(folder / "a.md")).formulas]


TWO = r"""
## Point mass
$$ -m g L \sin\theta = m L^2 \ddot\theta $$
$$ -\frac{g}{L}\theta = \ddot\theta $$
## Its motion
The period is
$$ T = 2\pi\sqrt{\frac{L}{g}} $$
## Rigid body
$$ -m g D \sin\theta = I \ddot\theta $$
$$ -\frac{m g D}{I}\theta = \ddot\theta $$
"""


@pytest.mark.long("other tests reach its code")
def test_each_heading_can_have_its_system(tmp_path: Path) -> None:
    verdicts = [one.verdict for one in judged(tmp_path, TWO)]
    assert verdicts == ["definition", "verified", "verified", "definition", "verified"]


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize(("old", "new", "number"), [
    (r"-\frac{g}{L}\theta", r"-\frac{2 g}{L}\theta", 1),
    (r"2\pi\sqrt", r"\pi\sqrt", 2),
    (r"-\frac{m g D}{I}\theta", r"-\frac{m g D}{2 I}\theta", 4),
])  # fmt: skip
def test_a_slip_below_a_heading_is_not_verified(
    old: str, new: str, number: int, tmp_path: Path
) -> None:
    assert judged(tmp_path, TWO.replace(old, new))[number].verdict not in ("verified", "definition")


@pytest.mark.parametrize("text", [
    "# A\n@a\n## B\n@b\n# C\n@c\n",
    "\\section{A}\n@a\n\\subsection{B}\n@b\n\\section{C}\n@c\n",
    "<h1>A</h1>\n@a\n<h2>B</h2>\n@b\n<h1>C</h1>\n@c\n",
    "# A\n@a\n**Example 1.** @b\n# C\n@c\n",
    "# A\n@a\n<strong>Example 1.</strong> @b\n# C\n@c\n",
    "A\n===\n@a\n\nProblem 1\n@b\n\nC\n===\n@c\n",
    "\\paragraph{A}\n@a\n\\subparagraph{B}\n@b\n\\paragraph{C}\n@c\n",
    "\\begin{question}\n@a\n1. @b\n\\end{question}\n\\begin{question}\n@c\n\\end{question}\n",
    "\\section{A}\n@a\n\\paragraph{B}\n@b\n\\section{C}\n@c\n",
    "\\section{A}\n@a\n\\problem\n@b\n\\section{C}\n@c\n",
    ":::{admonition} A\n@a\n1. @b\n:::\n:::{admonition} C\n@c\n:::\n",
    "# A\n@a\n```{prf:example} B\n@b\n```\n# C\n@c\n",
])  # fmt: skip
def test_the_highest_headings_divide_a_text(text: str) -> None:
    def place(name: str) -> int:
        return text.index(f"@{name}")

    assert divided(text, "abc", place) == [("a", "b"), ("c",)]
    assert divided(text, "ab", place) == [("a",), ("b",)]
    assert divided(text, "c", place) == [("c",)]


CASE = r"""$$ T = \frac12 m l^2 \dot\theta^2 + \frac12 I \dot\theta^2 $$
$$ V = - m g l \cos\theta $$
$$ (m l^2 + I) \ddot\theta = - m g l \sin\theta $$
For a point mass, $I = 0$:
$$ \ddot\theta = - \frac{g}{l} \sin\theta $$"""


@pytest.mark.long("other tests reach its code")
def test_a_formula_can_hold_where_a_parameter_vanishes(tmp_path: Path) -> None:
    assert judged(tmp_path, CASE)[-1].note == "it holds for I = 0"
    again = judged(tmp_path, f"{CASE}\nAgain, for $I = 0$ there is nothing else.")
    assert again[-2].verdict == "equivalent"


@pytest.mark.parametrize(("old", "new"), [
    (r"{g}{l}", r"{2 g}{l}"), ("For a point mass, $I = 0$:", ""), (r"{l} \sin", r"{l} \cos"),
])  # fmt: skip
def test_a_vanishing_parameter_does_not_excuse_a_slip(old: str, new: str, tmp_path: Path) -> None:
    assert judged(tmp_path, CASE.replace(old, new))[-1].verdict == "wrong"


SPRINGS = r"""Springs are stretched by $\Delta x_1$ and $\Delta x_2$:
$$ T = \frac12 m_1 \Delta\dot x_1^2 + \frac12 m_2 (\Delta\dot x_1 + \Delta\dot x_2)^2 $$
$$ U = \frac12 k_1 \Delta x_1^2 + \frac12 k_2 \Delta x_2^2 $$
$$ m_1 \Delta\ddot x_1 = -k_1 \Delta x_1 + k_2 \Delta x_2 $$
$$ m_2 \Delta\ddot x_2 = -k_2 \Delta x_2 - m_2 \Delta\ddot x_1 $$"""


def test_a_difference_is_a_letter(tmp_path: Path) -> None:
    formulas = judged(tmp_path, SPRINGS)
    assert [one.verdict for one in formulas][-2:] == ["verified", "verified"]
    slip = judged(tmp_path, SPRINGS.replace(r"+ k_2 \Delta", r"- k_2 \Delta"))
    assert slip[-2].verdict == "wrong"
    assert slip[-2].wrong_term == r"- k_2 \Delta x_2"


@pytest.mark.long("other tests reach its code")
def test_a_difference_that_stands_alone_is_no_sign(tmp_path: Path) -> None:
    text = r"""$$\Delta = \theta_1 - \theta_2$$
$$T = \frac12 m l^2 (2\dot\theta_1^2 + \dot\theta_2^2 + 2\dot\theta_1\dot\theta_2\cos\Delta)$$
$$V = -m g l (2\cos\theta_1 + \cos\theta_2)$$
$$l\ddot\theta_2 + l\ddot\theta_1\cos\Delta - l\sin\Delta\dot\theta_1^2 + g\sin\theta_2 = 0$$"""
    assert judged(tmp_path, text)[-1].verdict == "verified"


PRIMES = r"""$$ v^2 = \dot r^2 + r^2\dot\alpha^2 $$ $$ T = \frac12 m v^2 $$
$$ V = \frac12 k (r - l)^2 - m g r\cos\alpha $$
$$ r'' = r\alpha'^2 + g\cos\alpha - \frac{k}{m}(r - l) $$
$$ \alpha'' = -\frac{1}{r}(2 r'\alpha' + g\sin\alpha) $$"""


@pytest.mark.long("other tests reach its code")
def test_primes_are_rates_beside_dots_if_there_are_second_ones(tmp_path: Path) -> None:
    verdicts = [one.verdict for one in judged(tmp_path, PRIMES)]
    assert verdicts[0] == "definition"
    assert verdicts[-2:] == ["verified", "verified"]
    assert judged(tmp_path, PRIMES.replace("(2 r'", "(r'"))[-1].verdict == "wrong"


INCLINES = r"""$$ T_1 - m_A g \sin\alpha = m_A a $$ $$ m_B g \sin\beta - T_2 = m_B a $$
$$ (T_2 - T_1) R = I \frac{a}{R} $$
$$ a = g \frac{m_B \sin\beta - m_A \sin\alpha}{m_A + m_B + I/R^2} $$"""


@pytest.mark.long("other tests reach its code")
def test_a_radius_beside_tensions_is_no_reaction(tmp_path: Path) -> None:
    assert judged(tmp_path, INCLINES)[-1].verdict == "verified"
    assert judged(tmp_path, INCLINES.replace("+ I/R^2", "+ 2 I/R^2"))[-1].verdict != "verified"


NUMBERS = r"""$m_A = 4.0\,\text{kg}$, $m_B = 6.0\,\text{kg}$, $\alpha = 30^\circ$.
$$ T - m_A g \sin\alpha = m_A a $$ $$ m_B g - T = m_B a $$
$$ a = g\frac{m_B - m_A\sin\alpha}{m_A + m_B} $$
$$ T = m_B (g - a) = 6 (9.81 - 5.61) \approx 25.2\,\text{N} $$"""


def test_numbers_with_units_define_no_letters(tmp_path: Path) -> None:
    assert [one.verdict for one in judged(tmp_path, NUMBERS)][-2:] == ["verified", "verified"]
    slip = judged(tmp_path, NUMBERS.replace(r"m_B - m_A\sin", r"m_B + m_A\sin"))
    assert slip[-2].verdict in ("wrong", "context")


EXAMPLES = r"""
## A disc on a hardening spring
$$T = \frac12 J\dot\phi^2$$ $$V = \frac14 c\phi^4$$
$$\frac{\partial L}{\partial\phi} = -c\phi^3$$
$$\frac{\partial L}{\partial\dot\phi} = J\dot\phi$$
$$\frac{d}{dt}(J\dot\phi) + c\phi^3 = 0$$
$$\ddot\phi = -\frac{c}{J}\phi^3$$
## A ball in a bowl
$$T = \frac12 m\dot y^2$$ $$V = \frac16 k y^6$$
$$\frac{\partial L}{\partial y} = -k y^5$$
$$\frac{\partial L}{\partial\dot y} = m\dot y$$
$$\frac{d}{dt}(m\dot y) + k y^5 = 0$$
$$\ddot y = -\frac{k}{m}y^5$$
"""


@pytest.mark.long("other tests reach its code")
def test_energies_of_another_coordinate_begin_an_example(tmp_path: Path) -> None:
    assert {one.verdict for one in judged(tmp_path, EXAMPLES)} == {"verified", "definition"}
    found = judged(tmp_path, EXAMPLES.replace(r"= -k y^5", r"= -5 k y^5"))
    assert [one.correction for one in found if one.verdict == "wrong"] == [
        r"\frac{\partial L}{\partial y} = -k y^5"
    ]


EQUAL = r"""
$$T = \frac12 m_1\dot y_1^2 + \frac12 m_2\dot y_2^2$$
$$V = \frac14 c_1 y_1^4 + \frac14 c_2 (y_2 - y_1)^4$$
$$L = T - V = \frac12 m_1\dot y_1^2 + \frac12 m_2\dot y_2^2
 - \frac14 c_1 y_1^4 - \frac14 c_2 (y_2 - y_1)^4$$
$$m_2\ddot y_2 = -c_2 (y_2 - y_1)^3$$
With $m_1 = m_2 = m$ and $c_1 = c_2 = c$ this is
$$m\ddot y_2 = -c (y_2 - y_1)^3$$
"""


@pytest.mark.long("other tests reach its code")
def test_a_slip_of_an_index_is_found_before_a_case_of_equal_parameters(tmp_path: Path) -> None:
    assert {one.verdict for one in judged(tmp_path, EQUAL)} == {"definition", "verified"}
    found = judged(tmp_path, EQUAL.replace(r"-c_2 (y_2", r"-c_1 (y_2"))
    assert [one.latex for one in found if one.verdict == "wrong"] == [
        r"m_2\ddot y_2 = -c_1 (y_2 - y_1)^3"
    ]


def test_equal_parameters_need_no_mass_in_the_equations(tmp_path: Path) -> None:
    text = r"""$$x_1 = a_1\sin\phi_1$$ $$y_1 = -a_1\cos\phi_1$$
$$x_2 = a_1\sin\phi_1 + a_2\sin\phi_2$$ $$y_2 = -a_1\cos\phi_1 - a_2\cos\phi_2$$
$$V = -(m_1 + m_2) g a_1\cos\phi_1 - m_2 g a_2\cos\phi_2$$
$$(m_1 + m_2) a_1\ddot\phi_1 + m_2 a_2\ddot\phi_2\cos(\phi_1 - \phi_2)
 + m_2 a_2\dot\phi_2^2\sin(\phi_1 - \phi_2) + (m_1 + m_2) g\sin\phi_1 = 0$$
With $m_1 = m_2 = m$ and $a_1 = a_2 = a$ this is
$$2 a\ddot\phi_1 + a\ddot\phi_2\cos(\phi_1 - \phi_2) + a\dot\phi_2^2\sin(\phi_1 - \phi_2)
 + 2 g\sin\phi_1 = 0$$"""
    assert "wrong" not in [one.verdict for one in judged(tmp_path, text)]


@pytest.mark.long("other tests reach its code")
def test_an_example_can_use_a_coordinate_before_as_a_component(tmp_path: Path) -> None:
    text = r"""
### Ball
$$T = \frac12 m\dot y^2$$ $$U = m g y$$ $$L = \frac12 m\dot y^2 - m g y$$ $$\ddot y = -g$$
### Swing
$$x = l\sin\theta$$ $$y = -l\cos\theta$$ $$U = m g y$$ $$T = \frac12 m(\dot x^2 + \dot y^2)$$
$$L = \frac12 m l^2\dot\theta^2 + m g l\cos\theta$$ $$\ddot\theta = -\frac gl\sin\theta$$
"""
    assert not {"wrong", "context"} & {one.verdict for one in judged(tmp_path, text)}
    wrong = judged(tmp_path, text.replace(r"\ddot y = -g", r"\ddot y = -2 g"))[3]
    other = judged(tmp_path, text.replace(r"-\frac gl", r"\frac gl"))[-1]
    assert (wrong.verdict, other.verdict) == ("wrong", "wrong")


SAME_COORDINATE = r"""
{first}
$$ L = \frac{1}{2} m \dot x^2 - \frac{1}{2} k x^2 $$
$$ m \ddot x + k x = 0 $$
{second}
$$ L = \frac{1}{2} m \dot x^2 - \frac{1}{2} k x^2 - \frac{1}{4} b x^4 $$
$$ p = m \dot x $$
$$ H = \frac{p^2}{2 m} + \frac{1}{2} k x^2 + \frac{1}{4} b x^4 $$
$$ m \ddot x + k x + b x^3 = 0 $$
"""
HEADINGS = [
    {"first": "## Harmonic oscillator", "second": "## Anharmonic oscillator"},
    {"first": "A mass on a spring has", "second": "A harder spring adds a term:"},
    {"first": "1. a. The Lagrangian", "second": "2.\na."},
]


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("headings", HEADINGS)
def test_systems_can_have_the_same_coordinate(headings: dict[str, str], tmp_path: Path) -> None:
    text = SAME_COORDINATE
    for name, heading in headings.items():
        text = text.replace("{" + name + "}", heading)
    verdicts = [one.verdict for one in judged(tmp_path, text)]
    assert verdicts == ["verified", "verified", "definition", "verified", "verified", "verified"]
    wrong = judged(tmp_path, text.replace("b x^3", "b x^2"))[5]
    assert (wrong.verdict, wrong.wrong_term) == ("wrong", "b x^2")


@pytest.mark.long("other tests reach its code")
def test_energies_after_equations_can_be_those_of_another_system(tmp_path: Path) -> None:
    verdicts = judged(tmp_path, r"""
## Spring
$$ T = \frac{1}{2} m (\dot x^2 + \dot y^2), \qquad V = \frac{1}{2} k (x^2 + y^2) $$
$$ m \ddot x = -k x, \qquad m \ddot y = -k y $$
## Gravity
$$ L = \frac{1}{2} m (\dot x^2 + \dot y^2) - m g y $$
$$ m \ddot x = 0, \qquad m (\ddot y + g) = 0 $$
""")  # fmt: skip
    assert {one.verdict for one in verdicts} <= {"definition", "verified"}


SAME_ANGLE = r"""
**Example (on a sphere).** A bob has
$$ T = \frac12 m \ell^2 (\dot\theta^2 + \sin^2\theta \dot\phi^2), \qquad V = -m g \ell \cos\theta $$
$$ L = \frac12 m \ell^2 (\dot\theta^2 + \sin^2\theta \dot\phi^2) + m g \ell \cos\theta $$
$$ p_\phi = \frac{\partial L}{\partial \dot\phi} = m \ell^2 \sin^2\theta \dot\phi $$
With $\dot\phi = p_\phi/(m \ell^2 \sin^2\theta)$ the equation of motion
$$ m \ell^2 \ddot\theta = m \ell^2 \sin\theta \cos\theta \dot\phi^2 - m g \ell \sin\theta $$
is
$$ m \ell^2 \ddot\theta = \frac{p_\phi^2 \cos\theta}{m \ell^2 \sin^3\theta} - m g \ell \sin\theta $$
**Example (in a cylinder).** A disc that rolls has
$$ T = \frac12 m (R - r)^2 \dot\theta^2 + \frac12 I \dot\psi^2 = \frac34 m (R - r)^2 \dot\theta^2 $$
$$ \dot\psi = \frac{R - r}{r} \dot\theta, \qquad I = \frac12 m r^2 $$
$$ V = m g (R - r) (1 - \cos\theta) $$
$$ \frac{\partial L}{\partial \dot\theta} = \frac32 m (R - r)^2 \dot\theta $$
$$ \frac32 m (R - r)^2 \ddot\theta = -m g (R - r) \sin\theta $$
$$ \ddot\theta = -\frac{2 g}{3 (R - r)} \sin\theta $$
"""


@pytest.mark.long("other tests reach its code")
def test_a_slip_does_not_leave_an_example_without_its_system(tmp_path: Path) -> None:
    verdicts = [one.verdict for one in judged(tmp_path, SAME_ANGLE)]
    assert {*verdicts} == {"definition", "verified"}
    slip = SAME_ANGLE.replace(r"\sin^2\theta \dot\phi $$", r"\sin\theta \dot\phi $$")
    wrong = judged(tmp_path, slip)
    assert [k for k, one in enumerate(wrong) if one.verdict == "wrong"] == [3]
    assert {one.verdict for one in wrong} - {"wrong"} == {"definition", "verified"}


CANONICAL = r"""The Lagrangian of a free particle is
$$ L = \frac12 m (\dot x^2 + \dot y^2) - U(x, y) $$
$$ p_x = m \dot x, \qquad p_y = m \dot y $$
$$ \dot x = \frac{p_x}{m}, \qquad \dot y = \frac{p_y}{m} $$
In polar coordinates it is
$$ L = \frac12 m (\dot r^2 + r^2 \dot\phi^2) - U(r, \phi) $$
$$ p_r = m \dot r, \qquad p_\phi = m r^2 \dot\phi $$
$$ \dot r = \frac{p_r}{m}, \qquad \dot\phi = \frac{p_\phi}{m r^2} $$
$$ H = \frac{p_r^2}{2 m} + \frac{p_\phi^2}{2 m r^2} + U(r, \phi) $$
"""


@pytest.mark.long("other tests reach its code")
def test_lagrangians_after_canonical_velocities_have_their_own_coordinates(tmp_path: Path) -> None:
    verdicts = [one.verdict for one in judged(tmp_path, CANONICAL)]
    assert {*verdicts} == {"definition", "verified"}
    wrong = judged(tmp_path, CANONICAL.replace("+ U(r", "- U(r"))[10]
    assert (wrong.verdict, wrong.wrong_term) == ("wrong", r"- U(r, \phi)")


@pytest.mark.long("other tests reach its code")
def test_of_energies_that_differ_in_two_terms_none_is_wrong(tmp_path: Path) -> None:
    text = CANONICAL.replace("U(x, y)", r"\frac12 k x^2").replace("U(r, \\phi)", r"\frac12 k r^2")
    slips = text.replace(r"r^2 \dot\phi^2) -", r"2 r^2 \dot\phi^2) -")
    wrong = judged(tmp_path, slips)[5]
    assert (wrong.verdict, wrong.wrong_term) == ("wrong", r"2 r^2 \dot\phi^2")
    slips = slips.replace(r"2 m r^2} + \frac12 k", r"2 m r^2} - \frac12 k")
    assert judged(tmp_path, slips)[5].verdict == "context"


TOP = r"""
$$ T = \frac12 I_1 (\dot\theta^2 + \dot\phi^2 \sin^2\theta)
 + \frac12 I_3 (\dot\psi + \dot\phi \cos\theta)^2 $$
$$ V = M g l \cos\theta, \qquad L = T - V $$
$$ p_\phi = I_1 \dot\phi \sin^2\theta + I_3 (\dot\psi + \dot\phi \cos\theta) \cos\theta $$
$$ p_\psi = I_3 (\dot\psi + \dot\phi \cos\theta) $$
The momentum is $p_\psi = I_3 \omega_3$. In steady precession
$$ \dot\theta = 0, \quad \dot\phi = \Omega, \quad \dot\psi = \dot\psi_0 $$
$$ n = \dot\psi_0 + \Omega \cos\theta $$
$$ I_1 \Omega^2 \sin\theta \cos\theta - I_3 n \Omega \sin\theta + M g l \sin\theta = 0 $$
$$ I_1 \Omega^2 \cos\theta - I_3 n \Omega + M g l = 0 $$
For a ring at $\theta = \pi/2$,
$$ I_3 = m R^2, \qquad I_1 = \frac12 m R^2 $$
$$ \Omega = \frac{M g l}{I_3 n} = \frac{g l}{R^2 n} $$
$$ I_1 \Omega^2 \cdot 0 - I_3 n \Omega + M g l = 0 $$
"""


@pytest.mark.long("other tests reach its code")
def test_formulas_of_special_motions_are_no_evidence_against_energies(tmp_path: Path) -> None:
    slip = TOP.replace(r"\dot\phi \sin^2", r"\dot\phi \sin")
    for text, number in ((TOP, -1), (slip, 3)):
        verdicts = judged(tmp_path, text)
        wrong = [k for k, one in enumerate(verdicts) if one.verdict == "wrong"]
        assert wrong == [number] * (number >= 0)
        assert [one.verdict for one in verdicts[:2]] == ["definition"] * 2


@pytest.mark.long("other tests reach its code")
def test_a_lambda_in_a_potential_is_no_multiplier(tmp_path: Path) -> None:
    text = r"""
$$ L = \frac12 m (\dot x^2 + \dot y^2) - \frac12 k (x^2 + y^2) - \lambda x y $$
$$ V = \frac12 k (x^2 + y^2) + \lambda x y $$
$$ m \ddot x + k x + \lambda y = 0, \qquad m \ddot y + k y + \lambda x = 0 $$
"""
    verdicts = [one.verdict for one in judged(tmp_path, text)]
    assert verdicts == ["definition", "verified", "verified", "verified"]
    slip = judged(tmp_path, text.replace(r"k y + \lambda x", r"k y + \lambda y"))[3]
    assert (slip.verdict, slip.wrong_term) == ("wrong", r"\lambda y")


def test_initial_rates_are_no_rates_of_another_coordinate(tmp_path: Path) -> None:
    text = r"""
$$ L = \frac12 I \dot\psi^2 - \frac12 k \psi^2 $$
$$ I \ddot\psi = - k \psi $$
$$ n = \dot\psi_0 + \Omega $$
"""
    (tmp_path / "a.md").write_text(text, encoding="utf-8")
    read, _ = judgement._read(read_document(tmp_path / "a.md"))
    assert "psi_dot_0" in translated(read).formulas[2].words
    (tmp_path / "a.md").write_text(text + r"$$ I \ddot\psi_0 = 0 $$", encoding="utf-8")
    read, _ = judgement._read(read_document(tmp_path / "a.md"))
    assert "psi_0_dot" in translated(read).formulas[2].words


def test_what_is_wrong_for_one_division_of_a_text_and_holds_for_another_is_open(
    tmp_path: Path,
) -> None:
    (tmp_path / "a.md").write_text(CASE, encoding="utf-8")
    right = judge_document(read_document(tmp_path / "a.md"))
    wrong = replace(right, formulas=tuple(
        replace(one, verdict="wrong") if one.verdict in HOLDING else one
        for one in right.formulas
    ))  # fmt: skip
    result = judgement._undisputed(wrong, right)
    own = [one for one, other in zip(result.formulas, right.formulas, strict=True) if one != other]
    assert {(one.verdict, one.note) for one in own} == {("context", OF_OTHER_SUBJECT)}
    assert "wrong" not in {one.verdict for one in result.formulas}
    assert judgement._undisputed(right, wrong) == right


ANY_POTENTIAL = r"""
$$ L = \frac12 m (\dot r^2 + r^2 \dot\phi^2) - V(r) $$
$$ m \ddot r = m r \dot\phi^2 - \frac{dV}{dr} $$
$$ m \ddot r = m r \dot\phi^2 - V'(r) $$
$$ E = \frac12 m (\dot r^2 + r^2 \dot\phi^2) + V(r) $$
"""


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(("old", "new", "number", "correction"), [
    (r"- \frac{dV}{dr}", r"+ \frac{dV}{dr}", 1, r"m \ddot r = m r \dot\phi^2 - \frac{dV}{dr}"),
    (r"- \frac{dV}{dr}", r"- 2 \frac{dV}{dr}", 1, r"m \ddot r = m r \dot\phi^2 - \frac{dV}{dr}"),
    ("- V'(r)", "+ V'(r)", 2, r"m \ddot r = m r \dot\phi^2 - V'"),
    ("+ V(r)", "- V(r)", 3, r"E = \frac12 m (\dot r^2 + r^2 \dot\phi^2) + V"),
])  # fmt: skip
def test_a_potential_of_which_only_the_variable_is_known_is_any_function(
    old: str, new: str, number: int, correction: str, tmp_path: Path
) -> None:
    right = [one.verdict for one in judged(tmp_path, ANY_POTENTIAL)]
    assert right == ["definition", "verified", "verified", "verified"]
    verdicts = judged(tmp_path, ANY_POTENTIAL.replace(old, new))
    assert [k for k, one in enumerate(verdicts) if one.verdict == "wrong"] == [number]
    assert verdicts[number].correction == correction
    assert "arbitrary" not in verdicts[number].state


def test_no_known_potential_stands_for_any_function(tmp_path: Path) -> None:
    # it holds for those without an angle
    text = r"""
$$ L = \frac12 m (\dot r^2 + r^2 \dot\theta^2) - V(r, \theta) $$
$$ F_r = -\frac{\partial V}{\partial r} = m \ddot r - m r \dot\theta^2 $$
$$ F_\theta = -\frac{\partial V}{\partial\theta} = m r \ddot\theta + 2 m \dot r \dot\theta $$
"""
    assert [one.verdict for one in judged(tmp_path, text)] == ["definition", "verified", "context"]


#: A cylinder in another one, with the multiplier of a constraint of velocities.
ROLLING = r"""
# A cylinder
$$ (R - r)\dot\theta - r\dot\phi = 0 $$
$$ K = \frac12 m (R - r)^2 \dot\theta^2 + \frac14 m r^2 \dot\phi^2, \qquad
U = -m g (R - r)\cos\theta $$
$$ L = \frac12 m (R - r)^2 \dot\theta^2 + \frac14 m r^2 \dot\phi^2 + m g (R - r)\cos\theta
- \lambda\left[(R - r)\dot\theta - r\dot\phi\right] $$
$$ m (R - r)^2 \ddot\theta - \lambda (R - r) + m g (R - r)\sin\theta = 0 $$
$$ \frac12 m r^2 \ddot\phi + \lambda r = 0 $$
$$ \frac32 m (R - r)^2 \ddot\theta + m g (R - r)\sin\theta = 0 $$
"""


def test_derivatives_in_other_subjects_make_no_coordinates(tmp_path: Path) -> None:
    before = r"$$ L = \frac12 m \dot r^2 - V(r) $$ $$ m \ddot r = -\frac{dV}{dr} $$"
    verdicts = [one.verdict for one in judged(tmp_path, before + ROLLING)]
    assert verdicts == ["definition", "verified", *["definition"] * 3, *["verified"] * 4]


@pytest.mark.parametrize(("right", "slip", "verdict"), [
    ("", "", "verified"),
    # of a constraint of velocities, a multiplier or its rate with the other sign are forces
    (r"- \lambda\left[", r"+ \lambda\left[", "verified"),
    (r"\lambda\left[(R - r)", r"\lambda\left[(R + r)", "wrong"),
])  # fmt: skip
def test_a_lagrangian_can_have_constraints_of_velocities(
    right: str, slip: str, verdict: str, tmp_path: Path
) -> None:
    assert judged(tmp_path, ROLLING.replace(right, slip))[3].verdict == verdict


def test_turning_points_are_where_the_energy_is_that_of_the_potential(tmp_path: Path) -> None:
    verdicts = judged(tmp_path, ANY_POTENTIAL + "The motion turns where $E - V(r) = 0$.")
    assert (verdicts[-1].verdict, verdicts[-1].note) == ("context", "it states a value")
    slip = judged(tmp_path, ANY_POTENTIAL + r"$$ E - V(r) = m \dot r^2 $$")[-1]
    assert slip.note != "it states a value"


def test_values_of_energies_at_a_place_are_not_wrong(tmp_path: Path) -> None:
    text = r"""
$$ T = \frac12 m l^2 \dot\theta^2, \qquad V = m g l \cos\theta $$
$$ l \ddot\theta = g \sin\theta $$
Upright, at $\theta = 0$, $V = m g l$ is largest. The energy is conserved:
$$ E = \frac12 m l^2 \dot\theta^2 + V(\theta) = \frac12 m v_0^2 + V(0) $$
"""
    verdicts = [one.verdict for one in judged(tmp_path, text)]
    assert verdicts[:3] == ["definition", "definition", "verified"]
    assert {*verdicts[3:]} <= {"context", "definition"}
    assert "wrong" in [
        one.verdict for one in judged(tmp_path, text.replace("= m g l$", "= 2 m g l$"))
    ]


@pytest.mark.long("other tests reach its code")
def test_a_known_system_without_letters_of_the_energies_accuses_nothing(tmp_path: Path) -> None:
    # a mass on a table, and one that hangs through a hole: no swinging Atwood machine
    text = r"""
The rope has the length $L = r - z_2$.
$$ x_1 = r\cos\theta, \qquad y_1 = r\sin\theta, \qquad z_2 = r - L $$
$$ \dot x_1 = \dot r\cos\theta - r\dot\theta\sin\theta $$
$$ \dot y_1 = \dot r\sin\theta + r\dot\theta\cos\theta, \qquad \dot z_2 = \dot r $$
$$ T = \frac12 m (\dot x_1^2 + \dot y_1^2) + \frac12 M \dot z_2^2 $$
$$ V = M g z_2 = M g r - M g L $$
$$ \mathcal{L} = T - V = \frac12 (m + M)\dot r^2 + \frac12 m r^2\dot\theta^2 - M g r + m g L $$
$$ \frac{\partial\mathcal{L}}{\partial r} = - M g + m r\dot\theta^2 $$
$$ \frac{\partial\mathcal{L}}{\partial\theta} = 0 $$
$$ \frac{d}{dt}\frac{\partial\mathcal{L}}{\partial\dot r} = (m + M)\ddot r $$
"""
    assert "wrong" not in [one.verdict for one in judged(tmp_path, text)]


def test_a_repeated_hamiltonian_begins_no_other_system(tmp_path: Path) -> None:
    text = r"""
$$ T = \frac12 m \dot x^2, \qquad V = m g x \sin\alpha $$
$$ H = \frac12 m \dot x^2 + m g x \sin\alpha = \frac{p^2}{2 m} + m g x \sin\alpha $$
$$ H = \frac{p^2}{2 m} + m g x \sin\alpha, \qquad p = m \dot x $$
$$ L = \frac12 m \dot x^2 - m g x \sin\alpha, \qquad m \ddot x = - m g \sin\alpha $$
By Hamilton:
$$ H = \frac{p^2}{2 m} + m g x \sin\alpha $$
$$ - \frac{\partial H}{\partial x} = m g \sin\alpha, \qquad \dot p = m g \sin\alpha $$
$$ m g \sin\alpha = m \ddot x, \qquad \ddot x = g \sin\alpha $$
"""
    verdicts = [one.verdict for one in judged(tmp_path, text)]
    assert verdicts[-4:] == ["wrong"] * 4
    assert "wrong" not in verdicts[:-4]


def test_an_equation_with_one_potential_can_be_another_case(tmp_path: Path) -> None:
    text = ANY_POTENTIAL + r"$$ m \ddot r = m r \dot\phi^2 - m r $$"
    assert judged(tmp_path, text)[-1].verdict == "context"
    part = ANY_POTENTIAL + r"$$ V_g = -m r \cos\phi $$"
    assert judged(tmp_path, part)[-1].verdict != "wrong"


def test_a_wrong_force_without_a_correction_in_letters_of_the_document_has_none(
    tmp_path: Path,
) -> None:
    wrong = judged(tmp_path, r"""
$$ H = \frac{p^2}{2m} + V(x) $$
$$ \dot x = \frac{p}{m}, \qquad \dot p = \frac{dV}{dx} $$
$$ m \ddot x = - \frac{dV}{dx} $$
""")[2]  # fmt: skip
    assert (wrong.verdict, wrong.correction) == ("wrong", "")


@pytest.mark.long("other tests reach its code")
def test_a_simplified_lagrangian_with_a_slip_begins_no_other_system(tmp_path: Path) -> None:
    verdicts = judged(tmp_path, r"""
## Energies
$$ T = \frac{1}{2} m l^2 \dot\theta^2, \qquad V = -m g l \cos\theta $$
$$ L = \frac{1}{2} m l^2 \dot\theta^2 + m g l \cos\theta $$
$$ \ddot\theta = -\frac{g}{l} \sin\theta $$
## In units of the mass
$$ L = m \left(\frac{1}{2} l^2 \dot\theta^2 - g l \cos\theta\right) $$
$$ l \ddot\theta + g \sin\theta = 0 $$
""")  # fmt: skip
    assert [one.verdict for one in verdicts].index("wrong") == 4
    assert [one.verdict for one in verdicts].count("verified") == 5


@pytest.mark.long("other tests reach its code")
def test_a_letter_of_an_energy_is_no_applied_force(tmp_path: Path) -> None:
    verdicts = judged(tmp_path, r"""
$$ L = \frac{1}{2} m \dot x^2 - m g x $$
$$ m \ddot x = - m g $$
$$ L = \frac{1}{2} m \dot x^2 + \frac{1}{2} a x^2 - \frac{1}{4} b x^4 $$
$$ m \ddot x + m g - a x + b x^2 = 0 $$
""")  # fmt: skip
    assert verdicts[-1].verdict == "context"


def test_an_acceleration_of_zero_is_an_equation_of_a_free_motion(tmp_path: Path) -> None:
    verdicts = judged(tmp_path, r"""
$$ L = \frac{1}{2} m (\dot x^2 + \dot y^2) - m g y $$
$$ \ddot x = 0, \qquad \ddot y = - g $$
At rest, it would be
$$ \ddot y = 0 $$
""")  # fmt: skip
    assert [one.verdict for one in verdicts][1:] == ["verified", "verified", "context"]


#: Two cases with positions of their own, below no headings.
CASES = r"""
$$x = l\sin\theta$$ $$y = -l\cos\theta$$ $$T = \frac12 m l^2\dot\theta^2$$
$$V = -m g l\cos\theta$$ $$l\ddot\theta + g\sin\theta = 0$$
If the pivot moves to the side,
$$x = a\cos\gamma t + l\sin\theta$$ $$y = -l\cos\theta$$
$$T = \frac12 m(a^2\gamma^2\sin^2\gamma t - 2 a\gamma l\dot\theta\sin\gamma t\cos\theta
+ l^2\dot\theta^2)$$
$$V = -m g l\cos\theta$$ $$l\ddot\theta + g\sin\theta = a\gamma^2\cos\gamma t\cos\theta$$
"""


@pytest.mark.long("other tests reach its code")
def test_cases_with_positions_of_their_own_are_systems(tmp_path: Path) -> None:
    assert {one.verdict for one in judged(tmp_path, CASES)} == {"definition", "verified"}
    text = CASES.replace(r"= a\gamma^2\cos\gamma t\cos", r"= a\gamma^2\cos\gamma t\sin")
    slip = judged(tmp_path, text)
    assert [one.verdict for one in slip].count("wrong") == 1
    assert slip[-1].verdict == "wrong"


MODES = r"""
## Energies
$$L = \frac12 m(\dot x_1^2 + \dot x_2^2 + \dot x_3^2)
 - \frac12 k\left[x_1^2 + x_2^2 + \left(x_3 - \tfrac12(x_1 + x_2)\right)^2\right]$$
## Equations of motion
$$m\ddot x_1 = -\frac14 k(5 x_1 + x_2 - 2 x_3)$$
$$m\ddot x_2 = -\frac14 k(x_1 + 5 x_2 - 2 x_3)$$
$$m\ddot x_3 = -\frac12 k(-x_1 - x_2 + 2 x_3)$$
## A rotation
$$x_1 = a\theta$$ $$x_2 = -a\theta$$
$$2 m a^2\ddot\theta = -2 k a^2\theta$$
"""


@pytest.mark.long("other tests reach its code")
def test_a_section_is_judged_by_the_energies_before_it(tmp_path: Path) -> None:
    def first(text: str) -> list[str]:
        return [one.verdict for one in judged(tmp_path, text)[:4]]

    assert first(MODES) == ["definition"] + ["verified"] * 3
    slip = MODES.replace("5 x_2 - 2", "5 x_2 + 2")
    assert first(slip) == ["definition", "verified", "wrong", "verified"]
    # energies behind the equations are those of another system
    head, energies, equations, rest = slip.split("## ")
    assert "wrong" not in first("## ".join([head, equations, energies, rest]))
