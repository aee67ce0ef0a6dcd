"""How long a trajectory is predictable: in chaos, errors grow to the size of the motion."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from math import inf

import numpy as np

from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.compiled.kernel import Batch
from solvers.integration.compiled.layout import STATUSES
from solvers.integration.compiled_loop import loop, obstacle
from solvers.integration.problem import Options, Problem
from solvers.runge_kutta.catalogue import load

#: Method and tolerance for linear perturbations, most steps, and steps per call.
METHOD, TOLERANCE, MOST_STEPS, CHUNK = "verner87", 1e-9, 20_000, 500
#: In the first steps every change grows, at once where a mode is fast.
FIRST_STEPS = 10
#: The usual ratio of an error to the tolerance.
ERROR_RATIO = 10.0
#: The largest initial error, whatever the tolerance, whose growth to 1 counts.
LARGEST_ERROR = 0.05
#: In regular motion changes grow in proportion to time; chaos outgrows this power of time.
POWER = 1.5


class PredictabilityWarning(UserWarning):
    """A trajectory is longer than its errors allow."""


@contextmanager
def ignore_predictability() -> Iterator[None]:
    """Suppress `PredictabilityWarning` in a ``with`` block, for all threads.

    Yields
    ------
    None
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PredictabilityWarning)
        yield


def predictable_until(problem: Problem, end: float) -> float:
    """The time in s from which on usual errors are as large as the motion.

    There a linear perturbation of the initial state, by the variational equations, has grown by
    1/(10 tolerances) since the first few steps, and faster than in regular motion. A change that
    is not integrated to the end is extrapolated. The result is infinity if there is no such time
    before `end`, or if it is unknown: for fixed steps, and without a compiled loop.
    """
    begin, module = problem.span[0], problem.form.module
    if problem.h is not None or begin == end or "variational" not in module.FORMS:
        return inf
    variational = replace(
        problem.with_form("variational"),
        method=load(METHOD),
        span=(begin, end),
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
    error = min(ERROR_RATIO * max(problem.tolerance, np.finfo(float).eps), LARGEST_ERROR)
    allowed, direction = np.log(1 / error), float(np.sign(end - begin))
    base, elapsed, growth = 0.0, np.empty(0), np.empty(0)
    status = None
    while status is None:
        batch.restart()
        batch.run()
        status = STATUSES[batch.motions["status"][0]]
        rows = batch.rows[0, : batch.motions["rows"][0]]
        batch.motions["rows"] = 0
        size = np.log(np.abs(rows["z"][:, -len(start) :]).max(axis=1))
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
