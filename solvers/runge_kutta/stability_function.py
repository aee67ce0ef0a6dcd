"""The stability function R: a step of y' = λy multiplies y by R(hλ). Its coefficients are exact.

Of splittings, which integrate q'' = λ²q instead, a step multiplies a mode by R(hλ).
"""

from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from math import factorial, sqrt
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polymul, polysub
from numpy.typing import ArrayLike

from solvers.runge_kutta.sturm import nonnegative_interval
from solvers.runge_kutta.surd import Surd
from solvers.runge_kutta.tableau import Splitting, Tableau

#: Eigenvalues whose real part is a smaller part of them are those of oscillations.
IMAGINARY = 1e-6
#: A decimal is taken for a fraction with a smaller denominator to which it is closer.
LARGEST_DENOMINATOR, CLOSE = 10**15, Fraction(1, 10**60)
Polynomial = tuple[Fraction, ...]  # coefficients of z⁰, z¹, …


@dataclass(frozen=True)
class StabilityFunction:
    """R(z) = numerator / denominator.

    Parameters
    ----------
    numerator, denominator : tuple of Fraction
        Coefficients of z⁰, z¹, ….

    Examples
    --------
    >>> from solvers.runge_kutta.method_catalogue import load
    >>> function = StabilityFunction.of(load("rk4"))
    >>> [str(c) for c in function.numerator]
    ['1', '1', '1/2', '1/6', '1/24']
    >>> round(function.imaginary_stability_interval, 6)
    2.828427
    """

    numerator: Polynomial
    denominator: Polynomial

    @classmethod
    def of(cls, tableau: Tableau) -> "StabilityFunction":
        """The stability function of a method; the denominator of explicit methods is 1.

        Where coefficients of an explicit method are published as rounded decimals, those of R up
        to the method's order are 1/k! nevertheless, since its order is proved.
        """
        if isinstance(tableau, Splitting):
            return SplittingStability.of_splitting(tableau)
        numerator, denominator = (list(map(_fraction, p)) for p in tableau.stability_function)
        if isinstance(tableau.b[0], Decimal) and tableau.is_explicit:
            for k in range(tableau.order + 1):
                numerator[k] = Fraction(1, factorial(k))
        return cls(tuple(numerator), tuple(denominator))

    def __call__(self, z: ArrayLike) -> Any:
        """R(z) for complex z, in floating-point numbers."""
        P, Q = ([*map(float, reversed(part))] for part in (self.numerator, self.denominator))
        return np.polyval(P, np.asarray(z)) / np.polyval(Q, np.asarray(z))

    @cached_property
    def real_stability_interval(self) -> float:
        """The largest x with |R| ≤ 1 on [-x, 0]; infinity if there is no largest."""
        P, Q = _reflected(self.numerator), _reflected(self.denominator)
        return nonnegative_interval(polysub(polymul(Q, Q), polymul(P, P)))

    @cached_property
    def imaginary_stability_interval(self) -> float:
        """The largest y with |R| ≤ 1 on [-iy, iy]; infinity if there is no largest."""
        # |Q(iy)|² - |P(iy)|² is a polynomial in y²
        P, Q = map(_square_on_imaginary_axis, (self.numerator, self.denominator))
        return sqrt(nonnegative_interval(polysub(Q, P)))


class SplittingStability(StabilityFunction):
    """R of a splitting, an eigenvalue of the 2 × 2 matrix of a step of q'' = λ²q.

    The determinant of the matrix is 1, and half its trace, an approximation of cosh z, is the
    `numerator`: oscillations do not grow where that is between -1 and 1.
    """

    @classmethod
    def of_splitting(cls, splitting: Splitting) -> "SplittingStability":
        """R of a splitting; up to its order, coefficients are those of cosh z, as is proved."""
        # the highest powers have coefficients of 1e-24 and less
        exact = [Fraction(round(Fraction(c) * 10**50), 10**50) for c in splitting.half_trace]
        powers = {2 * k: (-1) ** k * c for k, c in enumerate(exact)}
        proved = {k: Fraction(1, factorial(k)) for k in range(0, splitting.order + 1, 2)}
        powers |= {k: c for k, c in proved.items() if isinstance(splitting.b[0], Decimal)}
        degree = max(k for k, c in powers.items() if c)
        return cls(tuple(powers.get(k, Fraction(0)) for k in range(degree + 1)), (Fraction(1),))

    def __call__(self, z: ArrayLike) -> Any:
        """The eigenvalue next to exp(z), or of oscillations that grow the larger one."""
        z = np.asarray(z, complex)
        half_trace = super().__call__(z)
        root = np.sqrt(half_trace**2 - 1)
        both = np.stack([half_trace + root, half_trace - root])
        grows = (np.abs(z.real) <= IMAGINARY * np.abs(z)) & (np.abs(half_trace.real) > 1)
        preference = np.where(grows, -np.abs(both), np.abs(both - np.exp(z)))
        return np.take_along_axis(both, preference.argmin(axis=0)[np.newaxis], axis=0)[0]

    @property
    def real_stability_interval(self) -> float:
        """0: with λ, -λ is an eigenvalue of the equation, whose solutions do not decay."""
        return 0.0

    @cached_property
    def imaginary_stability_interval(self) -> float:
        """The largest y with |R| ≤ 1 on [-iy, iy]."""
        half_trace = _reflected(self.numerator[::2])  # at z = iy, in y²
        return sqrt(nonnegative_interval(polysub([Fraction(1)], polymul(half_trace, half_trace))))


def _fraction(number: Fraction | Surd | Decimal) -> Fraction:
    if isinstance(number, Surd):
        assert number.b == 0  # conjugate stages: R has rational coefficients
        return number.a
    if isinstance(number, Decimal):
        simple = Fraction(number).limit_denominator(LARGEST_DENOMINATOR)
        if abs(simple - Fraction(number)) < CLOSE:
            return simple
        # rounded at its publication: only 30 digits are significant
        return Fraction(round(Fraction(number) * 10**30), 10**30)
    return Fraction(number)


def _reflected(p: Iterable[Fraction]) -> Polynomial:
    return tuple(c if k % 2 == 0 else -c for k, c in enumerate(p))


def _square_on_imaginary_axis(p: Polynomial) -> Polynomial:
    """|p(iy)|² = p(z) p(-z) at z = iy, as a polynomial in y²."""
    return _reflected(polymul(p, _reflected(p))[::2])  # only even powers, and z² = -y²
