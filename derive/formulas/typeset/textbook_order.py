"""SymPy values as syntax trees, with factors and terms in the order of textbooks.

Factors are numbers, masses, gravity, other parameters, coordinates, rates, and last functions:
m g l sin θ. Terms with accelerations and velocities precede the others.
"""

import ast
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, reduce
from typing import Any, Literal, TypeAlias, get_args

import sympy as sp
from sympy.printing.str import StrPrinter

#: The kinds of symbols, in the order of factors.
Kind: TypeAlias = Literal["mass", "gravity", "parameter", "coordinate", "rate", "acceleration"]
KINDS = get_args(Kind)
#: Types of values that follow symbols.
FUNCTIONS = (sp.Function, sp.exp)


@dataclass(frozen=True)
class TextbookOrder:
    """The order of the factors and terms of a system's formulas.

    Attributes
    ----------
    kinds : mapping of sympy.Symbol to str
        The kind of each symbol; symbols of a kind are in the order of the mapping.
    """

    kinds: Mapping[sp.Symbol, Kind]

    def tree(self, value: sp.Expr | sp.MatrixBase) -> ast.expr:
        """The syntax tree of a value; a column is a tuple, another matrix a list of lists."""
        if isinstance(value, sp.MatrixBase):
            if value.cols == 1 and value.rows > 1:
                return ast.Tuple([self.tree(entry) for entry in value], ast.Load())
            rows = [[self.tree(entry) for entry in row] for row in value.tolist()]
            return ast.List([ast.List(row, ast.Load()) for row in rows], ast.Load())
        if value not in self._trees:
            self._trees[value] = self._of_number(value)
        return self._trees[value]

    @cached_property
    def _trees(self) -> dict[sp.Expr, ast.expr]:
        """Trees of values that occur in several formulas."""
        return {}

    def _of_number(self, value: sp.Expr) -> ast.expr:
        if value.is_Add:
            return self._sum(value)
        coefficient, rest = value.as_coeff_Mul()
        if coefficient.is_negative:
            return ast.UnaryOp(ast.USub(), self.tree(-coefficient * rest))
        if value.is_Mul or value.is_Rational or _is_divisor(value):
            return self._product(coefficient, rest)
        return self._factor(value)

    def _sum(self, value: sp.Expr) -> ast.expr:
        terms = sorted(value.as_ordered_terms(order="lex"), key=self._place_of_term)
        first = next((k for k, term in enumerate(terms) if not _is_negative(term)), 0)
        if self._degrees(terms[first]) == self._degrees(terms[0]):
            terms.insert(0, terms.pop(first))  # no minus sign at the start
        total = self.tree(terms[0])
        for term in terms[1:]:
            sign = ast.Sub() if _is_negative(term) else ast.Add()
            total = ast.BinOp(total, sign, self.tree(-term if _is_negative(term) else term))
        return total

    def _product(self, coefficient: sp.Rational, rest: sp.Expr) -> ast.expr:
        above: list[sp.Expr] = []
        below: list[sp.Expr] = []
        for factor in sp.Mul.make_args(rest):
            is_divisor = _is_divisor(factor)
            (below if is_divisor else above).append(1 / factor if is_divisor else factor)
        factors = [self._factor(one) for one in sorted(above, key=self._place) if one != 1]
        divisors = [self._factor(one) for one in sorted(below, key=self._place)]
        p, q = _number(coefficient.p), _number(coefficient.q)
        if divisors:
            factors = [p, *factors] if coefficient.p != 1 or not factors else factors
            divisors = [q, *divisors] if coefficient.q != 1 else divisors
            return ast.BinOp(_multiplied(factors), ast.Div(), _multiplied(divisors))
        if coefficient.q != 1:
            return _multiplied([ast.BinOp(p, ast.Div(), q), *factors])
        return _multiplied([p, *factors] if coefficient.p != 1 or not factors else factors)

    def _factor(self, value: sp.Expr) -> ast.expr:
        if value.is_Symbol:
            return _name(value.name)
        if value is sp.pi:
            return _name("pi")
        if isinstance(value, sp.exp) or value is sp.E:
            return _call("exp", self.tree(sp.log(value)))
        if value.is_Pow:
            base, exponent = value.as_base_exp()
            if exponent == sp.Rational(1, 2):
                return _call("sqrt", self.tree(base))
            return ast.BinOp(self.tree(base), ast.Pow(), self.tree(exponent))
        if value.is_Function:
            return ast.Call(_name(value.func.__name__), [*map(self.tree, value.args)], [])
        return self.tree(value)

    def _place(self, factor: sp.Expr) -> tuple[int, int, str]:
        """The place of a factor: that of its last symbol, and functions after symbols."""
        if factor.atoms(*FUNCTIONS):
            return (len(KINDS), 0, self._print(factor))
        places = (self._place_of_symbol(symbol) for symbol in factor.free_symbols)
        return (*max(places, default=(-1, 0)), self._print(factor))

    def _place_of_symbol(self, symbol: sp.Symbol) -> tuple[int, int]:
        kind = self.kinds.get(symbol, "parameter")
        return (KINDS.index(kind), self._index.get(symbol, 0))

    @cached_property
    def _print(self) -> Callable[[sp.Expr], str]:
        return _Texts().doprint

    @cached_property
    def _index(self) -> dict[sp.Symbol, int]:
        return {symbol: k for k, symbol in enumerate(self.kinds)}

    def _place_of_term(self, term: sp.Expr) -> tuple[object, ...]:
        """Accelerations first, then by the degree in rates, then by coordinates."""
        rates, coordinates = [*self._powers(term, "rate")], [*self._powers(term, "coordinate")]
        accelerations = [*self._powers(term, "acceleration")]
        return (
            *self._degrees(term),
            *(accelerations, len({*rates}), rates),
            *(bool(term.atoms(*FUNCTIONS)), len(coordinates), coordinates),
        )

    def _degrees(self, term: sp.Expr) -> tuple[int, int]:
        accelerations = len([*self._powers(term, "acceleration")])
        return (-accelerations, -len([*self._powers(term, "rate")]))

    def _powers(self, term: sp.Expr, kind: Kind) -> Iterator[int]:
        """The indices of symbols of a kind among the factors, each as often as its power."""
        for factor in sp.Mul.make_args(term):
            base, exponent = factor.as_base_exp()
            if self.kinds.get(base) == kind and exponent.is_Integer and exponent > 0:
                yield from [self._index[base]] * int(exponent)


class _Texts(StrPrinter):
    """Texts of expressions, as `str` gives them; sums and products are printed once."""

    def __init__(self) -> None:
        super().__init__()
        self._known: dict[sp.Expr, str] = {}

    def _print(self, expr: sp.Basic, **kwargs: Any) -> str:
        if not isinstance(expr, sp.Add | sp.Mul):
            return str(super()._print(expr, **kwargs))
        if expr not in self._known:
            self._known[expr] = str(super()._print(expr, **kwargs))
        return self._known[expr]


def _is_divisor(factor: sp.Expr) -> bool:
    """Whether a factor is printed below the line of a fraction."""
    return bool(factor.is_Pow and factor.exp.is_Rational and factor.exp < 0)


def _is_negative(term: sp.Expr) -> bool:
    return bool(term.as_coeff_Mul()[0].is_negative)


def _number(value: int) -> ast.expr:
    return ast.Constant(int(value))


def _name(name: str) -> ast.expr:
    return ast.Name(name, ast.Load())


def _call(name: str, argument: ast.expr) -> ast.expr:
    return ast.Call(_name(name), [argument], [])


def _multiplied(factors: list[ast.expr]) -> ast.expr:
    return reduce(lambda a, b: ast.BinOp(a, ast.Mult(), b), factors)
