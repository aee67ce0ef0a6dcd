"""The system of energies that a document states, if it has constraints of its own.

Kinetic energies are sums of squares of velocities with constant factors, such as those of particles
in Cartesian coordinates, of bodies in a plane and of wheels.
"""

from collections.abc import Iterator, Mapping, Sequence

import sympy as sp

from derive.formulas.expression import FUNCTIONS, parse
from derive.formulas.syntax import ExpressionError
from derive.system.parts import Coordinate, Parameter, PointMass, SystemDefinitionError
from derive.system.symbols import TIME, velocity
from derive.system.system import System
from derive.verification.documents.letters.document_system import derivation, is_length, valid_name
from derive.verification.documents.letters.letters import Letters
from derive.verification.documents.statements import DocumentFormula

#: Energies and the numbers of their formulas.
Stated = Mapping[str, tuple[sp.Expr, int]]


def systems_of_energies(
    letters: Letters, formulas: Sequence[DocumentFormula]
) -> Iterator[tuple[System, frozenset[int]]]:
    """Yield the system of the stated Lagrangian, or energies, and the numbers of these formulas."""
    symbols = _symbols(letters)
    energies = _energies(letters, formulas, symbols)
    if energies is None:
        return
    T, V, numbers = energies
    q = [symbols[name] for name in letters.coordinates]
    rates = [velocity(one) for one in q]
    masses = _masses(sp.expand(T), q, rates)
    moving = [one for one, v in zip(q, rates, strict=True) if T.has(v)]
    if masses is None or V.free_symbols & {*rates} or not {*moving} >= {*q} & V.free_symbols:
        return
    used = T.free_symbols | V.free_symbols
    parameters = [
        Parameter(one, "m" if is_length(name) else "1", 1.0, "a parameter")
        for name, one in symbols.items()
        if one in used and name in letters.parameters
    ]
    try:
        system = System(
            "stated", "The system of the stated energies",
            [Coordinate(one, "m", "a coordinate") for one in moving], parameters, masses,
            potential=V, gravity=(sp.S.Zero, sp.S.Zero),
        )  # fmt: skip
        derivation(system)
    except SystemDefinitionError:
        return
    yield system, numbers


def has_rotations(system: System, letters: Letters, formulas: Sequence[DocumentFormula]) -> bool:
    """Whether the stated kinetic energy is that of a system and energies of rotations beside it.

    The masses are then those of bodies, of which the document states the centres. An energy of a
    rotation has a moment of inertia, which is no mass.
    """
    own = {one.name: one for one in (*system.q, *system.params)}
    symbols = {name: own.get(one.name, one) for name, one in _symbols(letters).items()}
    energies = _energies(letters, formulas, symbols)
    if energies is None:
        return False
    masses = {symbols[name] for name in letters.of_kind("mass")}
    rest = sp.expand(sp.expand_trig(energies[0] - derivation(system).kinetic_energy))
    rotations = [(rest.coeff(rate, 2), rate) for rate in system.qdot if rest.has(rate)]
    return (
        bool(rotations)
        and all(
            not factor.could_extract_minus_sign()
            and factor.free_symbols - masses
            and not factor.free_symbols & {*system.q, *system.qdot, TIME}
            for factor, _ in rotations
        )
        and sp.expand(rest - sp.Add(*(c * rate**2 for c, rate in rotations))) == 0
    )


def _symbols(letters: Letters) -> dict[str, sp.Symbol]:
    """Symbols of the coordinates and parameters of a document, without multipliers."""
    symbols = {q: sp.Symbol(valid_name(q), real=True) for q in letters.coordinates}
    for name in set(letters.parameters) - {*letters.multipliers}:
        is_positive = is_length(name) or name in letters.of_kind("mass")
        assumptions = {"positive": True} if is_positive else {"real": True}
        symbols[name] = sp.Symbol(valid_name(name), **assumptions)
    return symbols


def _energies(
    letters: Letters, formulas: Sequence[DocumentFormula], symbols: Mapping[str, sp.Symbol]
) -> tuple[sp.Expr, sp.Expr, frozenset[int]] | None:
    """The stated kinetic and potential energy, and the numbers of their formulas."""
    stated = _stated(letters, formulas, symbols)
    if "kinetic_energy" in stated and "potential_energy" in stated:
        (T, first), (V, second) = stated["kinetic_energy"], stated["potential_energy"]
        return T, V, frozenset({first, second})
    if "lagrangian" in stated:
        L, number = stated["lagrangian"]
        V = -L.xreplace({velocity(symbols[q]): sp.S.Zero for q in letters.coordinates})
        return sp.expand(L + V), V, frozenset({number})
    if "kinetic_energy" in stated:
        T, number = stated["kinetic_energy"]
        return T, sp.S.Zero, frozenset({number})
    return None


def _stated(
    letters: Letters, formulas: Sequence[DocumentFormula], symbols: Mapping[str, sp.Symbol]
) -> Stated:
    """The energies that formulas state in letters, without those of reactions."""
    namespace = {**FUNCTIONS, **symbols, "t": TIME}
    namespace |= {f"{q}_dot": velocity(symbols[q]) for q in letters.coordinates}
    result: dict[str, tuple[sp.Expr, int]] = {}
    for number, formula in enumerate(formulas):
        kind = letters.quantities.get(formula.subject, "")
        for side in formula.sides[1:]:
            try:
                value = parse(side.text, namespace)
            except (ExpressionError, NotImplementedError):
                continue
            if not isinstance(value, sp.MatrixBase):
                result.setdefault(kind, (value, number))
    return result


def _masses(
    kinetic: sp.Expr, q: Sequence[sp.Symbol], rates: Sequence[sp.Symbol]
) -> list[PointMass] | None:
    """Masses that move along lines with a kinetic energy; None if there are none."""
    masses: list[PointMass] = []
    rest = kinetic
    for one, rate in zip(q, rates, strict=True):
        factor = kinetic.coeff(rate, 2) * 2
        if not factor:
            continue
        if factor.free_symbols & {*q, *rates, TIME} or factor.could_extract_minus_sign():
            return None
        rest -= factor * rate**2 / 2
        masses.append(PointMass(factor, (one, sp.S.Zero)))
    return masses if masses and sp.expand(rest) == 0 else None
