"""Parts of syntax trees, and trees with other indices."""

from collections.abc import Callable, Collection, Iterator
from dataclasses import replace
from typing import Any

from derive.reading.latex.tree import Letter, Node, Summation


def indexed(node: Node, index: str, value: int) -> Node:
    """The tree with a number in place of a letter that is an index."""

    def changed(letter: Letter) -> Letter:
        words = letter.index.split("_") if letter.index else []
        return replace(letter, index="_".join(str(value) if w == index else w for w in words))

    result: Node = with_letters(node, changed)
    return result


def with_letters(node: Any, change: Callable[[Letter], Letter]) -> Any:
    """A tree, or a tuple of trees, with other letters."""

    def changed(part: Any) -> Any:
        if isinstance(part, Letter):
            return change(part)
        if isinstance(part, tuple):
            return tuple(map(changed, part))
        if isinstance(part, Node):
            names = [name for name in part.__dataclass_fields__ if name != "span"]
            return replace(part, **{name: changed(getattr(part, name)) for name in names})
        return part

    return changed(node)


def nodes(node: object) -> Iterator[Node]:
    """A tree and all trees within it."""
    if isinstance(node, Node):
        yield node
        for name in node.__dataclass_fields__:
            yield from nodes(getattr(node, name))
    elif isinstance(node, tuple):
        for one in node:
            yield from nodes(one)


def letters(node: Node) -> Iterator[Letter]:
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
