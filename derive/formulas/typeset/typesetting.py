"""Typesetting of formulas as MathML, which browsers and notebooks render natively.

Formulas are parsed as in `derive.formulas.expression` but not evaluated, so that their
printed form is preserved. Each side of an equation and each term of a sum is a
separate element, so that a narrow screen can break the line between them.
"""

import ast
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from html import escape
from typing import TYPE_CHECKING

from derive.formulas.syntax import RELATION, ExpressionError, is_sum, syntax_tree
from derive.formulas.typeset.lettering import denominator, letter_and_index, name_markup

if TYPE_CHECKING:
    import sympy as sp

RELATIONS = {"=": "=", "<": "&lt;", ">": "&gt;", "<=": "≤", ">=": "≥"}
#: Invisible operators, for screen readers.
TIMES, APPLY = "<mo>&#x2062;</mo>", "<mo>&#x2061;</mo>"
MINUS = '<mo form="prefix">−</mo>'

#: Binding strengths: an operand that binds less than its neighbour needs brackets.
SUM, PRODUCT, POWER, ATOM = range(4)


@dataclass(frozen=True)
class Formula:
    """A formula that notebooks display as mathematics; other text is displayed unchanged.

    >>> Formula("E = m*v**2/2").html.count("<math")
    2
    """

    text: str

    @staticmethod
    def of(name: str, value: "sp.Expr | sp.MatrixBase") -> "Formula":
        """Return the formula ``name = value`` of a SymPy value."""
        import sympy as sp  # which pages of motions do not need

        plain = partial(sp.sstr, order="lex")
        if not isinstance(value, sp.MatrixBase):
            return Formula(f"{name} = {plain(value)}")
        rows = (", ".join(map(plain, row)) for row in value.tolist())
        return Formula(f"{name} = [{', '.join(f'[{row}]' for row in rows)}]")

    @property
    def html(self) -> str:
        """MathML elements, separated by spaces at which a line can break."""
        try:
            lines = [" ".join(_elements(part)) for part in self.text.split(";")]
        except (ExpressionError, RecursionError):
            return f'<code class="formula">{escape(self.text)}</code>'
        return "".join(f'<div class="formula">{line}</div>' for line in lines)

    def _repr_html_(self) -> str:
        return self.html


def elements(sides: Iterable[ast.expr], relations: Iterable[str]) -> Iterator[str]:
    """Yield the MathML elements of a statement: the terms of its sides, with their signs."""
    for relation, side in zip(["", *relations], sides, strict=True):
        head, *tail = _terms(side)
        for term in (infix(RELATIONS[relation]) + head if relation else head, *tail):
            yield f'<math displaystyle="true">{term}</math>'


def _elements(text: str) -> Iterator[str]:
    pieces = RELATION.split(text)
    return elements(map(syntax_tree, pieces[::2]), pieces[1::2])


def _terms(node: ast.expr) -> list[str]:
    """Return the terms of a sum with their signs."""
    rest: list[str] = []
    while isinstance(node, ast.BinOp) and is_sum(node):
        sign = "+" if isinstance(node.op, ast.Add) else "−"
        rest.append(infix(sign) + _operand(node.right, PRODUCT))
        node = node.left
    return [_markup(node), *rest[::-1]]


def _markup(node: ast.expr) -> str:
    return _markup_and_binding(node)[0]


def _markup_and_binding(node: ast.expr) -> tuple[str, int]:
    match node:
        case ast.Constant(value=int() | float() as number):
            return f"<mn>{number}</mn>", ATOM
        case ast.Name(id=name):
            return name_markup(name), ATOM
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return MINUS + _operand(operand, PRODUCT), SUM
        case ast.BinOp(op=ast.Add() | ast.Sub()):
            return "".join(_terms(node)), SUM
        case ast.BinOp(left=base, op=ast.Pow(), right=exponent):
            return _power(base, exponent), POWER
        case ast.BinOp(op=ast.Mult() | ast.Div()) if positive := negated(node):
            return MINUS + _operand(positive, PRODUCT), SUM
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            first = right.left if isinstance(right, ast.BinOp) else right
            gap = '<mspace width="0.167em"/>' if isinstance(first, ast.Call) else ""
            return _operand(left, PRODUCT) + TIMES + gap + _operand(right, PRODUCT), PRODUCT
        case ast.BinOp(left=left, op=ast.Div(), right=right):
            if isinstance(left, ast.Constant) or not isinstance(right, ast.Constant):
                above, below = grouped(_markup(left)), denominator(grouped(_markup(right)))
                return f"<mfrac>{above}{below}</mfrac>", PRODUCT
            # a numeric factor before a long numerator, instead of a long fraction
            factor = ast.BinOp(ast.Constant(1), ast.Div(), right)
            return _markup_and_binding(ast.BinOp(factor, ast.Mult(), left))
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return _call(name, arguments)
        case ast.Tuple(elts=items):
            return _matrix([[item] for item in items]), ATOM
        case ast.List(elts=rows) if all(isinstance(row, ast.List) for row in rows):
            return _matrix([row.elts for row in rows if isinstance(row, ast.List)]), ATOM
    raise ExpressionError(f"{ast.unparse(node)[:80]!r} cannot be typeset")


def negated(node: ast.expr) -> ast.expr | None:
    """Return a product without its leading minus sign; None if it has none."""
    match node:
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return operand
        case ast.BinOp(left=left, op=(ast.Mult() | ast.Div()) as op, right=right):
            positive = negated(left)
            return positive and ast.BinOp(positive, op, right)
    return None


def _operand(node: ast.expr, least: int) -> str:
    """Return the markup of an operand, in brackets if it binds less than `least`."""
    markup, binding = _markup_and_binding(node)
    return markup if binding >= least else brackets(markup)


def _power(base: ast.expr, exponent: ast.expr) -> str:
    raised = grouped(_markup(exponent))
    match base:
        case ast.Call(func=ast.Name(id="sin" | "cos" | "tan" as name), args=[argument]):
            if not isinstance(exponent, ast.Constant):  # sin⁻¹ is the inverse function
                return f"<msup>{grouped(brackets(_markup(base)))}{raised}</msup>"
            return f"<msup><mi>{name}</mi>{raised}</msup>{APPLY}{brackets(_markup(argument))}"
        case ast.Name(id=name) if (pair := letter_and_index(name))[1]:
            return f"<msubsup>{''.join(pair)}{raised}</msubsup>"
    return f"<msup>{grouped(_operand(base, ATOM))}{raised}</msup>"


def _call(name: str, arguments: Sequence[ast.expr]) -> tuple[str, int]:
    parts = list(map(_markup, arguments))
    match name, parts:
        case "d", [value, variable]:
            simple = isinstance(arguments[0], ast.Name)
            above = grouped(f"<mo>∂</mo>{value if simple else ''}")
            below = denominator(grouped(f"<mo>∂</mo>{variable}"))
            fraction = f"<mfrac>{above}{below}</mfrac>"
            return fraction + ("" if simple else brackets(value)), PRODUCT
        case "ddt", [_]:
            fraction = f"<mfrac><mi>d</mi>{grouped('<mi>d</mi><mi>t</mi>')}</mfrac>"
            return fraction + _operand(arguments[0], ATOM), PRODUCT
        case (("norm" | "Abs" | "abs"), [value]):
            return grouped(f"<mo>|</mo>{value}<mo>|</mo>"), ATOM
        case "sqrt", [value]:
            return f"<msqrt>{value}</msqrt>", ATOM
        case "inverse", [value]:
            return f"<msup>{grouped(value)}{grouped('<mo>−</mo><mn>1</mn>')}</msup>", POWER
        case "only", [function, *variables]:
            return function + APPLY + brackets("<mo>,</mo>".join(variables)), ATOM
    word = "<mi>ln</mi>" if name == "log" else name_markup(name)
    return word + APPLY + brackets("<mo>,</mo>".join(parts)), ATOM


def _matrix(rows: Sequence[Sequence[ast.expr]]) -> str:
    cells = ("".join(f"<mtd>{_markup(entry)}</mtd>" for entry in row) for row in rows)
    return brackets(f"<mtable>{''.join(f'<mtr>{row}</mtr>' for row in cells)}</mtable>")


def infix(sign: str) -> str:
    """Return the markup of a sign between two operands."""
    return f'<mo form="infix">{sign}</mo>'


def brackets(markup: str, left: str = "(", right: str = ")") -> str:
    """Return markup in brackets, which grow with fractions and tables, but not with accents."""
    stretchy = "true" if any(one in markup for one in ("<mfrac", "<mtable", "<mroot")) else "false"
    start = f'<mo form="prefix" stretchy="{stretchy}">{left}</mo>'
    return grouped(f'{start}{markup}<mo form="postfix" stretchy="{stretchy}">{right}</mo>')


def grouped(markup: str) -> str:
    """Return markup as one element."""
    return f"<mrow>{markup}</mrow>"
