"""Hinges and prismatic joints of bodies in space, by laws of single bodies and closed forms."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
import sympy as sp
from numpy.typing import NDArray

from derive import (
    Constraint,
    Coordinate,
    Derivation,
    Orientation,
    Parameter,
    RigidBody,
    System,
    hinge,
    prismatic,
    reduced,
    rotation_matrix,
    rotations,
)
from derive.mechanics.derivation import RedundancyWarning
from derive.system.parts import SystemDefinitionError
from holonomic import build, integrate, load
from solvers.equations.module import GeneratedModule

Array = NDArray[np.float64]
Jet = list[Array]  # Taylor coefficients of a function of time, up to the second

m, L, l, J, S, C, beta = sp.symbols("m L l J S C beta", positive=True)  # noqa: E741
g = sp.Symbol("g", real=True)
PARAMETERS = [
    Parameter(m, "kg", 0.1, "mass of the second body"),
    Parameter(L, "m", 0.3, "length of the first body"),
    Parameter(l, "m", 0.2, "from the hinge to the second body's centre"),
    Parameter(J, "kg m^2", 4e-3, "moment of inertia of the first body"),
    Parameter(S, "kg m^2", 1e-3, "moment of inertia of the second body"),
    Parameter(g, "m/s^2", 9.81, "gravity"),
]
STRICT = {"method": "verner98", "rtol": 1e-13, "atol": 1e-13}


class Body:
    """Coordinates of a free body, by rotations."""

    def __init__(self, k: int, axes: str = "zxy") -> None:
        self.place = sp.symbols(f"x{k} y{k} z{k}", real=True)
        self.angles = sp.symbols(f"a{k} b{k} c{k}", real=True)
        self.axes: Orientation = rotations(axes, self.angles)
        self.coordinates = [Coordinate(s, "m", "of the centre") for s in self.place]
        self.coordinates += [Coordinate(s, "rad", "of a rotation") for s in self.angles]

    def at(self, arm: tuple[sp.Expr | int, ...]) -> tuple[sp.Expr, ...]:
        """A point of the body."""
        pairs = zip(self.place, self.axes.turned(arm), strict=True)
        return tuple(centre + turned for centre, turned in pairs)


def furuta() -> System:
    """Furuta's pendulum as two free bodies and two hinges."""
    arm, rod = Body(1), Body(2)
    return System("two_hinges", "Furuta's pendulum of two free bodies",
        [*arm.coordinates, *rod.coordinates], PARAMETERS,
        [RigidBody(1, arm.place, (0, J, J), arm.axes),
         RigidBody(m, rod.place, (S, S, 0), rod.axes)],
        gravity=(0, 0, -g),
        constraints=[*hinge("A", arm.place, (0, 0, 0), arm.axes),
            *hinge("B", rod.at((0, 0, l)), arm.at((L, 0, 0)), rod.axes, arm.axes,
                   "x")])  # fmt: skip


@cache
def two_hinges() -> GeneratedModule:
    """The module of Furuta's pendulum."""
    return build(furuta())


def joint_state(module: GeneratedModule, given: dict[str, float]) -> Array:
    return np.array([given.get(name, 0.0) for name in module.STATE])


def furuta_state(alpha: float, theta: float, turn: float, swing: float) -> Array:
    angles = {"a1": alpha, "a2": alpha, "b2": theta}
    return joint_state(two_hinges(), angles | {"a1_dot": turn, "a2_dot": turn, "b2_dot": swing})


@pytest.mark.long("derives bodies by all their coordinates")
def test_two_hinges_are_furutas_pendulum() -> None:
    module, shipped = two_hinges(), load("furuta_pendulum")
    assert set(module.MULTIPLIERS) >= {"A_torque_x", "A_torque_y", "B_torque_y", "B_torque_z"}
    rng = np.random.default_rng(1)
    for start in rng.uniform(-2, 2, (20, 4)):
        y = furuta_state(*start)
        assert np.abs(module.constraints(0.0, y, module.DEFAULTS)).max() < 1e-14
        rates = dict(zip(module.STATE, module.rhs(0.0, y, module.DEFAULTS), strict=True))
        expected = shipped.rhs(0.0, start, shipped.DEFAULTS)
        found = (rates["a1_dot"], rates["b2_dot"])
        assert np.allclose(found, expected[2:], rtol=1e-12, atol=1e-12)
        assert rates["a2_dot"] == pytest.approx(rates["a1_dot"], rel=1e-12)


@pytest.mark.long("derives bodies by all their coordinates")
def test_two_hinges_remain_furutas_pendulum_in_a_motion() -> None:
    module, shipped, start = two_hinges(), load("furuta_pendulum"), (0.3, 1.2, 0.5, -1.0)
    times = np.linspace(0, 5, 11)
    motion = integrate(
        module, (0, 5), furuta_state(*start), module.DEFAULTS, t_eval=times, **STRICT
    )
    other = integrate(shipped, (0, 5), start, shipped.DEFAULTS, t_eval=times, **STRICT)
    rows = [module.STATE.index(name) for name in ("a1", "b2")]
    assert np.abs(motion.y[rows] - other.y[:2]).max() < 1e-10
    assert np.abs(module.constraints_many(motion.t, motion.y, module.DEFAULTS)).max() < 1e-13


def product(a: Jet, b: Jet) -> Jet:
    return [sum((a[i] @ b[k - i] for i in range(k + 1)), np.zeros((3, 3))) for k in range(3)]


def turn(axis: str, angle: Array) -> Jet:
    """The rotation by an angle, given with its rate and acceleration, by Taylor's series."""
    k = "xyz".index(axis)
    skew = np.cross(np.eye(3), np.eye(3)[k])
    matrix = np.eye(3) + np.sin(angle[0]) * skew + (1 - np.cos(angle[0])) * skew @ skew
    first = angle[1] * skew @ matrix
    return [matrix, first, (angle[2] * skew @ matrix + angle[1] * skew @ first) / 2]


def vector(skew: Array) -> Array:
    return np.array([skew[2, 1], skew[0, 2], skew[1, 0]])


def turning(axes: str, angles: Array) -> tuple[Array, Array, Array]:
    """Rotation matrix, angular velocity and angular acceleration in space."""
    R: Jet = [np.eye(3), np.zeros((3, 3)), np.zeros((3, 3))]
    for axis, angle in zip(axes, angles, strict=True):
        R = product(R, turn(axis, angle))
    velocity = R[1] @ R[0].T
    acceleration = 2 * R[2] @ R[0].T + R[1] @ R[1].T
    return R[0], vector(velocity), vector((acceleration - acceleration.T) / 2)


def moment(moments: tuple[float, ...], R: Array, omega: Array, alpha: Array) -> Array:
    """Rate of the angular momentum about the centre of mass."""
    inertia = R @ np.diag(moments) @ R.T
    return np.asarray(inertia @ alpha + np.cross(omega, inertia @ omega))


def motion_of(module: GeneratedModule, y: Array, names: str) -> Array:
    """Values, rates and accelerations of coordinates."""
    values = dict(zip(module.STATE, y, strict=True))
    rates = dict(zip(module.STATE, module.rhs(0.0, y, module.DEFAULTS), strict=True))
    return np.array([[values[q], rates[q], rates[f"{q}_dot"]] for q in names.split()])


def end_acceleration(motion: tuple[Array, Array, Array], arm: Array) -> Array:
    """Acceleration of the end of an arm that turns about its other end."""
    _, omega, alpha = motion
    return np.cross(alpha, arm) + np.cross(omega, np.cross(omega, arm))


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize("seed", range(5))
def test_multipliers_of_hinges_are_forces_and_torques(seed: int) -> None:
    # oracle: Newton's and Euler's laws of each body, with rotations by their Taylor series
    module = two_hinges()
    y = furuta_state(*np.random.default_rng(seed).uniform(-2, 2, 4))
    names, values = module.MULTIPLIERS, module.multipliers(0.0, y, module.DEFAULTS)
    of = dict(zip(names, values, strict=True))
    assert (module.UNITS["A_x"], module.UNITS["A_torque_x"]) == ("N", "N m")
    force = {k: np.array([of[f"{k}_{axis}"] for axis in "xyz"]) for k in "AB"}
    arm, rod = (turning("zxy", motion_of(module, y, f"a{k} b{k} c{k}")) for k in (1, 2))
    torque = {"A": np.array([of["A_torque_x"], of["A_torque_y"], 0.0])}
    torque["B"] = arm[0] @ [0.0, of["B_torque_y"], of["B_torque_z"]]
    weight = np.array([0, 0, -9.81])
    hinge_of_rod, hinge_of_arm = rod[0] @ [0, 0, 0.2], arm[0] @ [0.3, 0, 0]
    centre = end_acceleration(arm, hinge_of_arm) - end_acceleration(rod, hinge_of_rod)
    assert np.allclose(force["B"], 0.1 * (centre - weight), rtol=1e-12, atol=1e-14)
    assert np.allclose(
        moment((1e-3, 1e-3, 0.0), *rod), np.cross(hinge_of_rod, force["B"]) + torque["B"],
        rtol=1e-11, atol=1e-13)  # fmt: skip
    assert np.allclose(force["A"], force["B"] - weight, atol=1e-12)  # the arm's centre rests
    assert np.allclose(
        moment((0.0, 4e-3, 4e-3), *arm),
        torque["A"] - torque["B"] - np.cross(hinge_of_arm, force["B"]),
        rtol=1e-11, atol=1e-13)  # fmt: skip


def collar() -> System:
    """A collar that slides on an arm, which turns about the vertical."""
    alpha, body = sp.Symbol("alpha", real=True), Body(2)
    arm = rotations("z", [alpha])
    return System("collar", "A collar on a turning arm",
        [Coordinate(alpha, "rad", "of the arm"), *body.coordinates], PARAMETERS,
        [RigidBody(1, (0, 0, 0), (J, J, J), arm),
         RigidBody(m, body.place, (S, 2 * S, 2 * S), body.axes)], gravity=(0, 0, -g),
        constraints=prismatic("A", body.place, (0, 0, 0), body.axes, arm, "x"))  # fmt: skip


def test_a_collar_on_a_turning_arm() -> None:
    # oracle: r̈ = r α̇², and the angular momentum (J + 2 S + m r²) α̇ is constant
    module = build(collar())
    alpha, r, turn_rate, slide = 0.7, 0.4, 1.3, -0.6
    c, s = np.cos(alpha), np.sin(alpha)
    given = {"alpha": alpha, "a2": alpha, "x2": r * c, "y2": r * s, "alpha_dot": turn_rate,
             "a2_dot": turn_rate, "x2_dot": slide * c - r * turn_rate * s,
             "y2_dot": slide * s + r * turn_rate * c}  # fmt: skip
    y = joint_state(module, given)
    assert np.abs(module.constraints(0.0, y, module.DEFAULTS)).max() < 1e-15
    rates = dict(zip(module.STATE, module.rhs(0.0, y, module.DEFAULTS), strict=True))
    outward = r * turn_rate**2
    change = -2 * 0.1 * r * slide * turn_rate / (4e-3 + 2e-3 + 0.1 * r**2)
    across = r * change + 2 * slide * turn_rate
    radial = outward - r * turn_rate**2
    assert rates["alpha_dot"] == pytest.approx(change, rel=1e-12)
    assert rates["a2_dot"] == pytest.approx(change, rel=1e-12)
    assert rates["x2_dot"] == pytest.approx(radial * c - across * s, rel=1e-12)
    assert rates["y2_dot"] == pytest.approx(radial * s + across * c, rel=1e-12)
    values = module.multipliers(0.0, y, module.DEFAULTS)
    of = dict(zip(module.MULTIPLIERS, values, strict=True))
    expected = {"A_y": 0.1 * across, "A_z": 0.981, "A_torque_x": 0.0, "A_torque_y": 0.0,
                "A_torque_z": 2e-3 * change}  # fmt: skip
    assert {name: of[name] for name in expected} == pytest.approx(expected, rel=1e-12, abs=1e-15)


def universal_joint() -> System:
    """Two shafts at an angle and a cross, which has a hinge on each of them."""
    phi, psi = sp.symbols("phi psi", real=True)
    cross = sp.symbols("a b c", real=True)
    axes = rotations("xyz", cross)
    shafts = rotations("x", [phi]), rotations("zx", (beta, psi))
    return System("universal_joint", "A universal joint",
        [Coordinate(q, "rad", "an angle") for q in (phi, psi, *cross)],
        [Parameter(beta, "rad", 0.6, "angle of the shafts"),
         Parameter(J, "kg m^2", 0.02, "of a shaft"), Parameter(C, "kg m^2", 1e-3, "of the cross")],
        [RigidBody(1, (0, 0, 0), (J, J, J), shaft) for shaft in shafts]
        + [RigidBody(1, (0, 0, 0), (C, C, C), axes)], potential=0,
        constraints=[*hinge("A", (0, 0, 0), (0, 0, 0), axes, shafts[0], "y"),
            *hinge("B", (0, 0, 0), (0, 0, 0), axes, shafts[1], "z")])  # fmt: skip


@pytest.mark.long("derives bodies by all their coordinates")
def test_a_universal_joint_has_hookes_ratio() -> None:
    # oracle: tan φ = cos β tan ψ, of shafts whose forks hold perpendicular arms of the cross
    module = build(universal_joint())
    start = {"phi": 0.0, "phi_dot": 2.0}
    times = np.linspace(0, 6, 25)
    motion = integrate(module, (0, 6), start, module.DEFAULTS, t_eval=times, **STRICT)
    rows = [module.STATE.index(name) for name in ("phi", "psi", "phi_dot", "psi_dot")]
    phi, psi, phi_dot, psi_dot = motion.y[rows]
    assert phi[-1] > 2 * np.pi
    assert np.abs(np.sin(phi) * np.cos(psi) - np.cos(0.6) * np.cos(phi) * np.sin(psi)).max() < 1e-13
    ratio = np.cos(0.6) / (1 - np.sin(0.6) ** 2 * np.cos(phi) ** 2)
    assert np.allclose(psi_dot, ratio * phi_dot, rtol=1e-12)


def four_bars() -> System:
    """A four-bar linkage of three bodies in space and four parallel hinges."""
    lengths = a, b, c, d = sp.symbols("a b c d", positive=True)
    bars = [Body(k, "xyz") for k in (1, 2, 3)]
    parameters = [Parameter(s, "m", x, "length")
                  for s, x in zip(lengths, (0.5, 1.2, 1.0, 1.3), strict=True)]  # fmt: skip
    return System("four_bars", "A four-bar linkage in space",
        [q for bar in bars for q in bar.coordinates], [*parameters, *PARAMETERS],
        [RigidBody(m, bar.place, (m * s**2 / 100, m * s**2 / 12, m * s**2 / 12), bar.axes)
         for bar, s in zip(bars, lengths, strict=False)], gravity=(0, -g, 0),
        constraints=[
            *hinge("A", bars[0].at((-a / 2, 0, 0)), (0, 0, 0), bars[0].axes),
            *hinge("B", bars[1].at((-b / 2, 0, 0)), bars[0].at((a / 2, 0, 0)),
                   bars[1].axes, bars[0].axes),
            *hinge("C", bars[2].at((c / 2, 0, 0)), bars[1].at((b / 2, 0, 0)),
                   bars[2].axes, bars[1].axes),
            *hinge("D", bars[2].at((-c / 2, 0, 0)), (d, 0, 0), bars[2].axes)])  # fmt: skip


@pytest.mark.long("other tests reach its code")
def test_a_closed_loop_of_parallel_hinges_has_three_redundant_constraints() -> None:
    with pytest.warns(RedundancyWarning, match="left out: D_z, D_torque_x, D_torque_y; they"):
        derivation = Derivation(reduced(four_bars()))
    assert [one.name for one in derivation.redundant] == ["D_z", "D_torque_x", "D_torque_y"]
    assert derivation.degrees_of_freedom == 1


def test_invalid_orientations_and_axes_are_refused() -> None:
    body, origin = Body(1), (0, 0, 0)
    for joint in (hinge, prismatic):
        with pytest.raises(SystemDefinitionError, match="A has the orientation None: give"):
            joint("A", origin, origin, None, body.axes)
        with pytest.raises(SystemDefinitionError, match=r"orientation a1: give"):
            joint("A", origin, origin, body.axes, body.angles[0])
        with pytest.raises(SystemDefinitionError, match="the axis of A is 'xy': give x, y or z"):
            joint("A", origin, origin, body.axes, axis="xy")
        with pytest.raises(SystemDefinitionError, match="a point of 2 components: give 3"):
            joint("A", (0, 0), origin, body.axes)


def numeric(matrix: Array) -> Orientation:
    return rotation_matrix([[sp.Float(x) for x in row] for row in matrix])


@pytest.mark.parametrize("is_ground", [False, True])
@pytest.mark.parametrize("axis", "xyz")
@pytest.mark.parametrize("joint", [hinge, prismatic])
def test_constraints_are_components_of_motions_in_the_second_body(
    joint: Callable[..., list[Constraint]], axis: str, is_ground: bool
) -> None:
    rng, k = np.random.default_rng(3), "xyz".index(axis)
    angle, slide = (0.7, 0.0) if joint is hinge else (0.0, 0.4)
    second = np.eye(3) if is_ground else turning("xyz", rng.normal(size=(3, 3)))[0]
    first = second @ turn(axis, np.array([angle, 0.0, 0.0]))[0]
    q = rng.normal(size=3)
    p = q + slide * second[:, k]

    def values(shift: Array, rotation: Array) -> dict[str, float]:
        skew = np.cross(np.eye(3), rotation)
        found = joint("A", tuple(p + shift), tuple(q), numeric(first + skew @ first),
            None if is_ground else numeric(second), axis)  # fmt: skip
        return {one.name: float(one.formula) for one in found}

    zero, h = np.zeros(3), 1e-6
    # moved and turned along the axes of the second body; a formula that is 0 is left out
    rates = [values(h * one, zero) for one in second.T]
    rates += [values(zero, h * one) for one in second.T]
    forces, torques = ([f"A_{one}" for one in "xyz"], [f"A_torque_{one}" for one in "xyz"])
    for k, name in enumerate((*forces, *torques)):
        expected = [float(k == n) for n in range(6)]
        if joint is hinge and name in forces:  # in space
            expected[:3] = second[k].tolist()
        elif name == (f"A_torque_{axis}" if joint is hinge else f"A_{axis}"):
            expected = [0.0] * 6
        assert [one.get(name, 0.0) / h for one in rates] == pytest.approx(expected, abs=1e-5), name
