"""Orbits by their angle, statements that decide nothing about a system, and mild readings."""

from pathlib import Path

import pytest

from derive.verification.documents.pages.verdicts_in_place import FormulaVerdict
from derive.verification.source_files import judge_file
from solvers.runge_kutta.order_conditions import order


def judged(folder: Path, text: str) -> list[FormulaVerdict]:
    path = folder / "document.md"
    path.write_text(text, encoding="utf-8")
    return list(judge_file(str(path), order)[0].formulas)


def verdicts(folder: Path, text: str) -> dict[str, str]:
    return {one.latex: one.verdict for one in judged(folder, text)}


ORBIT = r"""$$\ddot r - r\dot\phi^2 = -\frac{\mu}{r^2}$$ $$r\ddot\phi + 2\dot r\dot\phi = 0$$
Times $r$, $$r(r\ddot\phi + 2\dot r\dot\phi) = \frac{d}{dt}(r^2\dot\phi) = 0, \quad h = r^2\dot\phi
= \text{const}$$ so the area $A$ grows by $$dA = \frac12 r^2 d\phi, \quad
\frac{dA}{dt} = \frac12 r^2\dot\phi = \frac{h}{2}$$ With $u(\phi) = \frac{1}{r(\phi)}$,
$$\dot r = -h\frac{d}{d\phi}\left(\frac{1}{r}\right) = -h\frac{du}{d\phi}$$
$$\frac{d^2u}{d\phi^2} + u = \frac{\mu}{h^2}$$
At the apsis $$r = r_p = a (1 - e), \quad v_p = \frac{h}{r_p}$$
and $$\xi = \frac12 v^2 - \frac{\mu}{r}, \quad v^2 = \mu(\frac{2}{r} - \frac{1}{a})$$"""


@pytest.mark.long("other tests reach its code")
def test_an_orbit_is_judged_beside_values_at_its_apsides(tmp_path: Path) -> None:
    found = verdicts(tmp_path, ORBIT)
    assert "wrong" not in found.values()
    assert found[r"\frac{d^2u}{d\phi^2} + u = \frac{\mu}{h^2}"] == "verified"
    assert found[r"dA = \frac12 r^2 d\phi"] == "context"
    assert next(one for text, one in found.items() if text.startswith(r"\dot r = -h")) == "verified"


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(("right", "slip"), [
    (r"= -h\frac{du}{d\phi}", r"= h\frac{du}{d\phi}"),
    (r"+ u = \frac{\mu}{h^2}", r"+ u = \frac{2\mu}{h^2}"),
])  # fmt: skip
def test_a_slip_in_an_orbit_is_found(right: str, slip: str, tmp_path: Path) -> None:
    (one,) = (one for one in judged(tmp_path, ORBIT.replace(right, slip)) if one.verdict == "wrong")
    assert slip in one.latex


def test_an_arrow_between_equations_separates_them(tmp_path: Path) -> None:
    text = r"""$$L = \frac12 m\dot x^2 - \frac12 k x^2$$
$$p = m\dot x \to \dot x = \frac{p}{m}$$ $$m\ddot x + k x = 0 \to \ddot x = -\frac{k}{m} x$$
$$x \to 0$$"""
    found = verdicts(tmp_path, text)
    assert found[r"\dot x = \frac{p}{m}"] == found[r"\ddot x = -\frac{k}{m} x"] == "verified"
    assert found[r"x \to 0"] == "context"
    slip = verdicts(tmp_path, text.replace(r"-\frac{k}{m} x", r"\frac{k}{m} x"))
    assert slip[r"\ddot x = \frac{k}{m} x"] == "wrong"


WELL = r"""$$T = \frac12 m a^2\dot\theta^2, \quad V = m g a (1 - \cos\theta)$$
$$E = \frac12 m a^2\dot\theta^2 + m g a (1 - \cos\theta) > 0$$
$$\frac{\partial T}{\partial\dot\theta} = m a^2\dot\theta \neq 0$$
$$m a^2\ddot\theta = -m g a\sin\theta$$
At $\theta = 0$, $$V'' = m g a > 0$$ and at $\theta = \pi$, $$V'' = -m g a < 0$$"""


def test_an_inequality_behind_an_equation_is_left_out(tmp_path: Path) -> None:
    found = verdicts(tmp_path, WELL)
    assert "wrong" not in found.values()
    assert list(found.values()).count("verified") == 3
    assert found["V'' = -m g a < 0"] == "context"  # that at another place
    slip = verdicts(tmp_path, WELL.replace("> 0", "- m g a > 0", 1).replace("m a^2\\dot\\theta \\n",
                                           "m a\\dot\\theta \\n"))  # fmt: skip
    assert [text for text, one in slip.items() if one == "wrong"] == [
        r"\frac{\partial T}{\partial\dot\theta} = m a\dot\theta \neq 0"
    ]


def test_a_second_derivative_at_a_place_is_a_value(tmp_path: Path) -> None:
    found = verdicts(tmp_path, WELL.replace("m g a > 0$$ and", "m g a$$ and").replace("a < 0", "a"))
    assert found["V'' = m g a"] == found["V'' = -m g a"] == "context"
    assert "wrong" not in found.values()


WEIGHTS = r"""With $x_1 = x$ and $x_2 = \ell - x$,
$$T = \frac12 (m_1 + m_2)\dot x^2, \quad V = -m_1 g x - m_2 g (\ell - x)$$
$$L = \frac12 (m_1 + m_2)\dot x^2 + m_1 g x + m_2 g (\ell - x)$$
$$(m_1 + m_2)\ddot x = (m_1 - m_2) g$$ Keep both, with the constraint $g = x_1 + x_2 - \ell = 0$:
$$L = \frac12 m_1\dot x_1^2 + \frac12 m_2\dot x_2^2 + m_1 g x_1 + m_2 g x_2$$
$$m_1\ddot x_1 - m_1 g = \lambda, \quad m_2\ddot x_2 - m_2 g = \lambda$$"""


def test_a_constraint_can_have_the_letter_of_gravity(tmp_path: Path) -> None:
    found = verdicts(tmp_path, WEIGHTS)
    assert found[r"g = x_1 + x_2 - \ell = 0"] == "context"
    assert "wrong" not in found.values()


BODIES = r"""$$x_1 = a\cos q_1, \quad y_1 = a\sin q_1$$
$$x_2 = q_2\cos q_1, \quad y_2 = q_2\sin q_1$$
$$\dot x_1 = -a\dot q_1\sin q_1, \quad \dot y_1 = a\dot q_1\cos q_1$$
$$\mathcal{E}_2 = \frac12 m_2 (\dot x_2^2 + \dot y_2^2) + \frac12 I_2\dot q_1^2
= \frac12 (I_2 + m_2 q_2^2)\dot q_1^2 + \frac12 m_2\dot q_2^2$$
$$\tau = M(q)\ddot q + c(q, \dot q) + g(q), \quad q = \begin{bmatrix} q_1 \\ q_2 \end{bmatrix}$$
$$M(q) = \begin{bmatrix} I_1 + I_2 + m_1 a^2 + m_2 q_2^2 & 0 \\ 0 & m_2 \end{bmatrix}$$
$$c(q, \dot q) = \begin{bmatrix} 2 m_2 q_2\dot q_1\dot q_2 \\ -m_2 q_2\dot q_1^2 \end{bmatrix}$$"""


def test_positions_of_bodies_leave_a_mass_matrix_open(tmp_path: Path) -> None:
    assert "wrong" not in verdicts(tmp_path, BODIES).values()


@pytest.mark.long("other tests reach its code")
def test_the_side_of_a_column_decides_its_sign(tmp_path: Path) -> None:
    slip = BODIES.replace(r"\\ -m_2 q_2\dot q_1^2", r"\\ m_2 q_2\dot q_1^2")
    (one,) = (one for one in judged(tmp_path, slip) if one.verdict == "wrong")
    assert one.wrong_term == r"m_2 q_2\dot q_1^2"


WHEEL = r"""$$T = \frac12 (M + m + \frac{I}{r^2})\dot x^2 + m l\dot x\dot\phi\cos\phi
+ \frac12 (J + m l^2)\dot\phi^2, \quad V = m g l\cos\phi$$
$$L = T - V, \quad \frac{\partial L}{\partial\dot\phi} = m l\dot x\cos\phi + (J + m l^2)\dot\phi$$
$$a = M + m + \frac{I}{r^2}, \quad h = m l, \quad j = J + m l^2$$
$$a\ddot x + h\cos\phi\,\ddot\phi - h\sin\phi\,\dot\phi^2 = 0$$
$$h\cos\phi\,\ddot x + j\ddot\phi - m g l\sin\phi = 0$$
$$f_1 = h\sin\phi\,\dot\phi^2, \quad f_2 = m g l\sin\phi, \quad \Delta = a j - h^2\cos^2\phi$$
$$\ddot x = \frac{j f_1 - h\cos\phi f_2}{\Delta}, \quad
\ddot\phi = \frac{a f_2 - h\cos\phi f_1}{\Delta}$$"""


def test_one_abbreviation_for_another_is_a_slip_of_a_letter(tmp_path: Path) -> None:
    assert "wrong" not in verdicts(tmp_path, WHEEL).values()
    slip = WHEEL.replace("{a f_2 -", "{j f_2 -")
    (one,) = (one for one in judged(tmp_path, slip) if one.verdict == "wrong")
    assert one.wrong_term == "j f_2"
    assert "a" in one.correction
    assert r"f_2 \left(" not in one.correction


LEG = r"""$$M(q)\ddot q + C(q, \dot q)\dot q + G(q) = \tau$$ $$L = K - P$$
$$K = \frac12 m_1 v_1^2 + \frac12 I_1\dot q_1^2 + \frac12 m_2 v_2^2
+ \frac12 I_2 (\dot q_1 + \dot q_2)^2$$
$$P = -m_1 g r_1\cos q_1 - m_2 g (l_1\cos q_1 + r_2\cos(q_1 + q_2))$$
$$M_{11} = I_1 + I_2 + m_1 r_1^2 + m_2 (l_1^2 + r_2^2 + 2 l_1 r_2\cos q_2)$$
$$M_{12} = M_{21} = I_2 + m_2 (r_2^2 + l_1 r_2\cos q_2), \quad M_{22} = I_2 + m_2 r_2^2$$
$$C_1 = -m_2 l_1 r_2\sin(q_2)\dot q_2 (2\dot q_1 + \dot q_2)$$
$$C_2 = m_2 l_1 r_2\sin(q_2)\dot q_1^2$$
$$G_1 = m_1 g r_1\sin q_1 + m_2 g (l_1\sin q_1 + r_2\sin(q_1 + q_2))$$
$$G_2 = m_2 g r_2\sin(q_1 + q_2)$$"""


@pytest.mark.long("columns of both kinds are composed alike", keep=1)
@pytest.mark.parametrize(("right", "slip"), [
    (r"(2\dot q_1 + \dot q_2)", r"(\dot q_1 + \dot q_2)"),
    (r"G_2 = m_2 g r_2\sin(q_1 + q_2)", r"G_2 = m_2 g r_2\sin(q_2)"),
])  # fmt: skip
def test_columns_by_their_entries_are_judged(right: str, slip: str, tmp_path: Path) -> None:
    assert "wrong" not in verdicts(tmp_path, LEG).values()
    before, _, after = LEG.rpartition(right)
    (one,) = (one for one in judged(tmp_path, before + slip + after) if one.verdict == "wrong")
    assert slip in one.latex


@pytest.mark.long("other tests reach its code")
def test_primes_can_be_derivatives_by_the_angle(tmp_path: Path) -> None:
    text = r"""$$L = \frac12 m (\dot r^2 + r^2\dot\phi^2) + \frac{k}{r}$$ $$\ell = m r^2\dot\phi$$
$$m\ddot r - \frac{\ell^2}{m r^3} + \frac{k}{r^2} = 0$$ With $u = \frac{1}{r}$,
$$u' = \frac{d}{d\phi}\left(\frac{1}{r}\right) = -\frac{r'}{r^2}$$
$$u'' = \frac{d}{d\phi}\left(-\frac{r'}{r^2}\right)
= -\frac{r''}{r^2} + 2\frac{(r')^2}{r^3}$$"""
    found = verdicts(tmp_path, text)
    assert list(found.values())[-2:] == ["verified"] * 2
    two = verdicts(tmp_path, rf"{text} With $$V'(r) = \frac{{dV}}{{dr}}$$")  # primes of two kinds
    assert "wrong" not in two.values()
    assert "verified" not in list(two.values())[-3:-1]


def test_a_function_of_the_angle_does_not_vanish_with_its_letters(tmp_path: Path) -> None:
    text = r"""$$h = r^2\dot\phi, \quad u(\phi) \equiv 1/r(\phi), \quad u' = \frac{du}{d\phi}$$
$$u'' + u = \frac{k}{h^2} u^2$$ $$u' u'' + u u' = \frac{k}{h^2} u^2 u'$$"""
    found = verdicts(tmp_path, text)
    assert found[r"u(\phi) \equiv 1/r(\phi)"] in ("definition", "context")
    assert found[r"u' u'' + u u' = \frac{k}{h^2} u^2 u'"] == "context"


CONSERVED = r"""$$\ddot r - r\dot\phi^2 = -\frac{\mu}{r^2}, \quad h = r^2\dot\phi = \text{const}$$
With $u(\phi) = 1/r(\phi)$, $$\dot r = -h\frac{du}{d\phi}, \quad
\frac{d^2u}{d\phi^2} + u = \frac{\mu}{h^2}$$"""


def test_a_constant_of_the_motion_states_an_equation(tmp_path: Path) -> None:
    found = verdicts(tmp_path, CONSERVED)
    assert list(found.values())[-2:] == ["verified", "verified"]
    free = CONSERVED.replace(r" = \text{const}", "")  # one equation states no system
    bases = [judged(tmp_path, text)[-1].basis for text in (CONSERVED, free)]
    assert bases == ["document", "known system"]
    slip = CONSERVED.replace(r"+ u = \frac", r"- u = \frac")
    assert list(verdicts(tmp_path, slip).values())[-1] != "verified"


ELLIPSE = r"""
$$L = \frac12\mu(\dot r^2 + r^2\dot\theta^2) + \frac{k}{r}, \quad \ell = \mu r^2\dot\theta$$
$$E = \frac12\mu\dot r^2 + \frac{\ell^2}{2\mu r^2} - \frac kr$$
$$p = \frac{\ell^2}{\mu k},\quad e = \sqrt{1 + \frac{2 E\ell^2}{\mu k^2}}$$
$$r = \frac{p}{1 + e\cos\theta}$$
"""


@pytest.mark.parametrize(("right", "other", "verdict", "note"), [
    ("", "", "verified", "it holds for some initial values"),
    (r"p}{1 + e", r"p}{1 - e", "verified", "it holds for some initial values"),
    (r"p}{1 + e", r"2 p}{1 + e", "context", "it can hold for some initial values"),
    (r"\frac{2 E\ell^2}", r"\frac{E\ell^2}", "context", "it can hold for some initial values"),
    (r"\cos\theta}", r"\cos 2\theta}", "context", "it can hold for some initial values"),
])  # fmt: skip
def test_an_orbit_holds_for_the_motions_that_keep_it(
    right: str, other: str, verdict: str, note: str, tmp_path: Path
) -> None:
    one = judged(tmp_path, ELLIPSE.replace(right, other) if right else ELLIPSE)[-1]
    assert (one.verdict, one.note) == (verdict, note)
