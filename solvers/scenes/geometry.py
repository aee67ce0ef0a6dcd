"""Geometry of a result: positions of masses, rods and springs, and the energy error."""

import numpy as np

from solvers.equations.energy import energy_error, supplied_energy
from solvers.player.track import Pairs, Track
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


def rods_and_springs(result: SceneResult) -> tuple[Pairs, Pairs]:
    """Pairs of indices of joined masses, the previous mass first; -1 is the origin.

    Rods join neighbours at a constant distance, a spring a single mass whose distance from the
    origin is a coordinate.
    """
    positions = mass_positions(result)
    lengths = np.linalg.norm(np.diff(positions, axis=0, prepend=0.0), axis=1)
    is_rigid = np.ptp(lengths, axis=1) <= RIGID * lengths.max(axis=1)
    rods = tuple((k - 1, k) for k in np.flatnonzero(is_rigid).tolist())
    if len(positions) != 1 or rods:
        return rods, ()
    coordinates = result.y[: len(result.y) // 2]
    is_spring = any(np.allclose(lengths[0], coordinate, rtol=RIGID) for coordinate in coordinates)
    return (), ((-1, 0),) if is_spring else ()


def energy_errors(result: SceneResult) -> np.ndarray:
    """Energy errors relative to the energy above rest, shape (samples,)."""
    scene = result.scene
    energy = energies(scene, result.t, result.y)
    energy -= supplied_energy(scene.module, result.t, result.y, scene.params)
    return energy_error(scene.module, scene.params, energy)


def track(result: SceneResult) -> Track:
    """The motion for the page that plays it: masses joined by rods, or by springs."""
    view, joined = projected(mass_positions(result)), rods_and_springs(result)
    return Track(result.scene.label, result.t, view, *joined, energy_errors(result))
