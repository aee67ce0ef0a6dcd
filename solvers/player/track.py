"""A run of a system for the page that plays it: sampled positions and energy errors."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import floor, log10

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: Kinds of links, and numbers of the points that each joins.
Links = tuple[tuple[str, tuple[int, ...]], ...]
#: Fewest points of each kind: a ring or wheel has a centre and two points of its rim, a quarter
#: turn apart, the first of which a wheel's spoke meets.
KINDS = {"rod": 2, "thread": 2, "spring": 2, "rail": 2, "plate": 3, "ring": 3, "wheel": 3}

#: More samples make a page slow without a visible difference.
MOST_SAMPLES = 20_000


@dataclass(frozen=True)
class CoordinateTrack:
    """A coordinate of a run over time.

    Attributes
    ----------
    label, unit : str
        Such as ``"θ₁"`` and ``"rad"``.
    values, rates : ndarray of shape (n,)
        The coordinate, and its rate of change per second.
    """

    label: str
    unit: str
    values: Array
    rates: Array


@dataclass(frozen=True)
class Track:
    """Positions of masses and energy errors of one run; a `Page` checks it.

    Attributes
    ----------
    label : str
        Label of the run, such as ``"rk4, h = 0.05 s"``.
    t : ndarray of shape (n,)
        Increasing times in s, two at least.
    positions : ndarray of shape (masses, axes, n)
        In m: (x, up) in the plane, (x, y, up) in space.
    links : tuple of pairs of str and tuple of int
        A kind, one of `KINDS`, and numbers of the points that it joins: the masses, then `points`.
        The number -1 is the pivot, which is the origin.
    energy_error : ndarray of shape (n,) or None
        Energy error, with its sign; None where the energy is not known.
    energy_unit : str
        Its unit ``"J"``, or the name of the energy that it is relative to, such as ``"energy above
        rest"``.
    points : ndarray of shape (points, axes, n), optional
        Further points of links, in m.
    coordinates : tuple of Coordinate, optional
        Shown over time and in the phase plane; the same ones in all runs of a page.
    """

    label: str
    t: Array
    positions: Array
    links: Links
    energy_error: Array | None
    energy_unit: str
    points: Array = field(default_factory=lambda: np.empty((0, 2, 0)))
    coordinates: tuple[CoordinateTrack, ...] = ()

    def check(self) -> None:
        """Raise `ValueError` where this run cannot be played."""
        for mistake in self._mistakes():
            raise ValueError(f"track {self.label!r}: {mistake}")

    def _mistakes(self) -> Iterator[str]:
        """Mistakes with their remedies; those after the first may follow from it."""
        times, positions = np.shape(self.t), np.shape(self.positions)
        energy_error = np.zeros_like(self.t) if self.energy_error is None else self.energy_error
        errors = np.shape(energy_error)
        if len(times) != 1 or times[0] < 2:
            yield f"t has shape {times}, but it must be (n,) with n at least 2: give the times in s"
        n, masses = times[0], positions[0] if positions else 0
        axes = positions[1:2]
        if len(positions) != 3 or masses < 1 or axes not in [(2,), (3,)] or positions[2] != n:
            yield (
                f"positions has shape {positions}, but with {n} times it must be (masses, 2, {n}) "
                f"or (masses, 3, {n}): positions_many of a generated module gives that for y of "
                "shape (state, n)"
            )
        count = len(self.points)
        if count and self.points.shape[1:] != positions[1:]:
            text = f"points has shape {self.points.shape}, but positions {positions}"
            yield f"{text}: give as many axes and times"
        if errors != (n,):
            text = f"energy_error has shape {errors}, but with {n} times it must be ({n},)"
            yield f"{text}: give one number for each time"
        arrays = {"t": self.t, "positions": self.positions, "energy_error": energy_error}
        arrays["points"] = self.points
        for one in self.coordinates:
            named = {one.label: one.values, f"rate of {one.label}": one.rates}
            for name, array in named.items():
                if np.shape(array) != (n,):
                    text = f"{name} has shape {np.shape(array)}, but with {n} times it must be"
                    yield f"{text} ({n},): give one number for each time"
            arrays |= named
        for name, array in arrays.items():
            for index in np.argwhere(~np.isfinite(array)).tolist():
                text = f"{name}{index} is {np.asarray(array)[tuple(index)]}"
                remedy = "leave out the samples after the run failed"
                yield f"{text}, but every number must be finite: {remedy}"
        for k in np.flatnonzero(np.diff(self.t) <= 0).tolist():
            text = f"t[{k + 1}] = {self.t[k + 1]} follows t[{k}] = {self.t[k]}"
            remedy = "sort the samples by time, and keep one of equal ones"
            yield f"{text}, but times must increase: {remedy}"
        for kind, numbers in self.links:
            if kind not in KINDS:
                yield f"links has the kind {kind!r}: known are {', '.join(KINDS)}"
            elif len(numbers) < KINDS[kind]:
                yield f"links has a {kind} of points {numbers}: give {KINDS[kind]} at least"
            elif not all(-1 <= number < masses + count for number in numbers):
                yield (
                    f"links has a {kind} of points {numbers}: number the masses from 0 to "
                    f"{masses - 1}, further points after them, up to {masses + count - 1}, and "
                    "the pivot -1"
                )

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
            "links": [[kind, *numbers] for kind, numbers in self.links],
            "points": [[_or_constant(axis[indices]) for axis in point] for point in self.points],
            "coordinates": [
                [one.label, one.unit, *(_rounded(x[indices], 6) for x in (one.values, one.rates))]
                for one in self.coordinates
            ],
            "energy_error": (
                None if self.energy_error is None else _rounded(self.energy_error[indices], 5)
            ),
        }


def _or_constant(values: Array) -> list[float] | float:
    """Values of a point's component; one number for all, if it is fixed."""
    return _rounded(values[:1], 6)[0] if np.ptp(values) == 0 else _rounded(values, 6)


def _rounded(values: Array, digits: int) -> list[float]:
    return [float(f"{value:.{digits}g}") for value in values]
