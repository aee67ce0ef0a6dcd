"""Whether every coordinate moves a mass in a way of its own."""

from __future__ import annotations

import sympy as sp

from derive.system.parts import SystemDefinitionError
from derive.system.symbols import TIME
from derive.system.system import System

#: A pivot smaller than this part of its diagonal entry, at 50 digits, is zero.
TINY = sp.Float("1e-30")


def check_independence(system: System, mass_matrix: sp.ImmutableDenseMatrix) -> None:
    """Eliminate the mass matrix at a generic place: a pivot of zero names its coordinate.

    Parameters
    ----------
    system : System
        Whose coordinates are judged.
    mass_matrix : sympy.Matrix
        M(q, t), n × n.

    Raises
    ------
    SystemDefinitionError
        When a coordinate moves no mass, or moves the masses only as others do, or has no
        inertia that is a positive number.
    """
    rows = _at_a_place(system, mass_matrix)
    diagonal = [row[k] for k, row in enumerate(rows)]
    for k, q in enumerate(system.q):
        if not rows[k][k] > diagonal[k] * TINY:
            why = (
                "moves no mass"
                if mass_matrix[k, k] == 0
                else f"moves the masses only as {', '.join(s.name for s in system.q[:k])} can"
                if k
                else "has no inertia that is a positive number"
            )
            raise SystemDefinitionError(
                f"coordinate {q.name!r} of system {system.name!r} {why}: leave it out, or let "
                "a position depend on it"
            )
        for i in range(k + 1, len(rows)):
            ratio = rows[i][k] / rows[k][k]
            rows[i] = [a - ratio * b for a, b in zip(rows[i], rows[k], strict=True)]


def _at_a_place(system: System, mass_matrix: sp.ImmutableDenseMatrix) -> list[list[sp.Expr]]:
    """The mass matrix in numbers, at the first of some places where they are real."""
    symbols = (*system.params, *system.q, TIME)
    place = {s: sp.Rational(7 * k + 3, 5 * k + 4) for k, s in enumerate(symbols)}
    # what hangs on a thread stays within its reach, what rolls on a wheel keeps away from its axis
    for size in (sp.Rational(1, 8), sp.Integer(5), sp.Integer(1)):
        there = place | {q: place[q] * size for q in system.q}
        n = mass_matrix.rows
        upper = {
            (i, j): mass_matrix[i, j].evalf(50, subs=there) for i in range(n) for j in range(i, n)
        }
        rows = [[upper[min(i, j), max(i, j)] for j in range(n)] for i in range(n)]
        if all(entry.is_real for row in rows for entry in row):
            break
    return rows
