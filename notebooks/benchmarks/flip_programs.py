"""Flip times of double pendulums, computed by several programs.

All integrate motions with enough energy for a flip and locate its time within a step. heyoka
integrates batches with terminal events on its own equations; numba compiles RK4 with fixed steps
and the generated right-hand side, and locates the time by cubic interpolation.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.compiled.kernel import Batch
from solvers.integration.ensemble import ensemble
from solvers.integration.loops import compiled_loop
from solvers.integration.problem import validation
from solvers.integration.problem.events import Event
from solvers.integration.problem.problem import Options
from solvers.sweeps.barrier import is_below
from solvers.sweeps.maps.first import First

Array = NDArray[np.float64]
#: Flip times of motions from these states, shape (n, 4); NaN where there is none.
Flips = Callable[[Array], Array]

#: Duration of the motions in s.
END = 20.0
ANGLES = {"theta1": (-np.pi, np.pi), "theta2": (-np.pi, np.pi)}
FLIP = First(ANGLES, ({"theta1": np.pi}, {"theta2": np.pi}))


def starts(module: GeneratedModule, side: int) -> Array:
    """States in rows, at rest at the centres of side² cells, with enough energy for a flip."""
    angles = (np.arange(side) + 0.5) * 2 * np.pi / side - np.pi
    state = np.zeros((side * side, 4))
    state[:, 0], state[:, 1] = (axis.ravel() for axis in np.meshgrid(angles, angles))
    return can_flip(module, state)


def can_flip(module: GeneratedModule, state: Array) -> Array:
    """The states with enough energy for a flip."""
    params = [np.full(len(state), p) for p in module.DEFAULTS]
    return state[~is_below(module, FLIP.barrier, state, params)]


def _events(module: GeneratedModule) -> list[Event]:
    return [Event(module, e.name, e.value, terminal=True) for e in FLIP.events(module)]


@ignore_predictability()
def by_ensemble(
    module: GeneratedModule, method: str, tol: float, workers: int, state: Array
) -> Array:
    """Flip times by an ensemble."""
    solve = partial(ensemble, method=method, rtol=tol, atol=tol, workers=workers)
    motions = solve(module, (0, END), state.T, module.DEFAULTS, events=_events(module))
    return _first(motions.t_events[:, :, 0])


def by_single_motions(module: GeneratedModule, method: str, tol: float, state: Array) -> Array:
    """Flip times by the compiled loop with one motion at a time."""
    events = _events(module)
    options = Options(method, "rational", tol, tol, t_eval=(), events=events)
    problem = validation.problem(module, (0, END), state[0], module.DEFAULTS, options)
    batch = Batch(compiled_loop.loop(problem), problem, state, occurrences=1)
    batch.restart()
    batch.run()
    occurred = batch.motions["occurred"][:, : len(events)] > 0
    return _first(np.where(occurred, batch.event_rows["t"][:, :, 0], np.nan))


def _first(times: Array) -> Array:
    first = np.where(np.isnan(times), np.inf, times).min(axis=1)
    return np.where(np.isinf(first), np.nan, first)


def by_heyoka(hy: Any, equations: Any, params: Sequence[float], tol: float, state: Array) -> Array:
    """Flip times by heyoka's batches; a lane whose motion has ended waits for the others."""
    width = hy.recommended_simd_size()
    angles = hy.make_vars("theta1", "theta2")
    events = [hy.t_event_batch(angle**2 - np.pi**2) for angle in angles]
    pars = np.repeat(np.array(params)[:, None], width, axis=1)
    options = {"tol": tol, "t_events": events, "pars": pars}
    integrator = hy.taylor_adaptive_batch(equations, np.zeros((4, width)), **options)
    times = np.full(len(state), np.nan)
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
                # terminal events have the outcomes -1, -2, …
                if -len(events) - 1 < int(outcome) < 0:
                    times[first + lane], is_over[lane] = integrator.time[lane], True
                elif integrator.time[lane] >= END:
                    is_over[lane] = True
    return times


def by_numba(nb: Any, module: GeneratedModule, h: float) -> Flips:
    """A function that computes flip times by RK4 in numba."""
    rhs = nb.njit(module.rhs)
    params = tuple(map(float, module.DEFAULTS))

    @nb.njit  # type: ignore[untyped-decorator]
    def add(y: Any, k: Any, h: float) -> Any:
        return (y[0] + h * k[0], y[1] + h * k[1], y[2] + h * k[2], y[3] + h * k[3])

    @nb.njit  # type: ignore[untyped-decorator]
    def crossing(x: float, v: float, y: float, w: float, h: float) -> float:
        """The fraction of h at which the cubic Hermite interpolant is ±π."""
        aim, low, high = np.copysign(np.pi, y), 0.0, 1.0
        for _ in range(60):
            s = (low + high) / 2
            start = (1 + 2 * s) * (1 - s) ** 2 * x + s * (1 - s) ** 2 * h * v
            cubic = start + s * s * (3 - 2 * s) * y + s * s * (s - 1) * h * w
            if abs(cubic) < abs(aim):
                low = s
            else:
                high = s
        return high

    @nb.njit  # type: ignore[untyped-decorator]
    def flips(states: Any, params: Any, end: float, h: float) -> Any:
        times = np.full(len(states), np.nan)
        for n in range(len(states)):
            y = (states[n, 0], states[n, 1], states[n, 2], states[n, 3])
            for step in range(round(end / h)):
                k1 = rhs(0.0, y, params)
                k2 = rhs(0.0, add(y, k1, h / 2), params)
                k3 = rhs(0.0, add(y, k2, h / 2), params)
                k4 = rhs(0.0, add(y, k3, h), params)
                z = add(add(add(add(y, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6)
                if abs(z[0]) >= np.pi or abs(z[1]) >= np.pi:
                    part = 1.0
                    for i in range(2):
                        if abs(z[i]) >= np.pi:
                            part = min(part, crossing(y[i], y[i + 2], z[i], z[i + 2], h))
                    times[n] = (step + part) * h
                    break
                y = z
        return times

    return lambda state: np.asarray(flips(state, params, END, h))
