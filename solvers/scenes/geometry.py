"""Geometry of a result: positions of masses, rods and springs, and the energy error."""

from __future__ import annotations

import numpy as np

from solvers.equations.energy import energy_error, supplied_energy
from solvers.player.track import Track
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


def links(result: SceneResult, positions: np.ndarray) -> list[tuple[int, int]]:
    """Pairs of indices of joined masses, the previous mass first; -1 is the origin."""
    # neighbours at a constant distance, or a single mass whose distance is a coordinate
    pairs = []
    previous = np.zeros(positions.shape[1:])
    for k, position in enumerate(positions):
        if is_rigid(previous, position):
            pairs.append((k - 1, k))
        previous = position
    if len(positions) == 1 and not pairs:
        length = np.linalg.norm(positions[0], axis=0)
        coordinates = result.y[: len(result.y) // 2]
        if any(np.allclose(length, coordinate, rtol=RIGID) for coordinate in coordinates):
            pairs.append((-1, 0))
    return pairs


def is_rigid(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether the distance of two masses is constant; positions have the shape (axes, samples)."""
    length = np.linalg.norm(other - one, axis=0)
    return bool(np.ptp(length) <= RIGID * length.max())


def energy_errors(result: SceneResult) -> np.ndarray:
    """Energy errors relative to the energy above rest, shape (samples,)."""
    scene = result.scene
    energy = energies(scene, result.t, result.y)
    energy -= supplied_energy(scene.module, result.t, result.y, scene.params)
    return energy_error(scene.module, scene.params, energy)


def track(result: SceneResult) -> Track:
    """The motion for the page that plays it: masses joined by rods, or by springs."""
    positions = mass_positions(result)
    rods: list[tuple[int, int]] = []
    springs: list[tuple[int, int]] = []
    for a, b in links(result, positions):
        start = positions[a] if a >= 0 else np.zeros_like(positions[b])
        (rods if is_rigid(start, positions[b]) else springs).append((a, b))
    joined = (tuple(rods), tuple(springs))
    return Track(result.scene.label, result.t, projected(positions), *joined, energy_errors(result))
