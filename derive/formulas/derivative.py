"""Derivatives of expressions; those of equal parts are formed once.

SymPy's own collects the symbols of every part of every part, which takes longer than the rest.
"""

from functools import lru_cache

import sympy as sp

#: Derivatives that are kept.
MOST = 100_000


@lru_cache(MOST)
def derivative(expression: sp.Expr, symbol: sp.Symbol) -> sp.Expr:
    """∂expression/∂symbol, as ``expression.diff(symbol)`` gives it."""
    if expression == symbol:
        return sp.S.One
    if not expression.args:
        return sp.S.Zero
    if not isinstance(expression, sp.Add | sp.Mul | sp.Pow | sp.sin | sp.cos):
        return expression.diff(symbol)
    changes = [derivative(part, symbol) for part in expression.args]
    if not any(changes):
        return sp.S.Zero
    if expression.is_Add:
        return sp.Add(*changes)
    if expression.is_Mul:
        parts = expression.args
        terms = [sp.Mul(*parts[:k], d, *parts[k + 1 :]) for k, d in enumerate(changes) if d != 0]
        return sp.Add(*terms)
    if expression.is_Pow:
        base, exponent = expression.args
        growth = changes[1] * sp.log(base) if changes[1] != 0 else sp.S.Zero
        return expression * (growth + changes[0] * exponent / base)
    return expression.fdiff() * changes[0]
