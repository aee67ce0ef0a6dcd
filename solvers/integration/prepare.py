"""One motion after another, with as little as possible around the compiled loop."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from math import ulp
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from solvers.equations.module import GeneratedModule, state_names
from solvers.integration import compiled_loop, validation
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.compiled.kernel import Batch
from solvers.integration.compiled.layout import STATUSES
from solvers.integration.problem import SHORTEST, Problem
from solvers.integration.solution import Status

#: What C answers to a span or state that is not finite.
NOT_NUMBERS = -1


class NotFinishedError(ArithmeticError):
    """A motion did not reach its end.

    Attributes
    ----------
    status : Status
        Why.
    t : float
        Where it got to.
    y : tuple of float
        Its state there.
    """

    def __init__(self, status: Status, t: float, y: tuple[float, ...]) -> None:
        super().__init__(f"{status.value} (t = {t}, y = {y})")
        self.status, self.t, self.y = status, t, y


def prepare(
    module: GeneratedModule,
    params: ArrayLike,
    *,
    method: str = "verner87",
    form: str | None = None,
    rtol: float = 1e-9,
    atol: float = 1e-12,
    h: float | None = None,
    max_steps: int = 1_000_000,
    compensated: bool = False,
) -> Prepared:
    """A function ``run((t0, t1), y0)`` that returns the state at t1, compiled now.

    Parameters
    ----------
    module : module
        A generated module.
    params : array_like of shape (parameters,)
        In the order of ``module.PARAMETERS``.
    method : str, optional
        One of ``solvers.runge_kutta.catalogue.names()``.
    form : {"lagrangian", "hamiltonian", "rational", "variational"}, optional
        The equations that are integrated, as in `solvers.integration.integrate.integrate`.
    rtol, atol : float, optional
        A step's error in a component may be atol + rtol |y|.
    h : float, optional
        A fixed step in s.
    max_steps : int, optional
        No motion takes more steps.
    compensated : bool, optional
        Whether the state's rounding errors are carried along.

    Returns
    -------
    Prepared
        Each thread needs one of its own.

    Raises
    ------
    ValueError
        When an argument makes no sense, or no compiled loop can do what is asked.
    solvers.runge_kutta.catalogue.UnknownMethodError
        When no method has this name.
    solvers.integration.compiled.compiler.NoCompilerError
        When no compiler could build the loop.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> run = prepare(dp, dp.DEFAULTS, rtol=1e-10)
    >>> end = run((0, 5), (0.1, 0.0, 0.0, 0.0))
    >>> [round(x, 6) for x in end]
    [-0.026553, -0.044719, -0.27311, 0.19133]
    """

    def asked(form: str) -> Problem:
        rest = (0.0,) * len(state_names(module, form))
        return validation.problem(
            module, (0.0, 1.0), rest, params, method, form, rtol, atol, h, [], (), max_steps
        )

    problem, program = compiled_loop.choice(
        asked, form, "compiled", method, lanes=False, compensated=compensated
    )
    assert program
    batch = Batch(
        program, problem, problem.form, problem.start[np.newaxis],
        capacity=0, occurrences=0, pauses=False,
    )  # fmt: skip
    return Prepared(program.single, batch, problem)


class Prepared:
    """A function that integrates one motion after another: ``run((t0, t1), y0)``.

    It takes a time span in s and an ordinary state, and returns the state at the span's end
    as a tuple. It raises `ValueError` for a span or state that makes no sense and
    `NotFinishedError` where the motion does not reach its end.

    Parameters
    ----------
    once : ctypes function
        As in `solvers.integration.compiled.kernel.Kernel`.
    batch : Batch
        One motion, of which `once` uses the room.
    problem : Problem
        What is asked.
    """

    def __init__(self, once: Any, batch: Batch, problem: Problem) -> None:
        self._batch, self._problem = batch, problem
        room = ctypes.c_double * len(problem.start)
        self._start, self._end = room(), room()
        once.argtypes = [ctypes.c_void_p, *[ctypes.c_double] * 2, *[ctypes.c_void_p] * 2]
        once.restype = ctypes.c_int64
        batch.task.time_limit = compiled_loop.PATIENCE
        self._once, self._task = once, ctypes.addressof(batch.task)
        self._from, self._to = map(ctypes.addressof, (self._start, self._end))

    def __call__(self, t_span: tuple[float, float], y0: Sequence[float]) -> tuple[float, ...]:
        """The state at the end of `t_span` of the motion that begins with `y0`."""
        try:
            begin, end = t_span
            self._start[:] = list(y0)
        except (TypeError, ValueError):
            self._refuse(t_span, y0)
            raise
        if begin == end:
            self._refuse(t_span, y0)
            return tuple(self._start)
        h = self._problem.h
        try:
            if h is not None and h < SHORTEST * ulp(max(abs(begin), abs(end))):
                validation.step(h, t_span)
            code = self._once(self._task, begin, end, self._from, self._to)
        except (ctypes.ArgumentError, TypeError):
            code = NOT_NUMBERS
        if code == NOT_NUMBERS:
            self._refuse(t_span, y0)
        while STATUSES[code] is None:
            code = self._once(self._task, begin, end, None, self._to)
        y, status = tuple(self._end), STATUSES[code]
        if status is not Status.FINISHED:
            assert status is not None
            raise NotFinishedError(status, float(self._batch.motions["t"][0]), y)
        return y

    @property
    def steps(self) -> int:
        """Steps of the last motion."""
        return int(self._batch.motions["steps"][0])

    @property
    def nfev(self) -> int:
        """Right-hand sides that the last motion evaluated."""
        return int(self._batch.nfev[0])

    def _refuse(self, t_span: tuple[float, float], y0: Sequence[float]) -> None:
        """Raise for what makes no sense in a span or a state."""
        validation.time_span(t_span)
        validation.numbers("y0", y0, self._problem.form.ordinary)


def no_compiler(module: GeneratedModule) -> str:
    """Why what takes very many steps cannot be compiled; empty if it can."""
    try:
        prepare(module, module.DEFAULTS)
    except NoCompilerError as error:
        return str(error)
    return ""
