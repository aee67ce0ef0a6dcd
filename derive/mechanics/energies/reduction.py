"""Targeted reduction of trigonometric sums: the shortest of several equal forms.

Products of sines and cosines become sines and cosines of sums of angles, for
which every identity holds by cancellation: cos a cos b + sin a sin b is
cos(a - b), sin² a + cos² a is 1. Squares are tried in place of doubled angles,
since sin² a costs less than (1 - cos 2a)/2 and is accurate near a = 0.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property, reduce
from itertools import starmap
from operator import add
from typing import Any, TypeAlias

import sympy as sp

from derive.formulas.budget import MOST_EXPANDED, is_expandable

#: Whether a term has a sine, the multiples of the angles in it, and the powers of other factors.
Key: TypeAlias = tuple[bool, tuple[Any, ...], tuple[Any, ...]]
Terms: TypeAlias = dict[Key, Any]

HALF = sp.QQ(1, 2)


@dataclass(frozen=True)
class Harmonics:
    """`expression` as a sum of coefficient times sine or cosine of a sum of angles.

    Terms are collected as numbers by the multiples of angles and the powers of other factors, so
    that terms that cancel never become SymPy expressions.
    """

    expression: sp.Expr

    @cached_property
    def sum(self) -> sp.Expr:
        """The sum, one term for each sine or cosine."""
        coefficients: dict[sp.Expr, list[sp.Expr]] = {}
        for (is_sine, multiples, powers), number in self._terms.items():
            angle = sp.Add(*map(sp.Mul, multiples, self._angles))
            factors = map(sp.Pow, self._factors, powers)
            wave = sp.sin(angle) if is_sine else sp.cos(angle)
            term = sp.Mul(sp.QQ.to_sympy(number), *factors)
            if self._has_roots:  # two of which are a sum
                term = sp.expand(term)
            coefficients.setdefault(wave, []).append(term)
        return sp.Add(*(sp.Add(*terms) * wave for wave, terms in coefficients.items()))

    @cached_property
    def fewest_operations(self) -> int:
        """A lower bound for the operations of the sum, also with squares for doubled angles."""
        waves = {(is_sine, multiples) for is_sine, multiples, _ in self._terms if any(multiples)}
        return len(waves) + len(self._terms) - 1 + sum(starmap(_products, self._terms.items()))

    @cached_property
    def _leaves(self) -> tuple[dict[sp.Expr, int], dict[sp.Expr, int]]:
        """Positions of angles, and of factors other than numbers and waves."""
        angles, factors = dict[sp.Expr, int](), dict[sp.Expr, int]()
        waiting, visited = [self.expression], set[sp.Expr]()
        while waiting:
            if (one := waiting.pop()) in visited or one.is_Rational:
                continue
            visited.add(one)
            if one.is_Add or one.is_Mul or _is_product(one):
                waiting += one.args
            elif isinstance(one, sp.sin | sp.cos):
                for angle in _multiples(one):
                    angles.setdefault(angle, len(angles))
            else:
                factors.setdefault(_power(one)[0], len(factors))
        return angles, factors

    @property
    def _angles(self) -> Iterable[sp.Expr]:
        return self._leaves[0]

    @property
    def _factors(self) -> Iterable[sp.Expr]:
        return self._leaves[1]

    @cached_property
    def _has_roots(self) -> bool:
        return any(factor.is_Add for factor in self._factors)

    @cached_property
    def _nothing(self) -> Key:
        angles, factors = self._leaves
        return False, (0,) * len(angles), (0,) * len(factors)

    @cached_property
    def _terms(self) -> Terms:
        return self._of(self.expression, {})

    def _of(self, one: sp.Expr, known: dict[sp.Expr, Terms]) -> Terms:
        if one not in known:
            known[one] = self._expanded(one, known)
        return known[one]

    def _expanded(self, one: sp.Expr, known: dict[sp.Expr, Terms]) -> Terms:
        is_sine, multiples, powers = self._nothing
        if one.is_Rational:
            return {self._nothing: sp.QQ.from_sympy(one)} if one else {}
        if one.is_Add:
            return _total(self._of(part, known) for part in one.args)
        if one.is_Mul:
            return reduce(_product, [self._of(part, known) for part in one.args])
        if _is_product(one):
            return reduce(_product, [self._of(one.base, known)] * int(one.exp))
        if isinstance(one, sp.sin | sp.cos):
            row = [*multiples]
            for angle, multiple in _multiples(one).items():
                row[self._leaves[0][angle]] = _number(multiple)
            return _wave(isinstance(one, sp.sin), tuple(row), powers, sp.QQ(1))
        base, exponent = _power(one)
        row = [*powers]
        row[self._leaves[1][base]] = _number(exponent)
        return {(is_sine, multiples, tuple(row)): sp.QQ(1)}


def _products(key: Key, number: Any) -> int:
    """The multiplications in a term without those by its wave, at least."""
    _, multiples, powers = key
    factors = len(powers) - powers.count(0)
    return max(factors - 1, 0) + (abs(number) != 1 and (factors > 0 or any(multiples)))


def _is_product(one: sp.Expr) -> bool:
    """Whether a power is a product of sums, products or waves."""
    is_whole = one.is_Pow and one.exp.is_Integer and one.exp > 0
    return bool(is_whole and (one.base.is_Add or isinstance(one.base, sp.sin | sp.cos)))


def _power(factor: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    base, exponent = factor.as_base_exp()
    return (base, exponent) if exponent.is_Rational else (factor, sp.S.One)


def _number(value: sp.Rational) -> Any:
    return int(value) if value.is_Integer else sp.QQ.from_sympy(value)


def _multiples(wave: sp.Expr) -> dict[sp.Expr, sp.Rational]:
    """The angles in the argument of a sine or cosine."""
    return dict(sp.expand(wave.args[0]).as_coefficients_dict())


def _wave(is_sine: bool, multiples: tuple[Any, ...], powers: tuple[Any, ...], number: Any) -> Terms:
    """A term, with its first multiple positive."""
    first = next(filter(None, multiples), 0)
    if first < 0:
        multiples, number = tuple(-k for k in multiples), -number if is_sine else number
    return {(is_sine, multiples, powers): number} if first or not is_sine else {}


def _total(sums: Iterable[Terms]) -> Terms:
    total: Terms = {}
    for terms in sums:
        for key, number in terms.items():
            total[key] = total[key] + number if key in total else number
    return {key: number for key, number in total.items() if number}


def _product(one: Terms, other: Terms) -> Terms:
    """The product of two sums: of cos a cos b and so on half of f(a + b) ± f(a - b)."""
    total: Terms = {}
    for (sine_a, a, powers_a), x in one.items():
        for (sine_b, b, powers_b), y in other.items():
            powers, number = tuple(map(add, powers_a, powers_b)), x * y
            if not any(a) or not any(b):
                parts = [(sine_a or sine_b, tuple(map(add, a, b)), number)]
            else:
                half, is_sine = HALF * number, sine_a != sine_b
                minus = tuple(-k for k in b)
                parts = [
                    (is_sine, tuple(map(add, a, b)), -half if sine_a and sine_b else half),
                    (is_sine, tuple(map(add, a, minus)), -half if sine_b and not sine_a else half),
                ]
            for is_sine, multiples, part in parts:
                for key, value in _wave(is_sine, multiples, powers, part).items():
                    total[key] = total[key] + value if key in total else value
    return {key: number for key, number in total.items() if number}


Square = Callable[[sp.Expr], sp.Expr]
#: Terms of the largest expression that is expanded to collect them.
MOST_TERMS = 1000
#: Forms of cos 2a.
SQUARES: tuple[Square, ...] = (lambda a: 1 - 2 * sp.sin(a) ** 2, lambda a: 2 * sp.cos(a) ** 2 - 1)


def reduced(expression: sp.Expr, largest: int = MOST_EXPANDED) -> sp.Expr:
    """The form of `expression` with the fewest operations; unchanged if too long."""
    if not expression.has(sp.sin, sp.cos) or not is_expandable(
        expression, waves=2, largest=largest
    ):
        return expression
    harmonics, operations = Harmonics(expression), int(expression.count_ops())
    if harmonics.fewest_operations > operations:
        return expression
    waves = harmonics.sum
    counts = {waves: int(waves.count_ops())}
    counts.setdefault(expression, operations)  # known; to count takes long
    if halves := _halves(waves):
        others = (_halved(waves, halves, square) for square in SQUARES)
        counts |= {one: int(one.count_ops()) for one in others}
    return min(counts, key=counts.__getitem__)


def collected(expression: sp.Expr, *variables: sp.Symbol) -> sp.Expr:
    """`expression` expanded, one term for each function of `variables`; unchanged if too long."""
    if not is_expandable(expression, largest=MOST_TERMS):
        return expression
    return gathered(sp.expand(expression), *variables)


def gathered(expression: sp.Expr, *variables: sp.Symbol) -> sp.Expr:
    """`expression` with one term for each function of `variables`; products of sums are kept.

    The square of a difference is accurate where the difference is small, its expansion is not.
    """
    coefficients: dict[sp.Expr, sp.Expr] = {}
    for coefficient, dependent in _terms(expression, variables):
        coefficients[dependent] = coefficients.get(dependent, sp.S.Zero) + coefficient
    return sp.Add(*(sp.factor_terms(c) * dependent for dependent, c in coefficients.items()))


def _terms(
    expression: sp.Expr, variables: tuple[sp.Symbol, ...]
) -> Iterator[tuple[sp.Expr, sp.Expr]]:
    """Terms of a sum, also of one with a constant factor: their coefficients and functions."""
    for term in sp.Add.make_args(expression):
        coefficient, dependent = term.as_independent(*variables, as_Add=False)
        if dependent.is_Add:
            for inner, function in _terms(dependent, variables):
                yield coefficient * inner, function
        else:
            yield coefficient, dependent


def _halves(expression: sp.Expr) -> dict[sp.Expr, sp.Expr]:
    """Half the arguments of sines and cosines, where it is an integer combination of angles."""
    halves = {wave: wave.args[0] / 2 for wave in expression.atoms(sp.sin, sp.cos)}
    return {
        wave: half
        for wave, half in halves.items()
        if all(c.is_Integer for c in half.as_coefficients_dict().values())
    }


def _halved(waves: sp.Expr, halves: dict[sp.Expr, sp.Expr], square: Square) -> sp.Expr:
    """`waves` with cos 2a as a square and sin 2a as a product."""
    replacements = {
        wave: square(half) if isinstance(wave, sp.cos) else 2 * sp.sin(half) * sp.cos(half)
        for wave, half in halves.items()
    }
    return sp.expand(waves.xreplace(replacements))
