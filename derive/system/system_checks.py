"""Checks of a system: numbers of components, and the symbols that its expressions contain."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain

import sympy as sp

from derive.formulas.functions import derivative
from derive.system.declaration import Declaration
from derive.system.parts import SystemDefinitionError
from derive.system.symbols import TIME


@dataclass(frozen=True)
class CheckedExpression:
    """An expression of a system, and the symbols that it may contain."""

    name: str
    expression: sp.Basic
    known: frozenset[sp.Symbol]
    variables: str  # `known` in words, and the remedy for others that exist in the system


def check(system: Declaration) -> None:
    """Raise `SystemDefinitionError` if components or symbols do not fit each other."""
    _check_counts(system)
    parts = [*_parts(system)]
    for part in parts:
        _check_symbols(system, part)
    _check_forces(system)
    _check_constraints(system)
    _check_weight(system, parts)


def _check_counts(system: Declaration) -> None:
    if len({len(mass.position) for mass in system.masses}) > 1 or not 2 <= system.dimension <= 3:
        counts = ", ".join(str(len(mass.position)) for mass in system.masses)
        raise SystemDefinitionError(
            f"positions of system {system.name!r} have {counts} components: give all two "
            "(x, up) or all three (x, y, up)"
        )
    for field, count in (("gravity", system.dimension), ("forces", len(system.q))):
        given = getattr(system, field) or ()
        if len(given) not in (0, count):
            raise SystemDefinitionError(
                f"{field} of system {system.name!r} has {len(given)} components: give {count}"
            )


def _parts(system: Declaration) -> Iterator[CheckedExpression]:
    """Every expression of a system."""
    constants = frozenset(system.params) - {*system.u}
    moving = frozenset(system.params) | {*system.q, TIME}
    fixed = "parameters"
    place = "coordinates, parameters and t; forces and dissipation can depend on velocities"
    for mass in system.masses:
        for inertia, position in mass.motions:
            remedy = f"{fixed}; inertia that varies follows from positions of constant masses"
            yield CheckedExpression(f"mass {inertia}", inertia, constants, remedy)
            yield CheckedExpression(
                f"the position of mass {inertia}", sp.Tuple(*position), moving, place
            )
        if mass.turns:
            for moment, _ in mass.turns:
                yield CheckedExpression(
                    f"the inertia of body {mass.mass}", moment, constants, fixed
                )
            orientation = sp.Tuple(*mass.placement)
            yield CheckedExpression(
                f"the orientation of body {mass.mass}", orientation, moving, place
            )
    yield CheckedExpression("the potential", system.potential_energy, moving, place)
    yield CheckedExpression(
        "the equilibrium", sp.Tuple(*(system.equilibrium or ())), constants, fixed
    )
    forces = sp.Tuple(system.dissipation, *system.forces)
    state = "coordinates, velocities, parameters and t"
    yield CheckedExpression("the list of forces", forces, moving | {*system.qdot}, state)
    for name, output in system.measured:
        yield CheckedExpression(f"output {name}", output, moving | {*system.qdot}, state)
    for one in system.conditions:
        yield CheckedExpression(
            f"constraint {one.name}", one.formula, moving | {*system.qdot}, state
        )
    yield CheckedExpression("the list of links", sp.Tuple(*chain(*system.points)), moving, place)
    yield CheckedExpression("the list of reactions", sp.Tuple(*system.reactions), constants, fixed)


def _check_symbols(system: Declaration, part: CheckedExpression) -> None:
    unknown = sorted({symbol.name for symbol in part.expression.free_symbols - part.known})
    if not unknown:
        return
    known, names = {symbol.name for symbol in part.known}, ", ".join(unknown)
    if same := ", ".join(name for name in unknown if name in known):
        raise SystemDefinitionError(
            f"{part.name} contains {same} as a symbol with other assumptions than the declared "
            "one: use the same object; time is derive.TIME, the velocity of x derive.velocity(x)"
        )
    variables = {*system.q, *system.qdot, *system.qddot, *system.p, *system.u, TIME}
    if {*unknown} <= {symbol.name for symbol in variables}:
        raise SystemDefinitionError(
            f"{part.name} depends on {names}: it must be a function of {part.variables}"
        )
    raise SystemDefinitionError(
        f"{part.name} contains unknown symbols: {names}; known are {', '.join(sorted(known))}; "
        "declare them as coordinates or parameters"
    )


def _check_forces(system: Declaration) -> None:
    if system.dissipation and not system.dissipation.free_symbols & {*system.qdot}:
        raise SystemDefinitionError(
            f"the dissipation of system {system.name!r} is {system.dissipation}, which depends on "
            "no velocity: give Rayleigh's function, such as c*theta_dot**2/2"
        )
    if system.reactions and any(system.applied):
        raise SystemDefinitionError(
            f"system {system.name!r} has reactions and applied forces: the components of applied "
            "forces along a constant length are not known; omit one of them"
        )


def _check_constraints(system: Declaration) -> None:
    qdot = {*system.qdot}
    for one in system.conditions:
        if not one.formula.free_symbols & (qdot | {*system.q}):
            raise SystemDefinitionError(
                f"constraint {one.name} of system {system.name!r} is {one.formula} = 0, which "
                "depends on no coordinate: omit it"
            )
        if not _is_affine(one.formula, one.formula.free_symbols & qdot):
            raise SystemDefinitionError(
                f"constraint {one.name} of system {system.name!r} is {one.formula} = 0, which is "
                "not affine in the velocities: give it as A(q, t) qdot + b(q, t)"
            )
    if system.reactions and system.conditions:
        raise SystemDefinitionError(
            f"system {system.name!r} has reactions and constraints: give the condition that a "
            "length is constant as a constraint, whose multiplier is the reaction"
        )


def _is_affine(formula: sp.Expr, variables: set[sp.Symbol]) -> bool:
    slopes = (derivative(formula, variable) for variable in variables)
    others = [slope for slope in slopes if slope.free_symbols & variables]
    # most derivatives of affine functions are constant as they stand; to expand takes long
    return not any(sp.expand(slope).free_symbols & variables for slope in others)


def _check_weight(system: Declaration, parts: list[CheckedExpression]) -> None:
    used = set().union(*(part.expression.free_symbols for part in parts))
    weightless = system.potential is not None and system.gravity is None
    if weightless and any(s.name == "g" and s not in used for s in system.params):
        down = ", ".join(["0"] * (system.dimension - 1) + ["-g"])
        raise SystemDefinitionError(
            f"parameter 'g' of system {system.name!r} is not used: a system with a potential has "
            f"weight only if gravity is given; give gravity=({down}), the acceleration of free "
            "fall, or omit g"
        )
