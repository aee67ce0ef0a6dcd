"""Values and relations that documents state beside a motion, and terms of their Lagrangians."""

from dataclasses import replace
from pathlib import Path

import pytest
import sympy as sp

from derive.reading.document_formats import read_document
from derive.verification.documents.judgement import _with_general, judge_document
from derive.verification.documents.letters.implied_energies import potential_of
from derive.verification.documents.pages.verdicts_in_place import DocumentVerdicts, FormulaVerdict

CORRECT = {"verified", "definition"}


def judged(folder: Path, text: str) -> DocumentVerdicts:
    (folder / "a.md").write_text(text, encoding="utf-8")
    return judge_document(read_document(folder / "a.md"))


def verdicts(folder: Path, text: str) -> list[str]:
    return [one.verdict for one in judged(folder, text).formulas]


def wrong(folder: Path, text: str) -> list[FormulaVerdict]:
    return [one for one in judged(folder, text).formulas if one.verdict == "wrong"]


def test_relations_of_parameters_contradict_no_motion(tmp_path: Path) -> None:
    text = r"""A rod has the length $d$, and its centre the distance $b = d/2$ from the hinge. With
$$I = \frac13 m d^2$$
$$T = \frac12 I\dot\theta^2$$ $$V = -m g b\cos\theta$$
$$I\ddot\theta + m g b\sin\theta = 0$$"""
    assert verdicts(tmp_path, text) == ["definition"] * 2 + ["verified"] * 3


CHARGE = r"""
$$T = \frac{m}{2}(\dot x^2 + \dot y^2)$$ $$L = \frac{m}{2}(\dot x^2 + \dot y^2) + e B x\dot y$$
$$p_y = m\dot y + e B x$$ $$H = \frac{p_x^2}{2 m} + \frac{(p_y - e B x)^2}{2 m}$$
$$m\ddot x = e B\dot y$$
"""


@pytest.mark.long("other tests reach its code")
def test_lagrangians_can_have_terms_linear_in_velocities(tmp_path: Path) -> None:
    assert {*verdicts(tmp_path, CHARGE)} <= CORRECT
    found = verdicts(tmp_path, CHARGE.replace(r"\dot y + e B", r"\dot y - e B"))
    assert [k for k, one in enumerate(found) if one == "wrong"] == [2]


STATIC = r"""
$$T = \frac12 m(\dot x^2 + \dot y^2)$$ $$K = x^2 + y^2$$ $$V = \frac12 k K$$
$$L = \frac12 m(\dot x^2 + \dot y^2) - \frac12 k K + \frac12 e B(x\dot y - y\dot x)$$
$$m\ddot x = e B\dot y - k x$$
"""


@pytest.mark.long("other tests reach its code")
def test_a_potential_can_leave_terms_of_velocities_to_the_lagrangian(tmp_path: Path) -> None:
    assert {*verdicts(tmp_path, STATIC)} <= CORRECT  # K is no kinetic energy beside T
    assert verdicts(tmp_path, STATIC.replace("V = ", "V = 2"))[2] == "wrong"


def test_a_lagrangian_leaves_terms_of_its_energies_open(tmp_path: Path) -> None:
    text = r"""$$T = \frac12 m(\dot x^2 + 2 v\dot x + v^2)$$
    $$L = \frac12 m\dot x^2 + m v\dot x - \frac12 k x^2$$ $$m\ddot x + k x = 0$$"""
    assert verdicts(tmp_path, text) == ["context", "definition", "verified"]
    assert verdicts(tmp_path, text.replace("m(", "m(2"))[0] == "wrong"


DAMPED = r"""
$$T = \frac12 m\dot x^2$$ $$V = \frac12 k x^2 + \frac14 b x^4$$
With Rayleigh's function $$D = \frac12 c\dot x^2$$
$$\frac{d}{dt}\frac{\partial L}{\partial\dot x} - \frac{\partial L}{\partial x}
  + \frac{\partial D}{\partial\dot x} = M$$
$$Q_x = M - c\dot x$$ $$m\ddot x + c\dot x + k x + b x^3 = M$$
"""


@pytest.mark.parametrize("text", [DAMPED, DAMPED.replace(" - c\\dot x$", "$")])
def test_a_stated_force_can_contain_the_friction_of_a_function(tmp_path: Path, text: str) -> None:
    assert verdicts(tmp_path, text) == [*["definition"] * 3, "verified", "definition", "verified"]


@pytest.mark.long("other tests reach its code")
def test_a_function_of_friction_can_be_known_by_its_letter(tmp_path: Path) -> None:
    text = r"""$$T = \frac12 m_1\dot x_1^2 + \frac12 m_2\dot x_2^2$$
    $$V = \frac12 k_1 x_1^2 + \frac12 k_2 (x_2 - x_1)^2$$
    $$D = \frac12 b_1\dot x_1^2 + \frac12 b_2 (\dot x_2 - \dot x_1)^2$$
    $$m_2\ddot x_2 + b_2\dot x_2 - b_2\dot x_1 + k_2 x_2 - k_2 x_1 = 0$$
    $$m_1\ddot x_1 + (b_1 + b_2)\dot x_1 - b_2\dot x_2 + (k_1 + k_2) x_1 - k_2 x_2 = 0$$"""
    found = judged(tmp_path, text).formulas
    assert [one.verdict for one in found] == [*["definition"] * 3, *["verified"] * 2]
    assert not found[-1].note  # such as that these are forces without a meaning


def test_any_kinetic_energy_can_stand_beside_a_potential_energy_pi(tmp_path: Path) -> None:
    text = r"""$$E_k = \frac12 m\dot x^2$$ $$\Pi = \frac12 k x^2$$
    $$L = \frac12 m\dot x^2 - \frac12 k x^2$$ $$m\ddot x = -k x$$"""
    assert {*verdicts(tmp_path, text)} <= CORRECT


@pytest.mark.long("other tests reach its code")
def test_components_in_two_frames_are_no_positions(tmp_path: Path) -> None:
    text = r"""$$x' = x\cos\omega t + y\sin\omega t$$ $$y' = -x\sin\omega t + y\cos\omega t$$
    $$x = x'\cos\omega t - y'\sin\omega t$$ $$y = x'\sin\omega t + y'\cos\omega t$$
    Without the primes, $$\frac{\partial L}{\partial\dot x} = m(\dot x - \omega y)$$
    $$m\ddot x = 2 m\omega\dot y + m\omega^2 x - \frac{\partial V}{\partial x}$$
    $$m\ddot y = -2 m\omega\dot x + m\omega^2 y - \frac{\partial V}{\partial y}$$"""
    assert not wrong(tmp_path, text)


def test_logarithms_of_lengths_can_be_subtracted(tmp_path: Path) -> None:
    text = r"""$$T = \frac12 m(\dot r^2 + r^2\dot\phi^2)$$ $$V = k\ln r - k\ln a$$
    $$m\ddot r - m r\dot\phi^2 = -\frac{k}{r}$$ $$V = k\ln\frac{r}{a}$$"""
    assert not wrong(tmp_path, text)
    assert "dimensions" not in " ".join(one.note for one in judged(tmp_path, text).formulas)


SWUNG = r"""
$$T = \frac12 m(l^2\dot\phi^2 + 2 a l\gamma\cos(\gamma t)\dot\phi\cos\phi)$$
$$V = -m g l\cos\phi$$ $$p_\phi = m l^2\dot\phi + m a l\gamma\cos(\gamma t)\cos\phi$$
$$l\ddot\phi = a\gamma^2\sin(\gamma t)\cos\phi - g\sin\phi$$
"""


@pytest.mark.long("other tests reach its code")
def test_kinetic_energies_can_have_terms_linear_in_velocities(tmp_path: Path) -> None:
    assert {*verdicts(tmp_path, SWUNG)} <= CORRECT
    assert verdicts(tmp_path, SWUNG.replace("= a", "= -a"))[-1] == "wrong"


def test_a_limit_is_a_value_at_one_time(tmp_path: Path) -> None:
    text = r"""$$m\ddot x + 5 m\dot x + 6 m x = F$$
    $$x(t) = \frac16 - \frac12 e^{-2t} + \frac13 e^{-3t}$$ $$x(\infty) = \frac16$$"""
    assert judged(tmp_path, text).formulas[-1].note == "it states a value at one time"


def test_an_energy_at_a_place_is_a_value(tmp_path: Path) -> None:
    text = r"""$$T = \frac12 m l^2\dot\theta^2$$ With $V = 0$ at the hinge,
$$V = -m g l\cos\theta$$ $$l\ddot\theta + g\sin\theta = 0$$"""
    assert verdicts(tmp_path, text) == ["verified", "context", "verified", "verified"]


def test_an_angle_at_a_place_defines_no_angle(tmp_path: Path) -> None:
    text = r"""It hangs at $\phi = \pi$. With $$\phi = \beta + \pi$$
$$T = \frac12 m a^2\dot\beta^2$$ $$V = m g a\cos\phi$$ $$a\ddot\beta = -g\sin\beta$$"""
    assert verdicts(tmp_path, text) == ["context", "definition", *["verified"] * 3]
    text = r"""It hangs at $\phi = \pi$. $$m\ddot\phi = m g\sin\phi$$ $$\ddot\phi = -g\sin\phi$$"""
    assert verdicts(tmp_path, text).count("verified") < 2


def test_a_length_l_beside_a_difference_of_energies(tmp_path: Path) -> None:
    text = r"""With $L = 2b$, $$I = \frac13 m L^2 = \frac43 m b^2$$
$$T = \frac12 I\dot\theta^2$$ $$V = -m g b\cos\theta$$ $$L = T - V$$"""
    assert {*verdicts(tmp_path, text)} <= CORRECT


def test_a_difference_of_lengths_is_a_factor(tmp_path: Path) -> None:
    text = r"""$$L = T - V$$ $$T = \frac12 m\dot r^2$$
$$V = m g (L - r)\sin\alpha + \frac12 k r^2$$
$$\frac{\partial L}{\partial r} = m g\sin\alpha - k r$$ $$m\ddot r = m g\sin\alpha - k r$$"""
    assert {*verdicts(tmp_path, text)} <= CORRECT
    assert verdicts(tmp_path, text.replace("= m g\\sin", "= -m g\\sin", 1))[3] == "wrong"


ATWOOD = r"""
$$T = \frac12 (m_1 + m_2)\dot x^2$$ $$V = -m_1 g x - m_2 g (l - x)$$
$$E = \frac12 (m_1 + m_2)\dot x^2 - m_1 g x - m_2 g (l - x)$$
$$(m_1 + m_2)\ddot x = (m_1 - m_2) g$$
"""


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("text", [
    ATWOOD, "$$s = l - x$$" + ATWOOD.replace("(l - x)$$ ", "s$$ "),
])  # fmt: skip
def test_a_length_can_add_a_constant_to_the_energies_of_a_known_system(
    tmp_path: Path, text: str
) -> None:
    assert {*verdicts(tmp_path, text)} <= {*CORRECT, "equivalent"}
    assert verdicts(tmp_path, text.replace("x^2 - m_1", "x^2 + m_1"))[-2] == "wrong"


EXPONENTIAL = r"""
$$T = \frac12 m\dot x^2 \left(1 + \frac{b^2}{a^2} e^{-2x/a}\right)$$ $$V = m g b e^{-x/a}$$
$$\frac{\partial V}{\partial x} = -\frac{m g b}{a} e^{-x/a}$$
$$\ddot x\left(1 + \frac{b^2}{a^2} e^{-2x/a}\right) - \frac{b^2}{a^3}\dot x^2 e^{-2x/a}
  - \frac{g b}{a} e^{-x/a} = 0$$
"""


@pytest.mark.long("other tests reach its code")
def test_powers_of_e_are_exponentials(tmp_path: Path) -> None:
    assert {*verdicts(tmp_path, EXPONENTIAL)} <= CORRECT
    (one,) = wrong(tmp_path, EXPONENTIAL.replace(r"{a^3}\dot x^2", r"{a^3} 2\dot x^2"))
    assert r"\ddot x" in one.latex


def test_terms_can_be_neglected(tmp_path: Path) -> None:
    text = r"""$$T = \frac12 m\dot r^2$$ $$V = \frac12 k r^2 - 2 m g r$$ $$L = T - V$$
$$m\ddot r = 2 m g - k r$$ Without the spring this simplifies to $$\ddot r = 2 g$$"""
    assert verdicts(tmp_path, text)[-1] == "context"


MODES = r"""$$T = \frac12 m(\dot x^2 + \dot y^2)$$ $$V = \frac12 k(x^2 + y^2) + \frac12 c(x - y)^2$$
Modes have $\omega = \sqrt{(k + 2 c)/m}$ or $\omega = \sqrt{k/m}$."""


@pytest.mark.long("other tests reach its code")
def test_one_letter_can_be_the_frequency_of_several_modes(tmp_path: Path) -> None:
    assert {*verdicts(tmp_path, MODES)} <= CORRECT


HOIST = r"""## First
$$T = \frac12 m l^2\dot\theta^2$$ $$U = -m g l\cos\theta$$ $$l\ddot\theta = -g\sin\theta$$
## Second
### Choice
$$y_1 + y_2 = \text{const} \quad\Rightarrow\quad y_2 = c - y_1$$
### Energies
$$T = \frac12 (m_1 + m_2)\dot y_1^2$$
$$U = -m_1 g y_1 - m_2 g y_2 = -m_1 g y_1 - m_2 g (c - y_1)$$
### Lagrangian
$$\mathcal{L} = \frac12 (m_1 + m_2)\dot y_1^2 + m_1 g y_1 + m_2 g (c - y_1)$$
$$(m_1 + m_2)\ddot y_1 = (m_1 - m_2) g$$
"""


def test_an_example_begins_with_the_relations_before_its_energies(tmp_path: Path) -> None:
    assert {*verdicts(tmp_path, HOIST)} <= {*CORRECT, "equivalent"}


DRIVEN = r"""$$J = \frac12 M r^2$$
$$T = \frac12 (m + J/r^2)\dot x^2$$ $$V = \frac12 k x^2$$
$$L = T - V = \frac12 (m + J/r^2)\dot x^2 - \frac12 k x^2$$
$$(m + J/r^2)\ddot x + k x = \frac{\tau}{r}$$
"""


@pytest.mark.long("other tests reach its code")
def test_a_slip_beside_a_load_is_found(tmp_path: Path) -> None:
    assert {*verdicts(tmp_path, DRIVEN)} <= CORRECT
    one = judged(tmp_path, DRIVEN.replace("+ k x", "- k x")).formulas[-1]
    assert (one.verdict, one.wrong_term) == ("wrong", "- k x")


ORBIT = r"""$$L = \frac12 m(\dot r^2 + r^2\dot\phi^2) + \frac{k}{r}$$ $$l = m r^2\dot\phi$$
$$E = \frac12 m\dot r^2 + \frac{l^2}{2 m r^2} - \frac{k}{r}$$
$$V_{eff} = \frac{l^2}{2 m r^2} - \frac{k}{r}$$
$$\dot r = \sqrt{\frac{2}{m}\left(E - V_{eff}\right)}$$
"""


def test_an_effective_potential_has_the_energy_of_conserved_momenta(tmp_path: Path) -> None:
    assert {*verdicts(tmp_path, ORBIT)} <= CORRECT
    found = verdicts(tmp_path, ORBIT.replace(r"eff} = \frac{l^2}{2 m", r"eff} = \frac{l^2}{m"))
    assert [k for k, one in enumerate(found) if one == "wrong"] == [3]


PULLEY = r"""$$x_1 + x_2 = c$$ $$\omega = \frac{\dot x_1}{R}$$
$$T = \frac12 m_1\dot x_1^2 + \frac12 m_2\dot x_2^2 + \frac12 I\omega^2$$
$$V = -m_1 g x_1 - m_2 g x_2$$
$$L = \frac12 (m_1 + m_2 + \frac{I}{R^2})\dot x_1^2 + (m_1 - m_2) g x_1$$
$$(m_1 + m_2 + \frac{I}{R^2})\ddot x_1 = (m_1 - m_2) g$$
"""


def test_a_relation_of_coordinates_gives_one_of_them(tmp_path: Path) -> None:
    assert {*verdicts(tmp_path, PULLEY)} <= {*CORRECT, "equivalent"}
    found = verdicts(tmp_path, PULLEY.replace("(m_1 - m_2) g$$", "(m_1 + m_2) g$$"))
    assert [k for k, one in enumerate(found) if one == "wrong"] == [5]


MOVING_SUPPORT = r"""
$$x = b\cos(\nu t) + l\sin\phi, \qquad y = -l\cos\phi$$
$$\mathcal{L} = T - V$$
$$T = \frac12 m(\dot x^2 + \dot y^2), \qquad V = m g y$$
$$L = \frac12 m l^2\dot\phi^2 + m b l\nu^2\cos(\nu t)\sin\phi + m g l\cos\phi$$
"""


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(("new", "verdict"), [("+ m b l", "equivalent"), ("- m b l", "wrong")])
def test_a_plain_letter_of_velocities_is_a_lagrangian_too(
    new: str, verdict: str, tmp_path: Path
) -> None:
    text = MOVING_SUPPORT.replace("+ m b l", new)
    assert judged(tmp_path, text).formulas[-1].verdict == verdict


TURNING_FRAME = r"""
In a frame that turns at $\omega$,
$$x' = x\cos\omega t + y\sin\omega t, \qquad y' = -x\sin\omega t + y\cos\omega t$$
and we leave the primes out:
$$m\ddot x = 2 m\omega\dot y + m\omega^2 x$$
$$m\ddot y = -2 m\omega\dot x + m\omega^2 y$$
"""


@pytest.mark.long("other tests reach its code")
def test_coordinates_of_another_frame_are_no_positions(tmp_path: Path) -> None:
    assert wrong(tmp_path, TURNING_FRAME) == []


THREAD = r"""
A pendulum has $$x = l\sin\phi, \qquad y = -l\cos\phi$$
Two masses on a thread have $$x + y = \text{const}, \qquad \dot y = -\dot x$$
$$T = \frac12 m_1\dot x^2 + \frac12 m_2\dot y^2 = \frac12 (m_1 + m_2)\dot x^2$$
$$V = -m_1 g x - m_2 g y = -(m_1 - m_2) g x + \text{const}$$
$$L = \frac12 (m_1 + m_2)\dot x^2 + (m_1 - m_2) g x$$
$$(m_1 + m_2)\ddot x = (m_1 - m_2) g$$
$$\ddot x = \frac{m_1 - m_2}{m_1 + m_2} g$$
"""


@pytest.mark.long("other tests reach its code")
def test_two_letters_of_one_relation_are_no_names_of_one_coordinate(tmp_path: Path) -> None:
    assert wrong(tmp_path, THREAD) == []


WIRE = r"""
On a wire $z = \frac12 a r^2$ that turns at $\Omega$,
$$T = \frac12 m\left((1 + a^2 r^2)\dot r^2 + r^2\Omega^2\right), \qquad V = \frac12 m g a r^2$$
$$\frac{\partial T}{\partial \dot r} = m(1 + a^2 r^2)\dot r$$
$$(1 + a^2 r^2)\ddot r + a^2 r\dot r^2 - r\Omega^2 + a g r = 0$$
At the speed $\Omega^2 = a g$ it rests anywhere.
"""


def test_a_critical_speed_does_not_define_the_speed(tmp_path: Path) -> None:
    assert wrong(tmp_path, WIRE) == []
    (one,) = wrong(tmp_path, WIRE.replace("+ a g r", "+ 2 a g r"))
    assert one.correction.endswith("+ a g r = 0")


@pytest.mark.long("other tests reach its code")
def test_a_square_of_an_abbreviation_is_no_special_case(tmp_path: Path) -> None:
    # the equation is compared near x = l as well, where most digits cancel
    text = r"""
$$u = \sqrt{l^2 - x^2}$$ $$T = \frac12 m(\dot x^2 + \frac{x^2\dot x^2}{u^2}), \quad V = m g u$$
$$u^2 = l^2 + x^2$$
$$\frac{l^2\ddot x}{u^2} + \frac{l^2 x\dot x^2}{u^4} - \frac{g x}{u} = 0$$"""
    assert verdicts(tmp_path, text) == [*["definition"] * 3, "wrong", "verified"]
    (one,) = wrong(tmp_path, text)
    assert one.correction == "u^2 = l^2 - x^2"


SUBSTITUTED = r"""
$$T = \frac12 m (b - a)^2\dot\theta^2 + \frac14 m a^2\dot\psi^2, \qquad V = -m g (b - a)\cos\theta$$
It rolls: $$(b - a)\dot\theta - a\dot\psi = 0$$
With a multiplier,
$$m (b - a)^2\ddot\theta + m g (b - a)\sin\theta = (b - a)\lambda$$
$$\frac12 m a^2\ddot\psi = -a\lambda$$
Without $\psi$,
$$L = \frac34 m (b - a)^2\dot\theta^2 + m g (b - a)\cos\theta$$
$$\frac{\partial L}{\partial\dot\theta} = \frac32 m (b - a)^2\dot\theta$$
$$\frac32 (b - a)\ddot\theta = -g\sin\theta$$
"""


def test_constraints_of_positions_can_be_substituted_into_a_lagrangian(tmp_path: Path) -> None:
    right = judged(tmp_path, SUBSTITUTED).formulas
    assert [one.verdict for one in right][-3:] == ["verified"] * 3
    # the formulas after a slip follow from the right Lagrangian
    (only,) = wrong(tmp_path, SUBSTITUTED.replace(r"\frac34", r"\frac54"))
    assert only.latex.startswith("L =")
    assert r"\frac{3}{4} m (b - a)^2" in only.correction


@pytest.mark.long("the same Lagrangian with all velocities")
def test_a_lagrangian_that_keeps_dependent_velocities_is_corrected_with_them(
    tmp_path: Path,
) -> None:
    whole = (
        r"$$L = \frac12 m (b - a)^2\dot\theta^2 + \frac12 m a^2\dot\psi^2"
        r" + m g (b - a)\cos\theta$$"
    )
    (only,) = wrong(tmp_path, SUBSTITUTED.partition("Without")[0] + whole)
    assert r"+ \frac{a^2 m \dot\psi^2}{4} +" in only.correction


SCALED = r"""
Measured from the other side, the angle is $\beta = \pi - \theta$.
$$\tilde L = \frac12(\dot\beta^2 + \dot\varphi^2\sin^2\beta) + \frac gl\cos\beta$$
$$p_\varphi = \dot\varphi\sin^2\beta$$
It rests for $\beta = 0,\pi,\,\dot\beta = 0$, and swings in a plane if $p_\varphi = 0$.
$$h = \frac12\dot\beta^2 + U(\beta)$$
$$U(\beta) = \frac{p_\varphi^2}{2\sin^2\beta} - \frac gl\cos\beta$$
"""


@pytest.mark.long("other tests reach its code")
def test_a_momentum_can_be_that_of_a_scaled_lagrangian(tmp_path: Path) -> None:
    assert wrong(tmp_path, SCALED) == []


def test_of_two_equal_components_of_a_position_either_can_be_wrong(tmp_path: Path) -> None:
    text = r"""$$x = l\cos\theta, \qquad y = -l\cos\theta$$
$$T = \frac12 m l^2\dot\theta^2, \qquad V = -m g l\cos\theta$$
$$l\ddot\theta + g\sin\theta = 0$$"""
    first, second, *others = judged(tmp_path, text).formulas
    assert {one.verdict for one in others} == {"verified"}
    assert {one.verdict for one in (first, second)} == {"context"}
    assert "contradicts another component of the position" in first.note


ROD = r"""
$$K = \frac12 m l^2\dot\theta^2$$
$$P = m g l\sin\theta$$
"""


def test_numbers_of_products_of_parameters_are_values(tmp_path: Path) -> None:
    text = ROD + r"The rod has $m l = 0.025$ and $\frac{g}{l} = 39.2$."
    assert wrong(tmp_path, text) == []


def test_a_height_of_zero_at_one_place_is_no_definition(tmp_path: Path) -> None:
    text = ROD + r"With $P_g = m g h = m g l\sin\theta$, and $h = 0$ at the pivot."
    assert wrong(tmp_path, text) == []


FORCED = r"""
$$T = \frac12 m\dot x^2 + \frac12 M\dot y^2$$ $$V = \frac12 k (x - y)^2$$
$$\frac{d}{dt}\frac{\partial L}{\partial\dot x} - \frac{\partial L}{\partial x} = Q_x$$
$$\frac{d}{dt}\frac{\partial L}{\partial\dot y} - \frac{\partial L}{\partial y} = Q_y$$
$$Q_x = F$$ $$Q_y = -F R$$
"""


@pytest.mark.long("other tests reach its code")
def test_a_generalized_force_is_stated(tmp_path: Path) -> None:
    assert wrong(tmp_path, FORCED) == []


PHASE_CURVE = r"""
$$\mathcal{L} = \frac12 m l^2\dot\theta^2 - m g l(1 - \cos\theta)$$
$$\ddot\theta + \frac gl\sin\theta = 0$$
$$E = \frac12 m l^2\dot\theta^2 + m g l(1 - \cos\theta)$$
$$\dot\theta = \sqrt{\frac{2}{m l^2}\left[E - m g l(1 - \cos\theta)\right]}$$
"""


def test_the_constant_of_an_energy_is_that_of_the_document(tmp_path: Path) -> None:
    assert wrong(tmp_path, PHASE_CURVE) == []
    (one,) = wrong(tmp_path, PHASE_CURVE.replace(r"E = \frac12", "E = "))
    assert one.latex.startswith("E =")


ONE_SPRING_LESS = r"""
$$T = \frac12 m_1\dot x_1^2 + \frac12 m_2\dot x_2^2$$
$$V = \frac12 k_1 x_1^2 + \frac12 k_2 (x_2 - x_1)^2$$
$$m_1\ddot x_1 + (b_1 + b_2)\dot x_1 - b_2\dot x_2 + (k_1 + k_2) x_1 - k_2 x_2 = 0$$
$$m_2\ddot x_2 + b_2\dot x_2 - b_2\dot x_1 + k_2 x_2 - k_2 x_1 = 0$$
$$M = \begin{bmatrix} m_1 & 0 \\ 0 & m_2 \end{bmatrix}$$
$$K = \begin{bmatrix} k_1 + k_2 & -k_2 \\ -k_2 & k_2 \end{bmatrix}$$
With three springs, $$G(s) = \frac{b s + k_2}{m_1 m_2 s^4 + k_1 k_2 + k_1 k_3 + k_2 k_3}$$
With one mass, $$20\ddot x + 5\dot x + 16 x = f(t)$$
"""


@pytest.mark.long("other tests reach its code")
def test_a_letter_of_formulas_that_are_not_judged_is_no_parameter(tmp_path: Path) -> None:
    assert wrong(tmp_path, ONE_SPRING_LESS) == []


TWO_CASES = r"""
With a rigid rod, $r = L$,
$$K = \frac12 m L^2\dot\theta^2$$
$$L\ddot\theta + g\sin\theta = 0$$
With an elastic one,
$$K = \frac12 m(\dot r^2 + r^2\dot\theta^2), \qquad U = -m g r\cos\theta + \frac12 k (r - L)^2$$
$$\ddot r - r\dot\theta^2 - g\cos\theta + \frac km (r - L) = 0$$
$$r\ddot\theta + 2\dot r\dot\theta + g\sin\theta = 0$$
"""


def test_an_energy_that_is_stated_again_is_that_of_another_case(tmp_path: Path) -> None:
    assert wrong(tmp_path, TWO_CASES) == []


def test_forces_have_a_potential_whatever_factors_their_quotients_have_in_common() -> None:
    x, a = sp.symbols("x a")
    factor = a**2 * x**2 + 1
    slope = sp.expand(sp.expand((x + x**2) * factor) / sp.expand(factor))
    assert potential_of([slope], [x]) == x**2 / 2 + x**3 / 3


@pytest.mark.long("other tests reach its code")
def test_a_function_of_coordinates_alone_is_no_momentum(tmp_path: Path) -> None:
    results = verdicts(tmp_path, r"""
$$ x = R \sin q, \qquad y = -R \cos q $$
$$ K = \frac{1}{2} g^2 m \dot q^2 $$
$$ P = -\frac{1}{2} m \Omega^2 R^2 \sin^2 q - m g R \cos q $$
$$ m R^2 \ddot q - m \Omega^2 R^2 \sin q \cos q + m g R \sin q = 0 $$
$$ \ddot q = \Omega^2 \sin q \cos q - \frac{g}{R} \sin q $$
""")  # fmt: skip
    assert results[3] != "wrong"
    assert results[4:] == ["verified", "verified"]


@pytest.mark.long("other tests reach its code")
def test_a_constant_in_an_abbreviation_of_the_potential_stands_for_itself(tmp_path: Path) -> None:
    text = r"""
$$ \sigma = - g m_1 x - g m_2 (l - x), \qquad V = \sigma $$
$$ T = \frac{1}{2} (m_1 + m_2) \dot x^2 $$
$$ L = \frac{1}{2} (m_1 + m_2) \dot x^2 + g l m_2 + g m_1 x - g m_2 x $$
$$ m_1 \ddot x + m_2 \ddot x - g m_1 + g m_2 = 0 $$
$$ H = \frac{p_x^2}{2 (m_1 + m_2)} - g l m_2 - g (m_1 - m_2) x $$
$$ \dot p_x = -\frac{\partial H}{\partial x} = g \left(m_1 - m_2\right) $$
"""
    assert {*verdicts(tmp_path, text)} <= {"definition", "verified", "equivalent"}
    assert judged(tmp_path, text).formulas[-1].note == ""


def test_potentials_of_central_forces_are_found_and_of_others_are_not() -> None:
    x, y, a, k = sp.symbols("x y a k", real=True)
    square = (x - a) ** 2 + y**2
    for power in (2, 3, 5):
        distance = square ** sp.Rational(power, 2)
        gradient = [k * (x - a) / distance, k * y / distance]
        V = potential_of(gradient, [x, y])
        assert V is not None
        for q, slope in zip((x, y), gradient, strict=True):
            assert abs((V.diff(q) - slope).subs({x: 2, y: 3, a: 5, k: 7}).evalf(30)) < 1e-25
        assert potential_of([gradient[0], 2 * gradient[1]], [x, y]) is None


#: Masses between springs, then equal ones.
EQUAL = r"""
$$m_1\ddot x_1 = -k_1 x_1 + k_2(x_2 - x_1)$$
$$m_2\ddot x_2 = -k_2(x_2 - x_1) - k_3 x_2 = k_2 x_1 - (%s + k_3) x_2$$
$$m_1\ddot x_1 + m_2\ddot x_2 = -k_1 x_1 - k_3 x_2$$
Let %s and $k_1 = k_2 = k_3 = k$, so that
$$m\ddot x_1 = -2 k x_1 + k x_2$$ $$m\ddot x_2 = k x_1 - 2 k x_2$$"""


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("masses", ["$m_1 = m_2 = m$", "$m_1 = m$, $m_2 = m$"])
def test_formulas_before_equal_parameters_hold_for_any(masses: str, tmp_path: Path) -> None:
    right = judged(tmp_path, EQUAL % ("k_2", masses)).formulas
    assert {one.verdict for one in right} == {"definition", "verified"}
    found = judged(tmp_path, EQUAL % ("k_1", masses)).formulas
    assert [one.correction for one in found if one.verdict == "wrong"] == [right[1].latex]
    assert [one.verdict for one in found].count("wrong") == 1


def test_a_part_before_equal_parameters_of_which_less_holds_refutes_nothing(
    tmp_path: Path,
) -> None:
    document = judged(tmp_path, EQUAL % ("k_2", "$m_1 = m_2 = m$"))
    kinds = ("wrong", "verified", "wrong")
    pairs = zip(document.formulas[:3], kinds, strict=True)
    parts = tuple(replace(one, verdict=kind) for one, kind in pairs)
    assert _with_general(document, replace(document, formulas=parts)) == document
    held = replace(document, formulas=parts[:2])
    assert _with_general(document, held).formulas == (parts[0], *document.formulas[1:])


def test_an_interval_is_no_row(tmp_path: Path) -> None:
    text = r"""$$T = \frac12 m\dot r^2$$ $$V = \frac12 k r^2$$ $$m r^2\ddot r = -k r^3$$
for $r \in [a, 2a]$."""
    assert verdicts(tmp_path, text)[:3] == ["verified"] * 3


def test_a_definition_is_not_verified_beside_a_side_that_is_not_judged(tmp_path: Path) -> None:
    text = r"""$$V_g = m g z = -m g s\sin\alpha$$
$$L = \frac12 m(\dot s^2 + s^2\sin^2\alpha\,\dot\phi^2) + m g s\cos\alpha$$
$$m\ddot s = m s\sin^2\alpha\,\dot\phi^2 + m g\cos\alpha$$"""
    (tmp_path / "a.md").write_text(text, encoding="utf-8")
    first, *_ = judge_document(read_document(tmp_path / "a.md")).formulas
    assert first.verdict == "definition"
    assert first.note == "the side with z is not judged"
