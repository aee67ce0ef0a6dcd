"""Functions with kinks or jumps, and the numbers whose signs decide between their branches.

Such a number is a switching function (E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary
Differential Equations I, section II.6): between its zeros, formulas are smooth.
"""

from collections.abc import Collection, Iterable, Iterator

import sympy as sp
from sympy.core.relational import Relational

#: Functions with kinks or jumps, and their derivatives.
CHOICES = (sp.Abs, sp.sign, sp.Max, sp.Min, sp.Heaviside, sp.DiracDelta, sp.Piecewise)


def switching_functions(
    expressions: Iterable[sp.Basic], variables: Collection[sp.Symbol]
) -> tuple[sp.Expr, ...]:
    """The switching functions of expressions that depend on `variables`, in a definite order.

    Of two that differ in their sign alone there is one. It comes after those in its own formula.
    """
    found: dict[sp.Expr, None] = {}
    for expression in expressions:
        for part in sorted(expression.atoms(*CHOICES), key=sp.default_sort_key):
            for number in _decisive(part):
                if number.free_symbols & {*variables} and -number not in found:
                    found[number] = None
    return tuple(sorted(found, key=lambda number: len(number.atoms(*CHOICES))))


def _decisive(part: sp.Expr) -> Iterator[sp.Expr]:
    if isinstance(part, sp.Piecewise):
        for relation in sorted(part.atoms(Relational), key=sp.default_sort_key):
            yield relation.lhs - relation.rhs
    elif isinstance(part, sp.Max | sp.Min):
        first, *rest = part.args
        for argument in rest:
            yield argument - first
            first = part.func(first, argument)
    else:
        yield part.args[0]
