"""Mechanisms in the plane: laws of each body with its joint forces, and closed forms.

The oracle assembles, by hand and without energies, Newton's and Euler's laws of every body with
the forces in its joints as unknowns, and accelerations of joints from the motions of both bodies.
"""

import warnings
from dataclasses import replace
from math import acos, atan2, cos, hypot, pi, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad
from sympy import Symbol, symbols

import generated.double_pendulum as dp
import generated.four_bar as four_bar
import generated.slider_crank as crank
import generated.two_link_arm as arm
from derive import Coordinate, Parameter, PointMass, System, fixed_distance, load, reduced
from solvers import build, consistent_start, integrate, load_scene, run_scene
from solvers import load as load_module
from solvers.equations.assembly import Assembly
from solvers.equations.module import GeneratedModule

Array = NDArray[np.float64]

STRICT = {"method": "verner98", "rtol": 1e-13, "atol": 1e-13}


class Bodies:
    """Newton's and Euler's laws of free bodies that forces join: linear equations.

    Unknown are the accelerations a_x, a_y, α of every body, and the forces in the joints.
    """

    def __init__(self, masses: list[float], inertias: list[float], g: float, joints: int) -> None:
        self.n = len(masses)
        self.rows: list[Array] = []
        self.right: list[float] = []
        self.size = 3 * self.n + joints
        self.laws = np.zeros((3 * self.n, self.size))
        for k, (m, inertia) in enumerate(zip(masses, inertias, strict=True)):
            self.laws[3 * k : 3 * k + 3, 3 * k : 3 * k + 3] = -np.diag([m, m, inertia])
        self.loads = np.array([[0.0, -m * g, 0.0] for m in masses]).ravel()

    def force(self, joint: int, direction: tuple[float, float], body: int, arm: Array) -> None:
        """A unit of the joint's unknown is a force along the direction, at the arm of a body."""
        x, y = direction
        self.laws[3 * body : 3 * body + 3, 3 * self.n + joint] += x, y, arm[0] * y - arm[1] * x

    def joined(self, direction: tuple[float, float], *ends: tuple[int, Array, float, int]) -> None:
        """Accelerations of points of bodies, with signs, along a direction have the sum 0.

        Each end is a body, an arm of it, its angular velocity, and a sign.
        """
        row, known, (x, y) = np.zeros(self.size), 0.0, direction
        for body, lever, rate, sign in ends:
            turn = lever[0] * y - lever[1] * x
            row[3 * body : 3 * body + 3] += sign * np.array([x, y, turn])
            known += sign * rate**2 * (lever[0] * x + lever[1] * y)
        self.rows.append(row)
        self.right.append(known)

    def solved(self) -> tuple[Array, Array]:
        """Accelerations, a row for each body, and the forces."""
        matrix = np.vstack([self.laws, *self.rows])
        solution = np.linalg.solve(matrix, np.array([*-self.loads, *self.right]))
        return solution[: 3 * self.n].reshape(-1, 3), solution[3 * self.n :]


AXES = ((1.0, 0.0), (0.0, 1.0))


def along(length: float, angle: float) -> Array:
    return length * np.array([cos(angle), sin(angle)])


def pinned_bars(
    lengths: list[float], masses: list[float], g: float, angles: Array, rates: Array
) -> tuple[Array, Array]:
    """Accelerations of crank, coupler and rocker, and forces in their four pins.

    The pins are O, of the crank, A, B, and D, of the rocker, in the order of the forces; these are
    on crank, coupler, coupler and rocker.
    """
    inertias = [m * size**2 / 12 for m, size in zip(masses, lengths, strict=True)]
    half = [along(size / 2, q) for size, q in zip(lengths, angles, strict=True)]
    bodies = Bodies(masses, inertias, g, 8)
    for k, axis in enumerate(AXES):
        bodies.force(k, axis, 0, -half[0])
        bodies.force(2 + k, axis, 1, -half[1])
        bodies.force(2 + k, (-axis[0], -axis[1]), 0, half[0])
        bodies.force(4 + k, axis, 1, half[1])
        bodies.force(4 + k, (-axis[0], -axis[1]), 2, half[2])
        bodies.force(6 + k, axis, 2, -half[2])
        bodies.joined(axis, (0, -half[0], rates[0], 1))
        bodies.joined(axis, (1, -half[1], rates[1], 1), (0, half[0], rates[0], -1))
        bodies.joined(axis, (1, half[1], rates[1], 1), (2, half[2], rates[2], -1))
        bodies.joined(axis, (2, -half[2], rates[2], 1))
    return bodies.solved()


def closed(angle: float, branch: int, lengths: tuple[float, ...]) -> tuple[float, float]:
    """Angles of coupler and rocker by the law of cosines in the triangle of A, B and D."""
    a, b, c, d = lengths
    x, y = d - a * cos(angle), -a * sin(angle)
    diagonal = hypot(x, y)
    at_A = acos((b**2 + diagonal**2 - c**2) / (2 * b * diagonal))
    psi = atan2(y, x) + branch * at_A
    B = (a * cos(angle) + b * cos(psi), a * sin(angle) + b * sin(psi))
    return psi, atan2(B[1], B[0] - d)


def named(module: GeneratedModule, params: tuple[float, ...]) -> dict[str, float]:
    return dict(zip(module.PARAMETERS, params, strict=True))


def of_four_bar(p: dict[str, float]) -> tuple[float, ...]:
    return p["a"], p["b"], p["c"], p["d"]


FOUR_BARS = [four_bar.DEFAULTS, four_bar.params(a=0.5, b=0.4, c=0.7, d=0.6, m2=2.5, g=-3.0)]


@pytest.mark.parametrize("params", FOUR_BARS)
@pytest.mark.parametrize("branch", [1, -1])
def test_each_bar_of_a_four_bar_linkage_obeys_newton_and_euler(
    params: tuple[float, ...], branch: int
) -> None:
    p = named(four_bar, params)
    lengths = of_four_bar(p)
    for angle, rate in ((0.7, 3.0), (2.5, -8.0), (4.0, 0.0)):
        guess = dict(zip(("psi", "chi"), closed(angle, branch, lengths), strict=True))
        given = {"phi": angle, "phi_dot": rate}
        y = consistent_start(four_bar, given, params, guess=guess).y
        moved = four_bar.rhs(0.0, y, params)[3:]
        masses = [p["m1"], p["m2"], p["m3"]]
        accelerations, forces = pinned_bars([*lengths[:3]], masses, p["g"], y[:3], y[3:])
        scale = np.abs(forces).max()
        assert moved == pytest.approx(accelerations[:, 2], rel=1e-11)
        assert four_bar.multipliers(0.0, y, params) == pytest.approx(forces[4:6], abs=1e-12 * scale)


@pytest.mark.parametrize("branch", [1, -1])
def test_angles_of_a_four_bar_linkage_are_those_of_the_law_of_cosines(branch: int) -> None:
    lengths = of_four_bar(named(four_bar, four_bar.DEFAULTS))
    shortest, *middle, longest = sorted(lengths)
    assert shortest + longest < sum(middle)  # Grashof: the crank turns round
    guess = dict(zip(("psi", "chi"), closed(0.3, branch, lengths), strict=True))
    start = {"phi": 0.3, "phi_dot": 12.0}
    y0 = consistent_start(four_bar, start, {}, guess=guess).y
    times = np.linspace(0, 3, 61)
    motion = integrate(four_bar, (0, 3), y0, {}, t_eval=times, **STRICT)
    turns = motion.y[0] / (2 * pi)
    assert turns.max() > 3
    for phi, *others in motion.y[:3].T:
        turn = np.subtract(others, closed(phi, branch, lengths)) / (2 * pi)
        assert turn == pytest.approx(np.round(turn), abs=1e-13)
    assert np.ptp(motion.y[2]) < pi  # and the rocker swings
    energy = four_bar.energy_many(times, motion.y, four_bar.DEFAULTS)
    assert np.abs(energy - energy[0]).max() < 1e-12 * energy[0]
    residuals = four_bar.constraints_many(times, motion.y, four_bar.DEFAULTS)
    assert np.abs(residuals[:2]).max() < 5e-15  # rounding of angles of several turns


def test_a_four_bar_linkage_turns_as_by_a_quadrature() -> None:
    # one degree of freedom: J(φ) φ̇²/2 + V(φ) = E, with J from rates of the closed form
    p = named(four_bar, four_bar.DEFAULTS)
    lengths, (a, b, c) = of_four_bar(p), (p["a"], p["b"], p["c"])

    def rate(phi: float, energy: float) -> float:
        psi, chi = closed(phi, 1, lengths)
        n2 = a * sin(phi - chi) / (b * sin(chi - psi))
        n3 = a * sin(phi - psi) / (c * sin(chi - psi))
        J = p["m1"] * a**2 / 3 + p["m3"] * (c * n3) ** 2 / 3
        J += p["m2"] * (a**2 + a * b * n2 * cos(phi - psi) + (b * n2) ** 2 / 3)
        height = p["m1"] * a * sin(phi) / 2 + p["m2"] * (a * sin(phi) + b * sin(psi) / 2)
        V = p["g"] * (height + p["m3"] * c * sin(chi) / 2)
        return sqrt(2 * (energy - V) / J)

    guess = dict(zip(("psi", "chi"), closed(0.3, 1, lengths), strict=True))
    y0 = consistent_start(four_bar, {"phi": 0.3, "phi_dot": 12.0}, {}, guess=guess).y
    energy = four_bar.energy(0.0, y0, four_bar.DEFAULTS)
    assert rate(0.3, energy) == pytest.approx(12.0, rel=1e-12)
    period = quad(lambda phi: 1 / rate(phi, energy), 0.3, 0.3 + 2 * pi, epsabs=0, epsrel=1e-12)[0]
    motion = integrate(four_bar, (0, period), y0, {}, t_eval=[period], **STRICT)
    assert motion.y[:, -1] == pytest.approx(y0 + 2 * pi * np.eye(6)[0], abs=1e-9)
    assert abs(motion.y[0, -1] - 0.3) > 6  # a whole turn


def crank_bodies(
    p: dict[str, float], phi: float, rate: float
) -> tuple[Array, Array, tuple[float, float]]:
    """Accelerations of crank, rod and slider; forces in the pins O, A, B, and of the guide."""
    r, l, masses = p["r"], p["l"], [p["m1"], p["m2"], p["M"]]  # noqa: E741
    angle = -np.arcsin(r * sin(phi) / l)
    turn = -r * cos(phi) * rate / (l * cos(angle))
    arms = along(r / 2, phi), along(l / 2, angle)
    inertias = [masses[0] * r**2 / 12, masses[1] * l**2 / 12, 1.0]
    bodies, none = Bodies(masses, inertias, p["g"], 8), np.zeros(2)
    for k, axis in enumerate(AXES):
        back = (-axis[0], -axis[1])
        bodies.force(k, axis, 0, -arms[0])
        bodies.force(2 + k, axis, 1, -arms[1])
        bodies.force(2 + k, back, 0, arms[0])
        bodies.force(4 + k, axis, 2, none)
        bodies.force(4 + k, back, 1, arms[1])
        bodies.joined(axis, (0, -arms[0], rate, 1))
        bodies.joined(axis, (1, -arms[1], turn, 1), (0, arms[0], rate, -1))
        bodies.joined(axis, (2, none, 0.0, 1), (1, arms[1], turn, -1))
    bodies.force(6, AXES[1], 2, none)
    bodies.joined(AXES[1], (2, none, 0.0, 1))
    bodies.laws[8, 3 * 3 + 7] = 1.0  # the guide's torque, which keeps the slider upright
    bodies.rows.append(np.eye(bodies.size)[8])
    bodies.right.append(0.0)
    return (*bodies.solved(), (cos(angle), sin(angle)))


CRANKS = [crank.DEFAULTS, crank.params(r=0.2, l=0.25, m2=3.0, g=-2.0)]


@pytest.mark.parametrize("params", CRANKS)
def test_each_body_of_a_slider_crank_obeys_newton_and_euler(params: tuple[float, ...]) -> None:
    p = named(crank, params)
    for phi, rate in ((0.4, 5.0), (2.0, -30.0), (4.4, 0.0)):
        y = (phi, rate)
        accelerations, forces, axis = crank_bodies(p, phi, rate)
        assert crank.rhs(0.0, y, params)[1] == pytest.approx(accelerations[0, 2], rel=1e-12)
        guide, rod = crank.multipliers(0.0, y, params)
        scale = np.abs(forces).max()
        assert guide == pytest.approx(forces[6], abs=1e-12 * scale)
        ends = -forces[2:4] @ axis, -forces[4:6] @ axis  # tension, on the rod at A and at B
        assert rod == pytest.approx(sum(ends) / 2, abs=1e-12 * scale)


def test_the_slider_is_at_its_closed_form_and_one_coordinate_remains() -> None:
    system = load("slider_crank")
    assert len(system.q) == 3
    assert [str(q) for q in reduced(system).q] == ["phi"]
    assert crank.STATE == ("phi", "phi_dot")
    r, l = crank.DEFAULTS[:2]  # noqa: E741
    for phi, rate in np.random.default_rng(2).uniform(-9, 9, (20, 2)):
        outputs = crank.outputs(0.0, (phi, rate), crank.DEFAULTS)
        values = dict(zip(crank.OUTPUTS, outputs, strict=True))
        root = sqrt(l**2 - (r * sin(phi)) ** 2)
        assert values["x"] == pytest.approx(r * cos(phi) + root, rel=1e-14)
        speed = -(r**2) * sin(phi) * cos(phi) / root * rate
        assert values["u_dot"] == pytest.approx(speed, abs=1e-14)


SCENE = """
system = "slider_crank"
duration = "2 s"
accuracy = 1e-8
[initial]
phi = 0.4
phi_dot = "ROTATION rad/s"
"""


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("rotation", [1, 12])  # it swings, and turns round
def test_the_slider_crank_reaches_the_quadrature_model(rotation: int, tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(SCENE.replace("ROTATION", str(rotation)))
    result = run_scene(load_scene(path))
    assert result.selection.model.name == "quadrature"
    start = (0.4, rotation)
    motion = integrate(crank, (0, 2), start, {}, t_eval=[2], **STRICT)
    final = dict(zip(crank.STATE, motion.y[:, -1], strict=True))
    assert result.final_state == pytest.approx(final, abs=1e-8)


def torques(p: dict[str, float], q: Array, rates: Array, moved: Array) -> tuple[Array, Array]:
    """Torques of both motors by the recursion of Newton and Euler; and the force in the elbow.

    J. Y. S. Luh, M. W. Walker, R. P. C. Paul (1980): accelerations outwards, forces inwards.
    """
    angles, spins, turns = np.cumsum(q), np.cumsum(rates), np.cumsum(moved)

    def accelerated(base: Array, arm: Array, k: int) -> Array:
        return base + turns[k] * np.array([-arm[1], arm[0]]) - spins[k] ** 2 * arm

    up = np.array([0.0, p["g"]])  # gravity as an acceleration of the ground
    elbow = along(p["l1"], angles[0])
    first, second = along(p["c1"], angles[0]), along(p["c2"], angles[1])
    force2 = p["m2"] * accelerated(accelerated(up, elbow, 0), second, 1)
    force1 = p["m1"] * accelerated(up, first, 0)
    torque2 = p["I2"] * turns[1] + second[0] * force2[1] - second[1] * force2[0]
    torque1 = p["I1"] * turns[0] + first[0] * force1[1] - first[1] * force1[0]
    torque1 += torque2 + elbow[0] * force2[1] - elbow[1] * force2[0]
    return np.array([torque1, torque2]), force2


def test_the_arm_is_moved_by_the_torques_of_newton_and_euler() -> None:
    random = np.random.default_rng(5)
    for _ in range(20):
        q, rates, moved = random.uniform(-3, 3, (3, 2))
        values = dict(zip(arm.PARAMETERS, random.uniform(0.3, 2, len(arm.PARAMETERS)), strict=True))
        values["tau1"], values["tau2"] = torques(values, q, rates, moved)[0]
        state = (*q, *rates)
        assert arm.rhs(0.0, state, arm.params(**values))[2:] == pytest.approx(moved, abs=1e-10)
        power = values["tau1"] * rates[0] + values["tau2"] * rates[1]
        assert arm.power(0.0, state, arm.params(**values)) == pytest.approx(power, rel=1e-12)


def test_an_arm_of_point_masses_without_torques_is_a_double_pendulum() -> None:
    tiny = 1e-300
    params = arm.params(l1=0.4, c1=0.4, c2=0.3, m1=2.0, m2=1.0, I1=tiny, I2=tiny)
    start = np.array([-0.3, 1.1, 0.5, -2.0])
    motion = integrate(arm, (0, 2), start, params, t_eval=[1, 2], **STRICT)
    other = dp.params(m1=2.0, m2=1.0, l1=0.4, l2=0.3)
    angles, spins = np.cumsum(start[:2]) + pi / 2, np.cumsum(start[2:])
    swing = integrate(dp, (0, 2), (*angles, *spins), other, t_eval=[1, 2], **STRICT)
    assert np.cumsum(motion.y[:2], axis=0) + pi / 2 == pytest.approx(swing.y[:2], abs=1e-9)
    hand = [arm.outputs(0.0, y, params)[:2] for y in motion.y.T]
    bob = dp.positions_many(motion.t, swing.y, other)[1].T
    assert np.array(hand) == pytest.approx(bob, abs=1e-9)


def test_torques_that_follow_from_the_equations_move_the_hand_along_a_line() -> None:
    # computed torques: the mass matrix times the accelerations of the path, and what else there is
    p = named(arm, arm.DEFAULTS)

    def bent(t: float) -> Array:
        """Angles with the hand at (0.3 + 0.2 t, 0.1)."""
        x, y = 0.3 + 0.2 * t, 0.1
        elbow = acos((x**2 + y**2 - p["l1"] ** 2 - p["l2"] ** 2) / (2 * p["l1"] * p["l2"]))
        toward = atan2(p["l2"] * sin(elbow), p["l1"] + p["l2"] * cos(elbow))
        return np.array([atan2(y, x) - toward, elbow])

    h = 1e-4
    for t in (0.2, 0.7, 1.1):
        before, now, after = bent(t - h), bent(t), bent(t + h)
        rates, moved = (after - before) / (2 * h), (after - 2 * now + before) / h**2
        state = (*now, *rates)
        matrix = np.array(arm.mass_matrix(0.0, state, arm.DEFAULTS))
        free = np.array(arm.rhs(0.0, state, arm.DEFAULTS)[2:])
        torque = matrix @ (moved - free)
        assert torque == pytest.approx(torques(p, now, rates, moved)[0], rel=1e-10)
        hand = arm.outputs(0.0, state, arm.DEFAULTS)
        assert hand == pytest.approx((0.3 + 0.2 * t, 0.1), rel=1e-12)


def peaucellier() -> System:
    """Joints with mass and seven bars; O and Q below it are fixed, and D moves on a line."""
    L, s, r, m = symbols("L s r m", positive=True)
    g = Symbol("g", real=True)
    joints = {name: symbols(f"x_{name} y_{name}", real=True) for name in "ABCD"}
    points = {"O": (0, 0), "Q": (0, -r)} | joints
    bars = {"OA": L, "OC": L, "AB": s, "BC": s, "CD": s, "DA": s, "QB": r}
    values = {L: (0.5, "m"), s: (0.25, "m"), r: (0.16, "m"), m: (2.0, "kg"), g: (9.81, "m/s^2")}
    constraints = [fixed_distance(p + q, points[p], points[q], bars[p + q]) for p, q in bars]
    return System("peaucellier", "Peaucellier-Lipkin linkage",
        [Coordinate(one, "m", "of a joint") for pair in joints.values() for one in pair],
        [Parameter(p, unit, value, str(p)) for p, (value, unit) in values.items()],
        [PointMass(m, joint) for joint in joints.values()],
        constraints=[one for (one,) in constraints])  # fmt: skip


def inverted(angle: float) -> dict[str, float]:
    """Joints by inversion, with OB at an angle from the downward vertical: OB OD = L² - s²."""
    L, s, r = 0.5, 0.25, 0.16
    near = 2 * r * cos(angle)
    far = (L**2 - s**2) / near
    half = sqrt(s**2 - (far - near) ** 2 / 4)
    down, side = np.array([sin(angle), -cos(angle)]), np.array([cos(angle), sin(angle)])
    middle = (near + far) / 2 * down
    joints = (middle + half * side, near * down, middle - half * side, far * down)
    return {
        f"{axis}_{name}": float(x)
        for name, joint in zip("ABCD", joints, strict=True)
        for axis, x in zip("xy", joint, strict=True)
    }


@pytest.fixture(scope="module")
def straight() -> GeneratedModule:
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # of redundant constraints, as where A and C coincide
        return build(peaucellier())


@pytest.mark.long("derives a large linkage")
def test_peaucellier_s_joint_moves_on_a_straight_line(straight: GeneratedModule) -> None:
    start = consistent_start(straight, {"x_D_dot": 0.0}, {}, guess=inverted(0.4))
    given = [inverted(0.4)[name] for name in straight.COORDINATES]
    assert start.y[:8] == pytest.approx(given, abs=1e-14)
    times = np.linspace(0, 3, 61)
    motion = integrate(straight, (0, 3), start.y, {}, t_eval=times, **STRICT)
    states = dict(zip(straight.STATE, motion.y, strict=True))
    assert np.ptp(states["x_D"]) > 0.4
    height = -(0.5**2 - 0.25**2) / (2 * 0.16)
    assert np.abs(states["y_D"] - height).max() < 1e-14
    assert np.ptp(np.hypot(states["x_B"], states["y_B"] + 0.16)) < 1e-14  # B on a circle
    for x, y in zip(states["x_B"], motion.y.T, strict=True):
        angle = np.arcsin(x / 0.16) / 2
        expected = [inverted(angle)[name] for name in straight.COORDINATES]
        assert y[:8] == pytest.approx(expected, abs=1e-12)
    energy = straight.energy_many(times, motion.y, straight.DEFAULTS)
    assert np.abs(energy - energy[0]).max() < 1e-12 * abs(energy[0])


def test_tensions_of_peaucellier_s_bars_accelerate_its_joints(straight: GeneratedModule) -> None:
    y = consistent_start(straight, {"x_D_dot": 1.7}, {}, guess=inverted(0.3)).y
    tensions = dict(
        zip(straight.MULTIPLIERS, straight.multipliers(0.0, y, straight.DEFAULTS), strict=True)
    )
    moved = np.array(straight.rhs(0.0, y, straight.DEFAULTS)[8:]).reshape(4, 2)
    places = dict(zip("ABCD", y[:8].reshape(4, 2), strict=True))
    places |= {"O": np.zeros(2), "Q": np.array([0.0, -0.16])}
    forces = {name: np.array([0.0, -2.0 * 9.81]) for name in places}
    for (p, q), tension in tensions.items():
        toward = (places[q] - places[p]) / np.linalg.norm(places[q] - places[p])
        forces[p] = forces[p] + tension * toward
        forces[q] = forces[q] - tension * toward
    for name, acceleration in zip("ABCD", moved, strict=True):
        assert forces[name] == pytest.approx(2.0 * acceleration, abs=1e-11)
    # each bar keeps its length: d²(|p - q|²)/dt² = 0
    rates = dict(zip("ABCD", y[8:].reshape(4, 2), strict=True)) | {"O": 0 * moved[0]}
    second = dict(zip("ABCD", moved, strict=True)) | {"O": 0 * moved[0]}
    for p, q in ("OA", "OC", "AB", "BC", "CD", "DA"):
        change = (places[p] - places[q]) @ (second[p] - second[q])
        assert change == pytest.approx(-np.sum((rates[p] - rates[q]) ** 2), abs=1e-11)


def test_cranks_of_peaucellier_s_linkage_that_coincide_are_refused(
    straight: GeneratedModule,
) -> None:
    # where A and C coincide, D turns about them: bars' constraints depend on each other
    folded = inverted(0.3)
    folded |= {"x_C": folded["x_A"], "y_C": folded["y_A"]}
    folded |= {"x_D": folded["x_A"] + 0.25, "y_D": folded["y_A"]}
    y = [*(folded[name] for name in straight.COORDINATES), *[0.0] * 8]
    assert np.abs(straight.constraints(0.0, y, straight.DEFAULTS)).max() < 1e-15
    with pytest.raises(ValueError, match="depends on the others, as at a toggle point"):
        integrate(straight, (0, 1), y, {})


def test_sums_of_tensions_of_the_shipped_linkage_are_those_of_seven_bars(
    straight: GeneratedModule,
) -> None:
    shipped = load_module("peaucellier")
    y = consistent_start(straight, {"x_D_dot": 1.7}, {}, guess=inverted(0.3)).y
    tensions = dict(
        zip(straight.MULTIPLIERS, straight.multipliers(0.0, y, straight.DEFAULTS), strict=True)
    )
    params = shipped.params(m=2.0)
    rates = dict(zip(straight.STATE, y, strict=True))
    theta_dot = (rates["x_B_dot"] * cos(0.3) + rates["y_B_dot"] * sin(0.3)) / (0.32 * cos(0.3))
    given = {"phi": 0.6, "phi_dot": 2 * theta_dot}
    start = consistent_start(shipped, given, params).y
    joints = np.array(shipped.positions(0.0, start, params))
    assert joints == pytest.approx(y[:8].reshape(4, 2), abs=1e-13)
    sums = dict(zip(shipped.MULTIPLIERS, shipped.multipliers(0.0, start, params), strict=True))
    for pair, others in (("OAOC", "OA OC"), ("ABCP", "AB CD"), ("BCPA", "BC DA")):
        assert sums[pair] == pytest.approx(sum(tensions[bar] for bar in others.split()), abs=1e-10)


@pytest.mark.long("other tests reach its code")
def test_the_shipped_linkage_draws_a_straight_line() -> None:
    shipped = load_module("peaucellier")
    start = consistent_start(shipped, {"phi": 0.8, "phi_dot": 0.0}, {})
    assert (start.y[2:4] > 0).all()
    assert len(start.others) == 0  # folded linkages, with u = 0, and negative distances are none
    motion = integrate(shipped, (0, 3), start.y, {}, energy=True, **STRICT)
    x, y = shipped.positions_many(motion.t, motion.y, shipped.DEFAULTS)[3]
    assert np.ptp(x) > 0.4
    assert np.abs(y + (0.5**2 - 0.25**2) / (2 * 0.16)).max() < 1e-15
    assert np.ptp(motion.energy) < 1e-12


def test_a_start_where_a_constraint_has_no_derivative_is_none() -> None:
    # u = sqrt(L**2 - w**2) is 0 at the first guess of w
    folded = build(reduced(replace(load("peaucellier"), name="folded", keep_coordinates=False)))
    assert folded.COORDINATES == ("phi", "theta", "w")
    assembly = Assembly(folded, np.array([folded.DEFAULTS]))
    edge = [0.8, 0.4, 0.5, 0.0, 0.0, 0.0]
    assert not assembly.is_exact(edge)
    with np.errstate(all="ignore"):
        assert np.isinf(assembly.relative(np.array([edge]))).any()
    start = consistent_start(folded, {"phi": 0.8, "phi_dot": 0.0}, {}).y
    assert start[1:3] == pytest.approx([0.4, 0.4654470], abs=1e-6)
    motion = integrate(folded, (0, 1), start, {}, **STRICT)  # 0.8 m is no length of w
    assert motion.success
