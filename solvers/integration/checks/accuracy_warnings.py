"""Warnings about results that reached their end, and are wrong or meaningless there."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solvers.equations.energy import conserves_energy, coupling, equilibrium_state
from solvers.equations.forms import Form
from solvers.equations.singularities import examined
from solvers.integration.checks.predictability import (
    PredictabilityWarning,
    is_ignored,
    predictable_until,
)
from solvers.integration.problem.problem import Problem
from solvers.runge_kutta.stepper import Array
from solvers.runge_kutta.tableau import Tableau

#: Part of the motion's energy, and number of steps, from which on its change is a drift that calls
#: for another method. Errors of a symplectic method do not add up, and shorter steps that reduce a
#: thousandth cost little in runs of fewer steps.
VISIBLE, LONG = 1e-3, 1000
#: The tolerable change, in units of the motion's energy. In 10,000 runs of twelve systems every
#: larger change had errors above a tenth of the motion, and errors below 0.3 only at tolerances
#: of 0.1.
TOLERABLE = 1.0


class EnergyWarning(PredictabilityWarning):
    """The energy of a motion that conserves it has changed by more than itself."""


class DriftWarning(PredictabilityWarning):
    """The energy of a long motion drifts, as it does not by a symplectic method."""


def energies(form: Form, y: Array) -> Array:
    """Energies in J of ordinary states in columns."""
    with np.errstate(all="ignore"):
        return np.asarray(form.module.energy_many(0.0, y[: len(form.module.STATE)], form.constants))


def motion_energy(form: Form, start: Array) -> Array:
    """The energy in J that motions from states in columns have: what a large change is.

    The largest of kinetic energy, potential energy, and energy above that of the equilibrium,
    where one is known.
    """
    n = len(form.module.COORDINATES)
    own, at_rest = energies(form, start), start.copy()
    at_rest[n:] = 0.0
    potential = energies(form, at_rest)
    rest = equilibrium_state(form.module, form.constants)
    above = own - (np.nan if rest is None else energies(form, rest))
    parts = [np.abs(part) for part in np.broadcast_arrays(own - potential, potential, above)]
    return np.asarray(np.fmax.reduce(parts))


def changed_energy(
    form: Form, start: Array, end: Array, tolerable: float = TOLERABLE
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Energies in J of start and end, states in columns, and whether they differ intolerably.

    A `tolerable` change is given in units of the motion's energy.
    """
    before, after = energies(form, start), energies(form, end)
    with np.errstate(all="ignore"):
        is_tolerable = np.abs(after - before) <= tolerable * motion_energy(form, start)
    return before, after, ~is_tolerable


#: The methods that are suggested for long motions: of separable systems, and of others.
SPLITTING, GAUSS = "leapfrog4", "gauss4"


def accuracy_warnings(problem: Problem, t: float, y: Array) -> Iterator[PredictabilityWarning]:
    """Warnings about the motion that ended at time `t` in s with the ordinary state `y`."""
    if is_ignored():
        return
    if conserves_energy(problem.form.module):
        ends = problem.start[:, np.newaxis], y[:, np.newaxis]
        energies = changed_energy(problem.form, *ends)
        before, after, has_changed = (float(values[0]) for values in energies)
        if has_changed:
            yield EnergyWarning(
                f"the energy of this motion, which is constant, changed from {before:.4g} to "
                f"{after:.4g} J: its end is meaningless; {_remedy(problem)}"
            )
            return
        if _drifts(problem, t) and changed_energy(problem.form, *ends, VISIBLE)[2][0]:
            yield DriftWarning(
                f"the energy of this motion, which is constant, drifted from {before:.6g} to "
                f"{after:.6g} J: {_symplectic(problem)}"
            )
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
        drifted = changed_energy(form, starts.T, y.T, VISIBLE)[2] & _drifts(problem, t)
        if drifted.any():
            k = int(np.argmax(drifted))
            yield DriftWarning(
                f"the energy of {int(drifted.sum())} of {n} motions, which is constant, drifted, "
                f"as from {before[k]:.6g} to {after[k]:.6g} J: {_symplectic(problem)}"
            )
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


def _drifts(problem: Problem, t: ArrayLike) -> NDArray[np.bool_]:
    """Whether energies change in proportion to the time `t` in s: by many equal, explicit steps."""
    h, method = problem.h, problem.method
    if (
        h is None
        or not isinstance(method, Tableau)
        or not method.is_explicit
        or method.is_splitting
    ):
        return np.zeros(np.shape(t), bool)
    return np.asarray(np.abs(np.asarray(t) - problem.span[0]) >= LONG * h)


def _symplectic(problem: Problem) -> str:
    """The method that keeps the energy with the same steps."""
    module, method = problem.form.module, f"method = {SPLITTING!r}"
    if coupling(module):
        has_momenta = "hamiltonian" in module.FORMS
        method = f"method = {GAUSS!r}" + ", form = 'hamiltonian'" * has_momenta
    return (
        f"{problem.options.method!r} is not symplectic, and errors of its steps add up; use "
        f"{method} with a fixed step, whose errors of the energy do not"
    )
