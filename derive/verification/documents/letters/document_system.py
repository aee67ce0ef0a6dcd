"""The system of a document in the document's own letters."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache

import sympy as sp

from derive.formulas.expression import FUNCTIONS, parse
from derive.mechanics.derivation import Derivation
from derive.system.constraints import Constraint
from derive.system.naming import check_name
from derive.system.parts import Coordinate, Parameter, SystemDefinitionError
from derive.system.symbols import TIME, velocity
from derive.system.system import System
from derive.verification.documents.formula_translation import RATES
from derive.verification.documents.letters.candidates import (
    BY_LAGRANGIAN,
    Damped,
    SystemCandidate,
)
from derive.verification.documents.letters.letters import KINDS
from derive.verification.documents.letters.stated_constraints import StatedConstraint
from derive.verification.documents.statements import WORD

#: Endings of parameters that a document does not name, and of letters that are no valid names.
UNNAMED, INVALID = "_unnamed", "_letter"


@dataclass(frozen=True)
class SystemLetters:
    """A system, and the symbols of the document's letters."""

    system: System
    symbols: Mapping[str, sp.Symbol]
    #: Letters of multipliers, with their values.
    multipliers: Mapping[str, sp.Expr] = field(default_factory=dict)


def system_letters(candidate: SystemCandidate) -> SystemLetters:
    """The system of a candidate with the document's coordinates and parameters."""
    template = candidate.system
    symbols: dict[str, sp.Symbol] = {}
    for i, name in enumerate(candidate.coordinates):
        symbols[name] = sp.Symbol(valid_name(name), **_assumptions(candidate, i))
    units, defaults = dict[str, str](), dict[str, float]()
    values: dict[sp.Symbol, sp.Expr] = {}
    assumptions: dict[str, dict[str, bool]] = {}  # of a letter for several parameters, those of all
    for parameter in template.parameters:
        letter = candidate.parameters.get(parameter.symbol.name)
        if letter:
            assumptions.setdefault(letter, {}).update(parameter.symbol._assumptions_orig)
    for parameter in template.parameters:
        own = parameter.symbol
        if own.name in candidate.numbers:
            values[own] = sp.Rational(candidate.numbers[own.name])
            continue
        letter = candidate.parameters.get(own.name)
        name = valid_name(letter) if letter else own.name + UNNAMED
        values[own] = sp.Symbol(name, **assumptions.get(letter or "", own._assumptions_orig))
        units[name] = parameter.unit
        defaults[name] = parameter.default
        if letter:
            symbols[letter] = values[own]
    for offset in candidate.offsets:
        if isinstance(offset, str) and offset not in symbols:  # no parameter of the system
            symbols[offset] = sp.Symbol(valid_name(offset), positive=True)
            units[symbols[offset].name] = "m"
    q = [symbols[name] for name in candidate.coordinates]
    qdot = [velocity(symbol) for symbol in q]
    for i, (symbol, rate) in enumerate(zip(template.q, template.qdot, strict=True)):
        offset, signs = candidate.offsets[i], candidate.signs[i]
        shift = symbols[offset] if isinstance(offset, str) else offset * sp.pi / 2
        values[symbol] = sp.Add(*(s * one for s, one in zip(signs, q, strict=True)), shift)
        values[rate] = sp.Add(*(s * one for s, one in zip(signs, qdot, strict=True)))
    forces = _forces(template, candidate, values)
    for name, _ in (*candidate.forces, *candidate.friction):
        symbols[name] = sp.Symbol(valid_name(name), real=True)
        units.setdefault(symbols[name].name, "N")
    for name, damped in candidate.friction:
        row = _damping(candidate, damped).xreplace(values) * sp.Matrix(qdot)
        forces = [force - symbols[name] * one for force, one in zip(forces, row, strict=True)]
    for name, i in candidate.forces:
        forces[i] += symbols[name]
    for name in _letters(candidate.constraints):
        if name not in symbols:
            kind = {"positive": True} if is_length(name) else {"real": True}
            symbols[name] = sp.Symbol(valid_name(name), **kind)
            units[symbols[name].name] = "m" if is_length(name) else "1"
    parameters = {s.name: s for s in symbols.values() if s not in q}
    parameters |= {v.name: v for p in template.params if isinstance(v := values[p], sp.Symbol)}
    kinds = {one.symbol.name: one.unit for one in template.coordinates}
    coordinates = [
        Coordinate(symbol, _unit(candidate, i, kinds), "a coordinate of the document")
        for i, symbol in enumerate(q)
    ]
    system = System(
        name=template.name,
        title=template.title,
        coordinates=coordinates,
        parameters=[
            Parameter(s, units[s.name], defaults.get(s.name, 1.0), "a parameter")
            for s in parameters.values()
        ],
        masses=[mass.mapped(lambda e: e.xreplace(values)) for mass in template.masses],
        potential=template.potential_energy.xreplace(values),
        gravity=(sp.S.Zero,) * template.dimension,  # included in the potential
        forces=forces,
        constraints=[
            *(one.with_formula(one.formula.xreplace(values)) for one in template.conditions),
            *_conditions(candidate, symbols),
        ],
    )
    multipliers = {
        name: factor * system.multipliers[index] for name, index, factor in candidate.multipliers
    }
    multipliers |= {name: value.xreplace(values) for name, value in candidate.reactions.items()}
    return SystemLetters(system, symbols, multipliers)


def _letters(constraints: Sequence[StatedConstraint]) -> set[str]:
    """The parameters in constraints."""
    words = {word for one in constraints for word in WORD.findall(one.text)}
    moving = {q + ending for one in constraints for q in one.coordinates for ending in RATES}
    return words - moving - {*FUNCTIONS, "t"}


def is_length(name: str) -> bool:
    """Whether a letter is usual for a length, which is positive."""
    return name.partition("_")[0].rstrip("0123456789") in KINDS["length"]


def _conditions(
    candidate: SystemCandidate, symbols: Mapping[str, sp.Symbol]
) -> Iterator[Constraint]:
    """The constraints that the document states."""
    namespace = {**FUNCTIONS, **symbols, "t": TIME}
    namespace |= {f"{q}_dot": velocity(symbols[q]) for q in candidate.coordinates}
    for k, one in enumerate(candidate.constraints):
        yield Constraint(parse(one.text, namespace), multiplier(candidate, k))


def multiplier(candidate: SystemCandidate, index: int) -> str:
    """The name of the multiplier of a constraint that the document states."""
    return f"multiplier_{len(candidate.system.conditions) + index + 1}"


def _assumptions(candidate: SystemCandidate, index: int) -> dict[str, bool]:
    """Those of a coordinate of the system if that of the document has the same value."""
    for q, signs, offset in zip(
        candidate.system.q, candidate.signs, candidate.offsets, strict=True
    ):
        if offset == 0 and sum(map(abs, signs)) == signs[index] == 1:
            return q._assumptions_orig
    return {"real": True}


def _damping(candidate: SystemCandidate, damped: Damped) -> sp.Matrix:
    """The matrix D of friction Q = -b D q' on the document's coordinates, in template symbols."""
    n = len(candidate.coordinates)
    if isinstance(damped, int):
        return sp.diag(*(int(i == damped) for i in range(n)))
    if damped == "coordinates":
        return sp.eye(n)
    signs = sp.Matrix(candidate.signs)
    matrix = mass_matrix(candidate.system) if damped == "motion" else drag(candidate.system)
    return sp.Matrix(signs.T * matrix * signs)


def mass_matrix(template: System) -> sp.Matrix:
    """The mass matrix of a system."""
    return sp.Matrix(derivation(template).mass_matrix)


def energies_of(derived: Derivation) -> tuple[sp.Expr, sp.Expr]:
    """Kinetic and potential energy, to which velocities can belong in a stated Lagrangian."""
    T, V = derived.kinetic_energy, derived.potential_energy
    if derived.system.name == BY_LAGRANGIAN:
        T = derived.energy - derived.effective_potential
        V = T - derived.lagrangian
    return T, V


def drag(template: System) -> sp.Matrix:
    """The mass matrix with 1 for every mass, and without inertia."""
    masses = {p.symbol for p in template.parameters if p.unit == "kg"}
    inertia = {p.symbol: 0 for p in template.parameters if p.unit == "kg m^2"}
    matrix = mass_matrix(template).xreplace(inertia)
    return sum((matrix.diff(mass) for mass in masses), sp.zeros(*matrix.shape))


@cache
def derivation(template: System) -> Derivation:
    """The derivation of a system, which is kept."""
    return Derivation(template)


def _forces(
    template: System, candidate: SystemCandidate, values: Mapping[sp.Symbol, sp.Expr]
) -> list[sp.Expr]:
    """Generalized forces on the document's coordinates: Aᵀ Q with q = A q' + c."""
    applied = [force.xreplace(dict(values)) for force in template.applied]
    n = len(applied)
    return [sp.Add(*(candidate.signs[j][i] * applied[j] for j in range(n))) for i in range(n)]


def _unit(candidate: SystemCandidate, index: int, kinds: Mapping[str, str]) -> str:
    names = [*kinds]
    row = next(k for k, signs in enumerate(candidate.signs) if signs[index])
    return kinds[names[row]]


def valid_name(name: str) -> str:
    """The name of a letter in a system: itself, unless it is reserved."""
    try:
        check_name(name, "")
    except SystemDefinitionError:
        return name + INVALID
    return name
