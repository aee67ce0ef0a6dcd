"""Whether fixed steps are short enough: growth of small deviations by the stability function."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import has_function
from solvers.integration.problem import Problem
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.runge_kutta.tableau import Tableau

Array = NDArray[np.float64]

#: Deviations may be multiplied by so much over a run, and a run is called unstable from here on.
TOLERABLE, UNSTABLE = 10.0, 1e3


def step_instability(problem: Problem, failed: bool) -> str:
    """What is wrong with the step of a run, with the last good time and the longest good step.

    Empty if nothing is, if steps are controlled, or if the module has no Jacobian. The
    modes are those of the equations linearised where the run begins; modes that grow by
    themselves are left out. A run that failed is blamed on less growth than another.

    Parameters
    ----------
    problem : Problem
        What was run.
    failed : bool
        Whether it came upon numbers that are not finite.

    Returns
    -------
    str
        A sentence without a full stop, with times and steps in s.
    """
    method, h, module = problem.method, problem.h, problem.form.module
    if h is None or not isinstance(method, Tableau) or not has_function(module, "jacobian"):
        return ""
    begin, end = problem.span
    duration = abs(end - begin)
    try:
        jacobian = np.array(
            module.jacobian(begin, problem.start[: len(module.STATE)], problem.form.params)
        )
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
    longest = _longest(function, rates, h, duration)
    return (
        f"h = {h} multiplies small deviations by ten in {np.log(10) * duration / growth:.3g} s: "
        f"good up to t = {until:.6g}; over this time span h may be at most {longest:.3g}"
    )


def _growth(function: StabilityFunction, rates: NDArray[np.complex128], h: float) -> float:
    """The largest exponent, a second, with which a step of h lets a mode grow."""
    return float(np.log(np.max(np.abs(function(h * rates)), initial=1.0)) / h)


def _longest(
    function: StabilityFunction, rates: NDArray[np.complex128], h: float, duration: float
) -> float:  # fmt: skip
    """The longest step below h that keeps deviations tolerable."""
    short, long = 0.0, h
    for _ in range(60):
        middle = (short + long) / 2
        tolerable = _growth(function, rates, middle) * duration <= np.log(TOLERABLE)
        short, long = (middle, long) if tolerable else (short, middle)
    return short
