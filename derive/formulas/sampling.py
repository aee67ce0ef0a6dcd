"""Generic values of symbols, at which nothing vanishes by accident.

A symbol that may be negative is so at six of the last eleven states, which are different for
different symbols. Hence every two symbols have all four pairs of signs (D. J. Kleitman,
J. Spencer, Discrete Math. 6 (1973) 255).
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import cache
from itertools import combinations
from random import Random

import sympy as sp

from derive.formulas.numeric import Approximation, Evaluator, NoValueError

#: The number of states at which formulas are compared.
STATES = 12


def sample(symbols: Sequence[sp.Symbol], index: int) -> dict[sp.Symbol, sp.Expr]:
    """Values with sizes from 1 to 3 and the signs that assumptions allow; `index` < `STATES`."""
    values = {}
    for k, symbol in enumerate(symbols):
        size = 1 + sp.Rational(int(Random(f"{k} {index}").random() * 2000) + 1, 1000)
        values[symbol] = size * _sign(symbol, k, index)
    return values


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
