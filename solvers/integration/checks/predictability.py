"""How long a trajectory is predictable: in chaos, errors grow to the size of the motion."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import replace
from math import inf

import numpy as np

from solvers.equations.module import GeneratedModule, has_function
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.compiled.kernel import Batch
from solvers.integration.compiled.memory_layout import STATUSES
from solvers.integration.loops.compiled_loop import compile_ahead, loop, obstacle
from solvers.integration.loops.singular_passage import rerun
from solvers.integration.problem.problem import Options, Problem
from solvers.integration.problem.status import Status
from solvers.runge_kutta.method_catalogue import load
from solvers.runge_kutta.stepper import Array

#: Method and tolerance for linear perturbations, most steps, and steps per call.
METHOD, TOLERANCE, MOST_STEPS, CHUNK = "verner853", 1e-9, 20_000, 500
#: In the first steps every change grows, at once where a mode is fast.
FIRST_STEPS = 10
#: Natural logarithm of the growth after which the error of the run is measured.
GROWN = 3.0
#: How much finer tolerances are for that, the finest of them, and parts of a fixed step.
FINER, FINEST, PARTS = 1e3, 1e-14, 4
#: In regular motion changes grow in proportion to time; chaos outgrows this power of time.
POWER = 1.5


_IS_IGNORED = ContextVar("predictability is ignored", default=False)


class PredictabilityWarning(UserWarning):
    """A trajectory is longer than its errors allow."""


class UnfinishedWarning(PredictabilityWarning):
    """A motion did not reach the end of its time span."""


@contextmanager
def ignore_predictability() -> Iterator[None]:
    """Suppress `PredictabilityWarning`, of which others are kinds, in a ``with`` block.

    It holds for all threads.

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


def compile_perturbations(problem: Problem) -> None:
    """Start to compile the loop of `predictable_until`, while that of the motion is compiled."""
    module = problem.form.module
    if _has_perturbations(module) and not (is_ignored() or problem.has_varying_inputs):
        compile_ahead(module, "variational", METHOD)


def predictable_until(problem: Problem, end: float) -> float:
    """The time in s from which on usual errors are as large as the motion.

    The error of the run is measured where a linear perturbation of the initial state, by the
    variational equations, has grown by e^3, and faster than in regular motion: the same method
    runs with finer tolerances or steps. From there on the error grows as the perturbation does.
    The size of a perturbation is that of its coordinates in the metric of the mass matrix, which
    stays finite where coordinates are singular, as at the pole of a sphere. A perturbation that is
    not integrated to the end is extrapolated. The result is infinity if there is no such time
    before `end`, or if it is unknown: without a compiled loop.
    """
    begin, module = problem.span[0], problem.form.module
    if begin == end or not _has_perturbations(module):
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
    allowed, direction = inf, float(np.sign(end - begin))
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
        grown = np.flatnonzero(is_chaotic & (growth >= GROWN))
        if grown.size and allowed == inf:
            k = grown[0]
            error = _error_at(problem, begin + direction * float(elapsed[k]))
            if not error:  # as exactly at rest, where nothing grows
                return inf
            allowed = growth[k] - np.log(error)
        unpredictable = elapsed[is_chaotic & (growth >= allowed)]
        if unpredictable.size:
            return begin + direction * float(unpredictable[0])
    if not elapsed.size or not is_chaotic[-1] or allowed == inf:
        return inf
    after = float(allowed / growth[-1] * elapsed[-1])
    return inf if after >= abs(end - begin) else begin + direction * after


def _has_perturbations(module: GeneratedModule) -> bool:
    return "variational" in module.FORMS and has_function(module, "mass_matrix")


def _error_at(problem: Problem, t: float) -> float:
    """The error of a run at time `t`, at most 1: its difference from a finer one."""
    run = replace(problem, span=(problem.span[0], t), samples=np.array([t]), events=[])
    if run.h is None:
        finer = replace(run, rtol=max(run.rtol / FINER, FINEST), atol=run.atol / FINER)
    else:
        finer = replace(run, h=run.h / PARTS)
    ends = []
    for one in (run, replace(finer, max_steps=PARTS * run.max_steps)):
        outcome = rerun(one)
        if outcome.status is not Status.FINISHED:
            return 1.0
        ends.append(outcome.end[1][: len(problem.form.module.STATE)])
    return min(float(np.abs(ends[0] - ends[1]).max()), 1.0)


def _log_size(problem: Problem, t: Array, y: Array) -> Array:
    """Logarithms of the sizes of perturbations, of which states in rows are the second half."""
    module, state = problem.form.module, y.shape[1] // 2
    n = state // 2
    change = y[:, state : state + n].T
    masses = np.asarray(module.mass_matrix_many(t, y[:, :state].T, problem.form.constants))
    with np.errstate(all="ignore"):
        return np.asarray(np.log((change * (masses * change).sum(axis=1)).sum(axis=0)) / 2)
