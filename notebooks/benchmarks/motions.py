"""Times of compiled loops and other programs at equal measured error.

Every figure is a ratio within one run: the programs are called in turn, and medians are compared
at the same global error, interpolated on each program's own curve. Preparation and compilation
are left out and stated separately.
"""

from collections.abc import Callable
from functools import partial
from math import isnan, pi
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from benchmarks import heyoka
from benchmarks.median_times import median_times
from solvers.equations.module import GeneratedModule, function
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.ensemble import ensemble
from solvers.integration.prepare import NotFinishedError, prepare
from solvers.studies.work_precision.measured_curves import FINEST_OF_SCIPY

Array = NDArray[np.float64]
#: Seconds and global errors of each program, from loose to tight tolerances.
Curves = dict[str, list[tuple[float, float]]]
#: Functions that return final states, by the names of programs.
Runs = dict[str, Callable[[], Array]]

#: The report's scene, and its state at 5 s from an 80-bit Taylor series.
START, END = (pi / 2, pi, 0.0, 0.0), 5.0
FINAL = (2.2280642400930692, -0.2670447339117043, -1.9694093323354762, -2.9859792219408772)
#: Methods, and the tolerances below which they take far too many steps.
METHODS = {"bs32": 1e-5, "dp54": 1e-9, "tsit54": 1e-9, "dop853": 0, "verner853": 0, "verner98": 0}
#: Methods for a single motion only, and the same of them.
PARALLEL = {"gauss4": 0, "gauss8": 0}
MOTIONS = 4096
#: Errors of heyoka are about its tolerance, ours a multiple: its tolerances reach further.
HEYOKA_POWER = 8 / 7


def tolerances(loosest: float, tightest: float) -> Array:
    """Two tolerances per decade, from loose to tight."""
    return np.logspace(loosest, tightest, round(2 * (loosest - tightest)) + 1)


def random_starts() -> Array:
    """States at rest at random angles, shape (`MOTIONS`, 4)."""
    starts = np.zeros((MOTIONS, 4))
    starts[:, :2] = np.random.default_rng(1).uniform(-pi, pi, (MOTIONS, 2))
    return starts


def one_motion(module: GeneratedModule, hy: Any) -> Curves:
    """Curves of the report's scene: our methods, heyoka with three sets of equations, SciPy."""
    params = module.DEFAULTS
    systems = {name: (e, START) for name, e in heyoka.double_pendulum(hy).items()}
    rational_start = function(module, "rational_state")(0.0, START, params)
    systems["rational"] = heyoka.generated(hy, module), rational_start
    curves: Curves = {}
    for tol in map(float, tolerances(-1, -14)):
        ready = partial(prepare, module, params, rtol=tol, atol=tol)
        methods = METHODS | PARALLEL
        runs: Runs = {m: partial(_state, ready(method=m)) for m in methods if tol > methods[m]}
        for name, system in systems.items():
            run = heyoka.single(hy, *system, params, END, tol**HEYOKA_POWER)
            runs[f"heyoka, {name}"] = run
        if tol > FINEST_OF_SCIPY:
            runs["solve_ivp"] = partial(_by_scipy, module, tol)
        for name, time in median_times(runs, 0.3).items():
            state = ordinary(runs[name]()[np.newaxis])[0]
            if not isnan(error := float(np.abs(state - FINAL).max())):
                curves.setdefault(name, []).append((time, error))
    return curves


def _state(run: Callable[..., Any]) -> Array:
    try:
        return np.array(run((0.0, END), START))
    except NotFinishedError:  # the tolerance is too loose for this method
        return np.full(len(START), np.nan)


def _by_scipy(module: GeneratedModule, tol: float) -> Array:
    solve = partial(solve_ivp, method="DOP853", rtol=tol, atol=tol, args=(module.DEFAULTS,))
    return solve(module.rhs, (0.0, END), START).y[:, -1]


def many_motions(module: GeneratedModule, hy: Any) -> Curves:
    """Curves of many motions from rest at random angles: time of one, on one core; median error."""
    starts, params = random_starts(), module.DEFAULTS
    derived = heyoka.double_pendulum(hy)
    final = heyoka.reference(hy, derived["textbook"], starts, params, END)
    systems = {name: (equations, starts) for name, equations in derived.items()}
    rational = function(module, "rational_state_many")(0.0, starts.T, params)
    systems["rational"] = heyoka.generated(hy, module), np.ascontiguousarray(rational.T)
    curves: Curves = {}
    for tol in map(float, tolerances(-3, -14)):
        ours = partial(_by_ensemble, module, starts, tol)
        runs: Runs = {m: partial(ours, m) for m in METHODS if tol > METHODS[m]}
        for name, system in systems.items():
            run = heyoka.batches(hy, *system, params, END, tol**HEYOKA_POWER)
            runs[f"heyoka, {name}"] = run
        for name, time in median_times(runs, 0.0).items():
            # angles of the rational form are known up to whole turns
            apart = np.abs(ordinary(runs[name]()) - final)
            apart[:, :2] = np.abs((apart[:, :2] + pi) % (2 * pi) - pi)
            if not isnan(error := float(np.median(apart.max(axis=1)))):
                curves.setdefault(name, []).append((time / MOTIONS, error))
    return curves


@ignore_predictability()
def _by_ensemble(module: GeneratedModule, starts: Array, tol: float, method: str) -> Array:
    solve = partial(ensemble, method=method, rtol=tol, atol=tol, workers=1)
    return solve(module, (0.0, END), starts.T, module.DEFAULTS).y.T


def ordinary(states: Array) -> Array:
    """Angles and velocities of states, which may be rational."""
    if states.shape[1] == len(START):
        return states
    s1, c1, s2, c2, *rates = states.T
    return np.array([np.arctan2(s1, c1), np.arctan2(s2, c2), *rates]).T
