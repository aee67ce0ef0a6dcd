"""Record the samples and events of the steps of an integration."""

from collections.abc import Callable, Iterable

import numpy as np
from scipy.optimize import brentq

from solvers.integration.crossings import (
    NODES,
    ROUGH_NODES,
    Extremum,
    approach,
    may_recur,
    separate_crossings,
)
from solvers.integration.problem import EventFunction, Outcome, Problem
from solvers.integration.solution import Array

#: States at several times of a step, in columns.
Curve = Callable[[Array], Array]


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
        states: Curve,
        curves: Iterable[Curve],
    ) -> bool:
        """Record the step that ends at `end`; return whether an event ends the run.

        `state` gives the state at a time within the step, in the form of the problem, `states`
        those at several times in columns; where they raise `ArithmeticError`, nothing is recorded.
        `curves` are approximations of these, each better than the one before.
        """
        t = self.t

        def ordinary(time: float) -> Array:
            if time == t:
                return self.y.copy()
            return self.form.to_ordinary(time, state(time), self.y, time - t)

        values = [event(end, ordinary(end)) for event in self.events]
        extrema = self._extrema(end, values, curves) if self.events else []
        roots = self._roots(end, values, extrema, ordinary)
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

    def _extrema(
        self, end: float, values: list[float], curves: Iterable[Curve]
    ) -> list[list[Extremum]]:
        """Extrema of each event between which it occurs at most once in the step."""
        begin, h, events = self.t, end - self.t, range(len(self.events))
        approximations = iter(curves)
        curve = next(approximations)

        def along(curve: Curve, k: int, parts: Array) -> Array:
            times = begin + parts * h
            states = self.form.to_ordinary(times, curve(times), self.y, times - begin)
            pairs = zip(times.tolist(), states.T, strict=True)
            return np.array([self.events[k](time, y.copy()) for time, y in pairs])

        recurring = []
        for k in events:
            inside = along(curve, k, ROUGH_NODES[1:-1])
            rough = np.array([self._values[k], *inside, values[k]])
            if np.isfinite(rough).all() and may_recur(rough):
                recurring.append(k)
        extrema: list[list[Extremum]] = [[] for _ in events]
        if recurring:
            *_, curve = curve, *approximations
        for k in recurring:
            better = along(curve, k, NODES)
            if np.isfinite(better).all():
                extrema[k] = separate_crossings(self._values[k], better, values[k])
        return extrema

    def _due(self, until: float) -> Array:
        """The times up to `until` to record that are not recorded yet."""
        if self.samples is None or self._ascending is None:
            return np.array([until])
        due = int(np.searchsorted(self._ascending, self._direction * until, "right"))
        return self.samples[self._sampled : due]

    def _roots(
        self,
        end: float,
        values: list[float],
        extrema: list[list[Extremum]],
        ordinary: Callable[[float], Array],
    ) -> list[tuple[int, float]]:
        """The events of a step and their times, in order, up to the first that is terminal."""
        t, h, crossings = self.t, end - self.t, []
        for k, event in enumerate(self.events):
            begin, before = t, self._values[k]

            def value(part: float, event: EventFunction = event) -> float:
                return event(t + part * h, ordinary(t + part * h))

            for extremum in [*extrema[k], None]:
                time, after = end, values[k]
                if extremum:
                    part, after = approach(extremum, (begin - t) / h, before, value)
                    time = t + part * h
                crossed = before != 0 and np.sign(before) != np.sign(after)
                if extremum and after == 0:
                    continue  # which side it is on is decided by the next extremum
                if crossed and np.sign(after - before) * getattr(event, "direction", 0) >= 0:
                    root = _root(event, ordinary, begin, time)
                    crossings.append((abs(root - t), k, root))
                before, begin = after, time
        crossings.sort()
        terminal = [n for n, (_, k, _) in enumerate(crossings, 1) if _is_terminal(self.events[k])]
        return [(k, root) for _, k, root in crossings[: terminal[0] if terminal else None]]


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
