"""Times of one motion in numbers longer than doubles, at equal measured error.

The motion of the report's scene is chaotic: in 20 s an error of the start grows by seven orders of
magnitude, in 50 s by nineteen.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from decimal import Decimal, localcontext
from functools import partial
from math import pi
from typing import Any

import numpy as np

from benchmarks import heyoka
from benchmarks.median_times import median_times
from benchmarks.motions import START, Array, Curves, ordinary
from solvers.equations.forms import Form, fastest_form
from solvers.equations.module import GeneratedModule
from solvers.integration.compiled.extended import PRECISIONS, integrate_extended
from solvers.io.terminal import text_table
from solvers.references.decimal_numbers import decimal_state
from solvers.studies.work_precision.cost_curve import work_at

#: Final states by Taylor series of 70 decimal digits.
FINAL = {
    20.0: (-1.580187362807668, -18.14811914390868, 2.938014965702849, 0.03796161822119856),
    50.0: (0.9246154392560003, -41.66936175646693, -1.693132414506711, -2.751313347571617),
}
#: Errors at which programs are compared.
ERRORS = {20.0: (1e-9, 1e-12), 50.0: (1e-4, 1e-7)}
#: Powers of ten of tolerances, from loose to tight, of numbers of 64 bits and of longer ones.
SHORT = range(-13, -20, -1)
LONG = {20.0: range(-11, -22, -2), 50.0: range(-18, -28, -3)}
#: Digits of the initial state.
DIGITS = 40


def figures(module: GeneratedModule, hy: Any) -> list[dict[str, Any]]:
    """For each duration and error, the seconds of all programs that reach it."""
    rows = []
    for end, errors in ERRORS.items():
        curves = _curves(module, hy, end)
        for error in errors:
            times = {
                name: work_at(error, [e for _, e in curve], [t for t, _ in curve])
                for name, curve in curves.items()
            }
            rows.append({"duration": end, "global_error": error, "seconds": times})
    return rows


def _curves(module: GeneratedModule, hy: Any, end: float) -> Curves:
    runs: dict[str, Callable[[int], Callable[[], Array]]] = {
        name: partial(_ours, module, end, name) for name in PRECISIONS
    }
    types = {"heyoka, long double": np.longdouble, "heyoka, quadruple": hy.real128}
    for name, kind in types.items():
        runs[name] = partial(_heyoka, module, hy, end, kind)
    curves: Curves = {}
    for name, prepare in runs.items():
        is_short = name.endswith("long double")
        for power in SHORT if is_short else LONG[end]:
            run = prepare(power)
            error = _distance(ordinary(run()[np.newaxis])[0], end)
            if error < 1:
                seconds = median_times({name: run}, 0.0)[name]
                curves.setdefault(name, []).append((seconds, error))
    return curves


def _distance(state: Array, end: float) -> float:
    """Largest error; angles may differ by whole turns."""
    apart = state - FINAL[end]
    apart[:2] = (apart[:2] + pi) % (2 * pi) - pi
    return float(np.abs(apart).max())


def _ours(module: GeneratedModule, end: float, precision: str, power: int) -> Callable[[], Array]:
    run = partial(integrate_extended, module, module.DEFAULTS, START, [0.0, end], precision)
    return lambda: run(10.0**power)[-1]


def _heyoka(
    module: GeneratedModule, hy: Any, end: float, kind: Any, power: int
) -> Callable[[], Array]:
    form = Form(module, fastest_form(module), module.DEFAULTS)
    with localcontext(prec=DIGITS):
        start = [kind(str(x)) for x in decimal_state(form, START)[: len(form.state)]]
        tolerance = kind(str(Decimal(10) ** power))
    params, system = [kind(p) for p in module.DEFAULTS], heyoka.generated(hy, module)
    run = heyoka.single(hy, system, start, params, kind(end), tolerance, fp_type=kind)
    return lambda: np.array([float(x) for x in run()])


def summary(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """A table of times."""
    yield "The report's scene in longer numbers: milliseconds at equal global error"
    names = list(dict.fromkeys(name for row in rows for name in row["seconds"]))
    columns = {"duration/s": ".0f", "error": ".0e"} | dict.fromkeys(names, ".3g")
    cells = [
        (
            row["duration"],
            row["global_error"],
            *(1e3 * row["seconds"].get(name, np.nan) for name in names),
        )
        for row in rows
    ]
    yield from text_table(columns, cells)
    yield ""
