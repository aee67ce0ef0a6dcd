"""The first part of a formula that differs from another formula."""

from collections.abc import Sequence
from typing import Any, TypeAlias

from derive.reading.latex.tree import Node, Product, Span, Statement, Sum
from derive.verification.report.report_latex import text

#: Trees and their signs.
Parts: TypeAlias = list[tuple[Node, int]]


def first_difference(written: Statement, correct: Statement) -> Span:
    """The span of the smallest part in which a statement first differs from the correct one."""
    if written.relations == correct.relations:
        for one, other in zip(written.sides, correct.sides, strict=True):
            if _name(one) != _name(other):
                return _difference(one, other)
    return written.span


def _difference(written: Node, correct: Node) -> Span:
    parts, others = _parts(written), _parts(correct)
    if type(written) is not type(correct):
        return written.span
    if len(parts) != len(others):
        return _surplus(written, parts, others)
    end = written.span[0]
    for (one, mark), (other, other_mark) in zip(parts, others, strict=True):
        if mark != other_mark:  # with the sign before it
            return end, one.span[1]
        if _name(one) != _name(other):
            return _difference(one, other)
        end = one.span[1]
    return written.span


def _surplus(written: Node, parts: Parts, others: Parts) -> Span:
    """The terms or factors without those at the start and at the end that are correct."""
    names = [[(_name(one), mark) for one, mark in side] for side in (parts, others)]
    first = _common(*names)
    rest = parts[first : len(parts) - _common(names[0][first:][::-1], names[1][first:][::-1])]
    if not rest or not isinstance(written, Sum | Product):
        return written.span
    start = rest[0][0].span[0]
    if isinstance(written, Sum):  # with the sign before it
        start = parts[first - 1][0].span[1] if first else written.span[0]
    return start, rest[-1][0].span[1]


def _common(one: Sequence[object], other: Sequence[object]) -> int:
    """The number of equal items at the start."""
    pairs = zip(one, other, strict=False)
    return next((k for k, (a, b) in enumerate(pairs) if a != b), min(len(one), len(other)))


def _parts(node: Node) -> Parts:
    """The trees directly within a tree, with their signs."""
    if isinstance(node, Sum):
        return [(term, sign) for sign, term in node.terms]
    result: Parts = []
    waiting: list[Any] = [getattr(node, name) for name in node.__dataclass_fields__]
    while waiting:
        one = waiting.pop(0)
        if isinstance(one, Node):
            result.append((one, 1))
        elif isinstance(one, tuple):
            waiting[:0] = one
    return result


def _name(node: Node) -> str:
    return text(Statement((node,), (), node.span))
