"""One attempt at a step: accepted, or rejected with a smaller step size."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from solvers.runge_kutta.step_control import Controller
from solvers.runge_kutta.stepper import Array, NoConvergenceError, NotFiniteError, Stepper

#: Failures of a step that a smaller step may avoid.
FAILURES = (NotFiniteError, NoConvergenceError)


@dataclass(frozen=True)
class Point:
    """A time in s, with the state and its derivative."""

    t: float
    y: Array
    derivative: Array


@dataclass(frozen=True)
class Accepted:
    """A step with a sufficiently small error; `norm` is that of its error."""

    attempts: Attempts
    start: Point
    end: Point
    norm: float

    def state(self, t: float) -> Array:
        """The state at a time within the step, by a shorter step from its start."""
        if t == self.end.t:
            return self.end.y
        start = self.start
        y = self.attempts.stepper.step(start.t, start.y, t - start.t, start.derivative)[0]
        return self.attempts.normalise(y)


@dataclass(frozen=True)
class Rejected:
    """A step that failed, or whose error is too large; `h` is the next step size to try."""

    h: float
    failure: ArithmeticError | None = None


@dataclass(frozen=True)
class Attempts:
    """Attempts at steps of one method; `normalise` is applied to every new state."""

    stepper: Stepper
    controller: Controller | None
    normalise: Callable[[Array], Array] = lambda y: y

    def attempt(self, start: Point, t: float, h: float, *, is_last: bool) -> Accepted | Rejected:
        """Try the step from `start` to `t`, of size `h`; the last step needs no derivative."""
        controller = self.controller
        try:
            step = self.stepper.step(start.t, start.y, t - start.t, start.derivative)
            y, error, derivative = step
            norm = controller.norm(error, start.y, y) if controller else 0.0
            y = self.normalise(y)
            if not np.isfinite(y).all() or not np.isfinite(norm):
                raise NotFiniteError(f"the state at t = {t} or its error is not finite")
            if controller and norm > 1:
                return Rejected(h * controller.factor(norm))
            if derivative is None:
                derivative = start.derivative if is_last else self.stepper.derivative(t, y)
        except FAILURES as failure:
            return Rejected(h / 4, failure)
        return Accepted(self, start, Point(t, y, derivative), norm)

    def first_step_size(self, start: Point, end: float, shortest: float) -> float:
        """The first step size of steps that are controlled."""
        assert self.controller is not None
        guess = self.controller.initial_step
        rhs, duration = self.stepper.derivative, end - start.t
        return max(guess(rhs, start.t, start.y, start.derivative, duration), 2 * shortest)
