r"""Formulas as LaTeX.

Only commands of LaTeX and of amsmath are used, in one spelling each: ``\frac{a}{b}``,
``\dot{\theta}_1``, ``\sin\left(x\right)``.
"""

import ast
import re
from collections.abc import Mapping, Sequence

from derive.formulas.syntax import ExpressionError, is_sum, summands
from derive.formulas.typeset.lettering import name_latex
from derive.formulas.typeset.typesetting import ATOM, POWER, PRODUCT, SUM, negated

#: Functions that have a command of their own in LaTeX, by name.
COMMANDS = {name: rf"\{name}" for name in "sin cos tan sinh cosh tanh exp det".split()}
COMMANDS |= {"log": r"\ln", "asin": r"\arcsin", "acos": r"\arccos", "atan": r"\arctan"}
COMMANDS |= {"Max": r"\max", "Min": r"\min", "sign": r"\operatorname{sgn}"}
POWERS = ("sin", "cos", "tan")


def latex(node: ast.expr, letters: Mapping[str, str] | None = None) -> str:
    """The LaTeX of a formula on one line; `letters` are names with a LaTeX of their own."""
    return _Writer(letters or {}).latex(node)


def operand_latex(node: ast.expr, least: int) -> str:
    """The LaTeX of an operand, in brackets if it binds less than `least`."""
    return _Writer({}).operand(node, least)


class _Writer:
    def __init__(self, letters: Mapping[str, str]) -> None:
        self._letters = letters

    def latex(self, node: ast.expr) -> str:
        return self._latex_and_binding(node)[0]

    def operand(self, node: ast.expr, least: int) -> str:
        text, binding = self._latex_and_binding(node)
        return text if binding >= least else brackets(text)

    def _latex_and_binding(self, node: ast.expr) -> tuple[str, int]:
        match node:
            case ast.Constant():
                return str(node.value), ATOM
            case ast.Name(id=name):
                text = self._name(name)
                if text.startswith(r"\frac"):  # a rate can be a fraction, or have primes
                    return text, PRODUCT
                return text, POWER if "'" in text else ATOM
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return f"-{self.operand(operand, PRODUCT)}", SUM
            case ast.BinOp() if is_sum(node):
                return self._sum(node), SUM
            case ast.BinOp(left=base, op=ast.Pow(), right=exponent):
                return self._power(base, exponent), POWER
            case ast.BinOp(op=ast.Mult() | ast.Div()) if positive := negated(node):
                return f"-{self.operand(positive, PRODUCT)}", SUM
            case ast.BinOp(left=left, op=ast.Mult(), right=right):
                after = self.operand(right, PRODUCT)
                times = r" \cdot " if after[0].isdigit() else " "
                return f"{self.operand(left, PRODUCT)}{times}{after}", PRODUCT
            case ast.BinOp(left=left, op=ast.Div(), right=right):
                return rf"\frac{{{self.latex(left)}}}{{{self.latex(right)}}}", PRODUCT
            case ast.Call(func=ast.Name(id=name), args=arguments):
                return self._call(name, arguments)
            case ast.Tuple(elts=items):
                return self._matrix([[item] for item in items]), ATOM
            case ast.List(elts=rows):
                lists = [row.elts for row in rows if isinstance(row, ast.List)]
                return self._matrix(lists), ATOM
        raise ExpressionError(f"{ast.unparse(node)[:80]!r} cannot be typeset")

    def _name(self, name: str) -> str:
        if name in self._letters:
            return self._letters[name]
        stem = re.sub("_d?dot$", "", name)
        if stem not in self._letters:
            return name_latex(name)
        letter, _, index = self._letters[stem].partition("_")
        dotted = rf"\{name[len(stem) + 1 :]}{{{letter}}}"
        return f"{dotted}_{index}" if index else dotted

    def _sum(self, node: ast.expr) -> str:
        (first, sign), *rest = summands(node)
        parts = [f"-{self.operand(first, PRODUCT)}" if sign < 0 else self.latex(first)]
        parts += (f"{'-' if s < 0 else '+'} {self.operand(term, PRODUCT)}" for term, s in rest)
        return " ".join(parts)

    def _power(self, base: ast.expr, exponent: ast.expr) -> str:
        raised = self.latex(exponent)
        raised = raised if len(raised) == 1 else f"{{{raised}}}"
        match base:
            case ast.Call(func=ast.Name(id=name), args=[argument]) if name in POWERS:
                if not isinstance(exponent, ast.Constant):  # sin^{-1} is the inverse function
                    return f"{brackets(self.latex(base))}^{raised}"
                return rf"{COMMANDS[name]}^{raised}{brackets(self.latex(argument))}"
        return f"{self.operand(base, ATOM)}^{raised}"

    def _call(self, name: str, arguments: Sequence[ast.expr]) -> tuple[str, int]:
        parts = list(map(self.latex, arguments))
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
            case (("Abs" | "abs" | "norm"), [value]):
                return rf"\left|{value}\right|", ATOM
            case "inverse", [value]:
                return f"{value}^{{-1}}", POWER
            case "transpose", [_]:
                return f"{self.operand(arguments[0], ATOM)}^T", POWER
        command = COMMANDS.get(name, rf"\operatorname{{{name}}}")
        return command + brackets(", ".join(parts)), ATOM

    def _matrix(self, rows: Sequence[Sequence[ast.expr]]) -> str:
        lines = r" \\ ".join(" & ".join(map(self.latex, row)) for row in rows)
        return rf"\begin{{pmatrix}} {lines} \end{{pmatrix}}"


def brackets(text: str) -> str:
    """LaTeX in round brackets that grow with it."""
    return rf"\left({text}\right)"
