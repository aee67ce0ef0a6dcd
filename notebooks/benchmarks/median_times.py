"""Median times of several programs, called in turn, and of compilation."""

import time
from collections.abc import Callable, Mapping

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.integration.compiled.compiler import build
from solvers.integration.compiled.kernel_source import program
from solvers.integration.compiled.native import equations
from solvers.runge_kutta.catalogue import load

#: Least duration in s of a burst of calls: a call alone, after other programs, would be timed with
#: caches and branch predictors that hold nothing of it.
BURST = 2e-4


def seconds(run: Callable[[], object], calls: int = 1) -> float:
    """Mean time of some successive calls."""
    start = time.perf_counter()
    for _ in range(calls):
        run()
    return (time.perf_counter() - start) / calls


def median_times(runs: Mapping[str, Callable[[], object]], duration: float) -> dict[str, float]:
    """Median time of a call of each, in bursts in turn, five at least, for `duration` seconds."""
    times: dict[str, list[float]] = {name: [] for name in runs}
    calls = {}
    for name, run in runs.items():
        run()
        calls[name] = max(1, round(BURST / seconds(run)))
    until = time.perf_counter() + duration
    while time.perf_counter() < until or len(next(iter(times.values()))) < 5:
        for name, run in runs.items():
            times[name].append(seconds(run, calls[name]))
    return {name: float(np.median(values)) for name, values in times.items()}


def compile_loop(module: GeneratedModule, *, lanes: bool = False) -> None:
    """Compile a module's loop with ``verner98``, which no cache contains."""
    text = program(equations(module, "rational"), load("verner98"), lanes=lanes, compensated=False)
    build(f"{text}/* {time.perf_counter_ns()} */")
