"""Options of an integration, the problem built from them, and its outcome."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from solvers.equations.forms import Form
from solvers.equations.quantities import NotFiniteNumberError, Values
from solvers.integration.inputs import Controller, Held, History, Schedule
from solvers.integration.solution import Array, Status
from solvers.integration.switching import Switch
from solvers.runge_kutta.stepper import NoConvergenceError
from solvers.runge_kutta.tableau import Tableau

#: The shortest step, in units of the spacing of floating-point times.
SHORTEST = 10
#: Part of a motion's longest step below which its constraints may be singular: steps become as
#: short as the distance from such a configuration.
COLLAPSE = 1e-2
EventFunction = Callable[[float, Array], float]


def shortest_step(begin: float, end: float) -> float:
    """The shortest step between two times in s."""
    return SHORTEST * float(np.spacing(max(abs(begin), abs(end))))


@dataclass(frozen=True)
class Options:
    """Options of `integrate`, `ensemble` and `prepare`, before any check; documented there."""

    method: str = "verner853"
    form: str | None = None
    rtol: float = 1e-9
    atol: ArrayLike = 1e-12
    h: float | None = None
    t_eval: ArrayLike | None = None
    events: EventFunction | Sequence[EventFunction] = ()
    max_steps: int = 1_000_000
    backend: str | None = None
    compensated: bool = False
    inputs: Held | Controller | Values | None = None


@dataclass(frozen=True)
class Problem:
    """A valid integration problem; `solvers.integration.validation.problem` builds it."""

    form: Form
    method: Tableau | str  # a string is the name of a method of SciPy
    span: tuple[float, float]
    start: Array  # an ordinary state
    h: float | None  # None where steps are controlled
    rtol: float  # tolerances are 0 for fixed steps
    atol: Array
    samples: Array | None  # times of the states to record; None for the end of every step
    events: list[EventFunction]
    limits: Sequence[EventFunction]  # end the motion where a positive coordinate falls to 0
    max_steps: int
    options: Options  # as given
    schedule: Schedule | None = None  # of inputs that are held between samples
    levels: tuple[float, ...] = ()  # values of switching functions that count as 0

    def starting(self) -> "Problem":
        """The same problem, which keeps integrals at their values at the start."""
        return self.with_form_of(self.form.starting(self.span[0], self.start))

    def with_form(self, name: str) -> "Problem":
        """The same problem in another form with the same ordinary state."""
        return self.with_form_of(self.form.in_form(name))

    def with_form_of(self, form: Form) -> "Problem":
        """The same problem with another form, or other signs of switching functions."""
        return replace(self, form=form)

    def with_params(self, params: Sequence[Any]) -> "Problem":
        """The same problem with other parameters: numbers, or arrays for several motions."""
        return self.with_form_of(self.form.with_params(params))

    def motion(self, k: int, states: Array, params: Array) -> "Problem":
        """The problem of one of many motions, whose initial states and parameters are in rows."""
        return replace(self.with_params(params[k % len(params)].tolist()), start=states[k])

    def with_inputs(self, values: Array) -> "Problem":
        """The same problem with other inputs, the last parameters."""
        return self.with_params([*self.form.params[: -len(values)], *values])

    @property
    def has_varying_inputs(self) -> bool:
        """Whether inputs change during the motion, by samples or as a function of Python."""
        return self.schedule is not None or self.form.feedback is not None

    @property
    def all_events(self) -> list[EventFunction]:
        """The requested events, followed by the limits of coordinates and by switches."""
        return [*self.events, *self.limits, *self.switches]

    @property
    def switches(self) -> list[Switch]:
        """Events that end steps where switching functions, whose signs are held, are 0."""
        if not self.levels:  # a specialised module may have one form only
            return []
        lagrangian = self.form.in_form("lagrangian")
        return [Switch(lagrangian, k, level) for k, level in enumerate(self.levels)]

    @property
    def collapse(self) -> float:
        """Part of the longest step below which constraints may be singular; 0 without these."""
        watches = self.form.has_constraints and self.h is None and self.schedule is None
        return COLLAPSE * watches

    @property
    def backend(self) -> str | None:
        """The required backend, ``compiled`` or ``python``; None for any."""
        return "compiled" if self.options.compensated else self.options.backend

    @property
    def units(self) -> dict[str, str]:
        """Units of the components of an ordinary state, in their order."""
        return {name: self.form.module.UNITS[name] for name in self.form.ordinary}

    @property
    def description(self) -> str:
        """Method, form and step control in words."""
        title = self.method.title if isinstance(self.method, Tableau) else self.method
        steps = f"rtol = {self.rtol}" if self.h is None else f"h = {self.h}"
        return f"{title}, {self.form.name} form, {steps}"


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
