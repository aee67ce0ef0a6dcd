"""Repetition of a run with other steps or tolerances."""

from contextlib import suppress

from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.loops import compiled_loop, passage
from solvers.integration.problem.problem import Problem
from solvers.integration.results.outcome import Outcome


def rerun(problem: Problem) -> Outcome:
    """The outcome of a problem in its form, compiled if that is possible, without warnings."""
    outcome, program = Outcome.at_start(problem), None
    if problem.backend != "python" and not compiled_loop.obstacle(problem):
        with suppress(NoCompilerError):  # the first run has reported it
            program = compiled_loop.loop(problem)
    passage.run(problem, outcome, program)
    return outcome
