"""The bicycle of Whipple and Carvallo: published eigenvalues, and balances of bodies in numbers.

Published eigenvalues: J. P. Meijaard, J. M. Papadopoulos, A. Ruina, A. L. Schwab, Linearized
dynamics equations for the balance and steer of a bicycle: a benchmark and review, Proceedings of
the Royal Society A 463 (2007), tables 1 and 2. There z points down and y to the right.
"""

from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest
from numpy import cross
from numpy.typing import NDArray

from holonomic import integrate
from solvers import linearise
from solvers.equations.consistent_start import consistent_start

Array = NDArray[np.float64]

#: Weave, capsize and castering at 5 m/s, and two of four real eigenvalues at rest.
AT_5 = (-0.775341882195845 + 4.46486771378823j, -0.32286642900409, -14.0783896927982)
AT_REST = (3.13164324790656, 5.53094371765393)
#: Wheel base, trail, tilt of the steering axis, radii of the wheels, gravity.
BASE, TRAIL, TILT, REAR, FRONT, G = 1.02, 0.08, np.pi / 10, 0.3, 0.35, 9.81
X, Y, Z = range(3)
UP = np.array([0.0, 0.0, 1.0])


@pytest.fixture(scope="module")
def module(large_module: Callable[[str], ModuleType]) -> ModuleType:
    return large_module("bicycle")


def rolling(speed: float, **others: float) -> dict[str, float]:
    """Straight motion."""
    return {"x_dot": speed, "chi_dot": speed / REAR, "omega_dot": speed / FRONT, **others}


@pytest.mark.long("derives the bicycle")
def test_eigenvalues_are_those_of_the_benchmark(module: ModuleType) -> None:
    for speed, published in ((5.0, AT_5), (0.0, AT_REST)):
        linear = linearise(module, rolling(speed), {})
        accelerations = linear.rate[8:]
        assert np.abs(accelerations).max() < 1e-13  # it runs straight at constant speed
        assert linear.A.shape == (10, 10)
        for value in published:
            error = np.abs(linear.eigenvalues - value).min()
            assert error < 1e-12 * max(1.0, abs(value)), (speed, value, error)


@pytest.mark.long("derives the bicycle")
def test_it_falls_at_low_speed_and_runs_by_itself_between_weave_and_capsize(
    module: ModuleType,
) -> None:
    # published: stable from 4.292 to 6.024 m/s; heading, place and turns of wheels are neutral
    for speed, is_stable in ((4.292, False), (4.293, True), (6.024, True), (6.025, False)):
        growth = linearise(module, rolling(speed), {}).eigenvalues.real.max()
        assert (growth < 1e-6) == is_stable, (speed, growth)


class Axes:
    """The axes of a body in space, their angular velocity and its rate."""

    def __init__(self, matrix: Array, omega: Array, alpha: Array) -> None:
        self.matrix, self.omega, self.alpha = matrix, omega, alpha

    def turned(self, axis: int, angle: float, rate: float = 0.0, change: float = 0.0) -> "Axes":
        """The axes after a rotation about one of them."""
        turn, e = np.eye(3), self.matrix[:, axis]
        j, k = (axis + 1) % 3, (axis + 2) % 3
        turn[j, j] = turn[k, k] = np.cos(angle)
        turn[k, j] = np.sin(angle)
        turn[j, k] = -turn[k, j]
        alpha = self.alpha + change * e + rate * cross(self.omega, e)
        return Axes(self.matrix @ turn, self.omega + rate * e, alpha)

    def momentum_rate(self, tensor: Array) -> Array:
        """The rate of the angular momentum about the centre of mass."""
        inertia = self.matrix @ tensor @ self.matrix.T
        return inertia @ self.alpha + cross(self.omega, inertia @ self.omega)


SPACE = Axes(np.eye(3), np.zeros(3), np.zeros(3))


def moved(point: Array, axes: Axes, *arm: float) -> Array:
    """Place, velocity and acceleration of the end of an arm in the axes of a body."""
    s = axes.matrix @ np.array(arm)
    speed = cross(axes.omega, s)
    return point + np.array([s, speed, cross(axes.alpha, s) + cross(axes.omega, speed)])


def contact(hub: Array, wheel: Axes, radius: float) -> tuple[Array, Array, Array]:
    """The arm to the lowest point of a wheel, its acceleration there, and the axle."""
    a = wheel.matrix[:, Y]
    change = cross(wheel.omega, a)
    level = np.sqrt(1 - a[Z] ** 2)
    down = (a[Z] * a - UP) / level
    rate = (change[Z] * a + a[Z] * change) / level + down * a[Z] * change[Z] / level**2
    arm, slope = radius * down, radius * rate
    return arm, hub[2] + cross(wheel.alpha, arm) + cross(wheel.omega, slope), a


def tensor(xx: float, yy: float, zz: float, xz: float = 0.0) -> Array:
    return np.array([[xx, 0, xz], [0, yy, 0], [xz, 0, zz]])


def balances(state: Array, accelerations: Array, forces: Array) -> Array:
    """Newton's and Euler's equations of the bodies, and accelerations where wheels do not slip."""
    x, y, psi, phi, theta, delta, chi, omega = zip(*state.reshape(2, 8), accelerations, strict=True)
    lean = SPACE.turned(Z, *psi).turned(X, *phi)
    frame, behind = lean.turned(Y, *theta), lean.turned(Y, *chi)
    steered = frame.turned(Y, -TILT).turned(Z, *delta)
    fork = steered.turned(Y, TILT)
    ahead = fork.turned(Y, *omega)
    road = np.array([[x[k], y[k], 0.0] for k in range(3)])
    rear = moved(road, lean, 0, 0, REAR)
    foot = moved(rear, frame, BASE + TRAIL, 0, -REAR)
    front = moved(foot, fork, -TRAIL, 0, FRONT)
    rider = moved(rear, frame, 0.3, 0, 0.9 - REAR)
    handlebar = moved(foot, fork, 0.9 - BASE - TRAIL, 0, 0.7)
    on_rear, on_front = forces.reshape(2, 3)
    arm_rear, slip_rear, axle_rear = contact(rear, behind, REAR)
    arm_front, slip_front, axle_front = contact(front, ahead, FRONT)
    of_rider = (85, rider, frame.momentum_rate(tensor(9.2, 11, 2.8, -2.4)))
    of_bar = (4, handlebar, fork.momentum_rate(tensor(0.05892, 0.06, 0.00708, 0.00756)))
    of_rear = (2, rear, behind.momentum_rate(tensor(0.0603, 0.12, 0.0603)))
    of_front = (3, front, ahead.momentum_rate(tensor(0.1405, 0.28, 0.1405)))

    def moment(parts: list[tuple[float, Array, Array]], about: Array) -> Array:
        """Rate of the angular momentum about a point, less the moment of weight."""
        return sum(cross(p[0] - about, m * (p[2] + G * UP)) + rate for m, p, rate in parts)

    whole = [of_rider, of_bar, of_rear, of_front]
    pressing = cross(rear[0] + arm_rear, on_rear) + cross(front[0] + arm_front, on_front)
    turning = moment([of_bar, of_front], foot[0])
    turning = turning - cross(front[0] + arm_front - foot[0], on_front)
    return np.concatenate([
        sum(m * (p[2] + G * UP) for m, p, _ in whole) - on_rear - on_front,
        moment(whole, np.zeros(3)) - pressing,
        # axles and the steering axis transmit no moment about themselves
        [axle_rear @ (of_rear[2] - cross(arm_rear, on_rear)),
         axle_front @ (of_front[2] - cross(arm_front, on_front)),
         steered.matrix[:, Z] @ turning],
        slip_rear, slip_front])  # fmt: skip


def newton_euler(state: Array) -> tuple[Array, Array]:
    """Accelerations, and the forces of the road along, across and normal to both paths."""
    unknown = np.eye(14)
    zero = balances(state, np.zeros(8), np.zeros(6))
    columns = [balances(state, one[:8], one[8:]) - zero for one in unknown]
    solution, _, rank, _ = np.linalg.lstsq(np.transpose(columns), -zero)
    assert rank == 14
    psi, phi, theta, delta = state[2:6]
    lean = SPACE.turned(Z, psi).turned(X, phi)
    fork = lean.turned(Y, theta - TILT).turned(Z, delta)
    forces = []
    for axes, force in zip((lean, fork), solution[8:].reshape(2, 3), strict=True):
        along = cross(axes.matrix[:, Y], UP)
        along /= np.linalg.norm(along)
        forces += [along @ force, cross(UP, along) @ force, force[Z]]
    return solution[:8], np.array(forces)


@pytest.mark.long("derives the bicycle")
def test_accelerations_and_forces_are_those_of_newton_and_euler(module: ModuleType) -> None:
    # oracle: balances of the four bodies in numbers, without Lagrange
    rng = np.random.default_rng(5)
    for _ in range(5):
        guess = np.concatenate([rng.uniform(-0.5, 0.5, 8), rng.normal(size=8)])
        guess[4] = 0.0
        state = consistent_start(module, {"x_dot": rng.uniform(2, 6)}, {}, guess=guess).y
        assert abs(state[4]) < 0.5
        assert np.abs(state[[3, 5]]).min() > 1e-3
        accelerations, forces = newton_euler(state)
        scale = np.abs(accelerations).max()
        rates = np.array(module.rhs(0.0, state, module.DEFAULTS))
        assert np.abs(rates[8:] - accelerations).max() < 1e-11 * scale
        multipliers = module.multipliers(0.0, state, module.DEFAULTS)
        assert multipliers == pytest.approx(forces[[0, 1, 3, 4, 5]], abs=1e-10 * 94 * G)


@pytest.mark.long("compiles the bicycle")
def test_it_recovers_from_a_push_above_the_weave_speed_and_falls_below(module: ModuleType) -> None:
    strict = {"rtol": 1e-11, "atol": 1e-11}
    start = consistent_start(module, rolling(4.6, phi_dot=0.3, theta=0.0), {}).y
    motion = integrate(module, (0, 15), start, {}, **strict)
    lean, steer = motion.y[3], motion.y[5]
    assert np.abs(lean).max() > 0.03
    assert np.abs([lean[-1], steer[-1]]).max() < 0.005
    assert abs(motion.y[2, -1]) > 0.01  # it runs on in another direction
    energy = module.energy_many(motion.t, motion.y, module.DEFAULTS)
    assert np.abs(energy - energy[0]).max() < 1e-10 * energy[0]
    residuals = np.abs(module.constraints_many(motion.t, motion.y, module.DEFAULTS))
    assert residuals[0].max() < 1e-15  # in m, of the front wheel's height
    assert residuals[1:].max() < 1e-13  # in m/s
    start = consistent_start(module, rolling(3.0, phi_dot=0.1, theta=0.0), {}).y
    motion = integrate(module, (0, 5), start, {}, **strict)
    assert np.abs(motion.y[3]).max() > 0.6  # on its way to the road, the fork turned over
    assert np.abs(motion.y[5]).max() > 2
