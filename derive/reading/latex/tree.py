"""Syntax trees of formulas in LaTeX.

A tree says what is written, not what it means: whether ``m(x + y)`` is a product or a function,
and whether a prime is a derivative, depends on the document. Every node has its span: the first
character and the one after the last, in the LaTeX of its display.
"""

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

Span: TypeAlias = tuple[int, int]


@dataclass(frozen=True)
class Number:
    """Digits with an optional decimal point."""

    digits: str
    span: Span


@dataclass(frozen=True)
class Letter:
    r"""A symbol with its index, dots and primes: ``\dot{\theta}_1``, ``\dot{\theta_1}``, ``x'``."""

    name: str  # "theta" of \theta, "L" of \mathcal{L}, "xbar" of \bar{x}, "l" of l, "ell" of \ell
    span: Span
    index: str = ""  # "1", "kin" of T_{\text{kin}}, "theta_1" of p_{\theta_1}, "eff"
    dots: int = 0
    primes: int = 0
    is_bold: bool = False  # also with an arrow: a column of numbers

    @property
    def identifier(self) -> str:
        """The letter and its index without dots and primes, such as ``p_theta_1``."""
        return f"{self.name}_{self.index}" if self.index else self.name


@dataclass(frozen=True)
class Sum:
    """Terms with their signs, 1 and -1; a single term with -1 is a negative number."""

    terms: tuple[tuple[int, "Node"], ...]
    span: Span


@dataclass(frozen=True)
class Product:
    """Factors side by side or with a sign of multiplication, none of which is a product."""

    factors: tuple["Node", ...]
    span: Span


@dataclass(frozen=True)
class Quotient:
    """A fraction in any spelling; behind a slash the next letter can belong to the denominator."""

    numerator: "Node"
    denominator: "Node"
    span: Span
    is_ambiguous: bool = False


@dataclass(frozen=True)
class Power:
    r"""A base and its exponent; of ``\sin^2\theta`` the base is the sine."""

    base: "Node"
    exponent: "Node"
    span: Span


@dataclass(frozen=True)
class Root:
    """The root of a number: of degree 2 if no other is written."""

    radicand: "Node"
    degree: int
    span: Span


@dataclass(frozen=True)
class Call:
    """A known function, such as sin, and its argument."""

    function: str  # sin, cos, tan, cot, sec, csc, asin, acos, atan, sinh, ..., exp, log, sign, det
    argument: "Node"
    span: Span


@dataclass(frozen=True)
class Application:
    """A letter before round brackets: a function of arguments, or a product."""

    head: Letter
    arguments: tuple["Node", ...]
    span: Span


@dataclass(frozen=True)
class Derivative:
    r"""A derivative written as a fraction: of ``\frac{\partial L}{\partial\dot q}`` by q̇."""

    operand: "Node"
    variables: tuple["Node", ...]  # one for each order
    is_partial: bool
    span: Span


@dataclass(frozen=True)
class Dotted:
    r"""Dots over an expression that is no letter, such as ``\dot{\theta^2}``."""

    operand: "Node"
    dots: int
    span: Span


@dataclass(frozen=True)
class Matrix:
    """Rows of entries; a column has rows of one entry."""

    rows: tuple[tuple["Node", ...], ...]
    span: Span


@dataclass(frozen=True)
class Tuple:
    """Several expressions in brackets, separated by commas, such as a position."""

    items: tuple["Node", ...]
    span: Span


@dataclass(frozen=True)
class Transpose:
    """A transposed matrix or column."""

    operand: "Node"
    span: Span


@dataclass(frozen=True)
class Norm:
    """An expression between bars."""

    operand: "Node"
    span: Span


@dataclass(frozen=True)
class AtPlace:
    r"""An expression before a bar with a place, which is not read: ``\left. f \right|_{x_0}``."""

    operand: "Node"
    span: Span


@dataclass(frozen=True)
class Summation:
    r"""``\sum`` with its index and bounds, if they are written."""

    body: "Node"
    index: Letter | None
    lower: "Node | None"
    upper: "Node | None"
    span: Span


Node: TypeAlias = (
    Number
    | Letter
    | Sum
    | Product
    | Quotient
    | Power
    | Root
    | Call
    | Application
    | Derivative
    | Dotted
    | Matrix
    | Tuple
    | Transpose
    | Norm
    | AtPlace
    | Summation
)


@dataclass(frozen=True)
class Statement:
    """Sides with relations between them.

    Relations are ``=``, ``:=``, ``~`` for ≈, ``<``, ``<=``, ``>``, ``>=``, ``!=``, ``->``, ``in``
    and ``:``. A single expression has one side and no relation.
    """

    sides: tuple[Node, ...]
    relations: tuple[str, ...]
    span: Span
    #: The sides with the lower one of two signs, of a statement with ± or ∓.
    other_sides: tuple[Node, ...] = ()


@dataclass(frozen=True)
class Unreadable:
    """A part of a display that cannot be read, and why."""

    reason: str
    span: Span


#: The letter of a difference of the letter behind it.
DIFFERENCE = "Delta"


def indexed(node: Node, index: str, value: int) -> Node:
    """The tree with a number in place of a letter that is an index."""

    def changed(letter: Letter) -> Letter:
        words = letter.index.split("_") if letter.index else []
        return replace(letter, index="_".join(str(value) if w == index else w for w in words))

    result: Node = with_letters(node, changed)
    return result


def with_letters(node: Any, change: Callable[[Letter], Letter]) -> Any:
    """A tree, or a tuple of trees, with other letters."""
    if isinstance(node, Letter):
        return change(node)
    return _with_parts(node, lambda part: with_letters(part, change))


def with_differences(node: Any) -> Any:
    r"""A tree, or a tuple of trees, with one letter for each ``\Delta x``."""
    if isinstance(node, Product):
        factors: list[Node] = []
        for one in node.factors:
            before = factors[-1] if factors else None
            if isinstance(before, Letter) and before.identifier == DIFFERENCE:
                other = _difference(before, one)
                if other is not None:
                    factors[-1] = other
                    continue
            factors.append(one)
        node = replace(node, factors=tuple(factors)) if len(factors) > 1 else factors[0]
    return _with_parts(node, with_differences)


def with_labels(node: Any, names: Collection[str]) -> Any:
    """A tree, or a tuple of trees, in which letters as exponents of some letters are indices.

    An exponent 0 is that of the fixed frame, in which a vector has its components.
    """
    match node:
        case Power(base=Letter(name=name) as base, exponent=Number(digits="0")) if name != "e":
            return replace(base, span=node.span)
        case Power(base=Letter() as base, exponent=Letter() as label) if base.name in names:
            index = "_".join(filter(None, (base.index, label.identifier)))
            return replace(base, index=index, span=node.span)
    return _with_parts(node, lambda part: with_labels(part, names))


def _difference(sign: Letter, node: Node) -> Node | None:
    """The letter behind a sign of differences with this as part of its name, or its power."""
    if isinstance(node, Power):
        base = _difference(sign, node.base)
        span = sign.span[0], node.span[1]
        return None if base is None else replace(node, base=base, span=span)
    if not isinstance(node, Letter):
        return None
    return replace(node, name=sign.name + node.name, span=(sign.span[0], node.span[1]))


def _with_parts(node: Any, change: Callable[[Any], Any]) -> Any:
    """A tree, or a tuple of trees, with changed parts."""
    if isinstance(node, tuple):
        return tuple(map(change, node))
    if isinstance(node, Node):
        names = [name for name in node.__dataclass_fields__ if name != "span"]
        return replace(node, **{name: change(getattr(node, name)) for name in names})
    return node


def nodes(node: object) -> Iterator[Node]:
    """A tree and all trees within it."""
    if isinstance(node, Node):
        yield node
        for name in node.__dataclass_fields__:
            yield from nodes(getattr(node, name))
    elif isinstance(node, tuple):
        for one in node:
            yield from nodes(one)


def letters(node: object) -> Iterator[Letter]:
    """All letters of a tree."""
    return (one for one in nodes(node) if isinstance(one, Letter))


def has_index(nodes: Collection[Node], index: str) -> bool:
    """Whether a letter has a letter as its index, which no sum binds."""

    def walk(part: object) -> bool:
        match part:
            case Summation(index=Letter(name=name)) if name == index:
                return False
            case Letter():
                return index in part.index.split("_")
            case tuple():
                return any(map(walk, part))
            case _ if isinstance(part, Node):
                return any(walk(getattr(part, name)) for name in part.__dataclass_fields__)
        return False

    return walk(tuple(nodes))
