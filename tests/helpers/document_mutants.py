"""Mistakes planted in the LaTeX of documents: a sign, an index, a power, a function, a factor."""

from collections.abc import Iterator
from dataclasses import dataclass

from derive.reading.document import Document
from derive.reading.latex.display_reader import formulas
from derive.reading.latex.tree import (
    Call,
    Letter,
    Matrix,
    Node,
    Number,
    Power,
    Product,
    Statement,
    Sum,
    nodes,
)


@dataclass(frozen=True)
class Mutant:
    """A text with one mistake, its kind and place, and the first character of its formula."""

    kind: str
    text: str
    place: int
    formula: int
    change: str


def mutants(document: Document) -> Iterator[Mutant]:
    """Yield the mistakes in all displays of a document."""
    for display in document.displays:
        for statement in formulas(display.latex, {}):
            if isinstance(statement, Statement) and not display.is_inline:
                for kind, start, end, new in changes(display.latex, statement):
                    first, last = display.start + start, display.start + end
                    old = document.text[first:last]
                    text = document.text[:first] + new + document.text[last:]
                    formula = display.start + statement.span[0]
                    yield Mutant(kind, text, first, formula, f"{old} -> {new}")


def changes(latex: str, statement: Statement) -> Iterator[tuple[str, int, int, str]]:
    """Yield kinds of mistakes in a statement, their first and last character, and the new text."""
    first, *others = statement.sides
    # another name on the left defines another quantity
    sides = others if isinstance(first, Letter | Matrix) else statement.sides
    for node in nodes(tuple(sides)):
        yield from _of_node(latex, node)


def _of_node(latex: str, node: Node) -> Iterator[tuple[str, int, int, str]]:
    source = latex[slice(*node.span)]
    match node:
        case Sum(terms=terms):
            for _, term in terms:
                head = latex[: term.span[0]].rstrip()
                if head[-1:] in ("+", "-"):
                    yield "sign", len(head) - 1, len(head), "-" if head[-1] == "+" else "+"
        case Letter(index="1" | "2" as index):
            at = node.span[0] + source.rindex(index)
            yield "index", at, at + 1, "1" if index == "2" else "2"
        case Power(exponent=Number(digits=digits, span=span)):
            yield "power", *span, "3" if digits == "2" else "2"
        case Call(function="sin" | "cos" as function) if function in source:
            at = node.span[0] + source.index(function)
            yield "function", at, at + 3, "cos" if function == "sin" else "sin"
        case Number(digits="2"):
            yield "factor", *node.span, "5"
        case Product(factors=factors):
            for one in factors:
                if isinstance(one, Letter) and not one.dots:
                    yield "omission", *one.span, "{}"
