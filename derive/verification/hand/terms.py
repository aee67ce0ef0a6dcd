"""Sums compared term by term: which term of a formula, as it is written, is the first wrong one."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator
from dataclasses import dataclass

import sympy as sp

from derive.formulas.expression import Scope, evaluate, syntax_tree
from derive.mechanics.reduction import collected, harmonics

#: Coefficients, of parameters, by what they multiply, a function of the state.
Terms = dict[sp.Expr, sp.Expr]


@dataclass(frozen=True)
class Written:
    """A term of a sum: as it is written, with its sign, and its value.

    Attributes
    ----------
    text : str
        As it is written.
    value : sympy.Expr
        What it adds to the sum.
    side : {1, -1}
        -1 for a term on the right of an equation, which is to be taken from its left.
    """

    text: str
    value: sp.Expr
    side: int = 1


@dataclass(frozen=True)
class Slip:
    """Where a formula first differs from what it should be.

    Attributes
    ----------
    term : str
        The first wrong term, as it is written; empty if one is missing.
    should_be : sympy.Expr
        What should stand in its place.
    """

    term: str
    should_be: sp.Expr


def written(text: str, scope: Scope) -> list[Written]:
    """The terms of a formula, in the order in which they are written."""
    text = text.strip()
    return [
        Written(f"{'' if sign > 0 else '-'}{ast.unparse(node)}", sign * evaluate(node, text, scope))
        for sign, node in _summands(syntax_tree(text), 1)
    ]


def _summands(node: ast.expr, sign: int) -> Iterator[tuple[int, ast.expr]]:
    match node:
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub() as operator, right=right):
            yield from _summands(left, sign)
            yield from _summands(right, sign if isinstance(operator, ast.Add) else -sign)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            yield from _summands(operand, -sign)
        case _:
            yield sign, node


def terms(expression: sp.Expr, state: Collection[sp.Symbol]) -> Terms:
    """The expression as a sum over functions of the state, products of waves written as sums."""
    found: Terms = {}
    for term in sp.Add.make_args(sp.expand(harmonics(expression))):
        coefficient, dependent = term.as_independent(*state, as_Add=False)
        found[dependent] = found.get(dependent, sp.S.Zero) + coefficient
    reduced = {dependent: sp.cancel(coefficient) for dependent, coefficient in found.items()}
    return {dependent: coefficient for dependent, coefficient in reduced.items() if coefficient}


def _compared(
    parts: Collection[Written], right: sp.Expr, state: Collection[sp.Symbol]
) -> tuple[Terms, Terms]:
    """The terms of the sum that is written, and those of `right`."""
    return terms(sp.Add(*(part.value for part in parts)), state), terms(right, state)


def wrong(
    parts: Collection[Written], right: sp.Expr, state: Collection[sp.Symbol]
) -> list[sp.Expr]:
    """Functions of the state that have another coefficient than in `right`."""
    have, wanted = _compared(parts, right, state)
    return [d for d in {**have, **wanted} if sp.cancel(have.get(d, 0) - wanted.get(d, 0))]


def slip(parts: Collection[Written], right: sp.Expr, state: Collection[sp.Symbol]) -> Slip | None:
    """The first of the terms written that differs from `right`; None where none does."""
    (have, wanted), differing = _compared(parts, right, state), wrong(parts, right, state)
    if not differing:
        return None
    by_part = [(part, terms(part.value, state)) for part in parts]
    told = {dependent for _, own in by_part for dependent in own}
    nowhere = [dependent for dependent in differing if dependent not in told]
    for part, own in by_part:
        mistaken = [dependent for dependent in differing if dependent in own]
        if mistaken:
            rest = {d: sp.cancel(have.get(d, 0) - own[d]) for d in mistaken}
            place = sp.Add(*(
                (wanted.get(d, 0) - rest.get(d, 0)) * d for d in [*mistaken, *nowhere]
            ))  # fmt: skip
            return Slip(part.text, _short(part.side * place, state))
    return Slip("", _short(sp.Add(*(wanted[d] * d for d in nowhere)), state))


def scale(
    parts: Collection[Written], right: sp.Expr, state: Collection[sp.Symbol],
    trusted: Collection[sp.Symbol] = (),
) -> sp.Expr:  # fmt: skip
    """The factor with which `right` agrees with most of the terms written.

    Equations may have one. Where opinions are divided, terms with `trusted` symbols decide.

    Parameters
    ----------
    parts : collection of Written
        The terms of the sum that is written.
    right : sympy.Expr
        What the sum should be, up to a factor.
    state : collection of sympy.Symbol
        All that changes; the factor is made of other symbols.
    trusted : collection of sympy.Symbol
        Whose terms count first, such as accelerations.

    Returns
    -------
    sympy.Expr
        1 if both sums have no term in common.
    """
    have, wanted = _compared(parts, right, state)
    shared = [dependent for dependent in have if dependent in wanted]
    shared.sort(key=lambda dependent: not dependent.free_symbols & {*trusted})
    ratios = [sp.cancel(have[dependent] / wanted[dependent]) for dependent in shared]
    return max(ratios, key=ratios.count, default=sp.S.One)


def _short(expression: sp.Expr, state: Collection[sp.Symbol]) -> sp.Expr:
    return collected(expression, *state) if expression else sp.S.Zero
