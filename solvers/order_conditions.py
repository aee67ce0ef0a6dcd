"""The order of a Runge–Kutta method, by rooted trees, in exact arithmetic.

A method has order p when Σ b Φ(τ) = 1/γ(τ) for every rooted tree τ with at most
p nodes (J. C. Butcher, Numerical Methods for Ordinary Differential Equations,
section 315; E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential
Equations I, theorem II.2.13).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cache
from itertools import combinations_with_replacement
from math import prod

Tree = tuple["Tree", ...]  # a root's branches, in descending order of size


def order(
    A: Sequence[Sequence[Fraction]], b: Sequence[Fraction], c: Sequence[Fraction], most: int = 6
) -> int:
    """The order of the method with coefficients `A`, `b` and `c`, at most `most`.

    Parameters
    ----------
    A, b, c : sequences of Fraction
        Stage matrix (stages × stages), weights and nodes. A method whose nodes
        are not the row sums of A has order 0 here: the trees then say nothing
        about right-hand sides that depend on time.
    most : int
        Where to stop looking.
    """
    if any(sum(row) != node for row, node in zip(A, c, strict=True)):
        return 0
    for p in range(1, most + 1):
        if any(_residual(tree, A, b) for tree in trees(p)):
            return p - 1
    return most


@cache
def trees(size: int) -> tuple[Tree, ...]:
    """All rooted trees with `size` nodes; there are 1, 1, 2, 4, 9, 20, 48, 115, ... of them."""
    return tuple(_forests(size - 1, size - 1))


def _forests(nodes: int, largest: int) -> Iterator[Tree]:
    """Multisets of trees with `nodes` nodes together, none larger than `largest`."""
    if nodes == 0:
        yield ()
    for size in range(min(nodes, largest), 0, -1):
        for count in range(nodes // size, 0, -1):
            for chosen in combinations_with_replacement(trees(size), count):
                for rest in _forests(nodes - size * count, size - 1):
                    yield chosen + rest


def _nodes(tree: Tree) -> int:
    return 1 + sum(map(_nodes, tree))


def _density(tree: Tree) -> int:
    """γ: the product of the sizes of all subtrees that hang from a node."""
    return _nodes(tree) * prod(map(_density, tree))


def _stage_weights(tree: Tree, A: Sequence[Sequence[Fraction]]) -> list[Fraction]:
    """Φ of each stage: the product over branches of A Φ(branch)."""
    weights = [Fraction(1)] * len(A)
    for branch in tree:
        inner = _stage_weights(branch, A)
        weights = [
            w * sum((a * x for a, x in zip(row, inner, strict=True)), Fraction(0))
            for w, row in zip(weights, A, strict=True)
        ]
    return weights


def _residual(tree: Tree, A: Sequence[Sequence[Fraction]], b: Sequence[Fraction]) -> Fraction:
    weights = _stage_weights(tree, A)
    total = sum((x * w for x, w in zip(b, weights, strict=True)), Fraction(0))
    return total - Fraction(1, _density(tree))
