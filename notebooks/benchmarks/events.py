"""Times of one motion with events, at equal measured error of the times of its crossings.

Programs are prepared before: ours is the compiled loop that `integrate` calls, heyoka's an
integrator of our equations whose events have callbacks in Python.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from benchmarks import heyoka
from benchmarks.median_times import RepeatedLoop, median_times
from benchmarks.motions import END, START, Array, Curves, tolerances
from solvers.equations.forms import fastest_form
from solvers.equations.module import GeneratedModule, function
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.integrate import integrate
from solvers.integration.problem.events import Event
from solvers.integration.problem.problem import Options
from solvers.io.terminal import text_table
from solvers.studies.work_precision.cost_curve import work_at

#: Components of the state and their values, and all their crossings in the report's scene until
#: `END`, by Taylor series of 28 digits.
CROSSINGS = {
    ("theta1", 0.0): (
        *(0.8382156957271462, 1.132145815518256),
        *(1.4596021120082272, 3.6397623643045636),
    ),
    ("theta2_dot", 6.0): (3.2364305361222567, 3.416138877336176),
}
#: The event that ends the motion at its first crossing.
TERMINAL = ("theta2_dot", 6.0)
ERRORS = (1e-6, 1e-9, 1e-12)
#: Methods of the compiled loop, and the name of `integrate` as a whole.
METHODS, WHOLE = ("verner853", "verner98", "gauss8"), "integrate"
#: Integrates the motion, and returns the times of the crossings that were found.
Program = tuple[Callable[[], object], Callable[[], Array]]


def figures(module: GeneratedModule, hy: Any) -> list[dict[str, Any]]:
    """Seconds of the fastest of our methods, of a whole call, and of heyoka."""
    rows = []
    for (name, value), times in CROSSINGS.items():
        terminal = (name, value) == TERMINAL
        event = Event(module, name, value, terminal=terminal)
        curves = _curves(module, hy, event, np.array(times[:1] if terminal else times))
        for error in ERRORS:
            seconds = {
                program: work_at(error, [e for _, e in curve], [t for t, _ in curve])
                for program, curve in curves.items()
            }
            known = [method for method in METHODS if seconds.get(method, 0.0) > 0]
            method = min(known, key=seconds.__getitem__)
            row = {"event": f"{name} = {value:g}", "terminal": terminal, "global_error": error}
            rows.append(row | {"method": method, "seconds": seconds})
    return rows


def _curves(module: GeneratedModule, hy: Any, event: Event, exact: Array) -> Curves:
    curves: Curves = {}
    for tol in map(float, tolerances(-2, -15)):
        programs = {method: _loop(module, event, method, tol) for method in METHODS}
        programs[WHOLE] = _integrated(module, event, tol)
        programs["heyoka"] = _heyoka(module, hy, event, tol)
        errors = {}
        for name, (run, read) in programs.items():
            run()
            if len(times := read()) == len(exact):
                errors[name] = max(float(np.abs(times - exact).max()), float(np.spacing(END)))
        runs = {name: programs[name][0] for name in errors}
        for name, seconds in median_times(runs, 0.1).items() if runs else ():
            curves.setdefault(name, []).append((seconds, errors[name]))
    return curves


def _loop(module: GeneratedModule, event: Event, method: str, tol: float) -> Program:
    options = Options(method, None, tol, tol, events=(event,))
    run = RepeatedLoop(module, START, END, options)
    batch = run.batch
    return run, lambda: batch.event_rows[0, 0, : batch.motions["occurred"][0, 0]]["t"]


def _integrated(module: GeneratedModule, event: Event, tol: float) -> Program:
    call = partial(integrate, module, (0.0, END), START, module.DEFAULTS, method=METHODS[-1])
    run = ignore_predictability()(partial(call, rtol=tol, atol=tol, t_eval=[END], events=event))
    return run, lambda: run().t_events[0]


def _heyoka(module: GeneratedModule, hy: Any, event: Event, tol: float) -> Program:
    form = fastest_form(module)
    # the angle of the event is between -π and π, where its sine is 0 at 0 only
    names = {name.removeprefix("sin_"): name for name in module.STATES[form]}
    expression = hy.make_vars(names[event.name]) - event.value
    start = function(module, "rational_state")(0.0, START, module.DEFAULTS)
    times: list[float] = []

    def record(integrator: Any, time: float, sign: int) -> None:
        times.append(time)

    def stop(integrator: Any, sign: int) -> bool:
        times.append(integrator.time)
        return False

    if event.terminal:
        options = {"t_events": [hy.t_event(expression, callback=stop)]}
    else:
        options = {"nt_events": [hy.nt_event(expression, callback=record)]}
    system = heyoka.generated(hy, module)
    propagate = heyoka.single(hy, system, start, module.DEFAULTS, END, tol, **options)

    def run() -> None:
        times.clear()
        propagate()

    return run, lambda: np.array(times)


def summary(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """A table of times and ratios."""
    yield "The report's scene with one event, at equal error of the times of its crossings:"
    columns = {"event": "", "ends": "", "error": ".0e", "method": "", "loop/µs": ".1f"}
    columns |= {"integrate/µs": ".0f", "heyoka/µs": ".0f", "heyoka / loop": ".2f"}
    cells = []
    for row in rows:
        seconds, ours = row["seconds"], row["seconds"][row["method"]]
        others = [1e6 * seconds.get(name, np.nan) for name in (WHOLE, "heyoka")]
        first = row["event"], "yes" if row["terminal"] else "no", row["global_error"]
        cells.append((*first, row["method"], 1e6 * ours, *others, others[-1] / (1e6 * ours)))
    yield from text_table(columns, cells)
    yield ""
