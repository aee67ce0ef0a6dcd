"""Single motions in numbers longer than doubles, by a compiled loop.

Each of the three kinds of numbers is the fastest for some motions. The report's scene over 20 s to
an error of 1e-12 takes 0.7 ms in sums of two doubles and 28 ms in quadruple numbers; to 1e-10 it
takes 0.7 ms and, in ``long double``, 2.5 ms. But equations that call functions, as those of 5 of
the 23 systems that ship do, cannot be written in sums of two doubles: the driven pendulum takes
26 ms in ``long double`` and 127 ms in quadruple numbers (20 s, error below 1e-13). Where ``long
double`` has 53 bits, and where compilers lack ``__float128``, only sums of two doubles are longer.
"""

import ctypes
from collections.abc import Callable, Sequence
from decimal import Decimal, localcontext
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from solvers.equations.forms import Form, fastest_form
from solvers.equations.module import GeneratedModule, has_constraints, has_header, integrals
from solvers.equations.singularities import NEAR, distance_from_singularity
from solvers.integration.compiled.compiler import NoCompilerError, build
from solvers.integration.compiled.double_double import DoubleDouble
from solvers.integration.compiled.extended_source import (
    DIGITS,
    DOUBLE,
    LONG_DOUBLE,
    PARTS,
    QUADRUPLE,
    NotArithmeticError,
    Precision,
    Sequential,
)
from solvers.integration.compiled.memory_layout import STATUSES
from solvers.integration.compiled.native import equations
from solvers.integration.problem.problem import COLLAPSE, shortest_step
from solvers.integration.problem.status import Status
from solvers.references.decimal_numbers import decimal_state
from solvers.runge_kutta.stepper import Array

#: Seconds of C between checks for an interruption by the user, and bytes to which C aligns numbers.
TIME_LIMIT, ALIGNMENT = 0.05, 64
#: Perturbations in units of the spacing of numbers above 1.
CHANGE = 0.5


PRECISIONS: dict[str, Precision] = {
    "double-double": DoubleDouble(),
    "long double": Sequential(LONG_DOUBLE, DOUBLE, 8),
    "quadruple": Sequential(QUADRUPLE, LONG_DOUBLE, 12),
}


class ExtendedError(ArithmeticError):
    """A motion ends before its last sample; the message states the time and the reason."""

    def __init__(self, status: Status, message: str) -> None:
        super().__init__(message)
        self.status = status


class ExtendedKernel:
    """The compiled program for a module's fastest form in one of `PRECISIONS`.

    `NoCompilerError` where no compiler has its number type, that is no longer than double, or the
    equations cannot be written in it.
    """

    def __init__(self, module: GeneratedModule, name: str) -> None:
        precision, form = PRECISIONS[name], Form(module, fastest_form(module), module.DEFAULTS)
        self.form = form
        if not has_header(module):
            raise NoCompilerError(f"there is no C header beside {module.SYSTEM}")
        source = equations(module, form.name)
        try:
            text = precision.program(source, form)
            self.library = build(text, reproducible=not precision.may_fuse)
        except (NoCompilerError, NotArithmeticError) as error:
            raise NoCompilerError(f"no {name} numbers: {error}") from error
        functions = self.library.functions
        names = "start", "advance", "progress", "size", "epsilon"
        self.start, self.advance, self.progress, size, epsilon = (
            getattr(functions, f"extended_{name}") for name in names
        )
        number, whole, pointer = ctypes.c_double, ctypes.c_int64, ctypes.c_void_p
        self.start.argtypes = [pointer, number, number, pointer, pointer, pointer]
        arrays = [pointer, pointer, whole, pointer]
        self.advance.argtypes = [*arrays, number, number, number, whole, number]
        self.progress.argtypes = [pointer, pointer]
        self.start.restype = self.progress.restype = None
        self.advance.restype = size.restype = whole
        epsilon.restype = number
        self.size, self.epsilon = int(size()), float(epsilon())
        if self.epsilon >= np.finfo(float).eps:
            raise NoCompilerError(f"no {name} numbers: they have no more digits than doubles here")


kernel = cache(ExtendedKernel)


def _parts(form: Form, y0: Sequence[float]) -> Array:
    """The decimal state, each component as a sum of doubles, shape (size, parts)."""
    with localcontext(prec=DIGITS):
        rest, parts = decimal_state(form, y0), list[list[float]]()
        for _ in range(PARTS):
            parts.append([float(x) for x in rest])
            rest = [x - Decimal(part) for x, part in zip(rest, parts[-1], strict=True)]
    return np.ascontiguousarray(np.transpose(parts))


def integrate_extended(
    module: GeneratedModule,
    params: Sequence[float],
    y0: Sequence[float],
    times: ArrayLike,
    precision: str,
    rtol: float,
    max_steps: int = 10**6,
    progress: Callable[[float], None] = lambda t: None,
    perturbation: int = 0,
) -> Array:
    """States (q, q̇) at `times` in numbers longer than doubles; the first one is `y0`.

    Parameters
    ----------
    module : module
        A generated module, whose header stands beside it.
    params, y0 : sequence of float
        In the order of ``module.PARAMETERS`` and ``module.STATE``, taken as exact.
    times : array_like of shape (n,)
        Increasing or decreasing, in s.
    precision : {"double-double", "long double", "quadruple"}
        The number type: sums of two doubles, for equations without calls of functions; that of C;
        or IEEE 754 binary128.
    rtol : float
        Relative tolerance of the error of a step, for components above 1e-3 in magnitude.
    max_steps : int, optional
        Most steps.
    progress : callable, optional
        Called with the time in s several times a second; an exception that it raises ends the
        integration.
    perturbation : int, optional
        The seed of random changes, which differ from rounding errors of the start, of parameters
        and of constants by a few units only; 0 for none. Runs with the same parameters have the
        latter in common.

    Returns
    -------
    ndarray of shape (n, state)
        The states, rounded to floats at the end. Those of systems with constraints, the first one
        too, are moved onto these, to rounding errors of the numbers.

    Raises
    ------
    ExtendedError
        When the last of the times is not reached: at a singularity, near a configuration where
        constraints depend on each other, or after `max_steps`.
    solvers.integration.compiled.compiler.NoCompilerError
        When no compiler has numbers of this type, or the equations cannot be written in them.

    Notes
    -----
    Gauss collocation with step control by the last Legendre coefficients of the derivative. Stages
    are solved by fixed-point iterations in a shorter type and refined in the longer one, and sums
    are compensated.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> start = (1.5, 3.0, 0.0, 0.0)
    >>> integrate_extended(dp, dp.DEFAULTS, start, [0, 5], "quadruple", 1e-24).shape
    (2, 4)
    """
    loop, samples = kernel(module, precision), np.ascontiguousarray(times, dtype=float)
    begin, end = float(samples[0]), float(samples[-1])
    size = len(module.STATE)
    rows, numbers = np.empty((len(samples), size)), np.zeros(1 + size)
    kept = np.zeros(len(integrals(module)))  # values that C sets
    start, values = _parts(loop.form, y0), np.array([*params, *kept], dtype=float)
    signs = np.random.default_rng(perturbation).choice([-CHANGE, CHANGE], len(start) + len(values))
    changes = signs * bool(perturbation)
    memory = np.zeros(loop.size + ALIGNMENT, np.uint8)
    motion = -(-memory.ctypes.data // ALIGNMENT) * ALIGNMENT
    arrays = (array.ctypes.data for array in (start, values, changes))
    loop.start(motion, begin, end - begin, *arrays)
    status, collapse = None, COLLAPSE * has_constraints(module)
    while status is None:
        code = loop.advance(
            *(motion, samples.ctypes.data, len(samples), rows.ctypes.data),
            *(rtol, shortest_step(begin, end), collapse, max_steps, TIME_LIMIT),
        )
        status = STATUSES[code]
        loop.progress(motion, numbers.ctypes.data)
        progress(float(numbers[0]))
        t, y = float(numbers[0]), numbers[1:]
        if status is Status.SINGULAR:
            near = distance_from_singularity(module, params, y.tolist(), t) <= NEAR
            status = status if near else None  # steps are short for another reason
    if status is not Status.FINISHED:
        reason = {
            Status.STEP_LIMIT: f"it takes more than {max_steps} steps",
            Status.STEP_TOO_SMALL: "a step is below the resolution of time, as at a singularity",
            Status.SINGULAR: "constraints nearly depend on each other, as at a toggle point",
        }[status]
        raise ExtendedError(status, f"{reason} (t = {numbers[0]:.10g}, {precision})")
    return rows
