"""Expressions of programs, whatever their language."""

from __future__ import annotations

from dataclasses import dataclass, field

#: Numbers, names and operations of the largest expression, written out, and its levels.
MAX_SIZE, MAX_DEPTH = 5_000, 120


@dataclass(frozen=True)
class Expression:
    """An expression; equal ones can stand on different lines."""

    line: int = field(compare=False)

    def __post_init__(self) -> None:
        # nodes and levels of the expression, written out
        size = depth = 1
        for part in self.parts:
            size += part.size
            depth = max(depth, part.depth + 1)
        object.__setattr__(self, "size", size)
        object.__setattr__(self, "depth", depth)

    size: int = field(init=False, repr=False, compare=False)
    depth: int = field(init=False, repr=False, compare=False)

    @property
    def parts(self) -> tuple[Expression, ...]:
        """The expressions that it consists of."""
        return ()


@dataclass(frozen=True)
class NumberLiteral(Expression):
    """A number in decimal digits."""

    digits: str


@dataclass(frozen=True)
class TextLiteral(Expression):
    """A quoted text."""

    value: str


@dataclass(frozen=True)
class Name(Expression):
    """A variable, or an entry or member of one, such as ``y[0]`` or ``self.theta``."""

    path: str


@dataclass(frozen=True)
class Member(Expression):
    """A member of an object."""

    base: Expression
    name: str

    @property
    def parts(self) -> tuple[Expression, ...]:  # noqa: D102
        return (self.base,)


@dataclass(frozen=True)
class Item(Expression):
    """Entries of an array."""

    base: Expression
    indices: tuple[Expression, ...]

    @property
    def parts(self) -> tuple[Expression, ...]:  # noqa: D102
        return (self.base, *self.indices)


@dataclass(frozen=True)
class Slice(Expression):
    """A range of indices as an index; a bound that is not written is None."""

    lower: Expression | None
    upper: Expression | None


@dataclass(frozen=True)
class OperatorExpression(Expression):
    """A sum, difference, product, quotient, power (``+ - * / **``), matrix product or solution.

    The matrix product is ``@`` and the solution of a linear system is ``solve``; one operand is
    negated with ``-``. Of ``transpose``, the operand is a matrix.
    """

    operator: str
    operands: tuple[Expression, ...]

    @property
    def parts(self) -> tuple[Expression, ...]:  # noqa: D102
        return self.operands


@dataclass(frozen=True)
class FunctionCall(Expression):
    """A function and its arguments."""

    function: Expression
    arguments: tuple[Expression, ...]
    keywords: tuple[tuple[str, Expression], ...] = ()

    @property
    def parts(self) -> tuple[Expression, ...]:  # noqa: D102
        return (self.function, *self.arguments, *(value for _, value in self.keywords))


@dataclass(frozen=True)
class Result(Expression):
    """The value of a call, or of an entry of it, that has been followed."""

    call: Expression
    value: Expression

    @property
    def parts(self) -> tuple[Expression, ...]:  # noqa: D102
        return (self.value,)


@dataclass(frozen=True)
class Array(Expression):
    """Several values in order: an array, a tuple, or a row of a matrix."""

    items: tuple[Expression, ...]

    @property
    def parts(self) -> tuple[Expression, ...]:  # noqa: D102
        return self.items


@dataclass(frozen=True)
class Comprehension(Expression):
    """The array of an expression for each value of an index, from `lower` to before `upper`."""

    element: Expression
    variable: str
    lower: Expression
    upper: Expression

    @property
    def parts(self) -> tuple[Expression, ...]:  # noqa: D102
        return (self.element, self.lower, self.upper)


@dataclass(frozen=True)
class Record(Expression):
    """Values with names: a dictionary or an object."""

    fields: tuple[tuple[str, Expression], ...]

    @property
    def parts(self) -> tuple[Expression, ...]:  # noqa: D102
        return tuple(value for _, value in self.fields)


@dataclass(frozen=True)
class Choice(Expression):
    """A value that a conditional statement may change."""

    before: Expression
    after: Expression

    @property
    def parts(self) -> tuple[Expression, ...]:  # noqa: D102
        return (self.before, self.after)


@dataclass(frozen=True)
class Opaque(Expression):
    """A value that cannot be followed, and why."""

    reason: str


def replaced(tree: Expression, parts: tuple[Expression, ...]) -> Expression:
    """The same kind of expression with other parts."""
    match tree:
        case OperatorExpression():
            return OperatorExpression(tree.line, tree.operator, parts)
        case Array():
            return Array(tree.line, parts)
        case Result():
            return Result(tree.line, tree.call, parts[0])
        case Choice():
            return Choice(tree.line, *parts)
        case Comprehension():
            return Comprehension(tree.line, parts[0], tree.variable, *parts[1:])
        case Item():
            return Item(tree.line, parts[0], parts[1:])
        case Member():
            return Member(tree.line, parts[0], tree.name)
        case Record():
            names = (name for name, _ in tree.fields)
            return Record(tree.line, tuple(zip(names, parts, strict=True)))
        case FunctionCall():
            count = 1 + len(tree.arguments)
            names = (name for name, _ in tree.keywords)
            keywords = tuple(zip(names, parts[count:], strict=True))
            return FunctionCall(tree.line, parts[0], parts[1:count], keywords)
    return tree
