"""Motions that stay on zeros of switching functions.

Where forces push a motion back to a jump from both sides, as dry friction holds a body, it follows
the convex combination of both right-hand sides along which the switching function stays 0 (A. F.
Filippov, Differential Equations with Discontinuous Righthand Sides, 1988, section 4). The sign of
the function is then a number s between -1 and 1: f(s) = f(1) + (s - 1) (f(1) - f(-1))/2. With
several functions, f is affine in their signs, which follow from a linear system.

The compiled loop does the same in ``compiled/c/sliding.h``.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: The right-hand side, and rows of switching functions, their rates and, in a variational form, the
#: perturbations of both; by signs of the switching functions.
Evaluate = Callable[[Sequence[float]], tuple[Array, Array]]
#: Largest relative change of a right-hand side by products of signs.
AFFINE = 1e-9


class Sliding(NamedTuple):
    """A right-hand side with the signs that keep some switching functions at 0."""

    derivative: Array
    switching: Array  # rows of switching functions, their rates, and the perturbations of both
    signs: Array  # of all switching functions
    excess: Array | float = 0.0  # of the state, up to which functions that stay 0 are 0


def slide(
    evaluate: Evaluate, signs: Sequence[float] | Array, perturbed: Sequence[tuple[int, int]] = ()
) -> Sliding:
    """The motion with the given signs; functions whose sign is 0 stay 0.

    `perturbed` are pairs of indices, of each velocity and its perturbation, if there are any. Signs
    are not finite where the functions do not determine them.
    """
    held = np.array(signs, float)
    sliding = np.flatnonzero(held == 0)
    held[sliding] = 1.0
    derivative, switching = evaluate(held.tolist())
    if not sliding.size:
        return Sliding(derivative, switching, held)
    others = [evaluate(_negated(held, [k])) for k in sliding.tolist()]
    jumps = np.array([(derivative - other) / 2 for other, _ in others])
    by_sign = np.array([(switching - other) / 2 for _, other in others])  # one more axis in front
    matrix = by_sign[:, 1, sliding].T
    change = _solved(matrix, -switching[1, sliding])
    derivative = derivative + change @ jumps
    switching = switching + np.tensordot(change, by_sign, 1)
    if perturbed:  # signs that follow the motion follow its perturbation, too
        velocities, perturbations = np.transpose(perturbed)
        response = _solved(matrix, -switching[3, sliding])
        derivative[perturbations] += response @ jumps[:, velocities]
        switching[3] += response @ by_sign[:, 1]
    held[sliding] += change
    return Sliding(derivative, switching, held, _solved(matrix, switching[0, sliding]) @ jumps)


def is_affine(evaluate: Evaluate, signs: Sequence[float] | Array) -> bool:
    """Whether the right-hand side is affine in the signs that are 0."""
    held = np.array(signs, float)
    sliding = np.flatnonzero(held == 0)
    held[sliding] = 1.0
    first = evaluate(held.tolist())[0]
    others = [evaluate(_negated(held, [k]))[0] for k in sliding.tolist()]
    expected = first + sum((other - first for other in others), np.zeros_like(first))
    last = evaluate(_negated(held, sliding))[0]
    return bool(np.abs(last - expected).max() <= AFFINE * np.abs([first, last, *others]).max())


def _negated(signs: Array, indices: Sequence[int] | NDArray[np.intp]) -> list[float]:
    changed = signs.copy()
    changed[indices] *= -1
    return [float(sign) for sign in changed]


def _solved(matrix: Array, right: Array) -> Array:
    try:
        return np.asarray(np.linalg.solve(matrix, right), float)
    except np.linalg.LinAlgError:
        return np.full(len(right), np.nan)
