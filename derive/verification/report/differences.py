"""The first part of a formula that differs from another formula."""

from typing import Any

from derive.reading.latex.tree import Node, Span, Statement, Sum
from derive.verification.report.reading import text


def first_difference(written: Statement, correct: Statement) -> Span:
    """The span of the smallest part in which a statement first differs from the correct one."""
    if written.relations == correct.relations:
        for one, other in zip(written.sides, correct.sides, strict=True):
            if _name(one) != _name(other):
                return _difference(one, other)
    return written.span


def _difference(written: Node, correct: Node) -> Span:
    parts, others = _parts(written), _parts(correct)
    if type(written) is not type(correct) or len(parts) != len(others):
        return written.span
    end = written.span[0]
    for (one, mark), (other, other_mark) in zip(parts, others, strict=True):
        if mark != other_mark:  # with the sign before it
            return end, one.span[1]
        if _name(one) != _name(other):
            return _difference(one, other)
        end = one.span[1]
    return written.span


def _parts(node: Node) -> list[tuple[Node, int]]:
    """The trees directly within a tree, with their signs."""
    if isinstance(node, Sum):
        return [(term, sign) for sign, term in node.terms]
    found: list[tuple[Node, int]] = []
    waiting: list[Any] = [getattr(node, name) for name in node.__dataclass_fields__]
    while waiting:
        one = waiting.pop(0)
        if isinstance(one, Node):
            found.append((one, 1))
        elif isinstance(one, tuple):
            waiting[:0] = one
    return found


def _name(node: Node) -> str:
    return text(Statement((node,), (), node.span))
