"""Geometry of a result: positions of masses, links between them, and the energy error."""

from collections.abc import Sequence

import numpy as np

from solvers.equations.energy import energy_unit
from solvers.equations.module import function, links
from solvers.io.notation import plain_symbol
from solvers.player.track import Coordinate, Links, Track
from solvers.scenes.run import SceneResult, energies

#: Largest relative change of a rod's length.
RIGID = 1e-6
#: Angles of view of motions in space: azimuth and elevation, in rad.
AZIMUTH, ELEVATION = 0.5, 0.45


def mass_positions(result: SceneResult) -> np.ndarray:
    """Positions in m of all masses that exist, shape (masses, axes, samples)."""
    scene = result.scene
    positions = np.asarray(scene.module.positions_many(result.t, result.y, scene.params))
    return positions[np.isfinite(positions).all(axis=(1, 2))]


def projected(positions: np.ndarray) -> np.ndarray:
    """Positions on the plane of view, shape (masses, 2, samples): unchanged in the plane."""
    if positions.shape[1] == 2:
        return positions
    x, y, z = np.moveaxis(positions, 1, 0)
    depth = np.cos(AZIMUTH) * y - np.sin(AZIMUTH) * x
    right = np.cos(AZIMUTH) * x + np.sin(AZIMUTH) * y
    return np.stack([right, np.cos(ELEVATION) * z + np.sin(ELEVATION) * depth], axis=1)


def links_and_points(result: SceneResult) -> tuple[Links, np.ndarray]:
    """Links, and points beyond the masses, shape (points, axes, samples).

    Links are those of the system. Of a system without them rods join masses to the one before, or
    the first to the origin, -1, at a constant distance, and a spring joins a single mass to the
    origin if its distance is a coordinate.
    """
    module, masses = result.scene.module, mass_positions(result)
    if not (stated := links(module)):
        return _default_links(result), np.empty((0, *masses.shape[1:]))
    points = function(module, "points_many")(result.t, result.y, result.scene.params)
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


def _default_links(result: SceneResult) -> Links:
    positions = mass_positions(result)
    lengths = np.linalg.norm(np.diff(positions, axis=0, prepend=0.0), axis=1)
    is_rigid = np.ptp(lengths, axis=1) <= RIGID * lengths.max(axis=1)
    rods = tuple(("rod", (k - 1, k)) for k in np.flatnonzero(is_rigid).tolist())
    if len(positions) != 1 or rods:
        return rods
    coordinates = result.y[: len(result.y) // 2]
    is_spring = any(np.allclose(lengths[0], coordinate, rtol=RIGID) for coordinate in coordinates)
    return (("spring", (-1, 0)),) if is_spring else ()


def energy_errors(results: Sequence[SceneResult]) -> tuple[list[np.ndarray], str]:
    """Energy errors of runs, each of shape (samples,), and the unit that they share.

    It is the name of the energy that they are relative to, or J where one run has none above rest.
    Energy that forces, friction and prescribed motions supply is no error.
    """
    kept = [energies(r.scene, r.t, r.y) - r.supplied_energy for r in results]
    units = [
        energy_unit(r.scene.module, r.scene.params, float(energy[0]))
        for r, energy in zip(results, kept, strict=True)
    ]
    is_relative = all(unit.is_relative for unit in units)
    errors = [
        (energy - energy[0]) / (unit.joules if is_relative else 1.0)
        for energy, unit in zip(kept, units, strict=True)
    ]
    return errors, units[0].name if is_relative else "J"


def coordinates(results: Sequence[SceneResult]) -> list[tuple[Coordinate, ...]]:
    """Coordinates over time that exist in all runs, of each run."""
    runs = []
    for result in results:
        module, n = result.scene.module, len(result.y) // 2
        rows = zip(module.COORDINATES, result.y[:n], result.y[n:], strict=True)
        runs.append(
            {
                name: Coordinate(plain_symbol(name), module.UNITS[name], values, rates)
                for name, values, rates in rows
                if np.isfinite([values, rates]).all()
            }
        )
    common = [name for name in runs[0] if all(name in run for run in runs)]
    return [tuple(run[name] for name in common) for run in runs]


def tracks(results: Sequence[SceneResult]) -> list[Track]:
    """The motions for the page that plays them, with the links between masses."""
    errors, unit = energy_errors(results)
    return [
        Track(r.scene.label, r.t, mass_positions(r), joined, error, unit, points, own)
        for r, error, own in zip(results, errors, coordinates(results), strict=True)
        for joined, points in [links_and_points(r)]
    ]
