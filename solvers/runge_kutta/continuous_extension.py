"""Continuous extensions: states within a step, from the stages of the step.

With θ^n/γ in place of 1/γ, the order conditions of trees with n nodes are linear equations for
weights b(θ) of the stages. Those that can be fulfilled give an extension of some order without
evaluations (M. Zennaro, Mathematics of Computation 46 (1986) 119-133): of collocation methods,
their polynomial. An integral of the right-hand side along an extension has an order that is larger
by one (W. H. Enright, K. R. Jackson, S. P. Nørsett, P. G. Thomsen, ACM Transactions on Mathematical
Software 12 (1986) 193-218); explicit methods repeat this up to their own order.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from math import comb

import numpy as np
from numpy.polynomial.chebyshev import chebpts1
from numpy.polynomial.legendre import leggauss, legvander
from numpy.typing import NDArray

from solvers.runge_kutta.order_conditions import Tree, alternating_trees, density, trees
from solvers.runge_kutta.parallel_stages import bernstein_matrix
from solvers.runge_kutta.tableau import StateWeights, Tableau

Array = NDArray[np.float64]
#: Residuals of order conditions below this, and relative singular values, are rounding errors.
ROUNDING = 1e-10
#: Weight of the size of the coefficients, beside that of the errors of the next order.
DAMPING = 1e-2


@dataclass(frozen=True)
class ContinuousExtension:
    """Matrices that give the polynomials over a step from derivatives at stages and at nodes.

    Polynomials have Bernstein coefficients on [0, 1], without the state at the start: with the
    derivatives k of the stages in rows, those of the natural extension are ``h * change(k)``.
    Each of the `rounds` that follow evaluates the derivatives f at the nodes, first at the states
    of the natural extension, then at ``y + h * integrals @ f``; the result is ``h * extended @ f``.
    Weights of the natural extension are those of the whole state, or of each of its halves.
    """

    natural_order: int
    rounds: int
    naturals: tuple[Array, ...]  # of shape (degree + 1, stages), of equal parts of the state
    nodes: Array
    integrals: Array  # of the Lagrange polynomials, up to each node
    step_evaluations: int = 0  # by a step, if all stages depend on the right-hand side explicitly

    @classmethod
    def of(cls, tableau: Tableau) -> "ContinuousExtension":
        """The extension of a method with stages of its own; that of Gauss methods is known."""
        return _extension(tableau)

    @property
    def least_samples(self) -> int:
        """Samples in a step from which on it takes fewer evaluations than shorter steps.

        0 if shorter steps are more accurate.
        """
        if not self.step_evaluations:
            return 0
        return self.rounds * len(self.nodes) // self.step_evaluations + 1

    @property
    def natural(self) -> Array:
        """Natural weights of the whole state."""
        (natural,) = self.naturals
        return natural

    @cached_property
    def firsts(self) -> tuple[Array, ...]:
        """Natural weights at the nodes, of each part of the state."""
        degree = len(self.naturals[0]) - 1
        return tuple(bernstein_values(degree, self.nodes) @ weights for weights in self.naturals)

    @cached_property
    def extended(self) -> Array:
        """Bernstein coefficients of the integrals of the Lagrange polynomials of the nodes."""
        return _integrals_of_lagrange(self.nodes)

    @cached_property
    def with_ends(self) -> Array:
        """Weights of the derivatives at the start and at the end, followed by those of the stages.

        Their polynomial has these slopes, which that of a method of few stages has not.
        """
        degree = max(len(self.natural) - 1, 3)
        weights = elevated(self.natural, degree)
        slopes = degree * (weights[[1, -1]] - weights[[0, -2]])
        hermite = elevated(np.array([[0, 0], [1, 0], [0, -1], [0, 0]]) / 3, degree)
        return np.hstack([hermite, weights - hermite @ slopes])

    def change(self, k: Array) -> Array:
        """Bernstein coefficients of the natural extension, over h."""
        return _of_parts(self.naturals, k)

    def extend(
        self, rhs: Callable[[float, Array], Array], t: float, y: Array, h: float, k: Array
    ) -> Array:
        """Bernstein coefficients of the extension of the method's order, over h."""
        times, states = (t + h * self.nodes).tolist(), y + h * _of_parts(self.firsts, k)
        for _ in range(self.rounds):
            f = np.array(list(map(rhs, times, states)))
            states = y + h * (self.integrals @ f)
        return np.asarray(self.extended @ f)


def bernstein_values(degree: int, x: Array) -> Array:
    """Values of the Bernstein polynomials at each of `x`, in rows."""
    powers = np.arange(degree + 1)
    factors = np.array([comb(degree, k) for k in powers], float)
    x = x[:, np.newaxis]
    return np.asarray(factors * x**powers * (1 - x) ** (degree - powers))


def elevated(coefficients: Array, degree: int) -> Array:
    """Bernstein coefficients, in columns, of the same polynomials with another degree."""
    x = (chebpts1(degree + 1) + 1) / 2
    values = bernstein_values(len(coefficients) - 1, x) @ coefficients
    return np.asarray(np.linalg.solve(bernstein_values(degree, x), values), float)


def _of_parts(weights: Sequence[Array], k: Array) -> Array:
    """Weighted sums of stages, with the weights of each part of the state."""
    parts = np.split(k, len(weights), axis=1)
    return np.hstack([w @ part for w, part in zip(weights, parts, strict=True)])


def _integrals_of_lagrange(nodes: Array) -> Array:
    n = len(nodes)
    return np.asarray(bernstein_matrix(n) @ np.linalg.inv(legvander(2 * nodes - 1, n - 1)))


@cache
def _extension(tableau: Tableau) -> ContinuousExtension:
    if tableau.is_parallel:  # derivatives k are Legendre coefficients
        natural = bernstein_matrix(tableau.stages)
        return ContinuousExtension(tableau.stages, 0, (natural,), np.zeros(1), np.zeros((1, 1)))
    order, naturals = _natural_extension(tableau)
    rounds = max(tableau.order - order, 1) if tableau.is_explicit else 0
    nodes = (leggauss(max(order + rounds, 3))[0] + 1) / 2
    integrals = bernstein_values(len(nodes), nodes) @ _integrals_of_lagrange(nodes)
    evaluations = tableau.is_explicit * (tableau.stages - tableau.is_fsal)
    return ContinuousExtension(order, rounds, naturals, nodes, integrals, evaluations)


def _natural_extension(tableau: Tableau) -> tuple[int, tuple[Array, ...]]:
    """Its order, and the Bernstein coefficients of its weights, of each part of the state."""
    parts = [_NaturalWeights(weights) for weights in tableau.state_weights]
    order = min(part.order for part in parts)
    return order, tuple(_to_bernstein(part.of_order(order)) for part in parts)


class _NaturalWeights:
    """Weights of a part of the state that fulfil the conditions up to some order within a step."""

    def __init__(self, weights: StateWeights) -> None:
        self._b, self._linear = np.array(weights.b, float), weights.linear
        self._matrices = [np.array(A, float) for A in weights.matrices]
        self._stage_weights: dict[tuple[Tree, int], Array] = {}

    @cached_property
    def order(self) -> int:
        """The largest order of which the conditions have a solution."""
        order = 0
        while True:
            left, right = self._conditions_up_to(order + 1)
            if np.abs(left @ _solve(left, right)[0] - right).max() > ROUNDING:
                return order
            order += 1

    def of_order(self, order: int) -> Array:
        """Weights as coefficients of the powers of θ from 1 on.

        Those that the conditions leave free reduce the errors of the next order.
        """
        b = self._b
        weights, free = _solve(*self._conditions_up_to(order))
        if free.shape[1]:
            weights = np.pad(weights, ((0, 0), (0, 1)))
            left, right = self._conditions(order + 1, order + 1)
            damping = DAMPING * np.abs(left @ free).max()
            left = np.concatenate([left, damping * np.eye(len(b))])
            right = np.concatenate([right, np.zeros((len(b), order + 1))])
            weights += free @ np.linalg.lstsq(left @ free, right - left @ weights)[0]
            # at the end of the step they are b; the derivative at its start does not change
            weights[:, 1:] += (b - weights.sum(axis=1))[:, np.newaxis] / order
        return weights

    def _conditions_up_to(self, order: int) -> tuple[Array, Array]:
        parts = [self._conditions(n, order) for n in range(1, order + 1)]
        left, right = (np.concatenate(part) for part in zip(*parts, strict=True))
        return left, right

    def _conditions(self, n: int, powers: int) -> tuple[Array, Array]:
        """Those of trees with n nodes, for the coefficients of the powers of θ from 1 on."""
        of_n = trees(n) if self._linear is None else alternating_trees(n, self._linear)
        right = np.zeros((len(of_n), powers))
        right[:, n - 1] = [1 / density(tree) for tree in of_n]
        return np.array([self._at_stages(tree, 0) for tree in of_n]), right

    def _at_stages(self, tree: Tree, height: int) -> Array:
        key = tree, height % len(self._matrices)
        if key not in self._stage_weights:
            A = self._matrices[key[1]]
            branches = [A @ self._at_stages(branch, height + 1) for branch in tree]
            self._stage_weights[key] = np.prod([np.ones(len(self._b)), *branches], axis=0)
        return self._stage_weights[key]


def _solve(left: Array, right: Array) -> tuple[Array, Array]:
    """The smallest solution of equations, and a basis of those with 0 on the right."""
    scale = np.abs(left).max(axis=1, keepdims=True) + ROUNDING
    u, sizes, v = np.linalg.svd(left / scale)
    rank = int((sizes > ROUNDING * sizes[0]).sum())
    solution = (v[:rank].T / sizes[:rank]) @ (u[:, :rank].T @ (right / scale))
    return solution, v[rank:].T


def _to_bernstein(powers: Array) -> Array:
    """Bernstein coefficients, in rows, of polynomials without a constant term."""
    d = powers.shape[1]
    matrix = [[comb(k, j) / comb(d, j) for j in range(1, d + 1)] for k in range(d + 1)]
    return np.array(matrix) @ powers.T
