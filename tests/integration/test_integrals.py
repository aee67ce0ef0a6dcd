"""Integrable constraints of velocities: their integrals stay as at the start, to rounding."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

import numpy as np
import pytest
import sympy as sp
from velocity_constraints import (
    CASES,
    VALUES,
    J,
    M,
    R,
    a,
    c0,
    dphi,
    dx,
    dy,
    g,
    k,
    m,
    mechanism,
    phi,
    stated,
    theta,
    x,
    y,
)

from derive import (
    Input,
    PointMass,
    RigidBody,
    velocity,
)
from derive.mechanics.constraints.differentiated_constraints import Constraints
from holonomic import build, ensemble, integrate, prepare
from solvers.equations.consistent_start import consistent_start
from solvers.equations.module import GeneratedModule
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.compiled.extended import integrate_extended
from solvers.integration.problem.inputs import Held
from solvers.references.taylor import taylor


@cache
def by_velocity(name: str) -> tuple[GeneratedModule, np.ndarray]:
    """A mechanism with its constraint of velocities, and its start."""
    integral, rate, given = CASES[name]
    module = build(stated(name, integral, rate))
    return module, consistent_start(module, given, {}).y


@cache
def by_position(name: str) -> tuple[GeneratedModule, tuple[float, ...]]:
    """The mechanism with the constraint of positions, and parameters with the constant."""
    integral, _, given = CASES[name]
    module = build(stated(name, integral, None))
    numbers = {s: value for s, (_, value) in VALUES.items()}
    numbers |= {s: given[s.name] for s in (x, y, phi) if s.name in given}
    return module, module.params(c0=float(integral.subs(numbers)))


def change(module: GeneratedModule, t: np.ndarray, y: np.ndarray) -> float:
    """The largest change of the integrals along a motion."""
    values = module.integrals_many(t, y, module.DEFAULTS)
    return float(np.abs(values - values[:, :1]).max())


METHODS = ("rk4", "verner853", "gauss4", "gauss8", "radau3", "radau5")


@pytest.mark.long("other tests reach its code", daily=16)
@pytest.mark.parametrize(
    ("name", "method", "backend"),
    [
        *((name, method, "python") for name in CASES for method in METHODS),
        *(("yoke", method, "compiled") for method in METHODS),
        *((name, "verner853", "compiled") for name in CASES if name != "yoke"),
    ],
)
def test_motions_are_those_of_the_constraint_of_positions(
    name: str, method: str, backend: str
) -> None:
    (module, y0), (other, params) = by_velocity(name), by_position(name)
    # steps are fixed: those that are controlled depend on rounding errors
    options = {"method": method, "h": 0.01, "backend": backend, "t_eval": np.linspace(0, 2, 21)}
    one = integrate(module, (0, 2), y0, {}, **options)
    two = integrate(other, (0, 2), y0, params, **options)
    assert np.abs(one.y - two.y).max() < 1e-13
    assert change(module, one.t, one.y) < 1e-15


@pytest.mark.parametrize("method", ["DOP853", "LSODA"])
def test_scipy_s_methods_keep_integrals(method: str) -> None:
    module, y0 = by_velocity("rack")
    motion = integrate(module, (0, 5), y0, {}, method=method, rtol=1e-6)
    assert motion.steps > 20
    assert change(module, motion.t, motion.y) < 1e-15


@contextmanager
def drifting(monkeypatch: pytest.MonkeyPatch, name: str) -> Iterator[GeneratedModule]:
    """A mechanism with its constraint of velocities, whose integral is not kept."""
    integral, rate, _ = CASES[name]
    with monkeypatch.context() as patch:
        patch.setattr(Constraints, "integrals", ())
        yield build(stated(f"{name}_without_integral", integral, rate))


@pytest.mark.long("other tests reach its code", daily=4)
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("steps", [100_000, pytest.param(1_000_000, marks=pytest.mark.slow)])
def test_integrals_are_constant_over_long_runs(
    monkeypatch: pytest.MonkeyPatch, name: str, steps: int
) -> None:
    module, y0 = by_velocity(name)
    times = np.linspace(0, 0.01 * steps, 101)
    options = {"method": "rk4", "h": 0.01, "backend": "compiled", "t_eval": times}
    kept = integrate(module, (0, times[-1]), y0, {}, **options)
    # no other thread generates functions without the patch
    with drifting(monkeypatch, name) as free, ignore_predictability():
        lost = integrate(free, (0, times[-1]), y0, {}, **options)
    assert kept.steps == lost.steps == steps
    assert change(module, kept.t, kept.y) < 1e-15
    # Runge-Kutta methods leave linear functions constant, but for rounding errors
    least = 2e-14 if name == "wheel" else 1e-13 * steps
    assert change(module, lost.t, lost.y) > least


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize("backend", ["python", "compiled"])
def test_an_integrable_constraint_beside_one_that_is_not(backend: str) -> None:
    # a skate, which drives a wheel by its heading
    edge = dx * sp.sin(theta) - dy * sp.cos(theta)
    wheel = phi - theta - sp.sin(theta) / 2
    rate = dphi - (1 + sp.cos(theta) / 2) * velocity(theta)
    body = (x + a * sp.cos(theta), y + a * sp.sin(theta))
    masses = [RigidBody(M, body, J, theta), RigidBody(m, (0, 0), J, phi)]
    q, weight = (x, y, theta, phi), m * g * R * sp.cos(phi)
    one, two = (
        build(mechanism(name, q, masses, edge, constraint, potential=weight))
        for name, constraint in (("by_rate", rate), ("by_angle", wheel - c0))
    )
    assert one.INTEGRALS == ("-2*phi + 2*theta + sin(theta)",)
    y0 = consistent_start(one, {"phi": 0.3, "theta_dot": 1.0, "x_dot": 0.5}, {}).y
    options = {"method": "rk4", "h": 0.01, "backend": backend}
    motion = integrate(one, (0, 3), y0, {}, **options)
    other = integrate(two, (0, 3), y0, two.params(c0=0.3), **options)
    assert np.ptp(motion.y[2]) > 1
    assert np.abs(motion.y - other.y).max() < 1e-12
    assert change(one, motion.t, motion.y) < 2e-15
    assert np.abs(one.constraints_many(0.0, motion.y, one.DEFAULTS)).max() < 1e-14


@pytest.mark.long("other tests reach its code")
def test_lanes_single_motions_and_python_agree() -> None:
    module, y0 = by_velocity("yoke")
    starts = np.tile(y0[:, np.newaxis], 20)
    starts[0] += 0.1 * np.arange(20)  # each with a constant of its own
    many = ensemble(module, (0, 3), starts, {}, rtol=1e-10)
    run = prepare(module, module.DEFAULTS, rtol=1e-10)
    before = module.integrals_many(0.0, starts, module.DEFAULTS)
    after = module.integrals_many(3.0, many.y, module.DEFAULTS)
    assert np.ptp(before) > 1.8
    assert np.abs(after - before).max() < 5e-16
    for n, start in enumerate(starts.T):
        assert np.abs(np.array(run((0, 3), start.tolist())) - many.y[:, n]).max() < 1e-10
    slow = integrate(module, (0, 3), starts[:, 7], {}, rtol=1e-10, backend="python")
    assert np.abs(slow.y[:, -1] - many.y[:, 7]).max() < 1e-10


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("backend", ["python", "compiled"])
def test_constants_are_kept_while_inputs_and_signs_change(backend: str) -> None:
    u = sp.Symbol("u", real=True)
    friction = -sp.Rational(1, 2) * sp.sign(dphi)
    masses = [PointMass(M, (x, 0)), PointMass(m, (R * sp.cos(phi), R * sp.sin(phi)))]
    system = mechanism("driven", (x, phi), masses, CASES["rack"][1], forces=(u, friction),
        potential=k * x**2 / 2 + g * m * x, inputs=[Input(u, "N", "force")])  # fmt: skip
    module, y0 = build(system), by_velocity("rack")[1]
    inputs = Held(0.25, {"u": np.resize([4.0, -5.0, 1.0, 0.0], 80)})
    motion = integrate(module, (0, 20), y0, {}, inputs=inputs, backend=backend, rtol=1e-6)
    assert motion.steps > 150
    assert np.ptp(motion.y[1]) > 1
    assert change(module, motion.t, motion.y) < 1e-15


def test_perturbations_change_the_constants() -> None:
    module, y0 = by_velocity("yoke")
    moved = np.array([1.0, 0.0, 0.0, 0.0])  # of x alone, which its constraint does not restrict
    start, times, step = np.array([*y0, *moved]), [0.0, 1.0], 1e-5
    ends = [integrate(module, (0, 1), y0 + s * step * moved, {}, rtol=1e-12, atol=1e-14).y[:, -1]
        for s in (-1, 1)]  # fmt: skip
    for backend in ("python", "compiled"):
        motion = integrate(module, (0, 1), start, {}, form="variational", backend=backend,
            rtol=1e-11, atol=1e-13, t_eval=times)  # fmt: skip
        assert np.abs(motion.y[4:, -1] - (ends[1] - ends[0]) / (2 * step)).max() < 1e-7
        gradient = np.array([1.0, 0.2 * np.sin(motion.y[1, -1])])
        assert gradient @ motion.y[4:6, -1] == pytest.approx(1.0, abs=1e-10)


@pytest.mark.parametrize("precision", ["double-double", "long double", "quadruple"])
def test_long_numbers_keep_the_constant_of_the_start(precision: str) -> None:
    # oracle: Taylor series, whose projection has no code in common
    module, y0 = by_velocity("yoke")
    times = [0.0, 1.0, 2.0]
    expected = taylor(module, module.DEFAULTS, y0, times, digits=32)
    states = integrate_extended(module, module.DEFAULTS, y0, times, precision, 1e-19)
    assert np.abs(states - expected).max() < 1e-15
    assert change(module, np.array(times), states.T) < 2e-16
