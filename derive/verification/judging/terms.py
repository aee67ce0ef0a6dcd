"""Term-by-term comparison of sums: coefficients of functions of the state."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import sympy as sp

from derive.formulas.expression import Namespace, number
from derive.mechanics.energies.reduction import Harmonics, collected

#: Coefficients, which depend on parameters only, by the function of the state that they multiply.
Coefficients = dict[sp.Expr, sp.Expr]
Symbols = Collection[sp.Symbol]


@dataclass(frozen=True)
class Term:
    """A term of a printed sum, or of the difference of the sides of an equation."""

    value: sp.Expr
    side: int  # -1 on the right of an equation


def difference(text: str, namespace: Namespace) -> sp.Expr:
    """Left minus right side of an equation; the value of a formula without an equals sign."""
    left, equals, right = text.partition("=")
    return number(left, namespace) - (number(right, namespace) if equals else sp.S.Zero)


def coefficients(expression: sp.Expr, state: Symbols) -> Coefficients:
    """Expand `expression` over functions of the state, with products of waves as sums."""
    totals: Coefficients = {}
    for term in sp.Add.make_args(sp.expand(Harmonics(expression).sum)):
        coefficient, function = term.as_independent(*state, as_Add=False)
        totals[function] = totals.get(function, sp.S.Zero) + coefficient
    return {f: reduced for f, coefficient in totals.items() if (reduced := sp.cancel(coefficient))}


def closest_factor(
    printed: Coefficients, correct: Coefficients, decisive: Symbols
) -> tuple[int, sp.Expr]:
    """Return by which factor most terms differ from correct ones, and how many still differ.

    In a tie, terms with decisive symbols such as accelerations decide.
    """
    shared = [function for function in printed if function in correct]
    shared.sort(key=lambda function: not function.free_symbols & {*decisive})
    ratios = [sp.cancel(printed[function] / correct[function]) for function in shared]
    factor = max(ratios, key=ratios.count, default=sp.S.One)
    return len({*printed, *correct}) - ratios.count(factor), factor


def corrected_terms(
    terms: Sequence[Term], derived: sp.Expr, state: Symbols
) -> tuple[dict[int, sp.Expr], sp.Expr]:
    """Return corrections of wrong terms, as printed, by index, and the sum of missing terms.

    With all corrections the terms have the sum `derived`. A function of the state that occurs in
    several terms is corrected in the first.
    """
    printed = coefficients(sp.Add(*(term.value for term in terms)), state)
    correct = coefficients(derived, state)
    pairs = {
        f: (correct.get(f, sp.S.Zero), printed.get(f, sp.S.Zero)) for f in {**printed, **correct}
    }
    changes = {f: change for f, (a, b) in pairs.items() if (change := sp.cancel(a - b))}
    corrected: dict[int, sp.Expr] = {}
    for index, term in enumerate(terms):
        own = coefficients(term.value, state)
        wrong = [function for function in own if function in changes]
        if wrong:
            for function in wrong:
                own[function] = sp.cancel(own[function] + changes.pop(function))
            corrected[index] = sp.Add(*(c * f for f, c in own.items()))
    missing = sp.Add(*(c * f for f, c in changes.items()))
    for index, value in corrected.items():
        if missing and not value:  # a wrong function has the place of a missing one
            corrected[index], missing = missing, sp.S.Zero
    whole = {k: _collected(terms[k].side * value, state) for k, value in corrected.items()}
    return whole, _collected(missing, state)


def _collected(expression: sp.Expr, state: Symbols) -> sp.Expr:
    return collected(expression, *state) if expression else sp.S.Zero
