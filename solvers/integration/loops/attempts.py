"""Attempts at steps of the methods of `solvers.runge_kutta`."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solvers.equations.number_checks import NotFiniteNumberError
from solvers.runge_kutta.continuous_extension import bernstein_values
from solvers.runge_kutta.newton_stages import NewtonStages
from solvers.runge_kutta.parallel_stages import Polynomial
from solvers.runge_kutta.step_control import Controller, OrderChoice
from solvers.runge_kutta.stepper import (
    Array,
    NoConvergenceError,
    NotFiniteError,
    Stepper,
    StepResult,
)

#: Failures of a step that a smaller step may avoid.
FAILURES = (NotFiniteError, NoConvergenceError, NotFiniteNumberError)


@dataclass(frozen=True)
class TimedState:
    """A time in s, with the state and its derivative."""

    t: float
    y: Array
    derivative: Array
    last: Polynomial | NewtonStages | None = None  # of the step that ends here


@dataclass(frozen=True)
class Accepted:
    """A step with a sufficiently small error; `norm` is that of its error."""

    attempts: "StepAttempts"
    start: TimedState
    end: TimedState
    norm: float
    step: StepResult

    def state(self, t: float) -> Array:
        """The state at a time within the step, by a shorter step from its start."""
        if t in (self.start.t, self.end.t):
            return self.start.y if t == self.start.t else self.end.y
        start, polynomial = self.start, self.step.polynomial
        guess = polynomial.within() if polynomial else start.last
        step = self.attempts.stepper.step
        y = step(start.t, start.y, t - start.t, start.derivative, guess).y
        return self.attempts.project(t, y)

    def between(self, begin: float, y0: Array, end: float, y1: Array) -> Callable[[Array], Array]:
        """States, in columns, between those at two near times, by the cubic."""
        derivative, width, change = self.attempts.stepper.derivative, end - begin, y1 - y0
        first, last = width * derivative(begin, y0) - change, width * derivative(end, y1) - change

        def curve(times: Array) -> Array:
            x = ((times - begin) / width)[:, np.newaxis]
            states = y0 + x * (change + (1 - x) * ((1 - x) * first - x * last))
            return self.attempts.projected(times, states)

        return curve

    def curves(self) -> Iterator[Callable[[Array], Array]]:
        """States at several times, in columns, by polynomials that are more accurate each."""
        start, step, extension = self.start, self.step, self.attempts.stepper.extension
        t, y, h = start.t, start.y, self.end.t - start.t
        if step.polynomial:
            polynomial = step.polynomial
            yield lambda times: y[:, np.newaxis] + polynomial.change(times - t)
            return

        def curve(coefficients: Array) -> Callable[[Array], Array]:
            degree = len(coefficients) - 1
            return lambda times: (
                (y + h * (bernstein_values(degree, (times - t) / h) @ coefficients)).T
            )

        if step.stages:
            ends = start.derivative, self.attempts.stepper.derivative(self.end.t, self.end.y)
            yield curve(extension.with_ends @ np.vstack([*ends, step.stages.k]))
            return
        assert step.k is not None
        yield curve(extension.change(step.k))
        yield curve(self._extended)

    @cached_property
    def _extended(self) -> Array:
        """Bernstein coefficients of the extension of the method's order."""
        start, stepper, k = self.start, self.attempts.stepper, self.step.k
        assert k is not None
        return stepper.extension.extend(
            stepper.derivative, start.t, start.y, self.end.t - start.t, k
        )

    def states(self, times: Array) -> Array:
        """The states at several times, in columns.

        They are as accurate as that at the end: by shorter steps, or by the continuous extension of
        the method's order where that takes fewer evaluations.
        """
        least = self.attempts.stepper.extension.least_samples
        inside = times != self.end.t
        if not least or np.count_nonzero(inside) < least:
            return np.stack([self.state(float(t)) for t in times], axis=1)
        *_, curve = self.curves()
        extended = iter(curve(times[inside]).T)
        states = [next(extended) if is_inside else self.end.y for is_inside in inside]
        return self.attempts.projected(times, states)


@dataclass(frozen=True)
class Rejected:
    """A step that failed, or whose error is too large.

    `h` is the next step size to try; `last` predicts its stages, unless those of the last step do.
    """

    h: float
    failure: ArithmeticError | None = None
    last: Polynomial | None = None


@dataclass(frozen=True)
class StepAttempts:
    """Attempts at steps of one method; `project` is applied to every new state."""

    stepper: Stepper
    controller: Controller | None
    project: Callable[[float, Array], Array] = lambda t, y: y

    def projected(self, times: Array, states: Iterable[Array]) -> Array:
        """States at several times, in columns, projected."""
        pairs = zip(times.tolist(), states, strict=True)
        return np.stack([self.project(t, y) for t, y in pairs], axis=1)

    def attempt(
        self, start: TimedState, t: float, h: float, *, is_last: bool
    ) -> Accepted | Rejected:
        """Try the step from `start` to `t`, of size `h`; the last step needs no derivative."""
        controller = self.controller
        try:
            step = self.stepper.step(start.t, start.y, t - start.t, start.derivative, start.last)
            norm = controller.norm(step.error, start.y, step.y) if controller else 0.0
            y, derivative = self.project(t, step.y), step.derivative
            if not np.isfinite(y).all() or not np.isfinite(norm):
                raise NotFiniteError(f"the state at t = {t} or its error is not finite")
            if controller and norm > 1:
                last = step.polynomial.after_rejection() if step.polynomial else None
                return Rejected(h * controller.factor(norm, h, step.contraction), last=last)
            if derivative is None:  # after the last step and a polynomial it is not needed
                needed = not is_last and step.polynomial is None
                derivative = self.stepper.derivative(t, y) if needed else start.derivative
        except FAILURES as failure:
            return Rejected(h / 4, failure)
        return Accepted(self, start, TimedState(t, y, derivative, step.last), norm, step)

    def first_step_size(self, start: TimedState, end: float, shortest: float) -> float:
        """The first step size of steps that are controlled."""
        assert self.controller is not None
        guess = self.controller.initial_step
        rhs, duration = self.stepper.derivative, end - start.t
        return max(guess(rhs, start.t, start.y, start.derivative, duration), 2 * shortest)


@dataclass(frozen=True)
class Orders:
    """Attempts by methods of decreasing order, and the choice between them."""

    members: Sequence[StepAttempts]
    choice: OrderChoice

    @property
    def attempts(self) -> StepAttempts:
        """Those by the method of the next step."""
        return self.members[self.choice.index]

    def factor(self, trial: Accepted, h: float) -> float:
        """The factor of the step size after an accepted step; it decides on the next method."""
        controller = trial.attempts.controller
        if controller is None:
            return 1.0
        if self.choice.index != self.choice.last:
            controller.forget()
        factor = controller.factor(trial.norm, h, trial.step.contraction)
        self.choice.advance(trial.step.contraction, factor)
        return factor
