"""The benchmark of chains of pendulums: derived, called and integrated by several programs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.integration.prepare import prepare
from solvers.io.text_table import text_table
from solvers.references.taylor import taylor
from solvers.studies import heyoka
from solvers.studies.benchmarks import growth
from solvers.studies.benchmarks.calls import Calls, Evaluations, lanes, single, textbook
from solvers.studies.benchmarks.growth import Maker
from solvers.studies.benchmarks.median_times import median_times

#: Numbers of pendulums whose equations are derived, and whose right-hand sides are called.
DERIVED, CALLED = (5, 10, 15), (2, 5, 10, 20)
#: Length of the chain that is integrated from rest at 1 rad, duration in s, and largest error.
LENGTH, END, ERROR = 10, 5.0, 1e-9


def figures(
    make: Maker,
    lagranges_method: Callable[[int], float],
    load: Callable[[str], GeneratedModule],
    hy: Any,
) -> dict[str, Any]:
    """All figures, in seconds, bytes and powers of the number of pendulums.

    Parameters
    ----------
    make, lagranges_method : callable
        Derive a chain here, and with SymPy's own mechanics.
    load : callable
        Returns the generated module of a system.
    hy : module
        heyoka.

    Returns
    -------
    dict of str
        The argument of `summary`.
    """
    rows = growth.growth(make)
    return {
        "derived and emitted": _derivations(make, lagranges_method),
        "right-hand sides": _right_hand_sides(make, hy),
        "integrated": _integration(load(f"chain_{LENGTH}"), hy),
        "growth": rows,
        "exponents": growth.exponents(rows),
    }


def _derivations(make: Maker, lagranges_method: Callable[[int], float]) -> list[dict[str, float]]:
    """Seconds to derive and emit, the least of three; and with SymPy's own mechanics."""
    rows = []
    for n in DERIVED:
        least = min(sum(make(n)[:2]) for _ in range(3))
        rows.append({"n": n, "holonomic": least, "sympy": lagranges_method(n)})
    return rows


def _right_hand_sides(make: Maker, hy: Any) -> list[dict[str, float]]:
    """Seconds for a call with one state and with many, for a textbook's C and for heyoka."""
    rows = []
    for n in CALLED:
        runs: dict[str, Calls | Evaluations] = {
            "one": single(make(n)[-1], n),
            "textbook": textbook(n),
            "lanes": lanes(make(n, "_rational")[-1], n),
            "heyoka": Evaluations(hy, n),
        }
        times = median_times(runs, 1.0)
        rows.append({"n": n} | {name: times[name] / runs[name].count for name in runs})
    return rows


def _integration(module: GeneratedModule, hy: Any) -> dict[str, float]:
    """Seconds to integrate a chain to `ERROR`, here and with heyoka's own Lagrangian."""
    start, params = [1.0] * LENGTH + [0.0] * LENGTH, list(module.DEFAULTS)
    _, _, equations = heyoka.chain(hy, LENGTH)
    reference = taylor(module, params, start, [0.0, END], 20)[-1]
    runs: dict[str, Callable[[], Any]] = {}
    for tol in (1e-8, 1e-9, 1e-10):
        for method in ("dop853", "verner87"):
            ready = prepare(module, params, method=method, rtol=tol, atol=tol)
            runs[f"holonomic, {method}, {tol}"] = partial(ready, (0.0, END), start)
    for tol in (1e-6, 1e-7, 1e-8, 1e-9):
        run = heyoka.single(hy, equations, start, params, END, tol, compact=True)
        runs[f"heyoka, {tol}"] = run
    errors = {name: np.abs(np.array(run()) - reference).max() for name, run in runs.items()}
    times = median_times({name: runs[name] for name in runs if errors[name] <= ERROR}, 2.0)
    return {
        program: min(time for name, time in times.items() if name.startswith(program))
        for program in ("holonomic", "heyoka")
    }


def _call(row: Mapping[str, float]) -> tuple[float, ...]:
    one, many = row["one"], row["lanes"]
    return row["n"], 1e9 * one, row["textbook"] / one, 1e9 * many, row["heyoka"] / many


def summary(results: Mapping[str, Any]) -> Iterator[str]:
    """The figures as tables."""
    yield "Chains of n pendulums, derived and emitted; SymPy's LagrangesMethod and lambdify:"
    rows = [
        (row["n"], row["holonomic"], row["sympy"], row["sympy"] / row["holonomic"])
        for row in results["derived and emitted"]
    ]
    columns = {"n": "d", "holonomic/s": ".2f", "SymPy/s": ".1f", "ratio": ".0f"}
    yield from text_table(columns, rows)
    yield "Their right-hand sides in C: one state, relative to a textbook; many, to heyoka:"
    columns = {"n": "d", "one/ns": ".0f", "textbook": ".2f", "lanes/ns": ".1f", "heyoka": ".1f"}
    yield from text_table(columns, map(_call, results["right-hand sides"]))
    times = results["integrated"]
    yield (
        f"A chain of {LENGTH} over {END:g} s, to {ERROR:g}: {times['holonomic'] * 1e3:.2f} ms; "
        f"heyoka takes {times['heyoka'] / times['holonomic']:.1f} times as long"
    )
    yield from growth.summary(results["growth"], results["exponents"])
