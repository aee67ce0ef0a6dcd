"""Right formulas in rarer spellings and with rarer forces are not called wrong."""

from pathlib import Path

import pytest

from derive.reading.document import Document
from derive.reading.document_formats import read_document
from derive.reading.latex.display_reader import formulas
from derive.verification.documents import judgement
from derive.verification.documents.judgement import judge_document
from derive.verification.documents.letter_meanings import Work
from derive.verification.documents.letters.letter_roles import letters_of
from derive.verification.documents.pages.verdicts_in_place import DocumentVerdicts
from derive.verification.documents.statements import (
    Occurrence,
    Translated,
    has_neighbours,
    translated,
)

PENDULUM = r"""
$$x = l\sin\theta(t), \quad y = -l\cos\theta(t)$$
$$\dot x = l\dot\theta(t)\cos\theta(t)$$
"""
SPRING = r"""
$$L = \frac m2(\dot r^2 + r^2\dot\theta^2) + m g r\cos\theta - \frac k2 (r - a)^2$$
"""
SPHERE = r"""
$$L = \frac m2 l^2(\dot\theta^2 + \dot\phi^2\sin^2\theta) + m g l\cos\theta$$
$$p = m l^2\dot\phi\sin^2\theta$$
"""


def judged(tmp_path: Path, text: str, suffix: str = ".md") -> DocumentVerdicts:
    file = tmp_path / f"notes{suffix}"
    file.write_text(text, encoding="utf-8")
    return judge_document(read_document(file))


def verdicts(tmp_path: Path, text: str, suffix: str = ".md") -> list[str]:
    return [formula.verdict for formula in judged(tmp_path, text, suffix).formulas]


def last(tmp_path: Path, text: str) -> str:
    return verdicts(tmp_path, text)[-1]


def test_brackets_behind_a_function_of_time_can_hold_a_factor(tmp_path: Path) -> None:
    moving = PENDULUM.replace(r"y = -l", r"y = b\sin(w t) - l")
    T = (
        r"$$T = \frac m2 (l\dot\theta)^2 + \frac m2 (b w\cos(w t))^2"
        r" + m l\dot\theta(b w\sin\theta\cos(w t))$$"
    )
    assert last(tmp_path, moving + T) == "verified"
    assert last(tmp_path, moving + T.replace(r"\sin\theta\cos", r"\sin\theta\sin")) == "wrong"


def test_a_square_before_the_time_is_that_of_a_function(tmp_path: Path) -> None:
    assert last(tmp_path, PENDULUM + r"$$T = \frac{m l^2}2 \dot\theta^2(t)$$") == "verified"
    assert last(tmp_path, PENDULUM + r"$$T = \frac{m l^2}3 \dot\theta^2(t)$$") == "wrong"


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("rates", [
    (r"\frac bm\dot r", r"\frac bm\dot\theta"),  # drag on the mass
    (r"\frac bm\dot r", r"\frac b{m r^2}\dot\theta"),  # on both coordinates
    (r"b\dot r", r"b\dot\theta"),  # by the mass matrix
])  # fmt: skip
def test_friction_of_every_usual_kind_is_recognised(rates: tuple[str, str], tmp_path: Path) -> None:
    accelerations = (
        (
            r"$$\ddot r = r\dot\theta^2 + g\cos\theta - \frac km (r - a) - {}$$"
            r"$$\ddot\theta = -\frac{{2\dot r\dot\theta}}r - \frac gr\sin\theta - {}$$"
        )
        .replace(r"\frac{{2", r"FRAC")
        .replace("}}r", "END")
    )
    text = accelerations.replace("{}", rates[0], 1).replace("{}", rates[1], 1)
    text = text.replace("FRAC", r"\frac{2").replace("END", "}r")
    assert verdicts(tmp_path, SPRING + text) == ["verified"] * 3
    unequal = text.replace(rates[1], r"3" + rates[1])
    assert "wrong" in verdicts(tmp_path, SPRING + unequal)


def test_conserved_momenta_are_constants_of_an_effective_potential(tmp_path: Path) -> None:
    potential = (
        r"$$W = -\frac gl\cos\theta + \frac{p^2}{2 m^2 l^4\sin^2\theta}$$"
        r"$$\ddot\theta = -SCALE\frac{\partial W}{\partial\theta}$$"
    )
    assert last(tmp_path, SPHERE + potential.replace("SCALE", "")) == "verified"
    assert last(tmp_path, SPHERE + potential.replace("SCALE", "2")) == "wrong"


@pytest.mark.long("other tests reach its code")
def test_conserved_momenta_by_mass_are_constants_of_an_effective_potential(tmp_path: Path) -> None:
    orbit = r"""$$L = \frac m2(\dot r^2 + r^2\dot\theta^2) - V, \quad V = -\frac{G M m}{r}$$
$$h = r^2\dot\theta, \quad W = V + \frac{m h^2}{2 r^2}$$ $$m\ddot r = - SCALE\frac{d W}{d r}$$"""
    assert last(tmp_path, orbit.replace("SCALE", "")) == "verified"
    assert last(tmp_path, orbit.replace("SCALE", "2")) == "wrong"
    assert last(tmp_path, orbit.replace("SCALE", "").replace("h = r^2", "h = r")) != "verified"


def test_small_motions_without_a_system_are_no_double_pendulum(tmp_path: Path) -> None:
    text = r"$$m\ddot\epsilon + k\epsilon = 0, \quad (l + m g/k)\ddot\theta + g\theta = 0$$"
    assert "wrong" not in verdicts(tmp_path, text)


def test_steps_in_time_are_no_equations_of_motion(tmp_path: Path) -> None:
    steps = r"$$\dot\theta = \dot\theta + h\ddot\theta$$ $$\theta_{k+1} = \theta_k + h\omega_k$$"
    pendulum = r"$$V = -m g l\cos\theta$$ $$\ddot\theta = -\frac gl\sin\theta$$"
    assert verdicts(tmp_path, pendulum + steps) == ["verified", "verified", "context", "context"]


@pytest.mark.long("more cases of the same kind", keep=5)
@pytest.mark.parametrize("numbers", ["", ", (1.2)", ". (7)"])
@pytest.mark.parametrize("parts", [
    r"$$T = \frac m2 l^2\dot\theta^2, V = -m g l\cos\theta = {}$$",
    r"$$T = \frac m2 l^2\dot\theta^2, V = -m g l\cos\theta =$$ $$= {}$$",
])  # fmt: skip
def test_displays_with_numbers_and_continued_displays_are_judged(
    numbers: str, parts: str, tmp_path: Path
) -> None:
    head, tail = parts.split("{}")
    text = head + r"-m g l + 2 m g l\sin^2\frac\theta 2" + numbers + tail
    assert verdicts(tmp_path, text) == ["verified", "verified"]
    document = judged(tmp_path, text.replace("2 m g l", "m g l"))
    assert [one.verdict for one in document.formulas] == ["verified", "wrong"]


def test_one_open_bracket_spoils_one_row_of_an_environment(tmp_path: Path) -> None:
    rows = r"\begin{eqnarray} K.E. &=& \frac m2 l^2\dot\theta^2 \\ P.E. &=& -m g l\cos\theta \\ "
    text = rows + r"L &=& (K.E. - P.E. \end{eqnarray}"
    assert verdicts(tmp_path, text, ".tex") == ["verified", "verified", "unreadable"]


@pytest.mark.long("other tests reach its code")
def test_uniform_rods_are_recognised_by_their_numbers(tmp_path: Path) -> None:
    text = (
        r"$$\frac 43 m l^2\ddot\theta = m g l\sin\theta - m l\ddot x\cos\theta$$"
        r"$$(M + m)\ddot x = F + m l\dot\theta^2\sin\theta - m l\ddot\theta\cos\theta$$"
    )
    assert verdicts(tmp_path, text) == ["verified", "verified"]
    assert "wrong" in verdicts(tmp_path, text.replace("F + m", "F - m"))


def test_statements_about_all_coordinates_name_no_further_one(tmp_path: Path) -> None:
    file = tmp_path / "notes.md"
    rate = r"\frac{d}{dt}\frac{\partial L}{\partial\dot q_i}"
    general = rf"$${rate} = \frac{{\partial L}}{{\partial q_i}}$$"
    file.write_text(rf"{general} $$L = \frac m2 (\dot x_1^2 + \dot y_1^2)$$", encoding="utf-8")
    statements = read_statements(read_document(file))
    letters = letters_of(statements.formulas, statements.derivatives)
    assert {*letters.coordinates} == {"x_1", "y_1"}


@pytest.mark.long("other tests reach its code")
def test_coordinates_and_rates_may_be_given_as_functions_of_time(tmp_path: Path) -> None:
    text = r"""$$T = \frac12 m R^2(\dot\theta^2 + \dot\phi^2\sin^2\theta), \quad
    V = -m g R\cos\theta$$
    $$\dot\phi = \sqrt{g/R}$$ $$\theta = \frac gR t^2 + \frac\pi2$$ $$\theta = \dot\theta t$$
    $$\dot\theta = \sin\theta$$"""
    given = ["context"] * 3
    assert verdicts(tmp_path, text) == ["verified", "verified", *given, "wrong"]


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("index", ["i", "j"])
def test_a_statement_with_an_index_is_one_about_each_coordinate(
    count: int, index: str, tmp_path: Path
) -> None:
    file = tmp_path / "notes.md"
    rates = "".join(rf" + \dot\theta_{k}^2" for k in range(1, count + 1))
    general = rf"$$x_{index} = l_{index} \sin\theta_{index}$$ $$g = 9.81$$"
    file.write_text(rf"{general} $$T = {rates[3:]}$$", encoding="utf-8")
    statements = read_statements(read_document(file)).formulas
    each = [f"x_{k} = l_{k}*sin(theta_{k})" for k in range(1, count + 1)]
    assert [one.text for one in statements[:-1]] == [*each, "g = 9.81"]


def test_general_momenta_beside_named_coordinates_are_judged(tmp_path: Path) -> None:
    text = r"""$$\dot q_i = \frac{\partial H}{\partial p_i}, \quad T = \frac m2 l^2\dot\phi_1^2,
    \quad V = -m g l\cos\phi_1$$"""
    assert "wrong" not in verdicts(tmp_path, text)


def read_statements(document: Document) -> Translated:
    trees = [tree for one in document.displays for tree in formulas(one.latex)]
    places = [Occurrence(n, 1, 1, 0, 0, "", tree) for n, tree in enumerate(trees, 1)]
    return translated(places)


DERIVED_MATRIX = r"""
$$T=\frac12(m_1+m_2)l_1^2\dot\theta_1^2+\frac12m_2l_2^2\dot\theta_2^2
  +m_2l_1l_2\dot\theta_1\dot\theta_2\cos(\theta_1-\theta_2)$$

$$V=-(m_1+m_2)gl_1\cos\theta_1-m_2gl_2\cos\theta_2$$

$$M=\begin{pmatrix}(m_1+m_2)l_1^2 & m_2l_1l_2\cos(\theta_1-\theta_2)\\
  m_2l_1l_2\cos(\theta_1-\theta_2)& m_2l_2^2\end{pmatrix}$$

$$\frac{\partial M}{\partial\theta_1}=\begin{pmatrix}0 & -m_2l_1l_2\sin(\theta_1-\theta_2)\\
  -m_2l_1l_2\sin(\theta_1-\theta_2)& 0\end{pmatrix}$$
"""
#: The natural length l is a parameter of the system, the length a is not.
ELONGATION = r"""
$$T=\frac12 m(\dot x^2+(a+x)^2\dot\theta^2)$$

$$V=\frac12 k (x+a-l)^2-m g (a+x)\cos\theta$$

$$m\ddot x - m(a+x)\dot\theta^2+k(x+a-l)-mg\cos\theta=0$$
"""
TURNING = r"""
$$L=\frac12 m(\dot x^2+\dot y^2)-mgy$$

$$x\sin(\omega t)-y\cos(\omega t)=0$$

$$m\ddot x=\lambda\sin(\omega t),\quad m\ddot y=-mg-\lambda\cos(\omega t)$$
"""


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(
    ("text", "old", "new"),
    [
        (DERIVED_MATRIX, r"0 & -m_2", r"0 & m_2"),
        (ELONGATION, r"k(x+a-l)-mg", r"k(x+a-l)+mg"),
        (TURNING, r"-mg-\lambda", r"-mg+\lambda"),
    ],
    ids=["derivative of M", "length of no parameter", "constraint with time"],
)
def test_rare_statements_are_judged(text: str, old: str, new: str, tmp_path: Path) -> None:
    assert {*verdicts(tmp_path, text)} <= {"verified", "definition"}
    assert "wrong" in verdicts(tmp_path, text.replace(old, new, 1))


def test_no_formula_is_wrong_by_a_partial_search(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = r"""$$V = -m g l\cos\theta$$ $$p = m l^2\dot\theta$$
    $$\ddot\theta = -2\frac gl\sin\theta$$"""
    work = Work()
    monkeypatch.setattr(judgement, "Work", lambda: work)
    full = judged(tmp_path, text)
    assert [one.verdict for one in full.formulas] == ["verified", "verified", "wrong"]
    needed = Work().left - work.left
    monkeypatch.setattr(judgement, "Work", lambda: Work(needed - 1))
    partial = judged(tmp_path, text)
    assert [one.verdict for one in partial.formulas] == ["verified", "verified", "context"]
    assert judgement.PARTIAL in partial.notes
    assert judgement.PARTIAL not in full.notes


def test_a_search_of_too_many_meanings_ends_with_its_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(judgement, "Work", lambda: Work(1000))
    stated = judged(tmp_path, ELONGATION).formulas  # its own statements come first
    assert "verified" in {one.verdict for one in stated}
    monkeypatch.setattr(judgement, "Work", lambda: Work(10))
    formulas = judged(tmp_path, ELONGATION).formulas
    assert {one.verdict for one in formulas} == {"context"}
    assert {one.note for one in formulas} == {
        "its 3 formulas have too many letters to try all meanings: state the system by --system, "
        "and its letters by --names"
    }


PIVOTS = r"""
(a) The pivot moves on a circle:
$$x = a\cos\gamma t + l\sin\phi, \quad y = -a\sin\gamma t + l\cos\phi$$
$$L = \frac12 m l^2\dot\phi^2 + m l a\gamma^2\sin(\phi - \gamma t) + m g l\cos\phi$$
(b) It oscillates sideways: $$x = a\cos\gamma t + l\sin\phi, \quad y = l\cos\phi$$
$$L = \frac12 m l^2\dot\phi^2 + m l a\gamma^2\cos\gamma t\sin\phi + m g l\cos\phi$$
(c) It oscillates vertically: $$x = l\sin\phi, \quad y = a\cos\gamma t + l\cos\phi$$
$$L = \frac12 m l^2\dot\phi^2 + m l a\gamma^2\cos\gamma t\cos\phi + m g l\cos\phi$$
"""  # L. D. Landau, E. M. Lifshitz, Mechanics, § 5, problem 3
LENGTHS = r"""
$$x_1 = l_1\sin\theta_1, \quad y_1 = -l_1\cos\theta_1$$
$$x_2 = x_1 + l_2\sin\theta_2, \quad y_2 = y_1 - l_2\cos\theta_2$$
$$\dot l_1 = \dot l_2 = 0$$
$$T = \frac12(m_1 + m_2) l_1^2\dot\theta_1^2 + \frac12 m_2 l_2^2\dot\theta_2^2
+ m_2 l_1 l_2\dot\theta_1\dot\theta_2\cos(\theta_1 - \theta_2)$$
"""


@pytest.mark.long("other tests reach its code")
def test_cases_have_positions_of_their_own(tmp_path: Path) -> None:
    stated = ["definition", "definition", "equivalent"]
    assert verdicts(tmp_path, PIVOTS) == 3 * stated
    slip = PIVOTS.replace(r"\cos\gamma t\cos\phi", r"\sin\gamma t\cos\phi")
    assert verdicts(tmp_path, slip) == [*(2 * stated), "definition", "definition", "wrong"]


@pytest.mark.long("other tests reach its code")
def test_lengths_that_rest_are_no_coordinates(tmp_path: Path) -> None:
    assert last(tmp_path, LENGTHS) == "verified"
    assert last(tmp_path, LENGTHS.replace(r"+ m_2 l_1", r"- m_2 l_1")) == "wrong"


def test_a_letter_in_braces_is_a_function_of_time(tmp_path: Path) -> None:
    text = r"""$$L = \frac12 m {\dot x}\left( t \right)^2 - \frac12 k x\left( t \right)^2$$
    $$m {\ddot x}\left( t \right) + k x\left( t \right) = 0$$"""
    assert verdicts(tmp_path, text) == ["verified", "verified"]
    # nothing decides which of both is wrong
    assert verdicts(tmp_path, text.replace("k x", "2 k x", 1)) == ["context", "context"]


@pytest.mark.parametrize(("factor", "verdict"), [("", "verified"), (r"\frac12", "wrong")])
def test_twice_the_kinetic_energy_is_stated(tmp_path: Path, factor: str, verdict: str) -> None:
    text = rf"""$$2T = {factor} m l^2\dot\theta^2$$ $$V = -m g l\cos\theta$$
    $$\ddot\theta = -\frac gl\sin\theta$$"""
    assert verdicts(tmp_path, text) == [verdict, "verified", "verified"]


def test_a_coordinate_can_have_a_reserved_name(tmp_path: Path) -> None:
    text = r"""$$L = \frac12 m l^2\dot\lambda^2 + m g l\cos\lambda$$
$$m l^2\ddot\lambda = -m g l\sin\lambda$$ $$p = m l^2\dot\lambda$$"""
    (tmp_path / "a.md").write_text(text, encoding="utf-8")
    document = judge_document(read_document(tmp_path / "a.md"))
    assert [one.verdict for one in document.formulas] == ["verified"] * 3


@pytest.mark.parametrize(("formula", "expected"), [
    (r"V = \frac k2\sum_{j=0}^{N}(u_{j+1} - u_j)^2", True),
    (r"V = \frac k2\sum_{j}(u_j - u_{j-1})^2", True),
    (r"V = \frac k2\sum_{j=1}^{2}(u_{j+1} - u_j)^2", False),
    (r"V = \frac k2\sum_{j=1}^{N} u_j^2 + u_{N+1}", False),
])  # fmt: skip
def test_sums_over_neighbours_are_recognised(formula: str, expected: bool, tmp_path: Path) -> None:
    file = tmp_path / "chain.md"
    file.write_text(f"$${formula}$$ $$m\\ddot u_1 = -k u_2$$", encoding="utf-8")
    occurrences, _ = judgement._read(read_document(file))
    assert has_neighbours(translated(occurrences).formulas[0]) == expected
