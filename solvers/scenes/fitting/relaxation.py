"""Nodes and parameters near a minimum, from poor first guesses.

Gaps between a segment's end and the next node are at first penalised only a little, so that every
segment follows its own samples and no motion has time to go astray; then the penalty grows. Each
problem is one of ordinary least squares, whose normal equations are banded but for the parameters
(D. W. Marquardt, J. Soc. Indust. Appl. Math. 11 (1963) 431-441, for the damping).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solveh_banded

from solvers.equations.quantities import Array
from solvers.integration.prepare import NotFinishedError
from solvers.scenes.fitting.least_squares import Flags, Linearise, Piece, longest

#: Weights of gaps in units of the noise, for components of the state in units of their size.
WEIGHTS = (1.0, 10.0, 100.0)
#: Iterations for each weight, which ends where the sum of squares decreases by less than this part.
MOST_ITERATIONS, SUFFICIENT = 60, 0.05
FIRST_DAMPING, LEAST_DAMPING, MOST_DAMPING = 1e-3, 1e-9, 1e6
#: Factors of the damping after steps that are accepted and refused.
FALL, RISE = 5, 4


@dataclass(frozen=True)
class Relaxed:
    """Nodes and unknown parameters, and the sum of squares with the last penalty."""

    nodes: Array
    params: Array
    squares: float


def relaxed(
    linearise: Linearise, nodes: Array, params: Array, positive: Flags, scale: Array
) -> Relaxed:
    """Better nodes and parameters; arguments as those of `least_squares.minimise`."""
    try:
        pieces, damping = linearise(nodes, params), FIRST_DAMPING
    except NotFinishedError:
        return Relaxed(nodes, params, np.inf)
    for weight in WEIGHTS:
        weights = weight / scale
        squares = _squares(pieces, weights)
        for _ in range(MOST_ITERATIONS):
            moves, change = _step(pieces, len(params), weights, damping)
            size = longest(params, change, positive)
            trial = nodes + size * moves, params + size * change
            try:
                new = linearise(*trial)
                new_squares = _squares(new, weights)
            except NotFinishedError:
                new_squares = np.inf
            if new_squares < squares:
                is_sufficient = new_squares > (1 - SUFFICIENT) * squares
                (nodes, params), pieces, squares = trial, new, new_squares
                damping = max(damping / FALL, LEAST_DAMPING)
                if is_sufficient:
                    break
            elif (damping := damping * RISE) > MOST_DAMPING:
                break
    return Relaxed(nodes, params, squares)


def _squares(pieces: Sequence[Piece], weights: Array) -> float:
    gaps = (weights * piece.gap for piece in pieces if piece.gap is not None)
    return float(sum(r @ r for r in (*(piece.residuals for piece in pieces), *gaps)))


def _step(pieces: Sequence[Piece], u: int, weights: Array, damping: float) -> tuple[Array, Array]:
    """Changes of nodes and parameters, by damped normal equations."""
    count, n = len(pieces), len(weights)
    own, coupling = np.zeros((count, n, n)), np.zeros((count, n, n))
    border, corner = np.zeros((count, n, u)), np.zeros((u, u))
    gradient, last = np.zeros((count, n)), np.zeros(u)
    for k, piece in enumerate(pieces):
        blocks = [(piece.by, piece.residuals)]
        if piece.gap is not None:
            blocks.append((weights[:, np.newaxis] * piece.gap_by, weights * piece.gap))
            node, params = np.split(blocks[1][0], [n], axis=1)
            own[k + 1] += np.diag(weights**2)
            coupling[k] = -weights[:, np.newaxis] * node
            border[k + 1] -= weights[:, np.newaxis] * params
            gradient[k + 1] -= weights * blocks[1][1]
        for by, residuals in blocks:
            square, slope = by.T @ by, by.T @ residuals
            own[k] += square[:n, :n]
            border[k] += square[:n, n:]
            corner += square[n:, n:]
            gradient[k] += slope[:n]
            last += slope[n:]
    bands = np.zeros((2 * n, count * n))  # below the diagonal, as LAPACK stores them
    for j in range(n):
        for i in range(n):
            bands[n + i - j, j : (count - 1) * n : n] = coupling[:-1, i, j]
        for i in range(j, n):
            bands[i - j, j::n] = own[:, i, j]
    bands[0] = bands[0] * (1 + damping) + np.tile(1e-9 * weights**2, count)
    columns = border.reshape(count * n, u)
    solution = solveh_banded(bands, np.column_stack([columns, gradient.ravel()]), lower=True)
    matrix = corner + damping * np.diag(np.diag(corner)) - columns.T @ solution[:, :u]
    change = np.linalg.lstsq(matrix, columns.T @ solution[:, u] - last, rcond=None)[0]
    return (-solution[:, u] - solution[:, :u] @ change).reshape(count, n), change
