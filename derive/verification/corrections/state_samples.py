"""Values of formulas at many random states, in ordinary precision, for searches."""

import math
from collections.abc import Callable, Sequence
from random import Random
from typing import TypeAlias

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from sympy.core.relational import Relational

from derive.formulas import functions
from derive.mechanics.derivation import Derivation
from derive.system.symbols import TIME
from derive.system.system import System
from derive.verification.judging.constrained_motions import equations
from derive.verification.judging.reference_system import ReferenceSystem

#: Numbers at all states; NaN where there is no real number.
Numbers: TypeAlias = list[float]

#: Steps of Newton's method onto constraints, and the largest residual after them.
NEWTON, CLOSED = 12, 1e-9

#: By their names in formulas and in SymPy.
FUNCTIONS: dict[str, Callable[..., float]] = {
    **{name: getattr(math, name) for name in functions.FUNCTIONS if hasattr(math, name)},
    **dict.fromkeys(("abs", "Abs"), abs),
    **dict.fromkeys(("min", "Min"), min),
    **dict.fromkeys(("max", "Max"), max),
    "sign": lambda x: (x > 0) - (x < 0),
    "Heaviside": lambda x, at_zero: 1.0 if x > 0 else 0.0 if x < 0 else at_zero,
    "DiracDelta": lambda x: 0.0,
}


class StateSamples:
    """Random states of a system, and the values of expressions there."""

    def __init__(self, model: ReferenceSystem, count: int, *, along_motions: bool) -> None:
        random, self.count, derivation = Random(0), count, model.derivation
        self._known: dict[sp.Expr, Numbers] = {}
        for symbol in _symbols(derivation.system):
            positive = symbol.is_positive or symbol in derivation.system.params or symbol == TIME
            signs = (1,) if positive else (1, -1)
            lowest = 0.5 if positive else 0.2
            self._known[symbol] = [
                random.choice(signs) * random.uniform(lowest, 1.5) for _ in range(count)
            ]
        self._independent = tuple(self._known)
        if along_motions and derivation.system.conditions:
            self._move(derivation)
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
        if isinstance(expression, sp.Piecewise):
            return self._choice(expression)
        parts = [self(part) for part in expression.args]
        if expression.is_Add:
            return [sum(terms) for terms in zip(*parts, strict=True)]
        if expression.is_Mul:
            return [math.prod(factors) for factors in zip(*parts, strict=True)]
        if expression.is_Pow:
            return [power(*pair) for pair in zip(*parts, strict=True)]
        if expression.func.__name__ in FUNCTIONS:
            return applied(expression.func.__name__, *parts)
        raise NotImplementedError(f"no numbers for {expression.func}")

    def _choice(self, expression: sp.Piecewise) -> Numbers:
        """The values of the first pieces whose conditions hold."""
        result = [math.nan] * self.count
        for value, condition in reversed(expression.args):
            holds = [condition == sp.true] * self.count
            if isinstance(condition, Relational):
                differences = self(condition.lhs - condition.rhs)
                holds = [bool(condition.func(x, 0)) for x in differences]
            pairs = zip(holds, self(value), result, strict=True)
            result = [a if chosen else b for chosen, a, b in pairs]
        return result

    def _move(self, derivation: Derivation) -> None:
        """Move states onto constraints."""
        system, phi = derivation.system, sp.Matrix(derivation.holonomic)
        for _ in range(NEWTON if derivation.holonomic else 0):
            self._shift(system.q, phi.jacobian(system.q), phi)
        self._keep(self._closed(phi, [q for q in system.q if q.is_positive]))
        self._shift(system.qdot, derivation.constraint_jacobian, derivation.constraint_rates)

    def _closed(self, phi: sp.MatrixBase, positive: Sequence[sp.Symbol]) -> list[int]:
        """The states on constraints, with positive coordinates."""
        residuals, coordinates = [*map(self, phi)], [*map(self, positive)]
        return [
            k
            for k in range(self.count)
            if all(abs(one[k]) < CLOSED for one in residuals)
            and all(one[k] > 0 for one in coordinates)
        ]

    def _keep(self, indices: Sequence[int]) -> None:
        """Repeat some states in place of all."""
        if not indices:
            raise NotImplementedError("no state satisfies the constraints")
        chosen = [indices[k % len(indices)] for k in range(self.count)]
        self._known = {s: [self._known[s][k] for k in chosen] for s in self._independent}

    def _shift(
        self, symbols: Sequence[sp.Symbol], gradients: sp.MatrixBase, residuals: sp.MatrixBase
    ) -> None:
        """Change symbols as little as removes linear residuals."""
        J, right = self._at(gradients, residuals)
        across = J.transpose(0, 2, 1)
        changes = (across @ _solutions(J @ across, right)[..., np.newaxis])[..., 0]
        moved = dict(self._known)
        for symbol, change in zip(symbols, changes.T.tolist(), strict=True):
            pairs = zip(self._known[symbol], change, strict=True)
            moved[symbol] = [value - x for value, x in pairs]
        self._known = {symbol: moved[symbol] for symbol in self._independent}

    def _solve(self, derivation: Derivation) -> None:
        """Set accelerations and multipliers to those of the motion."""
        system, M, f = derivation.system, derivation.mass_matrix, derivation.forcing
        if system.conditions:
            M = equations(derivation)
            f = sp.Matrix([*f, *derivation.constraint_forcing])
        solutions = _solutions(*self._at(M, f)).T.tolist()
        self._known |= zip((*system.qddot, *system.multipliers), solutions, strict=True)

    def _at(
        self, matrix: sp.MatrixBase, column: sp.MatrixBase
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """A matrix and a column at all states."""
        entries = np.array([*map(self, matrix.flat()), *map(self, column)]).T
        size = matrix.rows * matrix.cols
        shape = self.count, matrix.rows, matrix.cols
        return entries[:, :size].reshape(shape), entries[:, size:]


def samples(model: ReferenceSystem, count: int, *, along_motions: bool) -> StateSamples:
    """The random states of a model, once for all formulas that are judged with it."""
    key = "samples", count, along_motions
    return model.once(key, lambda: StateSamples(model, count, along_motions=along_motions))


def _solutions(matrices: NDArray[np.float64], right: NDArray[np.float64]) -> NDArray[np.float64]:
    """The solutions of linear equations; NaN where they are singular."""
    try:
        return np.asarray(np.linalg.solve(matrices, right[..., np.newaxis])[..., 0])
    except np.linalg.LinAlgError:
        if len(matrices) == 1:
            return np.full_like(right, np.nan)
    parts = zip(matrices[:, np.newaxis], right[:, np.newaxis], strict=True)
    return np.concatenate([_solutions(*part) for part in parts])


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


def applied(name: str, *arguments: Numbers) -> Numbers:
    """The values of a function, or NaN."""

    def value(*numbers: float) -> float:
        try:
            return FUNCTIONS[name](*numbers)
        except (ValueError, OverflowError):
            return math.nan

    return [*map(value, *arguments)]


def _symbols(system: System) -> Sequence[sp.Symbol]:
    return (
        *system.params, *system.q, *system.qdot, *system.qddot, TIME, *system.multipliers
    )  # fmt: skip
