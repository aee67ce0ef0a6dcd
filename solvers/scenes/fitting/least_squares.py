"""Least squares with multiple shooting: Gauss-Newton steps with continuity as a constraint.

The unknowns are the parameters and the state at every node. Continuity of the motion determines
all nodes of a run but the first to first order, so that a linear least-squares problem of the
parameters and first nodes remains (H. G. Bock, in: K. H. Ebert, P. Deuflhard, W. Jäger (eds.),
Modelling of Chemical Reaction Systems, Springer, 1981, 102-125). Steps are shortened until an exact
penalty function decreases.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solvers.equations.quantities import Array
from solvers.integration.prepare import NotFinishedError

#: Iterations, and halvings of a step.
MOST_ITERATIONS, MOST_HALVINGS = 100, 12
#: Decrease of the sum of squares by a step, as a part of it and for each value, and gaps in units
#: of the state, below which the iteration ends.
DECREASE, ROUNDING, CLOSED = 1e-8, 1e-10, 1e-8


class NotConvergedError(ArithmeticError):
    """The iteration found no minimum."""


@dataclass(frozen=True)
class Piece:
    """The linearised residuals of a segment, and its continuity with the next one.

    `residuals` has shape (m,), `by` its derivatives by node and parameters; `gap` is the distance
    of the segment's end from the next node, `gap_by` its derivatives by this node and parameters.
    """

    run: int
    residuals: Array
    by: Array
    gap: Array | None  # None at the end of a run
    gap_by: Array


Flags = NDArray[np.bool_]
#: Pieces at nodes of shape (segments, state) and unknown parameters; `NotFinishedError` if none.
Linearise = Callable[[Array, Array], Sequence[Piece]]


@dataclass(frozen=True)
class Step:
    """A Gauss-Newton step: changes of nodes and parameters, and residuals predicted by it."""

    nodes: Array
    params: Array
    predicted: float  # sum of squares of the residuals
    triangle: Array  # R of the QR decomposition of the condensed problem
    jacobian: Array  # of all residuals by first nodes and parameters


def condensed(pieces: Sequence[Piece], n: int, u: int) -> Step:
    """The least-squares step of all pieces, with the linearised continuity satisfied exactly."""
    runs = list(dict.fromkeys(piece.run for piece in pieces))
    columns = len(runs) * n + u
    # the node of a piece is `own` · (first nodes, parameters) + `offset`
    own, offset = np.zeros((n, columns)), np.zeros(n)
    rows, right, nodes = [], [], []
    begins = True
    for piece in pieces:
        if begins:
            own, offset = np.zeros((n, columns)), np.zeros(n)
            start = runs.index(piece.run) * n
            own[:, start : start + n] = np.eye(n)
        nodes.append((own, offset))
        block = piece.by[:, :n] @ own
        block[:, columns - u :] += piece.by[:, n:]
        rows.append(block)
        right.append(piece.residuals + piece.by[:, :n] @ offset)
        begins = piece.gap is None
        if piece.gap is not None:
            offset = piece.gap_by[:, :n] @ offset + piece.gap
            own = piece.gap_by[:, :n] @ own
            own[:, columns - u :] += piece.gap_by[:, n:]
    jacobian, residuals = np.vstack(rows), np.concatenate(right)
    scale = np.linalg.norm(jacobian, axis=0)
    scale[scale == 0] = 1.0
    q, triangle = np.linalg.qr(jacobian / scale)
    change = np.linalg.lstsq(triangle, -q.T @ residuals, rcond=1e-14)[0] / scale
    predicted = float(np.sum((residuals + jacobian @ change) ** 2))
    moves = np.array([own @ change + offset for own, offset in nodes])
    return Step(moves, change[columns - u :], predicted, triangle * scale, jacobian)


@dataclass(frozen=True)
class Minimum:
    """The end of the iteration."""

    nodes: Array
    params: Array  # the unknown ones
    pieces: Sequence[Piece]
    step: Step
    iterations: int

    @property
    def squares(self) -> float:
        """The sum of squares of the residuals."""
        return sum(float(piece.residuals @ piece.residuals) for piece in self.pieces)


def minimise(
    linearise: Linearise,
    nodes: Array,
    params: Array,
    positive: Flags,
    scale: Array,
) -> Minimum:
    """Nodes and parameters that minimise the sum of squares, with continuous motions.

    `linearise` returns the pieces at nodes of shape (segments, state) and unknown parameters;
    `positive` tells which of these are; `scale` has the sizes of the state's components.
    """
    n, u = nodes.shape[1], len(params)
    try:
        pieces = linearise(nodes, params)
    except NotFinishedError as error:
        raise NotConvergedError(f"the motion of the first guess ends: {error}") from error
    weight, step = 0.0, condensed(pieces, n, u)
    squares, gaps = _merit(pieces, scale)
    for iteration in range(1, MOST_ITERATIONS + 1):
        if gaps:  # so that the penalty function decreases along the step
            weight = max(weight, 2 * (step.predicted - squares) / gaps, 0.0)
        size, accepted = longest(params, step.params, positive), None
        expected = squares - step.predicted + weight * gaps
        for _ in range(MOST_HALVINGS):
            trial = nodes + size * step.nodes, params + size * step.params
            try:
                new = linearise(*trial)
            except NotFinishedError:
                size /= 4
                continue
            new_squares, new_gaps = _merit(new, scale)
            merit = squares + weight * gaps
            rounding = 1e-10 * merit
            if new_squares + weight * new_gaps <= merit - 1e-4 * size * expected + rounding:
                accepted = new
                break
            size /= 2
        if accepted is None:
            raise NotConvergedError(
                f"no step improves the fit after {iteration} iterations: give a better first guess"
            )
        (nodes, params), pieces = trial, accepted
        step = condensed(pieces, n, u)
        squares, gaps = _merit(pieces, scale)
        values = sum(len(piece.residuals) for piece in pieces)
        if (
            size == 1
            and gaps <= CLOSED * len(pieces)
            and squares - step.predicted <= DECREASE * squares + ROUNDING * values
        ):
            return Minimum(nodes, params, pieces, step, iteration)
    raise NotConvergedError(
        f"no minimum in {MOST_ITERATIONS} iterations: give a better first guess"
    )


def _merit(pieces: Sequence[Piece], scale: Array) -> tuple[float, float]:
    squares = sum(float(piece.residuals @ piece.residuals) for piece in pieces)
    gaps = (np.abs(piece.gap / scale).sum() for piece in pieces if piece.gap is not None)
    return squares, float(sum(gaps))


def longest(params: Array, change: Array, positive: Flags) -> float:
    """The longest part of a step that leaves positive parameters at a tenth or more."""
    falls = positive & (change < 0) & (params > 0)
    limits = -0.9 * params[falls] / change[falls]
    return min(1.0, float(np.min(limits, initial=1.0)))
