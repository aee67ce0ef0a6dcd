"""Growth of the cost of a system with its size: chains of pendulums."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from matplotlib.figure import Figure

from solvers.io.figures import coloured, panels
from solvers.io.text_table import text_table
from solvers.studies.benchmarks.calls import single
from solvers.studies.benchmarks.median_times import median_times

#: Numbers of pendulums.
SIZES = (2, 3, 5, 8, 10, 15, 20, 30, 50)
#: Takes the number of pendulums and, except for Lagrange's form, the suffix of a form; returns
#: seconds to derive and to emit the equations, their Python text and their C header.
Maker = Callable[..., tuple[float, float, str, str]]
#: Costs in seconds, and their labels.
COSTS = {"derive": "derivation", "emit": "emission", "compile": "compilation", "call": "one call"}


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


def summary(rows: Sequence[dict[str, float]], powers: dict[str, float]) -> Iterator[str]:
    """Costs and powers as a table."""
    yield "Growth with n, in s, and the power of n in the larger half:"
    columns = {"n": ">"} | dict.fromkeys(COSTS.values(), ".2g") | {"C text": ">"}
    cells = [
        (f"{row['n']:.0f}", *(row[key] for key in COSTS), f"{row['bytes'] / 1e3:.0f} kB")
        for row in rows
    ]
    last = ("power", *(f"{powers[key]:.1f}" for key in (*COSTS, "bytes")))
    yield from text_table(columns, [*cells, last])


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
