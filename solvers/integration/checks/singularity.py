"""Motions that fail where their coordinates are singular, as an orientation at gimbal lock."""

import numpy as np

from solvers.equations.singularities.singular_coordinates import State, singular_coordinates
from solvers.integration.problem.problem import Problem
from solvers.integration.problem.status import Status
from solvers.integration.results.ensemble_solution import Ensemble
from solvers.runge_kutta.stepper import Array

#: Ends of motions that run into a singularity.
FAILURES = (Status.NOT_FINITE, Status.STEP_TOO_SMALL, Status.STEP_LIMIT, Status.NO_CONVERGENCE)


class SingularityWarning(UserWarning):
    """Motions of an ensemble end where their coordinates are singular."""


def singularity(problem: Problem, status: Status | None, end: State) -> str:
    """A description of the singular coordinates at which a run ended; empty elsewhere."""
    if status not in FAILURES:
        return ""
    form, start = problem.form, (problem.span[0], problem.start)
    return singular_coordinates(form.module, form.constants, start, end)


def singularities(problem: Problem, states: Array, params: Array, result: Ensemble) -> str:
    """A description of the first motion, by rows of states and parameters, that ended so."""
    failed = np.logical_or.reduce([result.status == status for status in FAILURES])
    for k in np.flatnonzero(failed).tolist():
        end = float(result.t[k]), result.y[:, k]
        if detail := singularity(problem.motion(k, states, params), result.status[k], end):
            return f"{np.sum(failed)} of {len(states)} motions failed; of motion {k}: {detail}"
    return ""
