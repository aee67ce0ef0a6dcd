"""Prescribed motions as inputs: positions depend on them, and their rates of change follow."""

from functools import cache
from math import cos, sin
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from velocity_constraints import CASES, stated

from derive import (
    Coordinate,
    Derivation,
    Input,
    Parameter,
    PointMass,
    System,
    load,
    velocity,
    with_inputs,
)
from derive.system.parts import SystemDefinitionError
from solvers.app.modules import build
from solvers.equations.linearisation.linear_system import linearise
from solvers.equations.module import GeneratedModule
from solvers.integration.integrate import integrate
from solvers.integration.prepare import prepare
from solvers.integration.problem.inputs import Held

theta, x, s, w = sp.symbols("theta x s w", real=True)
length, g, k, c, m = sp.symbols("l g k c m", positive=True)
THETA = Coordinate(theta, "rad", "from the downward vertical")
LENGTH, GRAVITY = Parameter(length, "m", 0.7, "length"), Parameter(g, "m/s^2", 9.81, "gravity")
PIVOT = Input(s, "m", "the pivot", motion=True)
TIGHT = {"rtol": 1e-12, "atol": 1e-12}


def system() -> System:
    masses = [PointMass(1, (s + length * sp.sin(theta), -length * sp.cos(theta)))]
    return System("moved_pivot", "", [THETA], [LENGTH, GRAVITY], masses, inputs=[PIVOT])


@cache
def pendulum() -> GeneratedModule:
    return build(system())


@cache
def swung() -> GeneratedModule:
    """The same with a formula of time, which needs no inputs."""
    return build(with_inputs(system(), {"s": "sin(3*t)/5"}))


def shaken(t: float, y: np.ndarray) -> dict[str, float]:
    return {"s": sin(3 * t) / 5, "s_dot": 0.6 * cos(3 * t), "s_ddot": -1.8 * sin(3 * t)}


def test_equations_of_a_moved_pivot() -> None:
    assert pendulum().INPUTS == ("s", "s_dot", "s_ddot", "s_time")
    assert [pendulum().UNITS[name] for name in pendulum().INPUTS] == ["m", "m/s", "m/s^2", "s"]
    params = pendulum().params(s=5.0, s_dot=2.0, s_ddot=3.0, s_time=1.0)
    rates = pendulum().rhs(4.0, (0.4, 0.2), params)
    assert rates == pytest.approx((0.2, -(9.81 * sin(0.4) + 3 * cos(0.4)) / 0.7), rel=1e-14)
    ((place, _),) = pendulum().positions(4.0, (0.4, 0.2), params)
    assert place == pytest.approx(5 + 2 * 3 + 3 * 9 / 2 + 0.7 * sin(0.4), rel=1e-14)
    assert swung().PARAMETERS == ("l", "g")
    assert Derivation(with_inputs(system(), {"s": 1})).power == 0


@pytest.mark.long("other tests reach its code")
def test_a_function_of_time_is_the_formula() -> None:
    expected = integrate(swung(), (0, 5), {"theta": 1.0}, {}, **TIGHT).y[:, -1]
    motion = integrate(pendulum(), (0, 5), {"theta": 1.0}, {}, inputs=shaken, **TIGHT)
    assert motion.y[:, -1] == pytest.approx(expected, abs=1e-10)
    momenta = integrate(swung(), (0, 5), {"theta": 1.0}, {}, form="hamiltonian", **TIGHT)
    assert momenta.y[:, -1] == pytest.approx(expected, abs=1e-10)


@pytest.mark.parametrize("backend", ["python", "compiled"])
def test_the_acceleration_is_held(backend: str) -> None:
    # a pivot that starts and stops with 2 m/s^2: velocity and position follow between samples
    times, acceleration = [0.0, 1.0, 1.5, 2.5], [2.0, 0.0, -2.0, 0.0]
    table = {"s": [0, 1, 2, 3], "s_dot": [0, 2, 2, 0], "s_ddot": acceleration}
    options = {"backend": backend, **TIGHT}
    held = integrate(pendulum(), (0, 4), (0.0, 0.0), {}, inputs=Held(times, table), **options)
    moved = []
    for begin, end, a in zip(times, [*times[1:], 4.0], acceleration, strict=True):
        start = moved[-1] if moved else (0.0, 0.0)
        inputs = {"s_ddot": a}  # velocities of the pivot do not matter
        run = integrate(pendulum(), (begin, end), start, {}, inputs=inputs, **options)
        moved.append(run.y[:, -1])
    assert held.y[:, -1] == pytest.approx(moved[-1], abs=1e-11)
    sampled = Held(0.5, lambda t, y: {"s": 1.0, "s_dot": t, "s_ddot": 1.0})
    motion = integrate(pendulum(), (0, 2), (0.0, 0.0), {}, inputs=sampled, backend=backend)
    assert motion.inputs[3] == pytest.approx(np.minimum(motion.t // 0.5, 3) * 0.5)


def test_prepared_functions_take_motions() -> None:
    run = prepare(pendulum(), {}, **TIGHT)
    inputs = {"s": 0.3, "s_dot": 0.5, "s_ddot": 2.0, "s_time": 1.0}
    expected = integrate(pendulum(), (0, 2), (0.1, 0.0), {}, inputs=inputs, **TIGHT).y[:, -1]
    assert run((0, 2), (0.1, 0.0), None, inputs) == pytest.approx(expected, abs=1e-11)


def test_a_linear_system_with_the_acceleration_as_input() -> None:
    plant = linearise(pendulum(), {"theta": np.pi}, {})
    B = plant.B[1]
    assert pytest.approx((0.0, 0.0, 1 / 0.7, 0.0)) == B


def test_a_wall_that_moves_a_mass_by_a_spring_and_a_damper(tmp_path: Path) -> None:
    path = tmp_path / "wall.toml"
    path.write_text(
        """
potential = "k*(x - s)**2/2"
forces = { x = "-c*(x_dot - s_dot)" }
[coordinates]
x = { unit = "m" }
[parameters]
m = { value = 2.0, unit = "kg" }
k = { value = 8.0, unit = "N/m" }
c = { value = 0.5, unit = "N s/m" }
[inputs]
s = { unit = "m", motion = true }
[[masses]]
mass = "m"
position = ["x", "0"]
""",
        encoding="utf-8",
    )
    module = build(load(str(path)))
    params = module.params(s=1.0, s_dot=2.0, s_ddot=3.0, s_time=1.0)
    wall, speed = 1 + 2 * 0.5 + 3 * 0.125, 2 + 3 * 0.5
    rates = module.rhs(1.5, (0.3, 0.4), params)
    assert rates[1] == pytest.approx((-8 * (0.3 - wall) - 0.5 * (0.4 - speed)) / 2)
    with pytest.raises(SystemDefinitionError, match=r"s_dot"):
        System("twice", "", [THETA], [LENGTH], [PointMass(1, (s, theta))], 0,
               inputs=[PIVOT, Input(velocity(s), "m/s", "")])  # fmt: skip


def test_inputs_in_potentials() -> None:
    lifted = Input(w, "N/m", "stiffness")
    spring = System(
        "spring", "", [Coordinate(x, "m", "")], [], [PointMass(1, (x, 0))], w * x**2 / 2,
        inputs=[lifted],
    )  # fmt: skip
    module = build(spring)
    assert module.rhs(0.0, (0.5, 0.0), (4.0,))[1] == -2.0
    assert module.energy(0.0, (0.5, 0.0), (4.0,)) == 0.5
    assert module.input_jacobian(0.0, (0.5, 0.0), (4.0,)) == ((0.0,), (-0.5,))
    with pytest.raises(SystemDefinitionError, match=r"positions .* depend on w.*motion=True"):
        Derivation(System("no", "", [THETA], [], [PointMass(1, (w, theta))], 0, inputs=[lifted]))


def test_all_quantities_are_real() -> None:
    """SymPy simplifies roots and moduli of real numbers, which no other symbol allows."""
    d, wheel = Derivation(system()), Derivation(stated("wheel", *CASES["wheel"][:2]))
    derived = [d.lagrangian, d.hamiltonian, d.power, *d.accelerations, *d.momenta]
    symbols = set().union(*(one.free_symbols for one in derived))
    symbols |= {*d.system.qddot, *d.system.p, *wheel.system.multipliers, *wheel.integral_values}
    symbols |= {*d.system.variations, *d.system.parameter_variations}
    assert len({one.name for one in symbols}) == len(symbols) == 20
    assert all(one.is_real for one in symbols)
