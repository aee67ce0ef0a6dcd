"""The stability function R: a step of y' = λy multiplies y by R(hλ). Its coefficients are exact.

Of splittings, which integrate q'' = λ²q instead, a step multiplies a mode by R(hλ).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from math import factorial, gcd, inf, lcm, sqrt
from typing import Any, TypeAlias

import numpy as np
from numpy.polynomial.polynomial import polymul, polysub, polytrim
from numpy.typing import ArrayLike, NDArray

from solvers.runge_kutta.surd import Surd
from solvers.runge_kutta.tableau import Splitting, Tableau

#: Coefficients of x⁰, x¹, …, all of them Fractions, with which NumPy computes exactly.
ExactPolynomial: TypeAlias = Sequence[Fraction] | NDArray[np.object_]

#: Relative accuracy of a root.
RESOLUTION = Fraction(1, 10**17)


def nonnegative_interval(polynomial: ExactPolynomial) -> float:
    """The largest x such that `polynomial` ≥ 0 on [0, x], to `RESOLUTION`; or infinity.

    Sturm's theorem separates the roots, so that a double root is not taken for a change of sign
    (D. E. Knuth, The Art of Computer Programming, volume 2, exercise 4.6.2-22).
    """
    p = list(polytrim(polynomial))
    while p and p[0] == 0:  # a factor x has no sign for x > 0
        del p[0]
    if not p:
        return inf
    if p[0] < 0:
        return 0.0
    whole = _whole(p)
    chain = _sturm_chain(whole)
    # above Cauchy's bound of all roots; its binary fractions have few digits
    bound = Fraction(2 ** (1 + max(map(abs, whole)) // abs(whole[-1])).bit_length())

    def sign_change(a: Fraction, b: Fraction) -> Fraction | None:
        """The first change to negative values in (a, b], whose ends are no roots."""
        count = _variations(chain, a) - _variations(chain, b)
        if count == 0 or (count == 1 and _sign(whole, b) > 0):
            return None
        if count == 1:
            return _root(whole, a, b)
        middle = (a + b) / 2
        while _sign(whole, middle) == 0:
            middle = (a + middle) / 2
        left = sign_change(a, middle)
        return sign_change(middle, b) if left is None else left

    root = sign_change(Fraction(0), bound)
    return inf if root is None else float(root)


def _root(p: Sequence[int], above: Fraction, below: Fraction) -> Fraction:
    """The root between `above`, where `p` is positive, and `below`, where it is negative."""
    while below - above > RESOLUTION * below:
        middle = (above + below) / 2
        above, below = (middle, below) if _sign(p, middle) > 0 else (above, middle)
    return above


def _sturm_chain(p: list[int]) -> list[list[int]]:
    """The polynomial, its derivative, and their negative remainders, by whole numbers alone."""
    chain = [p]
    following = [k * c for k, c in enumerate(p)][1:]
    while following:
        chain.append(following)
        following = [-c for c in _remainder(chain[-2], chain[-1])]
    return chain


def _remainder(p: Sequence[int], q: Sequence[int]) -> list[int]:
    """A positive multiple of the remainder of p / q, without a common factor."""
    rest, size, sign = list(p), abs(q[-1]), 1 if q[-1] > 0 else -1
    while len(rest) >= len(q):
        factor, shift = sign * rest[-1], len(rest) - len(q)
        rest = [size * c for c in rest]
        for k, c in enumerate(q, shift):
            rest[k] -= factor * c
        while rest and rest[-1] == 0:
            rest.pop()
    common = gcd(*rest)
    return [c // common for c in rest]


def _whole(p: ExactPolynomial) -> list[int]:
    """A positive multiple with whole coefficients, which are computed with faster."""
    denominator = lcm(*(c.denominator for c in p))
    return [int(c * denominator) for c in p]


def _sign(p: Sequence[int], x: Fraction) -> int:
    """The sign of p(x): that of p(x) times a power of the denominator of x."""
    total, power = 0, 1
    for c in reversed(p):
        total, power = total * x.numerator + c * power, power * x.denominator
    return (total > 0) - (total < 0)


def _variations(chain: Sequence[Sequence[int]], x: Fraction) -> int:
    """Changes of sign along the chain's values at x."""
    signs = [sign for sign in (_sign(p, x) for p in chain) if sign]
    return sum(a != b for a, b in pairwise(signs))


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
