"""The results of a run so far, which every loop fills."""

from dataclasses import dataclass, field

import numpy as np

from solvers.equations.number_checks import NotFiniteNumberError
from solvers.integration.problem.inputs import History
from solvers.integration.problem.problem import Problem
from solvers.integration.problem.status import Status
from solvers.runge_kutta.stepper import Array, NoConvergenceError


@dataclass
class Outcome:
    """The results of a run so far; times and states are stored in blocks, events as lists."""

    end: tuple[float, Array]  # time and ordinary state reached
    t_events: list[list[float]]
    y_events: list[list[Array]]
    t: list[Array] = field(default_factory=list)  # of shape (rows,)
    y: list[Array] = field(default_factory=list)  # of shape (rows, state)
    status: Status = Status.INTERRUPTED
    nfev: int = 0
    njev: int = 0
    steps: int = 0
    rejected: int = 0
    backend: str = "python"
    signs: tuple[float, ...] = ()  # of switching functions, 0 of those that stay 0
    recent: list[int] = field(default_factory=list)  # switches in succession in next to no time
    history: History = field(default_factory=History)  # of held inputs
    cause: NotFiniteNumberError | None = None  # the value of a user's function that ended it

    @classmethod
    def at_start(cls, problem: Problem) -> "Outcome":
        """The outcome before the first step."""
        switches = problem.form.switching_count  # whose signs are held from the first step on
        events = range(len(problem.events) + len(problem.limits) + switches)
        return cls((problem.span[0], problem.start), [[] for _ in events], [[] for _ in events])

    def fail(self, failure: BaseException) -> Status:
        """The status after a failed step, whose cause may be a value of a user's function."""
        is_unsolved, cause = isinstance(failure, NoConvergenceError), failure.__cause__
        if isinstance(failure, NotFiniteNumberError):
            self.cause = failure
        elif cause:
            self.fail(cause)
        return Status.NO_CONVERGENCE if is_unsolved and not self.cause else Status.NOT_FINITE

    def end_with(self, status: Status, problem: Problem) -> None:
        """Set the status; an event that ends the motion may be one of its limits.

        The first value of a user's function that is not finite is raised.
        """
        if self.cause and not self.steps:
            raise self.cause
        limits = self.t_events[len(problem.events) :][: len(problem.limits)]
        is_limit = status is Status.EVENT and any(limits)
        self.status = Status.OUTSIDE_DOMAIN if is_limit else status

    def rows(self) -> tuple[Array, Array]:
        """All times, and all states in rows."""
        y = np.concatenate([np.empty((0, len(self.end[1]))), *self.y])
        # an interruption may come after times are stored and before their states are
        return np.concatenate([np.empty(0), *self.t])[: len(y)], y
