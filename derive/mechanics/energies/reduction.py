"""Targeted reduction of trigonometric sums: the shortest of several equal forms.

Products of sines and cosines become sines and cosines of sums of angles, for
which every identity holds by cancellation: cos a cos b + sin a sin b is
cos(a - b), sin² a + cos² a is 1. Squares are tried in place of doubled angles,
since sin² a costs less than (1 - cos 2a)/2 and is accurate near a = 0.
"""

from collections.abc import Callable, Iterator

import sympy as sp

from derive.formulas.budget import MOST_EXPANDED, is_expandable
from derive.mechanics.energies.harmonics import Harmonics

Square = Callable[[sp.Expr], sp.Expr]
#: Terms of the largest expression that is expanded to collect them.
MOST_TERMS = 1000
#: Forms of cos 2a.
SQUARES: tuple[Square, ...] = (lambda a: 1 - 2 * sp.sin(a) ** 2, lambda a: 2 * sp.cos(a) ** 2 - 1)


def reduced(expression: sp.Expr, largest: int = MOST_EXPANDED) -> sp.Expr:
    """The form of `expression` with the fewest operations; unchanged if too long."""
    if not expression.has(sp.sin, sp.cos) or not is_expandable(
        expression, waves=2, largest=largest
    ):
        return expression
    harmonics, operations = Harmonics(expression), int(expression.count_ops())
    if harmonics.fewest_operations > operations:
        return expression
    waves = harmonics.sum
    counts = {waves: int(waves.count_ops())}
    counts.setdefault(expression, operations)  # known; to count takes long
    if halves := _halves(waves):
        others = (_halved(waves, halves, square) for square in SQUARES)
        counts |= {one: int(one.count_ops()) for one in others}
    return min(counts, key=counts.__getitem__)


def collected(expression: sp.Expr, *variables: sp.Symbol) -> sp.Expr:
    """`expression` expanded, one term for each function of `variables`; unchanged if too long."""
    if not is_expandable(expression, largest=MOST_TERMS):
        return expression
    return gathered(sp.expand(expression), *variables)


def gathered(expression: sp.Expr, *variables: sp.Symbol) -> sp.Expr:
    """`expression` with one term for each function of `variables`; products of sums are kept.

    The square of a difference is accurate where the difference is small, its expansion is not.
    """
    coefficients: dict[sp.Expr, sp.Expr] = {}
    for coefficient, dependent in _terms(expression, variables):
        coefficients[dependent] = coefficients.get(dependent, sp.S.Zero) + coefficient
    return sp.Add(*(sp.factor_terms(c) * dependent for dependent, c in coefficients.items()))


def _terms(
    expression: sp.Expr, variables: tuple[sp.Symbol, ...]
) -> Iterator[tuple[sp.Expr, sp.Expr]]:
    """Terms of a sum, also of one with a constant factor: their coefficients and functions."""
    for term in sp.Add.make_args(expression):
        coefficient, dependent = term.as_independent(*variables, as_Add=False)
        if dependent.is_Add:
            for inner, function in _terms(dependent, variables):
                yield coefficient * inner, function
        else:
            yield coefficient, dependent


def _halves(expression: sp.Expr) -> dict[sp.Expr, sp.Expr]:
    """Half the arguments of sines and cosines, where it is an integer combination of angles."""
    halves = {wave: wave.args[0] / 2 for wave in expression.atoms(sp.sin, sp.cos)}
    return {
        wave: half
        for wave, half in halves.items()
        if all(c.is_Integer for c in half.as_coefficients_dict().values())
    }


def _halved(waves: sp.Expr, halves: dict[sp.Expr, sp.Expr], square: Square) -> sp.Expr:
    """`waves` with cos 2a as a square and sin 2a as a product."""
    replacements = {
        wave: square(half) if isinstance(wave, sp.cos) else 2 * sp.sin(half) * sp.cos(half)
        for wave, half in halves.items()
    }
    return sp.expand(waves.xreplace(replacements))
