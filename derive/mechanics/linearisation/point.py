"""Points of a system, given by names and formulas."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import sympy as sp

from derive.formulas.evaluation.generic_values import is_small
from derive.formulas.expression import FUNCTIONS, number
from derive.formulas.syntax import ExpressionError
from derive.mechanics.energies.kinetics import Matrix
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
