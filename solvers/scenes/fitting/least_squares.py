"""Least squares with multiple shooting: Gauss-Newton steps, also from poor first guesses.

The unknowns are the parameters and the state at every node. Continuity of the motion determines
all nodes of a run but the first to first order, so that a linear least-squares problem of the
parameters and first nodes remains (H. G. Bock, in: K. H. Ebert, P. Deuflhard, W. Jäger (eds.),
Modelling of Chemical Reaction Systems, Springer, 1981, 102-125). Steps are shortened until an exact
penalty function decreases.

Gaps between a segment's end and the next node are at first penalised only a little, so that every
segment follows its own samples and no motion has time to go astray; then the penalty grows. Each
problem is one of ordinary least squares, whose normal equations are banded but for the parameters
(D. W. Marquardt, J. Soc. Indust. Appl. Math. 11 (1963) 431-441, for the damping).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from solvers.equations.number_checks import Array
from solvers.scenes.fitting.multiple_shooting import NoResidualsError

#: Iterations, and halvings of a step.
MOST_ITERATIONS, MOST_HALVINGS = 100, 12
#: Decrease of the sum of squares by a step, as a part of it and for each value, and gaps in units
#: of the state, below which the iteration ends. With N values, unknowns then change by less than
#: √(1e-10 N) of their errors, 0.001 of 10,000 values.
DECREASE, ROUNDING, CLOSED = 1e-10, 1e-12, 1e-8
#: Decrease below which it may stagnate: values change by a thirtieth of their errors.
STAGNANT = 1e-3

Flags = NDArray[np.bool_]


class NotConvergedError(ArithmeticError):
    """The iteration found no minimum."""


def triangle_of(matrices: Array) -> Array:
    """R of the QR decomposition of a matrix, or of several."""
    return np.asarray(np.linalg.qr(matrices, mode="r"))


@dataclass(frozen=True)
class LinearisedResiduals:
    """Linearised residuals of all segments, and the gaps between them.

    Attributes
    ----------
    runs : ndarray of shape (segments,)
        The run of each segment.
    residuals : ndarray of shape (segments, values)
        In units of the noise; 0 where there is no value.
    by : ndarray of shape (segments, values, state + unknown)
        Their derivatives by the node and the parameters.
    gaps, gaps_by : ndarray of shape (segments, state) and (segments, state, state + unknown)
        Distance of the end from the next node, and its derivatives by the node and the parameters;
        both 0 at the end of a run.
    """

    runs: NDArray[np.int64]
    residuals: Array
    by: Array
    gaps: Array
    gaps_by: Array

    @property
    def triangles(self) -> Array:
        """R of the QR decomposition of each segment's derivatives, and of its residuals beside."""
        both = np.concatenate([self.by, self.residuals[:, :, np.newaxis]], axis=2)
        return triangle_of(both)

    @property
    def squares(self) -> float:
        """The sum of squares of the residuals."""
        return float(np.sum(self.residuals**2))

    def weighted(self, ratio: Array) -> "LinearisedResiduals":
        """Residuals times a factor for each of the values, shape (segments, values)."""
        by = self.by * ratio[:, :, np.newaxis]
        return replace(self, residuals=self.residuals * ratio, by=by)


#: Residuals at nodes of shape (segments, state) and unknown parameters; `NoResidualsError` if none.
Linearise = Callable[[Array, Array], LinearisedResiduals]


@dataclass(frozen=True)
class GaussNewtonStep:
    """A Gauss-Newton step: changes of nodes and parameters, and residuals predicted by it."""

    nodes: Array
    params: Array
    predicted: float  # sum of squares of the residuals
    triangle: Array  # R of the QR decomposition of the condensed problem
    maps: Array  # of first nodes and parameters to each node, shape (segments, state, columns)

    def jacobian(self, linear: LinearisedResiduals) -> Array:
        """Derivatives by first nodes and parameters, shape (segments, values, columns)."""
        n, u = self.maps.shape[1], len(self.params)
        jacobian = linear.by[:, :, :n] @ self.maps
        jacobian[:, :, self.maps.shape[2] - u :] += linear.by[:, :, n:]
        return np.asarray(jacobian)


def condensed(linear: LinearisedResiduals, u: int) -> GaussNewtonStep:
    """The least-squares step of all segments, with linearised continuity satisfied exactly."""
    runs, n = linear.runs, linear.gaps.shape[1]
    first = np.concatenate([[True], np.diff(runs) > 0])
    columns = int(first.sum()) * n + u
    # a node is `own` · (first nodes, parameters) + `offset`, of which offset is the last column
    maps = np.zeros((len(runs), n, columns + 1))
    for k, begins in enumerate(first):
        if begins:
            start = int(runs[k] - runs[0]) * n
            maps[k, range(n), range(start, start + n)] = 1.0
        else:
            maps[k] = linear.gaps_by[k - 1, :, :n] @ maps[k - 1]
            maps[k, :, columns - u : columns] += linear.gaps_by[k - 1, :, n:]
            maps[k, :, columns] += linear.gaps[k - 1]
    triangles = linear.triangles
    rows = triangles[:, :, :n] @ maps
    rows[:, :, columns - u :] += triangles[:, :, n:]
    rows = triangle_of(rows).reshape(-1, columns + 1)
    scale = np.linalg.norm(rows[:, :columns], axis=0)
    scale[scale == 0] = 1.0
    both = triangle_of(rows / np.append(scale, 1.0))
    triangle, right = both[:columns, :columns], both[:columns, columns]
    change = np.linalg.lstsq(triangle, -right, rcond=1e-14)[0] / scale
    residuals = rows @ np.append(change, 1.0)
    moves = maps @ np.append(change, 1.0)
    predicted = float(residuals @ residuals)
    triangle = triangle * scale
    return GaussNewtonStep(moves, change[columns - u :], predicted, triangle, maps[:, :, :columns])


@dataclass(frozen=True)
class Minimum:
    """The end of the iteration."""

    nodes: Array
    params: Array  # the unknown ones
    linear: LinearisedResiduals
    step: GaussNewtonStep
    iterations: int


def minimise(
    linearise: Linearise,
    nodes: Array,
    params: Array,
    positive: Flags,
    scale: Array,
    linear: LinearisedResiduals | None = None,
    most: int | None = None,
) -> Minimum:
    """Nodes and parameters that minimise the sum of squares, with continuous motions.

    `linearise` returns residuals at nodes of shape (segments, state) and unknown parameters, and
    `linear` those of the first guess if they are known; `positive` tells which parameters are;
    `scale` has the sizes of the state's components; `most` iterations are done.
    """
    try:
        linear = linear or linearise(nodes, params)
    except NoResidualsError as error:
        raise NotConvergedError(
            f"from the first guess, {error}: give a better first guess"
        ) from error
    weight, before, u = 0.0, np.inf, len(params)
    step, squares, gaps = condensed(linear, u), linear.squares, _gaps(linear, scale)
    most = most or MOST_ITERATIONS
    for iteration in range(most + 1):
        values = np.count_nonzero(linear.residuals)
        is_closed = gaps <= CLOSED * len(nodes)
        # rounding errors, which chaotic motions amplify, let it stagnate
        decrease = abs(squares - step.predicted)
        is_stagnant = before / 2 < decrease < STAGNANT
        before = decrease
        if is_closed and (is_stagnant or decrease <= DECREASE * squares + ROUNDING * values):
            return Minimum(nodes, params, linear, step, iteration)
        if iteration == most:
            break
        if gaps:  # so that the penalty function decreases along the step
            weight = max(weight, 2 * (step.predicted - squares) / gaps)
        size, accepted = longest(params, step.params, positive), None
        merit, expected = squares + weight * gaps, squares - step.predicted + weight * gaps
        for _ in range(MOST_HALVINGS):
            trial = nodes + size * step.nodes, params + size * step.params
            try:
                new = linearise(*trial)
            except NoResidualsError:
                size /= 4
                continue
            reached = new.squares + weight * _gaps(new, scale)
            if reached <= merit - 1e-4 * size * expected + 1e-10 * merit:
                accepted = new
                break
            size /= 2
        if accepted is None:
            raise NotConvergedError(
                f"no step improves the fit after {iteration} iterations: give a better first guess"
            )
        (nodes, params), linear = trial, accepted
        step, squares, gaps = condensed(linear, u), linear.squares, _gaps(linear, scale)
    raise NotConvergedError(f"no minimum after {most} iterations: give a better first guess")


def _gaps(linear: LinearisedResiduals, scale: Array) -> float:
    return float(np.sum(np.abs(linear.gaps / scale)))


def longest(params: Array, change: Array, positive: Flags) -> float:
    """The longest part of a step that leaves positive parameters at a tenth or more."""
    falls = positive & (change < 0) & (params > 0)
    limits = -0.9 * params[falls] / change[falls]
    return min(1.0, float(np.min(limits, initial=1.0)))


#: Weights of gaps in units of the noise, for components of the state in units of their size.
WEIGHTS = (1.0, 10.0, 100.0)
#: Iterations for each weight, which ends where the sum of squares decreases by less than this part.
MOST_RELAXATIONS, SUFFICIENT = 60, 0.05
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
        for _ in range(MOST_RELAXATIONS):
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
