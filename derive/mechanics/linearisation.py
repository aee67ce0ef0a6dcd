"""Small oscillations about an equilibrium."""

from dataclasses import dataclass
from typing import TypeAlias

import sympy as sp

from derive.formulas.sampling import is_small
from derive.mechanics.reduction import reduced
from derive.system.parts import SystemDefinitionError
from derive.system.symbols import TIME
from derive.system.system import System

Matrix: TypeAlias = sp.ImmutableDenseMatrix
INFINITE = (sp.zoo, sp.oo, sp.nan)


@dataclass(frozen=True)
class Linearisation:
    """M₀ ẍ + K x = 0 for small displacements x = q - q₀ from an equilibrium q₀.

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


@dataclass(frozen=True)
class Energies:
    """The mass matrix, potential and momenta that determine small oscillations."""

    system: System
    mass_matrix: Matrix  # M(q, t)
    potential: sp.Expr  # the effective one, U(q, t)
    drift: Matrix  # momenta b at q̇ = 0, a column

    def linearised(self, equilibrium: tuple[sp.Expr, ...]) -> Linearisation:
        """M₀ and K at `equilibrium`; an error if it is none, or if these are not sufficient."""
        self._refuse(self._other_terms())
        values = self.check_equilibrium(equilibrium)
        gradient = [self.potential.diff(q) for q in self.system.q]
        stiffness = Matrix([[force.diff(q) for q in self.system.q] for force in gradient])
        matrices = self.mass_matrix.xreplace(values), stiffness.xreplace(values)
        self._refuse({"have infinite terms": any(matrix.has(*INFINITE) for matrix in matrices)})
        return Linearisation(equilibrium, *matrices)

    def _refuse(self, problems: dict[str, bool]) -> None:
        for problem, exists in problems.items():
            if exists:
                raise SystemDefinitionError(
                    f"small motions of {self.system.name!r} {problem}: a mass and a stiffness "
                    "matrix do not describe them; use eigenvalues of the generated jacobian"
                )

    def check_equilibrium(self, equilibrium: tuple[sp.Expr, ...]) -> dict[sp.Symbol, sp.Expr]:
        """`equilibrium` by coordinate; an error if a force is not 0 there."""
        system = self.system
        if len(equilibrium) != len(system.q):
            raise SystemDefinitionError(
                f"an equilibrium of {system.name!r} has {len(system.q)} coordinates "
                f"({', '.join(q.name for q in system.q)}), got {len(equilibrium)}"
            )
        values = dict(zip(system.q, equilibrium, strict=True))
        still = dict.fromkeys(system.qdot, sp.S.Zero)
        for i, q in enumerate(system.q):
            gradient = self.potential.diff(q) + self.drift[i].diff(TIME)
            everywhere = system.applied[i].xreplace(still) - gradient
            force, reason = everywhere.xreplace(values), ""
            if force.has(*INFINITE):
                reason = f"the force along {q.name} is not finite there"
            elif q.is_positive and values[q].is_nonpositive:
                reason = f"{q.name} is positive"
            elif not is_small(force):
                force = sp.factor_terms(reduced(force))
                reason = f"the force along {q.name} is {force} there"
                if all(is_small(everywhere.diff(other)) for other in system.q):
                    raise SystemDefinitionError(
                        f"{system.name!r} has no equilibrium: the force along {q.name} is {force} "
                        "for all coordinates"
                    )
            if reason:
                raise SystemDefinitionError(
                    f"{system.name!r} has no equilibrium at {q.name} = {values[q]}: {reason}; give "
                    "equilibrium= coordinates where all forces are 0"
                )
        return values

    def _other_terms(self) -> dict[str, bool]:
        """Terms of small motions beside those of masses and springs, and whether they exist."""
        rotation = self.drift.jacobian(self.system.q)
        parts = (self.mass_matrix, self.potential, self.drift)
        return {
            "depend on time": any(part.has(TIME) for part in parts),
            "have applied forces": any(self.system.applied),
            "have gyroscopic forces": not (rotation - rotation.T).is_zero_matrix,
        }
