"""heyoka's Taylor integrator and its equations of pendulums; needs the extra ``bench``.

A system is a list of pairs: a variable of heyoka and its time derivative.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solvers.equations.forms import fastest_form
from solvers.equations.module import ELEMENTARY, GeneratedModule, function, named, with_functions

Array = NDArray[np.float64]
System = list[tuple[Any, Any]]
Numbers = Sequence[float]


def double_pendulum(hy: Any) -> dict[str, System]:
    """The double pendulum's equations with free parameters m1, m2, l1, l2, g.

    ``positions`` derives them with heyoka's Lagrangian from the positions of the masses, as
    holonomic does; ``textbook`` from the kinetic energy that textbooks print.
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


def chain(hy: Any, n: int) -> tuple[list[Any], list[Any], System]:
    """Angles, velocities and the system of n pendulums, from heyoka's Lagrangian."""
    q = hy.make_vars(*(f"theta{k}" for k in range(n)))
    rates = hy.make_vars(*(f"omega{k}" for k in range(n)))
    m, lengths, g = [hy.par[k] for k in range(n)], [hy.par[n + k] for k in range(n)], hy.par[2 * n]
    vx = [length * hy.cos(a) * v for length, a, v in zip(lengths, q, rates, strict=True)]
    vy = [length * hy.sin(a) * v for length, a, v in zip(lengths, q, rates, strict=True)]
    down = [length * hy.cos(a) for length, a in zip(lengths, q, strict=True)]
    squares = (hy.sum(vx[: k + 1]) ** 2 + hy.sum(vy[: k + 1]) ** 2 for k in range(n))
    kinetic = hy.sum([0.5 * m[k] * square for k, square in enumerate(squares)])
    depth = hy.sum([m[k] * g * hy.sum(down[: k + 1]) for k in range(n)])
    return list(q), list(rates), hy.lagrangian(kinetic + depth, list(q), list(rates))


def generated(hy: Any, module: GeneratedModule) -> System:
    """A module's fastest equations: the generated function, called with heyoka's expressions."""

    def expression(x: Any) -> Any:
        return x if isinstance(x, hy.expression) else hy.expression(x)

    def elementary(name: str) -> Callable[[Any], Any]:
        return lambda x: getattr(hy, name)(expression(x))

    form = fastest_form(module)
    functions = {name: elementary(name) for name in ELEMENTARY}
    rhs = with_functions(function(module, named("rhs", form)), functions)
    state = hy.make_vars(*module.STATES[form])
    params = [hy.par[k] for k in range(len(module.PARAMETERS))]
    return list(zip(state, map(expression, rhs(hy.time, state, params)), strict=True))


@contextmanager
def no_disk_cache(hy: Any) -> Iterator[None]:
    """A context in which heyoka compiles anew."""
    hy.llvm_state.set_diskcache_enabled(False)
    try:
        yield
    finally:
        hy.llvm_state.set_diskcache_enabled(True)


def single(
    hy: Any, system: System, start: Numbers, params: Numbers, end: float, tol: float, **options: Any
) -> Callable[[], Array]:
    """A function that integrates one motion; its next call overwrites the array it returns.

    All numbers have the type `fp_type` of the options.
    """
    integrator = hy.taylor_adaptive(system, list(start), tol=tol, pars=list(params), **options)

    def run() -> Array:
        integrator.time = type(end)(0)
        integrator.state[:] = start
        integrator.propagate_until(end)
        return integrator.state

    return run


def batches(
    hy: Any, system: System, starts: Array, params: Numbers, end: float, tol: float
) -> Callable[[], Array]:
    """A function that integrates motions, shape (n, state), in batches of the recommended size."""
    width = hy.recommended_simd_size()
    state = np.ascontiguousarray(starts[:width].T)
    pars = np.repeat(np.array(params)[:, None], width, axis=1)
    integrator = hy.taylor_adaptive_batch(system, state.copy(), tol=tol, pars=pars)
    ends = [end] * width

    def run() -> Array:
        states = np.empty_like(starts)
        for first in range(0, len(starts), width):
            integrator.set_time(0.0)
            integrator.state[:] = starts[first : first + width].T
            integrator.propagate_until(ends)
            states[first : first + width] = integrator.state.T
        return states

    return run


def reference(hy: Any, system: System, starts: Array, params: Numbers, end: float) -> Array:
    """Final states by Taylor series in 80-bit numbers, with an error of about 1e-17 per step."""
    long = np.longdouble
    first, pars = [long(x) for x in starts[0]], [long(p) for p in params]
    integrator = hy.taylor_adaptive(system, first, tol=long(1e-18), pars=pars, fp_type=long)
    states = np.empty_like(starts)
    for k, start in enumerate(starts):
        integrator.time = long(0)
        integrator.state[:] = start
        integrator.propagate_until(long(end))
        states[k] = integrator.state
    return states
