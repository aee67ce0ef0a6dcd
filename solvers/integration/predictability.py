"""How long a trajectory is predictable: in chaos, errors grow to the size of the motion."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import replace
from math import inf

import numpy as np

from solvers.equations.module import has_function
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.compiled.kernel import Batch
from solvers.integration.compiled.layout import STATUSES
from solvers.integration.compiled_loop import loop, obstacle
from solvers.integration.problem import Options, Problem
from solvers.integration.solution import Array
from solvers.runge_kutta.catalogue import load
from solvers.runge_kutta.stepper import Stepper
from solvers.runge_kutta.tableau import Tableau

#: Method and tolerance for linear perturbations, most steps, and steps per call.
METHOD, TOLERANCE, MOST_STEPS, CHUNK = "verner87", 1e-9, 20_000, 500
#: In the first steps every change grows, at once where a mode is fast.
FIRST_STEPS = 10
#: The usual ratio of an error to the tolerance, or to the error of a fixed step.
ERROR_RATIO = 10.0
#: The number of fixed steps whose errors are measured.
MEASURED_STEPS = 8
#: The largest initial error, whatever the tolerance, whose growth to 1 counts.
LARGEST_ERROR = 0.05
#: In regular motion changes grow in proportion to time; chaos outgrows this power of time.
POWER = 1.5


_IS_IGNORED = ContextVar("predictability is ignored", default=False)


class PredictabilityWarning(UserWarning):
    """A trajectory is longer than its errors allow."""


@contextmanager
def ignore_predictability() -> Iterator[None]:
    """Suppress `PredictabilityWarning` in a ``with`` block, for all threads.

    In its own thread nothing is computed for it, either.

    Yields
    ------
    None
    """
    token = _IS_IGNORED.set(True)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PredictabilityWarning)
            yield
    finally:
        _IS_IGNORED.reset(token)


def is_ignored() -> bool:
    """Whether this thread is in a block of `ignore_predictability`."""
    return _IS_IGNORED.get()


def usual_error(problem: Problem) -> float:
    """A usual error of a state after some steps: a multiple of the tolerance.

    For fixed steps it is a multiple of the largest difference between one of the first steps and
    two of half its length.
    """
    local = problem.tolerance if problem.h is None else _step_error(problem)
    return min(ERROR_RATIO * max(local, float(np.finfo(float).eps)), LARGEST_ERROR)


def _step_error(problem: Problem) -> float:
    form, method, (begin, end) = problem.form, problem.method, problem.span
    assert isinstance(method, Tableau)
    assert problem.h is not None
    h, t, largest = float(np.copysign(problem.h, end - begin)), begin, 0.0
    stepper = Stepper(method, form.rhs, form.jacobian)
    try:
        y = form.from_ordinary(t, problem.start)
        for _ in range(min(MEASURED_STEPS, max(1, int(abs(end - begin) / problem.h)))):
            first = stepper.derivative(t, y)
            whole = stepper.step(t, y, h, first)[0]
            half = stepper.step(t, y, h / 2, first)[0]
            middle = stepper.derivative(t + h / 2, half)
            halves = stepper.step(t + h / 2, half, h / 2, middle)[0]
            largest = max(largest, float(np.abs(whole - halves).max()))
            t, y = t + h, form.normalised(whole)
    except ArithmeticError:
        return np.inf
    return largest


def predictable_until(problem: Problem, end: float) -> float:
    """The time in s from which on usual errors are as large as the motion.

    There a linear perturbation of the initial state, by the variational equations, has grown by
    the reciprocal of `usual_error` since the first few steps, and faster than in regular motion.
    Its size is that of its coordinates in the metric of the mass matrix, which stays finite where
    coordinates are singular, as at the pole of a sphere. A perturbation that is not integrated to
    the end is extrapolated. The result is infinity if there is no such time before `end`, or if it
    is unknown: without a compiled loop.
    """
    begin, module = problem.span[0], problem.form.module
    if begin == end or "variational" not in module.FORMS or not has_function(module, "mass_matrix"):
        return inf
    variational = replace(
        problem.with_form("variational"),
        method=load(METHOD),
        span=(begin, end),
        h=None,
        rtol=TOLERANCE,
        atol=np.array(TOLERANCE),
        samples=None,
        events=[],
        max_steps=MOST_STEPS,
        options=Options(METHOD),
    )
    if obstacle(variational):
        return inf
    try:
        program = loop(variational)
    except NoCompilerError:
        return inf
    start = problem.start[: len(module.STATE)]
    states = np.array([[*start, *np.ones_like(start)]])
    batch = Batch(program, variational, states, capacity=CHUNK, pauses=True)
    allowed, direction = np.log(1 / usual_error(problem)), float(np.sign(end - begin))
    base, elapsed, growth = 0.0, np.empty(0), np.empty(0)
    status = None
    while status is None:
        batch.restart()
        batch.run()
        status = STATUSES[batch.motions["status"][0]]
        rows = batch.rows[0, : batch.motions["rows"][0]]
        batch.motions["rows"] = 0
        size = _log_size(variational, rows["t"], batch.ordinary(rows))
        if not elapsed.size:
            if len(rows) <= FIRST_STEPS:
                return inf
            base, first = size[: FIRST_STEPS + 1].max(), abs(rows["t"][FIRST_STEPS] - begin)
            rows, size = rows[FIRST_STEPS + 1 :], size[FIRST_STEPS + 1 :]
        if len(rows):
            elapsed, growth = np.abs(rows["t"] - begin), size - base
        is_chaotic = growth > POWER * np.log(elapsed / first)
        unpredictable = elapsed[is_chaotic & (growth >= allowed)]
        if unpredictable.size:
            return begin + direction * float(unpredictable[0])
    if not elapsed.size or not is_chaotic[-1]:
        return inf
    after = float(allowed / growth[-1] * elapsed[-1])
    return inf if after >= abs(end - begin) else begin + direction * after


def _log_size(problem: Problem, t: Array, y: Array) -> Array:
    """Logarithms of the sizes of perturbations, of which states in rows are the second half."""
    module, state = problem.form.module, y.shape[1] // 2
    n = state // 2
    change = y[:, state : state + n].T
    masses = np.asarray(module.mass_matrix_many(t, y[:, :state].T, problem.form.params))
    with np.errstate(all="ignore"):
        return np.asarray(np.log((change * (masses * change).sum(axis=1)).sum(axis=0)) / 2)
