"""Other programs on the same work, for the benchmark: heyoka's Taylor integrator and its equations.

Needs the extra ``bench``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule, function

Array = NDArray[np.float64]


def double_pendulum(hy: Any) -> dict[str, list[tuple[Any, Any]]]:
    """The double pendulum's equations for heyoka, parameters m1, m2, l1, l2, g left open.

    ``positions`` derives them by heyoka's own Lagrangian from the positions of the
    masses, as holonomic does; ``textbook`` from the kinetic energy that a textbook
    prints. Those that holonomic generates come from `generated`.

    Parameters
    ----------
    hy : module
        heyoka.

    Returns
    -------
    dict of str to list of pair
        For each of the two, variables and their rates, angles before velocities.
    """
    theta, omega = hy.make_vars("theta1", "theta2"), hy.make_vars("omega1", "omega2")
    m1, m2, l1, l2, g = (hy.par[k] for k in range(5))
    (s1, c1), (s2, c2) = ((hy.sin(angle), hy.cos(angle)) for angle in theta)
    x = (l1 * c1 * omega[0], l1 * c1 * omega[0] + l2 * c2 * omega[1])
    y = (l1 * s1 * omega[0], l1 * s1 * omega[0] + l2 * s2 * omega[1])
    potential = -m1 * g * l1 * c1 - m2 * g * (l1 * c1 + l2 * c2)
    kinetic = 0.5 * m1 * (x[0] ** 2 + y[0] ** 2) + 0.5 * m2 * (x[1] ** 2 + y[1] ** 2)
    reduced = (
        0.5 * (m1 + m2) * l1**2 * omega[0] ** 2
        + 0.5 * m2 * l2**2 * omega[1] ** 2
        + m2 * l1 * l2 * omega[0] * omega[1] * hy.cos(theta[0] - theta[1])
    )
    return {
        "positions": hy.lagrangian(kinetic - potential, list(theta), list(omega)),
        "textbook": hy.lagrangian(reduced - potential, list(theta), list(omega)),
    }


def chain(hy: Any, n: int) -> tuple[list[Any], list[Any], list[tuple[Any, Any]]]:
    """Angles, velocities and equations of n pendulums, from heyoka's own Lagrangian.

    Left open are masses, lengths and g, as in the generated chain.

    Parameters
    ----------
    hy : module
        heyoka.
    n : int
        How many pendulums.

    Returns
    -------
    angles, velocities : list
        heyoka's variables, n of each.
    equations : list of pair
        All 2n variables and their rates.
    """
    q = hy.make_vars(*(f"theta{k}" for k in range(n)))
    rates = hy.make_vars(*(f"omega{k}" for k in range(n)))
    m, lengths, g = [hy.par[k] for k in range(n)], [hy.par[n + k] for k in range(n)], hy.par[2 * n]
    vx = [length * hy.cos(a) * v for length, a, v in zip(lengths, q, rates, strict=True)]
    vy = [length * hy.sin(a) * v for length, a, v in zip(lengths, q, rates, strict=True)]
    down = [length * hy.cos(a) for length, a in zip(lengths, q, strict=True)]
    kinetic = hy.sum([
        0.5 * m[k] * (hy.sum(vx[: k + 1]) ** 2 + hy.sum(vy[: k + 1]) ** 2) for k in range(n)
    ])  # fmt: skip
    depth = hy.sum([m[k] * g * hy.sum(down[: k + 1]) for k in range(n)])
    return list(q), list(rates), hy.lagrangian(kinetic + depth, list(q), list(rates))


def generated(hy: Any, module: GeneratedModule) -> list[tuple[Any, Any]]:
    """A module's rational equations for heyoka: the generated function, called with symbols."""
    state = hy.make_vars(*module.STATES["rational"])
    params = [hy.par[k] for k in range(len(module.PARAMETERS))]
    return list(zip(state, function(module, "rhs_rational")(0.0, state, params), strict=True))


def single(hy: Any, equations: Any, start: Sequence[float], params: Sequence[float], end: float,
           tol: float, *, compact: bool = False) -> Callable[[], Array]:  # fmt: skip
    """A function that integrates one motion from `start` and returns its state at `end`.

    Parameters
    ----------
    hy : module
        heyoka.
    equations : list of pair
        Variables and their rates.
    start, params : sequence of float
        State at time 0, and parameters, in the order of the equations.
    end : float
        In s.
    tol : float
        Tolerance of a step.
    compact : bool
        Large systems need it, since else they compile for minutes.

    Returns
    -------
    callable
        Takes nothing. The state is heyoka's own array, which the next call overwrites.
    """
    integrator = hy.taylor_adaptive(
        equations, list(start), tol=tol, pars=list(params), compact_mode=compact
    )

    def run() -> Array:
        integrator.time = 0.0
        integrator.state[:] = start
        integrator.propagate_until(end)
        return integrator.state

    return run


def batches(hy: Any, equations: Any, starts: Array, params: Sequence[float], end: float,
            tol: float) -> Callable[[], Array]:  # fmt: skip
    """A function that integrates motions, shape (n, state), as many at once as heyoka advises."""
    width = hy.recommended_simd_size()
    state = np.ascontiguousarray(starts[:width].T)
    integrator = hy.taylor_adaptive_batch(
        equations, state.copy(), tol=tol, pars=np.repeat(np.array(params)[:, None], width, axis=1)
    )
    ends = [end] * width

    def run() -> Array:
        found = np.empty_like(starts)
        for first in range(0, len(starts), width):
            integrator.set_time(0.0)
            integrator.state[:] = starts[first : first + width].T
            integrator.propagate_until(ends)
            found[first : first + width] = integrator.state.T
        return found

    return run


def reference(hy: Any, equations: Any, starts: Array, params: Sequence[float], end: float) -> Array:
    """States at `end` by Taylor series in 80-bit numbers, to about 1e-17 a step."""
    long = np.longdouble
    integrator = hy.taylor_adaptive(
        equations, [long(x) for x in starts[0]], tol=long(1e-18),
        pars=[long(p) for p in params], fp_type=long,
    )  # fmt: skip
    found = np.empty_like(starts)
    for k, start in enumerate(starts):
        integrator.time = long(0)
        integrator.state[:] = start
        integrator.propagate_until(long(end))
        found[k] = integrator.state
    return found
