"""What is seen of a motion: where its masses are, what joins them, and its energy's error."""

from __future__ import annotations

import numpy as np

from solvers.equations.energy import energy_error, supplied_energy
from solvers.player.track import Track
from solvers.scenes.run import SceneResult, energies

#: Lengths that differ by less are those of rods.
RIGID = 1e-6
#: How far around and from above motions in space are looked at, in rad.
AROUND, ABOVE = 0.5, 0.45


def places(result: SceneResult) -> np.ndarray:
    """Positions in m of the masses that there are, shape (masses, axes, samples)."""
    found = np.asarray(result.scene.module.positions_many(result.t, result.y, result.scene.params))
    return found[np.isfinite(found).all(axis=(1, 2))]


def projected(positions: np.ndarray) -> np.ndarray:
    """Positions as they are seen: in the plane as they are.

    In space from above and from the side, without perspective.

    Parameters
    ----------
    positions : ndarray of shape (masses, axes, samples)
        In m, with 2 or 3 axes.

    Returns
    -------
    ndarray of shape (masses, 2, samples)
        In m, to the right and up.
    """
    if positions.shape[1] == 2:
        return positions
    x, y, z = np.moveaxis(positions, 1, 0)
    depth = np.cos(AROUND) * y - np.sin(AROUND) * x
    right = np.cos(AROUND) * x + np.sin(AROUND) * y
    return np.stack([right, np.cos(ABOVE) * z + np.sin(ABOVE) * depth], axis=1)


def links(result: SceneResult, positions: np.ndarray) -> list[tuple[int, int]]:
    """Which masses are joined, by their numbers; -1 is the origin.

    Neighbours that keep their distance are, and a single mass whose distance from the origin
    is a coordinate.

    Parameters
    ----------
    result : SceneResult
        The motion, with its coordinates.
    positions : ndarray of shape (masses, axes, samples)
        Its masses' `places` in m.

    Returns
    -------
    list of pairs of int
        In the order of the masses, the one before it first.
    """
    joined = []
    before = np.zeros(positions.shape[1:])
    for k, place in enumerate(positions):
        if is_rigid(before, place):
            joined.append((k - 1, k))
        before = place
    if len(positions) == 1 and not joined:
        length = np.linalg.norm(positions[0], axis=0)
        coordinates = result.y[: len(result.y) // 2]
        if any(np.allclose(length, coordinate, rtol=RIGID) for coordinate in coordinates):
            joined.append((-1, 0))
    return joined


def is_rigid(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether two masses keep their distance; positions have the shape (axes, samples)."""
    length = np.linalg.norm(other - one, axis=0)
    return bool(np.ptp(length) <= RIGID * length.max())


def energy_errors(result: SceneResult) -> np.ndarray:
    """Energy errors in parts of the energy above rest, shape (samples,)."""
    scene = result.scene
    kept = energies(scene, result.t, result.y)
    kept -= supplied_energy(scene.module, result.t, result.y, scene.params)
    return energy_error(scene.module, scene.params, kept)


def track(result: SceneResult) -> Track:
    """Masses, joined by rods or, where lengths change, springs."""
    positions = places(result)
    rods: list[tuple[int, int]] = []
    springs: list[tuple[int, int]] = []
    for a, b in links(result, positions):
        start = positions[a] if a >= 0 else np.zeros_like(positions[b])
        (rods if is_rigid(start, positions[b]) else springs).append((a, b))
    return Track(
        result.scene.label, result.t, projected(positions), tuple(rods), tuple(springs),
        energy_errors(result),
    )  # fmt: skip
