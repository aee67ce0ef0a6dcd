"""Frequencies, periods and solutions that documents state beside their equations."""

from pathlib import Path

import pytest

from derive.reading.document_formats import read_document
from derive.verification.documents.judgement import judge_document
from derive.verification.documents.pages.verdicts_in_place import FormulaVerdict


def judged(folder: Path, text: str) -> list[FormulaVerdict]:
    (folder / "a.md").write_text(text, encoding="utf-8")
    return [*judge_document(read_document(folder / "a.md")).formulas]


PENDULUM = r"""Torques give
$$ m l^2 \ddot\theta = -m g l \sin\theta $$
$$ \ddot\theta = -\frac{g}{l} \sin\theta $$
Small angles oscillate with the frequency and the period
$$ %s $$
"""


@pytest.mark.parametrize(("formula", "verdict"), [
    (r"\omega = \sqrt{\frac{g}{l}}", "verified"),
    (r"\omega = \sqrt{\frac{l}{g}}", "wrong"),
    (r"\omega_0^2 = \frac{g}{l}", "verified"),
    (r"\omega_0^2 = \frac{2 g}{l}", "wrong"),
    (r"T = 2\pi\sqrt{\frac{l}{g}}", "verified"),
    (r"T = \pi\sqrt{\frac{l}{g}}", "wrong"),
    (r"f = \frac{1}{2\pi}\sqrt{\frac{g}{l}}", "verified"),
    (r"f = 2\pi\sqrt{\frac{g}{l}}", "wrong"),
    (r"\omega = \sqrt{\frac{k}{m}}", "context"),  # of another oscillator
])  # fmt: skip
def test_a_frequency_is_that_of_small_motions(formula: str, verdict: str, tmp_path: Path) -> None:
    assert judged(tmp_path, PENDULUM % formula)[-1].verdict == verdict


CHAIN = r"""
$$m\ddot x_1 = -k x_1 - k(x_1 - x_2)$$ $$m\ddot x_2 = -k x_2 - k(x_2 - x_1)$$
$$T = \frac12 m(\dot x_1^2 + \dot x_2^2)$$
"""


@pytest.mark.parametrize(("formula", "verdict"), [
    (r"\omega_\pm^2 = \frac{k}{m}(2 \pm 1)", "verified"),
    (r"\omega^2 = \frac{k}{m}(2 \mp 1)", "verified"),
    (r"\omega = \sqrt{\frac km}\sqrt{2 \pm 1}", "verified"),
    (r"\omega^2 = \frac{k}{m}(1 \pm 2)", "context"),  # of one sign alone
    (r"x_2 = \pm x_1", "context"),
])  # fmt: skip
def test_frequencies_of_both_signs_are_those_of_modes(
    formula: str, verdict: str, tmp_path: Path
) -> None:
    assert judged(tmp_path, f"{CHAIN}$${formula}$$")[-1].verdict == verdict


@pytest.mark.parametrize(("first", "second", "expected"), [
    (r"\omega_2 = \sqrt{\frac{3 k}{m}}", r"\omega_2^2 = 3k/m", ["verified", "verified"]),
    (r"\omega_2 = \sqrt{\frac{2 k}{m}}", r"\omega_2^2 = 3k/m", ["wrong", "verified"]),
    (r"\omega_2 = \sqrt{\frac{2 k}{m}}", r"\omega_1^2 = k/m", ["definition", "verified"]),
])  # fmt: skip
def test_a_frequency_that_is_stated_twice_is_wrong_once(
    first: str, second: str, expected: list[str], tmp_path: Path
) -> None:
    text = rf"""Equal masses between equal springs
$$m\ddot x_1 = -2k x_1 + k x_2$$ $$m\ddot x_2 = k x_1 - 2k x_2$$
have two frequencies, of which the higher one is $${first}$$ and its mode has
$${second}$$"""
    found = judged(tmp_path, text)
    assert [one.verdict for one in found[2:]] == expected
    if "wrong" in expected:
        assert found[2].correction == r"\omega_2 = \sqrt{\frac{3 k}{m}}"


def test_simple_harmonic_motion_has_a_frequency(tmp_path: Path) -> None:
    text = PENDULUM.replace("oscillate with the frequency and the period", "lead to SHM with")
    assert judged(tmp_path, text % r"\omega^2 = \frac{2 g}{l}")[-1].verdict == "wrong"


def test_an_angular_velocity_need_not_be_a_frequency(tmp_path: Path) -> None:
    text = PENDULUM.replace("Small angles oscillate with the frequency and the period",
                            "It starts below with just enough to reach the top:")  # fmt: skip
    assert judged(tmp_path, text % r"\omega = 2\sqrt{\frac{g}{l}}")[-1].verdict == "definition"


@pytest.mark.long("other tests reach its code")
def test_omega_beside_a_frequency_can_be_the_rate_of_an_angle(tmp_path: Path) -> None:
    text = PENDULUM % r"\omega = \sqrt{\frac{g}{l}}" + "\nThe bob has the speed $$ v = %s $$"
    assert judged(tmp_path, text % r"l\dot\theta = l\omega")[-1].verdict == "context"
    assert judged(tmp_path, text % r"l\dot\theta = l^2\omega")[-1].verdict == "wrong"


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize(("old", "new"), [
    ("k + 2c", "k + 2c"), ("k + 2c", "k + c"), ("k + 2c", "2k + 2c"),
])  # fmt: skip
def test_normal_frequencies_are_eigenvalues(old: str, new: str, tmp_path: Path) -> None:
    text = r"""$$ T = \frac12 m (\dot x^2 + \dot y^2) $$
$$ V = \frac12 k x^2 + \frac12 k y^2 + \frac12 c (x - y)^2 $$
The natural frequencies are
$$ \omega_1 = \sqrt{\frac{k}{m}}, \quad \omega_2 = \sqrt{\frac{k + 2c}{m}} $$"""
    verdicts = [one.verdict for one in judged(tmp_path, text.replace(old, new))][-2:]
    assert verdicts == ["verified", "verified" if old == new else "definition"]


OSCILLATOR = r"""$$ m \ddot x = -k x $$
$$ \ddot x = -\omega^2 x, \quad \omega = \sqrt{\frac{k}{m}} $$
$$ %s $$"""


@pytest.mark.parametrize(("solution", "verdict"), [
    (r"x = A \cos(\omega t + \phi)", "verified"),
    (r"x(t) = x_0 \cos(\omega t) + \frac{v_0}{\omega}\sin(\omega t)", "verified"),
    (r"\dot x = -A\omega\sin(\omega t + \phi)", "verified"),
    (r"x(t) = A \cos(2\omega t)", "context"),
])  # fmt: skip
def test_a_solution_solves_the_equation(solution: str, verdict: str, tmp_path: Path) -> None:
    assert judged(tmp_path, OSCILLATOR % solution)[-1].verdict == verdict


def test_a_square_is_not_verified_by_itself(tmp_path: Path) -> None:
    text = OSCILLATOR % r"v^2 = 3 \dot x^2"
    assert judged(tmp_path, text)[-1].verdict == "definition"


@pytest.mark.long("other tests reach its code")
def test_a_solution_does_not_hide_the_equation(tmp_path: Path) -> None:
    text = r"""$$ -m g L \sin\theta = m L^2 \ddot\theta $$ $$ -\frac{g}{L}\theta = \ddot\theta $$
$$ \theta(t) = \theta_{max}\cos(\omega t + \phi) $$"""
    verdicts = [one.verdict for one in judged(tmp_path, text)]
    assert verdicts == ["verified", "verified", "context"]
    slip = text.replace(r"{g}{L}\theta", r"{2g}{L}\theta")
    assert judged(tmp_path, slip)[1].verdict != "verified"


SWINGS = r"""$$m\ddot x = -k x - c (x - y)$$ $$m\ddot y = -k y - c (y - x)$$
With $$x = A\cos(\omega t + \alpha), \quad y = B\cos(\omega t + \beta)$$ these are
$$-m\omega^2 A\cos(\omega t + \alpha) + (k + c) A\cos(\omega t + \alpha)
 = c B\cos(\omega t + \beta)$$
$$(k + c - m\omega^2) B\cos(\omega t + \beta) = c A\cos(\omega t + \alpha)$$"""


@pytest.mark.long("other tests reach its code")
def test_equations_of_amplitudes_follow_from_stated_functions(tmp_path: Path) -> None:
    assert [one.verdict for one in judged(tmp_path, SWINGS)][4:] == ["verified"] * 2
    found = judged(tmp_path, SWINGS.replace("(k + c - m", "(k - c - m"))
    assert found[-1].verdict == "context"


MATRICES = r"""$$M = \begin{bmatrix} m & 0 \\ 0 & m \end{bmatrix}$$
$$K = \begin{bmatrix} k + c & -c \\ -c & k + c \end{bmatrix}$$ $$(K - \omega^2 M)\mathbf{A} = 0$$"""


@pytest.mark.long("other tests reach its code")
def test_columns_of_amplitudes_are_not_compared(tmp_path: Path) -> None:
    assert judged(tmp_path, SWINGS + MATRICES)[-1].verdict == "context"


COUPLED = r"""$$\ddot u_1 + \frac{D}{m} u_1 + \frac{c}{m} (u_1 - u_2) = 0$$
$$\ddot u_2 + \frac{D}{m} u_2 + \frac{c}{m} (u_2 - u_1) = 0$$
With $u_1 - u_2 = 0$ both move alike, $$u_1 = u_2 = A\sin(\omega t + \alpha), \quad
\omega = \sqrt{D/m}$$
and with $u_1 + u_2 = 0$ against one another:
$$\ddot u_1 + (D + 2 c)\frac{u_1}{m} = 0$$
$$u_1 = -u_2 = B\sin(\Omega t + \beta), \quad \Omega = \sqrt{(D + 2 c)/m} > \omega$$
In all, $$u_1 = A\sin(\omega t + \alpha) + B\sin(\Omega t + \beta)$$
$$u_2 = A\sin(\omega t + \alpha) - B\sin(\Omega t + \beta)$$
At the start, $$A\sin\alpha + B\sin\beta = a_0$$ $$A\sin\alpha - B\sin\beta = 0$$"""


@pytest.mark.long("other tests reach its code")
def test_modes_and_solutions_of_two_coordinates(tmp_path: Path) -> None:
    verdicts = {one.latex: one.verdict for one in judged(tmp_path, COUPLED)}
    assert list(verdicts.values()).count("verified") == 7
    assert "wrong" not in verdicts.values()


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(("right", "slip", "verdict"), [
    (r"\ddot u_1 + (D + 2 c)", r"\ddot u_1 + (D + c)", "wrong"),
    (r"+ \frac{c}{m} (u_2 - u_1)", r"+ \frac{c}{m} (u_1 - u_2)", "definition"),
    (r"- B\sin(\Omega t", r"+ B\sin(\Omega t", "context"),
])  # fmt: skip
def test_slips_beside_modes(right: str, slip: str, verdict: str, tmp_path: Path) -> None:
    text = COUPLED.replace(right, slip)
    after = judged(tmp_path, text)
    changed = [one for one in after if slip in one.latex]
    assert changed[-1].verdict == verdict
    assert sum(one.verdict == "wrong" for one in after) == (verdict == "wrong")


@pytest.mark.long("other tests reach its code")
def test_an_equation_of_one_coordinate_can_be_of_another_case(tmp_path: Path) -> None:
    text = rf"{COUPLED} While the other one rests, $$\ddot u_1 + (D + c)\frac{{u_1}}{{m}} = 0$$"
    assert judged(tmp_path, text)[-1].verdict == "context"


MODES = r"""$$m_1\ddot x_1 = -k_1 x_1 + c (x_2 - x_1)$$ $$m_2\ddot x_2 = -k_2 x_2 - c (x_2 - x_1)$$
Try $$x_1 = A_1\cos(\omega t)$$ $$x_2 = A_2\cos(\omega t)$$ as $\ddot x = -\omega^2 x$:
$$(k_1 + c - m_1\omega^2) A_1 - c A_2 = 0$$ $$-c A_1 + (k_2 + c - m_2\omega^2) A_2 = 0$$
$$(k_1 + c - m_1\omega^2)(k_2 + c - m_2\omega^2) - c^2 = 0$$"""


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(("right", "slip", "term"), [
    ("-c A_1 + (k", "c A_1 + (k", "c A_1"),
    (r"c - m_1\omega^2) A_1", r"c - m_1\omega) A_1", r"- m_1\omega"),
    (r"k_2 + c - m_2\omega^2) A_2", r"k_1 + c - m_2\omega^2) A_2", "k_1"),
])  # fmt: skip
def test_an_equation_of_amplitudes_with_a_slip_is_wrong(
    right: str, slip: str, term: str, tmp_path: Path
) -> None:
    assert [one.verdict for one in judged(tmp_path, MODES)].count("verified") == 5
    formulas = judged(tmp_path, MODES.replace(right, slip))
    (found,) = (one for one in formulas if one.verdict == "wrong")
    assert found.wrong_term == term
    assert slip in found.latex
    assert sum(one.verdict == "verified" for one in formulas) == 4


@pytest.mark.long("other tests reach its code")
def test_one_frequency_of_equal_masses(tmp_path: Path) -> None:
    equal = MODES.replace("m_1", "m").replace("m_2", "m").replace("k_1", "k").replace("k_2", "k")
    found = {one.latex: one.verdict for one in judged(tmp_path, equal)}
    assert found[r"(k + c - m\omega^2) A_1 - c A_2 = 0"] == "verified"
    assert found[r"-c A_1 + (k + c - m\omega^2) A_2 = 0"] == "verified"


def test_an_equation_of_amplitudes_in_other_letters_is_open(tmp_path: Path) -> None:
    first, _, rest = MODES.partition(r"$$(k_1 + c - m_1\omega^2) A_1 - c A_2 = 0$$")
    for other in ("(k_1 + c) A_1 - b A_2 = 0", r"\omega A_1 - \omega A_2 = 0"):
        text = f"{first}$${other}$${rest}"
        assert "wrong" not in {one.verdict for one in judged(tmp_path, text)}


def test_a_canonical_equation_with_time_prescribes_no_coordinate(tmp_path: Path) -> None:
    text = r"""$$H = \frac{(p - m b\sin(w t))^2}{2 m} + \frac12 k x^2$$
$$\dot x = \frac{\partial H}{\partial p} = \frac{p - m b\sin(w t)}{m}$$
$$\dot p = -k x$$"""
    assert [one.verdict for one in judged(tmp_path, text)][1:] == ["verified"] * 2


def test_amplitudes_of_a_mode_can_contradict_an_equation(tmp_path: Path) -> None:
    """With its frequency, both equations of motion are the same, and their difference is zero."""
    text = r"""$$T=\frac12 m\dot x_1^2+\frac12 m\dot x_2^2$$
$$V=\frac12 k x_1^2+\frac12 k(x_2-x_1)^2+\frac12 k x_2^2$$
$$m\ddot x_1 = -k x_1 + k(x_2 - x_1)$$
$$x_1(t) = A_1\cos(\omega t + \phi_1)$$ $$x_2(t) = A_2\cos(\omega t + \phi_2)$$
$$\left(\frac{2k}{m}-\omega^2\right)A_1\cos(\omega t + \phi_1)
= \frac km A_2\cos(\omega t + \phi_2)$$
$$\omega = \sqrt{\frac{3k}{m}}$$"""
    assert judged(tmp_path, text)[5].verdict == "verified"
    slip = text.replace(r"\frac{2k}{m}-", r"\frac km-")
    assert judged(tmp_path, slip)[5].verdict == "context"


#: Motions of a satellite beside another one on a circular orbit.
HILL = r"""$$\ddot x - 2 n\dot y - 3 n^2 x = 0$$ $$\ddot y + 2 n\dot x = 0$$ $$\ddot z + n^2 z = 0$$
$$x(t) = -(3 x_0 + 2\dot y_0/n)\cos(n t) + (\dot x_0/n)\sin(n t) + 4 x_0 + 2\dot y_0/n$$
$$y(t) = (6 x_0 + 4\dot y_0/n)\sin(n t) + (2\dot x_0/n)\cos(n t) - (6 n x_0 + 3\dot y_0) t + y_0
- 2\dot x_0/n$$
$$z(t) = z_0\cos(n t) + (\dot z_0/n)\sin(n t)$$
$$\dot x(t) = (3 n x_0 + 2\dot y_0)\sin(n t) + \dot x_0\cos(n t)$$
$$\dot z(t) = -n z_0\sin(n t) + \dot z_0\cos(n t)$$"""


@pytest.mark.parametrize(("right", "slip", "number", "term"), [
    ("", "", None, ""),
    ("-n z_0", "-z_0", 7, r"-z_0\sin(n t)"),
    ("3 n x_0 + 2", "3 n x_0 - 2", 6, r"- 2\dot y_0"),
])  # fmt: skip
def test_a_rate_is_that_of_the_motion_with_initial_values(
    right: str, slip: str, number: int | None, term: str, tmp_path: Path
) -> None:
    verdicts = judged(tmp_path, HILL.replace(right, slip))[3:]
    wrong = {k: one.wrong_term for k, one in enumerate(verdicts, 3) if one.verdict == "wrong"}
    assert wrong == ({number: term} if number else {})
    assert sum(one.verdict == "verified" for one in verdicts) == 5 - len(wrong)


@pytest.mark.parametrize(("rate", "verdicts"), [
    (r"-A\omega\sin(\omega t + \phi)", ["verified", "verified"]),
    (r"-A\sin(\omega t + \phi)", ["context", "context"]),
    (r"-A\sin(\omega t + \phi) = -A\omega\sin(\omega t + \phi)", ["context", "context"]),
])  # fmt: skip
def test_of_a_motion_and_another_rate_none_is_wrong(
    rate: str, verdicts: list[str], tmp_path: Path
) -> None:
    text = rf"""$$m\ddot x = -k x$$ $$\omega = \sqrt{{k/m}}$$
$$x(t) = A\cos(\omega t + \phi)$$ $$\dot x(t) = {rate}$$"""
    assert [one.verdict for one in judged(tmp_path, text)][2:] == verdicts


@pytest.mark.parametrize(("motion", "rate"), [
    # of a start at 0, and with other constants
    (r"x_0\cos\omega t + \frac{v_0}{\omega}\sin\omega t", r"v_0\cos\omega t"),
    (r"A\cos(\omega t + \phi)", r"-x_0\omega\sin\omega t + v_0\cos\omega t"),
])  # fmt: skip
def test_a_rate_with_other_letters_is_no_contradiction(
    motion: str, rate: str, tmp_path: Path
) -> None:
    text = rf"""$$m\ddot x = -k x$$ $$\omega = \sqrt{{k/m}}$$
$$x(t) = {motion}$$ $$\dot x(t) = {rate}$$"""
    assert [one.verdict for one in judged(tmp_path, text)][2:] == ["verified"] * 2


def test_a_rate_of_one_of_several_motions_is_not_in_doubt(tmp_path: Path) -> None:
    text = r"""$$m\ddot x = -k x$$ $$\omega = \sqrt{k/m}$$
$$x(t) = a\sin\omega t$$ $$x(t) = A\cos\omega t$$ $$\dot x(t) = a\omega\cos\omega t$$"""
    assert [one.verdict for one in judged(tmp_path, text)][-1] == "verified"
