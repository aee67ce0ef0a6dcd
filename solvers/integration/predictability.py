"""How long a trajectory means anything: in chaos, errors grow until they are as large as it."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from math import inf

import numpy as np

from solvers.equations.forms import Form
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.compiled.kernel import Batch, kernel
from solvers.integration.compiled.layout import STATUSES
from solvers.integration.compiled_loop import obstacle
from solvers.integration.problem import Problem
from solvers.runge_kutta.catalogue import load

#: What a small change of the start is integrated with, and for how many steps, so many at a time.
METHOD, TOLERANCE, MOST_STEPS, CHUNK = "verner87", 1e-9, 20_000, 500
#: In so many steps every change grows somehow, at once where a mode is fast.
BEGINNING = 10
#: Errors are this many times the tolerance, usually.
USUAL = 10.0
#: Even for large tolerances a change must grow from this to 1 before growth means anything.
LARGE = 0.05
#: In regular motion changes grow in proportion to time; chaos is what outgrows this power of it.
POWER = 1.5


class PredictabilityWarning(UserWarning):
    """A trajectory is longer than its errors allow."""


@contextmanager
def ignore_predictability() -> Iterator[None]:
    """Where runs are meant to be longer than their errors allow: no warning.

    Yields
    ------
    None
        In a ``with`` block, within which `PredictabilityWarning` is not shown.

    Notes
    -----
    Python keeps one list of warnings to be shown for all threads: others, too, do not warn
    meanwhile.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PredictabilityWarning)
        yield


def predictable_until(problem: Problem, end: float) -> float:
    """The time before `end` from which on usual errors have grown as large as the motion.

    That is when a small change of the start, by the variational equations, has grown by
    1/(10 tolerances) since the first few steps, and by more than regular motion lets it.
    A change that is not followed to the end of the run goes on as before. Infinity if
    there is no such time, or it is not known: for fixed steps, and without a compiled
    loop.

    Parameters
    ----------
    problem : Problem
        What was integrated.
    end : float
        When its integration ended, in s.

    Returns
    -------
    float
        In s, as times of the problem are counted.
    """
    begin = problem.span[0]
    module = problem.form.module
    if problem.h is not None or begin == end or "variational" not in module.FORMS:
        return inf
    start = problem.start[: len(module.STATE)]
    variational = replace(
        problem,
        form=Form(module, "variational", problem.form.params),
        method=load(METHOD),
        span=(begin, end),
        rtol=TOLERANCE,
        atol=np.array(TOLERANCE),
        samples=None,
        events=[],
        max_steps=MOST_STEPS,
    )
    if obstacle(variational):
        return inf
    try:
        program = kernel(
            module, "variational", METHOD, lanes=False, compensated=False, reproducible=False
        )
    except NoCompilerError:
        return inf
    batch = Batch(
        program, variational, variational.form, np.array([[*start, *np.ones_like(start)]]),
        capacity=CHUNK, occurrences=0, pauses=True,
    )  # fmt: skip
    allowed = np.log(1 / min(USUAL * max(problem.tolerance, np.finfo(float).eps), LARGE))
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
            if len(rows) <= BEGINNING:
                return inf
            base, first = size[: BEGINNING + 1].max(), abs(rows["t"][BEGINNING] - begin)
            rows, size = rows[BEGINNING + 1 :], size[BEGINNING + 1 :]
        if len(rows):
            elapsed, growth = np.abs(rows["t"] - begin), size - base
        lost = np.flatnonzero((growth >= allowed) & (growth > POWER * np.log(elapsed / first)))
        if lost.size:
            return begin + float(np.sign(end - begin) * elapsed[lost[0]])
    if not elapsed.size or growth[-1] <= POWER * np.log(elapsed[-1] / first):
        return inf
    after = float(allowed / growth[-1] * elapsed[-1])
    return inf if after >= abs(end - begin) else begin + float(np.sign(end - begin)) * after
