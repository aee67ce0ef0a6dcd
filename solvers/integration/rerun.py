"""Repetition of a run with other steps or tolerances."""

from contextlib import suppress

from solvers.integration import compiled_loop, passage
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.problem import Outcome, Problem


def rerun(problem: Problem) -> Outcome:
    """The outcome of a problem in its form, compiled if that is possible, without warnings."""
    outcome, program = Outcome.at_start(problem), None
    if problem.backend != "python" and not compiled_loop.obstacle(problem):
        with suppress(NoCompilerError):  # the first run has reported it
            program = compiled_loop.loop(problem)
    passage.run(problem, outcome, program)
    return outcome
