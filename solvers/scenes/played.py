"""What the page plays of an answer."""

from __future__ import annotations

import numpy as np

from solvers.player.track import Track
from solvers.scenes.geometry import energy_errors, is_rigid, links, places, projected
from solvers.scenes.run import Answer


def track(answer: Answer) -> Track:
    """Masses, joined by rods or, where lengths change, springs."""
    positions = places(answer)
    rods: list[tuple[int, int]] = []
    springs: list[tuple[int, int]] = []
    for a, b in links(answer, positions):
        start = positions[a] if a >= 0 else np.zeros_like(positions[b])
        (rods if is_rigid(start, positions[b]) else springs).append((a, b))
    return Track(
        answer.scene.label, answer.t, projected(positions), tuple(rods), tuple(springs),
        energy_errors(answer),
    )  # fmt: skip
