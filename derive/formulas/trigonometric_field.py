"""Rational functions of variables, parameters, sines and cosines, as a field with derivatives."""

from collections.abc import Sequence
from itertools import islice
from math import lcm
from typing import Any

import sympy as sp
from sympy.polys.matrices import DomainMatrix

TANGENT = (sp.tan, lambda angle: sp.sin(angle) / sp.cos(angle))


class TrigonometricField:
    """The field of rational functions of variables, parameters, sines and cosines.

    The tangent of half an angle is a variable, so that equal functions are equal fractions.
    """

    def __init__(self, formulas: Sequence[sp.Expr], variables: Sequence[sp.Symbol]) -> None:
        self.variables = variables
        multiples: dict[sp.Expr, list[int]] = {}
        for wave in set().union(*(f.replace(*TANGENT).atoms(sp.sin, sp.cos) for f in formulas)):
            for angle, n in sp.expand(wave.args[0]).as_coefficients_dict().items():
                if angle.has(sp.pi) or not n.is_Rational:
                    raise NotImplementedError(f"{wave} is not a rational function of sines")
                multiples.setdefault(angle, []).append(int(sp.Rational(n).q))
        self._angles = {angle: angle / lcm(*result) for angle, result in multiples.items()}
        self._halves = {angle: sp.Dummy(f"tan_{k}") for k, angle in enumerate(self._angles)}
        symbols = set().union(*(formula.free_symbols for formula in formulas))
        constants = sorted(symbols - {*variables}, key=str)
        moving = [a for a in self._angles if a.free_symbols & {*variables}]
        fixed = [self._halves[a] for a in self._angles if a not in moving]
        self.moving = (*variables, *(self._halves[a] for a in moving))
        self.constants = (*constants, *fixed)
        self.field = sp.QQ.frac_field(*self.moving, *self.constants)
        self.numbers = sp.QQ.frac_field(*self.constants) if self.constants else sp.QQ
        self.tangents = {self._halves[a]: sp.tan(self._angles[a] / 2) for a in self._angles}
        primes = sp.primerange(11, 10_000)
        self._point = [sp.QQ(prime, 100) for prime in islice(primes, self.field.ngens)]
        self._generators = {v: self.field(v) for v in variables}
        self.waves = tuple(
            wave(self._angles[angle]) for angle in moving for wave in (sp.sin, sp.cos)
        )
        half = [(self.field(self._halves[a]), self._angles[a]) for a in self._angles]
        self._derivatives = {
            v: [(t, (1 + t**2) * self.value(a.diff(v)) / 2) for t, a in half if a.has(v)]
            for v in variables
        }

    def value(self, formula: sp.Expr) -> Any:
        """The element of the field; `NotImplementedError` if there is none."""
        formula = formula.replace(*TANGENT)
        values = {}
        for wave in formula.atoms(sp.sin, sp.cos):
            terms = sp.expand(wave.args[0]).as_coefficients_dict().items()
            names = {angle: sp.Dummy() for angle, _ in terms}
            scaled = (n * angle / self._angles[angle] * names[angle] for angle, n in terms)
            expanded = sp.expand_trig(wave.func(sp.Add(*scaled)))
            for angle, name in names.items():
                t = self._halves[angle]
                sine, cosine = 2 * t / (1 + t**2), (1 - t**2) / (1 + t**2)
                expanded = expanded.subs({sp.sin(name): sine, sp.cos(name): cosine})
            values[wave] = expanded
        try:
            return self.field.from_sympy(formula.xreplace(values))
        except (sp.CoercionFailed, ValueError):
            raise NotImplementedError(
                f"{str(formula)[:80]} is not a rational function of coordinates, sines and cosines"
            ) from None

    def derivative(self, value: Any, variable: sp.Symbol) -> Any:
        """The derivative by a variable."""
        own = value.diff(self._generators[variable])
        return sum((value.diff(t) * rate for t, rate in self._derivatives[variable]), own)

    def gradient(self, value: Any) -> list[Any]:
        """The derivatives by all variables."""
        return [self.derivative(value, variable) for variable in self.variables]

    def at_a_point(self, value: Any) -> Any:
        """The number of an element where all variables and parameters have certain values."""
        return value.numer(*self._point) / value.denom(*self._point)

    def is_never_zero(self, value: Any) -> bool:
        """Whether the numerator has no variables but in factors 1 + tan² of half an angle."""
        numerator = value.numer
        for t in (self.field(half).numer for half in self._halves.values()):
            while numerator and not numerator.rem(t**2 + 1):
                numerator = numerator.exquo(t**2 + 1)
        moving = range(len(self.moving))
        return bool(numerator) and not any(powers[k] for powers in numerator for k in moving)

    def rank(self, rows: Sequence[Sequence[Any]]) -> int:
        """The number of independent rows."""
        shape = (len(rows), len(self.variables))
        return DomainMatrix([*map(list, rows)], shape, self.field).rank() if rows else 0
