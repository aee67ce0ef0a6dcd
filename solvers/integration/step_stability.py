"""The stability of fixed steps: growth of small deviations by the stability function."""

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import has_function
from solvers.integration.problem import Problem
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.runge_kutta.tableau import Tableau

#: Growth of deviations over a run that is tolerable, and from which on a run is unstable.
TOLERABLE, UNSTABLE = 10.0, 1e3


def step_instability(problem: Problem, failed: bool) -> str:
    """A description of the instability of a run with fixed steps; empty if there is none.

    It gives the time until which the run is good, and the largest stable step size. The modes are
    those of the equations linearised at the start, except those that grow by themselves. For a run
    that `failed`, with numbers that are not finite, less growth suffices. The text is empty, too,
    if steps are controlled, or if the module has no Jacobian.
    """
    method, h, module = problem.method, problem.h, problem.form.module
    if h is None or not isinstance(method, Tableau) or not has_function(module, "jacobian"):
        return ""
    begin, end = problem.span
    duration, state = abs(end - begin), problem.start[: len(module.STATE)]
    try:
        jacobian = np.array(module.jacobian(begin, state, problem.form.params))
    except ArithmeticError:
        return ""
    if not np.isfinite(jacobian).all():
        return ""
    modes = np.linalg.eigvals(np.sign(end - begin) * jacobian)
    rates = modes[modes.real <= 1e-6 * np.abs(modes)]
    function = StabilityFunction.of(method)
    growth = _growth(function, rates, h) * duration
    if growth <= np.log(TOLERABLE if failed else UNSTABLE):
        return ""
    until = begin + (end - begin) * np.log(TOLERABLE) / growth
    stable, unstable = 0.0, h
    for _ in range(60):
        middle = (stable + unstable) / 2
        tolerable = _growth(function, rates, middle) * duration <= np.log(TOLERABLE)
        stable, unstable = (middle, unstable) if tolerable else (stable, middle)
    return (
        f"h = {h} multiplies small deviations by ten in {np.log(10) * duration / growth:.3g} s: "
        f"good up to t = {until:.6g}; over this time span h may be at most {stable:.3g}"
    )


def _growth(function: StabilityFunction, rates: NDArray[np.complex128], h: float) -> float:
    """The largest growth rate of a mode, in 1/s, with steps of size h."""
    return float(np.log(np.max(np.abs(function(h * rates)), initial=1.0)) / h)
