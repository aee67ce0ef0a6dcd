"""Compiled functions for one motion after another, with little overhead per call."""

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import ulp
from struct import Struct
from typing import Any, TypeAlias

import numpy as np

from solvers.equations.assembly import Assembly
from solvers.equations.module import (
    GeneratedModule,
    has_constraints,
    has_function,
    parameter_names,
)
from solvers.equations.module import inputs as input_names
from solvers.equations.number_checks import REAL, Values, finite_row
from solvers.equations.signature_checks import known_names
from solvers.equations.singularities import check_condition
from solvers.integration.checks.accuracy_warnings import accuracy_warnings
from solvers.integration.checks.singularity import singularity
from solvers.integration.checks.step_stability import diagnosis
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.compiled.kernel import Batch
from solvers.integration.compiled.memory_layout import STATUSES
from solvers.integration.loops import compiled_loop
from solvers.integration.loops.singular_passage import rerun
from solvers.integration.problem import validation
from solvers.integration.problem.inputs import given
from solvers.integration.problem.problem import SHORTEST, Options, Problem
from solvers.integration.problem.status import Status

Numbers: TypeAlias = Sequence[float] | Mapping[str, float]
#: The result of the C function for a span or state that is not finite.
NOT_NUMBERS = -1


class NotFinishedError(ArithmeticError):
    """A motion did not reach its end: `status` is the reason, `t` and `y` time and state there."""

    def __init__(self, status: Status, t: float, y: tuple[float, ...], detail: str = "") -> None:
        super().__init__(f"{status.value} (t = {t}, y = {y}{detail and f'; {detail}'})")
        self.status, self.t, self.y = status, t, y


@known_names
def prepare(
    module: GeneratedModule,
    params: Values,
    *,
    method: str = "verner853",
    form: str | None = None,
    rtol: float = 1e-9,
    atol: float = 1e-12,
    h: float | None = None,
    max_steps: int = 1_000_000,
    compensated: bool = False,
) -> "Prepared":
    """Compile a function ``run((t0, t1), y0, params=None, inputs=None)``: the state at t1.

    Parameters
    ----------
    module : module
        A generated module.
    params : array_like of shape (parameters,), or mapping of str to float
        As in `integrate`; a call can give others, whose mass matrices are not examined, and
        other inputs, which are the last parameters.
    method, form, rtol, atol, h, max_steps, compensated : optional
        As in `integrate`; `method` is none of SciPy's.

    Returns
    -------
    Prepared
        The function; each thread needs its own.

    Raises
    ------
    ValueError
        When an argument is invalid, or no compiled loop can solve the problem; other errors are
        those of `integrate`.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> run = prepare(dp, dp.DEFAULTS, rtol=1e-10)
    >>> end = run((0, 5), (0.1, 0.0, 0.0, 0.0))
    >>> [round(x, 6) for x in end]
    [-0.026553, -0.044719, -0.27311, 0.19133]
    >>> on_the_moon = run((0, 5), (0.1, 0.0, 0.0, 0.0), {"g": 1.62})
    """
    options = Options(
        method, form, rtol, atol, h, (), (), max_steps, backend="compiled", compensated=compensated
    )
    problem = validation.problem_at_rest(module, (0.0, 1.0), options, params)
    check_condition(module, [("", problem.form.constants, None)])
    problem, program = compiled_loop.select(problem, lanes=False)
    assert program
    return Prepared(program.single, Batch(program, problem), problem)


class Prepared:
    """A function that integrates one motion after another.

    ``run((t0, t1), y0, params=None, inputs=None)`` takes times in s; `y0`, `params` and `inputs`
    are in order or by name. Without `params`, and without `inputs`, those are used that were
    prepared; `inputs` replace those in `params`, and are constant during the call. It raises
    `ValueError` for invalid arguments, `NotFinishedError` where the motion does not reach the end
    of the time span, and `RuntimeError` in a thread that calls it during a call of another thread.
    """

    def __init__(self, single: Any, batch: Batch, problem: Problem) -> None:
        self._batch, self._problem = batch, problem
        buffer = ctypes.c_double * len(problem.start)
        self._start, self._end = buffer(), buffer()
        self._unpack = Struct(f"{len(problem.start)}d").unpack_from  # faster than a tuple
        self._defaults, self._has_defaults = problem.form.params, True
        address = batch.motions["params"].ctypes.data
        self._params = (ctypes.c_double * len(self._defaults)).from_address(address)
        single.argtypes = [ctypes.c_void_p, *[ctypes.c_double] * 2, *[ctypes.c_void_p] * 2]
        single.restype = ctypes.c_int64
        batch.task.time_limit = compiled_loop.TIME_LIMIT
        self._single, self._task = single, ctypes.addressof(batch.task)
        self._from, self._to = map(ctypes.addressof, (self._start, self._end))
        module, names = problem.form.module, problem.form.ordinary
        parameters = parameter_names(module, problem.form.name)
        self._positive = [k for k, p in enumerate(parameters) if p in module.POSITIVE]
        self._inputs = len(input_names(module))
        self._limited = [k for k, q in enumerate(names) if q in module.POSITIVE]
        self._is_constrained = has_constraints(module)
        self._assembly: Assembly | None = None  # of the parameters and start of the last call
        self._span_start = 0.0
        self._idle = [True]  # empty during a call; faster than a lock, and as atomic

    def __call__(
        self,
        t_span: tuple[float, float],
        y0: Numbers,
        params: Numbers | None = None,
        inputs: Any = None,
    ) -> tuple[float, ...]:
        """The state at the end of `t_span`."""
        try:
            self._idle.pop()
        except IndexError:
            raise RuntimeError(
                "this prepared function is running in another thread, and its calls share memory: "
                "prepare one function for each thread"
            ) from None
        try:
            return self._run(t_span, y0, params, inputs)
        finally:
            self._idle.append(True)

    def _run(
        self, t_span: tuple[float, float], y0: Numbers, params: Numbers | None, inputs: Any
    ) -> tuple[float, ...]:
        if params is not None or not self._has_defaults:
            self._has_defaults = False
            self._set_params(self._defaults if params is None else params)
            self._has_defaults = params is None
        if inputs is not None:
            self._has_defaults = False
            self._set_inputs(inputs)
        try:
            start, end = t_span
            values: list[Any] = list(y0)
            are_real = type(start) in REAL and type(end) in REAL
            are_real = are_real and REAL.issuperset(map(type, values))
            if are_real:
                self._start[:] = values
        except (TypeError, ValueError, OverflowError):
            are_real = False
        if not are_real or (self._is_constrained and not self._is_consistent(start, values)):
            start, end = validation.time_span(t_span)
            self._span_start = start
            self._start[:] = self._checked(y0)
        if self._limited and not all(self._start[k] > 0 for k in self._limited):
            self._checked(self._start)
        if start == end:
            validation.time_span(t_span)
            return tuple(self._checked(self._start))
        self._span_start = start
        h = self._problem.h
        try:
            if h is not None and h < SHORTEST * ulp(max(abs(start), abs(end))):
                validation.step_size(h, t_span)
            code = self._single(self._task, start, end, self._from, self._to)
        except (ctypes.ArgumentError, OverflowError):
            code = NOT_NUMBERS
        if code == NOT_NUMBERS:
            validation.time_span(t_span)
            self._checked(self._start)
        while STATUSES[code] is None:
            code = self._single(self._task, start, end, None, self._to)
        y, status = self._unpack(self._end), STATUSES[code]
        if status is Status.SINGULAR:
            outcome = rerun(self._problem_of(start, end))
            status, y = outcome.status, tuple(outcome.end[1].tolist())
        if status is not Status.FINISHED:
            assert status is not None
            raise self._failure(status.without_events, start, end, y)
        return y

    def _failure(
        self, status: Status, start: float, end: float, y: tuple[float, ...]
    ) -> NotFinishedError:
        problem, t = self._problem_of(start, end), float(self._batch.motions["t"][0])
        detail = diagnosis(problem) if status is Status.NOT_FINITE else ""
        if detail:
            status = Status.UNSTABLE
        return NotFinishedError(status, t, y, detail or singularity(problem, status, (t, y)))

    def _problem_of(self, start: float, end: float) -> Problem:
        """The problem of the last motion."""
        problem = self._problem.with_params(list(self._params))
        return replace(problem, span=(start, end), start=np.array(self._start))

    def _is_consistent(self, t: float, values: list[float]) -> bool:
        """Whether a complete state satisfies the constraints to rounding errors."""
        module = self._problem.form.module
        if len(values) != len(module.STATE) or has_function(module, "redundant_constraints"):
            return False
        if self._assembly is None or self._assembly.t != t:
            self._assembly = Assembly(module, np.array([self._params]), t)
        return self._assembly.is_exact(values)

    def _set_params(self, params: Numbers) -> None:
        self._assembly = None
        row: Any = finite_row(params)
        is_complete = row is not None and len(row) == len(self._params)
        if row is None or not is_complete or not all(row[k] >= 0 for k in self._positive):
            row = self._checked_params(params)
        self._params[:] = row

    def _checked_params(self, params: Any) -> list[Any]:
        form = self._problem.form
        return validation.parameters(form.module, params, form.name).tolist()

    def _set_inputs(self, inputs: Any) -> None:
        self._assembly = None
        row: Any = finite_row(inputs)
        if not row or len(row) != self._inputs:
            row = given("inputs", self._problem.form.module, inputs).tolist()
        self._params[-len(row) :] = row

    def _checked(self, y0: Any) -> list[Any]:
        form, t = self._problem.form, self._span_start
        return validation.initial_state(form.module, y0, form.name, [*self._params], t).tolist()

    @property
    def steps(self) -> int:
        """Accepted steps of the last motion."""
        return int(self._batch.motions["steps"][0])

    @property
    def warnings(self) -> list[str]:
        """Texts of the warnings that `integrate` gives for the last motion, computed on demand.

        Its end must have been reached; a call itself computes nothing for them.
        """
        t, end = (float(self._batch.motions[name][0]) for name in ("t", "t_end"))
        if t != end:
            return []
        problem = self._problem_of(self._span_start, end)
        return [str(warning) for warning in accuracy_warnings(problem, end, np.array(self._end))]

    @property
    def nfev(self) -> int:
        """Evaluations of the right-hand side by the last motion."""
        return int(self._batch.nfev[0])


def no_compiler(module: GeneratedModule) -> str:
    """The compiler's message if no loop can be compiled for `module`; empty if one can."""
    try:
        prepare(module, module.DEFAULTS)
    except NoCompilerError as error:
        return str(error)
    return ""
