"""Small motions about an equilibrium."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import sympy as sp

from derive.system import System, SystemDefinitionError

Matrix: TypeAlias = sp.ImmutableDenseMatrix


@dataclass(frozen=True)
class Linearisation:
    """M₀ ẍ + K x = 0 for small displacements x = q - q₀ about an equilibrium q₀.

    Attributes
    ----------
    equilibrium : tuple of sympy.Expr
        q₀.
    mass_matrix, stiffness_matrix : sympy.Matrix
        M₀ = M(q₀) and K = ∂²V/∂q² at q₀, n × n.
    """

    equilibrium: tuple[sp.Expr, ...]
    mass_matrix: Matrix
    stiffness_matrix: Matrix


def linearised(
    system: System, mass_matrix: Matrix, potential: sp.Expr, equilibrium: tuple[sp.Expr, ...]
) -> Linearisation:
    """Mass and stiffness matrix at `equilibrium`.

    Raises
    ------
    SystemDefinitionError
        When a force is left there, or the number of coordinates is wrong.
    """
    if len(equilibrium) != len(system.q):
        raise SystemDefinitionError(
            f"an equilibrium of {system.name!r} has {len(system.q)} coordinates "
            f"({', '.join(q.name for q in system.q)}), got {len(equilibrium)}"
        )
    at_rest = dict(zip(system.q, equilibrium, strict=True))
    gradient = [potential.diff(q) for q in system.q]
    for q, slope in zip(system.q, gradient, strict=True):
        force = sp.simplify(-slope.subs(at_rest))
        if force != 0:
            raise SystemDefinitionError(
                f"{system.name!r} is not at rest at {q.name} = {at_rest[q]}: the force "
                f"along {q.name} is {force} there; give equilibrium= coordinates where it is 0"
            )
    stiffness = Matrix([[slope.diff(q) for q in system.q] for slope in gradient])
    return Linearisation(equilibrium, mass_matrix.subs(at_rest), stiffness.subs(at_rest))
