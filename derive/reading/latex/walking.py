"""Parts of syntax trees, and trees with other indices."""

from collections.abc import Callable, Collection, Iterator
from dataclasses import replace
from typing import Any

from derive.reading.latex.tree import Letter, Node, Power, Product, Summation

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
