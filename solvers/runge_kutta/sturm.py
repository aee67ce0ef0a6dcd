"""The first interval on which a polynomial is not negative, by exact arithmetic."""

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from math import gcd, inf, lcm
from typing import TypeAlias

import numpy as np
from numpy.polynomial.polynomial import polytrim
from numpy.typing import NDArray

#: Coefficients of x⁰, x¹, …, all of them Fractions, with which NumPy computes exactly.
Polynomial: TypeAlias = Sequence[Fraction] | NDArray[np.object_]

#: Relative accuracy of a root.
RESOLUTION = Fraction(1, 10**17)


def nonnegative_interval(polynomial: Polynomial) -> float:
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


def _whole(p: Polynomial) -> list[int]:
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
