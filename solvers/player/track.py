"""A run of a system for the page that plays it: sampled positions and energy errors."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import floor, log10

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Pairs = tuple[tuple[int, int], ...]

#: More samples make a page slow without a visible difference.
MOST_SAMPLES = 20_000


@dataclass(frozen=True)
class Track:
    """Positions of masses and energy errors of one run; a `Page` checks it.

    Attributes
    ----------
    label : str
        Label of the run, such as ``"rk4, h = 0.05 s"``.
    t : ndarray of shape (n,)
        Increasing times in s, two at least.
    positions : ndarray of shape (masses, 2, n)
        In m; x points to the right and y up.
    links : tuple of pairs of int
        Indices of masses that a rod joins; -1 is the pivot, which is the origin.
    springs : tuple of pairs of int
        Indices of masses that a spring joins, likewise.
    energy_error : ndarray of shape (n,)
        Energy error, with its sign.
    energy_unit : str
        Its unit ``"J"``, or the name of the energy that it is relative to, such as ``"energy above
        rest"``.
    """

    label: str
    t: Array
    positions: Array
    links: Pairs
    springs: Pairs
    energy_error: Array
    energy_unit: str

    def check(self) -> None:
        """Raise `ValueError` where this run cannot be played."""
        for mistake in self._mistakes():
            raise ValueError(f"track {self.label!r}: {mistake}")

    def _mistakes(self) -> Iterator[str]:
        """Mistakes with their remedies; those after the first may follow from it."""
        times, positions, errors = map(np.shape, (self.t, self.positions, self.energy_error))
        if len(times) != 1 or times[0] < 2:
            yield f"t has shape {times}, but it must be (n,) with n at least 2: give the times in s"
        n, masses = times[0], positions[0] if positions else 0
        if len(positions) != 3 or masses < 1 or positions[1:] != (2, n):
            yield (
                f"positions has shape {positions}, but with {n} times it must be (masses, 2, {n}): "
                "positions_many of a generated module gives that for y of shape (state, n)"
            )
        if errors != (n,):
            text = f"energy_error has shape {errors}, but with {n} times it must be ({n},)"
            yield f"{text}: give one number for each time"
        arrays = {"t": self.t, "positions": self.positions, "energy_error": self.energy_error}
        for name, array in arrays.items():
            for index in np.argwhere(~np.isfinite(array)).tolist():
                text = f"{name}{index} is {np.asarray(array)[tuple(index)]}"
                remedy = "leave out the samples after the run failed"
                yield f"{text}, but every number must be finite: {remedy}"
        for k in np.flatnonzero(np.diff(self.t) <= 0).tolist():
            text = f"t[{k + 1}] = {self.t[k + 1]} follows t[{k}] = {self.t[k]}"
            remedy = "sort the samples by time, and keep one of equal ones"
            yield f"{text}, but times must increase: {remedy}"
        for name, pairs in (("links", self.links), ("springs", self.springs)):
            for pair in pairs:
                if len(pair) != 2 or not all(-1 <= end < masses for end in pair):
                    text = f"{name} holds {pair}, but a pair joins two of the masses"
                    remedy = "number the masses as in positions"
                    yield f"{text} 0 to {masses - 1} and the pivot, -1: {remedy}"

    def json_values(self) -> dict[str, object]:
        """Values for JSON, with no more samples and digits than a screen can show."""
        n = len(self.t)
        indices = np.linspace(0, n - 1, min(n, MOST_SAMPLES)).round().astype(int)
        # late times differ in late digits only, so that the duration determines the rounding
        decimals = 6 - floor(log10(self.t[-1] - self.t[0]))
        return {
            "label": self.label,
            "t": [round(time, decimals) for time in self.t[indices].tolist()],
            "positions": [[_rounded(axis[indices], 6) for axis in mass] for mass in self.positions],
            "links": [list(pair) for pair in self.links],
            "springs": [list(pair) for pair in self.springs],
            "energy_error": _rounded(self.energy_error[indices], 5),
        }


def _rounded(values: Array, digits: int) -> list[float]:
    return [float(f"{value:.{digits}g}") for value in values]
