r"""Formulas as LaTeX.

Only commands of LaTeX and of amsmath are used, in one spelling each: ``\frac{a}{b}``,
``\dot{\theta}_1``, ``\sin\left(x\right)``.
"""

import ast
from collections.abc import Sequence

from derive.formulas.expression import ExpressionError, is_sum, summands
from derive.formulas.lettering import letter_and_index_latex, name_latex
from derive.formulas.typesetting import ATOM, POWER, PRODUCT, SUM, negated

#: Functions that have a command of their own in LaTeX, by name.
COMMANDS = {name: rf"\{name}" for name in "sin cos tan sinh cosh tanh exp det".split()}
COMMANDS |= {"log": r"\ln", "asin": r"\arcsin", "acos": r"\arccos", "atan": r"\arctan"}
POWERS = ("sin", "cos", "tan")


def latex(node: ast.expr) -> str:
    """The LaTeX of a formula on one line."""
    return _latex_and_binding(node)[0]


def _latex_and_binding(node: ast.expr) -> tuple[str, int]:
    match node:
        case ast.Constant():
            return str(node.value), ATOM
        case ast.Name(id=name):
            return name_latex(name), ATOM
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return f"-{operand_latex(operand, PRODUCT)}", SUM
        case ast.BinOp() if is_sum(node):
            return _sum(node), SUM
        case ast.BinOp(left=base, op=ast.Pow(), right=exponent):
            return _power(base, exponent), POWER
        case ast.BinOp(op=ast.Mult() | ast.Div()) if positive := negated(node):
            return f"-{operand_latex(positive, PRODUCT)}", SUM
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            after = operand_latex(right, PRODUCT)
            times = r" \cdot " if after[0].isdigit() else " "
            return f"{operand_latex(left, PRODUCT)}{times}{after}", PRODUCT
        case ast.BinOp(left=left, op=ast.Div(), right=right):
            return rf"\frac{{{latex(left)}}}{{{latex(right)}}}", PRODUCT
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return _call(name, arguments)
        case ast.Tuple(elts=items):
            return _matrix([[item] for item in items]), ATOM
        case ast.List(elts=rows):
            return _matrix([row.elts for row in rows if isinstance(row, ast.List)]), ATOM
    raise ExpressionError(f"{ast.unparse(node)[:80]!r} cannot be typeset")


def _sum(node: ast.expr) -> str:
    (first, sign), *rest = summands(node)
    parts = [f"-{operand_latex(first, PRODUCT)}" if sign < 0 else latex(first)]
    parts += (f"{'-' if sign < 0 else '+'} {operand_latex(term, PRODUCT)}" for term, sign in rest)
    return " ".join(parts)


def operand_latex(node: ast.expr, least: int) -> str:
    """The LaTeX of an operand, in brackets if it binds less than `least`."""
    text, binding = _latex_and_binding(node)
    return text if binding >= least else brackets(text)


def _power(base: ast.expr, exponent: ast.expr) -> str:
    raised = latex(exponent)
    raised = raised if len(raised) == 1 else f"{{{raised}}}"
    match base:
        case ast.Call(func=ast.Name(id=name), args=[argument]) if name in POWERS:
            return rf"{COMMANDS[name]}^{raised}{brackets(latex(argument))}"
        case ast.Name(id=name) if (pair := letter_and_index_latex(name))[1]:
            return f"{pair[0]}_{pair[1]}^{raised}"
    return f"{operand_latex(base, ATOM)}^{raised}"


def _call(name: str, arguments: Sequence[ast.expr]) -> tuple[str, int]:
    parts = list(map(latex, arguments))
    match name, parts:
        case "d", [value, variable]:
            if isinstance(arguments[0], ast.Name):
                return rf"\frac{{\partial {value}}}{{\partial {variable}}}", PRODUCT
            return rf"\frac{{\partial}}{{\partial {variable}}}{brackets(value)}", PRODUCT
        case "ddt", [value]:
            if isinstance(arguments[0], ast.Name):
                return rf"\frac{{d {value}}}{{d t}}", PRODUCT
            return rf"\frac{{d}}{{d t}}{brackets(value)}", PRODUCT
        case "sqrt", [value]:
            return rf"\sqrt{{{value}}}", ATOM
        case "Abs", [value]:
            return rf"\left|{value}\right|", ATOM
        case "inverse", [value]:
            return f"{value}^{{-1}}", POWER
    command = COMMANDS.get(name, rf"\operatorname{{{name}}}")
    return command + brackets(", ".join(parts)), ATOM


def _matrix(rows: Sequence[Sequence[ast.expr]]) -> str:
    lines = r" \\ ".join(" & ".join(map(latex, row)) for row in rows)
    return rf"\begin{{pmatrix}} {lines} \end{{pmatrix}}"


def brackets(text: str) -> str:
    """LaTeX in round brackets that grow with it."""
    return rf"\left({text}\right)"
