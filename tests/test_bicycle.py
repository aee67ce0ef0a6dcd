"""The bicycle of Whipple and Carvallo, from positions, two wheels that roll and one condition.

Published eigenvalues: J. P. Meijaard, J. M. Papadopoulos, A. Ruina, A. L. Schwab, Linearized
dynamics equations for the balance and steer of a bicycle: a benchmark and review, Proceedings of
the Royal Society A 463 (2007), tables 1 and 2. There z points down and y to the right.
"""

from types import ModuleType

import numpy as np
import pytest
import sympy as sp
from sympy import Matrix, Rational

from derive import (
    Constraint,
    Coordinate,
    Derivation,
    Parameter,
    RigidBody,
    System,
    rolling_on_plane,
    rotations,
    velocity,
)
from derive.codegen.backends.python import backend
from derive.codegen.functions import contents
from derive.system.orientation import Orientation
from solvers import linearise

Q = sp.symbols("x y psi phi theta delta chi omega", real=True)
g = sp.Symbol("g", real=True)
x, y, psi, phi, theta, delta, chi, omega = Q
UP = Matrix([0, 0, 1])
#: Wheel base, trail, tilt of the steer axis, radii of the wheels.
BASE, TRAIL, TILT, REAR, FRONT = (
    *(Rational(102, 100), Rational(8, 100), sp.pi / 10),
    *(Rational(30, 100), Rational(35, 100)),
)
#: Weave, capsize and castering at 5 m/s, and two of four real eigenvalues at rest.
AT_5 = (-0.775341882195845 + 4.46486771378823j, -0.32286642900409, -14.0783896927982)
AT_REST = (3.13164324790656, 5.53094371765393)


def tensor(xx: str, yy: str, zz: str, xz: str = "0") -> Matrix:
    """Moments of inertia; xz is that of the source, whose sign changes with the axes."""
    a, b, c, d = map(Rational, (xx, yy, zz, xz))
    return Matrix([[a, 0, d], [0, b, 0], [d, 0, c]])


def slip(centre: Matrix, frame: Orientation, spin: sp.Symbol, arm: Matrix) -> Matrix:
    """Velocity of a wheel's point of contact, in axes of the frame in which it spins about y."""
    rates = [velocity(q) for q in Q]
    turns = (Matrix(frame.turn(q)) * rate for q, rate in zip(Q, rates, strict=True))
    turning = sum(turns, Matrix([0, velocity(spin), 0]))
    return frame.matrix.T * centre.jacobian(Q) * Matrix(rates) + turning.cross(arm)


def bicycle() -> System:
    """Heading psi, lean phi, pitch theta, steer delta; chi and omega turn the wheels."""
    plane, frame = rotations("zx", (psi, phi)), rotations("zxy", (psi, phi, theta))
    fork = rotations("zxyyzy", (psi, phi, theta, -TILT, delta, TILT))
    rear = Matrix([x, y, 0]) + plane.matrix * Matrix([0, 0, REAR])
    steer = rear + frame.matrix * Matrix([BASE + TRAIL, 0, -REAR])  # where its axis meets the road
    front = steer + fork.matrix * Matrix([-TRAIL, 0, FRONT])
    rider = rear + frame.matrix * Matrix([Rational(3, 10), 0, Rational(9, 10) - REAR])
    handlebar = steer + fork.matrix * Matrix([Rational(9, 10) - BASE - TRAIL, 0, Rational(7, 10)])
    up = fork.matrix.T * UP
    height = sp.sqrt(up[0] ** 2 + up[2] ** 2)
    behind = slip(rear, plane, chi, Matrix([0, 0, -REAR]))
    ahead = slip(front, fork, omega, -FRONT / height * Matrix([up[0], 0, up[2]]))
    return System("bicycle", "Bicycle of Whipple and Carvallo",
        [Coordinate(q, "m" if q in (x, y) else "rad", str(q)) for q in Q],
        [Parameter(g, "m/s^2", 9.81, "gravity")],
        [RigidBody(85, rider, tensor("9.2", "11", "2.8", "-2.4"), frame),
         RigidBody(4, handlebar, tensor("0.05892", "0.06", "0.00708", "0.00756"), fork),
         RigidBody(2, rear, tensor("0.0603", "0.12", "0.0603"),
                   rotations("zxy", (psi, phi, chi))),
         RigidBody(3, front, tensor("0.1405", "0.28", "0.1405"),
                   rotations("zxyyzyy", (psi, phi, theta, -TILT, delta, TILT, omega)))],
        constraints=[
            Constraint(behind[0], "rear_x", "N"), Constraint(behind[1], "rear_y", "N"),
            Constraint(front[2] - FRONT * height, "front_z", "N"),
            Constraint(up[2] * ahead[0] - up[0] * ahead[2], "front_x", "N"),
            Constraint(ahead[1], "front_y", "N")])  # fmt: skip


def test_a_steered_wheel_that_leans_rolls() -> None:
    # oracle: the velocity of its point of contact, from angular velocities
    axes = ("zxyyzy", (psi, phi, theta, -TILT, delta, TILT))
    fork, wheel = rotations(*axes), rotations(axes[0] + "y", (*axes[1], omega))
    up, centre = fork.matrix.T * UP, Matrix([x, y, phi])
    arm = Matrix([up[0], 0, up[2]]) * -FRONT / sp.sqrt(up[0] ** 2 + up[2] ** 2)
    slips = fork.matrix * slip(centre, fork, omega, arm)
    joint = rolling_on_plane("road", Q, centre, fork.matrix * arm, wheel)
    state = [*Q, *map(velocity, Q)]
    formulas = [[one.formula for one in joint[:2]], [*slips[:2]]]
    values = sp.lambdify(state, formulas, "math", cse=True)
    given, expected = values(*np.random.default_rng(1).uniform(-1, 1, len(state)))
    assert given == pytest.approx(expected, rel=1e-11)


@pytest.fixture(scope="module")
def module() -> ModuleType:
    names = {"rhs", "jacobian", "constraints", "constraints_jacobian", "mass_matrix"}
    module = ModuleType("bicycle")
    exec(backend.file(contents(Derivation(bicycle()), names)), module.__dict__)
    return module


def test_eigenvalues_are_those_of_the_benchmark(module: ModuleType) -> None:
    for speed, published in ((5.0, AT_5), (0.0, AT_REST)):
        motion = {"x_dot": speed, "chi_dot": speed / 0.3, "omega_dot": speed / 0.35}
        linear = linearise(module, motion, {})
        accelerations = linear.rate[len(Q) :]
        assert np.abs(accelerations).max() < 1e-13  # it runs straight at constant speed
        assert linear.A.shape == (10, 10)
        for value in published:
            error = np.abs(linear.eigenvalues - value).min()
            assert error < 1e-12 * max(1.0, abs(value)), (speed, value, error)


def test_it_falls_at_low_speed_and_runs_by_itself_between_weave_and_capsize(
    module: ModuleType,
) -> None:
    # published: stable from 4.292 to 6.024 m/s; heading, place and turns of wheels are neutral
    for speed, is_stable in ((4.28, False), (4.30, True), (6.02, True), (6.03, False)):
        motion = {"x_dot": speed, "chi_dot": speed / 0.3, "omega_dot": speed / 0.35}
        growth = linearise(module, motion, {}).eigenvalues.real.max()
        assert (growth < 1e-6) == is_stable, (speed, growth)
