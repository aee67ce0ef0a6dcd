"""Integration by splittings: order, agreement of loops, refusals, energy over very long times."""

import re
from importlib import import_module
from math import pi

import numpy as np
import pytest
from sympy import Rational, symbols

import generated
import generated.coupled_pendulums as cp
import generated.double_pendulum as dp
import generated.driven_pendulum as driven
import generated.duffing as duffing
import generated.foucault_pendulum as foucault
import generated.four_bar as four_bar
import generated.henon_heiles as hh
import generated.rotating_hoop as hoop
import generated.single_pendulum as sp
from derive import Coordinate, Input, Parameter, PointMass, System
from solvers import Event, Held, build, ensemble, integrate, prepare
from solvers.equations.energy import coupling
from solvers.equations.module import GeneratedModule
from solvers.integration.checks.predictability import ignore_predictability
from solvers.runge_kutta.method_catalogue import load, names

SPLITTINGS = [name for name in names() if load(name).is_splitting]
START = (0.1, 0.2, 0.3, 0.2)  # of Hénon and Heiles' system, in regular motion
DURATION = 12.0
SEPARABLE = ("coupled_pendulums", "henon_heiles", "rotating_hoop", "single_pendulum")


@pytest.fixture(scope="module")
def exact() -> np.ndarray:
    return integrate(hh, (0, DURATION), START, {}, method="gauss8", rtol=1e-14, atol=1e-15).y[:, -1]


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize("name", SPLITTINGS)
@pytest.mark.parametrize("backend", ["python", "compiled", "lanes"])
def test_every_loop_has_the_order(name: str, backend: str, exact: np.ndarray) -> None:
    order, errors = load(name).order, []
    for h in (0.4, 0.2):
        if backend == "lanes":
            starts = np.tile(START, (3, 1)).T
            end = ensemble(hh, (0, DURATION), starts, {}, method=name, h=h).y[:, 0]
        else:
            options = {"method": name, "h": h, "backend": backend}
            end = integrate(hh, (0, DURATION), START, {}, **options).y[:, -1]
        errors.append(np.abs(end - exact).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.4)


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize("name", SPLITTINGS)
def test_loops_agree_with_samples_and_events(name: str) -> None:
    events = [Event(hh, "x", 0.0), Event(hh, "y_dot", 0.1, direction=1)]
    options = {"method": name, "h": 0.1, "t_eval": np.linspace(0, DURATION, 77), "events": events}
    python, compiled = (
        integrate(hh, (0, DURATION), START, {}, backend=backend, energy=True, **options)
        for backend in ("python", "compiled")
    )
    starts = np.tile(START, (5, 1)).T
    lanes = ensemble(hh, (0, DURATION), starts, {}, occurrences=9, **options)
    assert python.y == pytest.approx(compiled.y, abs=1e-13)
    assert lanes.samples[:, 0] == pytest.approx(compiled.y, abs=1e-13)
    assert python.energy == pytest.approx(compiled.energy, abs=1e-14)
    for k in range(2):
        assert len(python.t_events[k]) > 1
        assert python.t_events[k] == pytest.approx(compiled.t_events[k], abs=1e-12)
        found = lanes.t_events[0, k, : len(python.t_events[k])]
        assert found == pytest.approx(compiled.t_events[k], abs=1e-12)
    run = prepare(hh, {}, method=name, h=0.1)
    assert run((0, DURATION), START) == pytest.approx(compiled.y[:, -1], abs=1e-13)


@pytest.mark.parametrize("backend", ["python", "compiled"])
@pytest.mark.parametrize("name", SPLITTINGS)
def test_samples_and_events_do_not_change_the_steps(name: str, backend: str) -> None:
    options = {"method": name, "h": 0.25, "backend": backend}
    plain = integrate(hh, (0, DURATION), START, {}, **options)
    times, event = np.linspace(0, DURATION, 1001), Event(hh, "x", 0.0)
    sampled = integrate(hh, (0, DURATION), START, {}, t_eval=times, events=event, **options)
    assert sampled.steps == plain.steps
    assert np.array_equal(sampled.y[:, -1], plain.y[:, -1])


@pytest.mark.parametrize("name", SPLITTINGS)
def test_samples_are_as_accurate_as_the_ends_of_steps(name: str) -> None:
    times = np.linspace(0.013, DURATION, 400)
    exact = integrate(hh, (0, DURATION), START, {}, rtol=1e-13, atol=1e-14, t_eval=times)
    steps = integrate(hh, (0, DURATION), START, {}, method=name, h=0.2)
    at_ends = integrate(hh, (0, DURATION), START, {}, rtol=1e-13, atol=1e-14, t_eval=steps.t)
    largest = np.abs(steps.y - at_ends.y).max()
    for backend in ("python", "compiled"):
        run = integrate(
            hh, (0, DURATION), START, {}, method=name, h=0.2, t_eval=times, backend=backend
        )
        assert np.abs(run.y - exact.y).max() < 1.5 * largest


@pytest.mark.parametrize("name", SPLITTINGS)
def test_a_motion_leads_back_to_its_start(name: str) -> None:
    for backend in ("python", "compiled"):
        options = {"method": name, "h": 0.25, "backend": backend}
        end = integrate(hh, (0, 10), START, {}, **options).y[:, -1]
        assert integrate(hh, (10, 0), end, {}, **options).y[:, -1] == pytest.approx(
            START, abs=1e-13
        )


def test_systems_with_a_constant_mass_matrix_and_forces_of_positions_are_separable() -> None:
    modules = [import_module(f"generated.{name}") for name in generated.__all__]
    assert {module.SYSTEM for module in modules if not coupling(module)} == {*SEPARABLE}


@pytest.mark.parametrize("name", SEPARABLE)
def test_accelerations_of_separable_systems_ignore_velocities(name: str) -> None:
    module = import_module(f"generated.{name}")
    random = np.random.default_rng(3)
    n = len(module.COORDINATES)
    for _ in range(20):
        q, v, w = random.normal(size=(3, n))
        one, other = (module.rhs(0.3, [*q, *u], module.DEFAULTS)[n:] for u in (v, w))
        assert one == other


@pytest.mark.parametrize(("module", "reason"), [
    (dp, "the mass matrix of the system double_pendulum depends on theta1 and theta2"),
    (duffing, "accelerations of the system duffing depend on x_dot"),
    (driven, "accelerations of the system driven_pendulum depend on theta_dot"),
    (foucault, "the mass matrix of the system foucault_pendulum depends on x and y"),
    (four_bar, "the system four_bar has constraints"),
])  # fmt: skip
def test_other_systems_are_refused_with_the_reason(module: GeneratedModule, reason: str) -> None:
    message = f"method 'leapfrog' needs .*{reason}.*use a Gauss method.*'gauss4'"
    start = {} if module is four_bar else dict.fromkeys(module.COORDINATES, 0.1)
    starts = np.full((len(module.STATE), 2), 0.1)
    with pytest.raises(ValueError, match=message):
        integrate(module, (0, 1), start, {}, method="leapfrog", h=0.1)
    with pytest.raises(ValueError, match=message):
        ensemble(module, (0, 1), starts, {}, method="leapfrog", h=0.1)
    with pytest.raises(ValueError, match=message):
        prepare(module, {}, method="leapfrog", h=0.1)


@pytest.mark.parametrize(("options", "message"), [
    ({}, "steps are equal: give a fixed step h"),
    ({"h": 0.1, "form": "hamiltonian"}, "form 'hamiltonian' is not: leave out form"),
    ({"h": 0.1, "form": "variational"}, "form 'variational' is not: leave out form"),
    ({"accuracy": 1e-6}, "give a fixed step h"),
])  # fmt: skip
def test_other_forms_and_step_control_are_refused(options: dict[str, object], message: str) -> None:
    start = (0.1,) * (4 if options.get("form") == "variational" else 2)
    with pytest.raises(ValueError, match=f"method 'leapfrog4' .*{re.escape(message)}"):
        integrate(sp, (0, 1), start, {}, method="leapfrog4", **options)


def test_inputs_may_be_held_but_are_no_function_of_the_velocity() -> None:
    x = symbols("x", real=True)
    m, k = symbols("m k", positive=True)
    F = symbols("F", real=True)
    system = System(
        name="pushed",
        title="A mass that is pushed",
        coordinates=[Coordinate(x, "m", "position")],
        parameters=[Parameter(m, "kg", 1.0, "mass"), Parameter(k, "N/m", 4.0, "stiffness")],
        inputs=[Input(F, "N", "push")],
        masses=[PointMass(m, (x, 0))],
        potential=k * x**2 / 2,
        forces={x: F},
    )
    module = build(system)
    held = Held(0.5, lambda t, y: np.array([np.sin(t)]))
    one, other = (
        integrate(module, (0, 5), {"x": 0.3}, {}, inputs=held, **options).y[:, -1]
        for options in ({"method": "leapfrog8", "h": 0.1}, {"rtol": 1e-13, "atol": 1e-14})
    )
    assert one == pytest.approx(other, abs=1e-9)
    with pytest.raises(ValueError, match="hold the inputs between samples"):
        integrate(
            module, (0, 5), {"x": 0.3}, {}, method="leapfrog", h=0.1, inputs=lambda t, y: -y[1:]
        )


def test_a_system_of_the_user_is_separable_by_its_derivation() -> None:
    x, y = symbols("x y", real=True)
    m, mu = symbols("m mu", positive=True)
    orbit = build(
        System(
            name="orbit",
            title="Kepler's problem",
            coordinates=[Coordinate(x, "m", "position"), Coordinate(y, "m", "position")],
            parameters=[Parameter(m, "kg", 1.0, "mass"), Parameter(mu, "m^3/s^2", 1.0, "pull")],
            masses=[PointMass(m, (x, y))],
            potential=-m * mu / (x**2 + y**2) ** Rational(1, 2),
        )
    )
    run = integrate(orbit, (0, 2 * pi), (1.0, 0.0, 0.0, 1.0), {}, method="leapfrog8", h=pi / 30)
    assert run.y[:, -1] == pytest.approx((1, 0, 0, 1), abs=1e-6)


def energy_errors(periods: float, **options: object) -> np.ndarray:
    """Relative errors of the energy of a pendulum at 1000 times, over many periods."""
    period = 2 * pi * np.sqrt(2.0 / 9.81)  # of small oscillations
    span = (0.0, periods * period)
    times = np.linspace(*span, 1001)
    with ignore_predictability():
        run = integrate(
            sp, span, (1.0, 0.0), {}, t_eval=times, energy=True, max_steps=10**9, **options
        )
    depth = sp.energy(0.0, (0.0, 0.0), sp.DEFAULTS)
    return (run.energy - run.energy[0]) / (run.energy[0] - depth)


@pytest.mark.long("other tests reach its code", daily=4)
@pytest.mark.parametrize("name", SPLITTINGS)
@pytest.mark.parametrize(
    "periods",
    [1e4, pytest.param(1e6, marks=pytest.mark.long("a million periods of a pendulum"))],
)
def test_the_energy_error_stays_bounded_while_that_of_rk4_grows(name: str, periods: float) -> None:
    h = {"leapfrog": 0.05, "leapfrog4": 0.15, "leapfrog6": 0.3, "leapfrog8": 0.4}[name]
    error = np.abs(energy_errors(periods, method=name, h=h, compensated=True))
    # samples meet few of the peaks, so their root mean squares are compared; a drift doubles these
    first, last = (np.sqrt(np.mean(half**2)) for half in np.array_split(error, 2))
    assert last == pytest.approx(first, rel=0.2)
    drifting = np.abs(energy_errors(periods, method="rk4", h=0.05))
    assert drifting[-1] > 5 * max(drifting[100], error.max())


@pytest.mark.long("other tests reach its code")
def test_hoop_and_pendulums_keep_their_energies() -> None:
    for module, start in ((hoop, (1.0, 0.3)), (cp, (0.5, -0.2, 0.0, 0.1))):
        run = integrate(module, (0, 200), start, {}, method="leapfrog6", h=0.1, energy=True)
        assert np.ptp(run.energy) < 1e-5 * np.abs(run.energy).max()
