"""A motion at sampled times, and its geometry: positions of masses, links, the energy error."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solvers.equations.energy import energy_unit
from solvers.equations.module import GeneratedModule, function, links
from solvers.io.figure_names import plain_symbol
from solvers.player.track import Array, CoordinateTrack, Links, Track

#: Samples per second of a motion, at least and at most.
RATE, FEWEST, MOST = 100, 501, 20_001
CURVES = re.compile(r"(\w+(?:, *\w+)*) +over +(\w+)\Z")


def sample_times(begin: float, end: float) -> Array:
    """Times in s that show a motion smoothly."""
    count = min(max(round(RATE * abs(end - begin)) + 1, FEWEST), MOST)
    return np.linspace(begin, end, count)


def curves_of(picture: str) -> tuple[list[str], str]:
    """The quantities of a picture and the one on its horizontal axis; empty for other text."""
    match = CURVES.match(picture)
    return (re.split(", *", match[1]), match[2]) if match else ([], "")


@dataclass(frozen=True)
class SampledMotion:
    """A motion at sampled times.

    Attributes
    ----------
    module : module
        The generated module of its system.
    params : sequence of float
        In the order of ``module.PARAMETERS``.
    t : ndarray of shape (n,)
        Increasing times in s.
    y : ndarray of shape (state, n)
        Coordinates and velocities; NaN for coordinates without inertia.
    title, label, note : str
        Of the whole picture, of this motion beside others, and a text below.
    pictures : tuple of str
        The pictures of a plot, such as ``theta1, theta2 over t``, ``path`` or ``energy``; by
        default all.
    energy : ndarray of shape (n,) or None
        Energy in J without that which forces, friction and prescribed motions have supplied since
        the start, which the motion keeps; None where it is not known.
    """

    module: GeneratedModule
    params: Sequence[float]
    t: Array
    y: Array
    title: str
    label: str
    note: str = ""
    pictures: tuple[str, ...] = ()
    energy: Array | None = None


#: Largest relative change of a rod's length.
RIGID = 1e-6
#: Angles of view of motions in space: azimuth and elevation, in rad.
AZIMUTH, ELEVATION = 0.5, 0.45


def mass_positions(motion: SampledMotion) -> np.ndarray:
    """Positions in m of all masses that exist, shape (masses, axes, samples)."""
    positions = np.asarray(motion.module.positions_many(motion.t, motion.y, motion.params))
    return positions[np.isfinite(positions).all(axis=(1, 2))]


def projected(positions: np.ndarray) -> np.ndarray:
    """Positions on the plane of view, shape (masses, 2, samples): unchanged in the plane."""
    if positions.shape[1] == 2:
        return positions
    x, y, z = np.moveaxis(positions, 1, 0)
    depth = np.cos(AZIMUTH) * y - np.sin(AZIMUTH) * x
    right = np.cos(AZIMUTH) * x + np.sin(AZIMUTH) * y
    return np.stack([right, np.cos(ELEVATION) * z + np.sin(ELEVATION) * depth], axis=1)


def links_and_points(motion: SampledMotion) -> tuple[Links, np.ndarray]:
    """Links, and points beyond the masses, shape (points, axes, samples).

    Links are those of the system. Of a system without them rods join masses to the one before, or
    the first to the origin, -1, at a constant distance, and a spring joins a single mass to the
    origin if its distance is a coordinate.
    """
    module, masses = motion.module, mass_positions(motion)
    if not (stated := links(module)):
        return _default_links(motion), np.empty((0, *masses.shape[1:]))
    points = function(module, "points_many")(motion.t, motion.y, motion.params)
    numbers: dict[int, int] = {}
    others: list[np.ndarray] = []
    for k, point in enumerate(points):
        if same := [n for n, mass in enumerate(masses) if np.array_equal(mass, point)]:
            numbers[k] = same[0]
        elif np.isfinite(point).all():  # else it is that of an absent mass
            numbers[k] = len(masses) + len(others)
            others.append(point)
    kept = ((kind, ends) for kind, ends in stated if {*ends} <= {*numbers})
    numbered = tuple((kind, tuple(numbers[end] for end in ends)) for kind, ends in kept)
    return numbered, np.reshape(others, (len(others), *masses.shape[1:]))


def _default_links(motion: SampledMotion) -> Links:
    positions = mass_positions(motion)
    lengths = np.linalg.norm(np.diff(positions, axis=0, prepend=0.0), axis=1)
    is_rigid = np.ptp(lengths, axis=1) <= RIGID * lengths.max(axis=1)
    rods = tuple(("rod", (k - 1, k)) for k in np.flatnonzero(is_rigid).tolist())
    if len(positions) != 1 or rods:
        return rods
    coordinates = motion.y[: len(motion.y) // 2]
    is_spring = any(np.allclose(lengths[0], coordinate, rtol=RIGID) for coordinate in coordinates)
    return (("spring", (-1, 0)),) if is_spring else ()


def energy_errors(motions: Sequence[SampledMotion]) -> tuple[list[np.ndarray | None], str]:
    """Energy errors of motions, each of shape (samples,), and the unit that they share.

    It is the name of the energy that they are relative to, or J where one motion has none above
    rest. An error is None where the energy is not known.
    """
    units = [
        energy_unit(one.module, one.params, float(one.energy[0]))
        for one in motions
        if one.energy is not None
    ]
    is_relative = all(unit.is_relative for unit in units)
    joules = iter(units)
    errors = [
        None
        if one.energy is None
        else (one.energy - one.energy[0]) / (next(joules).joules if is_relative else 1.0)
        for one in motions
    ]
    return errors, units[0].name if units and is_relative else "J"


def coordinates(motions: Sequence[SampledMotion]) -> list[tuple[CoordinateTrack, ...]]:
    """Coordinates over time that exist in all runs, of each run."""
    runs = []
    for motion in motions:
        module, n = motion.module, len(motion.y) // 2
        rows = zip(module.COORDINATES, motion.y[:n], motion.y[n:], strict=True)
        runs.append(
            {
                name: CoordinateTrack(plain_symbol(name), module.UNITS[name], values, rates)
                for name, values, rates in rows
                if np.isfinite([values, rates]).all()
            }
        )
    common = [name for name in runs[0] if all(name in run for run in runs)]
    return [tuple(run[name] for name in common) for run in runs]


def tracks(motions: Sequence[SampledMotion]) -> list[Track]:
    """The motions for the page that plays them, with the links between masses."""
    errors, unit = energy_errors(motions)
    return [
        Track(one.label, one.t, mass_positions(one), joined, error, unit, points, own)
        for one, error, own in zip(motions, errors, coordinates(motions), strict=True)
        for joined, points in [links_and_points(one)]
    ]
