"""Independence of the coordinates: each one moves a mass as no other does."""

import sympy as sp

from derive.formulas.numeric import Evaluator, NoValueError
from derive.system.parts import SystemDefinitionError
from derive.system.rigid_body import RigidBody
from derive.system.symbols import TIME
from derive.system.system import System

#: A pivot below this fraction of its diagonal entry, with 50 digits, is zero.
TINY = sp.Float("1e-30")
#: Values near defaults differ from them by about the inverse of this part.
NEAR = 10**6


def check_independence(system: System, mass_matrix: sp.ImmutableDenseMatrix) -> None:
    """Eliminate M(q, t) at a generic state; a zero pivot identifies a dependent coordinate.

    Parameters have values near their defaults, where bodies are admissible, or unrelated ones if
    M is not positive there.
    """
    faults = []
    for is_near in (True, False):
        rows = _generic_values(system, mass_matrix, is_near=is_near)
        if not (fault := _fault(system, mass_matrix, rows)):
            return
        faults.append(fault)
    raise SystemDefinitionError(faults[0])


def _fault(
    system: System, mass_matrix: sp.ImmutableDenseMatrix, rows: list[list[sp.Expr]]
) -> str | None:
    diagonal = [row[k] for k, row in enumerate(rows)]
    for k, q in enumerate(system.q):
        if not rows[k][k].is_real or not rows[k][k] > diagonal[k] * TINY:
            reason = "has no inertia that is a positive number"
            if mass_matrix[k, k] == 0:
                reason = "moves no mass"
            elif k:
                others = ", ".join(s.name for s in system.q[:k])
                reason = f"moves the masses only in ways in which {others} can move them"
            return (
                f"coordinate {q.name!r} of system {system.name!r} {reason}: {_way_out(system, q)}"
            )
        for i in range(k + 1, len(rows)):
            ratio = rows[i][k] / rows[k][k]
            rows[i] = [a - ratio * b for a, b in zip(rows[i], rows[k], strict=True)]
    return None


def is_singular(system: System, mass_matrix: sp.ImmutableDenseMatrix) -> bool:
    """Whether some motions of the coordinates move no mass."""
    try:
        check_independence(system, mass_matrix)
    except SystemDefinitionError:
        return True
    return False


def _way_out(system: System, q: sp.Symbol) -> str:
    for body in system.masses:
        if isinstance(body, RigidBody) and q in body.quaternion:
            parts = ", ".join(map(str, body.quaternion))
            return (
                f"rotations of body {body.mass} with {body.moments} move no mass; give positive "
                "principal moments, a constraint that prevents these rotations, or instead of the "
                f"quaternion {parts} only angles that move a mass, such as "
                "rotations('xy', (alpha, beta)) for a thin rod along z"
            )
    return "omit it, or let a position depend on it"


def _generic_values(
    system: System, mass_matrix: sp.ImmutableDenseMatrix, *, is_near: bool
) -> list[list[sp.Expr]]:
    """The mass matrix in numbers, at the first of several states where it is real."""
    symbols = (*system.params, *system.q, TIME)
    values = {s: sp.Rational(7 * k + 3, 5 * k + 4) for k, s in enumerate(symbols)}
    for one in system.parameters_and_inputs if is_near else ():
        if one.default:  # no relation of the defaults, such as equal lengths, holds between values
            values[one.symbol] = sp.Rational(one.default) * (1 + values[one.symbol] / NEAR)
    n = mass_matrix.rows
    # a thread limits coordinates from above; a wheel's axis limits them from below
    for size in (sp.Rational(1, 8), sp.Integer(5), sp.Integer(1)):
        state = values | {q: values[q] * size for q in system.q}
        pairs = [(i, j) for i in range(n) for j in range(i, n)]
        evaluator = Evaluator(state)
        upper = {(i, j): _value(evaluator, mass_matrix[i, j]) for i, j in pairs}
        if all(entry.is_real for entry in upper.values()):
            break
    return [[upper[min(i, j), max(i, j)] for j in range(n)] for i in range(n)]


def _value(evaluator: Evaluator, expression: sp.Expr) -> sp.Expr:
    try:
        return evaluator(expression).rounded()
    except NoValueError:
        return sp.nan
