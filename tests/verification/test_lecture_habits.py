"""Habits of lecture notes: Rayleigh's function, constants of motions, other letters of forces."""

from pathlib import Path

import pytest

from derive.reading.document_formats import read_document
from derive.verification.documents.judgement import judge_document
from derive.verification.documents.pages.verdicts_in_place import FormulaVerdict

CORRECT = {"verified", "equivalent", "definition"}


def judged(folder: Path, text: str) -> list[FormulaVerdict]:
    (folder / "a.md").write_text(text, encoding="utf-8")
    return [*judge_document(read_document(folder / "a.md")).formulas]


def wrong(found: list[FormulaVerdict]) -> list[str]:
    return [one.correction for one in found if one.verdict == "wrong"]


DAMPED = r"""
$$T = \frac12 m_1\dot x_1^2 + \frac12 m_2\dot x_2^2$$
$$V = \frac12 k_1 x_1^2 + \frac12 k_2 (x_2 - x_1)^2$$
Rayleigh's function is
$$\mathcal{R} = \frac12 b_1\dot x_1^2 + \frac12 b_2(\dot x_2 - \dot x_1)^2$$
$$m_1\ddot x_1 + (b_1 + b_2)\dot x_1 - b_2\dot x_2 + (k_1 + k_2) x_1 - k_2 x_2 = 0$$
$$m_2\ddot x_2 - b_2\dot x_1 + b_2\dot x_2 - k_2 x_1 + k_2 x_2 = 0$$
"""


@pytest.mark.long("other tests reach its code")
def test_forces_follow_from_rayleighs_function(tmp_path: Path) -> None:
    assert {one.verdict for one in judged(tmp_path, DAMPED)} == {"verified", "definition"}
    found = judged(tmp_path, DAMPED.replace(r"- b_2\dot x_1 +", r"+ b_2\dot x_1 +"))
    assert wrong(found) == [r"m_2\ddot x_2 - b_2 \dot x_1 + b_2\dot x_2 - k_2 x_1 + k_2 x_2 = 0"]


def test_a_slip_in_rayleighs_function_accuses_no_equation(tmp_path: Path) -> None:
    assert not wrong(judged(tmp_path, DAMPED.replace(r"= \frac12 b_1", r"= b_1")))


@pytest.mark.long("other tests reach its code")
def test_a_column_beside_a_matrix_is_no_further_coordinate(tmp_path: Path) -> None:
    matrix = r"""With $$M = \begin{pmatrix} m_1 & 0 \\ 0 & m_2 \end{pmatrix}$$ this is
$$M\ddot x + B\dot x + K x = 0$$"""
    found = judged(tmp_path, DAMPED + matrix)
    assert [one.verdict for one in found][3:6] == ["verified"] * 3


CRANE = r"""
$$T = \frac12 (M + m)\dot x^2 + \frac12 m a^2\dot\phi^2 + m a\dot x\dot\phi\cos\phi$$
$$V = -m g a\cos\phi$$
$$\frac{d}{dt}\frac{\partial L}{\partial\dot x} - \frac{\partial L}{\partial x} = F_x$$
$$a\ddot\phi + \ddot x\cos\phi + g\sin\phi = 0$$
$$(M + m)\ddot x + m a\ddot\phi\cos\phi - m a\dot\phi^2\sin\phi = (p_1 + p_2)\cos\beta$$
"""


@pytest.mark.long("other tests reach its code")
def test_forces_can_have_other_letters_in_an_equation(tmp_path: Path) -> None:
    assert judged(tmp_path, CRANE)[4].note.endswith("p_1, p_2, beta as applied forces")
    slip = CRANE.replace(r"- m a\dot\phi^2", r"+ m a\dot\phi^2")
    assert judged(tmp_path, slip)[4].verdict == "context"


def test_braces_around_the_lagrangian_make_no_length_of_others(tmp_path: Path) -> None:
    text = r"$$L = \frac12 m\dot x^2 - c x^4$$ $$\frac{\partial{L}}{\partial{x}} = -4 c x^3$$"
    assert [one.verdict for one in judged(tmp_path, text)] == ["definition", "verified"]


BOWL = r"""
$$L = m a^2\left[\frac12(\dot\theta^2 + \sin^2\theta\,\dot\phi^2) + \frac{g}{a}\cos\theta\right]$$
$$\ddot\theta = \sin\theta\cos\theta\,\dot\phi^2 - \frac{g}{a}\sin\theta$$
$$\sin^2\theta\,\dot\phi = const. = j$$
$$\frac12\dot\theta^2 + U(\theta) = \epsilon$$
$$U(\theta) = \frac{j^2}{2\sin^2\theta} - \frac{g}{a}\cos\theta$$
"""


@pytest.mark.long("other tests reach its code")
def test_constants_of_the_motion_are_verified(tmp_path: Path) -> None:
    found = judged(tmp_path, BOWL)
    assert {one.verdict for one in found} == {"verified", "definition"}
    assert [one.note for one in found[2:4]] == [
        "j is a constant of the motion", "epsilon is a constant of the motion"
    ]  # fmt: skip
    spelled = judged(tmp_path, BOWL.replace("const. = j", "j = constant"))
    assert [one.verdict for one in spelled] == [one.verdict for one in found]
    changed = judged(tmp_path, BOWL.replace(r"\frac{j^2}{2", r"\frac{j^2}{4"))
    assert changed[3].verdict == "definition"


def test_constants_of_the_motion_show_which_equation_is_wrong(tmp_path: Path) -> None:
    found = judged(tmp_path, BOWL.replace(r"\,\dot\phi^2 - \frac{g}{a}\sin\theta", r"\,\dot\phi^2"))
    assert [one.verdict for one in found].count("wrong") == 1
    assert found[1].correction.endswith(r"- \frac{g \sin\left(\theta\right)}{a}")


DRIVEN = r"""
The arm turns at $$\theta(t) = \Omega t$$ so that $\theta = 0$ is where it points downwards.
$$x = r\sin\theta$$ $$y = -r\cos\theta$$
$$V = \frac12 k (r - a)^2 - m g r\cos(\Omega t)$$
$$m\ddot r = m r\Omega^2 - k(r - a) + m g\cos(\Omega t)$$
The state is $$x_1 = r$$ $$x_2 = \dot r$$ with
$$\dot x_2 = x_1\Omega^2 - \frac{k}{m}(x_1 - a) + g\cos(\Omega t)$$
$$\frac{dx_2}{dt} = x_1\Omega^2 - \frac{k}{m}(x_1 - a) + g\cos(\Omega t)$$
"""


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("formula", [r"\theta = 0", "x_1 = r"])
def test_a_place_and_a_state_are_not_wrong(formula: str, tmp_path: Path) -> None:
    found = {one.latex: one.verdict for one in judged(tmp_path, DRIVEN)}
    assert found[formula] in ("context", "definition")
    assert "wrong" not in found.values()


@pytest.mark.long("other tests reach its code")
def test_equations_of_a_driven_motion_leave_its_energies_open(tmp_path: Path) -> None:
    text = DRIVEN.replace(r"$$x = r\sin\theta$$ $$y = -r\cos\theta$$", "")
    assert not wrong(judged(tmp_path, text))


@pytest.mark.long("other tests reach its code")
def test_a_length_called_d_is_no_friction_as_well(tmp_path: Path) -> None:
    text = r"""$$E = d M\cos(\alpha x) + \frac12 c x^2
 + \frac12 M\dot x^2 (d^2\alpha^2\sin^2(\alpha x) + 1)$$
$$M\ddot x (d^2\alpha^2\sin^2(\alpha x) + 1)
 = d\alpha g M\sin(\alpha x) - c x - d^2\alpha^3 M\dot x^2\sin(\alpha x)\cos(\alpha x)$$"""
    assert len(judged(tmp_path, text)) == 2


STATES = r"""
$$m\ddot y = -f\sin\beta$$ $$J\ddot\beta = \tau$$
$$\ddot y = -\frac{f}{m}\sin\beta$$
$$s_1 = y$$ $$s_2 = \beta$$ $$s_3 = \dot y$$ $$s_4 = \dot\beta$$
$$\dot s_1 = s_3$$ $$\dot s_2 = s_4$$ $$\dot s_3 = -\frac{f}{m}\sin s_2$$
$$\dot s_4 = \frac{\tau}{J}$$
"""


@pytest.mark.long("other tests reach its code")
def test_the_rate_of_a_state_is_corrected_by_the_equations(tmp_path: Path) -> None:
    assert {one.verdict for one in judged(tmp_path, STATES)} == {"definition", "verified"}
    found = judged(tmp_path, STATES.replace(r"\sin s_2", r"\cos s_2"))
    assert wrong(found) == [r"\dot s_3 = -\frac{f}{m} \sin\left(s_2\right)"]


CART = r"""
$$x_m = s + b\sin\phi$$ $$y_m = -b\cos\phi$$
$$T = \frac12 (M + m) v^2 + m b v\dot\phi\cos\phi + \frac12 m b^2\dot\phi^2$$
$$V = -m g b\cos\phi$$
$$(M + m) a + m b\alpha\cos\phi = F + m b\dot\phi^2\sin\phi \qquad (I)$$
$$a\cos\phi + b\alpha = -g\sin\phi \qquad (II)$$
$$\alpha = -\frac{F\cos\phi + m b\dot\phi^2\sin\phi\cos\phi + (M + m) g\sin\phi}
{b(M + m\sin^2\phi)}$$
"""


def test_rates_can_be_called_v_a_and_alpha_alone(tmp_path: Path) -> None:
    found = judged(tmp_path, CART)
    assert len(found) == 7
    assert {one.verdict for one in found} == {"verified", "definition"}
    slip = judged(tmp_path, CART.replace(r"+ b\alpha", r"- b\alpha"))
    assert wrong(slip) == [r"a\cos\phi + b \alpha = -g\sin\phi"]


GLIDER = r"""
$$\ddot y = -\frac{f}{m}\sin\beta$$ $$\ddot\beta = \frac{\tau}{J}$$
$$w := \dot\beta$$ $$u := \dot y$$ $$\dot y = u$$ $$\dot\beta = w$$
$$\dot u = -\frac{f}{m}\sin\beta$$ $$\dot w = \frac{\tau}{J}$$
"""


def test_a_rate_by_its_letter_can_lack_a_dot(tmp_path: Path) -> None:
    assert {one.verdict for one in judged(tmp_path, GLIDER)} <= CORRECT
    assert wrong(judged(tmp_path, GLIDER.replace(r"$$\dot\beta = w$$", r"$$\beta = w$$"))) == [
        r"\dot\beta = w"
    ]


ROTOR = r"""
$$T = \frac12 A\dot\alpha^2 + \frac12 B(\dot\alpha + \dot\gamma)^2$$ $$V = c\cos\alpha$$
The forces are $$Q_\gamma = N - d\dot\gamma$$ $$Q_\alpha = -e\dot\alpha$$
$$B(\ddot\alpha + \ddot\gamma) = N - d\dot\gamma$$
$$A\ddot\alpha + B(\ddot\alpha + \ddot\gamma) - c\sin\alpha = -e\dot\alpha$$
$$A\ddot\alpha = c\sin\alpha - N + d\dot\gamma - e\dot\alpha$$
"""


@pytest.mark.long("other tests reach its code")
def test_generalized_forces_can_be_defined(tmp_path: Path) -> None:
    found = judged(tmp_path, ROTOR)
    assert [(one.verdict, one.note.startswith("with")) for one in found[4:]] == [
        ("verified", False)
    ] * 3
    slip = judged(tmp_path, ROTOR.replace(r"- N + d\dot\gamma - e", r"- N - d\dot\gamma - e"))
    assert wrong(slip) == [r"A\ddot\alpha = c\sin\alpha - N + d \dot\gamma - e\dot\alpha"]
    assert not wrong(judged(tmp_path, ROTOR.replace(r"Q_\gamma = N - d", r"Q_\gamma = N + d")))


HOOP = r"""
$$T = \frac12 m a^2\dot\theta^2 + \frac12 m a^2 w^2\sin^2\theta$$ $$V = -m g a\cos\theta$$
$$L = \frac12 m a^2\dot\theta^2 + \frac12 m a^2 w^2\sin^2\theta + m g a\cos\theta$$
$$\ddot\theta = \sin\theta\,(w^2\cos\theta - \frac{g}{a})$$
It rests where $\sin\theta = 0$ or $\cos\theta = g/(a w^2)$.
"""


def test_an_equilibrium_is_a_place(tmp_path: Path) -> None:
    found = judged(tmp_path, HOOP)
    assert not wrong(found)
    assert [one.verdict for one in found[-2:]] == ["context"] * 2
