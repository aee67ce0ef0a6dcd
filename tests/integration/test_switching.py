"""Steps end at kinks and jumps of forces, so that methods keep their order."""

from collections.abc import Callable, Sequence
from functools import cache
from math import cos, pi, sin, sqrt

import numpy as np
import pytest
import sympy as sp
from scipy.optimize import brentq

from derive import TIME, Coordinate, Parameter, PointMass, System, velocity
from solvers.app.modules import build
from solvers.equations.module import GeneratedModule, switching_functions
from solvers.integration.integrate import integrate
from solvers.integration.problem.events import Event
from solvers.integration.problem.status import Status

x, a, F = sp.symbols("x a F", real=True)
v = velocity(x)
BACKENDS = ("python", "compiled")


def oscillator(
    name: str, potential: sp.Expr = sp.S.Zero, force: sp.Expr = sp.S.Zero
) -> GeneratedModule:
    parameters = [Parameter(a, "m", 0.5, "place of the stop"), Parameter(F, "N", 0.1, "friction")]
    coordinates = [Coordinate(x, "m", "position")]
    forces = (force - x,)
    masses = [PointMass(1, (x, 0))]
    return build(System(name, "", coordinates, parameters, masses, potential, forces=forces))


@cache
def stop() -> GeneratedModule:
    return oscillator("bump_stop", 25 * sp.Max(0, x - a) ** 2)


@cache
def friction() -> GeneratedModule:
    return oscillator("dry_friction", force=-F * sp.sign(v))


def in_stop(t: float) -> tuple[float, float]:
    """The motion from x = -1 at rest, in closed form from contact to contact."""
    state, stiff, begin = (-1.0, 0.0), False, 0.0
    while True:
        (start, rate), w, centre = state, sqrt(51) if stiff else 1.0, 25 / 51 if stiff else 0.0

        def at(s: float, start=start, rate=rate, w=w, centre=centre) -> tuple[float, float]:
            b = start - centre
            place = centre + b * cos(w * s) + rate / w * sin(w * s)
            return place, rate * cos(w * s) - b * w * sin(w * s)

        grid = np.arange(1e-6, t - begin, 1e-3)
        signs = np.array([at(s)[0] > 0.5 for s in grid])
        changes = np.flatnonzero(signs != stiff)
        if not changes.size:
            return at(t - begin)
        k = int(changes[0])
        end = brentq(lambda s: at(s)[0] - 0.5, grid[k] - 1e-3, grid[k], xtol=1e-16)
        state, stiff, begin = (0.5, at(end)[1]), not stiff, begin + end


def with_friction(t: float) -> tuple[float, float]:
    """The motion from x = 1 at rest, in half periods about -F and F in turn."""
    start, centre = 1.0, 0.1
    while t > pi:
        start, centre, t = 2 * centre - start, -centre, t - pi
    return centre + (start - centre) * cos(t), -(start - centre) * sin(t)


CASES = ((stop, -1.0, in_stop, 100), (friction, 1.0, with_friction, 25))


def errors(
    module: GeneratedModule,
    start: float,
    exact: Callable[[float], tuple[float, float]],
    method: str,
    steps: Sequence[int],
    backend: str,
) -> np.ndarray:
    ends = [
        integrate(
            module, (0, 5), (start, 0.0), module.DEFAULTS, method=method, h=5 / n, backend=backend
        ).y[:, -1]
        for n in steps
    ]
    return np.abs(np.array(ends) - exact(5.0)).max(axis=1)


@pytest.mark.long("more cases of the same kind", keep=2, daily=6)
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("case", "start", "exact", "n"), CASES)
@pytest.mark.parametrize(("method", "order"), [("rk4", 4), ("bs32", 3), ("radau3", 5)])
def test_methods_keep_their_order(
    case, start: float, exact, n: int, method: str, order: int, backend: str
) -> None:
    first, second = errors(case(), start, exact, method, (2 * n, 4 * n), backend)
    assert first > 1e-13
    assert np.log2(first / second) > order - 0.3


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("case", "start", "exact", "n"), CASES)
def test_high_orders_reach_rounding_errors(case, start, exact, n, backend) -> None:
    assert errors(case(), start, exact, "verner98", (4 * n,), backend)[0] < 1e-14


@pytest.mark.parametrize(("case", "start", "exact", "n"), CASES)
def test_without_switching_the_order_is_low(case, start, exact, n, monkeypatch) -> None:
    monkeypatch.setattr("solvers.equations.forms.Form.switching_count", 0)
    sizes = [2**k * n for k in range(2, 7)]
    found = errors(case(), start, exact, "rk4", sizes, "python")
    order = np.log2(found[0] / found[-1]) / 4
    assert order < 3
    assert errors(case(), start, exact, "verner98", (4 * n,), "python")[0] > 1e-9


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("method", "form"),
    [("verner98", None), ("verner98", "hamiltonian"), ("radau5", None), ("gauss8", None)],
)
def test_controlled_steps_keep_the_accuracy(method: str, form: str | None, backend: str) -> None:
    if method == "gauss8" and backend == "compiled":
        with pytest.raises(ValueError, match="kinks or jumps, at which parallel stages"):
            integrate(stop(), (0, 5), (-1, 0), stop().DEFAULTS, method=method, backend=backend)
        return
    for case, start, exact, _ in CASES:
        module, options = case(), {"method": method, "form": form, "backend": backend}
        motion = integrate(module, (0, 5), (start, 0.0), module.DEFAULTS, rtol=1e-12, **options)
        assert motion.status is Status.FINISHED
        assert motion.y[:, -1] == pytest.approx(exact(5.0), abs=1e-9)
        plain = integrate(module, (0, 5), (start, 0.0), module.DEFAULTS, method="dop853")
        assert plain.global_error_estimate[:, -1].max() < 1e-6


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("direction", [1, -1])
def test_friction_holds_a_body(backend: str, direction: int) -> None:
    module = friction()
    force = module.DEFAULTS if direction > 0 else (0.5, -0.1)  # backwards friction drives
    times = direction * np.array([0, 15.0, 15.8, 100])  # 1.05 loses 0.2 each half period
    motion = integrate(
        *(module, (0, direction * 100), (1.05, 0.0), force), backend=backend, t_eval=times
    )
    assert motion.status is Status.FINISHED
    assert motion.y[:, 1] == pytest.approx(
        (0.1 + 0.15 * cos(15.0), -0.15 * direction * sin(15.0)), abs=1e-6
    )
    assert motion.y[:, 2:] == pytest.approx(np.array([[-0.05] * 2, [0.0] * 2]), abs=1e-7)
    rest = integrate(module, (0, 1), (0.05, 0.0), module.DEFAULTS, backend=backend)
    assert rest.y[:, -1] == pytest.approx((0.05, 0.0), abs=1e-15)


@pytest.mark.parametrize("backend", BACKENDS)
def test_events_samples_and_steps_are_those_of_the_whole_motion(backend: str) -> None:
    module = stop()
    middle = Event(module, "x", 0.0)
    times = np.linspace(0, 20, 801)
    options = {"rtol": 1e-12, "events": [middle], "backend": backend}
    motion = integrate(module, (0, 20), (-1, 0), module.DEFAULTS, t_eval=times, **options)
    assert np.array_equal(motion.t, times)
    for t, y in zip(motion.t[50::250], motion.y.T[50::250], strict=True):
        assert y == pytest.approx(in_stop(t), abs=1e-9)
    (roots,) = motion.t_events
    assert in_stop(roots[3])[0] == pytest.approx(0.0, abs=1e-9)
    assert len(roots) == np.count_nonzero(np.diff(np.sign(motion.y[0])))


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_short_contact_within_a_step_is_found(backend: str) -> None:
    # the body reaches 1, the stop is just before that: a step may pass the contact
    module = stop()
    motion = integrate(
        module, (0, 6), (-1.0, 0.0), (0.999, 0.1), method="verner98", h=1.5, backend=backend
    )
    fine = integrate(module, (0, 6), (-1.0, 0.0), (0.999, 0.1), rtol=1e-13, atol=1e-14)
    smooth = integrate(module, (0, 6), (-1.0, 0.0), (2.0, 0.1), rtol=1e-13, atol=1e-14)
    assert abs(fine.y[:, -1] - smooth.y[:, -1]).max() > 1e-4
    assert abs(motion.y[:, -1] - fine.y[:, -1]).max() < 1e-5


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("backend", BACKENDS)
def test_kinks_of_time_and_of_nested_functions_are_switches(backend: str) -> None:
    pulse = sp.Max(0, 1 - sp.Abs(TIME - 2)) + sp.Min(sp.Max(-3 * x, -sp.Abs(x - 1) / 2), sp.S.Half)
    module = oscillator("nested", force=pulse + sp.Piecewise((1, x > v), (0, True)))
    assert len(switching_functions(module)) == 6
    ends = [
        integrate(
            module, (0, 5), (-1.0, 0.3), module.DEFAULTS, method=method, backend=backend, **options
        ).y[:, -1]
        for method, options in (("verner98", {"h": 0.05}), ("dop853", {"rtol": 1e-13}))
    ]
    assert abs(ends[0] - ends[1]).max() < 1e-10


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_switch_that_moves_another_kink_beyond_the_state_switches_this_too(backend: str) -> None:
    force = x + sp.sign(x - 3 * sp.sign(TIME - 1))  # 1 up to t = 1, then -1 before x = 3
    module = oscillator("moved_kink", force=force)
    motion = integrate(module, (0, 2), (0.0, 0.0), {}, backend=backend, t_eval=[1.0, 2.0])
    assert motion.status is Status.FINISHED
    assert motion.y[0] == pytest.approx([0.5, 1.0], abs=1e-9)
    assert motion.y[1] == pytest.approx([1.0, 0.0], abs=1e-9)


@pytest.mark.parametrize("relation", [sp.Gt, sp.Ge, sp.Lt, sp.Le, sp.Eq, sp.Ne])
def test_a_force_acts_on_its_side_of_a_jump(relation: type[sp.Rel]) -> None:
    force = sp.Piecewise((2, relation(x, a)), (3, True))
    module = oscillator(f"jump_{relation.__name__}".lower(), force=force)
    for value in (-1.0, 0.25, 0.5, 0.75):
        expected = float(force.subs({x: value, a: 0.5})) - value
        assert module.rhs(0.0, (value, 0.0), module.DEFAULTS)[1] == expected


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize("backend", BACKENDS)
def test_steps_cross_kinks_of_roots_and_powers(backend: str) -> None:
    # contact by Hertz: with a held sign, the power has no value before and behind the contact
    potential = 20 * sp.Max(0, x - a) ** sp.Rational(5, 2) + sp.Abs(x) ** sp.Rational(5, 2)
    root = sp.Piecewise((sp.sqrt(x + 1), x > -1), (0, True))
    module = oscillator("hertz", potential, force=root)
    assert switching_functions(module) == ()
    options = {"rtol": 1e-12, "atol": 1e-13, "backend": backend}
    motion = integrate(module, (0, 20), (-1.5, 0.0), module.DEFAULTS, **options)
    assert motion.status is Status.FINISHED
    other = integrate(module, (0, 20), (-1.5, 0.0), module.DEFAULTS, method="tsit54", **options)
    assert abs(motion.y[:, -1] - other.y[:, -1]).max() < 1e-6


def test_signs_after_the_parameters_decide() -> None:
    module = friction()
    assert switching_functions(module) == ("x_dot",)
    assert module.rhs(0.0, (0.0, 1e-9), module.DEFAULTS)[1] == -0.1
    assert module.rhs(0.0, (0.0, 1e-9), (*module.DEFAULTS, -1.0))[1] == 0.1
    (value,), (rate,) = module.switches(0.0, (0.3, 0.2), module.DEFAULTS)
    assert (value, rate) == (0.2, -0.3 - 0.1)
