r"""The statements of a display in LaTeX.

    tokens → without macros → without layout → words → statements → sides → symbols → syntax trees

Implicit products, and functions without brackets, are read by these rules:

- The bare argument of a function holds numbers and Latin letters up to and including the first
  Greek letter, and a ``t`` behind it: ``\sin 2\theta l`` is sin(2θ) l, ``\cos\omega t`` is cos(ωt).
  Without a Greek letter it ends with the first ``t``; several Latin letters without either are
  ambiguous, unless no space is between them as in ``\sin kx``. It ends before letters with dots,
  functions, fractions, roots and brackets, unless it starts with one of these. An exponent belongs
  to the letter before it: ``\sin\theta^2`` is sin(θ²), ``\sin(\theta)^2`` is sin(θ)².
- A letter before round brackets is an ``Application``, also with an exponent behind the brackets:
  ``m(x + y)^2`` is the power of an application. Behind a bare argument brackets are a factor.
- A slash divides the factor before it by the factor behind it. A number behind it takes the
  factors that follow without a space: ``p^2/2m`` is p²/(2m), but ``1/2m`` is (1/2) m. ``k/mx`` and
  ``\sin\theta/2`` are ambiguous.
- A derivative without an operand, d/dt, applies to the brackets behind it, or else to the rest of
  the term; so does a sum.

The span of an expression in brackets includes the brackets.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

from derive.reading.latex.grammar.build import Build
from derive.reading.latex.grammar.terminals import Terminals
from derive.reading.latex.grammar.written_nodes import Symbol
from derive.reading.latex.layout.latex_symbols import ELLIPSES
from derive.reading.latex.layout.layout_removal import Layout
from derive.reading.latex.layout.macros import Macro, expanded, macros_of
from derive.reading.latex.layout.pairs import inside, pairs
from derive.reading.latex.layout.plain_words import with_words
from derive.reading.latex.layout.rows import flattened, statements
from derive.reading.latex.layout.spellings import (
    with_dots_on_variables,
    with_fractions_of_derivatives,
    with_new_fonts,
    with_points_above,
    with_unicode_scripts,
)
from derive.reading.latex.layout.tokens import Token, UnreadError, tokenize
from derive.reading.latex.tree import Letter, Node, Span, Statement, Unreadable

__all__ = ["Macro", "formulas", "macros_of"]

#: Characters of a display.
MAX_LENGTH = 100_000
#: Signs above each other.
SIGNS = {"pm": "+-", "mp": "-+"}
#: Nodes within nodes.
MAX_TREE_DEPTH = 200
#: The number of an equation.
NUMBER = re.compile(r"\(\d+[a-z]?\(")  # a bracket that closes has the text of the other


def formulas(latex: str, macros: Mapping[str, Macro] = {}) -> list[Statement | Unreadable]:
    r"""The statements of a display, in order.

    Parameters
    ----------
    latex
        The text between the delimiters of the display. It may contain environments such as
        ``aligned``.
    macros
        Macros of the document, of `macros_of`; definitions in the display are added.

    Returns
    -------
    list
        Statements, and in the place of each that cannot be read the reason. Of a chain with an
        unreadable side the other sides are a statement.

    Raises
    ------
    OSError
        If lark is not installed.
    """
    whole = 0, len(latex)
    if len(latex) > MAX_LENGTH:
        return [Unreadable(f"a display of more than {MAX_LENGTH} characters", whole)]
    try:
        tokens = expanded(latex, tokenize(latex), macros)
        pairs(tokens)  # refuses deep braces before anything descends into them
        tokens = with_points_above(with_new_fonts(with_unicode_scripts(tokens)))
        tokens = with_dots_on_variables(with_fractions_of_derivatives(tokens))
        tokens = with_words(Layout(tokens).tokens_without_layout())
        found = statements(flattened(tokens))
    except UnreadError as error:
        return [Unreadable(str(error), whole)]
    result: list[Statement | Unreadable] = []
    for statement in found:
        result += _read(latex, statement)
    return result


def _read(latex: str, tokens: list[Token]) -> Iterator[Statement | Unreadable]:
    """A statement without its unreadable sides, and these."""
    tokens = _without_number(_without_label(tokens))
    sides, relations = _sides(tokens)
    whole = _span(tokens, (0, len(latex)))
    nodes: list[Node] = []
    kept: list[str] = []
    failures: list[Unreadable] = []
    for number, side in enumerate(sides):
        try:
            tree = _tree(_with_sign(side))
        except UnreadError as error:
            failures.append(Unreadable(str(error), _span(side, whole)))
        else:
            if nodes:
                kept.append(relations[number - 1])
            nodes.append(tree)
    if not failures:
        others = tuple(_tree(_with_sign(side, lower=True)) for side in sides)
        has_two_signs = any(token.text in SIGNS for side in sides for token in side)
        yield Statement(tuple(nodes), tuple(kept), whole, others if has_two_signs else ())
    elif len(nodes) > 1 and set(relations) <= {"=", ":="}:
        yield Statement(tuple(nodes), tuple(kept), whole)
        yield from failures
    else:
        yield Unreadable(failures[0].reason, whole)


def _with_sign(side: list[Token], lower: bool = False) -> list[Token]:
    """A side with the upper or the lower one of two signs."""
    return [
        Token(sign, sign, token.span)
        if (sign := SIGNS.get(token.text, "  ")[lower]) != " "
        else token
        for token in side
    ]


def _without_label(tokens: list[Token]) -> list[Token]:
    r"""The tokens behind a label such as ``(E_1):`` or ``\theta:`` before an equation."""
    partner = pairs(tokens)
    whole = inside(-1, len(tokens), partner)
    colons = [at for at in whole if tokens[at].kind == "relation" and tokens[at].text == ":"]
    behind = [tokens[at].text for at in whole if colons and at > colons[0]]
    return tokens[colons[0] + 1 :] if len(colons) == 1 and "=" in behind else tokens


def _without_number(tokens: list[Token]) -> list[Token]:
    r"""The tokens before dots that lead to the number of an equation: ``\cdots (2a)``."""
    dots = [at for at, token in enumerate(tokens) if token.text in ELLIPSES]
    if not dots:
        return tokens
    behind = "".join(token.text for token in tokens[dots[-1] + 1 :])
    return tokens[: dots[-1]] if NUMBER.fullmatch(behind.replace(" ", "")) else tokens


def _sides(tokens: list[Token]) -> tuple[list[list[Token]], list[str]]:
    partner = pairs(tokens)
    sides: list[list[Token]] = [[]]
    relations: list[str] = []
    at = 0
    while at < len(tokens):
        end = max(at, partner.get(at, at))
        is_repeated = relations[-1:] == [tokens[at].text] and not _is_visible(sides[-1])
        is_leading = tokens[at].text == "->" and not relations and not _is_visible(sides[0])
        if tokens[at].kind == "relation":
            # at the end of a row and at the start of the next one, or an arrow from the one before
            if not is_repeated and not is_leading:
                relations.append(tokens[at].text)
                sides.append([])
        else:
            sides[-1] += tokens[at : end + 1]
        at = end + 1
    return sides, relations


def _is_visible(tokens: list[Token]) -> bool:
    return any(token.kind not in ("space", "gap") for token in tokens)


def _span(tokens: list[Token], whole: Span) -> Span:
    tokens = [token for token in tokens if token.kind not in ("space", "gap")]
    if not tokens:
        return whole
    return min(t.span[0] for t in tokens), max(t.span[1] for t in tokens)


def _tree(tokens: list[Token]) -> Node:
    if not _is_visible(tokens):
        raise UnreadError("a side of a relation is missing")
    lark, parser = _parser()
    try:
        parse = parser.parse_interactive("")
        for symbol in Terminals(tokens).all():
            parse.feed_token(symbol)
        tree = parse.feed_token(Symbol("$END", "", (0, 0)))
    except lark.UnexpectedToken as error:
        raise UnreadError(_unexpected(error.token, tokens)) from error
    _check(tree)
    return tree


def _unexpected(symbol: Any, tokens: list[Token]) -> str:
    if symbol.type == "$END":
        return "the expression ends too early"
    text = next((t.text for t in tokens if t.span[0] == symbol.span[0]), "")
    return f"{text or symbol.type.lower()!r} cannot stand here"


def _check(tree: Node) -> None:
    """Refuse a tree that is too deep, or has a ∂ outside of derivatives."""
    waiting: list[tuple[Any, int]] = [(tree, 0)]
    while waiting:
        item, depth = waiting.pop()
        if depth > MAX_TREE_DEPTH:
            raise UnreadError(f"more than {MAX_TREE_DEPTH} expressions within one another")
        if isinstance(item, Letter):
            if item.name == "partial":
                raise UnreadError("∂ outside of a derivative")
        elif isinstance(item, tuple):
            waiting += [(part, depth) for part in item]
        elif is_dataclass(item):
            waiting += [(getattr(item, f.name), depth + 1) for f in fields(item)]


@cache
def _parser() -> tuple[Any, Any]:
    """The parsing library and the parser of the grammar."""
    try:
        import lark
    except ImportError as error:
        raise OSError("lark is not installed: pip install 'holonomic[documents]'") from error
    grammar = (Path(__file__).parent / "grammar.lark").read_text(encoding="utf-8")
    return lark, lark.Lark(grammar, parser="lalr", lexer="basic", transformer=Build())
