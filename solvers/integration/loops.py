"""The loop that integrates one motion: compiled, in Python, or SciPy's."""

from __future__ import annotations

from solvers.integration import compiled_loop, python_loop, scipy_loop
from solvers.integration.compiled.kernel import Kernel
from solvers.integration.problem import Outcome, Problem
from solvers.runge_kutta.tableau import Tableau


def run(problem: Problem, outcome: Outcome, program: Kernel | None = None) -> None:
    """Integrate `problem`, by the compiled loop `program` if given."""
    if program:
        compiled_loop.run(problem, outcome, program)
    elif isinstance(problem.method, Tableau):
        python_loop.run(problem, outcome)
    else:
        scipy_loop.run(problem, outcome)
