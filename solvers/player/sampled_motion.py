"""A motion at sampled times, for pages, films and plots."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.player.track import Array

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
