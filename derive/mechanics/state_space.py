"""State-space matrices about any point, as functions of parameters."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import sympy as sp

from derive.formulas.expression import FUNCTIONS, number
from derive.formulas.syntax import ExpressionError
from derive.mechanics.reduction import reduced
from derive.system.parts import SystemDefinitionError, formula, items
from derive.system.symbols import TIME
from derive.system.system import System
from solvers.io.suggestion import did_you_mean, shortened

Matrix: TypeAlias = sp.ImmutableDenseMatrix
Numbers: TypeAlias = list[list[float]]
#: A formula, or its text.
Formula: TypeAlias = sp.Expr | float | str


@dataclass(frozen=True)
class StateSpace:
    """x' = r + A x + B w and z = C x + D w, for small changes x of the state and w of the inputs.

    Attributes
    ----------
    system : System
        The system.
    point : dict of sympy.Symbol to sympy.Expr
        Coordinates, velocities and inputs of the point.
    rate : sympy.Matrix
        The rate r of the state at the point, a column: 0 at an equilibrium.
    A, B, C, D : sympy.Matrix
        Derivatives of the rates (q̇, q̈) by the state and by the inputs, and of the outputs.

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
        values |= {_symbol(values, name): formula(value) for name, value in given.items()}
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


@dataclass(frozen=True)
class Point:
    """A point of a system: values of coordinates, velocities, inputs and time."""

    system: System
    values: dict[sp.Symbol, sp.Expr]

    @classmethod
    def of(cls, system: System, given: Mapping[str, Formula]) -> "Point":
        """A point by names; others are at the equilibrium, or zeros, at rest and without inputs."""
        rest = system.equilibrium or (sp.S.Zero,) * len(system.q)
        values = dict(zip(system.q, rest, strict=True))
        values |= dict.fromkeys((*system.qdot, *system.u), sp.S.Zero)
        known = dict.fromkeys((*values, TIME))
        scope = FUNCTIONS | {s.name: s for s in (*system.params, *known)}
        for name, value in given.items():
            values[_symbol(known, str(name))] = expression(str(name), value, scope)
        return cls(system, values)

    def __call__(self, matrix: Matrix) -> Matrix:
        """A matrix at the point; refused where it is infinite."""
        result = matrix.xreplace(self.values)
        if result.has(sp.zoo, sp.oo, sp.nan):
            raise SystemDefinitionError(
                f"the equations of {self.system.name!r} are not finite at {self.values}"
            )
        return result


def expression(what: str, value: Formula, scope: Mapping[str, object]) -> sp.Expr:
    """A formula given as an expression, a number or text."""
    try:
        return formula(number(value, scope) if isinstance(value, str) else value)
    except (ExpressionError, SystemDefinitionError) as error:
        raise SystemDefinitionError(f"{what}: {error}") from error


def state_space(
    point: Point,
    mass_matrix: Matrix,
    forcing: Matrix,
    outputs: Sequence[Formula] | None,
) -> StateSpace:
    """The state space of M q̈ = f at a point: M δq̈ = δf - δM q̈.

    By default, outputs are the components of the state.
    """
    system = point.system
    state, scope = (*system.q, *system.qdot), FUNCTIONS | {TIME.name: TIME}
    scope |= {s.name: s for s in (*state, *system.params)}
    results = state
    if outputs is not None:
        results = items("outputs", outputs, "a list of formulas")
        results = tuple(expression("an output", value, scope) for value in results)
    M, f = point(mass_matrix), point(forcing)
    adjugate, determinant = M.adjugate(), M.det()

    def solved(right: Matrix) -> list[sp.Expr]:
        return [tidied(entry / determinant) for entry in adjugate * right]

    acceleration = Matrix(solved(f))

    def column(symbol: sp.Symbol) -> list[sp.Expr]:
        change = point(forcing.diff(symbol)) - point(mass_matrix.diff(symbol)) * acceleration
        return [*(sp.Integer(v == symbol) for v in system.qdot), *solved(change)]

    def jacobian(expressions: Sequence[sp.Expr], symbols: Sequence[sp.Symbol]) -> Matrix:
        entries = [e.diff(s) for e in expressions for s in symbols]
        return point(Matrix(len(expressions), len(symbols), entries)).applyfunc(tidied)

    size = len(state)
    columns = [[column(s) for s in symbols] for symbols in (state, system.u)]
    A, B = (Matrix(size, len(c), lambda i, j, c=c: c[j][i]) for c in columns)
    rate = Matrix([*(point.values[v] for v in system.qdot), *acceleration])
    C, D = jacobian(results, state), jacobian(results, system.u)
    return StateSpace(system, point.values, rate, A, B, C, D)


def tidied(entry: sp.Expr) -> sp.Expr:
    """An entry in factors, where it is a rational function of parameters."""
    if entry.has(sp.Function):
        return sp.factor_terms(reduced(entry))
    return sp.factor(entry)


def _symbol(known: Mapping[sp.Symbol, object], name: str) -> sp.Symbol:
    for symbol in known:
        if symbol.name == name:
            return symbol
    names = [symbol.name for symbol in known]
    raise SystemDefinitionError(
        f"{shortened(name)} is no quantity of the point{did_you_mean(name, names)}; known are "
        f"{', '.join(names)}"
    )
