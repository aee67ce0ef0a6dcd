"""Quadrature: time as an integral over one degree of freedom.

Between turning points a < b the phase φ with u = (a + b)/2 - (b - a)/2 cos φ increases without
bound, as does φ = ±u where u rotates. Time and rotation are dt/dφ = G, ds/dφ = S with G and S
smooth and periodic, so that their Fourier series converge faster than any power: the trapezoid
rule integrates them to rounding.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, Self

import numpy as np
import scipy
from numpy.typing import NDArray

from solvers.integration.accuracy.checked_motion import Array, Motion, OutsideDomainError
from solvers.scenes.models.model_catalogue import EPS, ClosedForm, rounding_error
from solvers.scenes.models.one_degree_of_freedom import ReducedMotion

#: Numbers of points of a period to try, and of points that are searched for turning points.
POINTS, SCAN = (32, 64, 128, 256, 512, 1024, 2048), 720
#: A series ends where its terms are below this part of the mean.
END = 1e-14
#: Part of a period over 2π: short enough for a derivative, long enough for its rounding.
INSTANT = 1e-5
#: Roundings of the start and of the energy; safety factor of the difference from a longer series.
FEW, MARGIN = 4, 2.0
#: Newton iterations from an interpolated phase.
ITERATIONS = 5
#: An inertia below this part of its largest value vanishes; energies in J above this are infinite.
VANISHING, LARGEST = 1e-12, 1e300
NO_SERIES = f"no Fourier series of {POINTS[-1]} points converges"


@dataclass(frozen=True)
class FourierSeries:
    """The integral of a periodic function: mean · φ and its Fourier series without the mean."""

    mean: float
    terms: NDArray[np.complex128]

    @classmethod
    def of(cls, values: Array) -> Self:
        """From values at φ = 2π (k + ½)/n."""
        n = len(values)
        order = np.arange(n // 2)
        terms = np.fft.rfft(values)[: n // 2] * np.exp(-1j * np.pi * order / n) * 2 / n
        return cls(float(values.mean()), terms[1:])

    @property
    def tail(self) -> float:
        """The largest of the last quarter of its terms."""
        return float(np.abs(self.terms[-len(self.terms) // 4 :]).max())

    def value(self, phi: Array) -> Array:
        """The function itself."""
        return self.mean + self._sum(phi, self.terms)

    def integral(self, phi: Array) -> Array:
        """Its integral, up to a constant."""
        order = np.arange(1, len(self.terms) + 1)
        return self.mean * phi + self._sum(phi, self.terms / (1j * order))

    @staticmethod
    def _sum(phi: Array, terms: NDArray[np.complex128]) -> Array:
        order = np.arange(1, len(terms) + 1)
        return (np.exp(1j * np.multiply.outer(phi, order)) @ terms).real


@dataclass(frozen=True)
class Path:
    """u = centre - amplitude cos φ; with amplitude 0, u = direction φ."""

    centre: float
    amplitude: float
    direction: float

    def u(self, phi: Array) -> Array:
        """The shape."""
        if self.amplitude:
            return self.centre - self.amplitude * np.cos(phi)
        return self.direction * phi

    def du(self, phi: Array) -> Array:
        """Its derivative with respect to φ."""
        return self.amplitude * np.sin(phi) if self.amplitude else np.full_like(phi, self.direction)


@dataclass(frozen=True)
class Orbit:
    """A motion of one degree of freedom: `time` and `rotation` are the series of G and S.

    `phase` is φ at the start; the error of the period is relative.
    """

    reduced: ReducedMotion
    path: Path
    time: FourierSeries
    rotation: FourierSeries
    phase: float
    period_error: float

    @cached_property
    def _table(self) -> tuple[Array, Array]:
        """Times and phases, for an interpolated phase."""
        phases = np.linspace(-np.pi, 3 * np.pi, 4 * len(self.time.terms))
        return self.time.integral(phases), phases

    def states(self, t: Array) -> Array:
        """Coordinates and velocities at times, shape (n, state)."""
        start = np.array(self.phase)
        elapsed = np.asarray(t, dtype=float) + self.time.integral(start)
        period = 2 * np.pi * self.time.mean
        periods = np.floor(elapsed / period)
        rest = elapsed - periods * period
        phi = np.interp(rest, *self._table)
        for _ in range(ITERATIONS):
            phi = phi - (self.time.integral(phi) - rest) / self.time.value(phi)
        rate = 1 / self.time.value(phi)
        s = self.rotation.integral(phi) + periods * 2 * np.pi * self.rotation.mean
        s += self.reduced.start[2] - self.rotation.integral(start)
        u = self.path.u(phi if self.path.amplitude else phi + periods * 2 * np.pi)
        s_dot = self.rotation.value(phi) * rate
        return self.reduced.states(u, self.path.du(phi) * rate, s, s_dot)


@dataclass(frozen=True)
class Quadrature(ClosedForm):
    """An orbit with the error of its series and of rounding."""

    name: ClassVar[str] = "quadrature"
    complexity: ClassVar[int] = 50
    applies_to: ClassVar[str] = (
        "reducible to one degree of freedom, by a cyclic coordinate or rotation: Fourier series"
    )
    error_source: ClassVar[str] = "a longer series; rounding"

    orbit: Orbit

    @classmethod
    def of(cls, motion: Motion) -> Self:
        """The orbit; `OutsideDomainError` where the shape rests, does not return, or no series."""
        reduced, times = ReducedMotion.of(motion), motion.sample_times
        result = orbit(reduced)

        def states(y0: Array) -> Array:
            return orbit(ReducedMotion.of(replace(motion, y0=tuple(y0)))).states(times)

        sizes = np.maximum(np.abs(motion.y0), 1.0)
        if not reduced.momentum:  # it is 0 exactly: next to it, poles are no barriers
            at_rest = np.array([*np.zeros(motion.n_coordinates), *reduced.rotation]) != 0
            sizes[at_rest & (np.array(motion.y0) == 0)] = 0.0
        error = rounding_error(states, motion.y0, sizes.tolist(), FEW)
        # the energy is a small difference of large ones where the motion is small
        largest = abs(reduced.energy) + abs(float(reduced.parts(np.array(reduced.start[0]))[1]))
        shifted = replace(reduced, energy=reduced.energy + FEW * EPS * largest)
        reference = result.states(times)
        error += np.abs(orbit(shifted).states(times) - reference)
        # a longer series has other roundings at other points, and a smaller remainder
        longer = orbit(reduced, 4 * (len(result.time.terms) + 1))
        error += MARGIN * np.abs(longer.states(times) - reference)
        # an error of the period is an error of the time
        later = INSTANT * result.time.mean
        change = np.abs(result.states(times + later) - reference)
        speed = change.max(axis=0) / later
        longest = max(motion.duration, 2 * np.pi * result.time.mean)
        error = error.max(axis=0) + speed * longest * result.period_error
        rotates = result.reduced.rotation.any()
        conserved = "a momentum and the energy are" if rotates else "energy is"
        why = f"{conserved} conserved, which leaves one degree of freedom"
        estimate = float(error[list(motion.requested)].max())
        return cls(result, error_estimate=estimate, why=why)

    def states(self, t: Array) -> Array:
        return self.orbit.states(t)


def orbit(reduced: ReducedMotion, n: int | None = None) -> Orbit:
    """The orbit of a motion by a series of `n` points, by default the first one that converges.

    `OutsideDomainError` where no Fourier series converges.
    """
    u, u_dot, _ = reduced.start
    ends = _turning_points(reduced)
    direction = float(np.sign(u_dot)) or 1.0
    if ends:
        a, b = ends
        path = Path((a + b) / 2, (b - a) / 2, direction)
        root = direction * np.sqrt(max((u - a) * (b - u), 0.0))
        phase = float(np.arctan2(root, path.centre - u))
    else:
        path, phase = Path(0.0, 0.0, direction), direction * u
    for count in POINTS if n is None else (n,):
        result, has_converged = _by_series(reduced, path, phase, count)
        if has_converged or n:
            return result
    raise OutsideDomainError(NO_SERIES)


def _by_series(reduced: ReducedMotion, path: Path, phase: float, n: int) -> tuple[Orbit, bool]:
    """The orbit by series of `n` points, and whether these converge."""
    phi = 2 * np.pi * (np.arange(n) + 0.5) / n
    u, du = path.u(phi), path.du(phi)
    mu, W, spin, drag = reduced.parts(u)
    kinetic = reduced.energy - W
    if not np.all(kinetic > 0):
        raise OutsideDomainError(NO_SERIES)
    G = np.abs(du) * np.sqrt(mu / (2 * kinetic))
    S = spin * G - drag * du
    time, rotation = FourierSeries.of(G), FourierSeries.of(S)
    # E - W, and the distance from a turning point, are known to rounding only
    lost = EPS * (abs(reduced.energy) + np.abs(W)) / kinetic
    centre, amplitude = path.centre, path.amplitude
    if amplitude:
        lost += EPS * (abs(centre) + amplitude) / (amplitude - np.abs(u - centre))
    end = END + 4 * lost.max() / n
    has_converged = time.tail <= end * time.mean and rotation.tail <= end * np.abs(S).max()
    # G changes by half the relative change of E - W
    period_error = (float((G * lost).mean()) / 2 + time.tail) / time.mean
    if amplitude:  # du = amplitude sin φ dφ; the square root of `orbit` rounds at turning points
        start, rate, _ = reduced.start
        phase = float(np.arctan2(rate * time.value(np.array(phase)), centre - start))
    return Orbit(reduced, path, time, rotation, phase, period_error), has_converged


def _turning_points(reduced: ReducedMotion) -> tuple[float, float] | None:
    """The turning points of u on both sides of the start, ascending; None if u rotates."""
    u = reduced.start[0]

    def kinetic(u: float) -> float:
        return float(np.clip(reduced.energy - reduced.parts(np.array(u))[1], -LARGEST, LARGEST))

    reach = 2 * np.pi if reduced.is_angle else 4 * max(abs(u), 1.0)
    steps = np.linspace(0, reach, SCAN + 1)[1:]
    ends = []
    for side in (-1.0, 1.0):
        points = _with_barriers(reduced, u + side * np.array([0.0, *steps]))[1:]
        values = reduced.energy - reduced.parts(points)[1]
        forbidden = np.flatnonzero(~(values > 0))
        if forbidden.size and forbidden[0] == 0 and kinetic(u) <= 0:
            ends.append(u)  # released at rest: the start is a turning point
        elif forbidden.size:
            outer = forbidden[0]
            inner = points[outer - 1] if outer else u
            if np.isnan(values[outer]):
                raise OutsideDomainError("the motion approaches a singularity")
            try:
                end = scipy.optimize.brentq(
                    kinetic, inner, points[outer], xtol=1e-300, rtol=4 * EPS
                )
            except RuntimeError as error:  # it converges to a pole of the potential at 0
                raise OutsideDomainError("the motion approaches a singularity") from error
            ends.append(float(end))
        elif not reduced.is_angle:
            raise OutsideDomainError("the motion does not return")
    if not ends:
        return None
    if len(ends) < 2 or ends[0] == ends[1]:
        raise OutsideDomainError("the shape is at rest")
    return ends[0], ends[1]


def _with_barriers(reduced: ReducedMotion, points: Array) -> Array:
    """`points`, and between them those where the inertia of the rotation vanishes.

    There W is infinite, however small L is: a barrier that may be narrower than the distance of the
    points.
    """
    if not reduced.momentum:
        return points

    def inertia(u: float | Array) -> Array:
        return np.abs(reduced.momentum / reduced.parts(np.array(u))[2])

    values, barriers = inertia(points), []
    for k in np.flatnonzero((values[1:-1] <= values[:-2]) & (values[1:-1] < values[2:])) + 1:
        bounds = np.sort(points[[k - 1, k + 1]])
        lowest = scipy.optimize.minimize_scalar(
            inertia, bounds=bounds, method="bounded", options={"xatol": 1e-12}
        )
        if lowest.fun < VANISHING * values.max():
            if reduced.energy - reduced.parts(np.array(lowest.x))[1] > 0:
                raise OutsideDomainError("the motion passes too close to a pole of its coordinates")
            barriers.append(float(lowest.x))
    order = np.sign(points[-1] - points[0])
    return np.array(sorted([*points, *barriers], key=lambda point: order * point))
