"""The first interval on which a polynomial is not negative, by exact arithmetic."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from math import inf

Polynomial = Sequence[Fraction]  # coefficients of x⁰, x¹, …

#: Relative accuracy of a root.
RESOLUTION = Fraction(1, 10**17)


def nonnegative_interval(polynomial: Polynomial) -> float:
    """The largest x such that `polynomial` ≥ 0 on [0, x], to `RESOLUTION`; or infinity.

    Sturm's theorem separates the roots, so that a double root is not taken for a change of sign
    (D. E. Knuth, The Art of Computer Programming, volume 2, exercise 4.6.2-22).
    """
    p = list(polynomial)
    while p and p[-1] == 0:
        p.pop()
    while p and p[0] == 0:  # a factor x has no sign for x > 0
        del p[0]
    if not p:
        return inf
    if p[0] < 0:
        return 0.0
    chain = _sturm_chain(p)
    bound = 1 + max(abs(c) for c in p) / abs(p[-1])  # Cauchy's bound of all roots

    def roots(a: Fraction, b: Fraction) -> int:
        return _variations(chain, a) - _variations(chain, b)

    def sign_change(a: Fraction, b: Fraction) -> Fraction | None:
        """The first change to negative values in (a, b], whose ends are no roots."""
        count = roots(a, b)
        if count == 0 or (count == 1 and _value(p, b) > 0):
            return None
        if count == 1:
            return _root(p, a, b)
        middle = (a + b) / 2
        while _value(p, middle) == 0:
            middle = (a + middle) / 2
        left = sign_change(a, middle)
        return sign_change(middle, b) if left is None else left

    root = sign_change(Fraction(0), bound)
    return inf if root is None else float(root)


def _root(p: Polynomial, above: Fraction, below: Fraction) -> Fraction:
    """The root between `above`, where `p` is positive, and `below`, where it is negative."""
    while below - above > RESOLUTION * below:
        middle = (above + below) / 2
        above, below = (middle, below) if _value(p, middle) > 0 else (above, middle)
    return above


def _sturm_chain(p: Polynomial) -> list[list[Fraction]]:
    chain = [list(p), [k * c for k, c in enumerate(p)][1:]]
    while any(chain[-1]):
        remainder = _remainder(chain[-2], chain[-1])
        chain.append([-c / max(map(abs, remainder)) for c in remainder])
        if not chain[-1]:
            break
    return [part for part in chain if part]


def _remainder(p: Polynomial, q: Polynomial) -> list[Fraction]:
    rest = list(p)
    while len(rest) >= len(q):
        ratio, shift = rest[-1] / q[-1], len(rest) - len(q)
        for k, c in enumerate(q):
            rest[k + shift] -= ratio * c
        rest.pop()
    while rest and rest[-1] == 0:
        rest.pop()
    return rest


def _variations(chain: Sequence[Polynomial], x: Fraction) -> int:
    """Changes of sign along the chain's values at x."""
    signs = [value > 0 for value in (_value(p, x) for p in chain) if value]
    return sum(a != b for a, b in pairwise(signs))


def _value(p: Polynomial, x: Fraction) -> Fraction:
    total = Fraction(0)
    for c in reversed(p):
        total = total * x + c
    return total
