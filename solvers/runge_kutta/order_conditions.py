"""The order of a Runge–Kutta method, by rooted trees.

A method has order p when Σ b Φ(τ) = 1/γ(τ) for every rooted tree τ with at most p nodes (J. C.
Butcher, Numerical Methods for Ordinary Differential Equations, section 315; E. Hairer,
S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I, theorem II.2.13): exactly for
exact coefficients, within the rounding of their last digits for published decimals.

For q' = v, v' = a(q) positions and velocities may have tableaus of their own. Nodes of trees are
then of two kinds in turn, accelerations and velocities, and one of a velocity has at most one
branch, since the right-hand side is linear in velocities (the same book, section II.14; E. Hairer,
Ch. Lubich, G. Wanner, Geometric Numerical Integration, section III.2.3).
"""

from collections.abc import Callable, Iterator, Sequence
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import cache, partial
from itertools import combinations_with_replacement
from math import prod
from typing import Any, TypeAlias

#: A coefficient: Fraction, Surd or Decimal, of one kind in a method.
Number: TypeAlias = Any
Matrix: TypeAlias = Sequence[Sequence[Number]]
Tree = tuple["Tree", ...]  # a root's branches, in descending order of size

#: Largest order that is determined: the largest number of nodes of a tree.
MOST = 12
#: Digits that computations with rounded decimals carry.
WORKING_DIGITS = 110


def order(A: Matrix, b: Sequence[Number]) -> int:
    """The order of the method with stage matrix `A` and weights `b`, at most `MOST`.

    The nodes are taken to be the row sums of A.

    Parameters
    ----------
    A : sequence of sequences
        Stage matrix, stages × stages, of exact numbers (`fractions.Fraction`,
        `solvers.runge_kutta.surd.Surd`) or of decimals with all their published digits.
    b : sequence
        Weights, stages of them, of the same kind.

    Returns
    -------
    int
        0 if the weights do not even add up to 1.

    Raises
    ------
    ValueError
        When `A` is not stages × stages.
    TypeError
        When fractions and decimals stand beside each other.
    """
    return _order(_Conditions([A], b), trees)


def nystrom_order(
    A: Matrix,
    b: Sequence[Number],
    A_hat: Matrix,
    b_hat: Sequence[Number],
) -> int:
    """The order of a partitioned method for q' = v, v' = a(q), at most `MOST`.

    Parameters
    ----------
    A, b : sequence
        Stage matrix and weights of the velocities, as those of `order`.
    A_hat, b_hat : sequence
        Stage matrix and weights of the positions.

    Returns
    -------
    int
        0 if the weights do not even add up to 1.
    """
    kicks, drifts = _Conditions([A_hat, A], b), _Conditions([A, A_hat], b_hat)
    reached = _order(kicks, partial(alternating_trees, linear=1))
    return _order(drifts, partial(alternating_trees, linear=0), reached)


def _order(
    conditions: "_Conditions", trees_of: Callable[[int], Sequence[Tree]], most: int = MOST
) -> int:
    with localcontext(prec=WORKING_DIGITS):
        for p in range(1, most + 1):
            if not all(map(conditions.hold, trees_of(p))):
                return p - 1
    return most


@cache
def trees(size: int) -> tuple[Tree, ...]:
    """All rooted trees with `size` nodes; there are 1, 1, 2, 4, 9, 20, 48, 115, ... of them."""
    return tuple(_forests(size - 1, size - 1))


def alternating_trees(size: int, linear: int) -> tuple[Tree, ...]:
    """The trees with `size` nodes in which each node of one kind has at most one branch.

    These are the nodes at odd heights if `linear` is 1, and the root and others at even heights
    if it is 0.
    """
    return tuple(tree for tree in trees(size) if _alternates(tree, linear))


def _alternates(tree: Tree, linear: int) -> bool:
    return (linear == 1 or len(tree) <= 1) and all(_alternates(b, 1 - linear) for b in tree)


def _forests(nodes: int, largest: int) -> Iterator[Tree]:
    """Multisets of trees with `nodes` nodes together, none larger than `largest`."""
    if nodes == 0:
        yield ()
    for size in range(min(nodes, largest), 0, -1):
        for count in range(nodes // size, 0, -1):
            for chosen in combinations_with_replacement(trees(size), count):
                for rest in _forests(nodes - size * count, size - 1):
                    yield chosen + rest


@cache
def _nodes(tree: Tree) -> int:
    return 1 + sum(map(_nodes, tree))


@cache
def density(tree: Tree) -> int:
    """γ: the product of the sizes of all subtrees that hang from a node."""
    return _nodes(tree) * prod(map(density, tree))


class _Conditions:
    """The order conditions of one method; common subtrees are evaluated once.

    With several stage matrices, those of nodes at successive heights are used in turn.
    """

    def __init__(self, matrices: Sequence[Matrix], b: Sequence[Number]) -> None:
        self._matrices, self._b = matrices, b
        self._zero = b[0] - b[0]
        self._stage_weights: dict[tuple[Tree, int], list[Number]] = {}
        numbers = (*(x for A in matrices for row in A for x in row), *b)
        decimals = [x for x in numbers if isinstance(x, Decimal)]
        self._digits = max((_digits(x) for x in decimals), default=0)
        self._magnitudes = self
        if any(x < 0 for x in decimals):
            positive = [[[*map(abs, row)] for row in A] for A in matrices]
            self._magnitudes = _Conditions(positive, [*map(abs, b)])

    def weight(self, tree: Tree) -> Number:
        """Σ b Φ(tree)."""
        pairs = zip(self._b, self._at_stages(tree, 0), strict=True)
        return sum((w * x for w, x in pairs), self._zero)

    def hold(self, tree: Tree) -> bool:
        """Whether the condition of `tree` is fulfilled."""
        if not self._digits:
            return bool(self.weight(tree) == Fraction(1, density(tree)))
        residual = abs(self.weight(tree) - Decimal(1) / density(tree))
        # every factor is rounded in its last digit, and one or two digits may be lost in print
        last_digit = Decimal(10) ** (2 - self._digits)
        return bool(residual <= 2 * _nodes(tree) * last_digit * self._magnitudes.weight(tree))

    def _at_stages(self, tree: Tree, height: int) -> list[Number]:
        """Φ of each stage: the product over branches of A Φ(branch)."""
        key = tree, height % len(self._matrices)
        if key not in self._stage_weights:
            weights = [self._zero + 1] * len(self._b)
            for branch in tree:
                inner = self._at_stages(branch, height + 1)
                weights = [
                    w * sum((a * x for a, x in zip(row, inner, strict=True) if a), self._zero)
                    for w, row in zip(weights, self._matrices[key[1]], strict=True)
                ]
            self._stage_weights[key] = weights
        return self._stage_weights[key]


def _digits(number: Decimal) -> int:
    """Significant digits as printed; 0 for quotients, which fill the working digits."""
    digits = len(number.as_tuple().digits)
    return digits if digits < WORKING_DIGITS else 0
