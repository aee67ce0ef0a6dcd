"""Formulas of our syntax as LaTeX, with the letters as a document writes them."""

import ast
from collections.abc import Mapping, Sequence

from derive.formulas.expression import syntax_tree
from derive.formulas.lettering import GREEK
from derive.verification.documents.rates import RATES

#: Binding strengths: an operand that binds less than its neighbour needs brackets.
SUM, PRODUCT, POWER, ATOM = range(4)

FUNCTIONS = ("sin", "cos", "tan", "exp", "log", "sinh", "cosh", "tanh", "det")
DOTS = {"": "", "_dot": r"\dot", "_ddot": r"\ddot", "_dddot": r"\dddot"}


def written(text: str, letters: Mapping[str, str]) -> str:
    """A formula or an equation as LaTeX; `letters` are names as the document writes them."""
    return " = ".join(_Writer(letters).write(syntax_tree(side)) for side in text.split("="))


class _Writer:
    def __init__(self, letters: Mapping[str, str]) -> None:
        self._letters = letters

    def write(self, node: ast.expr) -> str:
        return self._written(node)[0]

    def _operand(self, node: ast.expr, least: int) -> str:
        text, binding = self._written(node)
        return text if binding >= least else rf"\left({text}\right)"

    def _written(self, node: ast.expr) -> tuple[str, int]:
        match node:
            case ast.Constant(kind=str() as digits):
                return digits, ATOM
            case ast.Name(id=name):
                return self._name(name), ATOM
            case ast.UnaryOp(operand=operand):
                return f"-{self._operand(operand, PRODUCT)}", SUM
            case ast.BinOp(left=left, op=ast.Add() | ast.Sub() as op, right=right):
                sign = "+" if isinstance(op, ast.Add) else "-"
                return f"{self.write(left)} {sign} {self._operand(right, PRODUCT)}", SUM
            case ast.BinOp(op=ast.Mult() | ast.Div()) if positive := _negated(node):
                return f"-{self._operand(positive, PRODUCT)}", SUM
            case ast.BinOp(left=left, op=ast.Mult(), right=right):
                return self._product(self._operand(left, PRODUCT), right), PRODUCT
            case ast.BinOp(left=left, op=ast.Div(), right=right):
                return self._quotient(left, right), PRODUCT
            case ast.BinOp(left=base, op=ast.Pow(), right=exponent):
                return self._power(base, exponent), POWER
            case ast.Call(func=ast.Name(id=name), args=arguments):
                return self._call(name, arguments), ATOM
        raise ValueError(ast.unparse(node))

    def _product(self, left: str, right: ast.expr) -> str:
        factor = self._operand(right, PRODUCT)
        separator = r" \cdot " if factor[:1].isdigit() else " "
        return left + separator + factor

    def _quotient(self, above: ast.expr, below: ast.expr) -> str:
        return rf"\frac{{{self.write(above)}}}{{{self.write(below)}}}"

    def _power(self, base: ast.expr, exponent: ast.expr) -> str:
        raised = f"^{{{self.write(exponent)}}}"
        if len(raised) == 4:  # one digit needs no group
            raised = f"^{raised[2]}"
        match base:
            case ast.Call(func=ast.Name(id=name), args=[argument]) if name in FUNCTIONS:
                return rf"\{name}{raised}\left({self.write(argument)}\right)"
        return self._operand(base, ATOM) + raised

    def _call(self, name: str, arguments: Sequence[ast.expr]) -> str:
        inner = ", ".join(map(self.write, arguments))
        match name:
            case "sqrt":
                return rf"\sqrt{{{inner}}}"
            case "Abs" | "norm":
                return rf"\left|{inner}\right|"
            case "ddt":
                return rf"\frac{{d}}{{dt}}\left({inner}\right)"
            case "transpose":
                return f"{self._operand(arguments[0], ATOM)}^T"
            case "inverse":
                return f"{self._operand(arguments[0], ATOM)}^{{-1}}"
        command = rf"\{name}" if name in FUNCTIONS else rf"\operatorname{{{name}}}"
        return rf"{command}\left({inner}\right)"

    def _name(self, name: str) -> str:
        if name in self._letters:
            return self._letters[name]
        for ending in reversed(RATES):
            if ending and name.endswith(ending):
                stem = name.removesuffix(ending)
                letter, _, index = self._letters.get(stem, letter_latex(stem)).partition("_")
                return rf"{DOTS[ending]}{{{letter}}}" + (f"_{index}" if index else "")
        return letter_latex(name)


def _negated(node: ast.expr) -> ast.expr | None:
    """A product without its leading minus sign; None if it has none."""
    match node:
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return operand
        case ast.BinOp(left=left, op=(ast.Mult() | ast.Div()) as op, right=right):
            positive = _negated(left)
            return positive and ast.BinOp(positive, op, right)
    return None


def letter_latex(name: str) -> str:
    """A name such as ``theta_1`` as LaTeX."""
    letter, _, index = name.partition("_")
    return _symbol(letter) + (f"_{{{letter_latex(index)}}}" if index else "")


def _symbol(letter: str) -> str:
    if letter in GREEK or letter in ("ell", "varphi", "pi"):
        return rf"\{letter}"
    return letter if len(letter) <= 1 or letter.isdecimal() else rf"\text{{{letter}}}"
