"""The flip map of the double pendulum beside other programs, to the same errors of its times.

All integrate the motions that have the energy for a flip, on one core; all find its time within
a step. heyoka does batches with terminal events on its own equations; numba compiles RK4 with
fixed steps and the generated right-hand side, and finds the time by cubic interpolation.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solvers.equations.forms import Form
from solvers.equations.module import GeneratedModule
from solvers.integration import validation
from solvers.integration.compiled.kernel import Batch, kernel
from solvers.integration.ensemble import ensemble
from solvers.integration.events import Event
from solvers.integration.problem import Options
from solvers.studies import heyoka as peers
from solvers.sweeps.axes import Random
from solvers.sweeps.barrier import is_below
from solvers.sweeps.maps.first import First
from solvers.sweeps.pool import Pool
from solvers.sweeps.run import sweep
from solvers.sweeps.sweep import Sweep

Array = NDArray[np.float64]

#: Seconds of motion, and starts along each side of the map.
END, SIDE = 20.0, 512
#: Errors are measured on a coarser map: this share of flips may have a larger one than `ERROR`.
COARSE, SHARE, ERROR = 64, 0.05, 1e-6
#: Numbers of motions over which growth is measured.
GROWTH = (10_000, 100_000, 262_144, 1_000_000)
#: Runs that take so many seconds are timed once.
LONG = 5.0
FLIP = First(
    {"theta1": (-np.pi, np.pi), "theta2": (-np.pi, np.pi)},
    ({"theta1": np.pi}, {"theta2": np.pi}),
)

#: Flip times of motions from rest, shape (n,); NaN where there is none.
Flips = Callable[[Array], Array]


def starts(module: GeneratedModule, side: int) -> Array:
    """States in rows, from rest at the middle of side² cells, with the energy for a flip."""
    angles = (np.arange(side) + 0.5) * 2 * np.pi / side - np.pi
    state = np.zeros((side * side, 4))
    state[:, 0], state[:, 1] = (axis.ravel() for axis in np.meshgrid(angles, angles))
    params = [np.full(len(state), p) for p in module.DEFAULTS]
    return state[~is_below(module, FLIP.barrier, state, params)]


def ours(
    module: GeneratedModule, method: str, tolerance: float, workers: int, state: Array
) -> Array:
    """By our ensemble."""
    events = [Event(module, e.name, e.value, terminal=True) for e in FLIP.events(module)]
    found = ensemble(module, (0, END), state.T, module.DEFAULTS, method=method, rtol=tolerance,
                     atol=tolerance, events=events, workers=workers)  # fmt: skip
    return _first(found.t_events[:, :, 0])


def scalar(module: GeneratedModule, method: str, tolerance: float, state: Array) -> Array:
    """By our compiled loop with one motion at a time."""
    events = [Event(module, e.name, e.value, terminal=True) for e in FLIP.events(module)]
    program = kernel(module, "rational", method, lanes=False, compensated=False,
                     reproducible=False)  # fmt: skip
    options = Options(method, "rational", tolerance, tolerance, t_eval=(), events=events)
    problem = validation.problem(module, (0, END), state[0], module.DEFAULTS, options)
    batch = Batch(program, problem, Form(module, "rational", module.DEFAULTS), state,
                  capacity=0, occurrences=1, pauses=False)  # fmt: skip
    batch.restart()
    batch.run()
    there = batch.motions["occurred"][:, : len(events)] > 0
    return _first(np.where(there, batch.event_rows["t"][:, :, 0], np.nan))


def heyoka(
    hy: Any, equations: Any, params: Sequence[float], tolerance: float, state: Array
) -> Array:
    """By heyoka's batches; a lane whose motion is over waits for the others."""
    width = hy.recommended_simd_size()
    angles = hy.make_vars("theta1", "theta2")
    events = [hy.t_event_batch(angle**2 - np.pi**2) for angle in angles]
    integrator = hy.taylor_adaptive_batch(
        equations, np.zeros((4, width)), tol=tolerance, t_events=events,
        pars=np.repeat(np.array(params)[:, None], width, axis=1),
    )  # fmt: skip
    found = np.full(len(state), np.nan)
    for first in range(0, len(state) - width + 1, width):
        integrator.set_time(0.0)
        integrator.reset_cooldowns()
        integrator.state[:] = state[first : first + width].T
        is_over = np.zeros(width, bool)
        while not is_over.all():
            integrator.propagate_until(np.where(is_over, integrator.time, END))
            for lane, (outcome, *_) in enumerate(integrator.propagate_res):
                if is_over[lane]:
                    continue
                # a terminal event is told by its number, counted from -1 downwards
                if -len(events) - 1 < int(outcome) < 0:
                    found[first + lane], is_over[lane] = integrator.time[lane], True
                elif integrator.time[lane] >= END:
                    is_over[lane] = True
    return found


def numba(nb: Any, module: GeneratedModule, h: float) -> Flips:
    """By RK4 in numba."""
    rhs = nb.njit(module.rhs)
    params = tuple(map(float, module.DEFAULTS))

    @nb.njit  # type: ignore[untyped-decorator]
    def moved(y: Any, k: Any, h: float) -> Any:
        return (y[0] + h * k[0], y[1] + h * k[1], y[2] + h * k[2], y[3] + h * k[3])

    @nb.njit  # type: ignore[untyped-decorator]
    def crossed(x: float, v: float, y: float, w: float, h: float) -> float:
        """Where the cubic through both ends with their slopes is at ±π, in parts of h."""
        aim, low, high = np.copysign(np.pi, y), 0.0, 1.0
        for _ in range(60):
            s = (low + high) / 2
            cubic = (
                (1 + 2 * s) * (1 - s) ** 2 * x + s * (1 - s) ** 2 * h * v
                + s * s * (3 - 2 * s) * y + s * s * (s - 1) * h * w
            )  # fmt: skip
            if abs(cubic) < abs(aim):
                low = s
            else:
                high = s
        return high

    @nb.njit  # type: ignore[untyped-decorator]
    def flips(states: Any, params: Any, end: float, h: float) -> Any:
        found = np.full(len(states), np.nan)
        for n in range(len(states)):
            y = (states[n, 0], states[n, 1], states[n, 2], states[n, 3])
            for step in range(round(end / h)):
                k1 = rhs(0.0, y, params)
                k2 = rhs(0.0, moved(y, k1, h / 2), params)
                k3 = rhs(0.0, moved(y, k2, h / 2), params)
                k4 = rhs(0.0, moved(y, k3, h), params)
                z = moved(moved(moved(moved(y, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6)
                if abs(z[0]) >= np.pi or abs(z[1]) >= np.pi:
                    part = 1.0
                    for i in range(2):
                        if abs(z[i]) >= np.pi:
                            part = min(part, crossed(y[i], y[i + 2], z[i], z[i + 2], h))
                    found[n] = (step + part) * h
                    break
                y = z
        return found

    return lambda state: np.asarray(flips(state, params, END, h))


def _first(times: Array) -> Array:
    first = np.where(np.isnan(times), np.inf, times).min(axis=1)
    return np.where(np.isinf(first), np.nan, first)


def error(found: Array, truth: Array) -> float:
    """The error in s that all but `SHARE` of the flips do not exceed; a flip missed is infinite."""
    there = np.isfinite(truth)
    apart = np.abs(found[there] - truth[there])
    return float(np.quantile(np.where(np.isnan(apart), np.inf, apart), 1 - SHARE))


def comparison(module: GeneratedModule, hy: Any, nb: Any) -> dict[str, Any]:
    """Seconds for the whole map, each program with its cheapest setting that meets `ERROR`."""
    equations = peers.double_pendulum(hy)
    params = list(module.DEFAULTS)
    settings: dict[str, list[tuple[str, Flips]]] = {
        "holonomic": [
            (f"{method}, {t:g}", partial(ours, module, method, t, 1))
            for t in (1e-8, 1e-9) for method in ("verner87", "verner98")
        ],
        "heyoka": [
            (f"{name}, {t:g}", partial(heyoka, hy, found, params, t))
            for t in (1e-7, 1e-8) for name, found in equations.items()
        ],
        "numba": [(f"h = {h:g}", numba(nb, module, h)) for h in (4e-3, 2e-3, 1e-3)],
    }  # fmt: skip
    coarse = starts(module, COARSE)
    coarse = coarse[: len(coarse) // 16 * 16]  # in full batches
    # each is judged by a program of another kind
    taylor = heyoka(hy, equations["textbook"], params, 1e-16, coarse)
    truth = {"holonomic": taylor, "heyoka": ours(module, "verner98", 1e-14, 1, coarse)}
    whole = starts(module, SIDE)
    seconds, chosen = {}, {}
    for side, runs in settings.items():
        good = [
            (_seconds(partial(run, coarse)), name, run)
            for name, run in runs
            if error(run(coarse), truth.get(side, taylor)) <= ERROR
        ]
        _, chosen[side], run = min(good, key=itemgetter(0))
        seconds[side] = _seconds(partial(run, whole))
    method, _, tolerance = chosen["holonomic"].partition(", ")
    seconds["one lane"] = _seconds(partial(scalar, module, method, float(tolerance), whole))
    seconds["both cores"] = _seconds(partial(ours, module, method, float(tolerance), 2, whole))
    return {"motions": len(whole), "seconds": seconds, "settings": chosen}


def overhead(module: GeneratedModule) -> list[dict[str, float]]:
    """Seconds of sweeps, and of nothing but their ensembles, for growing numbers of motions."""
    rows = []
    for count in GROWTH:
        axes = Random({"theta1": (-np.pi, np.pi), "theta2": (-np.pi, np.pi)}, count, seed=1)
        asked = Sweep(module, axes, {"flip": FLIP}, END, atol=1e-9)
        columns = axes.columns(0, count)
        state = np.zeros((count, 4))
        state[:, 0], state[:, 1] = columns["theta1"], columns["theta2"]
        params = [np.full(count, p) for p in module.DEFAULTS]
        can = state[~is_below(module, FLIP.barrier, state, params)]

        def swept(asked: Sweep = asked) -> None:
            with tempfile.TemporaryDirectory() as folder:
                sweep(asked, Path(folder) / "sweep", pool=Pool(workers=2))

        bare = partial(ours, module, asked.method, asked.rtol, 2, can)
        swept()
        pairs = [(_once(swept), _once(bare)) for _ in range(7)]
        ratios = [whole / part for whole, part in pairs]
        rows.append({
            "motions": count, "seconds": float(np.median([whole for whole, _ in pairs])),
            "overhead": float(np.median(ratios)) - 1,
        })  # fmt: skip
    return rows


def _seconds(run: Callable[[], object]) -> float:
    """The median of five, after a first that compiles; of what takes long, that of the first."""
    first = _once(run)
    return first if first > LONG else float(np.median([_once(run) for _ in range(5)]))


def _once(run: Callable[[], object]) -> float:
    begun = time.perf_counter()
    run()
    return time.perf_counter() - begun


def figures(module: GeneratedModule, hy: Any, nb: Any) -> dict[str, Any]:
    """All figures of maps."""
    return {"compared": comparison(module, hy, nb), "sweeps": overhead(module)}


def told(found: dict[str, Any]) -> Iterator[str]:
    """The figures, a line each."""
    both = found["compared"]
    seconds, ours_alone = both["seconds"], both["seconds"]["holonomic"]
    yield (
        f"Flip map, {SIDE} x {SIDE}, {END:g} s, {both['motions']:,} motions; {1 - SHARE:.0%} of "
        f"its times to {ERROR:g} s, on one core:"
    )
    for side, setting in both["settings"].items():
        yield f"  {side:<10}{seconds[side]:7.2f} s ({setting}): {seconds[side] / ours_alone:.1f} x"
    yield (
        f"  one motion at a time {seconds['one lane']:.2f} s; lanes on both cores "
        f"{seconds['both cores']:.2f} s: {seconds['one lane'] / seconds['both cores']:.1f} x"
    )
    yield "Sweeps from random starts, on both cores:"
    for row in found["sweeps"]:
        yield (
            f"  {row['motions']:>9,} motions {row['seconds']:7.2f} s, "
            f"{row['overhead']:+.1%} over the bare ensemble"
        )
