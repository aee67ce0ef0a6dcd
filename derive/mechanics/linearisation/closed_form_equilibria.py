"""Equilibria in closed form: one equation, or a factor of it, after another."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import sympy as sp

from derive.formulas.generic_values import is_small
from derive.mechanics.energies.reduction import reduced
from derive.mechanics.equations import Equations
from derive.mechanics.linearisation.point import OperatingPoint, tidied
from derive.system.parts import SystemDefinitionError

Solution: TypeAlias = dict[sp.Symbol, sp.Expr]

#: Operations in the longest condition that is solved in symbols.
LONGEST = 400


def equilibria(point: OperatingPoint, equations: Equations) -> list[Solution]:
    """All coordinates that remain with the velocities of a point, angles within one turn.

    `point` has velocities and inputs; coordinates on which no force depends keep their symbols.
    With constraints, f + Gᵀ λ = 0, and G q̇ + b and γ of G q̈ = γ are 0.
    """
    d, system = equations, point.system
    reactions = d.constraint_jacobian.T * sp.Matrix(system.multipliers)
    forces = d.forcing + reactions if system.conditions else d.forcing
    conditions = [*forces, *d.holonomic, *d.constraint_rates, *d.constraint_forcing]
    values = [sp.factor(condition.xreplace(point.values)) for condition in conditions]
    results: list[Solution] = []
    unknowns = (*system.multipliers, *system.q)
    for known in _solutions([value for value in values if value != 0], unknowns, system.name):
        solution = {q: known.get(q, q) for q in system.q}
        if not any(_contains(other, solution) for other in results):
            results = [other for other in results if not _contains(solution, other)]
            results.append(solution)
    return sorted(results, key=lambda values: [sp.default_sort_key(v) for v in values.values()])


def _solutions(
    conditions: Sequence[sp.Expr], unknowns: Sequence[sp.Symbol], name: str
) -> Iterator[Solution]:
    """Solutions of all equations condition = 0."""
    if not conditions:
        yield {}
        return
    factors = [[f for f in _factors(c) if f.free_symbols & {*unknowns}] for c in conditions]
    if [] in factors:  # a condition that no unknown changes
        return
    steps = [[_step(factor, unknowns) for factor in parts] for parts in factors]
    index = min(range(len(steps)), key=lambda k: max(step.cost for step in steps[k]))
    others = [*conditions[:index], *conditions[index + 1 :]]
    for step in steps[index]:
        for root in step.roots(name):
            rest = [q for q in unknowns if q != step.unknown]
            changed = [sp.factor(reduced(c.subs(step.unknown, root))) for c in others]
            for values in _solutions([c for c in changed if not is_small(c)], rest, name):
                value = tidied(root.subs(values)) if root.free_symbols & {*rest} else root
                if _is_possible(step.unknown, value) and not is_small(
                    step.coefficient.subs(values)
                ):
                    yield {step.unknown: value, **values}
        if step.may_be_singular:
            remainder = step.factor.xreplace({step.unknown: sp.S.Zero})
            both = [sp.factor(reduced(c)) for c in (step.coefficient, remainder)]
            yield from _solutions([*others, *(c for c in both if c != 0)], unknowns, name)


@dataclass(frozen=True)
class _Step:
    """A factor that is to be 0, and the unknown for which it is solved."""

    factor: sp.Expr
    unknown: sp.Symbol
    count: int  # of unknowns

    @cached_property
    def coefficient(self) -> sp.Expr:
        """The coefficient of the unknown in a linear equation of several unknowns, or else 1."""
        return self.factor.diff(self.unknown) if self.count > 1 else sp.S.One

    @property
    def is_linear(self) -> bool:
        return self.unknown not in self.coefficient.free_symbols

    @property
    def may_be_singular(self) -> bool:
        """Whether the coefficient can be 0, where the factor does not determine the unknown."""
        return self.coefficient.is_zero is not False

    @property
    def cost(self) -> tuple[bool, bool, int]:
        """Factors of one unknown are solved first, those of uncertain coefficients late."""
        return not self.is_linear, self.may_be_singular, self.count

    def roots(self, name: str) -> list[sp.Expr]:
        """Values of the unknown, those of equations of several unknowns by the others."""
        if not self.is_linear or self.factor.count_ops() > LONGEST:
            own = sorted(self.factor.free_symbols, key=str)
            raise SystemDefinitionError(_no_closed_form(name, self.factor, own))
        if self.count > 1:
            return [-self.factor.xreplace({self.unknown: sp.S.Zero}) / self.coefficient]
        return _roots(self.factor, self.unknown, name)


def _step(factor: sp.Expr, unknowns: Sequence[sp.Symbol]) -> _Step:
    """The easiest of the unknowns."""
    own = [q for q in unknowns if q in factor.free_symbols]
    return min((_Step(factor, q, len(own)) for q in own), key=lambda step: step.cost)


def _contains(general: Solution, special: Solution) -> bool:
    """Whether a solution is another one with values of free coordinates."""
    free = {q: special[q] for q, value in general.items() if q == value}
    return all(is_small(general[q].subs(free) - special[q]) for q in general)


def _is_possible(unknown: sp.Symbol, value: sp.Expr) -> bool:
    return value.is_real is not False and not (unknown.is_positive and value.is_nonpositive)


def _factors(force: sp.Expr) -> Iterator[sp.Expr]:
    """The factors that may be 0."""
    for factor in sp.Mul.make_args(sp.factor(force)):
        base, power = factor.as_base_exp()
        if not base.is_number and power.is_positive:
            yield base


def _roots(factor: sp.Expr, unknown: sp.Symbol, name: str) -> list[sp.Expr]:
    """The real roots of an expression in one unknown, whose form is known to have some."""
    sine, cosine = sp.Dummy("s", real=True), sp.Dummy("c", real=True)
    expanded = sp.expand_trig(factor).xreplace({sp.sin(unknown): sine, sp.cos(unknown): cosine})
    waves = expanded.free_symbols & {sine, cosine}
    if unknown in expanded.free_symbols:
        variables, degree = [unknown], 0 if waves else 2
    else:
        variables, degree = [*waves], 2 if len(waves) == 1 else 1
    if not expanded.is_polynomial(*variables) or sp.Poly(expanded, *variables).total_degree() > (
        degree
    ):
        raise SystemDefinitionError(_no_closed_form(name, factor, [unknown]))
    waves_of = {sine: sp.sin(unknown), cosine: sp.cos(unknown)}
    if len(variables) == 2 and expanded.xreplace(dict.fromkeys(waves, sp.S.Zero)) == 0:
        # opposite directions, of which SymPy finds one if the coefficients are numbers
        first = -sp.atan(sp.cancel(expanded.coeff(cosine) / expanded.coeff(sine)))
        roots = [first, first + sp.pi]
    else:
        roots = sp.solve(expanded.xreplace(waves_of), unknown)
    return [root for root in roots if _is_possible(unknown, root)]


def _no_closed_form(name: str, factor: sp.Expr, unknowns: Sequence[sp.Symbol]) -> str:
    names = ", ".join(q.name for q in unknowns)
    return (
        f"no closed form of the equilibria of {name!r} is known: {str(factor)[:200]} = 0 for "
        f"{names}; solvers.equilibria computes all of them in a box"
    )
