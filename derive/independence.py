"""Whether every coordinate moves a mass in a way of its own."""

from __future__ import annotations

import sympy as sp

from derive.parts import SystemDefinitionError
from derive.symbols import TIME
from derive.system import System

#: A pivot smaller than this part of its diagonal entry, at 50 digits, is zero.
TINY = sp.Float("1e-30")


def check_independence(system: System, mass_matrix: sp.ImmutableDenseMatrix) -> None:
    """Eliminate the mass matrix at a generic place: a pivot of zero names its coordinate.

    Raises
    ------
    SystemDefinitionError
        When a coordinate moves no mass, or moves the masses only as others do.
    """
    symbols = (*system.params, *system.q, TIME)
    place = {s: sp.Rational(7 * k + 3, 5 * k + 4) for k, s in enumerate(symbols)}
    # coordinates are small beside lengths: what hangs on a thread stays within its reach
    place |= {q: place[q] / 8 for q in system.q}
    rows = [list(row) for row in mass_matrix.evalf(50, subs=place).tolist()]
    for k, q in enumerate(system.q):
        if not rows[k][k] > mass_matrix[k, k].evalf(50, subs=place) * TINY:
            why = (
                "moves no mass"
                if mass_matrix[k, k] == 0
                else f"moves the masses only as {', '.join(s.name for s in system.q[:k])} can"
            )
            raise SystemDefinitionError(
                f"coordinate {q.name!r} of system {system.name!r} {why}: leave it out, or let "
                "a position depend on it"
            )
        for i in range(k + 1, len(rows)):
            ratio = rows[i][k] / rows[k][k]
            rows[i] = [a - ratio * b for a, b in zip(rows[i], rows[k], strict=True)]
