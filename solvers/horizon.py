"""How long a trajectory means anything: in chaos, errors grow until they are as large as it."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np

from solvers.catalogue import load
from solvers.compiled import obstacle
from solvers.compiler import NoCompilerError
from solvers.forms import Form, fastest_form
from solvers.kernel import Batch, kernel
from solvers.problem import Problem

#: How far the companion begins from the motion, when both count as apart, and how often to look.
NEAR, APART, LOOKS = 1e-8, 1e-3, 64
#: What the companions run with, and how far they are followed.
METHOD, MOST_STEPS = "verner87", 20_000


class HorizonWarning(UserWarning):
    """A trajectory is longer than its errors allow."""


def horizon(problem: Problem) -> float:
    """The time from which on the errors that are allowed have grown as large as the motion.

    It is begin + ln(1/tolerance)/λ, where λ is the rate at which a companion leaves the
    motion. Infinity if that is beyond the run, or not known: for fixed steps, and
    without a compiled loop.
    """
    begin, end = problem.span
    module, form = problem.form.module, fastest_form(problem.form.module)
    if problem.h is not None or begin == end:
        return inf
    companions = replace(
        problem,
        form=Form(module, form, problem.form.params),
        method=load(METHOD),
        rtol=NEAR / 100,
        atol=np.array(NEAR / 100),
        samples=begin + (end - begin) * np.logspace(-3, 0, LOOKS),
        events=[],
        max_steps=MOST_STEPS,
    )
    if obstacle(companions):
        return inf
    try:
        program = kernel(module, form, METHOD, lanes=False, compensated=False, reproducible=False)
    except NoCompilerError:
        return inf
    start = problem.start[: len(module.STATE)]
    near = start + NEAR * (1 + np.abs(start))
    batch = Batch(
        program, companions, companions.form, np.array([start, near]),
        capacity=LOOKS, occurrences=0, pauses=False,
    )  # fmt: skip
    batch.restart()
    batch.go()
    seen = int(batch.motions["rows"].min())
    if not seen:
        return inf
    motion, companion = (batch.form.outside_many(r["z"], r["turns"])[:seen] for r in batch.rows)
    distance = np.abs(companion - motion).max(axis=1)
    apart = np.flatnonzero(distance > APART)
    k = int(apart[0]) if apart.size else seen - 1
    elapsed = abs(batch.rows["t"][0, k] - begin)
    growth = np.log(max(distance[k], NEAR) / np.abs(near - start).max())
    allowed = max(problem.tolerance, np.finfo(float).eps)
    if growth <= 0 or np.log(1 / allowed) * elapsed / growth >= abs(end - begin):
        return inf
    return float(begin + np.sign(end - begin) * np.log(1 / allowed) * elapsed / growth)
