"""Exact tests for zero and for positive sign; proofs, not samples.

A rational expression in sines, cosines and other symbols is brought to a
polynomial over a product of polynomials, with cos² replaced by 1 - sin² for
every angle. The polynomial is then a normal form, since sin² + cos² - 1
generates all relations between the sine and the cosine of independent angles:
the expression is zero exactly when the polynomial is.
"""

from collections import Counter
from dataclasses import dataclass, field
from functools import cache, reduce
from math import lcm
from operator import or_

import sympy as sp
from sympy.polys.rings import PolyElement, PolyRing

from derive.formulas.expansion import is_expandable

#: Largest power, and largest multiple of an angle, that is expanded.
MAX_MULTIPLE = 100

#: Limit of the work: products of two terms of polynomials; a second or two.
MAX_PRODUCTS = 200_000


def vanishes(expression: sp.Expr) -> bool:
    """Whether `expression`, rational in symbols and in sines and cosines of sums, is zero.

    A `NotImplementedError` reports other expressions, powers and multiples of angles above
    `MAX_MULTIPLE`, and more work than `MAX_PRODUCTS`; a `ZeroDivisionError`, a denominator that is
    identically zero.
    """
    whole = _with_integer_angles(expression)
    expanded = whole.xreplace({wave: _expanded(wave) for wave in _waves(whole)})
    waves = _waves(expanded)
    generators = sorted({*expanded.free_symbols, *waves}, key=sp.default_sort_key)
    ring = PolyRing(generators, sp.QQ, sp.lex)
    pairs = {
        ring.index(ring(wave)): ring(sp.sin(wave.args[0]))
        for wave in waves
        if isinstance(wave, sp.cos) and sp.sin(wave.args[0]) in waves
    }
    return not _Converter(ring, pairs).fraction(expanded).numerator


def is_positive(expression: sp.Expr, *, strictly: bool) -> bool:
    """Whether `expression` is proved positive, or not negative, as a sum of such terms."""
    numerator, denominator = sp.fraction(sp.together(expression))
    angles = {wave.args[0] for wave in _waves(numerator)}
    squares = [(sp.sin(angle) ** 2, sp.cos(angle) ** 2) for angle in angles]
    forms = [numerator, *(numerator.subs(a, 1 - b) for a, b in squares)]
    forms += [numerator.subs(b, 1 - a) for a, b in squares]
    factored = (sp.factor_terms(sp.expand(form)) for form in forms)
    proofs = (form.is_positive if strictly else form.is_nonnegative for form in factored)
    return bool(denominator.is_positive and any(proofs))


@dataclass(frozen=True)
class _Fraction:
    """A polynomial over a product of powers of polynomials."""

    numerator: PolyElement
    denominator: Counter[PolyElement] = field(default_factory=Counter)  # powers


class _Converter:
    """Conversion of expressions to fractions over one ring, with cos² replaced by 1 - sin²."""

    def __init__(self, ring: PolyRing, sines: dict[int, PolyElement]) -> None:
        self._ring, self._sines = ring, sines
        self._cache: dict[sp.Expr, _Fraction] = {}
        self._products = 0

    def fraction(self, expression: sp.Expr) -> _Fraction:
        if expression not in self._cache:
            self._cache[expression] = self._convert(expression)
        return self._cache[expression]

    def _convert(self, expression: sp.Expr) -> _Fraction:
        if expression.is_Rational or expression in self._ring.symbols:
            return _Fraction(self._ring(expression))
        if expression.is_Add:
            return self._sum([self.fraction(term) for term in expression.args])
        if expression.is_Mul:
            return reduce(self._product, map(self.fraction, expression.args))
        if expression.is_Pow and expression.exp.is_Integer and abs(expression.exp) <= MAX_MULTIPLE:
            power = int(expression.exp)
            base = reduce(self._product, [self.fraction(expression.base)] * abs(power))
            return base if power > 0 else self._inverse(base)
        raise NotImplementedError(f"cannot decide whether {str(expression)[:80]!r} vanishes")

    def _sum(self, fractions: list[_Fraction]) -> _Fraction:
        common = reduce(or_, (fraction.denominator for fraction in fractions))
        total = self._ring.zero
        for fraction in fractions:
            missing = common - fraction.denominator
            total += reduce(self._times, missing.elements(), fraction.numerator)
        return _Fraction(total, common if total else Counter())

    def _product(self, a: _Fraction, b: _Fraction) -> _Fraction:
        return _Fraction(self._times(a.numerator, b.numerator), a.denominator + b.denominator)

    def _inverse(self, a: _Fraction) -> _Fraction:
        if not a.numerator:
            raise ZeroDivisionError("a denominator is identically zero")
        content, primitive = a.numerator.primitive()
        # common symbols become separate factors, because they often cancel
        shared = tuple(map(min, zip(*primitive.monoms(), strict=True)))
        denominator = Counter(dict(zip(self._ring.gens, shared, strict=True)))
        rest = primitive.quo(self._ring({shared: sp.QQ(1)}))
        if rest != 1:
            denominator[rest] = 1
        above = a.denominator.elements()
        return _Fraction(reduce(self._times, above, self._ring(1 / content)), +denominator)

    def _multiplied(self, a: PolyElement, b: PolyElement) -> PolyElement:
        self._products += len(a) * len(b)
        if self._products > MAX_PRODUCTS:
            raise NotImplementedError("cannot decide within the limit of work")
        return a * b

    def _times(self, a: PolyElement, b: PolyElement) -> PolyElement:
        product = self._multiplied(a, b)
        for i, sine in self._sines.items():
            parts: dict[int, dict[tuple[int, ...], object]] = {}  # by the power of cos²
            for monomial, coefficient in product.terms():
                half, odd = divmod(monomial[i], 2)
                parts.setdefault(half, {})[(*monomial[:i], odd, *monomial[i + 1 :])] = coefficient
            if {*parts} - {0}:
                product = sum(
                    (self._multiplied(self._ring(p), (1 - sine**2) ** n) for n, p in parts.items()),
                    self._ring.zero,
                )
        return product


def _waves(expression: sp.Expr) -> set[sp.Expr]:
    return set(expression.atoms(sp.sin, sp.cos))


def _with_integer_angles(expression: sp.Expr) -> sp.Expr:
    """Rescale the symbols of `expression` so that all multiples of angles are integers."""
    if not all(is_expandable(wave.args[0]) for wave in _waves(expression)):
        raise NotImplementedError("cannot expand an angle: it has too many terms")
    arguments = [sp.expand(wave.args[0]) for wave in _waves(expression)]
    multiples = [n for a in arguments for n in a.as_coefficients_dict().values()]
    scale = lcm(*(int(n.q) for n in multiples if n.is_Rational))
    symbols = {symbol for argument in arguments for symbol in argument.free_symbols}
    if scale > 1:
        expression = expression.xreplace({symbol: scale * symbol for symbol in symbols})
    return expression.xreplace({w: w.func(sp.expand(w.args[0])) for w in _waves(expression)})


@cache
def _expanded(wave: sp.Expr) -> sp.Expr:
    if any(abs(n) > MAX_MULTIPLE for n in wave.args[0].as_coefficients_dict().values()):
        raise NotImplementedError(f"cannot expand {wave}: it has a multiple above {MAX_MULTIPLE}")
    return sp.expand_trig(wave)
