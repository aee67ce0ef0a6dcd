"""State-space matrices about any point, as functions of parameters.

Changes of constrained motions are those of independent components of the state.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import sympy as sp

from derive.formulas.expression import FUNCTIONS
from derive.mechanics.energies.kinetics import Matrix
from derive.mechanics.equations import Equations
from derive.mechanics.linearisation.point import (
    Formula,
    FreeChanges,
    OperatingPoint,
    expression,
    named,
    solved,
    tidied,
)
from derive.system.parts import SystemDefinitionError, formula, items
from derive.system.symbols import TIME
from derive.system.system import System


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
    def _inertia(self) -> Matrix:
        """The mass matrix of independent velocities; refused where it is singular."""
        Z = self.velocities.directions
        inertia = Matrix(Z.T * self.mass_matrix * Z)
        if tidied(inertia.det()) == 0:
            raise SystemDefinitionError(
                f"the mass matrix of {self.point.system.name!r} is singular at "
                f"{self.point.values}: give a point with unique accelerations"
            )
        return inertia

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
        return Z * solved(self._inertia, Z.T * (forces - M * least)) + least

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


Numbers: TypeAlias = list[list[float]]


@dataclass(frozen=True)
class StateSpace:
    """x' = r + A x + B w and z = C x + D w, for small changes x of the state and w of the inputs.

    Constraints determine some components of the state by the others, which are x.

    Attributes
    ----------
    system : System
        The system.
    point : dict of sympy.Symbol to sympy.Expr
        Coordinates, velocities and inputs of the point.
    rate : sympy.Matrix
        The rate r of the whole state at the point, a column: 0 at an equilibrium.
    A, B, C, D : sympy.Matrix
        Derivatives of the rates (q̇, q̈) by the state and by the inputs, and of the outputs.
    states : tuple of str
        Names of the components of x, which determine the others best with the default parameters.
    tangent : sympy.Matrix
        Derivatives of the whole state by x: the unit matrix without constraints.

    Examples
    --------
    >>> from derive import Derivation, load
    >>> upright = Derivation(load("single_pendulum")).state_space({"theta": "pi"})
    >>> upright.A
    Matrix([
    [  0, 1],
    [g/l, 0]])
    """

    system: System
    point: dict[sp.Symbol, sp.Expr]
    rate: Matrix
    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix
    states: tuple[str, ...]
    tangent: Matrix

    def numbers(
        self, params: Mapping[str, float] | None = None
    ) -> tuple[Numbers, Numbers, Numbers, Numbers]:
        """A, B, C and D in numbers, with default values of the parameters that are left out.

        ``scipy.signal.StateSpace(*space.numbers())`` takes them.

        Raises
        ------
        SystemDefinitionError
            When there is no such parameter, or the point depends on other symbols.
        """
        values: dict[sp.Symbol, sp.Expr] = {
            p.symbol: formula(p.default) for p in self.system.parameters
        }
        given = params or {}
        values |= {named(values, name): formula(value) for name, value in given.items()}
        a, b, c, d = (self._numbers(matrix, values) for matrix in (self.A, self.B, self.C, self.D))
        return a, b, c, d

    def _numbers(self, matrix: Matrix, values: Mapping[sp.Symbol, sp.Expr]) -> Numbers:
        try:
            return [[float(entry) for entry in row] for row in matrix.xreplace(values).tolist()]
        except TypeError:
            names = ", ".join(sorted(s.name for s in matrix.free_symbols - {*values}))
            raise SystemDefinitionError(
                f"the matrices depend on {names or 'complex numbers'}: give its value in the point"
            ) from None


def state_space(
    point: OperatingPoint, equations: Equations, outputs: Sequence[Formula] | None
) -> StateSpace:
    """The state space of M q̈ - Gᵀ λ = f and G q̈ = γ at a point, by their differentials.

    By default, outputs are the components of the state.
    """
    system = point.system
    state, namespace = (*system.q, *system.qdot), FUNCTIONS | {TIME.name: TIME}
    namespace |= {s.name: s for s in (*state, *system.params)}
    results = state
    if outputs is not None:
        results = items("outputs", outputs, "a list of formulas")
        results = tuple(expression("an output", value, namespace) for value in results)
    motion = NearbyMotions.at(point, equations)

    def jacobian(expressions: Sequence[sp.Expr], symbols: Sequence[sp.Symbol]) -> Matrix:
        entries = [e.diff(s) for e in expressions for s in symbols]
        return point(Matrix(len(expressions), len(symbols), entries))

    tangent, rows = motion.tangent, motion.independent
    A = Matrix.vstack(tangent[len(system.q) :, :], motion.changes(state, tangent))
    B = Matrix.vstack(
        sp.zeros(len(system.q), len(system.u)), motion.changes(system.u, sp.eye(len(system.u)))
    )
    A, B = (matrix.extract(rows, [*range(matrix.cols)]) for matrix in (A, B))
    C, D = jacobian(results, state) * tangent, jacobian(results, system.u)
    rate = Matrix([*(point.values[v] for v in system.qdot), *motion.accelerations])
    states = tuple(state[k].name for k in rows)
    A, B, C, D = (matrix.applyfunc(tidied) for matrix in (A, B, C, D))
    return StateSpace(system, point.values, rate, A, B, C, D, states, tangent)
