"""Chains of pendulums beside other programs: derived, called, integrated."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.integration.prepare import prepare
from solvers.references.taylor import taylor
from solvers.studies import heyoka as peers
from solvers.studies.benchmarks.calls import Calls, Evaluations, lanes, single, textbook
from solvers.studies.benchmarks.curves import timed
from solvers.studies.benchmarks.growth import Maker

#: Numbers of pendulums that are derived, and whose right-hand sides are called.
DERIVED, CALLED = (5, 10, 15), (2, 5, 10, 20)
#: Length of the chain that is integrated, from rest at 1 rad, for so many seconds.
LENGTH, END = 10, 5.0
#: The largest error there.
ERROR = 1e-9


def derivations(made: Maker, rival: Callable[[int], float]) -> list[dict[str, float]]:
    """Seconds to derive and emit, here and with SymPy's own mechanics."""
    return [
        {"n": n, "holonomic": _seconds(made, n), "sympy": rival(n)} for n in DERIVED
    ]  # fmt: skip


def _seconds(made: Maker, n: int) -> float:
    """Of the quickest of three derivations."""
    return min(sum(made(n)[:2]) for _ in range(3))


def right_hand_sides(made: Maker, hy: Any) -> list[dict[str, float]]:
    """Seconds of a call, of one state and of many, beside a textbook's C and heyoka's function."""
    rows = []
    for n in CALLED:
        runs: dict[str, Calls | Evaluations] = {
            "one": single(made(n)[-1], n), "textbook": textbook(n),
            "lanes": lanes(made(n, "_rational")[-1], n), "heyoka": Evaluations(hy, n),
        }  # fmt: skip
        found = timed(runs, 1.0)
        rows.append({"n": n} | {name: found[name] / runs[name].count for name in runs})
    return rows


def integration(module: GeneratedModule, hy: Any) -> dict[str, float]:
    """Seconds to integrate a chain to `ERROR`, here and with heyoka from its own Lagrangian."""
    start = [1.0] * LENGTH + [0.0] * LENGTH
    params = list(module.DEFAULTS)
    _, _, equations = peers.chain(hy, LENGTH)
    truth = taylor(module, params, start, [0.0, END], 20)[-1]
    runs: dict[str, Callable[[], Any]] = {}
    for tolerance in (1e-8, 1e-9, 1e-10):
        for method in ("dop853", "verner87"):
            run = prepare(module, params, method=method, rtol=tolerance, atol=tolerance)
            runs[f"holonomic, {method}, {tolerance}"] = partial(run, (0.0, END), start)
    for tolerance in (1e-6, 1e-7, 1e-8, 1e-9):
        runs[f"heyoka, {tolerance}"] = peers.single(
            hy, equations, start, params, END, tolerance, compact=True
        )
    right = {
        name: run for name, run in runs.items() if np.abs(np.array(run()) - truth).max() <= ERROR
    }  # fmt: skip
    seconds = timed(right, 2.0)
    return {
        side: min(t for name, t in seconds.items() if name.startswith(side))
        for side in ("holonomic", "heyoka")
    }
