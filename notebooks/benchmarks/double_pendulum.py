"""The benchmark of the double pendulum: motions, calls, operations and preparation."""

import ctypes
import platform
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from importlib.resources import files
from typing import Any

from benchmarks import heyoka, motions
from benchmarks.median_times import compile_loop, median_times
from benchmarks.motions import END, METHODS, MOTIONS, PARALLEL, START
from solvers.equations.module import GeneratedModule, function
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.compiled.compiler import build
from solvers.integration.compiled.memory_layout import SOURCES
from solvers.integration.ensemble import ensemble
from solvers.io.terminal import text_table
from solvers.runge_kutta.method_catalogue import load
from solvers.studies.work_precision.cost_curve import work_at

#: Global errors at which programs are compared.
ERRORS = (1e-3, 1e-6, 1e-9, 1e-12)
#: The method whose operations are counted.
METHOD = "verner853"


def figures(module: GeneratedModule, lambdified: Callable[..., object], hy: Any) -> dict[str, Any]:
    """All figures, in seconds and operations per second."""
    return {
        "machine": f"{platform.machine()}, Python {platform.python_version()}",
        "peers": {"heyoka": hy.__version__},
        "one motion": _compared(motions.one_motion(module, hy)),
        "many motions": _compared(motions.many_motions(module, hy)),
        "right-hand side in Python": _calls(module, lambdified),
        "operations a second": _peak_share(module),
        "preparation": _preparation(module, hy),
    }


def _compared(curves: motions.Curves) -> list[dict[str, Any]]:
    """For each error the fastest of our methods, and the relative times of other programs."""
    rows = []
    for error in ERRORS:
        times = {name: _time_at(curve, error) for name, curve in curves.items()}
        times = {name: time for name, time in times.items() if time > 0}  # neither 0 nor NaN
        ours = METHODS | PARALLEL
        method = min((name for name in ours if name in times), key=times.__getitem__)
        peers = {name: time for name, time in times.items() if name not in ours}
        ratios = {name: time / times[method] for name, time in peers.items()}
        row = {"global_error": error, "method": method, "seconds": times[method]}
        rows.append(row | {"peers": peers, "ratios": ratios})
    return rows


def _time_at(curve: Sequence[tuple[float, float]], error: float) -> float:
    times, errors = zip(*curve, strict=True)
    return work_at(error, errors, times)


def _calls(module: GeneratedModule, lambdified: Callable[..., object]) -> dict[str, float]:
    """Seconds for a call of the right-hand side in Python, with one state."""
    y, params = list(START), module.DEFAULTS
    thousand: dict[str, Callable[[], object]] = {
        "holonomic": lambda: [module.rhs(0.0, y, params) for _ in range(1000)],
        "lambdify": lambda: [lambdified(y, params) for _ in range(1000)],
    }
    return {name: time / 1000 for name, time in median_times(thousand, 1.0).items()}


def _preparation(module: GeneratedModule, hy: Any) -> dict[str, float]:
    """Seconds before the first motion, once for each system and method."""
    params = module.DEFAULTS

    def set_up(system: Any, start: Sequence[float]) -> None:
        hy.llvm_state.clear_memcache()
        heyoka.single(hy, system, start, params, END, 1e-12)

    rational_start = function(module, "rational_state")(0.0, START, params)
    runs: dict[str, Callable[[], object]] = {
        "holonomic, one motion": partial(compile_loop, module),
        "holonomic, lanes": partial(compile_loop, module, lanes=True),
    }
    for name, system in heyoka.double_pendulum(hy).items():
        runs[f"heyoka, {name}"] = partial(set_up, system, START)
    runs["heyoka, rational"] = partial(set_up, heyoka.generated(hy, module), rational_start)
    with heyoka.no_disk_cache(hy):
        return median_times(runs, 0.0)


@ignore_predictability()
def _peak_share(module: GeneratedModule) -> dict[str, float]:
    """Operations per second in lanes on one core, and the largest possible number."""
    library = _peak_library()
    rounds = 1_000_000
    tableau = load(METHOD)
    weights = [*(a for row in tableau.A for a in row), *tableau.b]
    state = len(module.STATES["rational"])
    evaluations = module.OPERATIONS["rhs_rational"][0] * tableau.stages
    step = 2 * state * sum(w != 0 for w in weights) + evaluations
    controlled = step + 2 * state * sum(w != 0 for row in tableau.error_weights for w in row)
    starts = motions.random_starts().T
    run = partial(ensemble, module, (0, END), starts, module.DEFAULTS, method=METHOD, workers=1)
    run_controlled, run_fixed = partial(run, rtol=1e-11, atol=1e-11), partial(run, h=0.01)
    free, fixed = run_controlled(), run_fixed()
    names = ("peak", "lanes, controlled steps", "lanes, fixed steps")
    runs = (partial(library.peak, rounds), run_controlled, run_fixed)
    steps = int((free.steps + free.rejected).sum()), int(fixed.steps.sum())
    operations = library.operations() * rounds, controlled * steps[0], step * steps[1]
    times = median_times(dict(zip(names, runs, strict=True)), 3.0)
    return {name: count / times[name] for name, count in zip(names, operations, strict=True)}


def _peak_library() -> ctypes.CDLL:
    sources = SOURCES / "lanes.h", files(__package__) / "peak.c"
    parts = ["#include <math.h>\n#include <stdint.h>"]
    parts += [source.read_text(encoding="utf-8") for source in sources]
    library = build("\n".join(parts)).functions
    library.peak.argtypes, library.peak.restype = [ctypes.c_int64], ctypes.c_double
    library.operations.restype = ctypes.c_int64
    return library


def summary(results: Mapping[str, Any]) -> Iterator[str]:
    """The figures as tables."""
    yield f"{results['machine']}; heyoka {results['peers']['heyoka']}"
    yield ""
    many = f"{MOTIONS} motions from rest, 5 s: one of them, on one core"
    titles = {"one motion": "One motion: the report's scene, 5 s", "many motions": many}
    for part, title in titles.items():
        yield f"{title}. Times relative to holonomic, at equal global error:"
        rows = results[part]
        names = dict.fromkeys(name for row in rows for name in row["ratios"])
        columns = {"error": ".0e", "time/µs": ".1f", "method": ""} | dict.fromkeys(names, ".3g")
        first = ((row["global_error"], 1e6 * row["seconds"], row["method"]) for row in rows)
        ratios = (map(row["ratios"].get, names) for row in rows)
        yield from text_table(columns, ((*a, *b) for a, b in zip(first, ratios, strict=True)))
        yield ""
    call = results["right-hand side in Python"]
    yield (
        f"Right-hand side in Python, one state: {call['holonomic'] * 1e6:.2f} µs; "
        f"lambdify with NumPy takes {call['lambdify'] / call['holonomic']:.1f} times as long."
    )
    speeds = dict(results["operations a second"])
    peak = speeds.pop("peak")
    yield f"Multiply-add peak of one core: {peak / 1e9:.0f}e9 operations per second."
    yield from (f"  {name}: {rate / 1e9:.0f}e9, {rate / peak:.0%}" for name, rate in speeds.items())
    yield "Preparation, once for each system and method, not included above:"
    yield from (f"  {name}: {time:.2f} s" for name, time in results["preparation"].items())
    yield ""
