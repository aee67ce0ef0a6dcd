"""Equations of motion that follow from others: of velocities, of turned angles, in matrices."""

from pathlib import Path

import pytest
import sympy as sp
from constrained_systems import GRAVITY, KG, PLANE, ROD, length, m, x, y

from derive import Derivation, PointMass, System
from derive.formulas.syntax import ExpressionError
from derive.reading.document_formats import read_document
from derive.system.symbols import velocity
from derive.verification.documents.judgement import judge_document
from derive.verification.documents.letters.stated_equations import _quotient
from derive.verification.documents.pages.verdicts_in_place import FormulaVerdict
from derive.verification.judging.constrained_motions import motion
from derive.verification.judging.engine import State


def judged(folder: Path, text: str) -> list[FormulaVerdict]:
    (folder / "a.md").write_text(text, encoding="utf-8")
    return [*judge_document(read_document(folder / "a.md")).formulas]


def wrong(folder: Path, text: str) -> list[FormulaVerdict]:
    return [one for one in judged(folder, text) if one.verdict == "wrong"]


#: A vehicle by its side velocity v and its yaw rate r, both without coordinates.
VEHICLE = r"""$$m(\dot v + u r) = F_f + F_r$$ $$I_z\dot r = a F_f - b F_r$$
$$F_f = C_f\alpha_f, \quad F_r = C_r\alpha_r$$
$$\alpha_f = \delta - \frac{v + a r}{u}, \quad \alpha_r = -\frac{v - b r}{u}$$
$$\dot v = -\frac{C_f + C_r}{m u} v + \left(\frac{b C_r - a C_f}{m u} - u\right) r
+ \frac{C_f}{m}\delta$$
$$\dot r = \frac{b C_r - a C_f}{I_z u} v - \frac{a^2 C_f + b^2 C_r}{I_z u} r
+ \frac{a C_f}{I_z}\delta$$"""


@pytest.mark.long("other tests reach its code")
def test_equations_of_velocities_state_a_system(tmp_path: Path) -> None:
    found = judged(tmp_path, VEHICLE)
    assert [one.verdict for one in found][-2:] == ["verified"] * 2


@pytest.mark.long("each is decided in the same way", keep=1)
@pytest.mark.parametrize(("right", "slip", "term"), [
    ("a F_f - b F_r", "a F_f + b F_r", "b F_r"),
    (r"a^2 C_f + b^2 C_r", "a^2 C_f - b^2 C_r", "- b^2 C_r"),
    (r"\frac{a C_f}{I_z}\delta", r"\frac{C_f}{I_z}\delta", r"\frac{C_f}{I_z}\delta"),
])  # fmt: skip
def test_of_contrary_equations_that_of_one_slip_is_wrong(
    right: str, slip: str, term: str, tmp_path: Path
) -> None:
    (one,) = wrong(tmp_path, VEHICLE.replace(right, slip))
    assert slip in one.latex
    assert one.wrong_term == term


#: Torque-free motion: the kinetic energy gives no equations by Lagrange's formula.
TOP = r"""$$I_1\dot\omega_1 = (I_2 - I_3)\omega_2\omega_3$$
$$I_2\dot\omega_2 = (I_3 - I_1)\omega_3\omega_1$$ $$I_3\dot\omega_3 = (I_1 - I_2)\omega_1\omega_2$$
The energy $$T = \frac12 (I_1\omega_1^2 + I_2\omega_2^2 + I_3\omega_3^2)$$ is constant.
With $$I_1 = I_2, \quad \Omega = \frac{I_3 - I_1}{I_1}\omega_3$$ these are
$$\dot\omega_1 = -\Omega\omega_2, \quad \dot\omega_2 = \Omega\omega_1$$"""


@pytest.mark.long("other tests reach its code")
def test_a_kinetic_energy_of_angular_velocities_contradicts_no_equation(tmp_path: Path) -> None:
    found = judged(tmp_path, TOP)
    assert not [one for one in found if one.verdict == "wrong"]
    assert [one.verdict for one in found][-2:] == ["verified"] * 2


SPRING = r"""$$\dot x = v, \quad m\dot v = -k x - c v, \quad \dot v = -\frac{k x + c v}{m}$$"""


def test_a_velocity_with_its_place_is_none_of_its_own(tmp_path: Path) -> None:
    assert [one.verdict for one in judged(tmp_path, SPRING)][1:] == ["verified"] * 2


#: Forces between a cart and its pendulum; the tension P is not determined at rest.
PARTS = r"""$$M\ddot x + b\dot x + N = F$$
$$N = m\ddot x + m l\ddot\theta\cos\theta - m l\dot\theta^2\sin\theta$$
$$(M + m)\ddot x + b\dot x + m l\ddot\theta\cos\theta - m l\dot\theta^2\sin\theta = F$$
$$P\sin\theta + N\cos\theta - m g\sin\theta = m l\ddot\theta + m\ddot x\cos\theta$$
$$-P l\sin\theta - N l\cos\theta = I\ddot\theta$$
$$(I + m l^2)\ddot\theta + m g l\sin\theta = -m l\ddot x\cos\theta$$
With $\theta = \pi + \phi$, $$(I + m l^2)\ddot\phi - m g l\phi = m l\ddot x$$"""


@pytest.mark.long("other tests reach its code")
def test_small_motions_about_a_turned_angle_are_judged(tmp_path: Path) -> None:
    found = judged(tmp_path, PARTS)
    assert not [one for one in found if one.verdict == "wrong"]
    assert [one.verdict for one in found if one.line > 5][:1] == ["verified"]
    assert found[-1].verdict == "verified"
    (one,) = wrong(tmp_path, PARTS.replace(r"- m g l\phi", r"+ m g l\phi"))
    assert one.wrong_term == r"m g l\phi"


@pytest.mark.parametrize("factor", [sp.S.One, 1 / (m + sp.cos(x) ** 2)])
def test_quotients_have_a_value_where_a_sine_cancels(factor: sp.Expr) -> None:
    sine, cosine = sp.sin(x), sp.cos(x)
    value = factor * (sine * cosine + y * (1 - cosine**2)) + sine**3
    quotient = _quotient(value, divisor=sine * (m + cosine**2))
    numbers = {x: sp.Rational(1, 3), y: sp.Rational(2, 5), m: sp.Rational(7, 4)}
    expected = value / (sine * (m + cosine**2))
    assert float((quotient - expected).subs(numbers)) == pytest.approx(0.0, abs=1e-14)
    if factor == 1:
        assert quotient.subs(x, 0) == 1 / (m + 1)


@pytest.mark.long("other tests reach its code")
def test_a_wrong_sign_is_corrected_in_the_letters_of_its_term(tmp_path: Path) -> None:
    (one,) = wrong(tmp_path, PARTS.replace(r"+ m g l\sin", r"- m g l\sin"))
    assert one.wrong_term == r"- m g l\sin\theta"
    assert r"+ m g l \sin\left(\theta\right)" in one.correction


@pytest.mark.long("other tests reach its code")
def test_a_sum_is_not_wrong_for_a_sign_of_its_parts(tmp_path: Path) -> None:
    before, _, after = PARTS.partition(r"- m l\dot\theta^2")
    assert not wrong(tmp_path, rf"{before}+ m l\dot\theta^2{after}")


BALL = r"""$$m\ddot x = m g\sin\alpha - f, \quad I\dot\omega = f r, \quad \dot x = \omega r$$
$$I = \frac25 m r^2, \quad f = \frac27 m g\sin\alpha, \quad \ddot x = \frac57 g\sin\alpha$$
$$E = \frac12 m\dot x^2 + \frac12 I\omega^2 - m g x\sin\alpha
= \frac{7}{10} m\dot x^2 - m g x\sin\alpha$$"""


def test_a_constant_energy_of_equations_is_not_wrong(tmp_path: Path) -> None:
    found = judged(tmp_path, BALL)
    assert (found[-1].verdict, found[-1].note) == (
        "context", "it is constant, as an energy of the equations is"
    )  # fmt: skip
    other = judged(
        tmp_path, BALL.replace(r"\frac{7}{10} m\dot x^2 - m", r"\frac{7}{10} m\dot x^2 + m")
    )
    assert other[-1].verdict != "verified"


#: M is a mass and the matrix in whose entries it stands.
CART = r"""$$L = \frac12 (M + m)\dot x^2 + m l\dot x\dot\theta\cos\theta + \frac12 m l^2\dot\theta^2
+ m g l\cos\theta$$
$$(M + m)\ddot x + m l\ddot\theta\cos\theta - m l\dot\theta^2\sin\theta = F$$
$$q = \begin{bmatrix} x \\ \theta\end{bmatrix}, \quad
M(q)\ddot q + C(q, \dot q)\dot q = \begin{bmatrix} F \\ -m g l\sin\theta\end{bmatrix}$$
$$M\ddot q = \begin{bmatrix} F + m l\dot\theta^2\sin\theta \\ -m g l\sin\theta\end{bmatrix}$$
$$M = \begin{bmatrix} M + m & m l\cos\theta \\ m l\cos\theta & m l^2\end{bmatrix}, \quad
C = \begin{bmatrix} 0 & -m l\dot\theta\sin\theta \\ 0 & 0\end{bmatrix}$$
Upright, $\theta = \pi + \phi$ and
$$\ddot\phi = \frac{F + (M + m) g\phi}{M l}, \quad \ddot x = \frac{F + m g\phi}{M}$$
$$A = \begin{bmatrix} 0 & 1 & 0 & 0\\ 0 & 0 & \frac{m g}{M} & 0\\ 0 & 0 & 0 & 1\\
0 & 0 & \frac{(M + m) g}{M l} & 0\end{bmatrix}$$"""


@pytest.mark.long("other tests reach its code")
def test_a_mass_and_a_matrix_can_have_one_letter(tmp_path: Path) -> None:
    found = judged(tmp_path, CART)
    assert not [one for one in found if one.verdict == "wrong"]
    assert [one.verdict for one in found].count("verified") == 9


@pytest.mark.long("other tests reach its code")
def test_a_column_can_have_a_turned_angle_first(tmp_path: Path) -> None:
    other = CART.replace(r"x \\ \theta\end", r"\theta \\ x\end").replace(
        r"M + m & m l\cos\theta \\ m l\cos\theta & m l^2",
        r"m l^2 & m l\cos\theta \\ m l\cos\theta & M + m",
    )
    (matrix,) = (one for one in judged(tmp_path, other) if one.latex.startswith(r"M = \begin"))
    assert matrix.verdict == "verified"


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(("right", "slip", "term"), [
    (r"& m l^2\end", r"& m l\end", "m l"),
    (r"\frac{m g}{M} & 0", r"\frac{m g}{m} & 0", r"\frac{m g}{m}"),
    (r"\frac{F + (M + m) g\phi}", r"\frac{F - (M + m) g\phi}", r"- (M + m) g\phi"),
])  # fmt: skip
def test_slips_beside_a_mass_and_a_matrix_of_one_letter(
    right: str, slip: str, term: str, tmp_path: Path
) -> None:
    (one,) = wrong(tmp_path, CART.replace(right, slip))
    assert one.wrong_term == term


#: The position y has the wrong sign of its drive, and the potential energy that of its length.
DRIVEN = r"""$$x = l\sin\theta$$ $$y = -l\cos\theta - a\cos\omega t$$
$$\dot x = l\dot\theta\cos\theta$$ $$\dot y = l\dot\theta\sin\theta - a\omega\sin\omega t$$
$$T = \frac12 m(\dot x^2 + \dot y^2), \quad V = m g y$$
$$T = \frac{m}{2}(l^2\dot\theta^2 + a^2\omega^2\sin^2\omega t
- 2 l\dot\theta a\omega\sin\theta\sin\omega t), \quad V = m g (l\cos\theta + a\cos\omega t)$$
$$\ddot\theta = \frac{a\omega^2}{l}\sin\theta\cos\omega t - \frac{g}{l}\sin\theta$$"""


@pytest.mark.long("other tests reach its code")
def test_a_slip_in_a_position_is_not_that_of_what_follows(tmp_path: Path) -> None:
    assert not wrong(tmp_path, DRIVEN)


#: Two pendulums on a cart, small, with their sum and difference.
SUMS = r"""$$L = \frac{M}{2}\dot d^2 + \frac{m R^2}{2}(\dot\theta_1^2 + \dot\theta_2^2)
+ m R\dot d(\dot\theta_1 + \dot\theta_2) - \frac{m g R}{2}(\theta_1^2 + \theta_2^2)$$
$$h = \theta_1 + \theta_2, \quad q = \theta_1 - \theta_2$$
$$\theta_1^2 + \theta_2^2 = \frac{h^2 + q^2}{2}, \quad
\dot\theta_1^2 + \dot\theta_2^2 = \frac{\dot h^2 + \dot q^2}{2}$$
With other loads, $$M\ddot d = F - c d, \quad m R\ddot\theta_1 = F - c\theta_1 R, \quad
m\ddot\theta_2 = F_2 - c d\theta_2$$"""


@pytest.mark.long("other tests reach its code")
def test_a_relation_of_defined_names_depends_on_no_system(tmp_path: Path) -> None:
    assert not wrong(tmp_path, SUMS)
    (one,) = wrong(tmp_path, SUMS.replace("{h^2 + q^2}", "{h^2 - q^2}"))
    assert one.wrong_term == "- q^2"


ARM = r"""$$x_1 = l_1\sin\theta_1, \quad y_1 = -l_1\cos\theta_1$$
$$x_2 = l_1\sin\theta_1 + l_2\sin\theta_2, \quad y_2 = -l_1\cos\theta_1 - l_2\cos\theta_2$$
$$v_{x2} = l_1\dot\theta_1\cos\theta_1 + l_2\dot\theta_2\cos\theta_2$$
$$v_{2y} = l_1\dot\theta_1\sin\theta_1 + l_2\dot\theta_2\sin\theta_2$$
$$T = \frac12 m_1 l_1^2\dot\theta_1^2 + \frac12 m_2 (v_{x2}^2 + v_{2y}^2)$$"""


@pytest.mark.long("other tests reach its code")
def test_components_of_velocities_are_rates_of_positions(tmp_path: Path) -> None:
    assert [one.verdict for one in judged(tmp_path, ARM)][4:] == ["verified"] * 3
    (one,) = wrong(tmp_path, ARM.replace(r"\sin\theta_1 + l_2\dot", r"\sin\theta_1 - l_2\dot"))
    assert one.latex.startswith("v_{2y} =")
    # which of two is meant?
    two = r"$$x_2 = l_1\sin\theta_1, \quad v_{x2} = l_1\dot\theta_1\cos\theta_1$$"
    assert "v_{x2}" not in {one.latex[:6] for one in wrong(tmp_path, two + ARM)}


#: Inertias that positions do not state: a known system has them.
LINKS = r"""$$p_1 = \begin{bmatrix} a c_1 \\ a s_1 \\ 0\end{bmatrix}, \quad
p_2 = \begin{bmatrix} l c_1 + b c_{12} \\ l s_1 + b s_{12} \\ 0\end{bmatrix}$$
$$M = \begin{bmatrix} m_1 a^2 + m_2 l^2 + m_2 b^2 + I_1 + I_2 + 2 m_2 l b c_2
& m_2 b^2 + m_2 l b c_2 + I_2 \\ m_2 b^2 + m_2 l b c_2 + I_2 & m_2 b^2 + I_2\end{bmatrix}$$
In all, $$M = \begin{bmatrix} I_1 + I_2 + m_1 a^2 + m_2 (l^2 + b^2 + 2 l b c_2)
& I_2 + m_2 (b^2 + l b c_2) \\ I_2 + m_2 (b^2 + l b c_2) & I_2 + m_2 b^2\end{bmatrix}$$
$$C = \begin{bmatrix} -m_2 l b s_2\dot q_2 & -m_2 l b s_2 (\dot q_1 + \dot q_2) \\
m_2 l b s_2\dot q_1 & 0\end{bmatrix}, \quad
\tau = M\ddot q + C\dot q + G(q)$$"""


def test_of_two_matrices_that_of_the_known_system_is_right(tmp_path: Path) -> None:
    assert not wrong(tmp_path, LINKS)
    (one,) = wrong(tmp_path, LINKS.replace("b^2 + 2 l b c_2)", "b^2 + l b c_2)"))
    assert "l b c_2" in one.wrong_term


def test_blocks_of_matrices_are_not_compared(tmp_path: Path) -> None:
    text = r"""$$m\ddot x = -k x + u$$ $$\mathbf q = \begin{bmatrix} x \\ 0\end{bmatrix}$$
$$\mathbf s = \begin{bmatrix} \mathbf q \\ 1\end{bmatrix}, \quad
K = \begin{bmatrix} \mathbf q & 0 \\ 0 & 1\end{bmatrix}$$"""
    assert "wrong" not in {one.verdict for one in judged(tmp_path, text)}


def near_the_origin(condition: sp.Expr) -> State:
    """The state of a motion near one at which a condition has no value."""
    system = System("swing", "A mass", PLANE, [KG, ROD, GRAVITY], [PointMass(m, (x, y))],
        constraints=[condition])  # fmt: skip
    names = (*system.q, *system.qdot, *system.params)
    state = dict.fromkeys(names, sp.Integer(1)) | {x: sp.S.Zero, y: sp.S.Zero}
    return motion(Derivation(system), state)


def test_conditions_without_a_value_at_a_state_have_no_motion_there() -> None:
    with pytest.raises(ExpressionError, match="no generic state"):
        near_the_origin((x * velocity(y) - velocity(x)) / sp.sqrt(x**2 + y**2))
    found = near_the_origin(sp.sqrt(x**2 + y**2) - length)  # there is one beside it
    assert float(found[x] ** 2 + found[y] ** 2) == pytest.approx(1.0)
