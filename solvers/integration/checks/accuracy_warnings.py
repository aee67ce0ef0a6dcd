"""Warnings about results that reached their end, and are wrong or meaningless there."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from solvers.equations.energy import conserves_energy
from solvers.equations.singularities.mass_matrix import examined
from solvers.integration.checks.energy_change import EnergyWarning, changed_energy
from solvers.integration.checks.predictability import (
    PredictabilityWarning,
    is_ignored,
    predictable_until,
)
from solvers.integration.problem.problem import Problem
from solvers.runge_kutta.stepper import Array


def accuracy_warnings(problem: Problem, t: float, y: Array) -> Iterator[PredictabilityWarning]:
    """Warnings about the motion that ended at time `t` in s with the ordinary state `y`."""
    if is_ignored():
        return
    if conserves_energy(problem.form.module):
        energies = changed_energy(problem.form, problem.start[:, np.newaxis], y[:, np.newaxis])
        before, after, has_changed = (float(values[0]) for values in energies)
        if has_changed:
            yield EnergyWarning(
                f"the energy of this motion, which is constant, changed from {before:.4g} to "
                f"{after:.4g} J: its end is meaningless; {_remedy(problem)}"
            )
            return
    if problem.has_varying_inputs:  # the variational equations have constant ones
        return
    begin, until = problem.span[0], predictable_until(problem, t)
    if abs(until - begin) < abs(t - begin):
        yield PredictabilityWarning(
            f"this trajectory is not predictable beyond t = {until:.4g}: its errors have grown to "
            f"its size there; {_remedy(problem)}, or use its energies and statistics only"
        )


def ensemble_warnings(
    problem: Problem, starts: Array, params: Array, t: Array, y: Array
) -> Iterator[PredictabilityWarning]:
    """Warnings about motions that ended at times `t` with states `y`, in rows as `starts`."""
    n = len(t)
    if is_ignored() or not n:
        return
    if conserves_energy(problem.form.module):
        form = problem.with_params(list(params.T)).form
        before, after, has_changed = changed_energy(form, starts.T, y.T)
        if has_changed.any():
            k = int(np.argmax(has_changed))
            yield EnergyWarning(
                f"the energy of {int(has_changed.sum())} of {n} motions, which is constant, "
                f"changed by more than itself, as from {before[k]:.4g} to {after[k]:.4g} J: their "
                f"ends are meaningless; {_remedy(problem)}"
            )
            return
    if problem.has_varying_inputs:
        return
    limits, some = [], examined(n)
    for k in some:
        own = problem.with_params(params[k % len(params)].tolist())
        motion = replace(own, start=starts[k])
        until = predictable_until(motion, float(t[k]))
        if abs(until - problem.span[0]) < abs(t[k] - problem.span[0]):
            limits.append(until)
    if limits:
        until = min(limits, key=lambda limit: abs(limit - problem.span[0]))
        yield PredictabilityWarning(
            f"{len(limits)} of {len(some)} examined motions are not predictable to their ends, "
            f"and one not beyond t = {until:.4g}: {_remedy(problem)}, or use statistics of the "
            "motions only"
        )


def _remedy(problem: Problem) -> str:
    return "reduce rtol and atol" if problem.h is None else f"reduce h = {problem.h}"
