"""Points and outputs of a system by names and formulas; changes that constraints leave free."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import sympy as sp

from derive.formulas.expression import FUNCTIONS, number
from derive.formulas.generic_values import is_small, sample
from derive.formulas.numeric import Evaluator, NoValueError
from derive.formulas.syntax import ExpressionError
from derive.mechanics.energies.kinetics import Kinetics, Matrix
from derive.mechanics.energies.reduction import reduced
from derive.mechanics.equations import Equations
from derive.system.parts import SystemDefinitionError, formula
from derive.system.symbols import TIME
from derive.system.system import System
from solvers.io.suggestion import did_you_mean, shortened

#: A formula, or its text.
Formula: TypeAlias = sp.Expr | float | str


@dataclass(frozen=True)
class OperatingPoint:
    """A point of a system: values of coordinates, velocities, inputs and time."""

    system: System
    values: dict[sp.Symbol, sp.Expr]

    @classmethod
    def of(cls, system: System, given: Mapping[str, Formula]) -> "OperatingPoint":
        """A point by names; others are at the equilibrium, or zeros, at rest and without inputs."""
        rest = system.equilibrium or (sp.S.Zero,) * len(system.q)
        values = dict(zip(system.q, rest, strict=True))
        values |= dict.fromkeys((*system.qdot, *system.u), sp.S.Zero)
        known = dict.fromkeys((*values, TIME))
        namespace = FUNCTIONS | {s.name: s for s in (*system.params, *known)}
        for name, value in given.items():
            values[named(known, str(name))] = expression(str(name), value, namespace)
        return cls(system, values)

    def __call__(self, matrix: Matrix) -> Matrix:
        """A matrix at the point; refused where it is infinite."""
        result = matrix.xreplace(self.values)
        if result.has(sp.zoo, sp.oo, sp.nan):
            raise SystemDefinitionError(
                f"the equations of {self.system.name!r} are not finite at {self.values}"
            )
        return result

    def check_constraints(self, equations: Equations) -> None:
        """Refuse a point at which a constraint, or its rate, is not 0."""
        holonomic = {*equations.holonomic}
        residuals = []
        for one, rate in zip(self.system.conditions, equations.constraint_rates, strict=True):
            if one.formula in holonomic:
                residuals.append((f"constraint {one.name}", one.formula))
            residuals.append((f"the rate of constraint {one.name}", rate))
        for name, residual in residuals:
            value = residual.xreplace(self.values)
            if not is_small(value):
                raise SystemDefinitionError(
                    f"{self.system.name!r} violates {name} at the point: it is {reduced(value)}; "
                    "give coordinates and velocities with which it is 0, such as those of "
                    "Derivation.equilibria()"
                )


def expression(what: str, value: Formula, namespace: Mapping[str, object]) -> sp.Expr:
    """A formula given as an expression, a number or text."""
    try:
        return formula(number(value, namespace) if isinstance(value, str) else value)
    except (ExpressionError, SystemDefinitionError) as error:
        raise SystemDefinitionError(f"{what}: {error}") from error


def named(known: Collection[sp.Symbol], name: str) -> sp.Symbol:
    """The known symbol with a name."""
    for symbol in known:
        if symbol.name == name:
            return symbol
    names = [symbol.name for symbol in known]
    raise SystemDefinitionError(
        f"{shortened(name)} is no quantity of the point{did_you_mean(name, names)}; known are "
        f"{', '.join(names)}"
    )


#: The part of a column that others leave, above which it is independent of them.
INDEPENDENT = 1e-12


@dataclass(frozen=True)
class FreeChanges:
    """Changes x with G x = 0, by the independent ones of its components.

    Attributes
    ----------
    jacobian : sympy.Matrix
        G at a point, one row a constraint.
    dependent : tuple of int
        Components that the others determine, as many as constraints.
    """

    jacobian: Matrix
    dependent: tuple[int, ...]

    @classmethod
    def of(cls, system: System, jacobian: Matrix) -> "FreeChanges":
        """The changes by the components that determine the others best, with default parameters.

        A `SystemDefinitionError` reports constraints that depend on each other.
        """
        rest, chosen = _rows(system, jacobian), list[int]()
        for _ in range(jacobian.rows):
            sizes = [sum(row[k] ** 2 for row in rest) for k in range(jacobian.cols)]
            k = max(range(jacobian.cols), key=lambda k: (k not in chosen) * sizes[k])
            if not sizes[k] > INDEPENDENT**2:
                raise SystemDefinitionError(
                    f"constraints of {system.name!r} depend on each other at the point, with the "
                    "default values of the parameters: give a point at which they are independent"
                )
            chosen.append(k)
            unit = [row[k] / sizes[k] ** 0.5 for row in rest]
            for j in range(jacobian.cols):
                part = sum(u * row[j] for u, row in zip(unit, rest, strict=True))
                for u, row in zip(unit, rest, strict=True):
                    row[j] -= u * part
        return cls(jacobian, tuple(sorted(chosen)))

    @cached_property
    def free(self) -> tuple[int, ...]:
        """Independent components."""
        return tuple(k for k in range(self.jacobian.cols) if k not in self.dependent)

    @cached_property
    def directions(self) -> Matrix:
        """Z of one column an independent component, with G Z = 0."""
        count, constraints = len(self.free), self.jacobian.rows
        return self.with_components(Matrix(sp.eye(count)), Matrix(sp.zeros(constraints, count)))

    def with_components(self, components: Matrix, sides: Matrix) -> Matrix:
        """Columns x with the independent `components` and G x = `sides`."""
        others = self.jacobian.extract([*range(self.jacobian.rows)], [*self.free])
        determined = solved(self._square, sides - others * components)
        rows = {k: components.row(i) for i, k in enumerate(self.free)}
        rows |= {k: determined.row(i) for i, k in enumerate(self.dependent)}
        return Matrix.vstack(*(rows[k] for k in range(self.jacobian.cols)))

    def multipliers(self, forces: Matrix) -> Matrix:
        """Columns λ with Gᵀ λ = `forces` in the dependent components."""
        return solved(self._square.T, forces.extract([*self.dependent], [*range(forces.cols)]))

    @property
    def _square(self) -> Matrix:
        return self.jacobian.extract([*range(self.jacobian.rows)], [*self.dependent])


def solved(matrix: Matrix, right: Matrix) -> Matrix:
    """The solutions of linear equations, in factors."""
    adjugate, determinant = matrix.adjugate(), matrix.det()
    return Matrix((adjugate * right).applyfunc(lambda entry: tidied(entry / determinant)))


def tidied(entry: sp.Expr) -> sp.Expr:
    """An entry in factors, where it is a rational function of parameters."""
    if entry.has(sp.Function):
        return sp.factor_terms(reduced(entry))
    return sp.factor(entry)


def _rows(system: System, matrix: Matrix) -> list[list[float]]:
    """The entries with default values of parameters, and generic ones of other symbols."""
    defaults = {p.symbol: sp.sympify(p.default) for p in system.parameters}
    others = sorted(matrix.free_symbols - {*defaults}, key=str)
    evaluator = Evaluator(defaults | sample(others, 0))
    try:
        return [[float(evaluator(x).number.real) for x in row] for row in matrix.tolist()]
    except NoValueError as error:
        raise SystemDefinitionError(
            f"the constraints of {system.name!r} have no derivatives at the point: {error}"
        ) from None


def named_outputs(kinetics: Kinetics) -> dict[str, sp.Expr]:
    """Quantities with names: ``energy``, positions ``x1``, ``y1`` ..., outputs, and the state.

    The number is that of the mass, in the order of the system; two axes are x and y.
    """
    system = kinetics.system
    positions = {
        f"{axis}{k}": part
        for k, mass in enumerate(system.masses, 1)
        for axis, part in zip("xyz", mass.position, strict=False)
    }
    state = {s.name: s for s in (*system.q, *system.qdot)}
    return {"energy": kinetics.energy} | positions | dict(system.measured) | state


def outputs(kinetics: Kinetics, formulas: Sequence[Formula]) -> tuple[sp.Expr, ...]:
    """Formulas, or names of `named_outputs`, as expressions; `SystemDefinitionError` if invalid."""
    system, named = kinetics.system, named_outputs(kinetics)
    symbols = {s.name: s for s in (*system.params, TIME)}
    namespace, results = FUNCTIONS | symbols | named, []
    for given in formulas:
        if isinstance(given, str) and given.isidentifier() and given not in namespace:
            raise SystemDefinitionError(
                f"{shortened(given)} is no output{did_you_mean(given, named)}; known are "
                f"{', '.join(named)}, and formulas of these and of parameters"
            )
        results.append(expression(f"output {shortened(given)}", given, namespace))
    return tuple(results)
