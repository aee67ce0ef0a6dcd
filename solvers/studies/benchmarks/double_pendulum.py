"""The benchmark of the double pendulum: motions, calls, operations and preparation."""

from __future__ import annotations

import platform
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from solvers.equations.module import GeneratedModule
from solvers.integration.timing import work_at
from solvers.io.text_table import text_table
from solvers.studies.benchmarks import rates
from solvers.studies.benchmarks.motions import METHODS, MOTIONS, Curves, many_motions, one_motion

#: Global errors at which programs are compared.
ERRORS = (1e-3, 1e-6, 1e-9, 1e-12)


def figures(module: GeneratedModule, lambdified: Callable[..., object], hy: Any) -> dict[str, Any]:
    """All figures, in seconds and operations per second."""
    return {
        "machine": f"{platform.machine()}, Python {platform.python_version()}",
        "peers": {"heyoka": hy.__version__},
        "one motion": _compared(one_motion(module, hy)),
        "many motions": _compared(many_motions(module, hy)),
        "right-hand side in Python": rates.calls(module, lambdified),
        "operations a second": rates.peak_share(module),
        "preparation": rates.preparation(module, hy),
    }


def _compared(curves: Curves) -> list[dict[str, Any]]:
    """For each error the fastest of our methods, and the relative times of other programs."""
    rows = []
    for error in ERRORS:
        times = {name: _time_at(curve, error) for name, curve in curves.items()}
        times = {name: time for name, time in times.items() if time > 0}  # neither 0 nor NaN
        method = min((name for name in METHODS if name in times), key=times.__getitem__)
        peers = {name: time for name, time in times.items() if name not in METHODS}
        ratios = {name: time / times[method] for name, time in peers.items()}
        row = {"global_error": error, "method": method, "seconds": times[method]}
        rows.append(row | {"peers": peers, "ratios": ratios})
    return rows


def _time_at(curve: list[tuple[float, float]], error: float) -> float:
    return work_at(error, [point[1] for point in curve], [point[0] for point in curve])


def summary(results: Mapping[str, Any]) -> Iterator[str]:
    """The figures as tables."""
    yield f"{results['machine']}; heyoka {results['peers']['heyoka']}"
    yield ""
    for title, part in (
        ("One motion: the report's scene, 5 s", "one motion"),
        (f"{MOTIONS} motions from rest, 5 s: one of them, on one core", "many motions"),
    ):
        yield f"{title}. Times relative to holonomic, at equal global error:"
        rows = results[part]
        names = dict.fromkeys(name for row in rows for name in row["ratios"])
        columns = {"error": ".0e", "time/us": ".1f", "method": ""} | dict.fromkeys(names, ".3g")
        cells = (
            (
                row["global_error"],
                1e6 * row["seconds"],
                row["method"],
                *map(row["ratios"].get, names),
            )
            for row in rows
        )
        yield from text_table(columns, cells)
        yield ""
    call = results["right-hand side in Python"]
    yield (
        f"Right-hand side in Python, one state: {call['holonomic'] * 1e6:.2f} us; "
        f"lambdify with NumPy takes {call['lambdify'] / call['holonomic']:.1f} times as long."
    )
    speeds = dict(results["operations a second"])
    peak = speeds.pop("peak")
    yield f"Multiply-add peak of one core: {peak / 1e9:.0f}e9 operations per second."
    yield from (f"  {name}: {rate / 1e9:.0f}e9, {rate / peak:.0%}" for name, rate in speeds.items())
    yield "Preparation, once for each system and method, not included above:"
    yield from (f"  {name}: {time:.2f} s" for name, time in results["preparation"].items())
    yield ""
