"""State-space matrices about any point, as functions of parameters."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import sympy as sp

from derive.formulas.expression import FUNCTIONS
from derive.mechanics.energies.kinetics import Matrix
from derive.mechanics.equations import Equations
from derive.mechanics.linearisation.free_changes import tidied
from derive.mechanics.linearisation.nearby_motions import NearbyMotions
from derive.mechanics.linearisation.point import Formula, OperatingPoint, expression, named
from derive.system.parts import SystemDefinitionError, formula, items
from derive.system.symbols import TIME
from derive.system.system import System

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
