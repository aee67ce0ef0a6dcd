"""Compiled loops beside one other program, at equal measured error of the state at the end.

Ours are the loop that `integrate` calls, with several methods, and a call of a prepared function,
which checks the start before.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from benchmarks.median_times import RepeatedLoop, median_times
from benchmarks.motions import Array, Curves
from solvers.equations.module import GeneratedModule
from solvers.integration.prepare import prepare
from solvers.integration.problem.problem import Options
from solvers.io.terminal import text_table
from solvers.studies.work_precision.cost_curve import work_at

METHODS, POWERS = ("verner853", "verner98", "gauss8"), range(-1, -13, -1)
#: The call of a prepared function with the last of the methods, and the other program.
CALL, OTHER = "call", "other"
#: A run, and a function that returns the components of its end that are compared.
Program = tuple[Callable[[], object], Callable[[], Array]]


def programs(
    module: GeneratedModule,
    start: Sequence[float],
    end: float,
    tol: float,
    part: Callable[[Array], Array],
) -> dict[str, Program]:
    """Our programs; `part` takes a state and returns the components that are compared."""
    result: dict[str, Program] = {}
    for method in METHODS:
        loop = RepeatedLoop(module, start, end, Options(method, None, tol, tol))
        result[method] = loop, lambda loop=loop: part(loop.end())  # type: ignore[misc]
    ready = prepare(module, module.DEFAULTS, method=METHODS[-1], rtol=tol, atol=tol)

    def call() -> tuple[float, ...]:
        return ready((0.0, end), start)

    return result | {CALL: (call, lambda: part(np.array(call())))}


def measured(runs: Iterable[Mapping[str, Program]], exact: Array) -> Curves:
    """Seconds and errors of the programs, from loose to tight."""
    curves: Curves = {}
    for one in runs:
        errors = {}
        for name, (run, end) in one.items():
            run()
            errors[name] = float(np.abs(end() - exact).max())
        valid = {name: run for name, (run, _) in one.items() if errors[name] < 1}
        for name, seconds in median_times(valid, 0.1).items() if valid else ():
            curves.setdefault(name, []).append((seconds, errors[name]))
    return curves


def rows(errors: Sequence[float], curves: Curves) -> Iterator[dict[str, Any]]:
    """For each error that the other program reaches: seconds, and our fastest method."""
    for error in errors:
        seconds = {
            name: work_at(error, [e for _, e in curve], [s for s, _ in curve])
            for name, curve in curves.items()
        }
        known = [method for method in METHODS if seconds[method] > 0]
        if known and seconds[OTHER] > 0:
            method = min(known, key=seconds.__getitem__)
            yield {"global_error": error, "method": method, "seconds": seconds}


def table(results: Sequence[Mapping[str, Any]], name: str, other: str) -> Iterator[str]:
    """Times and ratios; rows have a title in their item `name`."""
    columns = {name: "", "error": ".0e", "method": "", "loop/µs": ".1f", "call/µs": ".0f"}
    columns |= {f"{other}/ms": ",.2f", f"{other} / loop": ",.0f", f"{other} / call": ",.0f"}
    cells = []
    for row in results:
        seconds = row["seconds"]
        loop, call, last = (1e6 * seconds[key] for key in (row["method"], CALL, OTHER))
        first = row[name], row["global_error"], row["method"]
        cells.append((*first, loop, call, 1e-3 * last, last / loop, last / call))
    yield from text_table(columns, cells)
    yield ""
