"""Formulas set as mathematics: MathML, which browsers and notebooks show without help.

A formula is parsed as `derive.formulas.expression` parses it, but nothing is computed, so that it
stays as it was written. Every side of an equation and every term of a sum is a piece of its own
that a narrow screen may put on the next line.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import TypeAlias

import sympy as sp

from derive.formulas.expression import RELATION, ExpressionError, tree
from derive.formulas.lettering import letters, named

RELATIONS = {"=": "=", "<": "&lt;", ">": "&gt;", "<=": "≤", ">=": "≥"}
TIMES, APPLIED = "<mo>&#x2062;</mo>", "<mo>&#x2061;</mo>"  # seen by no one, read by machines
GAP = '<mspace width="0.167em"/>'

# What binds less than its neighbour needs brackets.
SUM, PRODUCT, POWER, ATOM = range(4)
Set: TypeAlias = tuple[str, int]


@dataclass(frozen=True)
class Formula:
    """A formula that notebooks show as mathematics.

    Parameters
    ----------
    text : str
        In the language of formulas: ``"L = m*x_dot**2/2"``. What is no formula is
        shown as it stands.

    Examples
    --------
    >>> Formula("E = m*v**2/2").html.count("<math")
    2
    """

    text: str

    @staticmethod
    def of(name: str, value: sp.Expr | sp.MatrixBase) -> Formula:
        """``name = value`` for what SymPy has computed."""
        if not isinstance(value, sp.MatrixBase):
            return Formula(f"{name} = {_plain(value)}")
        rows = (", ".join(map(_plain, row)) for row in value.tolist())
        return Formula(f"{name} = [{', '.join(f'[{row}]' for row in rows)}]")

    @property
    def html(self) -> str:
        """Pieces of MathML, with room between them for a new line."""
        try:
            lines = [_line(part) for part in self.text.split(";")]
        except (ExpressionError, RecursionError):
            return f'<code class="formula">{escape(self.text)}</code>'
        return "".join(f'<div class="formula">{line}</div>' for line in lines)

    def _repr_html_(self) -> str:
        return self.html


def _plain(value: sp.Expr) -> str:
    return sp.sstr(value, order="lex")


def _line(text: str) -> str:
    first, *others = RELATION.split(text)
    pieces = _terms(tree(first))
    for relation, side in zip(others[::2], others[1::2], strict=True):
        head, *tail = _terms(tree(side))
        pieces += [_infix(RELATIONS[relation]) + head, *tail]
    return " ".join(f'<math displaystyle="true">{piece}</math>' for piece in pieces)


def _terms(node: ast.expr) -> list[str]:
    """The terms of a sum, with their signs."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        sign = "+" if isinstance(node.op, ast.Add) else "−"
        return [*_terms(node.left), _infix(sign) + _within(node.right, PRODUCT)]
    return [_set(node)[0]]


def _set(node: ast.expr) -> Set:
    match node:
        case ast.Constant(value=int() | float() as number):
            return f"<mn>{number}</mn>", ATOM
        case ast.Name(id=name):
            return named(name), ATOM
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return f'<mo form="prefix">−</mo>{_within(operand, PRODUCT)}', SUM
        case ast.BinOp(op=ast.Add() | ast.Sub()):
            return "".join(_terms(node)), SUM
        case ast.BinOp(left=base, op=ast.Pow(), right=exponent):
            return _power(base, exponent), POWER
        case ast.BinOp(left=left, op=ast.Mult() | ast.Div()) if positive := _negated(left):
            term = ast.BinOp(positive, node.op, node.right)
            return f'<mo form="prefix">−</mo>{_within(term, PRODUCT)}', SUM
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            gap = GAP if _is_called(right) else ""
            return _within(left, PRODUCT) + TIMES + gap + _within(right, PRODUCT), PRODUCT
        case ast.BinOp(left=left, op=ast.Div(), right=ast.Constant() as right) if not isinstance(
            left, ast.Constant
        ):  # a half of something long, not something long over two
            return _set(ast.BinOp(ast.BinOp(ast.Constant(1), ast.Div(), right), ast.Mult(), left))
        case ast.BinOp(left=left, op=ast.Div(), right=right):
            return f"<mfrac>{_row(_set(left)[0])}{_row(_set(right)[0])}</mfrac>", PRODUCT
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return _call(name, arguments)
        case ast.Tuple(elts=items):
            return _matrix([[item] for item in items]), ATOM
        case ast.List(elts=rows) if all(isinstance(row, ast.List) for row in rows):
            return _matrix([row.elts for row in rows if isinstance(row, ast.List)]), ATOM
    raise ExpressionError(f"{ast.unparse(node)[:80]!r} cannot be set as mathematics")


def _is_called(node: ast.expr) -> bool:
    return isinstance(node.left if isinstance(node, ast.BinOp) else node, ast.Call)


def _negated(node: ast.expr) -> ast.expr | None:
    """The product without the sign before it; None if there is no sign."""
    match node:
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return operand
        case ast.BinOp(left=left, op=(ast.Mult() | ast.Div()) as op, right=right):
            positive = _negated(left)
            return positive and ast.BinOp(positive, op, right)
    return None


def _within(node: ast.expr, least: int) -> str:
    markup, binding = _set(node)
    return markup if binding >= least else _brackets(markup)


def _power(base: ast.expr, exponent: ast.expr) -> str:
    raised = _row(_set(exponent)[0])
    match base:
        case ast.Call(func=ast.Name(id="sin" | "cos" | "tan" as name), args=[argument]):
            return f"<msup><mi>{name}</mi>{raised}</msup>{APPLIED}{_brackets(_set(argument)[0])}"
        case ast.Name(id=name) if (pair := letters(name))[1]:
            return f"<msubsup>{''.join(pair)}{raised}</msubsup>"
    return f"<msup>{_row(_within(base, ATOM))}{raised}</msup>"


def _call(name: str, arguments: Sequence[ast.expr]) -> Set:
    parts = [_set(argument)[0] for argument in arguments]
    match name, len(parts):
        case "d", 2:
            simple = isinstance(arguments[0], ast.Name)
            above = f"<mo>∂</mo>{parts[0]}" if simple else "<mo>∂</mo>"
            fraction = f"<mfrac>{_row(above)}<mrow><mo>∂</mo>{parts[1]}</mrow></mfrac>"
            return fraction + ("" if simple else _brackets(parts[0])), PRODUCT
        case "ddt", 1:
            inside = parts[0] if _set(arguments[0])[1] == ATOM else _brackets(parts[0])
            above, below = "<mi>d</mi>", "<mrow><mi>d</mi><mi>t</mi></mrow>"
            return f"<mfrac>{above}{below}</mfrac>{inside}", PRODUCT
        case (("norm" | "Abs"), 1):
            return f"<mrow><mo>|</mo>{parts[0]}<mo>|</mo></mrow>", ATOM
        case "sqrt", 1:
            return f"<msqrt>{parts[0]}</msqrt>", ATOM
        case "inverse", 1:
            return f"<msup>{_row(parts[0])}<mrow><mo>−</mo><mn>1</mn></mrow></msup>", POWER
        case "only", _:
            name_of, *parts = parts
            return name_of + APPLIED + _brackets("<mo>,</mo>".join(parts)), ATOM
    return named(name) + APPLIED + _brackets("<mo>,</mo>".join(parts)), ATOM


def _matrix(rows: Sequence[Sequence[ast.expr]]) -> str:
    set_rows = "".join(
        f"<mtr>{''.join(f'<mtd>{_set(entry)[0]}</mtd>' for entry in row)}</mtr>" for row in rows
    )
    return _brackets(f"<mtable>{set_rows}</mtable>")


def _infix(sign: str) -> str:
    return f'<mo form="infix">{sign}</mo>'


def _brackets(markup: str) -> str:
    # tall letters are no reason for tall brackets
    tall = "true" if "<mfrac" in markup or "<mtable" in markup else "false"
    left, right = (
        f'<mo form="{form}" stretchy="{tall}">{bracket}</mo>'
        for form, bracket in (("prefix", "("), ("postfix", ")"))
    )
    return f"<mrow>{left}{markup}{right}</mrow>"


def _row(markup: str) -> str:
    return f"<mrow>{markup}</mrow>"
