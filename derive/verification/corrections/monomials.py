"""Numbers as monomials: a rational number times powers of known factors.

The logarithm of a monomial is linear in the exponents. They are the solution of linear
equations, one for each state, and exact fractions are close to it.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

import sympy as sp

from derive.verification.corrections.state_samples import Numbers, power, quotient

#: Largest relative difference of equal numbers, and largest exponent and denominator.
CLOSE, MAX_EXPONENT, MAX_DENOMINATOR = 1e-7, 8, 360


@dataclass(frozen=True)
class Factor:
    """A name, a function or a sum that monomials can contain, with its values."""

    expression: sp.Expr
    values: Numbers


@dataclass(frozen=True)
class Monomial:
    """A rational number times powers of factors."""

    coefficient: Fraction
    powers: tuple[tuple[sp.Expr, Fraction], ...]

    @property
    def expression(self) -> sp.Expr:
        """The product."""
        powers = (base ** sp.Rational(exponent) for base, exponent in self.powers)
        return sp.Mul(sp.Rational(self.coefficient), *powers)

    @property
    def length(self) -> float:
        """The number of factors and of their inverses, and a number or a sign."""
        return self._above + 1.5 * self._below + self._number

    @property
    def change(self) -> float:
        """The length as a change of other factors: one in place of another is hardly more."""
        return max(self._above, self._below) + 0.3 * min(self._above, self._below) + self._number

    @property
    def _above(self) -> float:
        return sum(_weight(base) * float(e) for base, e in self.powers if e > 0)

    @property
    def _below(self) -> float:
        return sum(_weight(base) * float(-e) for base, e in self.powers if e < 0)

    @property
    def _number(self) -> int:
        return (abs(self.coefficient) != 1) + (self.coefficient < 0)


def _weight(factor: sp.Expr) -> int:
    return 4 if factor.is_Add else 1


class Monomials:
    """Monomials of `factors`, identified from their values at `states`."""

    def __init__(self, factors: Iterable[Factor], states: Sequence[int]) -> None:
        self._states = states
        self._factors: list[Factor] = []
        self._basis: list[list[float]] = [[len(states) ** -0.5] * len(states)]
        self._rows: list[list[float]] = []  # of each factor, in the basis
        for factor in factors:
            logarithms = self._logarithms(factor.values)
            if logarithms and len(self._basis) < len(states) - 8:
                row, rest = self._split(logarithms)
                size = math.hypot(*rest)
                # the first of several factors that depend on each other is kept
                if size > 1e-5 * math.hypot(*logarithms):
                    self._factors.append(factor)
                    self._rows.append([*row, size])
                    self._basis.append([x / size for x in rest])

    def identified(self, values: Numbers, *, up_to_sign: bool = False) -> Monomial | None:
        """Return the monomial with these values, or None."""
        logarithms = self._logarithms(values)
        if not logarithms:
            return None
        row, rest = self._split(logarithms)
        if math.hypot(*rest) > CLOSE * len(rest):
            return None
        powers: list[tuple[Factor, Fraction]] = []
        for factor, own in zip(reversed(self._factors), reversed(self._rows), strict=True):
            exponent = row[len(own) - 1] / own[-1]
            exact = Fraction(round(2 * exponent), 2)
            if abs(exponent - exact) > 1e-4 or abs(exact) > MAX_EXPONENT:
                return None
            if exact:
                powers.append((factor, exact))
                row = [a - float(exact) * b for a, b in zip(row, own, strict=False)]
        return self._with_coefficient(values, powers[::-1], up_to_sign)

    def _with_coefficient(
        self, values: Numbers, powers: list[tuple[Factor, Fraction]], up_to_sign: bool
    ) -> Monomial | None:
        ratios = []
        for k in self._states:
            factors = [(factor.values[k], float(exponent)) for factor, exponent in powers]
            ratio = quotient(values[k], math.prod(power(*pair) for pair in factors))
            ratios.append(abs(ratio) if up_to_sign else ratio)
        if not all(map(math.isfinite, ratios)):
            return None
        coefficient = Fraction(ratios[0]).limit_denominator(MAX_DENOMINATOR)
        if any(abs(ratio - coefficient) > CLOSE * abs(ratio) for ratio in ratios):
            return None
        return Monomial(coefficient, tuple((f.expression, exponent) for f, exponent in powers))

    def _logarithms(self, values: Numbers) -> list[float] | None:
        own = [values[k] for k in self._states]
        if not all(math.isfinite(x) and x for x in own):
            return None
        return [math.log(abs(x)) for x in own]

    def _split(self, vector: list[float]) -> tuple[list[float], list[float]]:
        """Components in the basis, and the remainder orthogonal to it."""
        row = []
        for axis in self._basis:
            component = math.fsum(map(float.__mul__, axis, vector))
            row.append(component)
            vector = [x - component * a for x, a in zip(vector, axis, strict=True)]
        return row, vector
