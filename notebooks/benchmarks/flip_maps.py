"""The benchmark of the flip map: several programs at equal error, and the overhead of sweeps."""

import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks import flip_programs as programs
from benchmarks import heyoka
from benchmarks.flip_programs import ANGLES, END, FLIP, Flips, can_flip, starts
from benchmarks.median_times import seconds
from solvers.equations.module import GeneratedModule
from solvers.io.terminal import text_table
from solvers.sweeps.definition.axes import Random
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution.pool import Pool
from solvers.sweeps.execution.sweep_run import sweep

Array = NDArray[np.float64]

#: Number of motions along each side of the map, and of the coarser map for errors.
SIDE, COARSE = 512, 64
#: Largest error of flip times in s, and the fraction of flips that may exceed it.
ERROR, FRACTION = 1e-6, 0.05
#: Numbers of motions of the sweeps.
SIZES = (10_000, 100_000, 262_144, 1_000_000)
#: Runs that last so many seconds are timed once.
LONG = 5.0


def figures(module: GeneratedModule, hy: Any, nb: Any) -> dict[str, Any]:
    """All figures of maps."""
    return {"compared": comparison(module, hy, nb), "sweeps": overhead(module)}


def error(times: Array, reference: Array) -> float:
    """The error in s that all but `FRACTION` of the flips do not exceed."""
    flips = np.isfinite(reference)
    apart = np.abs(times[flips] - reference[flips])
    return float(np.quantile(np.where(np.isnan(apart), np.inf, apart), 1 - FRACTION))


def comparison(module: GeneratedModule, hy: Any, nb: Any) -> dict[str, Any]:
    """Seconds for the whole map, each program with its fastest setting that meets `ERROR`."""
    equations, params = heyoka.double_pendulum(hy), list(module.DEFAULTS)
    settings: dict[str, dict[str, Flips]] = {
        "holonomic": {
            f"{method}, {tol:g}": partial(programs.by_ensemble, module, method, tol, 1)
            for tol in (1e-7, 1e-8, 1e-9)
            for method in ("verner853", "verner98")
        },
        "heyoka": {
            f"{name}, {tol:g}": partial(programs.by_heyoka, hy, system, params, tol)
            for tol in (1e-7, 1e-8)
            for name, system in equations.items()
        },
        "numba": {f"h = {h:g}": programs.by_numba(nb, module, h) for h in (4e-3, 2e-3, 1e-3)},
    }
    coarse, whole = starts(module, COARSE), starts(module, SIDE)
    coarse = coarse[: len(coarse) // 16 * 16]  # in full batches
    # the reference of each program comes from another one
    taylor = programs.by_heyoka(hy, equations["textbook"], params, 1e-16, coarse)
    references = {"heyoka": programs.by_ensemble(module, "verner98", 1e-14, 1, coarse)}
    times, selected = {}, {}
    for program, runs in settings.items():
        reference = references.get(program, taylor)
        valid = [
            (_median_seconds(run, coarse), name, run)
            for name, run in runs.items()
            if error(run(coarse), reference) <= ERROR
        ]
        _, selected[program], run = min(valid, key=itemgetter(0))
        times[program] = _median_seconds(run, whole)
    method, _, tolerance = selected["holonomic"].partition(", ")
    tol = float(tolerance)
    times["one lane"] = _median_seconds(programs.by_single_motions, module, method, tol, whole)
    times["both cores"] = _median_seconds(programs.by_ensemble, module, method, tol, 2, whole)
    return {"motions": len(whole), "seconds": times, "settings": selected}


def overhead(module: GeneratedModule) -> list[dict[str, float]]:
    """Seconds of sweeps of increasing size, and their overhead over the ensembles alone."""
    rows = []
    for count in SIZES:
        axes = Random(ANGLES, count, seed=1)
        definition = Sweep(module, axes, {"flip": FLIP}, END, atol=1e-9)
        columns = axes.columns(0, count)
        state = np.zeros((count, 4))
        state[:, 0], state[:, 1] = columns["theta1"], columns["theta2"]

        def run_sweep(definition: Sweep = definition) -> None:
            with tempfile.TemporaryDirectory() as folder:
                sweep(definition, Path(folder) / "sweep", pool=Pool(workers=2))

        method, tol, moving = definition.method, definition.rtol, can_flip(module, state)
        run_ensemble = partial(programs.by_ensemble, module, method, tol, 2, moving)
        run_sweep()
        pairs = np.array([(seconds(run_sweep), seconds(run_ensemble)) for _ in range(7)])
        whole, ratio = np.median(pairs[:, 0]), np.median(pairs[:, 0] / pairs[:, 1])
        rows.append({"motions": count, "seconds": float(whole), "overhead": float(ratio) - 1})
    return rows


def _median_seconds(run: Callable[..., object], *arguments: Any) -> float:
    """The median of five calls after a first that compiles; of long ones, the time of the first."""
    call = partial(run, *arguments)
    first = seconds(call)
    return first if first > LONG else float(np.median([seconds(call) for _ in range(5)]))


def summary(results: dict[str, Any]) -> Iterator[str]:
    """The figures as tables."""
    compared, times = results["compared"], results["compared"]["seconds"]
    accuracy = f"{1 - FRACTION:.0%} of the times to {ERROR:g} s"
    motions = f"{END:g} s, {compared['motions']:,} motions"
    yield f"Flip map, {SIDE} x {SIDE}, {motions}; {accuracy}, on one core:"
    relative = {program: time / times["holonomic"] for program, time in times.items()}
    rows = ((p, setting, times[p], relative[p]) for p, setting in compared["settings"].items())
    columns = {"program": "", "setting": "", "time/s": ".2f", "ratio": ".1f"}
    yield from text_table(columns, rows)
    ratio = times["one lane"] / times["both cores"]
    lanes = f"lanes on both cores {times['both cores']:.2f} s"
    yield f"one motion at a time {times['one lane']:.2f} s; {lanes}: {ratio:.1f} times as fast"
    yield "Sweeps from random starts, on both cores, and their overhead over the ensemble alone:"
    columns = {"motions": ",", "time/s": ".2f", "overhead": "+.1%"}
    shown = itemgetter("motions", "seconds", "overhead")
    yield from text_table(columns, map(shown, results["sweeps"]))
