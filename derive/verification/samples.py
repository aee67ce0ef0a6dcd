"""Values of formulas at many random states, in ordinary precision, for searches."""

import math
from collections.abc import Callable, Sequence
from random import Random
from typing import TypeAlias

import sympy as sp

from derive.mechanics.derivation import Derivation
from derive.system.symbols import TIME
from derive.system.system import System
from derive.verification.model import Model

#: Numbers at all states; NaN where there is no real number.
Numbers: TypeAlias = list[float]

FUNCTIONS: dict[str, Callable[[float], float]] = {
    name: getattr(math, name) for name in ("sin", "cos", "tan", "exp", "log", "sqrt")
} | {"Abs": abs}


class Samples:
    """Random states of a system, and the values of expressions there."""

    def __init__(self, model: Model, count: int, *, along_motions: bool) -> None:
        random, self.count, derivation = Random(0), count, model.derivation
        self._known: dict[sp.Expr, Numbers] = {}
        for symbol in _symbols(derivation.system):
            positive = symbol.is_positive or symbol in derivation.system.params or symbol == TIME
            signs = (1,) if positive else (1, -1)
            lowest = 0.5 if positive else 0.2
            self._known[symbol] = [
                random.choice(signs) * random.uniform(lowest, 1.5) for _ in range(count)
            ]
        if along_motions:
            self._solve(derivation)
        self._known |= {p: self(value) for p, value in model.momenta.items()}

    def __call__(self, expression: sp.Expr) -> Numbers:
        """The values of `expression`."""
        if expression not in self._known:
            self._known[expression] = self._value(expression)
        return self._known[expression]

    def _value(self, expression: sp.Expr) -> Numbers:
        if expression.is_number:
            return [_number(expression)] * self.count
        parts = [self(part) for part in expression.args]
        if expression.is_Add:
            return [sum(terms) for terms in zip(*parts, strict=True)]
        if expression.is_Mul:
            return [math.prod(factors) for factors in zip(*parts, strict=True)]
        if expression.is_Pow:
            return [power(*pair) for pair in zip(*parts, strict=True)]
        if expression.func.__name__ in FUNCTIONS:
            return applied(expression.func.__name__, parts[0])
        raise NotImplementedError(f"no numbers for {expression.func}")

    def _solve(self, derivation: Derivation) -> None:
        """Set accelerations to those of the motion."""
        qddot, M, f = derivation.system.qddot, derivation.mass_matrix, derivation.forcing
        n = range(len(qddot))
        entries = [[self(M[i, j]) for j in n] + [self(f[i])] for i in n]
        states = [[[one[k] for one in row] for row in entries] for k in range(self.count)]
        for symbol, values in zip(qddot, zip(*map(_solved, states), strict=True), strict=True):
            self._known[symbol] = [*values]


def _number(expression: sp.Expr) -> float:
    try:
        return float(expression)
    except (TypeError, OverflowError):  # complex, or very large
        return math.nan


def power(base: float, exponent: float) -> float:
    """The real power, or NaN."""
    try:
        return math.pow(base, exponent)
    except (ValueError, OverflowError):
        return math.nan


def quotient(a: float, b: float) -> float:
    """The quotient, or NaN."""
    return a / b if b else math.nan


def applied(name: str, values: Numbers) -> Numbers:
    """The values of a function, or NaN."""

    def value(x: float) -> float:
        try:
            return FUNCTIONS[name](x)
        except (ValueError, OverflowError):
            return math.nan

    return [*map(value, values)]


def _symbols(system: System) -> Sequence[sp.Symbol]:
    return (*system.params, *system.q, *system.qdot, *system.qddot, TIME)


def _solved(rows: list[list[float]]) -> list[float]:
    """Solve M x = f, with the rows of M and f side by side; M is positive definite."""
    n = len(rows)
    for i in range(n):
        for j in range(i + 1, n):
            factor = rows[j][i] / rows[i][i]
            rows[j] = [a - factor * b for a, b in zip(rows[j], rows[i], strict=True)]
    solution = [0.0] * n
    for i in reversed(range(n)):
        known = math.fsum(rows[i][j] * solution[j] for j in range(i + 1, n))
        solution[i] = (rows[i][n] - known) / rows[i][i]
    return solution
