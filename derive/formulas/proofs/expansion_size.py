"""The size of expanded expressions, known before anything is expanded."""

from math import prod

import sympy as sp

WAVES = (sp.sin, sp.cos)
#: Terms of the largest expression that is expanded.
LARGEST = 5000


def is_expandable(expression: sp.Expr, *, waves: int = 1, largest: int = LARGEST) -> bool:
    """Whether the expanded expression has at most `largest` terms, before terms are collected.

    With `waves` = 2, products of sines and cosines are expanded, too, into sums of them.
    """
    return _expanded_size(expression, waves, {}) <= largest


def _expanded_size(expression: sp.Expr, waves: int, known: dict[sp.Expr, int]) -> int:
    """Number of terms of the expanded expression, up to a bound."""
    if expression not in known:
        sizes = [_expanded_size(part, waves, known) for part in expression.args]
        if isinstance(expression, WAVES):
            sizes = [waves]  # a product of n waves is a sum of 2^n waves, of a power n + 1
        if expression.is_Add:
            size = sum(sizes)
        elif expression.is_Mul:
            size = prod(sizes)
        elif expression.is_Pow and isinstance(expression.base, WAVES) and expression.exp.is_Integer:
            size = 1 + (waves - 1) * abs(int(expression.exp))
        elif expression.is_Pow and expression.exp.is_Integer:  # denominators are expanded, too
            size = min(sizes[0], LARGEST + 1) ** min(abs(int(expression.exp)), 100)
        else:
            size = max(sizes, default=1)
        known[expression] = min(size, LARGEST + 1)
    return known[expression]
