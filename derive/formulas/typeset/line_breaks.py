r"""Breaks of long LaTeX formulas, before the signs of sums.

Brackets that contain a break have a fixed size, because ``\left`` and ``\right`` cannot be on
different lines.
"""

import ast
from collections.abc import Sequence
from functools import lru_cache
from typing import TypeAlias

from derive.formulas.syntax import ExpressionError, is_sum, summands
from derive.formulas.typeset.latex import COMMANDS, latex, operand_latex
from derive.formulas.typeset.lettering import lettering
from derive.formulas.typeset.typesetting import ATOM, PRODUCT, SUM, negated

#: A piece of LaTeX and its width.
Chunk: TypeAlias = tuple[str, float]

NOTHING: Chunk = ("", 0.0)

#: Widths in units of a digit: of a sign with its spaces, of brackets, and of an index.
SIGN, BRACKETS, INDEX = 3.2, 1.8, 0.7

#: Widths that are kept.
MOST_WIDTHS = 100_000

#: The space before continued rows, and its width.
INDENT, INDENT_WIDTH = r"\quad", 2.0


def latex_rows(sides: Sequence[ast.expr], width: float) -> list[str]:
    """The rows of an equation for ``aligned``, of at most `width` digits where breaks allow it.

    Rows are aligned at the first relation. Later ones begin with a relation, or with a sign behind
    a space.
    """
    first, *rest = sides
    width -= width_of(first) + SIGN
    rows, used = [f"{latex(first)} &"], 0.0
    for side in rest:
        (head, size), *others = chunks_of(side, width)
        if used and used + size + SIGN > width:
            rows.append("&")
            used = 0.0
        rows[-1] += f" = {head}"
        used += size + SIGN
        for text, size in others:
            if used + size > width:
                rows.append("& " + INDENT)
                used = INDENT_WIDTH
            rows[-1] += f" {text}"
            used += size
    return rows


@lru_cache(MOST_WIDTHS)  # of parts of formulas, whose lines are broken from outside to inside
def width_of(node: ast.expr) -> float:
    """The width of a formula on one line, in digits."""
    match node:
        case ast.Constant():
            return len(str(node.value))
        case ast.Name(id=name):
            read = lettering(name)
            letters = 1.1 if read.is_greek else 1.1 * len(read.letter)
            return letters + INDEX * sum(map(_index_width, read.indices))
        case ast.UnaryOp(operand=operand):
            return 1.6 + _operand_width(operand, PRODUCT)
        case ast.BinOp() if is_sum(node):
            terms = summands(node)
            sizes = (_operand_width(term, PRODUCT) for term, _ in terms)
            return sum(sizes) + SIGN * (len(terms) - 1)
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            return _operand_width(left, PRODUCT) + _operand_width(right, PRODUCT) + 0.2
        case ast.BinOp(left=left, op=ast.Div(), right=right):
            return max(width_of(left), width_of(right)) + 0.5
        case ast.BinOp(left=base, op=ast.Pow(), right=exponent):
            return _operand_width(base, ATOM) + INDEX * width_of(exponent)
        case ast.Call(func=ast.Name(id="d"), args=[value, variable]):
            return max(width_of(value), width_of(variable)) + 2
        case ast.Call(func=ast.Name(id=name), args=arguments):
            head = 2.0 if name == "ddt" else 0.9 * len(name)
            return head + BRACKETS + sum(map(width_of, arguments))
        case ast.Tuple(elts=items):
            return max(map(width_of, items)) + 3
        case ast.List(elts=rows):
            columns = zip(*(row.elts for row in rows if isinstance(row, ast.List)), strict=True)
            return sum(max(map(width_of, column)) + 2 for column in columns) + 2
    raise ExpressionError(f"{ast.unparse(node)[:80]!r} cannot be typeset")


def chunks_of(node: ast.expr, width: float) -> list[Chunk]:
    """Pieces of LaTeX and their widths; a line can break before each but the first."""
    size = width_of(node)
    if size <= width:
        return [(latex(node), size)]
    return _broken(node, width) or [(latex(node), size)]


def _broken(node: ast.expr, width: float) -> list[Chunk]:
    """The pieces of a formula that is too long for a line; none if it cannot be broken."""
    match node:
        case ast.BinOp() if is_sum(node):
            chunks: list[Chunk] = []
            for k, (term, sign) in enumerate(summands(node)):
                mark = "- " if sign < 0 else "+ " if k else ""
                chunks += _enclosed((mark, SIGN), _operand_chunks(term, width - SIGN))
            return chunks
        case ast.UnaryOp(operand=operand):
            return _enclosed(("- ", SIGN), _operand_chunks(operand, width - SIGN))
        case ast.BinOp(op=ast.Mult() | ast.Div()) if positive := negated(node):
            return _enclosed(("- ", SIGN), _operand_chunks(positive, width - SIGN))
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            if width_of(left) < width_of(right):
                head = (f"{operand_latex(left, PRODUCT)} ", width_of(left))
                return _enclosed(head, _operand_chunks(right, width - head[1]))
            tail = (f" {operand_latex(right, PRODUCT)}", width_of(right))
            return _enclosed(NOTHING, _operand_chunks(left, width - tail[1]), tail)
        case ast.BinOp(left=above, op=ast.Div(), right=below):
            if width_of(below) < width / 2:
                head = (rf"\frac{{1}}{{{latex(below)}}} ", width_of(below) + 1)
                return _enclosed(head, _bracketed(above, width - head[1]))
            return _product(_bracketed(above, width), _bracketed(below, width, "^{-1}"))
        case ast.BinOp(left=base, op=ast.Pow(), right=exponent) if not isinstance(base, ast.Call):
            return _bracketed(base, width, f"^{{{latex(exponent)}}}")
        case ast.Call(func=ast.Name(id="sqrt"), args=[argument]):
            return _bracketed(argument, width, "^{1/2}")
        case ast.Call(func=ast.Name(id=name), args=[argument]) if name in COMMANDS:
            return _enclosed((COMMANDS[name], len(name)), _bracketed(argument, width))
    return []


def _operand_chunks(node: ast.expr, width: float) -> list[Chunk]:
    """The pieces of a factor or term, in brackets if it is a sum."""
    if is_sum(node) or isinstance(node, ast.UnaryOp):
        return _bracketed(node, width)
    return chunks_of(node, width)


def _bracketed(node: ast.expr, width: float, after: str = "") -> list[Chunk]:
    """The pieces of a formula in brackets, which grow with it only if they contain no break."""
    chunks = chunks_of(node, width - BRACKETS)
    left, right = r"\left(", r"\right)"
    if len(chunks) > 1:
        size = "Big" if any(r"\frac" in text for text, _ in chunks) else "big"
        left, right = rf"\{size}l( ", rf" \{size}r)"
    return _enclosed((left, BRACKETS / 2), chunks, (right + after, BRACKETS / 2 + len(after) / 4))


def _enclosed(before: Chunk, chunks: list[Chunk], after: Chunk = NOTHING) -> list[Chunk]:
    """The pieces with LaTeX before the first and after the last."""
    first = (before[0] + chunks[0][0], before[1] + chunks[0][1])
    chunks = [first, *chunks[1:]]
    last = (chunks[-1][0] + after[0], chunks[-1][1] + after[1])
    return [*chunks[:-1], last]


def _product(left: list[Chunk], right: list[Chunk]) -> list[Chunk]:
    """The pieces of a product of two factors."""
    middle = (f"{left[-1][0]} {right[0][0]}", left[-1][1] + right[0][1])
    return [*left[:-1], middle, *right[1:]]


def _index_width(index: str) -> float:
    return len(index) if index.replace("_", "").isdigit() else width_of(ast.Name(index))


def _operand_width(node: ast.expr, least: int) -> float:
    loose = is_sum(node) or isinstance(node, ast.UnaryOp)
    return width_of(node) + (BRACKETS if loose and least > SUM else 0)
