"""The benchmark of chains of pendulums: derived, called and integrated by several programs."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from itertools import product
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks import heyoka
from benchmarks.calls import Calls, Evaluations, lanes, single, textbook
from benchmarks.median_times import median_times
from solvers.equations.module import GeneratedModule
from solvers.integration.prepare import prepare
from solvers.io.figures import coloured, panels
from solvers.io.terminal import text_table
from solvers.references.taylor import taylor

#: Numbers of pendulums of which growth is computed.
SIZES = (2, 3, 5, 8, 10, 15, 20, 30, 50)
#: Takes the number of pendulums and, except for Lagrange's form, the suffix of a form; returns
#: seconds to derive and to emit the equations, their Python text and their C header.
Maker = Callable[..., tuple[float, float, str, str]]
#: Costs in seconds, and their labels.
COSTS = {"derive": "derivation", "emit": "emission", "compile": "compilation", "call": "one call"}
#: Takes the number of pendulums; returns the seconds that SymPy's own mechanics needs.
Lagrange = Callable[[int], float]
#: Numbers of pendulums whose equations are derived, and whose right-hand sides are called.
DERIVED, CALLED = (5, 10, 15), (2, 5, 10, 20)
#: Length of the chain that is integrated from rest at 1 rad, duration in s, and largest error.
LENGTH, END, ERROR = 10, 5.0, 1e-9


def figures(
    make: Maker, lagranges_method: Lagrange, load: Callable[[str], GeneratedModule], hy: Any
) -> dict[str, Any]:
    """All figures, in seconds, bytes and powers of the number of pendulums.

    `make` derives a chain here and `lagranges_method` with SymPy's own mechanics; `load` returns
    the generated module of a system.
    """
    rows = growth(make)
    return {
        "derived and emitted": _derivations(make, lagranges_method),
        "right-hand sides": _right_hand_sides(make, hy),
        "integrated": _integration(load(f"chain_{LENGTH}"), hy),
        "growth": rows,
        "exponents": exponents(rows),
    }


def _derivations(make: Maker, lagranges_method: Lagrange) -> list[dict[str, float]]:
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
    for tol, method in product((1e-8, 1e-9, 1e-10), ("dop853", "verner853")):
        ready = prepare(module, params, method=method, rtol=tol, atol=tol)
        runs[f"holonomic, {method}, {tol}"] = partial(ready, (0.0, END), start)
    integrate = partial(heyoka.single, hy, equations, start, params, END)
    for tol in (1e-6, 1e-7, 1e-8, 1e-9):
        # without the compact mode it compiles for minutes
        runs[f"heyoka, {tol}"] = integrate(tol, compact_mode=True)
    errors = {name: np.abs(np.array(run()) - reference).max() for name, run in runs.items()}
    times = median_times({name: runs[name] for name in runs if errors[name] <= ERROR}, 2.0)
    return {
        program: min(time for name, time in times.items() if name.startswith(program))
        for program in ("holonomic", "heyoka")
    }


def growth(make: Maker) -> list[dict[str, float]]:
    """For each size seconds to derive, emit, compile and call, and the bytes of the C text."""
    rows = []
    make(2)  # imports are not timed
    for n in SIZES:
        derive, emit, _, header = make(n)
        start = time.perf_counter()
        run = single(f"{header}/* {time.perf_counter_ns()} */", n)  # not in the cache
        compiled = time.perf_counter() - start
        call = median_times({"": run}, 0.2)[""] / run.count
        row = {"n": n, "derive": derive, "emit": emit, "compile": compiled, "call": call}
        rows.append(row | {"bytes": len(header)})
    return rows


def exponents(rows: Sequence[dict[str, float]]) -> dict[str, float]:
    """Powers of n with which costs grow in the larger half, from fits to logarithms."""
    upper = rows[len(rows) // 2 :]
    size = np.log([row["n"] for row in upper])
    costs = {key: np.log([row[key] for row in upper]) for key in rows[0] if key != "n"}
    return {key: float(np.polyfit(size, values, 1)[0]) for key, values in costs.items()}


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
    yield "Growth with n, in s, and the power of n in the larger half:"
    columns = {"n": ">"} | dict.fromkeys(COSTS.values(), ".2g") | {"C text": ">"}
    growths = [
        (f"{row['n']:.0f}", *(row[key] for key in COSTS), f"{row['bytes'] / 1e3:.0f} kB")
        for row in results["growth"]
    ]
    powers = (f"{results['exponents'][key]:.1f}" for key in (*COSTS, "bytes"))
    yield from text_table(columns, [*growths, ("power", *powers)])


def plot(rows: Sequence[dict[str, float]]) -> Figure:
    """Times over the number of pendulums, with the powers of their growth."""
    figure, (panel,) = panels("Growth with size", size=(6.4, 4.4))
    sizes, powers = [row["n"] for row in rows], exponents(rows)
    for marker, (key, colour) in zip("osD^", coloured(COSTS), strict=True):
        seconds, label = [row[key] for row in rows], f"{COSTS[key]}, $n^{{{powers[key]:.1f}}}$"
        style = {"color": colour, "markersize": 4, "linewidth": 1}
        panel.loglog(sizes, seconds, f"{marker}-", label=label, **style)
    panel.set(xlabel="pendulums in the chain", ylabel="time / s")
    panel.set_xticks(sizes, [f"{n:.0f}" for n in sizes])
    panel.set_xticks([], minor=True)
    panel.legend(frameon=False)
    return figure
