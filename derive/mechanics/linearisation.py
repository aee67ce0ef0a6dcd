"""Small motions about an equilibrium."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import sympy as sp

from derive.system.parts import SystemDefinitionError
from derive.system.symbols import TIME
from derive.system.system import System

Matrix: TypeAlias = sp.ImmutableDenseMatrix


@dataclass(frozen=True)
class Linearisation:
    """M₀ ẍ + K x = 0 for small displacements x = q - q₀ about an equilibrium q₀.

    Attributes
    ----------
    equilibrium : tuple of sympy.Expr
        q₀.
    mass_matrix, stiffness_matrix : sympy.Matrix
        M₀ = M(q₀) and K = ∂²U/∂q² at q₀, n × n.

    Examples
    --------
    >>> from derive import Derivation, load
    >>> pendulum = Derivation(load("single_pendulum")).linearisation()
    >>> pendulum.stiffness_matrix
    Matrix([[g*l*m]])
    """

    equilibrium: tuple[sp.Expr, ...]
    mass_matrix: Matrix
    stiffness_matrix: Matrix


def linearised(
    system: System, mass_matrix: Matrix, potential: sp.Expr, drift: Matrix,
    equilibrium: tuple[sp.Expr, ...],
) -> Linearisation:  # fmt: skip
    """Mass and stiffness matrix at `equilibrium`.

    Parameters
    ----------
    system : System
        With n coordinates.
    mass_matrix : sympy.Matrix
        M(q, t), n × n.
    potential : sympy.Expr
        The effective potential U(q, t).
    drift : sympy.Matrix
        Momenta b that are there though q̇ is 0, a column.
    equilibrium : tuple of sympy.Expr
        The place q₀, in the order of ``system.q``.

    Returns
    -------
    Linearisation
        With M₀ and K, n × n.

    Raises
    ------
    SystemDefinitionError
        When a force is left there, or the number of coordinates is wrong; when small motions
        are more than masses and springs.
    """
    at_rest = resting(system, potential, drift, equilibrium)
    for what, holds in beyond_springs(system, mass_matrix, potential, drift).items():
        if holds:
            raise SystemDefinitionError(
                f"small motions of {system.name!r} {what}: they are more than masses and springs; "
                "take eigenvalues of the generated jacobian instead"
            )
    gradient = [potential.diff(q) for q in system.q]
    stiffness = Matrix([[slope.diff(q) for q in system.q] for slope in gradient])
    return Linearisation(equilibrium, mass_matrix.subs(at_rest), stiffness.subs(at_rest))


def resting(
    system: System, potential: sp.Expr, drift: Matrix, equilibrium: tuple[sp.Expr, ...]
) -> dict[sp.Symbol, sp.Expr]:
    """Coordinates by symbol, after seeing that what is there stays there.

    Parameters
    ----------
    system : System
        With n coordinates.
    potential : sympy.Expr
        The effective potential U(q, t).
    drift : sympy.Matrix
        Momenta b that are there though q̇ is 0, a column.
    equilibrium : tuple of sympy.Expr
        The place, in the order of ``system.q``.

    Returns
    -------
    dict of sympy.Symbol to sympy.Expr
        What to substitute for each coordinate.

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
    still = dict.fromkeys(system.qdot, 0)
    for i, q in enumerate(system.q):
        slope = potential.diff(q) + drift[i].diff(TIME)
        force = sp.simplify((system.applied[i].subs(still) - slope).subs(at_rest))
        if force != 0:
            raise SystemDefinitionError(
                f"{system.name!r} is not at rest at {q.name} = {at_rest[q]}: the force "
                f"along {q.name} is {force} there; give equilibrium= coordinates where it is 0"
            )
    return at_rest


def beyond_springs(
    system: System, mass_matrix: Matrix, potential: sp.Expr, drift: Matrix
) -> dict[str, bool]:
    """What small motions may have beside masses and springs, and whether they have it."""
    turning = drift.jacobian(system.q)
    return {
        "depend on time": any(part.has(TIME) for part in (mass_matrix, potential, drift)),
        "have applied forces": any(system.applied),
        "are turned by a moving frame": not (turning - turning.T).is_zero_matrix,
    }
