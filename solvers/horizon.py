"""How long a trajectory means anything: in chaos, errors grow until they are as large as it."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np

from solvers.catalogue import load
from solvers.compiled import obstacle
from solvers.compiler import NoCompilerError
from solvers.forms import Form
from solvers.kernel import Batch, kernel
from solvers.problem import Problem

#: What a small change of the start is integrated with, and how far.
METHOD, TOLERANCE, MOST_STEPS = "verner87", 1e-9, 20_000
#: Parts of the run: its beginning, in which every change grows somehow, and where to look.
BEGINNING = 0.01
LOOKS = np.concatenate([np.linspace(0, BEGINNING, 17)[1:], np.linspace(BEGINNING, 1, 100)[1:]])


class HorizonWarning(UserWarning):
    """A trajectory is longer than its errors allow."""


def horizon(problem: Problem) -> float:
    """The time from which on the errors that are allowed have grown as large as the motion.

    That is when a small change of the start, by the variational equations, has grown by
    1/tolerance since the beginning of the run, and beyond a growth in proportion to time,
    which happens in regular motion, too. Infinity if that is beyond the run, or not
    known: for fixed steps, and without a compiled loop.
    """
    begin, end = problem.span
    module = problem.form.module
    if problem.h is not None or begin == end or not hasattr(module, "rhs_variational"):
        return inf
    start = problem.start[: len(module.STATE)]
    variational = replace(
        problem,
        form=Form(module, "variational", problem.form.params),
        method=load(METHOD),
        rtol=TOLERANCE,
        atol=np.array(TOLERANCE),
        samples=begin + (end - begin) * LOOKS,
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
        capacity=len(LOOKS), occurrences=0, pauses=False,
    )  # fmt: skip
    batch.restart()
    batch.go()
    seen = int(batch.motions["rows"][0])
    change = batch.rows["z"][0, :seen, -len(start) :]
    early = LOOKS[:seen] <= BEGINNING
    if early.all():
        return inf
    size = np.log(np.abs(change).max(axis=1))
    growth = size - size[early].max() - np.log(LOOKS[:seen] / BEGINNING)
    growth[early] = 0.0
    allowed = np.log(1 / max(problem.tolerance, np.finfo(float).eps))
    grown = np.flatnonzero(growth >= allowed)
    # a change that is not followed to the end of the run goes on as before
    part = LOOKS[grown[0]] if grown.size else LOOKS[seen - 1] * allowed / max(growth[-1], 1e-9)
    return inf if part >= 1 else begin + float(part) * (end - begin)
