"""An estimate of the global error: the difference from a tighter run by another method."""

from dataclasses import replace

import numpy as np

from solvers.equations.forms import fastest_form
from solvers.equations.module import has_perturbation
from solvers.integration.loops import compiled_loop, singular_passage
from solvers.integration.problem.problem import Problem
from solvers.integration.results.recorder import Outcome
from solvers.runge_kutta.method_catalogue import load
from solvers.runge_kutta.stepper import Array

#: Methods of the comparison, how much tighter its tolerances are, and the tightest.
METHODS, TIGHTER, TIGHTEST = ("verner98", "dop853"), 100.0, 1e-14


def global_error_estimate(problem: Problem, t: Array, y: Array) -> Array:
    """Estimated errors of the states `y`, shape (state, n), at times `t` of a run of `problem`.

    They are differences from another method in another form, where there is one, so that few
    roundings are common to both; NaN where that run does not arrive.
    """
    method = next(name for name in METHODS if name != problem.options.method)
    module, form = problem.form.module, problem.form.name
    if not has_perturbation(form) and not problem.form.feedback:
        form = fastest_form(module) if form == "lagrangian" else "lagrangian"
    rtol, atol = TIGHTEST, TIGHTEST
    if problem.h is None:
        rtol, atol = max(problem.rtol / TIGHTER, TIGHTEST), float(problem.atol.min()) / TIGHTER
    options = replace(problem.options, method=method, form=form, compensated=False)
    tighter = replace(
        problem.with_form(form),
        method=load(method),
        h=None,
        rtol=rtol,
        atol=np.array(atol),
        samples=t,
        events=[],
        max_steps=100 * problem.max_steps,
        options=options,
    )
    tighter, program = compiled_loop.select(tighter, lanes=False)
    outcome = Outcome.at_start(tighter)
    singular_passage.run(tighter, outcome, program)
    states, result = outcome.rows()[1], np.full_like(y, np.nan)
    result[:, : len(states)] = np.abs(y[:, : len(states)] - states.T)
    return result
