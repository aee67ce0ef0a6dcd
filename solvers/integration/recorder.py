"""Record the samples and events of the steps of an integration."""

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.polynomial import Polynomial
from numpy.polynomial.chebyshev import chebfit, chebpts1, chebroots, chebtrim
from scipy.optimize import brentq

from solvers.integration.events import Event
from solvers.integration.problem import EventFunction, Outcome, Problem
from solvers.integration.solution import Array
from solvers.integration.switching import Switch

#: Attempts to find two crossings in a step; a polynomial that vanishes twice at both of its ends.
PROBES, BUMP = 2, Polynomial([0, 0, 1, -2, 1])
#: Degree of the polynomial of an event in a long step, and its relative rounding errors.
DEGREE, EPSILON = 24, 1e-13
#: Roots, in [-1, 1], whose distance or imaginary part is smaller count as a real double root.
CLOSE = 1e-6


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
            self.events = problem.all_events
            self._evaluate_events()

    def _evaluate_events(self) -> None:
        self._values = [event(self.t, self.y.copy()) for event in self.events]

    def _sample(self, t: Array, y: Array) -> None:
        self._outcome.t.append(t)
        self._outcome.y.append(y.T.copy())
        self._sampled += len(t)

    def advance(
        self,
        end: float,
        state: Callable[[float], Array],
        states: Callable[[Array], Array],
        rough: Callable[[float], Array] | None = None,
    ) -> bool:
        """Record the step that ends at `end`; return whether an event ends the run.

        `state` gives the state at a time within the step, in the form of the problem, `states`
        those at several times in columns; where they raise `ArithmeticError`, nothing is recorded.
        `rough` gives states approximately, where steps are long.
        """
        t = self.t

        def ordinary(time: float, state: Callable[[float], Array] = state) -> Array:
            if time == t:
                return self.y.copy()
            return self.form.to_ordinary(time, state(time), self.y, time - t)

        values = [event(end, ordinary(end)) for event in self.events]
        if rough:
            curve = partial(ordinary, state=rough)
            parts = [[*_parts(event, t, end, curve), end] for event in self.events]
        else:
            ends = zip(self.events, self._values, values, strict=True)
            parts = [[*self._dips(event, x, y, end, ordinary), end] for event, x, y in ends]
        roots = self._roots(t, parts, values, ordinary)
        stops = bool(roots) and _is_terminal(self.events[roots[-1][0]])
        until = roots[-1][1] if stops else end
        y, occurrences = ordinary(until), [(k, root, ordinary(root)) for k, root in roots]
        times, sampled = self._due(until), y[:, np.newaxis]
        if self.samples is not None and len(times):
            sampled = self.form.to_ordinary(times, states(times), self.y, times - t)
        if len(times):
            self._sample(times, sampled)
        for k, root, y_event in occurrences:
            self._outcome.t_events[k].append(root)
            self._outcome.y_events[k].append(y_event)
        self._values = values
        self.t, self.y = self._outcome.end = until, y
        return stops

    def _dips(
        self,
        event: EventFunction,
        before: float,
        after: float,
        end: float,
        ordinary: Callable[[float], Array],
    ) -> list[float]:
        """A time at which the event of a coordinate has another sign than at both ends of the step.

        Values and velocities at the ends give a cubic polynomial; at its extremum, and then at that
        of the polynomial of degree 4 through the value there, the event is evaluated.
        """
        if not isinstance(event, Event | Switch) or not event.has_rate:
            return []
        h, states = end - self.t, {self.t: self.y, end: ordinary(end)}
        u, v = (h * event.rate(t, y) for t, y in states.items())
        is_dip = before * u < 0 < after * v and before * after > 0
        if not is_dip or not v * before - u * after < -2 * u * v:
            return []
        curve = Polynomial(
            [before, u, 3 * (after - before) - 2 * u - v, u + v - 2 * (after - before)]
        )
        for _ in range(PROBES):
            slope = curve.deriv()
            part = float(brentq(slope, 0, 1))
            time = self.t + part * h
            value = event(time, ordinary(time))
            if value * before < 0:
                return [time]
            curve += (value - curve(part)) * (BUMP / BUMP(part))
        return []

    def _due(self, until: float) -> Array:
        """The times up to `until` to record that are not recorded yet."""
        if self.samples is None or self._ascending is None:
            return np.array([until])
        due = int(np.searchsorted(self._ascending, self._direction * until, "right"))
        return self.samples[self._sampled : due]

    def _roots(
        self,
        t: float,
        parts: list[list[float]],
        values: list[float],
        ordinary: Callable[[float], Array],
    ) -> list[tuple[int, float]]:
        """The events of a step and their times, in order, up to the first that is terminal.

        Each event occurs at most once between successive times of its `parts`, the last of which is
        the end of the step.
        """
        crossings = []
        for k, (before, last) in enumerate(zip(self._values, values, strict=True)):
            event, begin = self.events[k], t
            for end in parts[k]:
                after = last if end == parts[k][-1] else event(end, ordinary(end))
                crossed = before != 0 and np.sign(before) != np.sign(after)
                if crossed and np.sign(after - before) * getattr(event, "direction", 0) >= 0:
                    root = _root(event, ordinary, begin, end)
                    crossings.append((abs(root - t), k, root))
                before, begin = after, end
        crossings.sort()
        terminal = [n for n, (_, k, _) in enumerate(crossings, 1) if _is_terminal(self.events[k])]
        return [(k, root) for _, k, root in crossings[: terminal[0] if terminal else None]]


def _parts(
    event: EventFunction, t: float, end: float, state: Callable[[float], Array]
) -> list[float]:
    """Times between the roots of an event in a step, by interpolation along states of the step.

    After an event at the start, also one before the first root.
    """
    nodes = chebpts1(DEGREE + 1)
    times = t + (nodes + 1) / 2 * (end - t)
    values = np.array([event(float(time), state(float(time))) for time in times])
    if np.isfinite(values).all():
        roots = chebroots(chebtrim(chebfit(nodes, values, DEGREE), EPSILON * np.abs(values).max()))
        real = np.sort(roots[np.abs(roots.imag) < CLOSE].real)
        real = real[(real > -1 + CLOSE) & (real < 1 - CLOSE)]
        starts_at_event = event(t, state(t)) == 0
        ends = np.concatenate([[-1.0], real]) if starts_at_event else real
        between = (ends[1:] + ends[:-1]) / 2
        return [float(t + (x + 1) / 2 * (end - t)) for x in between]
    return []


def _is_terminal(event: EventFunction) -> bool:
    return bool(getattr(event, "terminal", False))


def _root(event: EventFunction, state: Callable[[float], Array], t: float, end: float) -> float:
    """The time of the sign change of `event`, or just after it, so that a restart is past it."""

    def value(time: float) -> float:
        return event(time, state(time))

    resolution = 4 * float(np.spacing(max(abs(t), abs(end))))
    root = float(brentq(value, t, end, xtol=resolution, maxiter=1000))
    # rounding may leave the sign as it was for a little longer
    shift, before = 0.0, np.sign(value(t))
    while abs(root + shift - t) < abs(end - t):
        if np.sign(value(root + shift)) != before:
            return root + shift
        shift = 2 * shift or resolution * float(np.sign(end - t))
    return end
