"""Expressions of programs, whatever their language."""

from __future__ import annotations

from dataclasses import dataclass, field

#: Numbers, names and operations of the largest expression, written out, and its levels.
MAX_SIZE, MAX_DEPTH = 5_000, 120


@dataclass(frozen=True)
class Tree:
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
    def parts(self) -> tuple[Tree, ...]:
        """The expressions that it consists of."""
        return ()


@dataclass(frozen=True)
class Number(Tree):
    """A number in decimal digits."""

    digits: str


@dataclass(frozen=True)
class Text(Tree):
    """A quoted text."""

    value: str


@dataclass(frozen=True)
class Name(Tree):
    """A variable, or an entry or member of one, such as ``y[0]`` or ``self.theta``."""

    path: str


@dataclass(frozen=True)
class Member(Tree):
    """A member of an object."""

    base: Tree
    name: str

    @property
    def parts(self) -> tuple[Tree, ...]:  # noqa: D102
        return (self.base,)


@dataclass(frozen=True)
class Item(Tree):
    """Entries of an array."""

    base: Tree
    indices: tuple[Tree, ...]

    @property
    def parts(self) -> tuple[Tree, ...]:  # noqa: D102
        return (self.base, *self.indices)


@dataclass(frozen=True)
class Slice(Tree):
    """A range of indices as an index; a bound that is not written is None."""

    lower: Tree | None
    upper: Tree | None


@dataclass(frozen=True)
class Operation(Tree):
    """A sum, difference, product, quotient, power (``+ - * / **``), matrix product or solution.

    The matrix product is ``@`` and the solution of a linear system is ``solve``; one operand is
    negated with ``-``. Of ``transpose``, the operand is a matrix.
    """

    operator: str
    operands: tuple[Tree, ...]

    @property
    def parts(self) -> tuple[Tree, ...]:  # noqa: D102
        return self.operands


@dataclass(frozen=True)
class Call(Tree):
    """A function and its arguments."""

    function: Tree
    arguments: tuple[Tree, ...]
    keywords: tuple[tuple[str, Tree], ...] = ()

    @property
    def parts(self) -> tuple[Tree, ...]:  # noqa: D102
        return (self.function, *self.arguments, *(value for _, value in self.keywords))


@dataclass(frozen=True)
class Result(Tree):
    """The value of a call, or of an entry of it, that has been followed."""

    call: Tree
    value: Tree

    @property
    def parts(self) -> tuple[Tree, ...]:  # noqa: D102
        return (self.value,)


@dataclass(frozen=True)
class Array(Tree):
    """Several values in order: an array, a tuple, or a row of a matrix."""

    items: tuple[Tree, ...]

    @property
    def parts(self) -> tuple[Tree, ...]:  # noqa: D102
        return self.items


@dataclass(frozen=True)
class Record(Tree):
    """Values with names: a dictionary or an object."""

    fields: tuple[tuple[str, Tree], ...]

    @property
    def parts(self) -> tuple[Tree, ...]:  # noqa: D102
        return tuple(value for _, value in self.fields)


@dataclass(frozen=True)
class Choice(Tree):
    """A value that a conditional statement may change."""

    before: Tree
    after: Tree

    @property
    def parts(self) -> tuple[Tree, ...]:  # noqa: D102
        return (self.before, self.after)


@dataclass(frozen=True)
class Opaque(Tree):
    """A value that cannot be followed, and why."""

    reason: str


def replaced(tree: Tree, parts: tuple[Tree, ...]) -> Tree:
    """The same kind of expression with other parts."""
    match tree:
        case Operation():
            return Operation(tree.line, tree.operator, parts)
        case Array():
            return Array(tree.line, parts)
        case Result():
            return Result(tree.line, tree.call, parts[0])
        case Choice():
            return Choice(tree.line, *parts)
        case Item():
            return Item(tree.line, parts[0], parts[1:])
        case Member():
            return Member(tree.line, parts[0], tree.name)
        case Record():
            names = (name for name, _ in tree.fields)
            return Record(tree.line, tuple(zip(names, parts, strict=True)))
        case Call():
            count = 1 + len(tree.arguments)
            names = (name for name, _ in tree.keywords)
            keywords = tuple(zip(names, parts[count:], strict=True))
            return Call(tree.line, parts[0], parts[1:count], keywords)
    return tree
