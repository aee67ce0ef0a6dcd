"""Motions of systems with constraints: states that satisfy these, accelerations and multipliers."""

from collections.abc import Iterator
from contextlib import suppress

import sympy as sp

from derive.formulas.numeric import Approximation, Evaluator, mp, solved
from derive.formulas.syntax import ExpressionError
from derive.mechanics.derivation import Derivation
from derive.verification.judging.engine import State

#: Steps of Newton's method from each of several states, and the residual before the last one.
MOST_STEPS, MOST_STATES, TINY = 60, 20, mp.mpf("1e-60")
#: Largest change in a step of a symbol's magnitude plus 1, and its change from state to state.
LONGEST, SHIFT = mp.mpf("0.5"), sp.Rational(7, 5)
#: Least value of a coordinate that is declared positive.
SMALLEST = sp.Rational(1, 100)


def motion(derivation: Derivation, state: State) -> State:
    """The state near `state` on the constraints, with its accelerations and multipliers.

    An `ExpressionError` reports constraints without a solution nearby.
    """
    candidates = _closed(derivation, state) if derivation.holonomic else iter([dict(state)])
    for values in candidates:
        with suppress(ArithmeticError):  # constraints depend on each other there, or have no value
            return _moving(derivation, values)
    raise ExpressionError("no generic state satisfies the constraints")


def _moving(derivation: Derivation, values: dict[sp.Symbol, sp.Expr]) -> State:
    """A state on the constraints of coordinates with velocities, accelerations and multipliers."""
    system = derivation.system
    G, drift = derivation.constraint_jacobian, derivation.constraint_rates
    _move(values, system.qdot, G, drift, Evaluator(values))
    unknown = (*system.qddot, *system.multipliers)
    right = sp.Matrix([*derivation.forcing, *derivation.constraint_forcing])
    evaluator = Evaluator({s: value for s, value in values.items() if s not in unknown})
    values |= dict(zip(unknown, solved(equations(derivation), right, evaluator), strict=True))
    momenta = zip(system.p, derivation.momenta, strict=True)
    return values | {p: evaluator(value).rounded() for p, value in momenta}


def _closed(derivation: Derivation, state: State) -> Iterator[dict[sp.Symbol, sp.Expr]]:
    """States that satisfy the constraints of coordinates, generic ones first."""
    q, phi = derivation.system.q, sp.Matrix(derivation.holonomic)
    gradients, others = phi.jacobian(q), list[dict[sp.Symbol, sp.Expr]]()
    for attempt in range(MOST_STATES):
        # Newton's method may end at a local minimum of the residuals
        values = dict(state) | {s: state[s] + SHIFT * attempt * k for k, s in enumerate(q)}
        largest = mp.inf
        with suppress(ArithmeticError):
            for _ in range(MOST_STEPS):
                evaluator = Evaluator(values)
                largest = max(abs(evaluator(entry).number) for entry in phi)
                _move(values, q, gradients, phi, evaluator, LONGEST)
                if largest < TINY:
                    break
        if largest < TINY:
            if _is_generic(values, q):
                yield values
            else:
                others.append(values)
    yield from others  # generic parameters may allow no others


def _is_generic(values: State, coordinates: tuple[sp.Symbol, ...]) -> bool:
    """Whether positive coordinates are: they vanish where mechanisms are folded."""
    return all(values[q] > SMALLEST for q in coordinates if q.is_positive)


def equations(derivation: Derivation) -> sp.Matrix:
    """The coefficients of accelerations and multipliers in M q̈ - Gᵀ λ = f and G q̈ = γ."""
    M, G = sp.Matrix(derivation.mass_matrix), sp.Matrix(derivation.constraint_jacobian)
    return M.row_join(-G.T).col_join(G.row_join(sp.zeros(G.rows)))


def _move(
    values: dict[sp.Symbol, sp.Expr],
    symbols: tuple[sp.Symbol, ...],
    gradients: sp.MatrixBase,
    residuals: sp.MatrixBase,
    evaluator: Evaluator,
    longest: mp.mpf = mp.inf,
) -> None:
    """Change symbols as little as removes linear residuals, or by a part of that."""
    J = _numbers(evaluator, gradients)
    change = J.T * mp.lu_solve(J * J.T, _numbers(evaluator, residuals))
    before = [evaluator(symbol).number for symbol in symbols]
    parts = (abs(x) / (1 + abs(b)) for x, b in zip(change, before, strict=True))
    factor = min(1, longest / max(TINY, *parts))
    for symbol, b, x in zip(symbols, before, change, strict=True):
        values[symbol] = Approximation(b - factor * x).rounded()


def _numbers(evaluator: Evaluator, matrix: sp.MatrixBase) -> mp.matrix:
    return mp.matrix([[evaluator(entry).number for entry in row] for row in matrix.tolist()])
