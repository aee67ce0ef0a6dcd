"""Motions through configurations at which constraints depend on each other, as aligned rods do.

Near such a configuration the multipliers lose digits, and every branch of the constraints satisfies
them to rounding errors: steps become as short as the distance from it, and end on any branch. The
motion itself is smooth on its own branch, as its past is. It is continued by the polynomial that
has its past positions and velocities, up to a state on the other side as far away.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import scipy

from solvers.equations.energy import conserves_energy
from solvers.equations.forms import Form
from solvers.equations.module import integrals
from solvers.equations.number_checks import NotFiniteNumberError
from solvers.equations.projection import projected
from solvers.equations.singularities import NEAR, distance_from_singularity
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.compiled.kernel import Kernel
from solvers.integration.loops import compiled_loop, python_loop
from solvers.integration.problem.problem import Problem, shortest_step
from solvers.integration.problem.status import Status
from solvers.integration.results.event_location import Curve
from solvers.integration.results.recorder import Outcome, Recorder
from solvers.runge_kutta.stepper import Array

#: Integrates a problem up to its end, or up to a step that collapses.
Loop = Callable[[Problem, Outcome], None]

#: The distance from a singularity at which a motion ends that no polynomial continues: where steps
#: collapse again, its states would have lost their digits.
LOST = 1e-3
#: Tolerances of the past motion: the smallest by which its steps get away from rounding errors.
PAST = (1e-13, 1e-12, 1e-11, 1e-10)
#: Times from the singularity at which polynomials begin and end, in units of that from the start;
#: past durations, in units of these; and parts of them at which polynomials have the states.
PARTS, LENGTHS = (1, 2, 4, 8, 16, 32), (10, 20, 40)
CHEBYSHEV = (1 - np.cos(np.linspace(0, np.pi, 8))) / 2
#: Largest estimate of the error on the other side, in units of the tolerances; largest distance
#: there from the constraints, in units of the estimate, and of rounding errors of coordinates.
LARGEST, ROUNDING = 100.0, 1e-13
#: Most doublings of a duration.
DOUBLINGS = 60


def run(problem: Problem, outcome: Outcome, program: Kernel | None) -> None:
    """Integrate `problem`, in Python or compiled, through singular configurations.

    The status is ``SINGULAR`` where the motion beyond such a configuration is not determined, or
    not accurately; no sample lies beyond it then.
    """
    loop = partial(compiled_loop.run, program=program) if program else python_loop.run
    # the values of integrals would be set anew with each part of a motion
    is_watched = replace(problem, schedule=None).collapse and not integrals(problem.form.module)
    if problem.schedule and problem.schedule.table is None and is_watched:
        _run_controlled(problem, outcome, loop)
        return
    loop(problem, outcome)
    while outcome.status is Status.SINGULAR:
        # polynomials do not reach across jumps of inputs
        held = _remaining(problem.held_at(outcome.end[0]), outcome)
        status = _extend(outcome, held, partial(_resume, loop=loop))
        if status is not Status.FINISHED or outcome.end[0] == problem.span[1]:
            return
        _extend(outcome, _remaining(problem, outcome), loop)


def _run_controlled(problem: Problem, outcome: Outcome, loop: Loop) -> None:
    """Integrate from sample to sample of a controller."""
    try:
        for segment in problem.segments(lambda: outcome.end[1], outcome.history):
            part = _remaining(replace(segment, schedule=None), outcome)
            _extend(outcome, part, partial(_run_held, loop=loop))
            if outcome.status is not Status.FINISHED:
                return
    except NotFiniteNumberError as failure:
        outcome.end_with(outcome.fail(failure), problem)


def _run_held(problem: Problem, outcome: Outcome, loop: Loop) -> None:
    """Integrate a problem with constant inputs."""
    loop(problem, outcome)
    if outcome.status is Status.SINGULAR:
        _resume(problem, outcome, loop)


def _resume(problem: Problem, outcome: Outcome, loop: Loop) -> None:
    """Continue a problem with constant inputs from where steps have collapsed."""
    outcome.status = Status.SINGULAR
    while outcome.status is Status.SINGULAR:
        part = _remaining(problem, outcome)
        if _approaches(part):
            passages = (_passage(part, loop, tolerance) for tolerance in PAST)
            passage = None if problem.switches else next(filter(None, passages), None)
            if passage is None and _distance(part, *outcome.end) < LOST:
                return
            if passage and _recorded(part, outcome, passage):
                return
            part = _remaining(problem, outcome)
        _extend(outcome, part, loop)


def _extend(outcome: Outcome, part: Problem, run: Loop) -> Status:
    """Append the outcome of the remaining part of a motion, and return its status."""
    own = Outcome.at_start(part)
    try:
        run(part, own)
    finally:
        _append(outcome, own)
    return own.status


def _remaining(problem: Problem, outcome: Outcome) -> Problem:
    """The problem from the state reached on."""
    (begin, end), (t, y) = problem.span, outcome.end
    direction, samples = np.sign(end - begin), problem.samples
    if samples is not None:
        later, last = direction * (samples - t), direction * (end - t)
        samples = samples[((later > 0) | ((later == 0) & (not outcome.t))) & (later <= last)]
    steps = max(problem.max_steps - outcome.steps, 0)
    return replace(problem, span=(t, end), start=y, samples=samples, max_steps=steps)


def _append(outcome: Outcome, part: Outcome) -> None:
    """Append the outcome of a later part, which may begin with the state reached before."""
    t, y = part.rows()
    first = int(len(outcome.t) > 0 and len(t) > 0 and t[0] == outcome.end[0])
    outcome.t.append(t[first:])
    outcome.y.append(y[first:])
    for event, (times, states) in enumerate(zip(part.t_events, part.y_events, strict=True)):
        outcome.t_events[event] += times
        outcome.y_events[event] += states
    outcome.end, outcome.status, outcome.cause = part.end, part.status, part.cause
    outcome.backend = part.backend
    for name in ("nfev", "njev", "steps", "rejected"):
        setattr(outcome, name, getattr(outcome, name) + getattr(part, name))


def _distance(problem: Problem, t: float, y: Array) -> float:
    return distance_from_singularity(problem.form.module, problem.form.constants, y.tolist(), t)


def _approaches(problem: Problem) -> bool:
    """Whether a motion is near a singular configuration and does not move away from it."""
    (t, stop), y, n = problem.span, problem.start, len(problem.form.module.COORDINATES)
    near = _distance(problem, t, y)
    if near > NEAR:
        return False
    rates = y[n : 2 * n] * np.sign(stop - t)
    change = 0.01 * near / max(float(np.abs(rates).max()), 1e-300)
    before, after = y.copy(), y.copy()
    before[:n] -= change * rates
    after[:n] += change * rates
    return _distance(problem, t, after) <= _distance(problem, t, before)


@dataclass(frozen=True)
class Passage:
    """States by a polynomial of time, up to a regular one at `end`, that is `y`."""

    end: float
    y: Array
    polynomial: Callable[[Array], Array]

    def state(self, t: float) -> Array:
        """The state at a time."""
        return self.y if t == self.end else self.states(np.array([t]))[:, 0]

    def states(self, times: Array) -> Array:
        """The states at several times, in columns."""
        return self.polynomial(times)

    def between(self, _begin: float, _y0: Array, _end: float, _y1: Array) -> Curve:
        """States at several times."""
        return self.states

    def curves(self) -> list[Curve]:
        """The states themselves."""
        return [self.states]


def _recorded(problem: Problem, outcome: Outcome, passage: Passage) -> bool:
    """Record the samples and events of a passage; return whether it ends the motion."""
    lagrangian = replace(problem.with_form("lagrangian"), span=(problem.span[0], passage.end))
    own = Outcome.at_start(lagrangian)
    stops = Recorder(lagrangian, own).advance(passage.end, passage)
    own.steps = 1
    if stops:
        own.end_with(Status.EVENT, problem)
    elif passage.end == problem.span[1]:
        own.status = Status.FINISHED
    else:
        own.status = Status.SINGULAR
    _append(outcome, own)
    return outcome.status is not Status.SINGULAR


def _passage(problem: Problem, loop: Loop, tolerance: float) -> Passage | None:
    """The motion from the start of a problem to the other side of a singular configuration."""
    (begin, stop), direction = problem.span, np.sign(problem.span[1] - problem.span[0])
    left = _time_left(problem, loop, tolerance)
    if left is None:
        return None
    singular = begin + direction * left
    pasts = {
        (part * left, length): singular - direction * part * left * (1 + length * CHEBYSHEV)
        for part in PARTS
        for length in LENGTHS
    }
    times = np.unique(direction * np.concatenate([*pasts.values()]))[::-1] * direction
    states = _past(problem, loop, tolerance, times)
    best, least = None, LARGEST
    for (apart, _), nodes in pasts.items():
        columns = np.searchsorted(-direction * times, -direction * nodes)
        if columns.max() >= states.shape[1]:
            continue  # the motion ends before, backwards
        end, past = singular + direction * apart, states[:, columns]
        polynomials = (
            _polynomial(problem, nodes, past),
            _polynomial(problem, nodes[:-1], past[:, :-1]),
        )
        y, other = (polynomial(np.array([end]))[:, 0] for polynomial in polynomials)
        sizes = problem.atol + problem.rtol * np.abs(y)
        error = float((np.abs(y - other) / sizes).max())
        if error < least:
            landed = _landed(problem, end, y, np.abs(y - other))
            if landed is not None:
                best, least = Passage(end, landed, polynomials[0]), error
    if best and direction * (stop - best.end) <= 0:  # the motion ends on the way
        best = replace(best, end=stop, y=best.polynomial(np.array([stop]))[:, 0])
    return best


def _time_left(problem: Problem, loop: Loop, tolerance: float) -> float | None:
    """The time to a singular configuration, the distance from which falls steadily."""
    (begin, stop), direction = problem.span, np.sign(problem.span[1] - problem.span[0])
    near, duration = _distance(problem, begin, problem.start), 10 * shortest_step(begin, stop)
    for _ in range(DOUBLINGS):
        time = begin - direction * duration
        past = _past(problem, loop, tolerance, np.array([time]))
        if not past.size:
            return None
        before = _distance(problem, time, past[:, 0])
        if before > 2 * near:
            return float(duration * near / (before - near))
        duration *= 2
    return None


def _landed(problem: Problem, end: float, y: Array, error: Array) -> Array | None:
    """The state on the constraints near `y`; None if it is not this state up to the error.

    Linkages that only nearly have a singular configuration turn near it, and go another way.
    """
    form, n = problem.form.in_form("lagrangian"), len(problem.form.module.COORDINATES)
    if _distance(problem, end, y) < _distance(problem, problem.span[0], problem.start) / 2:
        return None
    on_constraints = projected(form, end, y)
    rounding = ROUNDING * max(1.0, float(np.abs(y[:n]).max()))
    misses = np.abs(on_constraints - y)[:n].max() > LARGEST * max(float(error[:n].max()), rounding)
    sizes = problem.atol + problem.rtol * np.abs(y)
    return None if misses or _loses_energy(form, problem.start, y, sizes) else on_constraints


def _loses_energy(form: Form, before: Array, after: Array, sizes: Array) -> bool:
    """Whether a constant energy has changed by more than changes of the state explain."""
    if not conserves_energy(form.module):
        return False
    moved = [after + change for change in LARGEST * np.diag(sizes)]
    first, last, *others = (
        float(form.module.energy(0.0, y.tolist(), form.constants)) for y in (before, after, *moved)
    )
    return abs(last - first) > sum(abs(other - last) for other in others)


def _past(problem: Problem, loop: Loop, tolerance: float, times: Array) -> Array:
    """Earlier states of the motion at `times`, which recede, in columns, as far as it exists."""
    size = np.maximum(1.0, np.abs(problem.start).max())
    fine = replace(
        problem,
        span=(problem.span[0], float(times[-1])),
        samples=times,
        events=[],
        limits=[],
        rtol=tolerance,
        atol=np.array(tolerance * size),
    )
    outcome = Outcome.at_start(fine)
    loop(fine, outcome)
    return outcome.rows()[1].T


def _polynomial(problem: Problem, times: Array, states: Array) -> Callable[[Array], Array]:
    """The states by time of the polynomial with these positions and velocities at these times."""
    n, begin, rate = len(problem.form.module.COORDINATES), times[0], times[-1] - times[0]
    values = np.stack([states[:n], states[n : 2 * n] * rate]).transpose(2, 0, 1).reshape(-1, n)
    at = np.repeat((times - begin) / rate, 2)
    interpolated = scipy.interpolate.KroghInterpolator(at, values)

    def polynomial(times: Array) -> Array:
        at = (times - begin) / rate
        return np.vstack([interpolated(at).T, interpolated.derivative(at).T / rate])

    return polynomial


def rerun(problem: Problem) -> Outcome:
    """The outcome of a problem in its form, compiled if that is possible, without warnings."""
    outcome, program = Outcome.at_start(problem), None
    if problem.backend != "python" and not compiled_loop.obstacle(problem):
        with suppress(NoCompilerError):  # the first run has reported it
            program = compiled_loop.loop(problem)
    run(problem, outcome, program)
    return outcome
