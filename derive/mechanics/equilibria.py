"""Equilibria in closed form: one equation, or a factor of it, after another."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias

import sympy as sp

from derive.formulas.sampling import is_small
from derive.mechanics.state_space import Point
from derive.system.parts import SystemDefinitionError

Values: TypeAlias = Mapping[sp.Symbol, sp.Expr]


def equilibria(point: Point, forcing: sp.ImmutableDenseMatrix) -> list[dict[sp.Symbol, sp.Expr]]:
    """All coordinates with which `forcing` is 0 at rest, angles within one turn.

    `point` has velocities and inputs; coordinates on which no force depends keep their symbols.
    """
    system = point.system
    forces = [sp.factor(force.xreplace(point.values)) for force in forcing]
    results: list[dict[sp.Symbol, sp.Expr]] = []
    for values in _solutions([f for f in forces if f != 0], system.q, system.name):
        solution = {q: values.get(q, q) for q in system.q}
        if solution not in results:
            results.append(solution)
    return sorted(results, key=lambda values: [sp.default_sort_key(v) for v in values.values()])


def _solutions(
    forces: Sequence[sp.Expr], unknowns: Sequence[sp.Symbol], name: str
) -> Iterator[dict[sp.Symbol, sp.Expr]]:
    """Solutions of all equations force = 0."""
    if not forces:
        yield {}
        return
    factors = [[*_factors(force)] for force in forces]
    counts = [
        max((len(f.free_symbols & {*unknowns}) for f in parts), default=0) for parts in factors
    ]
    if 0 in counts:  # a force that no coordinate changes
        return
    index = counts.index(min(counts))
    for factor in factors[index]:
        own = [q for q in unknowns if q in factor.free_symbols]
        if not own:
            continue
        if len(own) > 1:
            raise SystemDefinitionError(_no_closed_form(name, factor, own))
        for root in _roots(factor, own[0], name):
            others = [sp.factor(f.subs(own[0], root)) for f in forces]
            rest = [q for q in unknowns if q != own[0]]
            for values in _solutions([f for f in others if not is_small(f)], rest, name):
                yield {own[0]: root, **values}


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
    return [
        root
        for root in sp.solve(
            expanded.xreplace({sine: sp.sin(unknown), cosine: sp.cos(unknown)}), unknown
        )
        if root.is_real is not False and not (unknown.is_positive and root.is_nonpositive)
    ]


def _no_closed_form(name: str, factor: sp.Expr, unknowns: Sequence[sp.Symbol]) -> str:
    names = ", ".join(q.name for q in unknowns)
    return (
        f"no closed form of the equilibria of {name!r} is known: {str(factor)[:200]} = 0 for "
        f"{names}; solvers.equilibria computes all of them in a box"
    )
