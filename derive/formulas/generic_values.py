"""Generic values of symbols, at which nothing vanishes by accident.

A symbol that may be negative is so at six of the last eleven states, which are different for
different symbols. Hence every two symbols have all four pairs of signs (D. J. Kleitman,
J. Spencer, Discrete Math. 6 (1973) 255).
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cache, lru_cache
from itertools import combinations
from random import Random
from typing import Any

import sympy as sp

from derive.formulas.numeric import DIGITS, Approximation, Evaluator, NoValueError, mp

#: The number of states at which formulas are compared.
STATES = 12
#: Distances from zeros of numbers, where functions of these saturate and where they do not.
DISTANCES = tuple(sign * sp.Rational(1, 10) ** power for power in (2, 40) for sign in (1, -1))
#: The number of zeros near which there are states.
MOST_ZEROS = 4


def sample(symbols: Sequence[sp.Symbol], index: int) -> dict[sp.Symbol, sp.Expr]:
    """Values with sizes from 1 to 3 and the signs that assumptions allow; `index` < `STATES`."""
    return {symbol: _size(k, index) * _sign(symbol, k, index) for k, symbol in enumerate(symbols)}


@cache
def _size(number: int, index: int) -> sp.Expr:
    """A random size of a symbol at a state, which no symbol before it has there."""
    size = 1 + sp.Rational(int(Random(f"{number} {index}").random() * 2000) + 1, 1000)
    while any(size == _size(k, index) for k in range(number)):
        size += sp.Rational(1, 1000)
    return size


def near_zeros(
    number: sp.Expr, state: Mapping[sp.Symbol, sp.Expr], symbols: Iterable[sp.Symbol]
) -> Iterator[dict[sp.Symbol, sp.Expr]]:
    """Yield states on both sides of zeros of a number, far from them and close to them.

    The first of `symbols` of which it has zeros is changed. Of complex zeros, those of the real
    parts are taken.
    """
    for symbol in symbols:
        others = {s: value for s, value in state.items() if s != symbol}
        zeros = _zeros(number.xreplace(others), symbol) if symbol in number.free_symbols else []
        for zero in zeros:
            for distance in DISTANCES:
                value = zero + distance * (1 + abs(zero))
                if not ((symbol.is_nonnegative and value <= 0) or symbol.is_nonpositive):
                    yield {**state, symbol: value}
        if zeros:
            return


def _zeros(number: sp.Expr, symbol: sp.Symbol) -> list[sp.Expr]:
    """Real parts of zeros of a function of one symbol, to many digits; the smallest ones."""
    try:
        roots = sp.Poly(sp.numer(sp.together(number)), symbol).nroots(n=DIGITS, maxsteps=200)
        zeros = [sp.re(root) for root in roots]
    except (sp.PolynomialError, mp.NoConvergence):
        zeros = [*changes_of_sign(number, symbol)]
    return sorted(dict.fromkeys(zeros), key=abs)[:MOST_ZEROS]


def changes_of_sign(number: sp.Expr, symbol: sp.Symbol) -> Iterator[sp.Expr]:
    """Yield zeros of a function of one symbol, of those between which its sign changes."""

    def value(x: Any) -> Any:
        return Evaluator({symbol: Approximation(x).rounded()})(number).number.real

    sizes = [mp.mpf(2) ** k for k in range(-3, 11)]
    places = [*(-x for x in reversed(sizes)), mp.zero, *sizes]
    with suppress(NoValueError, NotImplementedError):
        values = [*map(value, places)]
        for a, b, before, after in zip(places, places[1:], values, values[1:], strict=False):
            if not before:
                yield Approximation(a).rounded()
            elif before * after < 0:
                with suppress(ValueError):  # no convergence, as at a jump
                    yield Approximation(mp.findroot(value, (a, b), solver="anderson")).rounded()


@lru_cache(maxsize=4096)  # documents repeat their divisors
def check_value(expression: sp.Expr) -> None:
    """Raise `NoValueError` if `expression` has no value at one of the states."""
    with suppress(NotImplementedError):
        for _ in _values(expression):
            pass


def is_small(expression: sp.Expr) -> bool:
    """Whether `expression` has a value at every state, and is zero as far as the digits show."""
    try:
        return all(value.is_zero for value in _values(expression))
    except (NoValueError, NotImplementedError):
        return False


def is_nonzero(expression: sp.Expr) -> bool:
    """Whether `expression` is not zero at a state, before which all states have values."""
    try:
        return not all(value.is_zero for value in _values(expression))
    except (NoValueError, NotImplementedError):
        return False


def _values(expression: sp.Expr) -> Iterator[Approximation]:
    symbols = sorted(expression.free_symbols, key=lambda symbol: str(symbol.name))
    for index in range(STATES):
        yield Evaluator(sample(symbols, index))(expression)


def _sign(symbol: sp.Symbol, k: int, index: int) -> int:
    if symbol.is_nonnegative or symbol.is_nonpositive:
        return 1 if symbol.is_nonnegative else -1
    words = _words()
    return -1 if index in words[k % len(words)] else 1


@cache
def _words() -> list[tuple[int, ...]]:
    return list(combinations(range(1, STATES), STATES // 2))
