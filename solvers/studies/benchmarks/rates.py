"""Cost of a call, of an operation and of preparation."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable, Sequence
from functools import partial
from importlib.resources import files
from typing import Any

from solvers.equations.module import GeneratedModule, function
from solvers.integration.compiled.compiler import build
from solvers.integration.compiled.kernel_source import program
from solvers.integration.compiled.layout import SOURCES
from solvers.integration.compiled.native import equations
from solvers.integration.ensemble import ensemble
from solvers.runge_kutta.catalogue import load
from solvers.studies import heyoka
from solvers.studies.benchmarks.median_times import median_times
from solvers.studies.benchmarks.motions import END, START, random_starts

#: The method whose operations are counted.
METHOD = "verner87"


def calls(module: GeneratedModule, lambdified: Callable[..., object]) -> dict[str, float]:
    """Seconds for a call of the right-hand side in Python, with one state."""
    y, params = list(START), module.DEFAULTS
    thousand: dict[str, Callable[[], object]] = {
        "holonomic": lambda: [module.rhs(0.0, y, params) for _ in range(1000)],
        "lambdify": lambda: [lambdified(y, params) for _ in range(1000)],
    }
    return {name: time / 1000 for name, time in median_times(thousand, 1.0).items()}


def preparation(module: GeneratedModule, hy: Any) -> dict[str, float]:
    """Seconds before the first motion, once for each system and method."""
    params = module.DEFAULTS

    def compile_loop(lanes: bool) -> None:
        source = equations(module, "rational")
        text = program(source, load("verner98"), lanes=lanes, compensated=False)
        build(f"{text}/* {time.perf_counter_ns()} */")  # not in the cache

    def set_up(system: Any, start: Sequence[float]) -> None:
        hy.llvm_state.clear_memcache()
        heyoka.single(hy, system, start, params, END, 1e-12)

    rational_start = function(module, "rational_state")(0.0, START, params)
    runs: dict[str, Callable[[], object]] = {
        "holonomic, one motion": partial(compile_loop, lanes=False),
        "holonomic, lanes": partial(compile_loop, lanes=True),
    }
    for name, system in heyoka.double_pendulum(hy).items():
        runs[f"heyoka, {name}"] = partial(set_up, system, START)
    runs["heyoka, rational"] = partial(set_up, heyoka.generated(hy, module), rational_start)
    with heyoka.no_disk_cache(hy):
        return median_times(runs, 0.0)


def peak_share(module: GeneratedModule) -> dict[str, float]:
    """Operations per second in lanes on one core, and the largest possible number."""
    library = _peak_library()
    rounds = 1_000_000
    tableau = load(METHOD)
    weights = [*(a for row in tableau.A for a in row), *tableau.b]
    state = len(module.STATES["rational"])
    step = (
        2 * state * sum(w != 0 for w in weights)
        + module.OPERATIONS["rhs_rational"][0] * tableau.stages
    )
    controlled = step + 2 * state * sum(w != 0 for row in tableau.error_weights for w in row)
    run = partial(ensemble, module, (0, END), random_starts().T, module.DEFAULTS, method=METHOD)
    run_controlled = partial(run, rtol=1e-11, atol=1e-11, workers=1)
    run_fixed = partial(run, h=0.01, workers=1)
    free, fixed = run_controlled(), run_fixed()
    runs: dict[str, Callable[[], object]] = {"peak": lambda: library.peak(rounds)}
    times = median_times(runs | {"controlled": run_controlled, "fixed": run_fixed}, 3.0)
    operations = {
        "peak": library.operations() * rounds,
        "controlled": controlled * int((free.steps + free.rejected).sum()),
        "fixed": step * int(fixed.steps.sum()),
    }
    speeds = {name: count / times[name] for name, count in operations.items()}
    names = {"peak": "peak", "controlled": "lanes, controlled steps", "fixed": "lanes, fixed steps"}
    return {names[key]: speed for key, speed in speeds.items()}


def _peak_library() -> ctypes.CDLL:
    sources = SOURCES / "lanes.h", files(__package__) / "peak.c"
    parts = ["#include <math.h>\n#include <stdint.h>"]
    parts += [source.read_text(encoding="utf-8") for source in sources]
    library = ctypes.CDLL(str(build("\n".join(parts)).path))
    library.peak.argtypes, library.peak.restype = [ctypes.c_int64], ctypes.c_double
    library.operations.restype = ctypes.c_int64
    return library
