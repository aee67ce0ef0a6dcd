"""Cyclic coordinates, on which no energy and no force depends: their momenta are constant."""

from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from derive.mechanics.energies.kinetics import Matrix
from derive.mechanics.equations import Equations
from derive.mechanics.routhian import Routhian


@dataclass(frozen=True)
class CyclicCoordinates(Equations):
    """Conserved momenta of `system`, and its motion without the cyclic coordinates."""

    @cached_property
    def cyclic_coordinates(self) -> tuple[sp.Symbol, ...]:
        """Coordinates that neither L nor a constraint contains, and on which no force is applied.

        Examples
        --------
        >>> from derive import Derivation, load
        >>> Derivation(load("heavy_top")).cyclic_coordinates
        (phi, psi)
        """
        system = self.system
        contents = sp.Tuple(
            *self.mass_matrix, *self.drift, self.effective_potential, *self.constraint_rates
        ).free_symbols
        rows = zip(system.q, system.qdot, system.applied, strict=True)
        fixed = self.constraint_rates.free_symbols
        return tuple(q for q, v, Q in rows if Q == 0 and q not in contents and v not in fixed)

    @property
    def conserved_momenta(self) -> dict[sp.Symbol, sp.Expr]:
        """Momenta of the cyclic coordinates, functions of q and q̇."""
        rows = zip(self.system.q, self.system.p, self.momenta, strict=True)
        return {p: value for q, p, value in rows if q in self.cyclic_coordinates}

    @property
    def cyclic_velocities(self) -> dict[sp.Symbol, sp.Expr]:
        """Velocities of the cyclic coordinates, functions of the other q, q̇ and of momenta."""
        return self._without_cyclic.velocities

    @property
    def routhian(self) -> sp.Expr:
        """R = L - Σ p q̇ over the cyclic coordinates: a Lagrangian of the others.

        L if no coordinate is cyclic. Many textbooks define R with the opposite sign.

        Examples
        --------
        >>> from derive import Derivation, load
        >>> Derivation(load("spherical_pendulum")).routhian
        g*l*m*cos(theta) + l**2*m*theta_dot**2/2 - p_phi**2/(2*l**2*m*sin(theta)**2)
        """
        return self._without_cyclic.function

    @property
    def routh_equations(self) -> Matrix:
        """Residuals d/dt ∂R/∂q̇ - ∂R/∂q - Q - Gᵀ λ of the other coordinates, a column.

        They are zero along a motion, with constant momenta of the cyclic coordinates.
        """
        return self._without_cyclic.residuals

    @cached_property
    def _without_cyclic(self) -> Routhian:
        q = self.system.q
        return Routhian(self, tuple(q.index(one) for one in self.cyclic_coordinates))
