"""What the page plays: one run of a system, sampled."""

from __future__ import annotations

from dataclasses import dataclass
from math import floor, log10

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Pairs = tuple[tuple[int, int], ...]

#: More samples than this make a page slow and show nothing more.
MOST_SAMPLES = 20_000


@dataclass(frozen=True)
class Track:
    """One run: where its masses were, and how well it kept its energy.

    It may hold anything: `check` says whether it can be played, and a `Page` asks.

    Attributes
    ----------
    label : str
        Which run, such as ``"rk4, h = 0.05 s"``.
    t : ndarray of shape (n,)
        Increasing times in s, two at least.
    positions : ndarray of shape (masses, 2, n)
        In m; x points to the right and y up.
    links : tuple of pairs of int
        What a rod joins: numbers of masses; -1 is the pivot, which is the origin.
    springs : tuple of pairs of int
        What a spring joins, likewise.
    energy_error : ndarray of shape (n,)
        Relative energy error, with its sign.
    """

    label: str
    t: Array
    positions: Array
    links: Pairs
    springs: Pairs
    energy_error: Array

    def check(self) -> None:
        """Nothing, if this can be played.

        Raises
        ------
        ValueError
            When shapes disagree, a number is not finite, times do not increase, or a
            rod or spring ends at no mass.
        """
        self._check_shapes()
        self._check_numbers()
        masses = len(self.positions)
        for name, pairs in (("links", self.links), ("springs", self.springs)):
            for pair in pairs:
                if len(pair) != 2 or not all(-1 <= end < masses for end in pair):
                    raise self._refusal(
                        f"{name} holds {pair}, but a pair joins two of the masses 0 to "
                        f"{masses - 1} and the pivot, -1: number the masses as in positions"
                    )

    def _check_shapes(self) -> None:
        times, places, errors = (
            np.shape(array) for array in (self.t, self.positions, self.energy_error)
        )
        if len(times) != 1 or times[0] < 2:
            raise self._refusal(
                f"t has shape {times}, but it must be (n,) with n at least 2: give the times in s"
            )
        n = times[0]
        if len(places) != 3 or places[0] < 1 or places[1:] != (2, n):
            raise self._refusal(
                f"positions has shape {places}, but with {n} times it must be (masses, 2, {n}): "
                "positions_many of a generated module gives that for y of shape (state, n)"
            )
        if errors != (n,):
            raise self._refusal(
                f"energy_error has shape {errors}, but with {n} times it must be ({n},): "
                "give one number for each time"
            )

    def _check_numbers(self) -> None:
        for name in ("t", "positions", "energy_error"):
            array = np.asarray(getattr(self, name))
            wrong = np.argwhere(~np.isfinite(array))
            if len(wrong):
                place = tuple(int(k) for k in wrong[0])
                raise self._refusal(
                    f"{name}[{', '.join(map(str, place))}] is {array[place]}, but every number "
                    "must be finite: leave out the samples after the run broke down"
                )
        (falls,) = np.nonzero(np.diff(self.t) <= 0)
        if len(falls):
            k = int(falls[0])
            raise self._refusal(
                f"t[{k + 1}] = {self.t[k + 1]} follows t[{k}] = {self.t[k]}, but times must "
                "increase: sort the samples by time, and keep one of equal ones"
            )

    def _refusal(self, words: str) -> ValueError:
        return ValueError(f"track {self.label!r}: {words}")

    def plain(self) -> dict[str, object]:
        """The run as JSON has it: no more samples and digits than a screen can show."""
        n = len(self.t)
        kept = np.arange(n)
        if n > MOST_SAMPLES:
            kept = np.linspace(0, n - 1, MOST_SAMPLES).round().astype(int)
        return {
            "label": self.label,
            # late times differ in late digits only: what counts is how long the run lasts
            "t": [
                round(time, 6 - floor(log10(self.t[-1] - self.t[0])))
                for time in self.t[kept].tolist()
            ],
            "positions": [[_rounded(axis[kept], 6) for axis in mass] for mass in self.positions],
            "links": [list(pair) for pair in self.links],
            "springs": [list(pair) for pair in self.springs],
            "energy_error": _rounded(self.energy_error[kept], 5),
        }


def _rounded(values: Array, digits: int) -> list[float]:
    return [float(f"{value:.{digits}g}") for value in values]
