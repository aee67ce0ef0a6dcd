"""Linearisation and equilibria in symbols with constraints: as in numbers, and without them."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from constrained_systems import bars, lifted, pinned, sleigh, swing
from numpy.testing import assert_allclose

from derive import Coordinate, Derivation, Parameter, PointMass, System, load
from derive.system.parts import SystemDefinitionError
from holonomic import build, linearise

Make = Callable[[], System]
x1, y1, x2, y2, g = sp.symbols("x1 y1 x2 y2 g", real=True)
m1, m2, l1, l2 = sp.symbols("m1 m2 l1 l2", positive=True)


def rods() -> System:
    """Two masses on two rods, by their positions."""
    return System("rods", "Double pendulum by its positions",
        [Coordinate(s, "m", "position") for s in (x1, y1, x2, y2)],
        load("double_pendulum").parameters, [PointMass(m1, (x1, y1)), PointMass(m2, (x2, y2))],
        constraints=[x1**2 + y1**2 - l1**2, (x2 - x1)**2 + (y2 - y1)**2 - l2**2])  # fmt: skip


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(
    ("make", "point"),
    [
        (swing, {"y": "-l"}),
        (swing, {"x": "3*l/5", "y": "-4*l/5", "x_dot": "4/5", "y_dot": "3/5"}),
        (pinned, {"x": "l*sin(1/2)", "y": "-l*cos(1/2)", "theta": "1/2"}),
        (sleigh, {"x_dot": 1.5, "theta_dot": 2}),
        (sleigh, {"theta": 0.4, "F": 3}),
        (bars, {"y1": "-l1/2", "y2": "-l1 - l2/2"}),
    ],
)
def test_numbers_are_those_of_the_generated_jacobian(make: Make, point: dict[str, object]) -> None:
    system = replace(make(), keep_coordinates=True)
    space, one = Derivation(system).state_space(point), build(system)
    defaults = {p.symbol: p.default for p in system.parameters}
    values = {s.name: float(value.subs(defaults)) for s, value in space.point.items()}
    inputs = {s.name: values.pop(s.name) for s in system.u}
    linear = linearise(one, values, {}, inputs=inputs)
    assert space.states == linear.states
    for symbolic, number in zip(space.numbers(), (linear.A, linear.B, linear.C, linear.D),
                                strict=True):  # fmt: skip
        assert_allclose(np.reshape(symbolic, number.shape), number, atol=1e-12)
    assert_allclose([float(x.subs(defaults)) for x in space.rate], linear.rate, atol=1e-12)


def test_bars_by_their_positions_are_the_double_bar_pendulum() -> None:
    hanging = {"y1": "-l1/2", "y2": "-l1 - l2/2"}
    space = Derivation(bars()).state_space(hanging, outputs=["theta1", "theta2"])
    angles = space.C[:, :2]  # by the independent coordinates
    both = sp.diag(angles, angles)
    expected = Derivation(load("double_bar_pendulum")).state_space().A
    assert sp.simplify(both * space.A * both.inv() - expected).is_zero_matrix


@pytest.mark.long("equilibria in symbols with two constraints")
def test_the_rods_of_a_double_pendulum_have_its_equilibria_and_oscillations() -> None:
    d = Derivation(rods())
    found = d.equilibria()
    assert {(e[y1], e[y2]) for e in found} == {
        (a * l1, a * l1 + b * l2) for a in (1, -1) for b in (1, -1)
    }
    assert all(e[x1] == e[x2] == 0 for e in found)
    linear = d.linearisation((0, -l1, 0, -l1 - l2))
    assert linear.states == ("x1", "x2")
    assert linear.tangent == sp.Matrix([[1, 0], [0, 0], [0, 1], [0, 0]])
    arms = sp.Matrix([[l1, 0], [l1, l2]])  # x = l1 theta1, l1 theta1 + l2 theta2
    expected = Derivation(load("double_pendulum")).linearisation()
    for own, other in zip((linear.mass_matrix, linear.stiffness_matrix),
                          (expected.mass_matrix, expected.stiffness_matrix),
                          strict=True):  # fmt: skip
        assert sp.simplify(arms.T * own * arms - other).is_zero_matrix
    upright = d.state_space({"y1": "l1", "y2": "l1 + l2"})
    other = Derivation(load("double_pendulum")).state_space({"theta1": "pi", "theta2": "pi"})
    both = sp.diag(arms, arms)
    assert sp.simplify(both.inv() * upright.A * both - other.A).is_zero_matrix


def test_a_sleigh_has_chaplygin_s_exponent_at_any_speed() -> None:
    # S. A. Chaplygin (1911): omega' = -m a v omega/(I + m a²)
    d = Derivation(sleigh())
    space = d.state_space({"x_dot": "x_dot"})
    m, a, inertia = sleigh().params[:3]
    v = sleigh().qdot[0]
    assert space.states == ("x", "y", "theta", "x_dot", "theta_dot")
    rates = {value: n for value, n in space.A.eigenvals().items() if value != 0}
    (rate,) = rates
    assert sp.simplify(rate + m * a * v / (inertia + m * a**2)) == 0
    x, y, theta = sleigh().q
    assert d.equilibria({"F": 0}) == [{x: x, y: y, theta: theta}]
    assert [e[theta] for e in d.equilibria({"F": 0, "x_dot": 2})] == [0, sp.pi]
    assert d.equilibria() == []  # a thrust that is not 0


def test_a_bead_on_an_ellipse_rests_at_the_ends_of_its_axes() -> None:
    x, y = sp.symbols("x y", real=True)
    m, k = sp.symbols("m k", positive=True)
    bead = System("bead", "Bead on an ellipse",
        [Coordinate(x, "m", "to the right"), Coordinate(y, "m", "upwards")],
        [Parameter(m, "kg", 1.0, "mass"), Parameter(k, "N/m", 2.0, "stiffness")],
        [PointMass(m, (x, y))], potential=k * (x**2 + y**2) / 2,
        constraints=[x**2 / 4 + y**2 - 1])  # fmt: skip
    d = Derivation(bead)
    assert {(e[x], e[y]) for e in d.equilibria()} == {(2, 0), (-2, 0), (0, 1), (0, -1)}
    # at (0, 1): y = 1 - x²/8, V = k (x² - x²/4)/2
    assert d.linearisation((0, 1)).stiffness_matrix == sp.Matrix([[3 * k / 4]])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Derivation(swing()).state_space({"x": "l/2"}), "violates constraint rod"),
        (lambda: Derivation(swing()).state_space({"y": "-l", "y_dot": 1}), "violates the rate"),
        (lambda: Derivation(swing()).linearisation((0, 1)), r"Derivation\.equilibria\(\)"),
        (lambda: Derivation(swing()).linearisation((l1, 0)), "violates constraint rod"),
        (lambda: Derivation(sleigh()).linearisation(), r"applied forces.*Derivation\.state_space"),
        (lambda: Derivation(lifted()).linearisation(), "depend on time"),
        (
            lambda: Derivation(swing()).identifiable(),
            "constraints, rod: identifiable .* write positions",
        ),
    ],
)
def test_other_points_are_refused(call: Callable[[], object], message: str) -> None:
    with pytest.raises(SystemDefinitionError, match=message):
        call()


def test_an_inclined_rod_is_no_equilibrium() -> None:
    length = next(s for s in swing().params if s.name == "l")
    with pytest.raises(SystemDefinitionError, match=r"force along .* is .*g"):
        Derivation(swing()).linearisation((3 * length / 5, -4 * length / 5))


def test_constraints_that_depend_on_each_other_at_a_point_are_refused() -> None:
    # a straight line of three points, of which the outer ones are fixed: a toggle
    ends = [x1**2 + y1**2 - l1**2, (x1 - 2 * l1) ** 2 + y1**2 - l2**2]
    toggle = System("toggle", "Two rods", [Coordinate(s, "m", "position") for s in (x1, y1, x2)],
        [Parameter(m1, "kg", 1.0, "mass"), Parameter(l1, "m", 1.0, "rod"),
         Parameter(l2, "m", 1.5, "rod"), Parameter(g, "m/s^2", 9.81, "gravity")],
        [PointMass(m1, (x1, y1)), PointMass(m1, (x2, 0))], constraints=ends)  # fmt: skip
    with pytest.raises(SystemDefinitionError, match="violates constraint"):
        Derivation(toggle).state_space({"x1": "l1"})
    at = Derivation(replace(toggle, constraints=[x1 * y1])).state_space
    with pytest.raises(SystemDefinitionError, match="depend on each other at the point"):
        at({})


def test_equilibria_of_a_four_bar_linkage_have_no_closed_form() -> None:
    q = alpha, beta, gamma = sp.symbols("alpha beta gamma", real=True)
    joint, pivot = (sp.cos(alpha) + 2 * sp.cos(beta), sp.sin(alpha) + 2 * sp.sin(beta)), (2, 0)
    end = tuple(a + b for a, b in zip(pivot, (2 * sp.cos(gamma), 2 * sp.sin(gamma)), strict=True))
    linkage = System("linkage", "Four-bar linkage", [Coordinate(s, "rad", "angle") for s in q],
        [Parameter(m1, "kg", 1.0, "mass"), Parameter(g, "m/s^2", 9.81, "gravity")],
        [PointMass(m1, joint), PointMass(m1, (sp.cos(alpha), sp.sin(alpha)))],
        coincide=[(joint, end)])  # fmt: skip
    with pytest.raises(SystemDefinitionError, match=r"no closed form.* = 0 for alpha.*solvers"):
        Derivation(linkage).equilibria()
