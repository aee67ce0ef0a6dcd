"""Costs of other programs on scenes, with the equations that holonomic generates.

All programs get the fastest form and are compiled before they are timed. heyoka's Taylor series
and diffrax's methods take the right-hand side, called with their own numbers; numba compiles the
Python function into a loop of RK4 steps; numbalsoda's LSODA and DOP853 take its machine code.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module
from math import isfinite
from types import ModuleType
from typing import Any, TypeVar

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from benchmarks.heyoka import generated, single
from solvers.equations.forms import Form, fastest_form
from solvers.equations.module import ELEMENTARY, with_functions
from solvers.integration.accuracy.integration_run import median_seconds
from solvers.integration.compiled.native import native_rhs
from solvers.io.figures import COLOURS, columns, panels
from solvers.io.terminal import text_table
from solvers.scenes.scene import Scene
from solvers.studies.work_precision.cost_curve import CostCurve, MeasuredRun, frontier
from solvers.studies.work_precision.measured_curves import (
    LONGEST,
    STEPS,
    TOLERANCES,
    combinations,
    curves,
    point,
)
from solvers.studies.work_precision.reference import Reference
from solvers.studies.work_precision.work_precision_plots import ERROR

Array = NDArray[np.float64]
Item = TypeVar("Item")
#: Returns the final state, and the number of right-hand sides if it is known.
Run = Callable[[], tuple[Array, int | None]]
#: A method of a program, and its run with a tolerance or a step.
Method = tuple[str, Callable[[float], Run]]
#: The methods of a program; it takes the package, the scene, the form and the initial state.
Peer = Callable[[Any, Scene, Form, Array], Iterator[Method]]

#: Most steps of diffrax.
MAX_STEPS = 2**16
#: Below this tolerance LSODA prints warnings.
FINEST_OF_LSODA = 5e-13
STYLES = ("-", "--", ":")


@dataclass(frozen=True)
class SceneCosts:
    """Curves of compiled loops in the fastest form, of other programs, and their failures."""

    scene: str
    title: str
    ours: list[CostCurve]
    others: list[CostCurve]
    failures: dict[str, str]  # the exceptions that ended runs, by programs and methods

    def summary(self) -> Iterator[str]:
        """For each error our cheapest method, and relative times of other programs."""
        yield f"{self.title}: times relative to our cheapest method"
        formats = {"error": ".0e", "time/µs": ".1f", "cheapest": ""}
        formats |= {f"{curve.backend} {curve.method}": ".3g" for curve in self.others}
        yield from text_table(formats, self._rows())
        for program, failure in self.failures.items():
            yield f"{program} failed: {failure}"
        yield ""

    def _rows(self) -> Iterator[list[object]]:
        for best in frontier(self.ours):
            least = best.work_seconds
            ratios = (curve.at(best.global_error) / least for curve in self.others)
            shown = (ratio if isfinite(ratio) else None for ratio in ratios)
            yield [best.global_error, 1e6 * least, best.method, *shown]

    def plot(self) -> Figure:
        """Errors over times of other programs and of our cheapest methods."""
        figure, (axes,) = panels(f"Other programs: {self.title}", size=(8, 6))
        best = frontier(self.ours)
        costs = columns(best, "work_seconds", "global_error")
        axes.loglog(*costs, color="black", label="holonomic")
        for n, curve in enumerate(self.others):
            style = {"color": COLOURS[n % 6], "linestyle": STYLES[n // 6]}
            label = f"{curve.backend} {curve.method}"
            axes.loglog(*curve.costs("work_seconds"), marker=".", label=label, **style)
        axes.set(xlabel="time / s", ylabel=ERROR)
        axes.legend(frameon=False)
        return figure


def installed(name: str) -> ModuleType | None:
    """A package, or None if it is not installed."""
    try:
        return import_module(name)
    except ImportError:
        return None


def scene_costs(scene: Scene) -> SceneCosts:
    """Costs on a scene of the packages that are installed."""
    reference, fastest = Reference.of(scene), fastest_form(scene.module)
    choices = [c for c in combinations(scene.module) if c[1:] == (fastest, "compiled")]
    ours = curves(scene, reference, choices)
    title = f"{scene.title}, {scene.duration:g} s"
    return SceneCosts(scene.name, title, ours, *other_curves(scene, reference, installed))


def other_curves(
    scene: Scene, reference: Reference, package: Callable[[str], ModuleType | None]
) -> tuple[list[CostCurve], dict[str, str]]:
    """A curve for each method of the packages that are installed, and failures.

    A program that fails loses neither its earlier runs nor those of others.
    """
    form = Form(scene.module, fastest_form(scene.module), scene.params)
    start = form.from_ordinary(0.0, np.array(scene.y0))
    results, failures = list[CostCurve](), dict[str, str]()

    def methods_of(name: str) -> Iterator[Method]:
        if result := package(name):
            yield from PEERS[name](result, scene, form, start)

    for name in PEERS:
        methods, failure = _collected(methods_of(name))
        for method, run in methods:
            points, failed = _collected(_points(scene, reference, form, method, run))
            results.append(CostCurve(scene.name, method, form.name, name, points))
            if failed:
                failures[f"{name} {method}"] = failed
        if failure:
            failures[name] = failure
    return results, failures


def _collected(items: Iterator[Item]) -> tuple[list[Item], str]:
    """The items, and the exception that ended them; empty if none did."""
    collected = []
    try:
        for item in items:
            collected.append(item)  # noqa: PERF402  those before a failure count
    except Exception as error:  # another program may raise anything
        return collected, f"{type(error).__name__}: {error}"
    return collected, ""


def _points(
    scene: Scene, reference: Reference, form: Form, method: str, run: Callable[[float], Run]
) -> Iterator[MeasuredRun]:
    key, settings = "rtol", TOLERANCES
    if method == "rk4":
        key, settings = "h", scene.duration / STEPS
    elif method == "lsoda":
        settings = TOLERANCES[TOLERANCES > FINEST_OF_LSODA]
    for setting in map(float, settings):
        ready = run(setting)
        state, calls = ready()
        if np.isfinite(state).all():
            seconds = median_seconds(ready)
            # angles are known up to whole turns: those next to the reference are taken
            end = form.to_ordinary(scene.duration, state, reference.end, 0.0)
            if new := point(scene, reference, {key: setting}, seconds, calls, end):
                yield new
            if seconds > LONGEST["compiled"] / 2:
                return


def _heyoka(hy: Any, scene: Scene, form: Form, start: Array) -> Iterator[Method]:
    equations = generated(hy, scene.module)

    def run(tolerance: float) -> Run:
        motion = single(hy, equations, start.tolist(), scene.params, scene.duration, tolerance)
        return lambda: (np.array(motion()), None)

    yield "taylor", run


def _diffrax(diffrax: Any, scene: Scene, form: Form, start: Array) -> Iterator[Method]:
    jax: Any = import_module("jax")
    jax.config.update("jax_enable_x64", True)

    rhs = with_functions(form.function, {name: getattr(jax.numpy, name) for name in ELEMENTARY})

    def field(t: Any, y: Any, args: Any) -> Any:
        rates = rhs(t, tuple(y), form.params)
        return jax.numpy.stack([jax.numpy.asarray(rate) for rate in rates])

    for method in ("Tsit5", "Dopri8"):
        solver = getattr(diffrax, method)()

        @jax.jit  # type: ignore[untyped-decorator]
        def solve(y0: Any, tolerance: Any, solver: Any = solver) -> Any:
            term = diffrax.ODETerm(field)
            controller = diffrax.PIDController(rtol=tolerance, atol=tolerance)
            options = {"stepsize_controller": controller, "max_steps": MAX_STEPS, "throw": False}
            span = 0.0, scene.duration
            return diffrax.diffeqsolve(term, solver, *span, None, y0, **options).ys[-1]

        def run(tolerance: float, solve: Any = solve) -> Run:
            return lambda: (np.asarray(solve(start, tolerance).block_until_ready()), None)

        yield method, run


def _numba(numba: Any, scene: Scene, form: Form, start: Array) -> Iterator[Method]:
    to_fixed_tuple: Any = import_module("numba.np.unsafe.ndarray").to_fixed_tuple
    rhs, size, params = numba.njit(form.function), len(start), form.params

    @numba.njit  # type: ignore[untyped-decorator]
    def steps(y0: Any, h: float, count: int) -> Any:
        y, stage, k = y0.copy(), np.empty(size), np.empty((4, size))
        for step in range(count):
            for i, part in enumerate((0.0, 0.5, 0.5, 1.0)):
                for n in range(size):
                    stage[n] = y[n] + part * h * k[i - 1, n] if i else y[n]
                rates = rhs((step + part) * h, to_fixed_tuple(stage, size), params)
                for n in range(size):
                    k[i, n] = rates[n]
            for n in range(size):
                y[n] += h / 6 * (k[0, n] + 2 * k[1, n] + 2 * k[2, n] + k[3, n])
        return y

    def run(h: float) -> Run:
        count = round(scene.duration / h)
        return lambda: (steps(start, h, count), 4 * count)

    yield "rk4", run


def _numbalsoda(package: Any, scene: Scene, form: Form, start: Array) -> Iterator[Method]:
    rhs, params = native_rhs(scene.module, form.name), np.array(form.params)
    times = np.array([0.0, scene.duration])
    for method in ("lsoda", "dop853"):
        solver = getattr(package, method)

        def run(tolerance: float, solver: Any = solver) -> Run:
            def state() -> tuple[Array, None]:
                arguments = rhs.address, start, times, params
                rows, succeeded = solver(*arguments, rtol=tolerance, atol=tolerance)
                return (rows[-1] if succeeded else np.full(len(start), np.nan)), None

            return state

        yield method, run


#: The methods of each package.
PEERS: dict[str, Peer] = {"heyoka": _heyoka, "diffrax": _diffrax}
PEERS |= {"numba": _numba, "numbalsoda": _numbalsoda}
