"""How fast the compiled loops are beside other programs, at equal measured error.

Every figure is a ratio within one run: both sides in turn, medians, at the same
global error, interpolated on each side's own curve of time over error. Preparing and
compiling is left out on both sides and stated apart.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from solvers.equations.module import GeneratedModule, function
from solvers.integration.ensemble import ensemble
from solvers.integration.prepare import NotFinishedError, prepare
from solvers.integration.timing import work_at
from solvers.studies import heyoka as peers

Array = NDArray[np.float64]

#: The report's scene, and its state at 5 s from an 80-bit Taylor series.
START, END = (pi / 2, pi, 0.0, 0.0), 5.0
FINAL = (2.2280642400930692, -0.2670447339117043, -1.9694093323354762, -2.9859792219408772)
#: Methods that can be the cheapest, and tolerances beyond which they take far too many steps.
SENSIBLE = {
    "bs32": 1e-5, "dp54": 1e-9, "tsit54": 1e-9, "dop853": 0, "verner87": 0, "verner98": 0,
}  # fmt: skip
METHODS = tuple(SENSIBLE)
MOTIONS = 4096
#: heyoka's errors are about its tolerance, ours a multiple: its range goes further.
FURTHER = 8 / 7


@dataclass
class Curve:
    """Seconds over global error, from loose to tight tolerances."""

    seconds: list[float] = field(default_factory=list)
    error: list[float] = field(default_factory=list)

    def add(self, seconds: float, error: float) -> None:
        """A point with a tighter tolerance than those before, unless the run failed."""
        if error == error:
            self.seconds.append(seconds)
            self.error.append(error)

    def at(self, error: float) -> float:
        """Seconds for this error; NaN beyond the curve."""
        return work_at(error, self.error, self.seconds)


def timed(runs: Mapping[str, Callable[[], object]], seconds: float) -> dict[str, float]:
    """Median time of each, all of them in turn, until `seconds` have passed."""
    times: dict[str, list[float]] = {name: [] for name in runs}
    for run in runs.values():
        run()
    until = time.perf_counter() + seconds
    while time.perf_counter() < until or len(next(iter(times.values()))) < 5:
        for name, run in runs.items():
            before = time.perf_counter()
            run()
            times[name].append(time.perf_counter() - before)
    return {name: float(np.median(found)) for name, found in times.items()}


def tolerances(loosest: float, tightest: float) -> Array:
    """From loose to tight, two a decade."""
    return np.logspace(loosest, tightest, round(2 * (loosest - tightest)) + 1)


def one_motion(module: GeneratedModule, hy: Any) -> dict[str, Curve]:
    """Curves of the report's scene: our methods, heyoka with three kinds of equations, SciPy."""
    params, final = module.DEFAULTS, np.array(FINAL)
    derived, rational = peers.double_pendulum(hy), peers.generated(hy, module)
    rational_start = function(module, "rational_state")(0.0, START, params)

    def ours(method: str, tol: float) -> Callable[[], Array]:
        run = prepare(module, params, method=method, rtol=tol, atol=tol)

        def state() -> Array:
            try:
                return np.array(run((0.0, END), START))
            except NotFinishedError:  # a tolerance too loose for this method
                return np.full(len(START), np.nan)

        return state

    def scipy(tol: float) -> Array:
        return solve_ivp(
            module.rhs, (0.0, END), START, method="DOP853", rtol=tol, atol=tol, args=(params,)
        ).y[:, -1]

    curves: dict[str, Curve] = {}
    for tol in tolerances(-1, -14):
        runs: dict[str, Callable[[], Array]] = {
            method: ours(method, tol) for method in METHODS if tol > SENSIBLE[method]
        }
        for name, found in derived.items():
            runs[f"heyoka, {name}"] = peers.single(hy, found, START, params, END, tol**FURTHER)
        runs["heyoka, rational"] = peers.single(
            hy, rational, rational_start, params, END, tol**FURTHER
        )
        if tol > 3e-14:  # SciPy accepts no less
            runs["solve_ivp"] = partial(scipy, tol)
        for name, seconds in timed(runs, 0.3).items():
            state = runs[name]()
            if len(state) > len(START):
                state = _ordinary(state[np.newaxis])[0]
            curves.setdefault(name, Curve()).add(seconds, float(np.abs(state - final).max()))
    return curves


def many_motions(module: GeneratedModule, hy: Any) -> dict[str, Curve]:
    """Curves of many motions from rest at random angles: time of one, on one core; median error."""
    starts = np.zeros((MOTIONS, 4))
    starts[:, :2] = np.random.default_rng(1).uniform(-pi, pi, (MOTIONS, 2))
    params = module.DEFAULTS
    derived, rational = peers.double_pendulum(hy), peers.generated(hy, module)
    final = peers.reference(hy, derived["textbook"], starts, params, END)
    rational_starts = np.ascontiguousarray(
        function(module, "rational_state_many")(0.0, starts.T, params).T
    )

    def ours(method: str, tol: float) -> Callable[[], Array]:
        return lambda: (
            ensemble(
                module, (0.0, END), starts.T, params, method=method, rtol=tol, atol=tol, workers=1
            ).y.T
        )

    curves: dict[str, Curve] = {}
    for tol in tolerances(-3, -14):
        runs = {method: ours(method, tol) for method in METHODS if tol > SENSIBLE[method]}
        for name, found in derived.items():
            runs[f"heyoka, {name}"] = peers.batches(hy, found, starts, params, END, tol**FURTHER)
        runs["heyoka, rational"] = peers.batches(
            hy, rational, rational_starts, params, END, tol**FURTHER
        )
        for name, seconds in timed(runs, 0.0).items():
            states = runs[name]()
            if states.shape[1] > len(START):
                states = _ordinary(states)
            # angles of the rational form are known up to whole turns
            apart = np.abs(states - final)
            apart[:, :2] = np.abs((apart[:, :2] + pi) % (2 * pi) - pi)
            error = float(np.median(apart.max(axis=1)))
            curves.setdefault(name, Curve()).add(seconds / MOTIONS, error)
    return curves


def _ordinary(states: Array) -> Array:
    """Angles and velocities of rational states."""
    s1, c1, s2, c2, *rates = states.T
    return np.array([np.arctan2(s1, c1), np.arctan2(s2, c2), *rates]).T
