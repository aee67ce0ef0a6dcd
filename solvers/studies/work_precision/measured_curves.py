"""Timed runs, and the curves of combinations of method, form and backend on a scene."""

import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from itertools import product

import numpy as np
from numpy.typing import NDArray

from solvers.equations.energy import EnergyUnit, coupling, energy_unit
from solvers.equations.forms import Form
from solvers.equations.module import GeneratedModule
from solvers.integration.accuracy.integration_run import SECONDS, median_seconds
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.loops import python_loop
from solvers.integration.prepare import NotFinishedError, prepare
from solvers.integration.problem import validation
from solvers.integration.problem.problem import Options
from solvers.integration.problem.status import Status
from solvers.integration.results.recorder import Outcome
from solvers.runge_kutta.method_catalogue import SCIPY, load, names
from solvers.scenes.scene import Scene
from solvers.studies.work_precision.cost_curve import Combination, CostCurve, MeasuredRun
from solvers.studies.work_precision.reference import Reference

Array = NDArray[np.float64]
#: The methods that the report calls RK1 to RK4.
REPORT_METHODS = {"RK1": "rk1", "RK2": "midpoint", "RK3": "rk3", "RK4": "rk4"}
FORMS = ("lagrangian", "hamiltonian", "rational")
#: The longest run of each backend in s; and of the report's methods, which reach rounding.
LONGEST, LONGEST_REPORT = {"compiled": 0.02, "python": 0.1, "scipy": 0.1}, 0.5
#: Tolerances, and numbers of fixed steps, by rising cost.
TOLERANCES, STEPS = 10.0 ** -np.arange(1, 15), 10 * 2 ** np.arange(24)
#: Runs with a larger error are left out.
LARGEST_ERROR = 10.0
#: Largest number of steps of a timed run.
MOST_STEPS = 10**8
#: The least relative tolerance that SciPy accepts.
FINEST_OF_SCIPY = 3e-14


@dataclass(frozen=True)
class TimedRun:
    """The cost and the end of a run."""

    work_seconds: float  # without preparation; the median of several runs if it is short
    work_rhs: int
    steps: int
    end: Array  # an ordinary state


def timed_run(
    module: GeneratedModule,
    params: Sequence[float],
    y0: Sequence[float],
    duration: float,
    *,
    method: str,
    form: str,
    backend: str,
    rtol: float = 0.0,
    h: float | None = None,
) -> TimedRun | None:
    """Integrate and time a motion from time 0; None if it does not reach its end.

    Parameters
    ----------
    module, params, y0, method, form, h
        As in `integrate`.
    duration : float
        In s.
    backend : {"compiled", "python", "scipy"}
        The backend; the method decides between the last two.
    rtol : float
        Relative and absolute tolerance.

    Returns
    -------
    TimedRun or None

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> choice = dict(method="rk4", form="rational", backend="python", h=0.1)
    >>> run = timed_run(sp, sp.DEFAULTS, (1.0, 0.0), 1.0, **choice)
    >>> run.steps, run.work_rhs
    (10, 40)
    """
    span = (0.0, duration)
    if backend == "compiled":
        build = partial(prepare, module, params, method=method, form=form, max_steps=MOST_STEPS)
        run = build(rtol=rtol, atol=rtol, h=h)
        try:
            end = run(span, y0)
        except NotFinishedError:
            return None
        return TimedRun(median_seconds(lambda: run(span, y0)), run.nfev, run.steps, np.array(end))
    options = Options(method, form, rtol, rtol, h, t_eval=span[1:], max_steps=MOST_STEPS)
    problem = validation.problem(module, span, y0, params, options)

    def run_once() -> Outcome:
        result = Outcome.at_start(problem)
        python_loop.run(problem, result)
        return result

    start = time.perf_counter()
    result = run_once()
    first = time.perf_counter() - start
    if result.status is not Status.FINISHED:
        return None
    seconds = first if first > SECONDS else median_seconds(run_once)
    return TimedRun(seconds, result.nfev, result.steps, result.rows()[1][-1])


def combinations(module: GeneratedModule) -> Iterator[Combination]:
    """All combinations that a module's forms allow."""
    forms = [form for form in FORMS if form in module.FORMS]
    with_jacobian = [f for f in forms if Form(module, f, module.DEFAULTS).has_jacobian]
    for method in names():
        possible = with_jacobian if load(method).needs_jacobian else forms
        if load(method).is_splitting:
            possible = [] if coupling(module) else ["lagrangian"]
        yield from product([method], possible, ("compiled", "python"))
    yield from product(SCIPY, forms, ["scipy"])


def curves(
    scene: Scene, reference: Reference, combinations: Iterable[Combination]
) -> list[CostCurve]:
    """A curve for each combination; those that no compiler can build are left out.

    Parameters
    ----------
    scene : Scene
        The motion.
    reference : Reference
        Its final state.
    combinations : iterable of tuple
        Method, form and backend of each curve.

    Returns
    -------
    list of Curve
        In the order of `combinations`, without those that have no valid run.

    Raises
    ------
    ValueError
        When the module does not have the form, or the method cannot be used with it.
    solvers.runge_kutta.method_catalogue.UnknownMethodError
        When there is no method of this name.
    """
    results = []
    for combination in combinations:
        with suppress(NoCompilerError):
            if points := list(_points(scene, reference, combination)):
                results.append(CostCurve(scene.name, *combination, points))
    return results


def _points(scene: Scene, reference: Reference, combination: Combination) -> Iterator[MeasuredRun]:
    method, form, backend = combination
    solve = partial(timed_run, scene.module, scene.params, scene.y0, scene.duration)
    for setting in _settings(method, backend, scene.duration):
        if run := solve(method=method, form=form, backend=backend, **setting):
            costs = run.work_seconds, run.work_rhs
            if new := point(scene, reference, setting, *costs, run.end):
                yield new
            if run.work_seconds > _longest(combination) / 2:
                return


def _settings(method: str, backend: str, duration: float) -> list[dict[str, float]]:
    """Tolerances for methods with step control, else steps in s, by rising cost."""
    if method in SCIPY or load(method).estimates_error:
        finest = FINEST_OF_SCIPY if backend == "scipy" else 0.0
        return [{"rtol": float(tol)} for tol in TOLERANCES if tol >= finest]
    return [{"h": float(duration / n)} for n in STEPS]


def _longest(combination: Combination) -> float:
    method, form, backend = combination
    is_report = method in REPORT_METHODS.values() and (form, backend) == ("lagrangian", "compiled")
    return LONGEST_REPORT if is_report else LONGEST[backend]


def point(
    scene: Scene,
    reference: Reference,
    setting: dict[str, float],
    seconds: float,
    calls: int | None,
    end: Array,
) -> MeasuredRun | None:
    """The point of a run with this final state; None if its error exceeds `LARGEST_ERROR`."""
    module, params = scene.module, scene.params
    error = float(np.abs(end - reference.end).max())
    if not error < LARGEST_ERROR:
        return None
    # the energy of the reference, since that at the start may not be kept
    ends = end.tolist(), reference.end.tolist()
    energy, right = (module.energy(scene.duration, y, params) for y in ends)
    energy_error = abs(energy - right) / unit_of_energy(scene).joules
    # an error below that of the reference is not known
    return MeasuredRun(setting, seconds, calls, max(error, reference.global_error), energy_error)


def unit_of_energy(scene: Scene) -> EnergyUnit:
    """The unit of the energy errors of a scene's points."""
    first = scene.module.energy(0.0, scene.y0, scene.params)
    return energy_unit(scene.module, scene.params, first)
