"""The stability of fixed steps: growth of small deviations by the stability function."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from solvers.equations.energy import conserves_energy, equilibrium_state
from solvers.equations.module import has_function
from solvers.integration.checks.accuracy_warnings import changed_energy
from solvers.integration.checks.predictability import PredictabilityWarning
from solvers.integration.loops.singular_passage import rerun
from solvers.integration.problem.problem import Problem
from solvers.integration.problem.status import Status
from solvers.integration.results.ensemble_solution import Ensemble
from solvers.integration.results.recorder import Outcome
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.runge_kutta.stepper import Array
from solvers.runge_kutta.tableau import Tableau

#: Growth of deviations over a run that is tolerable, and from which on a run is unstable.
TOLERABLE, UNSTABLE = 10.0, 1e3
#: Most steps of a run that tries a shorter step size.
MOST_STEPS = 10_000
#: Number of times at which the states of an unstable motion are examined.
EXAMINED = 1001
#: Ends of runs with results up to there, whatever they are worth.
ENDS = (Status.FINISHED, Status.EVENT, Status.STEP_LIMIT)


class StepWarning(PredictabilityWarning):
    """A fixed step size is too long for some motions of an ensemble."""


def step_instability(problem: Problem, outcome: Outcome) -> str:
    """A description of the instability of a run with fixed steps; empty if there is none.

    It gives the time until which the run is good, and the largest stable step size. The modes are
    those of the equations linearised at the start, except those that grow by themselves. For a run
    that failed, with numbers that are not finite or a thousand times its energy, less growth
    suffices, and modes at the equilibrium count, too. Where none grows, the step is too long for
    the motion if the energy has changed before.
    """
    h, (begin, end) = problem.h, problem.span
    if h is None or not isinstance(problem.method, Tableau):
        return ""
    failed, duration = _has_failed(problem, outcome), abs(end - begin)
    function = StabilityFunction.of(problem.method)
    rates = _rates_at_start(problem, with_equilibrium=failed)
    growth = _growth(function, rates, h) * duration
    grows = growth > np.log(TOLERABLE if failed else UNSTABLE)
    if not grows and not (failed and _has_other_energy(problem, outcome)):
        return ""
    good, cause, limit, stable = duration, f"h = {h} is too long for this motion", "", h
    if grows:
        good = duration * np.log(TOLERABLE) / growth
        cause = f"h = {h} multiplies small deviations by ten in {good:.3g} s"
        stable = _largest_step(function, rates, h, duration)
        limit = f"; over this time span h may be at most {stable:.3g}"
    if failed:
        good = min(good, abs(_last_good_time(problem, outcome) - begin))
        if sufficient := _sufficient_step(problem, stable):
            limit += f"; the motion reaches its end with h = {sufficient:.3g}"
    until = begin + float(np.sign(end - begin)) * good
    return f"{cause}: good up to t = {until:.6g}{limit}"


def _has_other_energy(problem: Problem, outcome: Outcome, factor: float = 1.0) -> bool:
    """Whether an energy that is constant changed by more than `factor` times itself."""
    if not conserves_energy(problem.form.module):
        return False
    start, end = problem.start[:, np.newaxis], outcome.end[1][:, np.newaxis]
    return bool(changed_energy(problem.form, start, end, factor)[2][0])


def _has_failed(problem: Problem, outcome: Outcome) -> bool:
    """Whether a run ended with numbers that are not finite, or a thousand times its energy."""
    if outcome.status is Status.NOT_FINITE:
        return True
    return outcome.status in ENDS and _has_other_energy(problem, outcome, UNSTABLE)


def _last_good_time(problem: Problem, outcome: Outcome) -> float:
    """The last recorded time before the energy has changed, or the last step's end."""
    if not conserves_energy(problem.form.module):
        return outcome.end[0]
    has_changed = _has_changed(problem, outcome)
    good = outcome.rows()[0][: int(np.argmax(has_changed)) if has_changed.any() else None]
    return float(good[-1]) if len(good) else problem.span[0]


def _has_changed(problem: Problem, outcome: Outcome) -> NDArray[np.bool_]:
    """Whether an energy that is constant has changed, at each recorded time."""
    states = outcome.rows()[1].T
    if not conserves_energy(problem.form.module):
        return np.zeros(states.shape[1], bool)
    return changed_energy(problem.form, problem.start[:, np.newaxis], states)[2]


def _sufficient_step(problem: Problem, longest: float) -> float:
    """The first of the steps h/2, h/4, … that, and whose half, keeps the energy; 0 if unknown."""
    begin, end = problem.span
    h, kept = _rounded(longest / 2), 0.0
    while abs(end - begin) / h <= MOST_STEPS:
        trial = replace(problem, h=h, samples=None, events=[], max_steps=MOST_STEPS + 1)
        outcome = rerun(trial)
        if outcome.status is not Status.FINISHED or _has_changed(trial, outcome).any():
            kept = 0.0
        elif kept:
            return kept
        else:
            kept = h
        h = _rounded(h / 2)
    return 0.0


def _rounded(h: float) -> float:
    """A step size with the digits of messages: a chaotic motion may end with no other."""
    return float(f"{h:.3g}")


def _rates_at_start(problem: Problem, *, with_equilibrium: bool) -> NDArray[np.complex128]:
    """Rates in 1/s of the modes at the start, and at the equilibrium where one is known."""
    module = problem.form.module
    if not has_function(module, "jacobian"):
        return np.empty(0, complex)
    states = [problem.start[: len(module.STATE)]]
    if with_equilibrium and (rest := equilibrium_state(module, problem.form.constants)) is not None:
        states.append(rest)
    return np.concatenate([_rates(problem, state) for state in states])


def _rates(problem: Problem, state: Array) -> NDArray[np.complex128]:
    """Rates of the modes in 1/s at a state, without those that grow; none if they are unknown."""
    begin, end = problem.span
    try:
        jacobian = np.array(problem.form.module.jacobian(begin, state, problem.form.constants))
    except ArithmeticError:
        return np.empty(0, complex)
    if not np.isfinite(jacobian).all():
        return np.empty(0, complex)
    modes = np.linalg.eigvals(np.sign(end - begin) * jacobian).astype(complex)
    return np.asarray(modes[modes.real <= 1e-6 * np.abs(modes)])


def _largest_step(
    function: StabilityFunction, rates: NDArray[np.complex128], h: float, duration: float
) -> float:
    """The largest step size below `h` with which deviations grow tolerably."""
    stable, unstable = 0.0, h
    for _ in range(60):
        middle = (stable + unstable) / 2
        tolerable = _growth(function, rates, middle) * duration <= np.log(TOLERABLE)
        stable, unstable = (middle, unstable) if tolerable else (stable, middle)
    return stable


def _growth(function: StabilityFunction, rates: NDArray[np.complex128], h: float) -> float:
    """The largest growth rate of a mode, in 1/s, with steps of size h."""
    return float(np.log(np.max(np.abs(function(h * rates)), initial=1.0)) / h)


def mark_unstable(problem: Problem, states: Array, params: Array, result: Ensemble) -> str:
    """Set the status of motions whose fixed steps are too long, and describe the first of them.

    Initial states and parameters are in rows. Where the energy is constant, its change is the
    evidence; elsewhere the growth of deviations from the start of a motion that is not finite.
    """
    h = problem.h
    if h is None or not isinstance(problem.method, Tableau):
        return ""
    function, duration = StabilityFunction.of(problem.method), abs(np.subtract(*problem.span))
    form, start = problem.with_params(list(params.T)).form, states.T
    not_finite = result.status == Status.NOT_FINITE
    if conserves_energy(form.module):
        unstable = not_finite & changed_energy(form, start, result.y)[2]
        has_ended = np.logical_or.reduce([result.status == end for end in ENDS])
        unstable |= has_ended & changed_energy(form, start, result.y, UNSTABLE)[2]
    else:
        unstable = np.zeros(len(states), bool)
        for k in np.flatnonzero(not_finite).tolist():
            own = problem.motion(k, states, params)
            rates = _rates_at_start(own, with_equilibrium=True)
            unstable[k] = _growth(function, rates, h) * duration > np.log(TOLERABLE)
    if not unstable.any():
        return ""
    result.status[unstable] = Status.UNSTABLE
    first = int(np.argmax(unstable))
    detail = diagnosis(problem.motion(first, states, params))
    return f"{unstable.sum()} of {len(states)} motions are unstable; of motion {first}, {detail}"


def diagnosis(problem: Problem) -> str:
    """The result of `step_instability` for a run whose states are not known: it is repeated."""
    if problem.h is None:
        return ""
    recorded = replace(problem, samples=np.linspace(*problem.span, EXAMINED), events=[])
    return step_instability(recorded, rerun(recorded))
