"""Ends and sample times of many motions: the same for all, or different for each."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from solvers.equations.number_checks import real_number, real_numbers
from solvers.integration.problem import validation
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
