"""Geometry of a result: positions of masses, rods and springs, and the energy error."""

from collections.abc import Sequence

import numpy as np

from solvers.equations.energy import energy_unit
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


def tracks(results: Sequence[SceneResult]) -> list[Track]:
    """The motions for the page that plays them: masses joined by rods, or by springs."""
    errors, unit = energy_errors(results)
    return [
        Track(r.scene.label, r.t, projected(mass_positions(r)), *rods_and_springs(r), error, unit)
        for r, error in zip(results, errors, strict=True)
    ]
