"""Nodes and parameters near a minimum, from poor first guesses.

Gaps between a segment's end and the next node are at first penalised only a little, so that every
segment follows its own samples and no motion has time to go astray; then the penalty grows. Each
problem is one of ordinary least squares, whose normal equations are banded but for the parameters
(D. W. Marquardt, J. Soc. Indust. Appl. Math. 11 (1963) 431-441, for the damping).
"""

from dataclasses import dataclass

import numpy as np
import scipy

from solvers.equations.number_checks import Array
from solvers.scenes.fitting.least_squares import Flags, Linearise, LinearisedResiduals, longest
from solvers.scenes.fitting.multiple_shooting import NoResidualsError

#: Weights of gaps in units of the noise, for components of the state in units of their size.
WEIGHTS = (1.0, 10.0, 100.0)
#: Iterations for each weight, which ends where the sum of squares decreases by less than this part.
MOST_ITERATIONS, SUFFICIENT = 60, 0.05
FIRST_DAMPING, LEAST_DAMPING, MOST_DAMPING = 1e-3, 1e-9, 1e6
#: Factors of the damping after steps that are accepted and refused.
FALL, RISE = 5, 4


@dataclass(frozen=True)
class Relaxed:
    """Nodes and unknown parameters, the sum of squares with the last penalty, and residuals."""

    nodes: Array
    params: Array
    squares: float
    linear: LinearisedResiduals | None


def relaxed(
    linearise: Linearise, nodes: Array, params: Array, positive: Flags, scale: Array
) -> Relaxed:
    """Better nodes and parameters; arguments as those of `least_squares.minimise`."""
    try:
        linear, damping = linearise(nodes, params), FIRST_DAMPING
    except NoResidualsError:
        return Relaxed(nodes, params, np.inf, None)
    for weight in WEIGHTS:
        weights = weight / scale
        squares = _squares(linear, weights)
        for _ in range(MOST_ITERATIONS):
            moves, change = _step(linear, len(params), weights, damping)
            size = longest(params, change, positive)
            trial = nodes + size * moves, params + size * change
            try:
                new = linearise(*trial)
                new_squares = _squares(new, weights)
            except NoResidualsError:
                new_squares = np.inf
            if new_squares < squares:
                is_sufficient = new_squares > (1 - SUFFICIENT) * squares
                (nodes, params), linear, squares = trial, new, new_squares
                damping = max(damping / FALL, LEAST_DAMPING)
                if is_sufficient:
                    break
            elif (damping := damping * RISE) > MOST_DAMPING:
                break
    return Relaxed(nodes, params, squares, linear)


def _squares(linear: LinearisedResiduals, weights: Array) -> float:
    return linear.squares + float(np.sum((weights * linear.gaps) ** 2))


def _step(
    linear: LinearisedResiduals, u: int, weights: Array, damping: float
) -> tuple[Array, Array]:
    """Changes of nodes and parameters, by damped normal equations."""
    count, n = linear.gaps.shape
    triangles, rows = linear.triangles, weights[:, np.newaxis]
    links = np.concatenate([rows * linear.gaps_by, rows * linear.gaps[:, :, np.newaxis]], axis=2)
    square = np.swapaxes(triangles, 1, 2) @ triangles + np.swapaxes(links, 1, 2) @ links
    own, border, gradient = square[:, :n, :n], square[:, :n, n:-1], square[:, :n, -1]
    total = square.sum(axis=0)
    corner, last = total[n:-1, n:-1], total[n:-1, -1]
    # the next node of a gap
    follows = np.diff(linear.runs) == 0
    own[1:][follows] += np.diag(weights**2)
    coupling = -rows * links[:-1, :, :n]
    border[1:] -= rows * links[:-1, :, n:-1]
    gradient[1:] -= weights * links[:-1, :, -1]
    bands = np.zeros((2 * n, count * n))  # below the diagonal, as LAPACK stores them
    for j in range(n):
        for i in range(n):
            bands[n + i - j, j : (count - 1) * n : n] = coupling[:, i, j]
        for i in range(j, n):
            bands[i - j, j::n] = own[:, i, j]
    bands[0] = bands[0] * (1 + damping) + np.tile(1e-9 * weights**2, count)
    columns = border.reshape(count * n, u)
    solution = scipy.linalg.solveh_banded(
        bands, np.column_stack([columns, gradient.ravel()]), lower=True
    )
    matrix = corner + damping * np.diag(np.diag(corner)) - columns.T @ solution[:, :u]
    change = np.linalg.lstsq(matrix, columns.T @ solution[:, u] - last, rcond=None)[0]
    return (-solution[:, u] - solution[:, :u] @ change).reshape(count, n), change
