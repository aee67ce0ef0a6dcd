"""The results of a run so far, and the recorder of samples and events of its steps."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np

from solvers.equations.number_checks import NotFiniteNumberError
from solvers.integration.problem.inputs import History
from solvers.integration.problem.problem import EventFunction, Problem
from solvers.integration.problem.status import Status
from solvers.integration.results.event_location import (
    NODES,
    ROUGH_NODES,
    Bracket,
    Curve,
    EventCourse,
    OrdinaryStates,
    Shape,
    StepStates,
    approach,
    estimate,
    locate,
    may_recur,
    rough_polynomial,
    separate_crossings,
)
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


class Recorder:
    """Records the samples and events of successive steps in an `Outcome`.

    `t` and `y` are the time in s and the ordinary state at the end of the last step.
    """

    def __init__(self, problem: Problem, outcome: Outcome) -> None:
        self.form, self.samples, self.events = problem.form, problem.samples, problem.all_events
        self.t, self.y = problem.span[0], problem.start
        self._outcome, self._sampled = outcome, 0
        self._direction = float(np.sign(problem.span[1] - problem.span[0]))
        self._ascending = None if self.samples is None else self._direction * self.samples
        if self.samples is None or (len(self.samples) and self.samples[0] == self.t):
            self._sample(np.array([self.t]), self.y[:, np.newaxis])
        self._evaluate_events()

    def restart(self, problem: Problem) -> None:
        """Go on from the last state with the signs that the problem holds."""
        if problem.switches:
            self.form, self.events = problem.form, problem.all_events
            self.y = self._outcome.end[1]
            self._evaluate_events()

    def _evaluate_events(self) -> None:
        self._values = [event(self.t, self.y.copy()) for event in self.events]

    def _sample(self, t: Array, y: Array) -> None:
        self._outcome.t.append(t)
        self._outcome.y.append(y.T.copy())
        self._sampled += len(t)

    def advance(self, end: float, step: StepStates) -> bool:
        """Record the step that ends at `end`; return whether an event ends the run.

        Where states within the step raise `ArithmeticError`, nothing is recorded.
        """
        states = OrdinaryStates(self.form, self.t, self.y, step)
        values = [event(end, states.at(end)) for event in self.events]
        roots = self._roots(end, values, states, step.curves()) if self.events else []
        stops = bool(roots) and _is_terminal(self.events[roots[-1][0]])
        until = roots[-1][1] if stops else end
        y, occurrences = states.at(until), [(k, root, states.at(root)) for k, root in roots]
        times, sampled = self._due(until), y[:, np.newaxis]
        if self.samples is not None and len(times):
            sampled = states.along(step.states, times)
        if len(times):
            self._sample(times, sampled)
        for k, root, y_event in occurrences:
            self._outcome.t_events[k].append(root)
            self._outcome.y_events[k].append(y_event)
        self._values = values
        self.t, self.y = self._outcome.end = until, y
        return stops

    def _due(self, until: float) -> Array:
        """The times up to `until` to record that are not recorded yet."""
        if self._ascending is None:
            return np.array([until])
        due = int(np.searchsorted(self._ascending, self._direction * until, "right"))
        return self._direction * self._ascending[self._sampled : due]

    def _shapes(
        self, end: float, values: list[float], states: OrdinaryStates, curves: Iterable[Curve]
    ) -> list[Shape]:
        """The course of each event in the step."""
        begin, h = self.t, end - self.t
        approximations = iter(curves)
        curve = next(approximations)

        def along(curve: Curve, k: int, parts: Array) -> Array:
            times = begin + parts * h
            pairs = zip(times.tolist(), states.along(curve, times).T, strict=True)
            return np.array([self.events[k](time, y.copy()) for time, y in pairs])

        shapes = []
        for k, value in enumerate(values):
            inside = along(curve, k, ROUGH_NODES[1:-1])
            rough = np.array([self._values[k], *inside, value])
            shapes.append(Shape(rough_polynomial(rough), [], may_recur(rough)))
        if any(shape.recurs for shape in shapes):
            *_, curve = curve, *approximations
        for k, shape in enumerate(shapes):
            better = along(curve, k, NODES) if shape.recurs else np.array([np.nan])
            if np.isfinite(better).all():
                shapes[k] = separate_crossings(self._values[k], better, values[k])
        return shapes

    def _roots(
        self, end: float, values: list[float], states: OrdinaryStates, curves: Iterable[Curve]
    ) -> list[tuple[int, float]]:
        """The events of a step and their times, in order, up to the first that is terminal."""
        crossings = []
        for k, shape in enumerate(self._shapes(end, values, states, curves)):
            course = EventCourse(self.events[k], states)
            for bracket in self._brackets(end, self._values[k], values[k], shape, course):
                rise = bracket.far_value - bracket.near_value
                if np.sign(rise) * getattr(self.events[k], "direction", 0) >= 0:
                    guess = estimate(shape.polynomial, self.t, bracket)
                    root = locate(bracket, guess, course)
                    crossings.append((abs(root - self.t), k, root))
        crossings.sort()
        terminal = [n for n, (_, k, _) in enumerate(crossings, 1) if _is_terminal(self.events[k])]
        return [(k, root) for _, k, root in crossings[: terminal[0] if terminal else None]]

    def _brackets(
        self, end: float, before: float, after: float, shape: Shape, course: EventCourse
    ) -> Iterator[Bracket]:
        """Parts of the step in each of which an event, with these values at the ends, occurs."""
        begin, h = self.t, end - self.t
        for extremum in shape.extrema:
            part, value = approach(
                extremum, (begin - self.t) / h, before, lambda part: course.at(self.t + part * h)
            )
            if value == 0:
                continue  # which side it is on is decided by the next extremum
            time = self.t + part * h
            if np.sign(before) * np.sign(value) < 0:  # a product of tiny values may be 0
                yield Bracket(begin, before, time, value, h)
            before, begin = value, time
        if before != 0 and np.sign(before) != np.sign(after):
            yield Bracket(begin, before, end, after, h)


def _is_terminal(event: EventFunction) -> bool:
    return bool(getattr(event, "terminal", False))
