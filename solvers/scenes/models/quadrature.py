"""Quadrature: time as an integral over the one degree of freedom that is left.

Between turning points a < b the phase φ with u = (a + b)/2 - (b - a)/2 cos φ goes on for ever, as
does φ = ±u where u turns over and over. Time and turn are dt/dφ = G, ds/dφ = S with G and S
smooth and periodic, so that their Fourier series converge faster than any power: the trapezoid
rule integrates them to rounding.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.optimize import brentq

from solvers.scenes.models.fourier import Series
from solvers.scenes.models.model import (
    EPS,
    ROUNDINGS,
    Array,
    Motion,
    OutsideDomainError,
    rounding_error,
)
from solvers.scenes.models.one_degree_of_freedom import EnergyForm, energy_form

#: How many points of a period are tried, and how many are looked at for turning points.
FEWEST, MOST, SCAN = 32, 2048, 720
#: A series ends where its terms are so small, in parts of the first.
END = 1e-14
#: In parts of a period over 2π: short enough for rates, long enough not to be rounding.
INSTANT = 1e-5
#: Newton's steps from an interpolated phase.
ITERATIONS = 5


@dataclass(frozen=True)
class Orbit:
    """A motion of one degree of freedom by its phase.

    Attributes
    ----------
    form : EnergyForm
        What moves.
    middle, half : float
        u = middle - half cos φ; a half of 0 stands for u = direction φ.
    direction : float
        Direction of a motion that turns over.
    time, turn : Series
        G and S.
    phase : float
        φ at the beginning.
    period_error : float
        By how much of itself a period may be wrong.
    place_error, rate_error : float
        By how much turning points and velocities may be wrong.
    """

    form: EnergyForm
    middle: float
    half: float
    direction: float
    time: Series
    turn: Series
    phase: float
    period_error: float
    place_error: float
    rate_error: float

    @cached_property
    def _guesses(self) -> tuple[Array, Array]:
        """Times and phases between which a phase is sought."""
        phases = np.linspace(-np.pi, 3 * np.pi, 4 * len(self.time.terms))
        return self.time.integral(phases), phases

    def states(self, t: Array) -> Array:
        """Coordinates and velocities at times, shape (n, state)."""
        elapsed = np.asarray(t, dtype=float) + self.time.integral(np.array(self.phase))
        period = 2 * np.pi * self.time.mean
        whole = np.floor(elapsed / period)
        rest = elapsed - whole * period
        phi = np.interp(rest, *self._guesses)
        for _ in range(ITERATIONS):
            phi = phi - (self.time.integral(phi) - rest) / self.time.value(phi)
        rate = 1 / self.time.value(phi)
        s = self.turn.integral(phi) + whole * 2 * np.pi * self.turn.mean
        s += self.form.start[2] - self.turn.integral(np.array(self.phase))
        if self.half:
            u, slope = self.middle - self.half * np.cos(phi), self.half * np.sin(phi)
        else:
            u, slope = (
                self.direction * (phi + whole * 2 * np.pi),
                np.full_like(phi, self.direction),
            )
        return self.form.states(u, slope * rate, s, self.turn.value(phi) * rate)


@dataclass(frozen=True)
class Quadrature:
    """An orbit with its error."""

    orbit: Orbit
    error_estimate: float
    why: str
    name: str = "quadrature"

    def states(self, t: Array) -> Array:
        """Coordinates and velocities at times, shape (n, state)."""
        return self.orbit.states(t)


def quadrature(asked: Motion) -> Quadrature:
    """The orbit, with the error of its series and of rounding.

    Parameters
    ----------
    asked : Motion
        The motion.

    Returns
    -------
    Quadrature

    Raises
    ------
    OutsideDomainError
        When more than one degree of freedom is left, or that one rests or does not come
        back, or no series converges.
    """
    form = energy_form(asked)
    found = orbit(form)
    times = asked.looks

    def states(y0: Array) -> Array:
        return orbit(energy_form(replace(asked, y0=tuple(y0)))).states(times)

    sizes = [max(abs(component), 1.0) for component in asked.y0]
    error = rounding_error(states, asked.y0, sizes)
    # a wrong period is a wrong time
    here = found.states(times)
    later = INSTANT * found.time.mean
    speed = np.abs(found.states(times + later) - here).max(axis=0) / later
    error = error.max(axis=0) + speed * asked.duration * found.period_error
    quick = max(1.0, 1 / found.time.mean)
    error += ROUNDINGS * (found.place_error * quick + found.rate_error)
    kept = "angular momentum and energy are kept" if form.turn.any() else "energy is kept"
    return Quadrature(found, float(error[list(asked.wanted)].max()),
                      f"{kept}, one degree of freedom is left")  # fmt: skip


def orbit(form: EnergyForm) -> Orbit:
    """The series of a motion.

    Parameters
    ----------
    form : EnergyForm
        The motion.

    Returns
    -------
    Orbit

    Raises
    ------
    OutsideDomainError
        When the motion does not come back, or rests, or no series of `MOST` points
        converges.
    """
    u, u_dot, _ = form.start
    ends = _turning_points(form)
    direction = float(np.sign(u_dot)) or 1.0
    middle = half = 0.0
    if ends:
        a, b = ends
        middle, half = (a + b) / 2, (b - a) / 2
        phase = float(np.arctan2(direction * np.sqrt(max((u - a) * (b - u), 0.0)), middle - u))
    else:
        phase = direction * u
    n = FEWEST
    while n <= MOST:
        phi = 2 * np.pi * (np.arange(n) + 0.5) / n
        where = middle - half * np.cos(phi) if half else direction * phi
        slope = half * np.sin(phi) if half else np.full_like(phi, direction)
        mu, W, spin, drag = form.parts(where)
        kinetic = form.energy - W
        if not np.all(kinetic > 0):
            break
        G = np.abs(slope) * np.sqrt(mu / (2 * kinetic))
        S = spin * G - drag * slope
        time, turn = Series.of(G), Series.of(S)
        # what cancels in E - W, and between a place and a turning point, is known to rounding only
        lost = EPS * (abs(form.energy) + np.abs(W)) / kinetic
        if half:
            lost += EPS * (abs(middle) + half) / (half - np.abs(where - middle))
        noise = 4 * lost.max() / n
        if time.tail <= (END + noise) * time.mean and turn.tail <= (END + noise) * np.abs(S).max():
            period = float((G * lost).mean() / time.mean) + time.tail / time.mean
            # next to a turning point E - W falls in proportion to the distance from it
            reach = min(half - abs(where[k] - middle) for k in (0, n // 2)) if half else 0.0
            place = float(max(lost[0], lost[n // 2]) * abs(reach))
            rate = float((lost * (np.abs(slope) + np.abs(S)) / G).max())
            return Orbit(form, middle, half, direction, time, turn, phase, period, place, rate)
        n *= 2
    raise OutsideDomainError(f"no Fourier series of {MOST} points converges")


def _turning_points(form: EnergyForm) -> tuple[float, float] | None:
    """Where u turns back, on both sides of the beginning; None if it turns over.

    Parameters
    ----------
    form : EnergyForm
        The motion.

    Returns
    -------
    pair of float or None
        The lower one first, in the unit of u.

    Raises
    ------
    OutsideDomainError
        When the motion does not come back, or rests.
    """
    u, u_dot, _ = form.start

    def kinetic(place: float) -> float:
        return float(form.energy - form.parts(np.array(place))[1])

    reach = 2 * np.pi if form.is_angle else 4 * max(abs(u), 1.0)
    steps = np.linspace(0, reach, SCAN + 1)[1:]
    ends = []
    for side in (-1.0, 1.0):
        places = u + side * steps
        values = form.energy - form.parts(places)[1]
        fallen = np.flatnonzero(~(values > 0))
        if not u_dot and fallen.size and fallen[0] == 0:
            ends.append(u)  # released at rest: the beginning is a turning point
        elif fallen.size:
            inner = places[fallen[0] - 1] if fallen[0] else u
            if not np.isfinite(values[fallen[0]]):
                raise OutsideDomainError("the motion runs into a singular place")
            ends.append(float(brentq(kinetic, inner, places[fallen[0]], xtol=1e-300, rtol=4 * EPS)))
        elif not form.is_angle:
            raise OutsideDomainError("the motion does not come back")
    if not ends:
        return None
    if len(ends) < 2 or ends[0] == ends[1]:
        raise OutsideDomainError("the shape rests")
    return ends[0], ends[1]
