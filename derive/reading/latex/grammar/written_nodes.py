"""Parts of an expression while it is read: nodes, and the marks of how they are written."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeAlias

from derive.reading.latex.layout.tokens import UnreadError
from derive.reading.latex.tree import Letter, Node, Product, Span


@dataclass(frozen=True, slots=True)
class Symbol:
    """A terminal of the grammar, its value and its place."""

    type: str
    value: Any
    span: Span


@dataclass(frozen=True)
class WrittenNode:
    """A node and how it is written: in brackets, in braces, as an argument, or as a bare call."""

    node: Node
    span: Span
    form: Literal["brackets", "braces", "argument", "bare"]


@dataclass(frozen=True)
class Operator:
    """A derivative without its operand, such as d/dt."""

    variables: tuple[Node, ...]
    is_partial: bool
    span: Span


@dataclass(frozen=True)
class SumSign:
    """The sign of a sum without its terms."""

    indices: tuple[Letter, ...]
    lower: Node | None
    upper: Node | None
    span: Span


Part: TypeAlias = Any  # a node, a symbol, or one of the classes above


def around(children: Sequence[Part]) -> Span:
    """The place of all parts together."""
    return min(c.span[0] for c in children), max(c.span[1] for c in children)


def node(part: Part) -> Node:
    """The expression of a part; brackets and braces belong to its place."""
    if isinstance(part, Symbol):
        return part.value
    if isinstance(part, WrittenNode):
        is_enclosed = part.form in ("brackets", "braces")
        return replace(part.node, span=part.span) if is_enclosed else part.node
    if isinstance(part, Operator):
        raise UnreadError("a derivative has no operand")
    if isinstance(part, SumSign):
        raise UnreadError("a sum has no terms")
    return part


def is_symbol(part: Part, *types: str) -> bool:
    """Whether a part is a terminal of one of the types."""
    return isinstance(part, Symbol) and part.type in types


def factors_of(factors: Node) -> tuple[Node, ...]:
    """The factors of a product; anything else is one factor."""
    return factors.factors if isinstance(factors, Product) else (factors,)


def product(factors: list[Node]) -> Node:
    """A product without products in it; a single factor is itself."""
    if len(factors) == 1:
        return factors[0]
    flat = tuple(inner for factor in factors for inner in factors_of(factor))
    return Product(flat, around(factors))
