"""Elongations of springs, √E - d, as quotients without cancellation.

If b² is a term of E = b² + W, then √E - d = ((b - d)(b + d) + W)/(√E + d). For a spring of length
d whose ends move apart by u along it, b is d + u, and the numerator is u (2d + u) + W.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import sympy as sp


@dataclass(frozen=True)
class Elongation:
    """`scale` times √((d + u)² + W) - d."""

    scale: sp.Expr
    length: sp.Expr  # d, not negative
    change: sp.Expr  # u
    rest: sp.Expr  # W


def elongation(total: sp.Add) -> Elongation | None:
    """A sum as an elongation; None where it is none, or the sign of its length is not known."""
    for term in total.args:
        for root in sp.Mul.make_args(term):
            if root.is_Pow and root.exp == sp.S.Half and root.base.is_Add:
                scale = term / root
                length = (term - total) / scale
                # SymPy takes long to find the sign of a sum of roots with a minus
                parts = [part / scale for part in sp.Add.make_args(term - total)]
                has_minus = any(part.as_coeff_Mul()[0] < 0 for part in parts)
                if (length.is_number or not has_minus) and length.is_nonnegative:
                    return _shortest(scale, length, root.base)
    return None


def _shortest(scale: sp.Expr, length: sp.Expr, square: sp.Add) -> Elongation | None:
    """The elongation whose u has the fewest terms, so that lengths cancel where they are equal."""
    forms = [
        Elongation(scale, length, side - length, square - term)
        for term in square.args
        for side in _sides(term)
    ]
    return min(forms, key=lambda form: len(sp.Add.make_args(form.change)), default=None)


def _sides(term: sp.Expr) -> Iterator[sp.Expr]:
    """Roots b and -b of a square b² if a part of b, such as a length, has a known sign."""
    side = sp.sqrt(term) if term.is_positive else term.base if term.is_Pow else term
    is_rational = all(power.exp.is_Integer for power in side.atoms(sp.Pow))
    if is_rational and sp.expand(side**2 - term) == 0:
        known = [part for part in sp.Add.make_args(side) if part.is_positive or part.is_negative]
        if known:
            yield from (side, -side) if known[0].is_positive else (-side, side)
