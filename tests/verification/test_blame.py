"""Which of the formulas that contradict each other is wrong, and where nothing decides it."""

from pathlib import Path

import pytest

from derive.reading.document_formats import read_document
from derive.verification.documents.judgement import judge_document
from derive.verification.documents.pages.verdicts_in_place import FormulaVerdict


def judged(folder: Path, text: str) -> tuple[FormulaVerdict, ...]:
    (folder / "a.md").write_text(text, encoding="utf-8")
    return judge_document(read_document(folder / "a.md")).formulas


def wrong_terms(folder: Path, text: str) -> dict[str, str]:
    """The wrong formulas of a text without spaces, and their wrong terms."""
    wrong = [one for one in judged(folder, text) if one.verdict == "wrong"]
    return {one.latex.replace(" ", ""): one.wrong_term.replace(" ", "") for one in wrong}


#: Furuta's pendulum, as lecture notes state it: z has no definition, and one force is zero.
FURUTA = r"""
$$K = m r l$$ $$G = m g l$$ $$J_0 = J_1 + m r^2$$ $$J_2 = J + m l^2$$
$$T=\frac12(J_0+J_2\sin^2\alpha)\dot\theta^2+\frac12J_2\dot\alpha^2+K\cos\alpha\,\dot\theta\dot\alpha$$
$$V = m g z = m g l\cos\alpha = G\cos\alpha$$ $$L = T - V$$ $$Q_\theta=\tau$$ $$Q_\alpha=0$$
$$\frac{\partial L}{\partial\dot\theta}=(J_0+J_2\sin^2\alpha)\dot\theta + K\cos\alpha\,\dot\alpha$$
$$(J_0+J_2\sin^2\alpha)\ddot\theta+K\cos\alpha\,\ddot\alpha+J_2\sin(2\alpha)\dot\theta\dot\alpha
-K\sin\alpha\,\dot\alpha^2=\tau$$
$$K\cos\alpha\,\ddot\theta+J_2\ddot\alpha-\frac12J_2\sin(2\alpha)\dot\theta^2-G\sin\alpha=0$$
$$J_0\ddot\theta+K\ddot\alpha=\tau$$ $$K\ddot\theta + J_2\ddot\alpha - G\alpha = 0$$
"""


@pytest.mark.long("other tests reach its code")
def test_a_side_with_a_letter_of_its_own_is_not_judged(tmp_path: Path) -> None:
    assert {one.verdict for one in judged(tmp_path, FURUTA)} == {"verified", "definition"}


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(("right", "slip", "term"), [
    (r"\dot\theta + K\cos\alpha\,\dot\alpha", r"\dot\theta + K\sin\alpha\,\dot\alpha",
     r"K\sin\alpha\,\dot\alpha"),
    (r"K\ddot\theta + J_2\ddot\alpha - G\alpha", r"K\ddot\theta + J_2\ddot\alpha + G\alpha",
     r"G\alpha"),  # corrected by the linear equation
    (r"\dot\alpha^2=\tau", r"\dot\alpha=\tau", r"-K\sin\alpha\,\dot\alpha"),
    (r"J_0\ddot\theta+K\ddot\alpha", r"2J_0\ddot\theta+K\ddot\alpha", r"2J_0\ddot\theta"),
])  # fmt: skip
def test_a_slip_in_a_linear_equation_is_corrected_by_small_motions(
    right: str, slip: str, term: str, tmp_path: Path
) -> None:
    text = FURUTA.replace(right, slip)
    assert text != FURUTA
    assert [*wrong_terms(tmp_path, text).values()] == [term.replace(" ", "")]


def test_a_linear_equation_about_another_equilibrium_is_not_accused(tmp_path: Path) -> None:
    energies = r"""$$T = \frac12 J\dot\theta^2 + \frac12 K\dot\alpha^2 + c\cos\alpha\,\dot\theta
\dot\alpha$$ $$V = -G\cos\alpha$$ $$L = T - V$$ $$J\ddot\theta + c\cos\alpha\,\ddot\alpha
- c\sin\alpha\,\dot\alpha^2 = 0$$ $$K\ddot\alpha + c\cos\alpha\,\ddot\theta + G\sin\alpha = 0$$
Upright: """
    hanging, upright = (
        rf"$$K\ddot\alpha {signs[0]} c\ddot\theta {signs[1]} G\alpha = 0$$"
        for signs in ("++", "--")
    )
    assert judged(tmp_path, energies + hanging)[-1].verdict == "verified"
    assert judged(tmp_path, energies + upright)[-1].verdict == "context"
    mixed = hanging.replace("+ G", "- G")
    assert wrong_terms(tmp_path, energies + mixed)[mixed.strip("$").replace(" ", "")] == r"-G\alpha"


#: An arm on an elevator: its kinetic energy stands twice, and motors act.
ELEVATOR = r"""
$$T=\frac12 M\dot y^2+\frac12 m(\dot y^2+2\dot y l\dot\theta\cos\theta+l^2\dot\theta^2)
+\frac12 I\dot\theta^2$$
$$T=\frac12(M+m)\dot y^2+m\dot y l\dot\theta\cos\theta+\frac12(m l^2+I)\dot\theta^2$$
$$V=M g y+m g(y+l\sin\theta)$$ $$L = T - V$$
$$\frac{\partial L}{\partial\dot y}=(M+m)\dot y+m l\dot\theta\cos\theta$$
$$\frac{\partial L}{\partial y}=-(M+m)g$$
$$(M+m)\ddot y+m l(\ddot\theta\cos\theta-\dot\theta^2\sin\theta)+(M+m)g=F$$
$$\frac{\partial L}{\partial\dot\theta}=m\dot y l\cos\theta+(m l^2+I)\dot\theta$$
$$\frac{\partial L}{\partial\theta}=-m\dot y l\dot\theta\sin\theta-m g l\cos\theta$$
$$m l\ddot y\cos\theta+(m l^2+I)\ddot\theta+m g l\cos\theta=\tau$$
$$(M+m)\ddot y+m l(\ddot\theta\cos\theta-\dot\theta^2\sin\theta)+(M+m)g=F$$
"""


@pytest.mark.long("other tests reach its code")
def test_what_most_of_a_document_agrees_with_is_no_other_case(tmp_path: Path) -> None:
    assert not wrong_terms(tmp_path, ELEVATOR)
    text = ELEVATOR.replace(r"\frac12(m l^2+I)", r"\frac12(m l+I)")
    text = text.replace(r"\sin\theta-m g l\cos\theta", r"\sin\theta-m g l\sin\theta")
    assert [*wrong_terms(tmp_path, text).values()] == ["ml", r"-mgl\sin\theta"]


@pytest.mark.long("other tests reach its code")
def test_a_load_has_not_the_value_of_the_first_wrong_equation(tmp_path: Path) -> None:
    named = ELEVATOR.replace("=F$", "=F_{mot}$")
    text = named.replace(r"\sin\theta)+(M+m)g=F", r"\sin\theta)-(M+m)g=F", 1)
    equations = [one for one in judged(tmp_path, text) if one.latex.strip().endswith("=F_{mot}")]
    assert [one.verdict for one in equations] == ["wrong", "verified"]


@pytest.mark.long("other tests reach its code")
def test_a_force_between_bodies_has_the_inertia_of_one(tmp_path: Path) -> None:
    energies = r"""
$$T=\frac12(M+m+\frac{J}{R^2})\dot x^2+m l\dot x\dot\theta\cos\theta+\frac12 m l^2\dot\theta^2$$
$$V = - m g l\cos\theta$$ $$l\ddot\theta + \ddot x\cos\theta + g\sin\theta = 0$$ """
    force = r"$$m\ddot x + m l\ddot\theta\cos\theta - m l\dot\theta^2\sin\theta = S$$"
    assert judged(tmp_path, energies + force)[-1].verdict != "wrong"


def test_the_force_of_a_rod_is_no_wrong_equation_of_the_cart(tmp_path: Path) -> None:
    energies = r"""
$$T=\frac12(M+m)\dot x^2+m l\dot x\dot\theta\cos\theta+\frac12 m l^2\dot\theta^2$$
$$V = - m g l\cos\theta$$ $$L = T - V$$ The force of the rod is """
    force = r"$$m\ddot x + m l\ddot\theta\cos\theta - m l\dot\theta^2\sin\theta = F_{rod}$$"
    assert judged(tmp_path, energies + force)[-1].verdict == "context"
    whole = force.replace("m", "(M+m)", 1)
    assert judged(tmp_path, energies + whole)[-1].verdict == "verified"
    assert judged(tmp_path, energies + whole.replace("-", "+"))[-1].verdict == "wrong"
    # another equation gives it the inertia of the cart
    assert judged(tmp_path, energies + whole + force)[-1].verdict == "wrong"


@pytest.mark.long("other tests reach its code")
def test_a_stiffness_is_no_applied_force_and_a_moment_of_a_coordinate_is_one(
    tmp_path: Path,
) -> None:
    energies = r"$$T = \frac12 m l^2\dot\theta^2$$ $$V = -m g l\cos\theta$$ $$L = T - V$$"
    equation = r"$$m l^2\ddot\theta + m g l\sin\theta = M_\theta\cos\theta$$"
    for letter, verdict in (("M_\\theta", "verified"), ("Q", "verified"), ("k", "context")):
        formula = equation.replace("M_\\theta", letter)
        assert judged(tmp_path, energies + formula)[-1].verdict == verdict
    # nor is a spring beside a force
    formula = equation.replace(r"= M_\theta\cos\theta", r"+ k\theta = Q")
    assert judged(tmp_path, energies + formula)[-1].verdict == "context"
    # nor is a moment of inertia, beside a force
    formula = equation.replace("m l^2", "(m l^2 - 2 J_m)").replace("M_\\theta", "Q")
    assert judged(tmp_path, energies + formula)[-1].verdict == "context"


BEAM = r"""
$$L=\frac12(m+\frac{J}{R^2})\dot r^2+\frac12(m r^2+\frac13 M l^2)\dot\alpha^2-m g r\sin\alpha$$
$$\frac{\partial L}{\partial r}=m r\dot\alpha^2-m g\sin\alpha$$
$$\frac{\partial L}{\partial\dot\alpha}=(m r^2+\frac13 M l^2)\dot\alpha$$
$$(m+\frac{J}{R^2})\ddot r-m r\dot\alpha^2+m g\sin\alpha=0$$
$$(m r^2+\frac13 M l^2)\ddot\alpha+2m r\dot r\dot\alpha+m g r\cos\alpha=\tau$$
"""


def test_a_lagrangian_with_a_lost_square_is_the_wrong_formula(tmp_path: Path) -> None:
    text = BEAM.replace("M l^2", "M l", 1)
    assert [*wrong_terms(tmp_path, text).values()] == [r"\frac13Ml"]
    text = text.replace("+2m r", "+m r")  # beside another slip
    assert [*wrong_terms(tmp_path, text).values()] == [r"\frac13Ml", r"mr\dotr\dot\alpha"]


#: A spherical pendulum, and at the end its Hamiltonian with gravity in the other direction.
TURNED = r"""
$$L = \frac12 m r^2(\dot\theta^2+\dot\phi^2\sin^2\theta) - m g r\cos\theta$$
$$p_\theta = m r^2\dot\theta$$ $$p_\phi = m r^2\sin\theta\,\dot\phi$$
$$H = \frac{p_\theta^2}{2 m r^2}+\frac{p_\phi^2}{2 m r^2\sin^2\theta} + m g r\cos\theta$$
$$\dot\phi = \frac{p_\phi}{m r^2\sin^2\theta}$$
$$H = \frac{p_\theta^2}{2 m r^2}+\frac{p_\phi^2}{2 m r^2\sin^2\theta} - m g r\cos\theta$$
"""


def test_formulas_before_an_energy_of_another_case_are_not_of_this_case(tmp_path: Path) -> None:
    found = [one.verdict for one in judged(tmp_path, TURNED)]
    assert found == ["definition", "verified", "wrong", "verified", "verified", "context"]


@pytest.mark.long("other tests reach its code")
def test_two_sides_of_a_chain_decide_about_the_third(tmp_path: Path) -> None:
    """The Lagrangian alone states the system, and nothing else of it moves."""
    text = r"""
$$L = \frac\mu2(\dot r^2 + r^2\dot\phi^2) - V(r)$$ $$\ell = \mu r^2\dot\phi$$
$$E = \frac\mu2(\dot r^2 + r^2\dot\phi^2) + V(r)
= \frac\mu2\dot r^2 + \frac{\ell^2}{2\mu r^2} + V(r)$$"""
    assert judged(tmp_path, text)[-1].verdict == "verified"
    slip = text.replace("{2\\mu r^2}", "{\\mu r^2}")
    assert [*wrong_terms(tmp_path, slip).values()] == [r"\frac{\ell^2}{\mur^2}"]
    short = slip.replace(r"= \frac\mu2(\dot r^2 + r^2\dot\phi^2) + V(r)", "")
    assert not wrong_terms(tmp_path, short)


SEGWAY = r"""
$$F=\frac{\tau_1+\tau_2}{r}$$
$$T=\frac12 M\dot x^2+\frac12 m l\dot x\dot\theta\cos\theta+\frac12(I+m l^2)\dot\theta^2$$
$$V=m g l\cos\theta$$ $$L=T-V$$ $$M\ddot x+m l\cos\theta\,\ddot\theta
+m l\sin\theta\,\dot\theta^2=F$$
$$(I+m l^2)\ddot\theta+m l\cos\theta\,\ddot x-m g l\sin\theta=-(\tau_1+\tau_2)$$
$$M\ddot x+m l\cos\theta\,\ddot\theta-m l\dot\theta^2\sin\theta=\frac{\tau_1+\tau_2}{r}$$
$$(I+m l^2)\ddot\theta+m l\cos\theta\,\ddot x-m g l\cos\theta=-(\tau_1+\tau_2)$$
"""


def test_energies_decide_which_of_two_equations_is_wrong(tmp_path: Path) -> None:
    assert [*wrong_terms(tmp_path, SEGWAY).values()] == [
        r"\frac12ml\dotx\dot\theta\cos\theta", r"ml\sin\theta\,\dot\theta^2", r"-mgl\cos\theta",
    ]  # fmt: skip


def test_a_sum_of_energies_is_not_accused_for_a_wrong_part(tmp_path: Path) -> None:
    text = r"""$$K_r=\frac{1}{24}m b^2\dot\theta^2$$ $$K_c=\frac18 m b\dot\theta^2$$
$$V=-\frac12 m g b\cos\theta$$ $$L=K_c+K_r-V$$
$$L=\frac16 m b^2\dot\theta^2+\frac12 m g b\cos\theta$$
$$\frac13 m b^2\ddot\theta+\frac12 m g b\sin\theta=0$$ $$\ddot\theta+\frac{3g}{2b}\sin\theta=0$$"""
    assert not wrong_terms(tmp_path, text)  # the slip is in a definition
    right = text.replace("m b", "m b^2", 2).replace("^2^2", "^2")
    assert [*wrong_terms(tmp_path, right.replace("-V", "+V"))] == ["L=K_c+K_r+V"]


#: An elastic pendulum, with L for its length, and ℓ for l in one place.
ELASTIC = r"""
$$x = (l+L)\cos\theta$$ $$y = (l+L)\sin\theta$$ $$K = \frac12 m(\dot x^2+\dot y^2)$$
$$U = \frac12 k(l+L)^2 - m g y$$ $$\mathcal L = \frac12 m[(L+l)^2\dot\theta^2+\dot l^2]^2
- \frac12 k(L+\ell)^2 + m g(L+l)\cos\theta$$
$$\frac{\partial\mathcal L}{\partial\theta} = -m g(L+l)\sin\theta$$
$$\frac{\partial\mathcal L}{\partial\dot\theta} = m(L+l)^2\dot\theta$$
$$\frac{\partial\mathcal L}{\partial l} = m\dot\theta^2(L+l)+m g\cos\theta-k(L+l)$$
$$m\ddot l = m\dot\theta^2(L+l)+m g\cos\theta-k(L+l)$$
$$\ddot l = \dot\theta^2(L+l)+g\cos\theta-\frac{k}{m}(L+l)$$
"""


@pytest.mark.long("other tests reach its code")
def test_ell_and_l_are_one_letter_if_more_holds_so(tmp_path: Path) -> None:
    assert [*wrong_terms(tmp_path, ELASTIC).values()] == [
        "-mgy", r"[(L+l)^2\dot\theta^2+\dotl^2]",
    ]  # fmt: skip


ROD = r"""
$$V = m\frac l2 g\cos\theta$$ $$T = \frac12(M+m)\dot x^2+\frac12 m l\dot x\dot\theta\cos\theta
+\frac12\frac{m l^2}{3}\dot\theta^2$$ $$L = T - V = \frac12(M+m)\dot x^2
+\frac12 m l\dot x\dot\theta\cos\theta+\frac12\frac{m l^2}{3}\dot\theta^2-m g\frac l2\cos\theta$$
$$(M+m)\ddot x+\frac{m l}{2}\ddot\theta\cos\theta-\frac{m l}{2}\dot\theta^2\sin\theta=u$$
$$\frac{m l^2}{3}\ddot\theta+\frac{m l}{2}\ddot x\cos\theta+m g\frac l2\sin\theta=0$$
with $q = [x, \theta]^T$ and $\tau = [u, 0]^T$ in $D(q)\ddot q+C(q,\dot q)\dot q+G(q)=\tau$,
$$D(q)=\begin{bmatrix}M+m&\frac{m l}{2}\cos\theta\\\frac{m l}{2}\cos\theta&\frac{m l^2}{3}
\end{bmatrix}$$ $$\frac{m l^2}{3}\ddot\theta+\frac{m l}{2}a\cos\theta+m g\frac l2\sin\theta=0$$
$$\varphi=\theta-\pi$$ $$\ddot\varphi=\frac{3g}{2l}\varphi+\frac{3}{2l}a$$
"""


def test_nothing_decides_between_an_energy_and_equations_with_another_sign(tmp_path: Path) -> None:
    assert not wrong_terms(tmp_path, ROD)


@pytest.mark.long("other tests reach its code")
def test_all_letters_of_a_chain_of_equal_ones_are_one(tmp_path: Path) -> None:
    text = r"""$$m_1=m_2=m$$ $$k_1=k_2=k_3=k$$ $$m_1\ddot x_1+(k_1+k_2)x_1-k_2x_2=0$$
$$m_2\ddot x_2+(k_3+k_2)x_2-k_2x_1=0$$ $$\begin{bmatrix}-2\frac km&\frac km\\
\frac km&-2\frac km\end{bmatrix}\begin{bmatrix}x_1\\x_2\end{bmatrix}
=\begin{bmatrix}\ddot x_1\\\ddot x_2\end{bmatrix}$$"""
    assert judged(tmp_path, text)[-1].verdict == "verified"
    slip = text.replace("\n" + r"\frac km", "\n" + r"2\frac km")
    assert judged(tmp_path, slip)[-1].verdict == "wrong"


HOOP = r"""
$$L = \frac12 m a^2(\dot\theta^2+\Omega^2\sin^2\theta)+m g a\cos\theta$$
$$p = m a^2\dot\theta$$ $$\dot p = m a^2\Omega^2\sin\theta\cos\theta - m g a\sin\theta$$
$$\ddot\theta = (\Omega^2\cos\theta-\frac ga)\sin\theta$$
"""


@pytest.mark.long("other tests reach its code")
def test_beside_the_momentum_p_a_power_is_p_as_well(tmp_path: Path) -> None:
    power = r"$$P = -2m a^2\Omega^2\dot\theta\cos\theta\sin\theta$$"
    assert judged(tmp_path, HOOP + power)[-1].verdict == "definition"
    momentum = HOOP.replace(r"$$p = m a^2\dot\theta$$", "").replace(r"\dot p", r"\dot P")
    assert judged(tmp_path, momentum + power)[-1].verdict == "wrong"


def test_a_displacement_defines_no_coordinate(tmp_path: Path) -> None:
    near = HOOP + r"Let $\theta=\theta_0+\eta$. $$\ddot\eta=-\eta\Omega^2\sin^2\theta_0$$"
    assert [one.verdict for one in judged(tmp_path, near)][:4] == ["verified"] * 4
    slip = near.replace(r"m a^2\dot\theta", r"m a\dot\theta")
    assert [*wrong_terms(tmp_path, slip)] == [r"p=ma\dot\theta"]


@pytest.mark.long("other tests reach its code")
def test_a_column_of_coordinates_is_none(tmp_path: Path) -> None:
    text = r"""$$q = (x, \theta)$$
$$T = \frac12(M+m)\dot x^2-\frac12 m l\dot x\dot\theta\cos\theta+\frac12 m l^2\dot\theta^2$$
$$L = \frac12(M+m)\dot x^2-m l\dot x\dot\theta\cos\theta+\frac12 m l^2\dot\theta^2-m g l\cos\theta$$
$$\frac{\partial L}{\partial\dot x} = (M+m)\dot x-m l\dot\theta\cos\theta$$
$$l\ddot\theta-\ddot x\cos\theta-g\sin\theta=0$$ $$H(q)\ddot q+C(q,\dot q)\dot q+G(q)=\tau$$"""
    assert judged(tmp_path, text)[2].note == "it states the system"
    assert [*wrong_terms(tmp_path, text).values()] == [r"-\frac12ml\dotx\dot\theta\cos\theta"]


@pytest.mark.long("other tests reach its code")
def test_an_acceleration_of_a_coordinate_is_no_rate_of_a_position(tmp_path: Path) -> None:
    text = r"""$$x_p = x - l\sin\theta$$ $$y_p = l\cos\theta$$
$$T = \frac12 M\dot x^2+\frac12 m(\dot x_p^2+\dot y_p^2)$$
$$T = \frac12(M+m)\dot x^2-\frac12 m l\dot x\dot\theta\cos\theta+\frac12 m l^2\dot\theta^2$$
$$L = \frac12(M+m)\dot x^2-m l\dot x\dot\theta\cos\theta+\frac12 m l^2\dot\theta^2-m g l\cos\theta$$
$$(M+m)\ddot x-m l\cos\theta\,\ddot\theta+m l\sin\theta\,\dot\theta^2=0$$
$$l\ddot\theta-\ddot x\cos\theta-g\sin\theta=0$$
$$\ddot x = \frac{m l\sin\theta(g\cos\theta - l\dot\theta^2)}{M+m\sin^2\theta}$$"""
    wrong = wrong_terms(tmp_path, text)
    assert len(wrong) == 2
    assert r"-\frac12ml\dotx\dot\theta\cos\theta" in wrong.values()


def test_a_rate_that_vanishes_is_no_evidence(tmp_path: Path) -> None:
    text = r"""$$L = \frac12 m\dot x^2 + I\dot\theta^2$$
$$\frac{d}{dt}\left(\frac{\partial L}{\partial\dot x}\right) = m\ddot x$$
$$\frac{d}{dt}\left(\frac{\partial L}{\partial\dot\theta}\right) = I\ddot\theta$$"""
    assert [one.verdict for one in judged(tmp_path, text)][1:] == ["verified", "context"]


@pytest.mark.long("other tests reach its code")
def test_a_frequency_decides_which_equation_is_wrong(tmp_path: Path) -> None:
    text = r"""$$-k x = m\ddot x$$ $$\ddot x - \frac km x = 0$$ $$\omega_0^2 = \frac km$$
$$\omega_0 = \sqrt{\frac km}$$ $$T_0 = \frac{2\pi}{\omega_0}$$"""
    assert wrong_terms(tmp_path, text) == {r"\ddotx-\frackmx=0": r"-\frackmx"}
    torsion = r"""$$J\ddot\theta = -C\theta$$ $$\ddot\theta+\frac JC\theta=0$$
$$T_0 = 2\pi\sqrt{\frac JC}$$ $$T_0^2 = 4\pi^2\frac JC$$ $$\omega_0 = \sqrt{\frac CJ}$$"""
    assert wrong_terms(tmp_path, torsion) == {r"\ddot\theta+\fracJC\theta=0": r"\fracJC\theta"}
    undecided = torsion.partition("$$T_0")[0]
    assert not wrong_terms(tmp_path, undecided)


ARM = r"""
$$T = \frac12(m_1+m_2)l_1^2\dot\theta_1^2+\frac12 m_2l_2^2(\dot\theta_1+\dot\theta_2)^2
+m_2l_1l_2\dot\theta_1(\dot\theta_1+\dot\theta_2)\cos\theta_2$$
$$U = -(m_1+m_2)g l_1\cos\theta_1-m_2g l_1\cos(\theta_1+\theta_2)$$
$$T = \frac12\dot q^T M\dot q$$ $$q = [\theta_1, \theta_2]^T$$
$$(m_1+m_2)l_1^2\ddot\theta_1+m_2l_2^2(\ddot\theta_1+\ddot\theta_2)
+m_2l_1l_2(2\ddot\theta_1+\ddot\theta_2)\cos\theta_2
-m_2l_1l_2(2\dot\theta_1+\dot\theta_2)\dot\theta_2\sin\theta_2
+(m_1+m_2)l_1g\sin\theta_1+m_2g l_2\sin(\theta_1+\theta_2)=\tau_1$$
"""


@pytest.mark.long("other tests reach its code")
def test_an_equation_is_not_accused_by_an_energy_that_nothing_confirms(tmp_path: Path) -> None:
    assert not wrong_terms(tmp_path, ARM)


#: A cart with a rod, by energies and linear equations.
ROD_CART = r"""
$$T=\frac12(M+m)\dot x^2-\frac12 m l\dot x\dot\theta\cos\theta+\frac16 m l^2\dot\theta^2$$
$$U=\frac12 m g l\cos\theta$$ $$\sin\theta\approx\theta$$ $$\cos\theta\approx1$$
$$g\theta+\ddot x-\frac23 l\ddot\theta=0$$ $$u=(M+\frac14 m)\ddot x-\frac34 m g\theta$$
$$\frac23 l\ddot\theta=g\theta+\ddot x$$ $$u=(M+m)\ddot x-\frac12 m l\ddot\theta$$
$$\frac23 l\ddot\theta-\ddot x=g\theta$$ $$\ddot x+g\theta=\frac23 l\ddot\theta$$
$$\frac23 l\ddot\theta-g\theta=\ddot x$$ $$u+\frac34 m g\theta=(M+\frac14 m)\ddot x$$
"""


@pytest.mark.long("other tests reach its code")
def test_linear_equations_do_not_speak_against_energies(tmp_path: Path) -> None:
    assert "context" not in {one.verdict for one in judged(tmp_path, ROD_CART)}
    slip = ROD_CART.replace(r"\frac23 l\ddot\theta=g", r"\frac43 l\ddot\theta=g")
    slip = slip.replace(r"\frac23 l\ddot\theta-\ddot x", r"\frac13 l\ddot\theta-\ddot x")
    assert [*wrong_terms(tmp_path, slip).values()] == [
        r"\frac43l\ddot\theta", r"\frac13l\ddot\theta",
    ]  # fmt: skip


WHEEL = r"""
$$T=\frac12 m l^2\dot\theta^2+\frac12 I(\dot\theta+\dot\phi)^2$$ $$V=m g l\cos\theta$$
$$L=\frac12 m l^2\dot\theta^2+\frac12 I(\dot\theta+\dot\phi)^2-m g l\cos\theta$$
$$Q_\theta=-\tau$$ $$Q_\phi=+\tau$$ $$(m l^2+I)\ddot\theta+I\ddot\phi+m g l\sin\theta=-\tau$$
$$I(\ddot\theta+\ddot\phi)=\tau$$ $$\sin\theta\approx\theta$$
$$(m l^2+I)\ddot\theta+I\ddot\phi+m g l\theta=-\tau$$ $$I(\ddot\theta+\ddot\phi)=\tau$$
"""


def test_nothing_decides_between_energies_and_several_equations(tmp_path: Path) -> None:
    assert not wrong_terms(tmp_path, WHEEL)


@pytest.mark.long("other tests reach its code")
def test_a_potential_energy_can_have_no_value(tmp_path: Path) -> None:
    text = r"""$$L = T - U = \frac12 m(\dot x^2+\dot y^2) - U(x, y)$$ $$p_x = m\dot x$$
$$p_y = m\dot y$$ $$\dot x = \frac{p_x}{m}$$ $$\dot y = \frac{p_y}{m}$$
$$H = \frac{1}{2m}(p_x^2+p_y^2) + U(x, y)$$"""
    assert not wrong_terms(tmp_path, text)
    assert judged(tmp_path, text)[-1].verdict == "verified"
    slip = text.replace(r"\frac{1}{2m}", r"\frac1m")
    assert [*wrong_terms(tmp_path, slip).values()] == [r"\frac1m(p_x^2+p_y^2)"]


def test_equations_with_the_same_acceleration_can_be_those_of_another_body(tmp_path: Path) -> None:
    text = r"""$$\frac12 m\dot x^2+\frac12 k x^2=E$$ $$m\dot x\ddot x+k x\dot x=0$$
$$m\ddot x+k x=0$$ For a cylinder that rolls: $$\frac32 m\dot x\ddot x+k x\dot x=0$$
$$(m\ddot x+\frac23 k x)\dot x=0$$ $$m\ddot x+\frac23 k x=0$$"""
    assert not wrong_terms(tmp_path, text)
    slip = text.partition("For a cylinder")[0] + r"$$m\ddot x+\frac23 k x=0$$"
    assert [*wrong_terms(tmp_path, slip).values()] == [r"\frac23kx"]


@pytest.mark.long("other tests reach its code")
def test_an_equation_of_velocities_can_hold_for_some_constants_of_the_motion(
    tmp_path: Path,
) -> None:
    text = r"""
$$T=\frac A2(\dot\theta^2+\dot\phi^2\sin^2\theta)+\frac C2(\dot\psi+\dot\phi\cos\theta)^2$$
$$V=m g l\cos\theta$$ $$N=C(\dot\psi+\dot\phi\cos\theta)$$
$$p_\phi=A\dot\phi\sin^2\theta+N\cos\theta$$ $$E = T + V$$
$$\frac A2\dot\theta^2=(1-\cos\theta)\left(m g l-\frac{N^2}{2A(1+\cos\theta)}\right)$$"""
    *_, last = judged(tmp_path, text)
    assert (last.verdict, last.note) == ("context", "it can hold for some constants of the motion")


def test_a_momentum_of_another_coordinate_is_not_wrong(tmp_path: Path) -> None:
    """On a helix z is R*theta, and p is the momentum of z."""
    text = r"""
$$x = r\cos\theta$$ $$y = r\sin\theta$$ $$z = R\theta$$ $$\dot z = R\dot\theta$$
$$T = \frac12 m(r^2\dot\theta^2 + \dot z^2)$$ $$V = m g z$$
$$p = \frac{\partial L}{\partial\dot z} = m\dot z(1 + \frac{r^2}{R^2})$$"""
    assert "wrong" not in [one.verdict for one in judged(tmp_path, text)]


def test_a_potential_energy_can_stand_beside_another_part(tmp_path: Path) -> None:
    text = r"""
$$T = \frac{m l^2}{2}(\dot\theta_1^2 + \dot\theta_2^2)$$
$$V = \frac{m g l}{2}(\theta_1^2 + \theta_2^2)$$
$$V_{coupling} = \frac k2\frac{l^2}{4}(\theta_2 - \theta_1)^2$$
$$L = \frac{m l^2}{2}(\dot\theta_1^2 + \dot\theta_2^2) - \frac12\left(m g l(\theta_1^2 + \theta_2^2)
+ k\frac{l^2}{4}(\theta_2 - \theta_1)^2\right)$$
$$m l^2\ddot\theta_1 + m g l\theta_1 - k\frac{l^2}{4}(\theta_2 - \theta_1) = 0$$"""
    verdicts = {one.latex.strip()[:2]: one for one in judged(tmp_path, text)}
    assert verdicts["V "].note == "without V_coupling"
    slip = text.replace(r"\frac{m g l}{2}(\theta_1^2 +", r"\frac{m g l}{2}(\theta_1^2 -")
    assert "without" not in [one.note for one in judged(tmp_path, slip)][1]


SPRING = r"""$$\ddot x = (l_0 + x)\dot\theta^2 - \frac{k}{m} x + g\cos\theta$$
$$\ddot\theta = \frac{-g\sin\theta - 2\dot x\dot\theta}{l_0 + x}$$
$$L = \frac12 m\dot x^2 + \frac12 m (l_0 + x)^2\dot\theta^2 + m g (l_0 + x)\cos\theta
- \frac12 k x^2$$
$$\ddot\theta = \frac{-g\sin\theta - \dot x\dot\theta}{l_0 + x}$$
$$T = \frac12 m(\dot x^2 + (l_0 + x)^2\dot\theta^2)$$ $$V_g = -m g (l_0 + x)\cos\theta$$
$$L[\theta,\dot\theta,x,\dot x] = \frac12 m(\dot x^2 + (l_0 + x)^2\dot\theta^2)
+ m g (l_0 + x)\cos\theta - \frac12 k x^2 = \frac12 m\dot x^2 + \frac12 m (l_0 + x)^2\dot\theta^2
+ m g (l_0 + x)\cos\theta - k x^2$$"""


@pytest.mark.long("other tests reach its code")
def test_a_chain_that_contradicts_itself_is_not_of_another_case(tmp_path: Path) -> None:
    assert [*wrong_terms(tmp_path, SPRING).values()] == [
        r"-\dot x\dot\theta".replace(" ", ""),
        "-kx^2",
    ]


@pytest.mark.parametrize("lagrangian", ["L = T", "V = 0 \\implies L = T"])
def test_an_energy_that_states_the_system_is_not_verified_by_it(
    lagrangian: str, tmp_path: Path
) -> None:
    text = rf"""$$T = \frac12 m\dot x^2 + I\dot\theta^2$$ $${lagrangian}$$
$$\frac{{d}}{{dt}}\left(\frac{{\partial L}}{{\partial\dot x}}\right) = m\ddot x$$"""
    results = judged(tmp_path, text)
    assert (results[0].verdict, results[0].note) == ("definition", "it states the system")


def test_an_energy_among_accelerations_is_another_quantity(tmp_path: Path) -> None:
    text = r"""$$T = \frac12 m\dot y^2$$ $$V = m g y$$ $$\ddot y = -g$$ $$m\ddot y = {} - m g$$"""
    results = judged(tmp_path, text.replace("{}", "T"))  # a tension
    assert results[-1].verdict == "context"
    assert results[-1].note == "T is no energy beside accelerations"
    rate = judged(tmp_path, text + r"$$\frac{d T}{dt} = m\dot y\ddot y$$".replace("{}", "0"))
    assert rate[-1].verdict != "context"


WIRE = r"""$$X = x\cos\omega t$$ $$Y = a x^2$$ $$Z = x\sin\omega t$$
$$T = \frac12 m (\dot X^2 + \dot Y^2 + \dot Z^2)$$ $$V = m g Y$$
$$L = \frac12 m ((1 + 4 a^2 x^2)\dot x^2 + \omega^2 x^2) - m g a x^2$$
$$p = \frac{\partial L}{\partial\dot x} = m (1 + 4 a^2 x^2)\dot x$$
$$H = \frac{p^2}{2 m (1 + 4 a^2 x^2)} + m (g a - \frac{\omega^2}{2}) x^2$$
$$\dot x = \frac{p}{m (1 + 4 a^2 x^2)}$$"""


@pytest.mark.long("other tests reach its code")
def test_a_hamiltonian_is_wrong_whatever_formula_states_its_momentum(tmp_path: Path) -> None:
    assert wrong_terms(tmp_path, WIRE) == {}
    slips = WIRE.replace(r"a^2 x^2)\dot x$$", r"a x^2)\dot x$$").replace("g a -", "g a +")
    terms = wrong_terms(tmp_path, slips)
    assert [*terms.values()][-1] == r"\frac{\omega^2}{2}"
    assert len(terms) == 2


def test_a_sum_is_not_wrong_for_a_term_that_its_parts_can_lack(tmp_path: Path) -> None:
    text = r"""$$T = \frac12 m l^2\dot\phi^2$$ $$V = \frac12 k\phi^2 - m g l\cos\phi$$
$$p_\phi = m l^2\dot\phi$$
$$H = \frac{p_\phi^2}{2 m l^2} + \frac12 k\phi^2 - m g l\cos\phi$$
$$H_0 = \frac{p_\phi^2}{2 m l^2}$$ $$H_1 = - m g l\cos\phi$$
$$H = H_0 + \epsilon H_1$$ $$\epsilon = 1$$
$$\ddot\phi = -\frac gl\sin\phi - \frac{k}{m l^2}\phi$$"""
    assert not wrong_terms(tmp_path, text)
    whole = text.replace("H_0 + ", r"\frac{p_\phi^2}{2 m l^2} + ")
    assert [*wrong_terms(tmp_path, whole)] == [r"H=\frac{p_\phi^2}{2ml^2}+\epsilonH_1"]


#: A block on a string through a hole, a disc, and two weights, each with a law and a definition.
TABLE = r"""
$$L = \frac12 (m + M)\dot r^2 + \frac12 m r^2\dot\phi^2 - M g r$$
$$\frac{d}{dt}(m r^2\dot\phi) = 0, \qquad J = m r^2\dot\phi$$
$$(m + M)\ddot r = \frac{J^2}{m r^3} - M g$$
"""
SPHERE = r"""
$$T = \frac{7}{10} m\dot x^2, \quad V = -m g x\sin\beta, \quad \ddot x = \frac57 g\sin\beta$$
$$m\ddot x = m g\sin\beta - f$$ $$f = \frac27 m g\sin\beta$$
"""
WEIGHTS = r"""
$$T = \frac12 (m_1 + m_2)\dot x^2, \quad V = -m_1 g x - m_2 g (\ell - x)$$
$$m_1\ddot x = m_1 g - S$$ $$-m_2\ddot x = m_2 g - S$$ $$S = \frac{2 m_1 m_2}{m_1 + m_2} g$$
"""


@pytest.mark.parametrize(("text", "right", "slip", "law"), [
    (TABLE, r"J = m r^2", r"J = m r^3", r"(m + M)\ddot r = \frac{J^2}{m r^3} - M g"),
    (SPHERE, r"m g\sin\beta$$ $$", r"m g\cos\beta$$ $$", ""),
    (SPHERE, r"f = \frac27 m g\sin\beta", r"f = \frac27 m g\cos\beta",
     r"m\ddot x = m g\sin\beta - f"),
])  # fmt: skip
def test_a_law_is_not_accused_for_a_definition_that_nothing_else_supports(
    text: str, right: str, slip: str, law: str, tmp_path: Path
) -> None:
    assert wrong_terms(tmp_path, text) == {}
    if not law:
        return
    formulas = judged(tmp_path, text.replace(right, slip))
    assert "wrong" not in {one.verdict for one in formulas}
    (one,) = (one for one in formulas if one.latex == law)
    assert (one.verdict, one.note[:19]) == ("context", "it contradicts line")


@pytest.mark.parametrize(("text", "right", "slip"), [
    (TABLE, r"(m + M)\ddot r", r"(m - M)\ddot r"),
    (TABLE, r"\ddot r =", r"\dot r ="),
    (SPHERE, r"m\ddot x = m g\sin\beta - f", r"m\ddot x = m g\cos\beta - f"),
    (SPHERE, r"m\ddot x = m g\sin\beta - f", r"m\ddot x = m g\sin\beta + f"),
])  # fmt: skip
def test_a_law_with_a_slip_beside_a_definition_is_wrong(
    text: str, right: str, slip: str, tmp_path: Path
) -> None:
    assert text.count(right) == 1
    (wrong,) = wrong_terms(tmp_path, text.replace(right, slip))
    assert slip.strip("$\n").replace(" ", "") in wrong


def test_two_laws_show_the_slip_in_the_definition_of_their_reaction(tmp_path: Path) -> None:
    assert wrong_terms(tmp_path, WEIGHTS) == {}
    text = WEIGHTS.replace("{2 m_1 m_2}", "{2 m_1 m_1}")
    assert [*wrong_terms(tmp_path, text)] == [r"S=\frac{2m_1m_1}{m_1+m_2}g"]


INCLINE = r"$$T = \frac12 m\dot s^2,\quad V = -m g s\sin\alpha, \quad L = T - V$$"
OSCILLATORS = r"""
$$T = \frac12 m(\dot x^2 + \dot y^2),\quad V = \frac12 k (x^2 + y^2) + c x y, \quad L = T - V$$
"""


@pytest.mark.parametrize(("text", "equation", "verdict"), [
    (INCLINE, r"\ddot s = g\sin\alpha", "verified"),
    (INCLINE, r"\dot s = g\sin\alpha", "wrong"),
    (INCLINE, r"m\dot s = m g\sin\alpha", "wrong"),
    (INCLINE, r"\dot s = v_0", "definition"),
    (INCLINE, r"\dot s = 0", "context"),
    (OSCILLATORS, r"m\dot x = -k x - c y", "wrong"),
    (OSCILLATORS, r"m\dot x = -2 k x - c y", "context"),
    (OSCILLATORS, r"m\dot x = -m\dot y", "context"),
])  # fmt: skip
def test_an_equation_of_motion_without_a_dot_is_wrong(
    text: str, equation: str, verdict: str, tmp_path: Path
) -> None:
    one = judged(tmp_path, rf"{text}$${equation}$$")[-1]
    assert one.verdict == verdict
    if verdict == "wrong":
        assert one.wrong_term.startswith(r"\dot")
        assert one.correction.replace("{", " ").replace("}", "") == equation.replace(
            r"\dot", r"\ddot"
        )


SPHERICAL = r"""
$$x = \ell\sin\theta\cos\varphi,\quad y = \ell\sin\theta\sin\varphi,\quad z = -\ell\cos\theta$$
$$L = \frac{m\ell^2}{2}(\dot\theta^2 + \dot\varphi^2\sin^2\theta) + m g\ell\cos\theta$$
$$J = m\ell^2\sin^2\theta\,\dot\varphi = \text{const}$$
$$E = \frac{m\ell^2}{2}\dot\theta^2 + U$$
$$U = \frac{J^2}{2 m\ell^2\sin^2\theta} - m g\ell\cos\theta$$
"""


@pytest.mark.parametrize(("right", "slip"), [
    (r"J = m\ell^2\sin^2\theta", r"J = m\ell^2\sin^3\theta"),
    (r"J = m\ell^2\sin^2\theta", r"J = m\ell\sin^2\theta"),
    (r"J = m\ell^2\sin^2\theta", r"J = 2 m\ell^2\sin^2\theta"),
])  # fmt: skip
def test_a_constant_that_is_none_is_wrong_and_no_energy_with_it(
    right: str, slip: str, tmp_path: Path
) -> None:
    assert wrong_terms(tmp_path, SPHERICAL) == {}
    found = wrong_terms(tmp_path, SPHERICAL.replace(right, slip))
    changes = "3" in slip  # any multiple of the momentum is a constant of the motion
    assert [one.partition("=")[0] for one in found] == ["J"] * changes


PIVOT = r"""
$$x = x_0 + \ell\sin\theta,\qquad z = -\ell\cos\theta$$
$$T = \frac12 m(\dot x_0^2 + 2\ell\dot x_0\dot\theta\cos\theta + \ell^2\dot\theta^2),\qquad
  V = -m g\ell\cos\theta$$
$$\ell\ddot\theta + g\sin\theta + \ddot x_0\cos\theta = 0$$
"""


def test_energies_and_equations_are_not_accused_for_a_slip_in_a_position(tmp_path: Path) -> None:
    assert wrong_terms(tmp_path, PIVOT) == {}
    assert wrong_terms(tmp_path, PIVOT.replace(r"x_0 + \ell", r"x_0 - \ell")) == {}
    # an energy alone is
    slip = PIVOT.replace(r"+ 2\ell\dot x_0", r"- 2\ell\dot x_0")
    assert [*wrong_terms(tmp_path, slip).values()] == [
        r"-2\ell\dotx_0\dot\theta\cos\theta".replace(" ", "")
    ]


CART_POLE = r"""
$$(M + m)\ddot x + m l\ddot\theta\cos\theta - m l\dot\theta^2\sin\theta = F$$
$$l\ddot\theta + \ddot x\cos\theta - g\sin\theta = 0$$
With $\mathbf x = (x,\dot x,\theta,\dot\theta)^T$, $\dot{\mathbf x} = A\mathbf x + B F$,
$$A = \begin{pmatrix}0&1&0&0\\0&0&-\frac{m g}{M}&0\\0&0&0&1\\0&0&\frac{(M + m) g}{M l}&0
\end{pmatrix},\quad B = \begin{pmatrix}0\\\frac1M\\0\\-\frac1{M l}\end{pmatrix}$$
"""


def test_an_equation_is_not_accused_for_the_matrix_in_it(tmp_path: Path) -> None:
    assert wrong_terms(tmp_path, CART_POLE) == {}
    slip = CART_POLE.replace(r"- g\sin\theta", r"+ g\sin\theta")
    assert r"\dot{\mathbfx}=A\mathbfx+BF" not in wrong_terms(tmp_path, slip)
