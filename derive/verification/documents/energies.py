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
from derive.verification.documents.letters import Letters
from derive.verification.documents.meaning import derivation, is_length, valid_name
from derive.verification.documents.statements import DocumentFormula

#: Energies and the numbers of their formulas.
Stated = Mapping[str, tuple[sp.Expr, int]]


def systems_of_energies(
    letters: Letters, formulas: Sequence[DocumentFormula]
) -> Iterator[tuple[System, frozenset[int]]]:
    """Yield the system of the stated Lagrangian, or energies, and the numbers of these formulas."""
    symbols = {q: sp.Symbol(valid_name(q), real=True) for q in letters.coordinates}
    for name in set(letters.parameters) - {*letters.multipliers}:
        is_positive = is_length(name) or name in letters.of_kind("mass")
        assumptions = {"positive": True} if is_positive else {"real": True}
        symbols[name] = sp.Symbol(valid_name(name), **assumptions)
    stated = _stated(letters, formulas, symbols)
    q = [symbols[name] for name in letters.coordinates]
    rates = [velocity(one) for one in q]
    at_rest = dict.fromkeys(rates, sp.S.Zero)
    numbers = set[int]()
    if "kinetic_energy" in stated and "potential_energy" in stated:
        (T, first), (V, second) = stated["kinetic_energy"], stated["potential_energy"]
        numbers = {first, second}
    elif "lagrangian" in stated:
        L, number = stated["lagrangian"]
        V, numbers = -L.xreplace(at_rest), {number}
        T = sp.expand(L + V)
    elif "kinetic_energy" in stated:
        (T, number), V = stated["kinetic_energy"], sp.S.Zero
        numbers = {number}
    else:
        return
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
    yield system, frozenset(numbers)


def _stated(
    letters: Letters, formulas: Sequence[DocumentFormula], symbols: Mapping[str, sp.Symbol]
) -> Stated:
    """The energies that formulas state in letters, without those of reactions."""
    scope = {**FUNCTIONS, **symbols, "t": TIME}
    scope |= {f"{q}_dot": velocity(symbols[q]) for q in letters.coordinates}
    found: dict[str, tuple[sp.Expr, int]] = {}
    for number, formula in enumerate(formulas):
        kind = letters.quantities.get(formula.subject, "")
        for side in formula.sides[1:]:
            try:
                value = parse(side.text, scope)
            except (ExpressionError, NotImplementedError):
                continue
            if not isinstance(value, sp.MatrixBase):
                found.setdefault(kind, (value, number))
    return found


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
