"""Term-by-term comparison of sums: coefficients of functions of the state."""

import ast
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

import sympy as sp

from derive.formulas.expression import ExpressionError, Scope, evaluate, syntax_tree
from derive.mechanics.reduction import collected, harmonics

#: Coefficients, which depend on parameters only, by the function of the state that they multiply.
Coefficients = dict[sp.Expr, sp.Expr]
Symbols = Collection[sp.Symbol]


@dataclass(frozen=True)
class Term:
    """A term of a printed sum, or of the difference of the sides of an equation."""

    text: str  # as printed, with its sign
    value: sp.Expr
    side: int = 1  # -1 on the right of an equation


Terms = Collection[Term]


def split_terms(text: str, scope: Scope, side: int = 1) -> list[Term]:
    """Split a formula into its terms, in printed order."""
    text = text.strip()
    terms = []
    for sign, node in _summands(syntax_tree(text), 1):
        printed = f"{'' if sign > 0 else '-'}{ast.unparse(node)}"
        value = side * sign * evaluate(node, text, scope)
        if isinstance(value, sp.MatrixBase):
            raise ExpressionError(f"{printed[:50]!r} is a column or matrix, not a number")
        terms.append(Term(printed, value, side))
    return terms


def terms_of_equation(text: str, scope: Scope) -> list[Term]:
    """Split the difference of the sides of an equation; without an equals sign, a formula."""
    left, equals, right = text.partition("=")
    return split_terms(left, scope) + (split_terms(right, scope, -1) if equals else [])


def _summands(node: ast.expr, sign: int) -> Iterator[tuple[int, ast.expr]]:
    match node:
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub() as operator, right=right):
            yield from _summands(left, sign)
            yield from _summands(right, sign if isinstance(operator, ast.Add) else -sign)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            yield from _summands(operand, -sign)
        case _:
            yield sign, node


def coefficients(expression: sp.Expr, state: Symbols) -> Coefficients:
    """Expand `expression` over functions of the state, with products of waves as sums."""
    totals: Coefficients = {}
    for term in sp.Add.make_args(sp.expand(harmonics(expression))):
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
) -> tuple[list[tuple[Term, sp.Expr]], sp.Expr]:
    """Return the wrong terms with corrections of their values, and the sum of missing terms.

    With all corrections the terms have the sum `derived`. A function of the state that occurs in
    several terms is corrected in the first.
    """
    printed = coefficients(sp.Add(*(term.value for term in terms)), state)
    correct = coefficients(derived, state)
    pairs = {
        f: (correct.get(f, sp.S.Zero), printed.get(f, sp.S.Zero)) for f in {**printed, **correct}
    }
    changes = {f: change for f, (a, b) in pairs.items() if (change := sp.cancel(a - b))}
    corrected = []
    for term in terms:
        own = coefficients(term.value, state)
        wrong = [function for function in own if function in changes]
        if wrong:
            for function in wrong:
                own[function] = sp.cancel(own[function] + changes.pop(function))
            corrected.append((term, sp.Add(*(c * f for f, c in own.items()))))
    missing = sp.Add(*(c * f for f, c in changes.items()))
    for k, (term, value) in enumerate(corrected):
        if missing and not value:  # a wrong function has the place of a missing one
            corrected[k], missing = (term, missing), sp.S.Zero
    whole = [(term, _collected(term.side * value, state)) for term, value in corrected]
    return whole, _collected(missing, state)


def _collected(expression: sp.Expr, state: Symbols) -> sp.Expr:
    return collected(expression, *state) if expression else sp.S.Zero
