"""Exact tests for zero and for positive sign; proofs, not samples.

A rational expression in sines, cosines and other symbols is brought to a
polynomial over a product of polynomials, with cos² replaced by 1 - sin² for
every angle. The polynomial is then a normal form, since sin² + cos² - 1
generates all relations between the sine and the cosine of independent angles:
the expression is zero exactly when the polynomial is.

Other functions become symbols. Those of roots and signs have relations: with r = b^(1/q), r^q is
replaced by b, and all combinations of signs are tried. If the polynomial is zero then, so is the
expression, apart from the zeros at which signs change; otherwise nothing is decided.
"""

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from functools import cache, reduce
from itertools import product
from math import lcm
from operator import or_
from typing import TypeAlias, TypeVar

import sympy as sp
from sympy.polys.rings import PolyElement, PolyRing

from derive.formulas.budget import is_expandable

#: Largest power, and largest multiple of an angle, that is expanded.
MAX_MULTIPLE = 100

#: Largest number of signs of which all combinations are tried.
MAX_SIGNS = 5

#: Limit of the work: products of two terms of polynomials; a second or two.
MAX_PRODUCTS = 200_000


#: A symbol, the number of which it is a root, and the degree.
Root: TypeAlias = tuple[sp.Symbol, sp.Expr, int]
_Basic = TypeVar("_Basic", bound=sp.Basic)


def vanishes(expression: sp.Expr) -> bool:
    """Whether `expression`, rational in symbols and in sines and cosines of sums, is zero.

    A `NotImplementedError` reports that this is not decided: other functions whose symbols do not
    cancel, powers and multiples of angles above `MAX_MULTIPLE`, and more work than `MAX_PRODUCTS`;
    a `ZeroDivisionError`, a denominator that is identically zero.
    """
    functions = _Functions()
    rational = functions.replaced(expression)
    if not functions.are_present:
        return not _numerator(_with_integer_angles(rational))
    whole, *bases = _with_integer_angles(sp.Tuple(rational, *functions.bases), functions.roots)
    roots = list(zip(functions.roots, bases, functions.degrees, strict=True))
    signs = list(functions.signs.values())
    if len(signs) > MAX_SIGNS:
        raise NotImplementedError(f"cannot try all combinations of {len(signs)} signs")
    for numbers in product((sp.S.One, sp.S.NegativeOne), repeat=len(signs)):
        chosen = dict(zip(signs, numbers, strict=True))
        own = [(r, base.xreplace(chosen), q) for r, base, q in roots]
        if not _vanishes_with_roots(whole.xreplace(chosen), own):
            raise NotImplementedError(f"cannot decide whether {str(expression)[:80]!r} vanishes")
    return True


def _vanishes_with_roots(expression: sp.Expr, roots: Sequence[Root]) -> bool:
    """Whether an expression is zero if r^q = b for each root, of which later contain earlier."""
    numerator = _numerator(expression)
    if not numerator or not roots:
        return not numerator
    *others, (root, base, degree) = roots
    ring = numerator.ring
    if root not in ring.symbols:
        return _vanishes_with_roots(expression, others)
    index = ring.symbols.index(root)
    parts: dict[int, list[sp.Expr]] = {}  # by the power of the root that is left
    for monomial, coefficient in numerator.terms():
        power, left = divmod(monomial[index], degree)
        rest = ring({(*monomial[:index], 0, *monomial[index + 1 :]): coefficient})
        parts.setdefault(left, []).append(rest.as_expr() * base**power)
    return all(_vanishes_with_roots(sp.Add(*terms), others) for terms in parts.values())


def _numerator(whole: sp.Expr) -> PolyElement:
    """The numerator of an expression whose angles have integer multiples, in normal form."""
    expanded = whole.xreplace({wave: _expanded(wave) for wave in _waves(whole)})
    waves = _waves(expanded)
    generators = sorted({*expanded.free_symbols, *waves}, key=sp.default_sort_key)
    ring = PolyRing(generators, sp.QQ, sp.lex)
    pairs = {
        ring.index(ring(wave)): ring(sp.sin(wave.args[0]))
        for wave in waves
        if isinstance(wave, sp.cos) and sp.sin(wave.args[0]) in waves
    }
    return _Converter(ring, pairs).fraction(expanded).numerator


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


class _Functions:
    """Symbols in place of functions other than sine and cosine, and the relations of these."""

    def __init__(self) -> None:
        #: Of signs, by their arguments; roots in the order in which they contain each other.
        self.signs: dict[sp.Expr, sp.Symbol] = {}
        self.roots: list[sp.Symbol] = []
        self.bases: list[sp.Expr] = []
        self.degrees: list[int] = []
        self._others: dict[sp.Expr, sp.Symbol] = {}

    @property
    def are_present(self) -> bool:
        """Whether an expression contains such functions."""
        return bool(self.signs or self.roots or self._others)

    def replaced(self, expression: sp.Expr) -> sp.Expr:
        """The expression with these symbols."""
        if not expression.args:
            return self._other(expression) if expression.is_NumberSymbol else expression
        if isinstance(expression, sp.Piecewise):
            return self._choice(expression)
        parts = [self.replaced(part) for part in expression.args]
        match expression:
            case sp.Add() | sp.Mul() | sp.sin() | sp.cos():
                return expression.func(*parts)
            case sp.Pow() if expression.exp.is_Integer:
                return parts[0] ** expression.exp
            case sp.Pow() if expression.exp.is_Rational:
                return self._root(parts[0], expression.exp.q) ** expression.exp.p
            case sp.Pow():
                number, rest = sp.expand(parts[1]).as_coeff_Add()
                whole = sp.floor(number)
                power = sp.Pow(_normal(parts[0]), number - whole + rest, evaluate=False)
                return parts[0] ** whole * self._other(power)
            case sp.tan():
                return sp.sin(parts[0]) / sp.cos(parts[0])
            case sp.exp():
                return self._exponential(parts[0])
            case sp.sinh() | sp.cosh() | sp.tanh():
                return self.replaced(expression.rewrite(sp.exp))
            case sp.Abs():
                return parts[0] * self._sign(parts[0])
            case sp.sign():
                return self._sign(parts[0])
            case sp.Heaviside():
                return (1 + self._sign(parts[0])) / 2
            case sp.Max() | sp.Min():
                sign = 1 if isinstance(expression, sp.Max) else -1
                return reduce(lambda a, b: (a + b + sign * (a - b) * self._sign(a - b)) / 2, parts)
        return self._other(expression.func(*map(_normal, parts)))

    def _choice(self, expression: sp.Piecewise) -> sp.Expr:
        result = sp.S.Zero
        for value, condition in reversed(expression.args):
            holds = sp.S.One
            if isinstance(condition, sp.Gt | sp.Ge | sp.Lt | sp.Le):
                larger = self.replaced(condition.gts - condition.lts)
                holds = (1 + self._sign(larger)) / 2
            elif condition != sp.true:
                raise NotImplementedError(f"cannot decide by the condition {condition}")
            result = holds * self.replaced(value) + (1 - holds) * result
        return result

    def _sign(self, argument: sp.Expr) -> sp.Expr:
        content, own = _normal(argument).as_coeff_Mul()
        if own.is_Add:
            number, own = own.primitive()
            content *= number
        if own.could_extract_minus_sign():
            content, own = -content, -own
        if content.is_zero or own.is_number:
            return sp.sign(content * own)
        return sp.sign(content) * self.signs.setdefault(own, sp.Dummy("sign", real=True))

    def _root(self, base: sp.Expr, degree: int) -> sp.Expr:
        number, own = base.primitive()
        factor = sp.root(number, degree)
        if own.is_Rational or not factor.is_Rational:
            factor, own = sp.S.One, base
        for root, known, other in zip(self.roots, self.bases, self.degrees, strict=True):
            if other == degree and not _numerator(_with_integer_angles(known - own)):
                return factor * root
        self.roots.append(sp.Dummy("root"))
        self.bases.append(own)
        self.degrees.append(int(degree))
        return factor * self.roots[-1]

    def _exponential(self, argument: sp.Expr) -> sp.Expr:
        """A product of powers, one for each term of the exponent."""
        result = sp.S.One
        for term in sp.Add.make_args(_normal(argument)):
            number, own = term.as_coeff_Mul()
            root = self._other(sp.exp(own / number.q, evaluate=False))
            result *= root**number.p
        return result

    def _other(self, expression: sp.Expr) -> sp.Symbol:
        return self._others.setdefault(expression, sp.Dummy("function"))


def _normal(expression: sp.Expr) -> sp.Expr:
    """The expanded expression, by which equal arguments are recognised."""
    return sp.expand(expression) if is_expandable(expression) else expression


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


def _waves(expression: sp.Basic) -> set[sp.Expr]:
    return set(expression.atoms(sp.sin, sp.cos))


def _with_integer_angles(expression: _Basic, fixed: Collection[sp.Symbol] = ()) -> _Basic:
    """Rescale the symbols of `expression` so that all multiples of angles are integers."""
    if not all(is_expandable(wave.args[0]) for wave in _waves(expression)):
        raise NotImplementedError("cannot expand an angle: it has too many terms")
    arguments = [sp.expand(wave.args[0]) for wave in _waves(expression)]
    multiples = [n for a in arguments for n in a.as_coefficients_dict().values()]
    scale = lcm(*(int(n.q) for n in multiples if n.is_Rational))
    symbols = {symbol for argument in arguments for symbol in argument.free_symbols}
    if scale > 1 and symbols & {*fixed}:
        raise NotImplementedError("cannot rescale a root in an angle")
    if scale > 1:
        expression = expression.xreplace({symbol: scale * symbol for symbol in symbols})
    return expression.xreplace({w: w.func(sp.expand(w.args[0])) for w in _waves(expression)})


@cache
def _expanded(wave: sp.Expr) -> sp.Expr:
    if any(abs(n) > MAX_MULTIPLE for n in wave.args[0].as_coefficients_dict().values()):
        raise NotImplementedError(f"cannot expand {wave}: it has a multiple above {MAX_MULTIPLE}")
    return sp.expand_trig(wave)
