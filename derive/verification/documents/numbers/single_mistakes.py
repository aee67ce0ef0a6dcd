"""Formulas that hold but for one term: which of the meanings of letters are still supported."""

import ast
from collections.abc import Callable, Iterator, Sequence
from functools import cache

import numpy as np

from derive.formulas.syntax import ExpressionError, place, summands, syntax_tree
from derive.verification.documents.jets import Array, Jet, Value

#: The largest relative variation of a ratio that counts as none.
CONSTANT = 1e-6
#: Terms of a side that are multiplied out.
MAX_TERMS = 60
SWAPPED = {"sin": "cos", "cos": "sin"}


def is_near(
    sides: Sequence[str], value: Callable[[str], Value | None], velocities: Sequence[Array]
) -> Array | None:
    """For each candidate, whether one changed term makes both sides equal; None if unknown.

    The change is a constant factor, such as a sign or a parameter, a sine for a cosine, or a
    velocity more or less.
    """
    terms = [
        (sign * side_sign, text)
        for side_sign, side in zip((1, -1), sides, strict=True)
        for text, sign in _terms(side)
    ]
    values = [value(text) for _, text in terms]
    jets = [one for one in values if isinstance(one, Jet)]
    if not terms or len(jets) < len(values):
        return None
    with np.errstate(all="ignore"):
        arrays = [sign * one.value for (sign, _), one in zip(terms, jets, strict=True)]
        total = sum(np.broadcast_arrays(*arrays)) if len(arrays) > 1 else arrays[0]
        result = np.zeros(1, bool)
        for (_, text), own in zip(terms, arrays, strict=True):
            rest = own - total
            for other in _variants(text, own, value, velocities):
                result = result | _are_constant(rest, other)
    return result


def _are_constant(values: Array, others: Array) -> Array:
    """For each candidate, whether the ratio of two values is the same at all states."""
    ratios = (values / others).T
    first, last = ratios[0], ratios[-1]
    if not np.any(np.abs(first - last) <= 2 * CONSTANT * np.abs(first)):  # as for most
        return np.zeros(1, bool)
    ratios = np.ascontiguousarray(ratios)  # reduced much faster along the first axis
    middle = np.abs(ratios).mean(axis=0)
    spread = np.where(np.isfinite(middle), np.ptp(ratios, axis=0), np.inf)
    return (spread <= CONSTANT * middle) & np.isfinite(spread)


@cache  # many systems are tried for each formula
def _terms(side: str) -> tuple[tuple[str, int], ...]:
    """The terms of a sum and their signs; those in brackets are multiplied out."""
    try:
        terms = (*_distributed(syntax_tree(side)),)
    except ExpressionError:
        return ()
    return terms if len(terms) <= MAX_TERMS else ((side, 1),)


def _distributed(node: ast.expr) -> Iterator[tuple[str, int]]:
    match node:
        case ast.BinOp(op=ast.Add() | ast.Sub()):
            for part, sign in summands(node):
                yield from ((text, sign * own) for text, own in _distributed(part))
        case ast.UnaryOp(operand=operand):
            yield from ((text, -sign) for text, sign in _distributed(operand))
        case ast.BinOp(left=left, op=ast.Div(), right=right):
            below = ast.unparse(right)
            yield from ((f"({text})/({below})", sign) for text, sign in _distributed(left))
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            others = [*_distributed(right)]
            for text, sign in _distributed(left):
                yield from ((f"({text})*({other})", sign * own) for other, own in others)
        case _:
            yield ast.unparse(node), 1


def _variants(
    text: str, own: Array, value: Callable[[str], Value | None], velocities: Sequence[Array]
) -> Iterator[Array]:
    """The term, and terms that a slip of the pen makes of it."""
    yield own
    for swapped in _swapped(text):
        if isinstance(other := value(swapped), Jet):
            yield other.value
    for speed in velocities:
        yield own * speed
        yield own / speed


@cache
def _swapped(text: str) -> tuple[str, ...]:
    """The term with one sine for a cosine, or the other way round."""
    nodes = [node for node in ast.walk(syntax_tree(text)) if isinstance(node, ast.Call)]
    functions = [one.func for one in nodes if isinstance(one.func, ast.Name)]
    places = [(place(text, one), SWAPPED[one.id]) for one in functions if one.id in SWAPPED]
    return tuple(text[:start] + other + text[end:] for (start, end), other in places)
