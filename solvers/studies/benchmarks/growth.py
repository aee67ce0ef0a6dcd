"""How the cost of a system grows with its size: chains of pendulums."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.figure import Figure

from solvers.io.figures import COLOURS
from solvers.studies.benchmarks.calls import single
from solvers.studies.benchmarks.curves import timed

#: Numbers of pendulums.
SIZES = (2, 3, 5, 8, 10, 15, 20, 30, 50)

#: Takes n and, if it is not Lagrange's, the suffix of a form; gives seconds to derive and to
#: emit a chain, its Python text and its C header.
Maker = Callable[..., tuple[float, float, str, str]]

#: What is drawn, and how it is called.
CURVES = {"derive": "derivation", "emit": "emission", "compile": "compilation", "call": "one call"}


def growth(made: Maker) -> list[dict[str, float]]:
    """For each size seconds to derive, emit, compile and call, and the bytes of the C text."""
    rows = []
    made(2)  # imports are left out
    for n in SIZES:
        derive, emit, _, header = made(n)
        begin = time.perf_counter()
        run = single(f"{header}/* {time.perf_counter_ns()} */", n)  # nothing from the cache
        compiled = time.perf_counter() - begin
        rows.append({
            "n": n, "derive": derive, "emit": emit, "compile": compiled,
            "call": timed({"": run}, 0.2)[""] / run.count, "bytes": len(header),
        })  # fmt: skip
    return rows


def exponents(rows: Sequence[dict[str, float]]) -> dict[str, float]:
    """Powers of n with which costs grow: straight lines through the larger half, in logarithms."""
    upper = rows[len(rows) // 2 :]
    size = np.log([row["n"] for row in upper])
    return {
        key: float(np.polyfit(size, np.log([row[key] for row in upper]), 1)[0])
        for key in rows[0] if key != "n"
    }  # fmt: skip


def drawn(rows: Sequence[dict[str, float]]) -> Figure:
    """Times over the number of pendulums, with the powers that they grow with."""
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    panel = figure.subplots()
    sizes, powers = [row["n"] for row in rows], exponents(rows)
    for marker, colour, (key, name) in zip("osD^", COLOURS, CURVES.items(), strict=False):
        seconds = [row[key] for row in rows]
        panel.loglog(
            sizes, seconds, f"{marker}-", color=colour, markersize=4, linewidth=1,
            label=f"{name}, $n^{{{powers[key]:.1f}}}$",
        )  # fmt: skip
    panel.set(xlabel="pendulums in the chain", ylabel="time / s", title="Growth with size")
    panel.set_xticks(sizes, [f"{n:.0f}" for n in sizes])
    panel.set_xticks([], minor=True)
    panel.legend(frameon=False)
    return figure
