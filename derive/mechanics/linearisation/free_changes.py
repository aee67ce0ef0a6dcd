"""Small changes that constraints leave free: those of independent coordinates and velocities."""

from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from derive.formulas.evaluation.generic_values import sample
from derive.formulas.evaluation.numeric import Evaluator, NoValueError
from derive.mechanics.energies.kinetics import Matrix
from derive.mechanics.energies.reduction import reduced
from derive.system.parts import SystemDefinitionError
from derive.system.system import System

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
