"""Systems with constraints, linearised: the free components of the state are those of mechanics."""

import numpy as np
import pytest
import sympy as sp
from constrained_systems import pinned, sleigh, swing

from derive import Coordinate, Derivation, Parameter, PointMass, System, load
from holonomic import build, equilibria, linearise

BOX = {"x": (-1.0, 1.1), "y": (-1.0, 1.1)}


@pytest.mark.parametrize("make", [swing, pinned])
def test_frequencies_are_those_of_the_pendulum(make: object) -> None:
    one = build(make())  # type: ignore[operator]
    below, above = equilibria(one, {}, BOX)
    rate = np.sqrt(9.81 / 0.8)
    assert below.A.shape == (2, 2)
    assert (below.stability, above.stability) == ("neutral", "unstable")
    assert below.modes[0].frequency == pytest.approx(rate / (2 * np.pi), rel=1e-12)
    assert sorted(above.eigenvalues.real) == pytest.approx([-rate, rate], rel=1e-12)
    assert {*below.states} < {*one.STATE}
    x, y, *_ = below.modes[0].shape
    assert abs(y) < 1e-9 * abs(x)


def test_free_components_determine_the_others() -> None:
    # oracle: a small change of the angle of the pendulum
    one, angle, small = build(pinned()), 0.7, 1e-6

    def state(theta: float, rate: float) -> np.ndarray:
        s, c = np.sin(theta), np.cos(theta)
        return np.array([0.8 * s, -0.8 * c, theta, 0.8 * c * rate, 0.8 * s * rate, rate])

    linear = linearise(one, state(angle, 1.5), {})
    rows = [one.STATE.index(name) for name in linear.states]
    for change in ((small, 0.0), (0.0, small)):
        ends = [state(angle + s * change[0], 1.5 + s * change[1]) for s in (-1, 1)]
        difference = (ends[1] - ends[0]) / 2
        assert np.allclose(linear.tangent @ difference[rows], difference, atol=1e-12)
        rates = (np.subtract(*(one.rhs(0.0, end, one.DEFAULTS) for end in ends[::-1]))) / 2
        assert np.allclose(linear.A @ difference[rows], rates[rows], atol=1e-10)


def test_a_sleigh_runs_straight_with_the_centre_of_mass_ahead() -> None:
    # oracle: omega' = -m a v omega/(I + m a²), v' = a omega² + F/m (S. A. Chaplygin, 1911)
    one, v = build(sleigh()), 1.5
    for speed, word in ((v, "neutral"), (-v, "unstable")):
        linear = linearise(one, {"x_dot": speed}, {})
        values = sorted(linear.eigenvalues.real, key=abs)
        assert linear.A.shape == (5, 5)
        assert values[-1] == pytest.approx(-2.0 * 0.3 * speed / (0.1 + 2.0 * 0.3**2), rel=1e-12)
        assert np.abs(values[:-1]).max() < 1e-6
        assert linear.stability == word
    assert linear.B[linear.states.index("x_dot"), 0] == pytest.approx(1 / 2.0, rel=1e-12)


def test_systems_with_conditions_have_no_small_oscillations() -> None:
    assert Derivation(load("single_pendulum")).is_linearisable
    assert not Derivation(load("four_bar")).is_linearisable


def test_violated_constraints_are_refused() -> None:
    with pytest.raises(ValueError, match="does not satisfy the constraints of swing"):
        linearise(build(swing()), {"x": 0.5, "y": 0.1}, {})


def test_a_spring_pulls_a_bead_to_the_end_of_an_ellipse() -> None:
    # oracle: the ends of the axes are the equilibria; frequencies by the curvature there
    x, y = sp.symbols("x y", real=True)
    m, k = sp.symbols("m k", positive=True)
    q = [Coordinate(x, "m", "to the right"), Coordinate(y, "m", "upwards")]
    bead = System("bead", "Bead on an ellipse", q, [Parameter(m, "kg", 1.0, "mass"),
        Parameter(k, "N/m", 2.0, "stiffness")], [PointMass(m, (x, y))],
        potential=k * (x**2 + y**2) / 2, constraints=[x**2 / 4 + y**2 - 1])  # fmt: skip
    box = {"x": (-2.5, 2.6), "y": (-1.5, 1.6)}
    found = {tuple(np.round(e.y[:2], 9) + 0.0): e for e in equilibria(build(bead), {}, box)}
    assert {*found} == {(2.0, 0.0), (-2.0, 0.0), (0.0, 1.0), (0.0, -1.0)}
    # at (0, 1): y = 1 - x²/8, V = k (x² - x²/4)/2
    rate = np.sqrt(2.0 * 0.75) / (2 * np.pi)
    assert found[0.0, 1.0].modes[0].frequency == pytest.approx(rate, rel=1e-9)
    assert found[2.0, 0.0].stability == "unstable"
