"""Motions near a point of the state: their changes by independent components of the state."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from derive.mechanics.energies.kinetics import Matrix
from derive.mechanics.equations import Equations
from derive.mechanics.linearisation.free_changes import FreeChanges, solved
from derive.mechanics.linearisation.point import OperatingPoint


@dataclass(frozen=True)
class NearbyMotions:
    """The motion at a point, and the changes of state and accelerations near it."""

    point: OperatingPoint
    equations: Equations
    mass_matrix: Matrix
    velocities: FreeChanges  # of velocities and accelerations
    tangent: Matrix  # changes of the state, by those of its independent components
    independent: list[int]

    @classmethod
    def at(cls, point: OperatingPoint, equations: Equations) -> "NearbyMotions":
        """The motions near a point that satisfies the constraints."""
        system, n = point.system, len(point.system.q)
        point.check_constraints(equations)
        phi, rates = Matrix(equations.holonomic), equations.constraint_rates
        G = point(equations.constraint_jacobian)
        velocities = FreeChanges.of(system, G)
        gradients = phi.jacobian(system.q) if phi else Matrix(0, n, [])
        coordinates = FreeChanges.of(system, point(gradients))
        Z = coordinates.directions
        slips = point(rates.jacobian(system.q)) * Z if rates else Matrix(0, Z.cols, [])
        still = sp.zeros(len(velocities.free), Z.cols)
        drift = velocities.with_components(Matrix(still), Matrix(-slips))
        none = sp.zeros(n, len(velocities.free))
        tangent = Matrix.vstack(Z.row_join(none), drift.row_join(velocities.directions))
        independent = [*coordinates.free, *(n + k for k in velocities.free)]
        return cls(point, equations, point(equations.mass_matrix), velocities, tangent, independent)

    @cached_property
    def accelerations(self) -> Matrix:
        """q̈ at the point, a column."""
        d = self.equations
        return self._accelerations(self.point(d.forcing), self.point(d.constraint_forcing))

    def _accelerations(self, forces: Matrix, sides: Matrix) -> Matrix:
        """Columns q̈ of M q̈ = forces + Gᵀ λ and G q̈ = sides."""
        Z, M = self.velocities.directions, self.mass_matrix
        none = Matrix(sp.zeros(Z.cols, forces.cols))
        least = self.velocities.with_components(none, sides)
        return Z * solved(Z.T * M * Z, Z.T * (forces - M * least)) + least

    def changes(self, symbols: Sequence[sp.Symbol], directions: Matrix) -> Matrix:
        """Changes of the accelerations with those of symbols, a column a direction."""
        d, point, a = self.equations, self.point, self.accelerations
        reactions = self.velocities.multipliers(self.mass_matrix * a - point(d.forcing))
        M, G, f, gamma = (
            d.mass_matrix, d.constraint_jacobian, d.forcing, d.constraint_forcing
        )  # fmt: skip
        forces, sides = [sp.zeros(M.rows, 0)], [sp.zeros(G.rows, 0)]
        for s in symbols:
            forces.append(point(f.diff(s)) - point(M.diff(s)) * a + point(G.T.diff(s)) * reactions)
            sides.append(point(gamma.diff(s)) - point(G.diff(s)) * a)
        return self._accelerations(
            Matrix.hstack(*forces) * directions, Matrix.hstack(*sides) * directions
        )
