"""The document is its own authority: its statements are judged by each other."""

from pathlib import Path

import pytest

from derive.reading.document_formats import read_document
from derive.reading.programs.program_reader import read_program
from derive.verification.documents.judgement import judge_document
from derive.verification.documents.pages.verdicts_in_place import FormulaVerdict
from derive.verification.documents.program_judgement import judge_program


def judged(folder: Path, text: str) -> tuple[FormulaVerdict, ...]:
    (folder / "a.md").write_text(text, encoding="utf-8")
    return judge_document(read_document(folder / "a.md")).formulas


def wrong(formulas: tuple[FormulaVerdict, ...]) -> list[FormulaVerdict]:
    return [one for one in formulas if one.verdict == "wrong"]


DISC = r"""
# A disc that rolls on the table

A thin disc of mass $m$ and radius $R$ stays upright and rolls without slipping. Its centre is at
$(x, y)$, the plane of the disc makes the angle $\phi$ with the $x$ axis, and $\theta$ is the angle
by which it has rolled. The moments of inertia are $I = \frac12 m R^2$ about the axle and
$J = \frac14 m R^2$ about the vertical.

Rolling means the two constraints

$$ \dot x - R\dot\theta\cos\phi = 0, \qquad \dot y - R\dot\theta\sin\phi = 0 . $$

The kinetic energy is

$$ T = \frac12 m (\dot x^2 + \dot y^2) + \frac12 I \dot\theta^2 + \frac12 J \dot\phi^2 . $$

With the constraints we replace $\dot x$ and $\dot y$, so that the Lagrangian is

$$ L = \frac12 (I + m R^2)\dot\theta^2 + \frac12 J\dot\phi^2 . $$

The equations of motion are

$$ (I + m R^2)\ddot\theta = 0, \qquad J\ddot\phi = 0 . $$
"""

ABBREVIATED = r"""
# Double pendulum

With the abbreviation

$$ \Delta = \theta_1 - \theta_2, \qquad K = l_1 l_2 $$

the energies of a double pendulum are

$$ T = \frac12 (m_1 + m_2) l_1^2\dot\theta_1^2 + \frac12 m_2 l_2^2\dot\theta_2^2
     + K\dot\theta_1\dot\theta_2\cos\Delta $$
$$ V = -(m_1 + m_2) g l_1\cos\theta_1 - m_2 g l_2\cos\theta_2 . $$

The momenta are

$$ p_1 = (m_1 + m_2) l_1^2\dot\theta_1 + K\dot\theta_2\cos\Delta $$
$$ p_2 = m_2 l_2^2\dot\theta_2 + K\dot\theta_1\cos\Delta $$

and the equations of motion

$$ (m_1 + m_2) l_1^2\ddot\theta_1 + K\ddot\theta_2\cos\Delta + K\dot\theta_2^2\sin\Delta
     + (m_1 + m_2) g l_1\sin\theta_1 = 0 $$
$$ m_2 l_2^2\ddot\theta_2 + K\ddot\theta_1\cos\Delta - K\dot\theta_1^2\sin\Delta
     + m_2 g l_2\sin\theta_2 = 0 . $$
"""

CANONICAL = r"""
# Two coupled oscillators

$$ H = \frac{p_1^2}{2 m_1} + \frac{p_2^2}{2 m_2} + \frac12 k_1 x_1^2 + \frac12 k_2 (x_2 - x_1)^2 $$

$$ \dot x_1 = \frac{p_1}{m_1}, \qquad \dot x_2 = \frac{p_1}{m_2} $$
$$ \dot p_1 = -k_1 x_1 + k_2 (x_2 - x_1), \qquad \dot p_2 = -k_2 (x_2 - x_1) $$
"""


def test_constraints_in_a_lagrangian_are_found_and_the_lines_beside_it_are_right(
    tmp_path: Path,
) -> None:
    formulas = judged(tmp_path, DISC)
    (one,) = wrong(formulas)
    assert one.latex.startswith("L = ")
    assert "constraints that are not integrable" in one.note
    assert {o.verdict for o in formulas if o is not one} == {"definition", "verified"}


def test_an_abbreviation_without_a_factor_is_wrong_and_what_uses_it_is_right(
    tmp_path: Path,
) -> None:
    formulas = judged(tmp_path, ABBREVIATED)
    (one,) = wrong(formulas)
    assert (one.latex, one.correction) == ("K = l_1 l_2", "K = l_1 l_2 m_2")
    assert [o.verdict for o in formulas].count("verified") == 6
    right = judged(tmp_path, ABBREVIATED.replace("K = l_1 l_2", "K = m_2 l_1 l_2"))
    assert {o.verdict for o in right} == {"definition", "verified"}


def test_the_momentum_of_a_partner_in_a_canonical_equation_is_wrong(tmp_path: Path) -> None:
    formulas = judged(tmp_path, CANONICAL)
    (one,) = wrong(formulas)
    assert one.latex == r"\dot x_2 = \frac{p_1}{m_2}"
    assert one.correction == r"\dot x_2 = \frac{p_2}{m_2}"
    assert one.note == "given line 4"
    assert {o.verdict for o in formulas if o is not one} == {"definition", "verified"}


ROLLING = r"""
$$T = \frac34 m\dot x^2, \quad V = -m g x\sin\alpha$$
$$L = \frac34 m\dot x^2 + m g x\sin\alpha$$
$$\frac{\partial L}{\partial x} = m g\sin\alpha$$
$$\frac32 m\ddot x = m g\sin\alpha$$
"""


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        (r"T = \frac34", r"T = \frac12", 2),
        (r"V = -m g x", r"V = -m g x^2", 2),
        (r"L = \frac34 m\dot x^2 + m g x", r"L = \frac34 m\dot x^2 + m g", 3),
        (r"\partial x} = m g\sin", r"\partial x} = m g\cos", 4),
        (r"\frac32 m", r"\frac34 m", 5),
    ],
)
def test_energies_and_equations_that_agree_refute_the_one_that_does_not(
    old: str, new: str, line: int, tmp_path: Path
) -> None:
    assert wrong(judged(tmp_path, ROLLING)) == []
    (one,) = wrong(judged(tmp_path, ROLLING.replace(old, new)))
    assert one.line == line
    assert "given line" in one.note


@pytest.mark.long("other tests reach its code")
def test_of_two_statements_that_contradict_each_other_none_is_accused(tmp_path: Path) -> None:
    """A curve that no known system has: either the energy or the equation can be wrong."""
    text = r"$$E = \frac12 m\dot x^2 + \frac15 c x^5$$ $$m\ddot x + 2 c x^4 = 0$$"
    assert {one.verdict for one in judged(tmp_path, text)} <= {"context", "definition"}


def test_a_length_beside_a_lagrangian_in_script_is_no_lagrangian(tmp_path: Path) -> None:
    text = r"""$$\mathcal{L} = \frac12 m L^2\dot\theta^2 + m g L\cos\theta$$
    $$\ddot\theta = -\frac gL\sin\theta$$"""
    assert [one.verdict for one in judged(tmp_path, text)] == ["verified"] * 2


def test_a_single_equation_of_an_angle_from_the_horizontal_is_not_verified() -> None:
    program = "def rates(t, y):\n    theta, omega = y\n    return omega, -g*cos(theta)/l\n"
    formulas = judge_program(read_program(program, "Python")).formulas
    assert [one.verdict for one in formulas] == ["context"]
    right = judge_program(read_program(program.replace("cos", "sin"), "Python")).formulas
    assert [one.verdict for one in right] == ["verified"]


@pytest.mark.long("more cases of the same kind", keep=3)
@pytest.mark.parametrize(
    ("old", "new", "lines"),
    [
        ("", "", []),
        ("T = \\frac12 m K", "T = m K", [2]),
        ("m (1 + 4a^2x^2)\\dot x^2", "m (1 + 4a x^2)\\dot x^2", [3]),
        ("p = m (1 + 4", "p = m (1 + 2", [4]),
    ],
)
def test_a_factor_of_the_kinetic_energy_may_have_a_letter_of_energies(
    old: str, new: str, lines: list[int], tmp_path: Path
) -> None:
    text = r"""A bead of mass $m$ slides on $y = a x^2$. Let $K = 1 + 4a^2x^2$.
    $$T = \frac12 m K \dot x^2$$ $$V = m g a x^2$$
    $$L = \frac12 m (1 + 4a^2x^2)\dot x^2 - m g a x^2$$
    $$p = m (1 + 4 a^2 x^2)\dot x$$
    $$m(1+4a^2x^2)\ddot x + 4 m a^2 x \dot x^2 + 2 m g a x = 0$$"""
    assert [one.line for one in wrong(judged(tmp_path, text.replace(old, new)))] == lines


#: Right statements that a known system could seem to contradict, and how many are judged.
RIGHT = {
    "the letter of a constant of the motion": (
        r"""$$ L = \frac12 m (\dot r^2 + r^2\dot\theta^2) - U(r) $$
        $$ \frac{d}{dt}(m r^2\dot\theta) = 0, \qquad m r^2\dot\theta = J $$
        $$ m\ddot r - m r\dot\theta^2 + \frac{dU}{dr} = 0 $$""",
        3,
    ),
    "an angular momentum called L": (
        r"""$$ T = \frac12\mu(\dot r^2 + r^2\dot\theta^2) $$ and $L = \mu r^2\dot\theta$, so that
        $$ E = T + V(r) = \frac12\mu\dot r^2 + \frac{L^2}{2\mu r^2} + V(r) = \text{constante} $$""",
        1,
    ),
    "equations divided by lengths": (
        r"""$$ (m_1 + m_2) l_1\ddot\theta_1 + m_2 l_2\ddot\theta_2\cos(\theta_1 - \theta_2)
        + m_2 l_2\dot\theta_2^2\sin(\theta_1 - \theta_2) + (m_1 + m_2) g\sin\theta_1 = 0 $$
        $$ l_2\ddot\theta_2 + l_1\ddot\theta_1\cos(\theta_1 - \theta_2)
        - l_1\dot\theta_1^2\sin(\theta_1 - \theta_2) + g\sin\theta_2 = 0 $$
        with the mass matrix $$ \mathbf M = \begin{pmatrix} (m_1 + m_2) l_1 &
        m_2 l_2\cos(\theta_1 - \theta_2) \\ l_1\cos(\theta_1 - \theta_2) & l_2 \end{pmatrix} $$""",
        3,
    ),
    "a spring that is absent": (
        r"""$$ m_1\ddot x_1 = -k_1 x_1 - k_2 (x_1 - x_2) - b\dot x_1 $$
        $$ m_2\ddot x_2 = -k_2 (x_2 - x_1) + u $$""",
        2,
    ),
    "numbers of an example": (
        r"""$$ T = \frac12(m_1 + m_2)\dot x^2, \quad V = -m_2 g x, \quad
        L = \frac12(m_1 + m_2)\dot x^2 + m_2 g x $$
        With 2 kg and 1 kg, $$ \ddot x = \frac{m_2 g}{m_1 + m_2} = \frac{g}{3} = 3.27 $$""",
        2,
    ),
    "a prescribed angle": (
        r"""$$ \rho = R\sin\theta, \quad \phi = \omega t, \quad z = -R\cos\theta $$
        $$ T = \frac12 m R^2(\dot\theta^2 + \omega^2\sin^2\theta), \quad V = -m g R\cos\theta $$
        $$ m R^2\ddot\theta = m R^2\omega^2\sin\theta\cos\theta - m g R\sin\theta $$""",
        1,
    ),
    "the state at the start": (
        r"""$$ m l^2\ddot\theta + c\dot\theta - m g l\sin\theta = 0 $$
        with $$ \theta(0) = \theta_0, \qquad \dot\theta(0) = \dot\theta_0 . $$""",
        1,
    ),
    "other canonical coordinates": (
        r"""$$ H = \frac{p^2}{2m} + m g q, \quad \dot q = \frac pm, \quad \dot p = -m g $$
        $$ \dot Q = \frac{\partial K}{\partial P} = 1, \qquad
        \dot P = -\frac{\partial K}{\partial Q} = 0 $$""",
        0,
    ),
    "a relation at the end of a row and at the start of the next": (
        r"""$$ T = \frac12 m \dot x^2, \quad V = \frac12 k x^2 $$
        $$ \begin{aligned} E &= T + V = \\ &= \frac12 m\dot x^2 + \frac12 k x^2 \end{aligned} $$""",
        1,
    ),
    "a prescribed rate with its number": (
        r"""$$ T = \frac12 m (\dot r^2 + r^2\dot\phi^2), \qquad V = m g r $$
        $$ m\ddot r - m r\dot\phi^2 + m g = 0 $$
        $$ \dot\phi = \omega = 3 $$""",
        1,
    ),
    "a potential energy P beside K": (
        r"""$$ K = \frac12 m L^2\dot q^2, \qquad P = -g L m\cos q $$
        $$ m L^2\ddot q + g L m\sin q = 0 $$""",
        2,
    ),
    "a chain that ends with a new letter": (
        r"""$$ T = \frac12 I_1(\dot\theta^2 + \dot\phi^2\sin^2\theta)
        + \frac12 I_3(\dot\psi + \dot\phi\cos\theta)^2, \quad V = M g l\cos\theta $$
        $$ p_\psi = \frac{\partial\mathcal L}{\partial\dot\psi}
        = I_3(\dot\psi + \dot\phi\cos\theta) = L_3 $$""",
        1,
    ),
}


@pytest.mark.long("more cases of the same kind", keep=6)
@pytest.mark.parametrize("name", RIGHT)
def test_right_statements_of_usual_kinds_are_not_accused(tmp_path: Path, name: str) -> None:
    text, least = RIGHT[name]
    formulas = judged(tmp_path, text)
    assert wrong(formulas) == []
    assert not any(one.verdict == "unreadable" for one in formulas)
    assert sum(one.verdict in ("verified", "equivalent") for one in formulas) >= least


def test_factors_with_a_decimal_point_are_no_example(tmp_path: Path) -> None:
    text = r"$$T = 0.5 m l^2\dot\theta^2, \quad V = -m g l\cos\theta$$"
    text += r"$$m l^2\ddot\theta + m g l\sin\theta = 0$$"
    chain = r"$$E = T + V = 0.5 m l^2\dot\theta^2 - m g l\sin\theta$$"
    (one,) = wrong(judged(tmp_path, text + chain))
    assert one.latex.startswith("E = T + V")


#: The same with a slip, where another statement decides.
SLIPS = {
    "the letter of a constant of the motion": (r"- m r\dot\theta^2", r"- m r^2\dot\theta^2"),
    "equations divided by lengths": (r"+ g\sin\theta_2", r"- g\sin\theta_2"),
    "a spring that is absent": (r"- k_2 (x_1 - x_2)", r"+ k_2 (x_1 - x_2)"),
    "numbers of an example": (r"= \frac{m_2 g}", r"= \frac{m_1 g}"),
    "a potential energy P beside K": (r"g L m\sin q", r"g L m\cos q"),
    "a prescribed angle": (r"= m R^2\omega^2", r"= 2 m R^2\omega^2"),
}


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize("name", SLIPS)
def test_slips_beside_them_are_found_or_left_open(tmp_path: Path, name: str) -> None:
    right, slip = SLIPS[name]
    formulas = judged(tmp_path, RIGHT[name][0].replace(right, slip))
    before = judged(tmp_path, RIGHT[name][0])
    changed = [one for one, own in zip(formulas, before, strict=True) if one.verdict != own.verdict]
    assert changed
    assert all(slip.split()[-1] in one.latex for one in wrong(formulas))


def test_a_lagrangian_is_blamed_where_its_derivative_and_equation_agree(tmp_path: Path) -> None:
    text = r"""$$ L = \frac12 m\dot x^2 - \frac12 k x^2 - a g m\cos x $$
    $$ \frac{\partial L}{\partial x} = a\alpha g m\sin(\alpha x) - k x $$
    $$ m\ddot x - a\alpha g m\sin(\alpha x) + k x = 0 $$"""
    formulas = judged(tmp_path, text)
    assert [one.verdict for one in formulas] == ["wrong", "verified", "definition"]
    assert formulas[0].wrong_term == r"- a g m\cos x"


def test_a_rate_is_not_accused_by_a_position_that_nothing_confirms(tmp_path: Path) -> None:
    text = r"""$$ x = \sin\theta, \qquad y = -R\cos\theta $$ $$ \dot x = R\dot\theta\cos\theta $$
    $$ T = \frac12 m R^2\dot\theta^2 $$
    $$ V = -m g R\cos\theta - \frac12 m\Omega^2 R^2\sin^2\theta $$
    $$ R\ddot\theta + g\sin\theta - \Omega^2 R\sin\theta\cos\theta = 0 $$"""
    formulas = judged(tmp_path, text)
    assert wrong(formulas) == []
    (rate,) = [one for one in formulas if one.latex.startswith(r"\dot x")]
    assert rate.verdict == "context"
    assert "it contradicts line 1" in rate.note


@pytest.mark.parametrize("used", ["", "$$ V = m g y $$"])
def test_a_sign_that_only_a_position_and_its_rate_have_accuses_none(
    used: str, tmp_path: Path
) -> None:
    text = rf"""$$ x = l\sin\theta, \qquad y = l\cos\theta $$ {used}
    $$ \dot x = l\dot\theta\cos\theta $$ $$ \dot y = l\dot\theta\sin\theta $$
    $$ T = \frac12 m l^2\dot\theta^2 $$ $$ l\ddot\theta + g\sin\theta = 0 $$"""
    (rate,) = [one for one in judged(tmp_path, text) if one.latex.startswith(r"\dot y")]
    assert rate.verdict == ("wrong" if used else "context")
    assert used or "it contradicts line 1" in rate.note


@pytest.mark.long("other tests reach its code")
def test_the_sign_of_a_wrong_component_is_that_of_its_rate(tmp_path: Path) -> None:
    text = r"""$$ x = l\sin\theta\cos\phi, \quad y = l\sin\theta\sin\phi $$ $$ z = l\sin\theta $$
    $$ \dot z = -l\dot\theta\sin\theta $$
    $$ T = \frac12 m l^2 (\dot\theta^2 + \dot\phi^2\sin^2\theta) $$
    $$ V = -m g l\cos\theta $$
    $$ l\ddot\theta - l\dot\phi^2\sin\theta\cos\theta + g\sin\theta = 0 $$"""
    formulas = judged(tmp_path, text)
    (one,) = wrong(formulas)
    assert one.latex == r"z = l\sin\theta"
    assert "-" not in one.correction
    (rate,) = [one for one in formulas if one.latex.startswith(r"\dot z")]
    assert rate.verdict == "verified"


def test_of_two_equal_components_none_is_accused(tmp_path: Path) -> None:
    text = r"""$$ x = l\sin\theta\cos\phi, \quad y = l\sin\theta\cos\phi, \quad z = -l\cos\theta $$
    $$ T = \frac12 m l^2 (\dot\theta^2 + \dot\phi^2\sin^2\theta) $$
    $$ V = -m g l\cos\theta $$
    $$ l\ddot\theta - l\dot\phi^2\sin\theta\cos\theta + g\sin\theta = 0 $$"""
    assert wrong(judged(tmp_path, text)) == []


def test_a_potential_is_not_accused_by_an_equation_that_lacks_a_term(tmp_path: Path) -> None:
    text = r"""$$ T = \frac12 m_1\dot x_1^2 + \frac12 m_2\dot x_2^2 $$
    $$ V = \frac12 x_1^2\left(k_1 + k_2\right) - k_2 x_1 x_2 + \frac12 k_2 x_2^2 $$
    $$ m_1\ddot x_1 + (k_1 + k_2) x_1 - k_2 x_2 = 0 $$ $$ m_2\ddot x_2 - k_2 x_1 = 0 $$"""
    formulas = judged(tmp_path, text)
    assert wrong(formulas) == []
    assert "agrees with line 1: nothing else" in formulas[1].note


@pytest.mark.long("other tests reach its code")
def test_two_known_systems_that_refute_different_formulas_decide_nothing(tmp_path: Path) -> None:
    text = r"""$$ x_1 = x_1, \qquad x_2 = x_2 $$
    $$ T = \frac{m_1\dot x_1^2}{2} + \frac{m_2\dot x_2^2}{2} $$
    $$ V = \frac{x_1^2 (k_1 + k_2)}{2} - k_2 x_1 x_2 + \frac{2 k_2 x_2^2}{2} $$
    $$ m_1\ddot x_1 + (k_1 + k_2) x_1 - k_2 x_2 = 0 $$
    $$ m_2\ddot x_2 - k_2 x_1 + k_2 x_2 = 0 $$"""
    assert wrong(judged(tmp_path, text)) == []


@pytest.mark.long("other tests reach its code")
def test_a_mass_in_place_of_a_sum_is_larger_than_the_others(tmp_path: Path) -> None:
    text = r"""With $M = m_1 + m$, $$ T = \frac12 M\dot x^2 + m l\dot\theta\dot x\cos\theta
    + \frac12 m l^2\dot\theta^2 $$ $$ V = -m g l\cos\theta $$
    $$ L = T - V $$ $$ M\ddot x + m l\ddot\theta\cos\theta - m l\dot\theta^2\sin\theta = 0 $$
    $$ l\ddot\theta + \ddot x\cos\theta + g\sin\theta = 0 $$"""
    right = [one.verdict for one in judged(tmp_path, text)[-2:]]
    assert right == ["verified", "verified"]
    (one,) = wrong(judged(tmp_path, text.replace("+ g", "+ 2 g")))
    assert one.wrong_term == r"2 g\sin\theta"


@pytest.mark.long("other tests reach its code")
def test_a_mass_that_moves_along_one_axis_is_part_of_the_system(tmp_path: Path) -> None:
    text = r"""$$ y_1 = -y, \qquad x_2 = l\sin\alpha, \qquad y_2 = l\cos\alpha - y $$
    $$ T = \frac{l^2 m_2\dot\alpha^2}{2} + l m_2\dot\alpha\dot y\sin\alpha
    + \frac{\dot y^2 (m_1 + m_2)}{2} $$
    $$ V = -g l m_2\cos\alpha + g y (m_1 + m_2) + \frac{k y^2}{2} $$
    $$ g l m_2\sin\alpha + l^2\ddot\alpha + l m_2\ddot y\sin\alpha = 0 $$"""
    (one,) = wrong(judged(tmp_path, text))
    assert one.wrong_term == r"l^2\ddot\alpha"


@pytest.mark.long("other tests reach its code")
def test_a_known_system_that_fits_one_of_three_formulas_accuses_none(tmp_path: Path) -> None:
    text = r"""$$ E = \frac12 c r^2 + \frac12 M\dot\phi^2 r^2 $$
    $$ M\ddot r = -c r + M\dot\phi^2 r $$ $$ M\ddot\phi r^2 = -2 M\dot\phi r\dot r $$"""
    assert wrong(judged(tmp_path, text)) == []
