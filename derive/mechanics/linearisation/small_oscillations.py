"""Small oscillations about an equilibrium."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

import sympy as sp

from derive.formulas.generic_values import is_small
from derive.mechanics.energies.kinetics import Matrix
from derive.mechanics.energies.reduction import reduced
from derive.mechanics.equations import Equations
from derive.mechanics.linearisation.point import FreeChanges, OperatingPoint, tidied
from derive.system.parts import SystemDefinitionError
from derive.system.symbols import TIME

Values: TypeAlias = Mapping[sp.Symbol, sp.Expr]
INFINITE = (sp.zoo, sp.oo, sp.nan)


@dataclass(frozen=True)
class Linearisation:
    """M₀ ẍ + K x = 0 for small displacements x from an equilibrium q₀: q = q₀ + Z x.

    Constraints φ determine some displacements by the others, which are x. The multipliers λ at q₀
    add -λ ∂²φ/∂q² to the stiffness (C. Lanczos, The Variational Principles of Mechanics, II.5).

    Attributes
    ----------
    equilibrium : tuple of sympy.Expr
        q₀.
    mass_matrix, stiffness_matrix : sympy.Matrix
        M₀ = Zᵀ M Z and K = Zᵀ ∂²(U - λ φ)/∂q² Z at q₀.
    states : tuple of str
        Names of the coordinates whose displacements are x.
    tangent : sympy.Matrix
        Z: the unit matrix without constraints.

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
    states: tuple[str, ...]
    tangent: Matrix


@dataclass(frozen=True)
class SmallOscillations:
    """Small oscillations of a system about its equilibria."""

    equations: Equations

    def linearised(self, equilibrium: tuple[sp.Expr, ...]) -> Linearisation:
        """M₀ and K at `equilibrium`; an error if it is none, or if these are not sufficient."""
        self._refuse(self._other_terms())
        values = self.check_equilibrium(equilibrium)
        d, q = self.equations, self.equations.system.q
        pairs = zip(self._multipliers(values), d.holonomic, strict=True)
        potential = d.effective_potential - sp.Add(*(force * phi for force, phi in pairs))
        gradient = [potential.diff(x) for x in q]
        stiffness = Matrix([[force.diff(x) for x in q] for force in gradient])
        matrices = d.mass_matrix_at(values), stiffness.xreplace(values)
        self._refuse({"have infinite terms": any(matrix.has(*INFINITE) for matrix in matrices)})
        changes = self._changes(values)
        Z, states = changes.directions, tuple(q[k].name for k in changes.free)
        if d.holonomic:
            M, K = ((Z.T * matrix * Z).applyfunc(tidied) for matrix in matrices)
            matrices = M, K
        return Linearisation(equilibrium, *matrices, states, Z)

    def _changes(self, values: Values) -> FreeChanges:
        """Displacements that constraints leave free."""
        jacobian = self.equations.constraint_jacobian.xreplace(values)
        return FreeChanges.of(self.equations.system, jacobian)

    def _multipliers(self, values: Values) -> Matrix:
        """Multipliers with which the constraints balance the forces of the potential, a column."""
        d = self.equations
        gradient = Matrix([d.effective_potential.diff(q) for q in d.system.q])
        return self._changes(values).multipliers(gradient.xreplace(values))

    def _refuse(self, problems: dict[str, bool]) -> None:
        name = self.equations.system.name
        for problem, exists in problems.items():
            if exists:
                raise SystemDefinitionError(
                    f"small motions of {name!r} {problem}: a mass and a stiffness matrix do not "
                    "describe them; use Derivation.state_space"
                )

    def check_equilibrium(self, equilibrium: tuple[sp.Expr, ...]) -> dict[sp.Symbol, sp.Expr]:
        """`equilibrium` by coordinate; an error if a force or a constraint is not 0 there."""
        d, system = self.equations, self.equations.system
        if len(equilibrium) != len(system.q):
            raise SystemDefinitionError(
                f"an equilibrium of {system.name!r} has {len(system.q)} coordinates "
                f"({', '.join(q.name for q in system.q)}), got {len(equilibrium)}"
            )
        values = dict(zip(system.q, equilibrium, strict=True))
        still = dict.fromkeys(system.qdot, sp.S.Zero)
        reactions = sp.zeros(len(system.q), 1)
        if system.conditions:
            OperatingPoint(system, values | still).check_constraints(d)
            reactions = d.constraint_jacobian.xreplace(values).T * self._multipliers(values)
        for i, q in enumerate(system.q):
            gradient = d.effective_potential.diff(q) + d.drift[i].diff(TIME)
            everywhere = system.applied[i].xreplace(still) - gradient + reactions[i]
            force, reason = everywhere.xreplace(values), ""
            if force.has(*INFINITE):
                reason = f"the force along {q.name} is not finite there"
            elif q.is_positive and values[q].is_nonpositive:
                reason = f"{q.name} is positive"
            elif not is_small(force):
                force = sp.factor_terms(reduced(force))
                reason = f"the force along {q.name} is {force} there"
                is_constant = all(is_small(everywhere.diff(other)) for other in system.q)
                if is_constant and not system.conditions:
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
        d = self.equations
        rotation = d.drift.jacobian(d.system.q)
        parts = [d.effective_potential, d.drift, *d.holonomic]
        parts += [d.mass_matrix] if TIME in d.variables else []
        return {
            "depend on time": any(part.has(TIME) for part in parts),
            "have applied forces": any(d.system.applied),
            "have constraints of velocities": bool(d.velocity_constraints),
            "have gyroscopic forces": not (rotation - rotation.T).is_zero_matrix,
        }
