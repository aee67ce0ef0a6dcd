"""Integration in Python by the methods of `solvers.runge_kutta`; compiled loops agree with it."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from solvers.integration import scipy_loop
from solvers.integration.inputs import segments
from solvers.integration.problem import Outcome, Problem, shortest_step
from solvers.integration.recorder import Recorder
from solvers.integration.solution import Array, Status
from solvers.integration.stop_flag import StopFlag
from solvers.runge_kutta.newton import Stages
from solvers.runge_kutta.parallel_stages import Polynomial
from solvers.runge_kutta.step_control import Controller
from solvers.runge_kutta.stepper import NoConvergenceError, NotFiniteError, Step, Stepper
from solvers.runge_kutta.tableau import Tableau

#: Most successive failures of a step, each of which divides its size by four.
MOST_FAILURES = 25
#: Failures of a step that a smaller step may avoid.
FAILURES = (NotFiniteError, NoConvergenceError)


@dataclass(frozen=True)
class Point:
    """A time in s, with the state and its derivative."""

    t: float
    y: Array
    derivative: Array
    last: Polynomial | Stages | None = None  # of the step that ends here


@dataclass(frozen=True)
class Accepted:
    """A step with a sufficiently small error; `norm` is that of its error."""

    attempts: "Attempts"
    start: Point
    end: Point
    norm: float
    step: Step

    def state(self, t: float) -> Array:
        """The state at a time within the step, by a shorter step from its start."""
        if t == self.end.t:
            return self.end.y
        start, polynomial = self.start, self.step.polynomial
        guess = polynomial.within() if polynomial else start.last
        step = self.attempts.stepper.step
        y = step(start.t, start.y, t - start.t, start.derivative, guess).y
        return self.attempts.normalise(y)

    @property
    def rough(self) -> Callable[[float], Array] | None:
        """States within the step, with a lower order and without evaluations, if it has them."""
        start, polynomial = self.start, self.step.polynomial
        return (lambda t: start.y + polynomial.change(t - start.t)) if polynomial else None

    def states(self, times: Array) -> Array:
        """The states at several times, in columns."""
        return np.stack([self.state(float(t)) for t in times], axis=1)


@dataclass(frozen=True)
class Rejected:
    """A step that failed, or whose error is too large.

    `h` is the next step size to try; `last` predicts its stages, unless those of the last step do.
    """

    h: float
    failure: ArithmeticError | None = None
    last: Polynomial | None = None


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
            step = self.stepper.step(start.t, start.y, t - start.t, start.derivative, start.last)
            norm = controller.norm(step.error, start.y, step.y) if controller else 0.0
            y, derivative = self.normalise(step.y), step.derivative
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
        return Accepted(self, start, Point(t, y, derivative, step.last), norm, step)

    def first_step_size(self, start: Point, end: float, shortest: float) -> float:
        """The first step size of steps that are controlled."""
        assert self.controller is not None
        guess = self.controller.initial_step
        rhs, duration = self.stepper.derivative, end - start.t
        return max(guess(rhs, start.t, start.y, start.derivative, duration), 2 * shortest)


def run(problem: Problem, outcome: Outcome, stop: StopFlag | None = None) -> None:
    """Integrate `problem`, by SciPy if it has the method; `outcome` holds the results so far.

    Once `stop` is set, the integration ends with the last step.
    """
    stop = stop or StopFlag()
    if not isinstance(problem.method, Tableau):
        scipy_loop.run(problem, outcome, stop)
        return
    controller = None
    if problem.h is None:
        controller = Controller.of(problem.method, problem.rtol, problem.atol)
    recorder, h, status = Recorder(problem, outcome), problem.h, Status.FINISHED
    for part in segments(problem, lambda: recorder.y, outcome.history):
        form = part.form
        stepper = Stepper(problem.method, form.rhs, form.jacobian, problem.rtol, problem.atol)
        attempts = Attempts(stepper, controller, form.normalised)
        try:
            status, h = _run(part, outcome, recorder, attempts, h, stop)
        finally:
            outcome.nfev += stepper.nfev
            outcome.njev += stepper.njev
        if status is not Status.FINISHED:
            break
    outcome.end_with(status, problem)


def _run(
    problem: Problem,
    outcome: Outcome,
    recorder: Recorder,
    attempts: Attempts,
    h: float | None,
    stop: StopFlag,
) -> tuple[Status, float | None]:
    """Integrate from the recorder's state on, by a first step of size `h`, or of a suitable size.

    Return the status, and the size of the next step.
    """
    begin, end = problem.span
    if begin == end:
        return Status.FINISHED, h
    y = problem.form.from_ordinary(begin, recorder.y)
    try:
        point = Point(begin, y, attempts.stepper.derivative(begin, y))
    except NotFiniteError:
        return Status.NOT_FINITE, h
    shortest, failures, first = shortest_step(begin, end), 0, outcome.steps
    if problem.h is None:
        longest = abs(end - begin)
        h = min(h, longest) if h else attempts.first_step_size(point, end, shortest)
    assert h
    while point.t != end:
        if stop.is_set:
            return Status.INTERRUPTED, h
        if outcome.steps == problem.max_steps:
            return Status.STEP_LIMIT, h
        t = _step_end(problem, point.t, h, outcome.steps - first)
        if abs(t - point.t) < shortest and t != end:
            return Status.STEP_TOO_SMALL, h
        trial, stops = _step(attempts, recorder, point, t, is_last=t == end)
        if isinstance(trial, Rejected):
            outcome.rejected, h = outcome.rejected + 1, trial.h
            point = replace(point, last=trial.last or point.last)
            failures += trial.failure is not None
            if trial.failure and (attempts.controller is None or failures > MOST_FAILURES):
                unsolved = isinstance(trial.failure, NoConvergenceError)
                return Status.NO_CONVERGENCE if unsolved else Status.NOT_FINITE, h
            continue
        outcome.steps, failures = outcome.steps + 1, 0
        if stops:
            return Status.EVENT, h
        point = trial.end
        if attempts.controller:
            h *= attempts.controller.factor(trial.norm, h, trial.step.contraction)
    return Status.FINISHED, h


def _step(
    attempts: Attempts, recorder: Recorder, start: Point, t: float, *, is_last: bool
) -> tuple[Accepted | Rejected, bool]:
    """An attempt at a step to `t`, recorded if accepted, and whether an event ends the run."""
    h = abs(t - start.t)
    trial = attempts.attempt(start, t, h, is_last=is_last)
    try:
        if isinstance(trial, Rejected):
            return trial, False
        return trial, recorder.advance(t, trial.state, trial.states, trial.rough)
    except FAILURES as failure:
        return Rejected(h / 4, failure), False


def _step_end(problem: Problem, t: float, h: float, steps: int) -> float:
    """The end of a step of size `h` from `t`: the end of the time span where that is near."""
    begin, end = problem.span
    direction = np.sign(end - begin)
    # fixed steps are counted, so that their ends do not drift
    aim = t + h * direction if problem.h is None else begin + (steps + 1) * h * direction
    return end if (end - aim) * direction < 1e-9 * h else aim
