"""The model of a document: sections of paragraphs, tables, numbered formulas and code.

Formulas inside texts are in backquotes, in the syntax of `derive.formulas.expression`.
"""

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

import sympy as sp

from derive.formulas.syntax import syntax_tree
from derive.formulas.typeset.textbook_order import TextbookOrder

#: Width of the lines of formulas, in digits.
WIDTH = 78


@dataclass(frozen=True)
class Paragraph:
    """Sentences; formulas are in backquotes."""

    text: str


@dataclass(frozen=True)
class NumberedEquation:
    """A numbered formula ``before = value = after``.

    Attributes
    ----------
    number : int
        Its number in the document.
    before, after : tuple of str
        Sides in the syntax of formulas, such as ``("L", "T - V")``; `after` is often ``("0",)``.
    value : sympy.Expr or sympy.Matrix, optional
        The derived side; None where the formula only relates names.
    order : TextbookOrder
        The order of the factors and terms of `value`.
    is_given : bool
        Whether it belongs to the definition of the system.
    is_blank : bool
        Whether `value` is replaced by space to write on.
    """

    number: int
    before: tuple[str, ...]
    value: sp.Expr | sp.MatrixBase | None
    after: tuple[str, ...]
    order: TextbookOrder
    is_given: bool = False
    is_blank: bool = False

    @property
    def known(self) -> tuple[list[ast.expr], list[ast.expr]]:
        """The sides before and after the derived one."""
        return [*map(syntax_tree, self.before)], [*map(syntax_tree, self.after)]

    @property
    def sides(self) -> list[ast.expr]:
        """All sides."""
        before, after = self.known
        return [*before, *([] if self.value is None else [self.order.tree(self.value)]), *after]


@dataclass(frozen=True)
class HandoutTable:
    """Rows of texts; formulas are in backquotes."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Code:
    """A function in a programming language."""

    language: str
    text: str
    is_executable: bool  # in a notebook


Block: TypeAlias = Paragraph | NumberedEquation | HandoutTable | Code


@dataclass(frozen=True)
class HandoutSection:
    """A heading and the blocks below it."""

    title: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class HandoutDocument:
    """A title and sections."""

    title: str
    sections: tuple[HandoutSection, ...]

    @property
    def equations(self) -> Iterator[NumberedEquation]:
        """The numbered formulas, in order."""
        blocks = (block for section in self.sections for block in section.blocks)
        return (block for block in blocks if isinstance(block, NumberedEquation))


@dataclass(frozen=True)
class TextPiece:
    """A part of a text: plain words, or a formula."""

    text: str
    tree: ast.expr | None = None


def pieces(text: str) -> Iterator[TextPiece]:
    """Split a text at its backquotes."""
    for k, part in enumerate(text.split("`")):
        if part:
            yield TextPiece(part, syntax_tree(part) if k % 2 else None)


def in_text(*trees: ast.expr) -> str:
    """Formulas in a sentence."""
    *first, last = (f"`{ast.unparse(tree)}`" for tree in trees)
    return f"{', '.join(first)} and {last}" if first else last
