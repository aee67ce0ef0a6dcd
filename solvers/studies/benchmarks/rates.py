"""What a call, an operation and a preparation cost."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable, Sequence
from functools import partial
from importlib.resources import files
from math import pi
from typing import Any

import numpy as np

from solvers.equations.module import GeneratedModule, function
from solvers.integration.compiled.compiler import build
from solvers.integration.compiled.kernel_source import program
from solvers.integration.compiled.layout import SOURCES
from solvers.integration.compiled.native import equations
from solvers.integration.ensemble import ensemble
from solvers.runge_kutta.catalogue import load
from solvers.studies import heyoka as peers
from solvers.studies.benchmarks.curves import END, MOTIONS, START, timed


def calls(module: GeneratedModule, lambdified: Callable[..., object]) -> dict[str, float]:
    """Seconds of a call of the right-hand side in Python, on one state."""
    y, params = list(START), module.DEFAULTS
    thousand = timed(
        {
            "holonomic": lambda: [module.rhs(0.0, y, params) for _ in range(1000)],
            "lambdify": lambda: [lambdified(y, params) for _ in range(1000)],
        },
        1.0,
    )
    return {name: seconds / 1000 for name, seconds in thousand.items()}


def preparation(module: GeneratedModule, hy: Any) -> dict[str, float]:
    """Seconds before the first motion, once for each system and method."""

    def compiled(lanes: bool) -> Callable[[], object]:
        source = equations(module, "rational")
        text = program(source, load("verner98"), lanes=lanes, compensated=False)
        return lambda: build(f"{text}/* {time.perf_counter_ns()} */")

    start, params = function(module, "rational_state")(0.0, START, module.DEFAULTS), module.DEFAULTS
    rational = peers.generated(hy, module)
    runs = {"holonomic, one motion": compiled(False), "holonomic, lanes": compiled(True)}

    def set_up(found: Any, begin: Sequence[float]) -> Callable[[], object]:
        def run() -> object:
            hy.llvm_state.clear_memcache()
            return peers.single(hy, found, begin, params, END, 1e-12)

        return run

    for name, found in peers.double_pendulum(hy).items():
        runs[f"heyoka, {name}"] = set_up(found, START)
    runs["heyoka, rational"] = set_up(rational, start)
    hy.llvm_state.set_diskcache_enabled(False)
    try:
        return timed(runs, 0.0)
    finally:
        hy.llvm_state.set_diskcache_enabled(True)


def peak_share(module: GeneratedModule) -> dict[str, float]:
    """Operations a second in lanes on one core, beside as many multiply-adds as there can be."""
    sources = SOURCES / "lanes.h", files(__package__) / "peak.c"
    parts = ["#include <math.h>\n#include <stdint.h>"]
    parts += [source.read_text(encoding="utf-8") for source in sources]
    library = ctypes.CDLL(str(build("\n".join(parts)).path))
    library.peak.argtypes, library.peak.restype = [ctypes.c_int64], ctypes.c_double
    library.operations.restype = ctypes.c_int64
    rounds = 1_000_000
    starts = np.zeros((MOTIONS, 4))
    starts[:, :2] = np.random.default_rng(1).uniform(-pi, pi, (MOTIONS, 2))
    method = "verner87"
    tableau = load(method)
    weights = [*(a for row in tableau.A for a in row), *tableau.b]
    state = len(module.STATES["rational"])
    step = (
        2 * state * sum(w != 0 for w in weights)
        + module.OPERATIONS["rhs_rational"][0] * tableau.stages
    )
    controlled = step + 2 * state * sum(w != 0 for row in tableau.error_weights for w in row)
    run = partial(ensemble, module, (0, END), starts.T, module.DEFAULTS, method=method, workers=1)
    free, held = run(rtol=1e-11, atol=1e-11), run(h=0.01)
    times = timed(
        {
            "peak": lambda: library.peak(rounds),
            "controlled": lambda: run(rtol=1e-11, atol=1e-11),
            "fixed": lambda: run(h=0.01),
        },
        3.0,
    )
    return {
        "peak": library.operations() * rounds / times["peak"],
        "lanes, controlled steps": controlled
        * int((free.steps + free.rejected).sum())
        / times["controlled"],
        "lanes, fixed steps": step * int(held.steps.sum()) / times["fixed"],
    }
