"""The result of an integration of many motions."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solvers.equations.number_checks import real_number, real_numbers
from solvers.integration.problem import validation
from solvers.integration.problem.problem import Problem
from solvers.integration.problem.status import Status
from solvers.integration.results.solution import Solution
from solvers.io.exports import data_frame, dataset
from solvers.io.suggestion import counted
from solvers.player.playable import Playable
from solvers.player.sampled_motion import SampledMotion
from solvers.runge_kutta.stepper import Array


@dataclass(frozen=True)
class EnsembleTimes:
    """Checked arguments `t_span` and `t_eval` of `ensemble`."""

    begin: float
    ends: Array  # of shape (1,) or (n,)
    samples: Array  # of shape (1, times) or (n, times)

    @classmethod
    def of(cls, t_span: object, t_eval: ArrayLike | None, n: int) -> "EnsembleTimes":
        """Times of `n` motions; ValueError where they are invalid."""
        begin, ends = _span(t_span)
        samples = real_numbers("t_eval", () if t_eval is None else t_eval, "s")
        if samples.ndim not in (1, 2):
            raise ValueError(f"t_eval has shape {samples.shape}: give (times,) or (n, times)")
        samples = np.atleast_2d(samples)
        for name, array in (("t_span[1]", ends), ("t_eval", samples)):
            if len(array) not in (1, n):
                raise ValueError(f"{name} has {len(array)} rows, but y0 has {n} motions")
        if len(ends) > 1 and (ends < begin).any() and (ends > begin).any():
            raise ValueError("t_span has ends before and after its start: integrate them apart")
        for k in range(max(len(ends), len(samples))) if samples.size else ():
            end = float(ends[k % len(ends)])
            validation.times(samples[k % len(samples)], (begin, end))
        return cls(begin, ends, samples)

    @property
    def span(self) -> tuple[float, float]:
        """The time span that includes those of all motions."""
        return self.begin, float(self.ends[np.argmax(np.abs(self.ends - self.begin))])

    @property
    def differ(self) -> bool:
        """Whether motions have different ends."""
        return len(self.ends) > 1

    def end(self, k: int) -> float:
        """The end of motion `k`."""
        return float(self.ends[k % len(self.ends)])

    def samples_of(self, k: int) -> Array:
        """The sample times of motion `k`."""
        return np.asarray(self.samples[k % len(self.samples)])


def _span(t_span: object) -> tuple[float, Array]:
    """Start, and end or ends."""
    if isinstance(t_span, list | tuple) and len(t_span) == 2 and np.ndim(t_span[1]) == 1:
        return real_number("t_span[0]", t_span[0], "s"), real_numbers("t_span[1]", t_span[1], "s")
    begin, end = validation.time_span(t_span)  # type: ignore[arg-type]  # checked there
    return begin, np.array([end])


#: Most motions of an ensemble that are shown side by side.
MOST_SHOWN = 12


@dataclass(frozen=True, repr=False)
class Ensemble(Playable):
    """The final states of many motions, their samples and events.

    Arrays of states have the component as their first axis, as those that generated functions
    take: ``module.energy_many(0.0, motions.y, params)``.

    Attributes
    ----------
    t, y : ndarray of shape (n,) and (state, n)
        Time in s at which each motion ended, coordinates and velocities there.
    growth : ndarray of shape (n,)
        In the variational form, natural logarithms of the ratio of the length of the
        linear perturbation at the end to that at the start, of any size; else NaN.
    samples : ndarray of shape (state, n, times)
        States at the requested times; NaN after a motion's end.
    t_events : ndarray of shape (n, events, occurrences)
        Times in s of the first occurrences of each event, of those not skipped; NaN where there
        were fewer.
    y_events : ndarray of shape (state, n, events, occurrences)
        States at these times.
    occurred : ndarray of shape (n, events)
        How often each event occurred, skipped occurrences included.
    status : ndarray of shape (n,)
        How each ended, a `Status`.
    steps, rejected, nfev : ndarray of shape (n,)
        As in `Solution`, of each motion.
    run, units
        As in `Solution`.
    t_eval : ndarray of shape (times,) or (n, times)
        The requested times in s; a row for each motion where these differ.
    error_estimate : ndarray of shape (n,) or None
        Largest estimated error of the returned states of each motion, if an accuracy is requested.
    alone : callable or None
        Integrates the motion of an index again, with the end of every step.

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> from solvers import ensemble
    >>> motions = ensemble(sp, (0, 5), {"theta": [0.5, 1.0]}, {}, method="rk4", h=0.01)
    >>> motions.y.shape, bool(motions.success.all())
    ((2, 2), True)
    """

    t: Array
    y: Array
    growth: Array
    samples: Array
    t_events: Array
    y_events: Array
    occurred: NDArray[np.int64]
    status: NDArray[np.object_]
    steps: NDArray[np.int64]
    rejected: NDArray[np.int64]
    nfev: NDArray[np.int64]
    run: str
    units: Mapping[str, str]
    t_eval: Array
    error_estimate: Array | None = None
    alone: Callable[[int], Solution] | None = field(default=None, compare=False)

    @classmethod
    def empty(
        cls, problem: Problem, n: int, occurrences: int, backend: str, t_eval: Array
    ) -> "Ensemble":
        """An ensemble of `n` motions of `problem` without results; `t_eval` has 1 or n rows."""
        state, events = len(problem.units), len(problem.events)
        unknown = partial(np.full, fill_value=np.nan)
        return cls(
            t=unknown(n),
            y=unknown((n, state)).T,  # in memory the states of a motion are adjacent
            growth=unknown(n),
            samples=np.moveaxis(unknown((n, state, t_eval.shape[1])), 1, 0),
            t_events=unknown((n, events, occurrences)),
            y_events=np.moveaxis(unknown((n, events, occurrences, state)), -1, 0),
            occurred=np.zeros((n, events), np.int64),
            status=np.full(n, Status.INTERRUPTED, object),
            steps=np.zeros(n, np.int64),
            rejected=np.zeros(n, np.int64),
            nfev=np.zeros(n, np.int64),
            run=f"{problem.description}, {backend}",
            units=problem.units,
            t_eval=t_eval if len(t_eval) > 1 else t_eval[0],
        )

    def __getstate__(self) -> dict[str, Any]:
        """The attributes to copy or send to other processes, which modules cannot be."""
        return {name: value for name, value in vars(self).items() if name != "alone"}

    def motion(self, k: int) -> Solution:
        """Motion `k`, integrated again, with the states at the end of every step.

        Raises
        ------
        ValueError
            When there is no such motion; for an ensemble from a file or another process.
        """
        if self.alone is None:
            raise ValueError("a copied ensemble has no equations: integrate again")
        if not isinstance(k, int | np.integer) or not 0 <= k < len(self.t):
            raise ValueError(f"motion {k!r} must be a number from 0 to {len(self.t) - 1}")
        return self.alone(int(k))

    def sampled_motions(self) -> list[SampledMotion]:
        """All motions, up to a dozen, for pages, films and plots."""
        if len(self.t) > MOST_SHOWN:
            raise ValueError(
                f"{len(self.t)} motions are more than the {MOST_SHOWN} that can be shown side by "
                "side: choose some, as by motions.motion(0).play([motions.motion(1)])"
            )
        return [one for k in range(len(self.t)) for one in self.motion(k).sampled_motions()]

    @property
    def success(self) -> NDArray[np.bool_]:
        """Whether each motion reached the end, or a terminal event."""
        return np.asarray((self.status == Status.FINISHED) | (self.status == Status.EVENT))

    def __repr__(self) -> str:
        n, events, _ = self.t_events.shape
        counts = {status.name: int((self.status == status).sum()) for status in Status}
        ends = "".join(f", {number} {name}" for name, number in counts.items() if number)
        return (
            f"Ensemble: {counted(n, 'motion')}{ends}\n"
            f"  {counted(self.samples.shape[2], 'time')}, {counted(events, 'event')}, "
            f"{counted(self.steps.sum(), 'step')}, {self.rejected.sum()} rejected\n"
            f"  {self.run}\n"
            f"  state: {', '.join(self.units)}"
        )

    def to_table(self) -> Any:
        """The end of each motion in a row.

        A ``pandas.DataFrame`` where pandas is installed, else a dict of arrays.
        """
        return data_frame(self._columns())

    def _columns(self) -> dict[str, NDArray[Any]]:
        table = {"t": self.t, **dict(zip(self.units, self.y, strict=True))}
        growth = {} if np.isnan(self.growth).all() else {"growth": self.growth}
        status = np.array([status.name for status in self.status], dtype=str)
        counts = {"steps": self.steps, "rejected": self.rejected, "nfev": self.nfev}
        return {**table, **growth, "status": status, **counts}

    def to_xarray(self) -> Any:
        """An ``xarray.Dataset``; its dimensions are component, motion, time, event, occurrence."""
        events = ("motion", "event", "occurrence")
        times = ("motion", "time")[-self.t_eval.ndim :]
        table = {k: ("motion", v) for k, v in self._columns().items() if k not in self.units}
        variables = table | {
            "y": (("component", "motion"), self.y),
            "samples": (("component", "motion", "time"), self.samples),
            "t_events": (events, self.t_events, {"units": "s"}),
            "y_events": (("component", *events), self.y_events),
            "occurred": (events[:2], self.occurred),
        }
        coordinates = {
            "component": list(self.units),
            "unit": ("component", list(self.units.values())),
            "time": (times, self.t_eval, {"units": "s"}),
        }
        return dataset(variables, coordinates, {"run": self.run})
