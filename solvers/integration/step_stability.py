"""The stability of fixed steps: growth of small deviations by the stability function."""

import numpy as np
from numpy.typing import NDArray

from solvers.equations.equilibrium import equilibrium_state
from solvers.equations.module import has_function
from solvers.integration.energy_change import changed_energy, conserves_energy
from solvers.integration.problem import Outcome, Problem
from solvers.integration.solution import Array, Status
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.runge_kutta.tableau import Tableau

#: Growth of deviations over a run that is tolerable, and from which on a run is unstable.
TOLERABLE, UNSTABLE = 10.0, 1e3


def step_instability(problem: Problem, outcome: Outcome) -> str:
    """A description of the instability of a run with fixed steps; empty if there is none.

    It gives the time until which the run is good, and the largest stable step size. The modes are
    those of the equations linearised at the start, except those that grow by themselves. For a run
    that failed, with numbers that are not finite or a thousand times its energy, less growth
    suffices, and modes at the equilibrium count, too. The text is empty, too, if steps are
    controlled, or if the module has no Jacobian.
    """
    method, h, module = problem.method, problem.h, problem.form.module
    if h is None or not isinstance(method, Tableau) or not has_function(module, "jacobian"):
        return ""
    (begin, end), failed = problem.span, _has_failed(problem, outcome)
    duration = abs(end - begin)
    places = [problem.start[: len(module.STATE)]]
    if failed and (rest := equilibrium_state(module, problem.form.params)) is not None:
        places.append(rest)
    rates = np.concatenate([_rates(problem, place) for place in places])
    function = StabilityFunction.of(method)
    growth = _growth(function, rates, h) * duration
    if growth <= np.log(TOLERABLE if failed else UNSTABLE):
        return ""
    good = duration * np.log(TOLERABLE) / growth
    if failed:
        good = min(good, abs(_last_good_time(problem, outcome) - begin))
    until = begin + float(np.sign(end - begin)) * good
    stable, unstable = 0.0, h
    for _ in range(60):
        middle = (stable + unstable) / 2
        tolerable = _growth(function, rates, middle) * duration <= np.log(TOLERABLE)
        stable, unstable = (middle, unstable) if tolerable else (stable, middle)
    return (
        f"h = {h} multiplies small deviations by ten in {np.log(10) * duration / growth:.3g} s: "
        f"good up to t = {until:.6g}; over this time span h may be at most {stable:.3g}"
    )


def _has_failed(problem: Problem, outcome: Outcome) -> bool:
    """Whether a run ended with numbers that are not finite, or a thousand times its energy."""
    if outcome.status is Status.NOT_FINITE:
        return True
    if outcome.status is not Status.FINISHED or not conserves_energy(problem.form.module):
        return False
    start, end = problem.start[:, np.newaxis], outcome.end[1][:, np.newaxis]
    return bool(changed_energy(problem.form, start, end, UNSTABLE)[2][0])


def _last_good_time(problem: Problem, outcome: Outcome) -> float:
    """The last recorded time before the energy has changed, or the last step's end."""
    t, y = outcome.rows()
    if not conserves_energy(problem.form.module):
        return outcome.end[0]
    has_changed = changed_energy(problem.form, problem.start[:, np.newaxis], y.T)[2]
    good = t[: int(np.argmax(has_changed)) if has_changed.any() else len(t)]
    return float(good[-1]) if len(good) else problem.span[0]


def _rates(problem: Problem, state: Array) -> NDArray[np.complex128]:
    """Rates of the modes in 1/s at a state, without those that grow; none if they are unknown."""
    begin, end = problem.span
    try:
        jacobian = np.array(problem.form.module.jacobian(begin, state, problem.form.params))
    except ArithmeticError:
        return np.empty(0, complex)
    if not np.isfinite(jacobian).all():
        return np.empty(0, complex)
    modes = np.linalg.eigvals(np.sign(end - begin) * jacobian).astype(complex)
    return np.asarray(modes[modes.real <= 1e-6 * np.abs(modes)])


def _growth(function: StabilityFunction, rates: NDArray[np.complex128], h: float) -> float:
    """The largest growth rate of a mode, in 1/s, with steps of size h."""
    return float(np.log(np.max(np.abs(function(h * rates)), initial=1.0)) / h)
