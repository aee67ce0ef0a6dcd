"""The limits of formulas, checked after every operation: no value outgrows the next one."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import log, prod

import sympy as sp
from sympy.core.basic import Basic

from derive.formulas.numeric import Evaluator

#: Largest absolute value of an exponent, also of a power of powers, and bits of a number.
MAX_EXPONENT, MAX_BITS = 100, 400
#: The largest number and the inverse of the smallest one, which generated code can contain.
LARGEST = 1e300
MAX_LOGARITHM = log(LARGEST)
RANGE = f"numbers are from {1 / LARGEST:g} to {LARGEST:g}; choose other units"
#: Operands of a formula with all names written out, and of all formulas of a file.
MAX_SIZE, MAX_FILE = 5_000, 100_000
#: Levels of a formula, and of functions and roots within each other, whose derivatives are products
#: of those of all levels.
MAX_DEPTH, MAX_NESTING = 30, 12
#: Operands of the second derivatives of a formula that is judged, and of one in a system, whose
#: equations of motion contain them.
MAX_SECOND, MAX_SECOND_IN_SYSTEM = 60_000, 12_000
#: Factors of a product in a system, besides powers of names: its derivatives contain those of all.
MAX_FACTORS_IN_SYSTEM = 12
#: Arguments of one min or max.
MAX_ARGUMENTS = 12
#: Parts of formulas that have no finite value.
INFINITE = (sp.zoo, sp.nan, sp.oo, -sp.oo)

REMEDY = "simplify the formula, or the definitions that it uses"


class BudgetError(ValueError):
    """A formula exceeds a limit; the message names the limit and the way out."""


@dataclass(frozen=True, slots=True)
class Extent:
    """The size of a formula that is written out, without shared parts."""

    size: int  # numbers, names and operations
    depth: int
    exponent: int  # of powers of powers, multiplied
    nesting: int  # functions and roots within each other
    first: int  # operands in a first derivative, at most
    second: int  # and in a second one
    factors: int  # of a product, besides powers of names


class Budget:
    """The extents of formulas; equal parts are measured once."""

    def __init__(self, max_second: int = MAX_SECOND, max_factors: int = MAX_SIZE) -> None:
        self._max_second, self._max_factors = max_second, max_factors
        self._known: dict[Basic, Extent] = {}
        self._value = Evaluator({})
        self._spent = 0

    def check(self, value: Basic) -> None:
        """Raise `BudgetError` if a formula is too large, or contains a number that is."""
        extent = self._extent(value)
        if extent.size > MAX_SIZE:
            raise BudgetError(
                f"written out, it has more than {MAX_SIZE} numbers, names and operations: {REMEDY}"
            )
        if extent.depth > MAX_DEPTH:
            raise BudgetError(f"written out, it has more than {MAX_DEPTH} levels: {REMEDY}")
        if extent.nesting > MAX_NESTING:
            raise BudgetError(
                f"more than {MAX_NESTING} functions and roots are within each other: {REMEDY}"
            )
        if extent.second > self._max_second:
            raise BudgetError(
                f"its second derivatives have more than {self._max_second} operands: {REMEDY}"
            )
        if extent.factors > self._max_factors:
            raise BudgetError(
                f"a product has more than {self._max_factors} factors that are formulas: {REMEDY}"
            )
        if extent.exponent > MAX_EXPONENT:
            raise BudgetError(f"exponent {extent.exponent}: at most {MAX_EXPONENT} is allowed")

    def check_product(self, a: Basic, b: Basic) -> None:
        """Raise `BudgetError` if a product of matrices is too large."""
        if isinstance(a, sp.MatrixBase) and isinstance(b, sp.MatrixBase):
            size = self._extent(a).size * b.cols + self._extent(b).size * a.rows
            if size > MAX_SIZE:
                raise BudgetError(f"a product of matrices has some {size} operands: {REMEDY}")

    def spend(self, value: Basic) -> None:
        """Add a formula to those of a file, or raise `BudgetError`."""
        self._spent += self._extent(value).size
        if self._spent > MAX_FILE:
            raise BudgetError(
                f"written out, the formulas of the file have more than {MAX_FILE} numbers, names "
                f"and operations: {REMEDY}"
            )

    def _extent(self, value: Basic) -> Extent:
        if value not in self._known:
            self._check_number(value)
            self._known[value] = _extent(value, [self._extent(part) for part in _parts(value)])
        return self._known[value]

    def _check_number(self, value: Basic) -> None:
        if value.is_Pow and value.exp.is_Rational and value.exp.q > MAX_EXPONENT:
            raise BudgetError(f"exponent {value.exp}: its denominator is at most {MAX_EXPONENT}")
        if isinstance(value, sp.Rational):
            bits = max(value.p.bit_length(), value.q.bit_length())
            if bits > MAX_BITS:
                raise BudgetError(f"a number has {bits} bits; at most {MAX_BITS} are allowed")
        elif value.is_Mul or value.is_Pow or value.is_Function:
            number = sp.Mul(*(factor for factor in sp.Mul.make_args(value) if factor.is_number))
            if not number.is_Rational and not number.has(*INFINITE):
                self._check_magnitude(number)

    def check_exponential(self, argument: sp.Expr) -> None:
        """Raise `BudgetError` if the exponential function of a number is out of range."""
        if argument.is_number and abs(self._value(argument).number) > MAX_LOGARITHM:
            raise BudgetError(f"exp({str(argument)[:50]}) is out of range: {RANGE}")

    def check_arguments(self, function: object, arguments: Sequence[Basic]) -> None:
        """Raise `BudgetError` if a largest or smallest of numbers, which are compared, has many."""
        counts = (len(a.args) if type(a) is function else 1 for a in arguments)
        if function in (sp.Max, sp.Min) and sum(counts) > MAX_ARGUMENTS:
            raise BudgetError(f"more than {MAX_ARGUMENTS} arguments of one min or max: {REMEDY}")

    def check_exponent(self, exponent: sp.Expr) -> None:
        """Raise `BudgetError` if an exponent is a number that is too large or not real."""
        self.check_real(exponent)
        if exponent.is_number and abs(self._value(exponent).number) > MAX_EXPONENT:
            limit = f"only numbers up to {MAX_EXPONENT} are allowed"
            raise BudgetError(f"exponent {str(exponent)[:50]}: {limit}")

    def check_real(self, value: sp.Expr) -> None:
        """Raise `BudgetError` if a formula is a number that is not real."""
        if value.is_number and self._value(value).number.imag:
            raise BudgetError(f"{str(value)[:50]} is not a real number")

    def _check_magnitude(self, number: sp.Expr) -> None:
        approximation = self._value(number)
        size = abs(approximation.number)
        if not approximation.is_zero and not 1 / LARGEST < size < LARGEST:
            raise BudgetError(f"{str(number)[:50]} is out of range: {RANGE}")


def _parts(value: Basic) -> tuple[Basic, ...]:
    return tuple(value) if isinstance(value, sp.MatrixBase) else value.args


def _extent(value: Basic, parts: Sequence[Extent]) -> Extent:
    """The extent of a formula with these parts."""
    if not parts:
        varies = int(value.is_Symbol)
        return Extent(1, 1, 1, 0, varies, varies, 0)
    exponent = max(part.exponent for part in parts)
    if value.is_Pow and value.exp.is_Rational:
        exponent *= max(1, abs(int(value.exp)))
    first, second = (sum(getattr(part, name) for part in parts) for name in ("first", "second"))
    if value.is_Mul:
        # each factor is differentiated in turn, with the others beside it
        varying = sum(part.first > 0 for part in parts)
        second += varying * (varying * len(parts) + 2 * first)
        first += varying * len(parts)
    elif not value.is_Add:  # f(u)' = f'(u) u', f(u)'' = f''(u) u'² + f'(u) u''
        arguments = max(1, sum(part.first > 0 for part in parts))
        second += arguments * (2 * first + 2)
        first += arguments
    size, depth = 1 + sum(part.size for part in parts), 1 + max(part.depth for part in parts)
    is_root = value.is_Pow and not value.exp.is_Integer
    nesting = max(part.nesting for part in parts) + (value.is_Function or is_root)
    own = sum(not factor.as_base_exp()[0].is_Atom for factor in value.args) if value.is_Mul else 0
    factors = max(own, *(part.factors for part in parts))
    return Extent(size, depth, exponent, nesting, first, second, factors)


WAVES = (sp.sin, sp.cos)
#: Terms of the largest expression that is expanded.
MOST_EXPANDED = 5000


def is_expandable(expression: sp.Expr, *, waves: int = 1, largest: int = MOST_EXPANDED) -> bool:
    """Whether the expanded expression has at most `largest` terms, before terms are collected.

    With `waves` = 2, products of sines and cosines are expanded, too, into sums of them.
    """
    return _expanded_size(expression, waves, {}) <= largest


def _expanded_size(expression: sp.Expr, waves: int, known: dict[sp.Expr, int]) -> int:
    """Number of terms of the expanded expression, up to a bound."""
    if expression not in known:
        sizes = [_expanded_size(part, waves, known) for part in expression.args]
        if isinstance(expression, WAVES):
            sizes = [waves]  # a product of n waves is a sum of 2^n waves, of a power n + 1
        if expression.is_Add:
            size = sum(sizes)
        elif expression.is_Mul:
            size = prod(sizes)
        elif expression.is_Pow and isinstance(expression.base, WAVES) and expression.exp.is_Integer:
            size = 1 + (waves - 1) * abs(int(expression.exp))
        elif expression.is_Pow and expression.exp.is_Integer:  # denominators are expanded, too
            size = min(sizes[0], MOST_EXPANDED + 1) ** min(abs(int(expression.exp)), 100)
        else:
            size = max(sizes, default=1)
        known[expression] = min(size, MOST_EXPANDED + 1)
    return known[expression]
