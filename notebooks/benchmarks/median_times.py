"""Median times of several programs, called in turn, and loops and compilations to be timed."""

import ctypes
import time
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from solvers.equations.forms import fastest_form
from solvers.equations.module import GeneratedModule
from solvers.integration.compiled.compiler import build
from solvers.integration.compiled.kernel import Batch, program
from solvers.integration.compiled.native import equations
from solvers.integration.loops import compiled_loop
from solvers.integration.problem import validation
from solvers.integration.problem.problem import Options
from solvers.runge_kutta.method_catalogue import load
from solvers.runge_kutta.stepper import Array

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


class RepeatedLoop:
    """The loop that `integrate` calls, without its preparation and its checks of the start."""

    def __init__(
        self, module: GeneratedModule, start: Sequence[float], end: float, options: Options
    ) -> None:
        problem = validation.problem(module, (0.0, end), start, module.DEFAULTS, options)
        problem = problem.with_form(fastest_form(module))
        room = compiled_loop.EVENT_CAPACITY if options.events else 0
        self.batch = Batch(compiled_loop.loop(problem), problem, occurrences=room)
        motions = self.batch.motions
        self._there, self._size = motions.ctypes.data, motions.nbytes
        self._first = ctypes.create_string_buffer(motions.tobytes(), self._size)

    def __call__(self) -> None:
        """Integrate from the start."""
        ctypes.memmove(self._there, self._first, self._size)
        self.batch.restart()
        self.batch.run()

    def end(self) -> Array:
        """The last state, coordinates and velocities."""
        return self.batch.ordinary(self.batch.motions)[0]
