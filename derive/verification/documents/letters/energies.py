"""The system of energies that a document states: T and V, its Lagrangian, or its energy.

Kinetic energies are quadratic in velocities, with coefficients that may depend on coordinates and
time. Terms that are linear are those of moving supports and of magnetic fields.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import product
from typing import Any

import sympy as sp

from derive.formulas.expression import FUNCTIONS, Value, parse
from derive.formulas.syntax import ExpressionError
from derive.system.parts import Coordinate, Parameter, PointMass, SystemDefinitionError
from derive.system.symbols import TIME, acceleration, velocity
from derive.system.system import System
from derive.verification.documents.formula_translation import is_derivative, order, stem
from derive.verification.documents.letters.candidates import BY_LAGRANGIAN, STATED
from derive.verification.documents.letters.document_system import derivation, is_length, valid_name
from derive.verification.documents.letters.implied_energies import (
    Energies,
    energies_of_hamiltonians,
    energies_of_matrices,
)
from derive.verification.documents.letters.letters import Letters, energy_of_part
from derive.verification.documents.statements import WORD, DocumentFormula, definitions

#: Energies by their kinds, and the numbers of their formulas: different values, the first first.
Stated = Mapping[str, Sequence[tuple[sp.Expr, int]]]
#: Most values of an energy that are tried, and rounds in which definitions are sought.
MOST, ROUNDS = 3, 3
#: Words about Rayleigh's function.
RAYLEIGH = re.compile(r"rayleigh|dis{1,2}ipa[ctz]|レイリー|瑞利", re.IGNORECASE)
#: A letter of a speed that no formula defines.
SPEED = re.compile(r"v(?:_\w+)?\Z")
#: The value of a mass that is larger than the others.
LARGE = 10.0


@dataclass(frozen=True)
class StatedInertia(PointMass):
    """Masses without known positions, but with a mass matrix, perhaps with a row of time."""

    matrix: sp.ImmutableDenseMatrix

    @property
    def motions(self) -> tuple[()]:
        """None: no position is known."""
        return ()

    @property
    def inertia_matrix(self) -> sp.ImmutableDenseMatrix:
        """The mass matrix."""
        return self.matrix


def systems_of_energies(
    letters: Letters, formulas: Sequence[DocumentFormula]
) -> Iterator[tuple[System, frozenset[int]]]:
    """Yield the systems of stated energies, and the numbers of the formulas that state them."""
    symbols = letter_symbols(letters)
    q = [symbols[name] for name in letters.coordinates]
    known: set[tuple[sp.Expr, sp.Expr]] = set()
    stated, values = stated_values(letters, formulas, symbols)
    damping = stated_dissipation(letters, formulas, values)
    kinetic = stated.get("kinetic_energy", ())
    # coordinates of points that angles without rates give are not those of the system
    rates = {stem(word) for one in formulas for word in one.words if order(word)}
    implied = {*letters.coordinates} - rates
    dependent = {symbols[one.subject] for one in formulas
                 if one.subject in rates & {*symbols} and implied & {*one.words}}  # fmt: skip
    for T, V, numbers in stated_energies(letters, formulas, stated, values):
        moving = [one for one in q if T.has(velocity(one))]
        matrix = _quadratic_form(T, moving)
        accelerated = {symbols[name] for name in _beside(letters, formulas, moving)}
        if (
            matrix is None
            or dependent & {*moving}
            or not {*moving} >= ({*q} & (V.free_symbols | T.free_symbols)) | accelerated
        ):
            continue
        pair = (sp.expand(T), sp.expand(V))
        if pair in known:
            continue
        known.add(pair)
        title = "The system of the stated energies"
        friction = [-damping.diff(velocity(one)) for one in moving]
        applied = stated_forces(formulas, values, moving)
        sums = [sp.Add(*pair) for pair in zip(friction, applied, strict=True)]
        # stated forces can contain the friction, or be those of another case
        loads = (sums, applied, friction) if any(applied) else (friction,)
        for forces in dict.fromkeys(map(tuple, loads)):
            is_kinetic = matrix.shape[0] == len(moving) or all(
                sp.expand(one - T) == 0 for one, _ in kinetic
            )
            name = STATED if is_kinetic else BY_LAGRANGIAN
            # also letters that cancel, as r of J = m*r**2/2 does in J/r**2
            own = [symbols[w] for k in numbers for w in formulas[k].words if w in symbols]
            if system := stated_system(name, title, letters, moving, matrix, V, forces, own):
                yield system, numbers


def _beside(
    letters: Letters, formulas: Sequence[DocumentFormula], moving: Sequence[sp.Symbol]
) -> set[str]:
    """The accelerated coordinates in formulas with coordinates that move; others are separate."""
    names = {one.name for one in moving}
    stems = [{*map(stem, one.words)} for one in formulas]
    return {*letters.accelerated} & set[str]().union(*(one for one in stems if one & names))


def stated_forces(
    formulas: Sequence[DocumentFormula], values: Mapping[str, Value], q: Sequence[sp.Symbol]
) -> list[sp.Expr]:
    """The generalized forces that a document defines, such as Q_theta = M - d*theta_dot."""
    subjects = {one.subject for one in formulas}
    names = [f"Q_{one.name}" for one in q]
    own = [values.get(name, sp.S.Zero) if name in subjects else sp.S.Zero for name in names]
    known = {*q, *map(velocity, q), *(one for one in values.values() if isinstance(one, sp.Symbol))}
    return [
        one if isinstance(one, sp.Expr) and one.free_symbols <= known else sp.S.Zero for one in own
    ]


def stated_dissipation(
    letters: Letters, formulas: Sequence[DocumentFormula], values: Mapping[str, Value]
) -> sp.Expr:
    """Rayleigh's function of a document, 0 if there is none: a quadratic form of velocities.

    Its sentence names it, or an equation contains its derivative by a velocity, or its letter is
    usual and its factors are those of no kinetic energy.
    """
    rates = [velocity(values[q]) for q in letters.coordinates if q in values]
    words = {word for formula in formulas for word in formula.words}
    kinetic = {name for name, kind in letters.quantities.items() if kind == "kinetic_energy"}
    inertial = {word for one in formulas if one.subject in kinetic for word in one.words}
    for formula in formulas:
        name, value = formula.subject, values.get(formula.subject)
        is_derived = any(re.fullmatch(rf"d{name}_d\w+_dot", word) for word in words)
        is_usual = name in ("D", "R", "F") and inertial.isdisjoint(
            word for word in formula.words if not order(word) and word != name
        )
        is_named = is_derived or is_usual or RAYLEIGH.search(formula.occurrence.prose)
        if not name or not is_named or name in letters.quantities or not isinstance(value, sp.Expr):
            continue
        forms = (value.diff(a).diff(b) * a * b / 2 for a in rates for b in rates)
        if value.has(*rates) and sp.expand(value - sp.Add(*forms)) == 0:
            return value
    return sp.S.Zero


def stated_system(
    name: str,
    title: str,
    letters: Letters,
    q: Sequence[sp.Symbol],
    matrix: sp.ImmutableDenseMatrix,
    potential: sp.Expr,
    forces: Sequence[sp.Expr] = (),
    others: Sequence[sp.Expr] = (),
) -> System | None:
    """A system by its mass matrix, with the parameters of other values; None if it is none.

    A mass can be larger than others, as M in place of m_1 + m_2 is, and so can letters of the
    diagonal of the matrix alone.
    """
    used = sp.Tuple(matrix, potential, *forces, *others).free_symbols
    names = {valid_name(one): one for one in letters.parameters}
    own = sorted((s for s in used if s.name in names and s not in q), key=str)
    masses = [s for s in own if names[s.name] in letters.of_kind("mass")]
    inner = sp.Tuple(*(matrix[i, j] for i in range(matrix.rows) for j in range(i))).free_symbols
    of_diagonal = [s for s in own if s in sp.Tuple(*matrix.diagonal()).free_symbols - inner]
    for large in ((), *((one,) for one in masses), of_diagonal):
        with suppress(SystemDefinitionError, NotImplementedError, ValueError):
            system = System(
                name, title, [Coordinate(one, "m", "a coordinate") for one in q],
                [Parameter(s, "m" if is_length(names[s.name]) else "1",
                           LARGE if s in large else 1.0, "a parameter") for s in own],
                [StatedInertia(sp.S.One, (sp.S.Zero, sp.S.Zero), matrix)],
                potential=potential, gravity=(sp.S.Zero, sp.S.Zero), forces=[*forces],
            )  # fmt: skip
            derivation(system)
            return system
    return None


def _quadratic_form(
    kinetic: sp.Expr, moving: Sequence[sp.Symbol]
) -> sp.ImmutableDenseMatrix | None:
    """The mass matrix of a kinetic energy, with a row of time if it needs one; None without any."""
    rates = [velocity(one) for one in moving]
    matrix = sp.ImmutableDenseMatrix(sp.hessian(kinetic, rates)) if rates else None
    if matrix is None or matrix.free_symbols & {*rates} or not all(matrix.diagonal()):
        return None
    at_rest = dict.fromkeys(rates, sp.S.Zero)
    if any(matrix[i, i].could_extract_minus_sign() for i in range(len(rates))):
        return None
    row = sp.Matrix([[*(kinetic.diff(rate) for rate in rates), 2 * kinetic]]).xreplace(at_rest)
    if any(row):
        matrix = matrix.row_join(row[:, :-1].T).col_join(row)
    return sp.ImmutableDenseMatrix(matrix.applyfunc(sp.factor_terms))


def has_rotations(system: System, letters: Letters, formulas: Sequence[DocumentFormula]) -> bool:
    """Whether the stated kinetic energy is that of a system and energies of rotations beside it.

    The masses are then those of bodies, of which the document states the centres. An energy of a
    rotation has a moment of inertia, which is no mass.
    """
    own = {one.name: one for one in (*system.q, *system.params)}
    symbols = {name: own.get(one.name, one) for name, one in letter_symbols(letters).items()}
    known = stated_values(letters, formulas, symbols)
    energies = next(stated_energies(letters, formulas, *known), None)
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


def letter_symbols(letters: Letters) -> dict[str, sp.Symbol]:
    """Symbols of the coordinates and parameters of a document, without multipliers."""
    symbols = {q: sp.Symbol(valid_name(q), real=True) for q in letters.coordinates}
    for name in (one for one in letters.parameters if one not in letters.multipliers):
        is_positive = is_length(name) or name in letters.of_kind("mass")
        assumptions = {"positive": True} if is_positive else {"real": True}
        symbols[name] = sp.Symbol(valid_name(name), **assumptions)
    return symbols


def stated_energies(
    letters: Letters,
    formulas: Sequence[DocumentFormula],
    stated: Stated,
    values: Mapping[str, Value],
) -> Iterator[Energies]:
    """Yield kinetic and potential energies that the document states, or that follow from others.

    `stated` and `values` are those of `stated_values`.
    """
    kinetic, potential = (stated.get(f"{kind}_energy", ()) for kind in ("kinetic", "potential"))
    kinetic = [(T, number) for T, number in kinetic if not _has_open_speed(T)]
    for (T, first), (V, second) in product(kinetic, potential):
        yield T, V, frozenset({first, second})
    at_rest = {velocity(values[q]): sp.S.Zero for q in letters.coordinates}
    for kind, sign in (("lagrangian", -1), ("energy", 1), ("hamiltonian", 1)):
        for value, number in stated.get(kind, ()):
            V = sign * value.xreplace(at_rest)
            own = {*WORD.findall(formulas[number].sides[-1].text)}  # such as T in L = T
            others = {k for _, k in (*kinetic, *potential) if formulas[k].subject in own}
            yield sp.expand(value - sign * V), V, frozenset({number, *others})
    yield from energies_of_hamiltonians(letters, formulas, values)
    if not kinetic:
        yield from _sums_of_parts(formulas, values)
        yield from energies_of_matrices(letters, formulas, values, potential)
    if not potential:
        yield from ((T, sp.S.Zero, frozenset({number})) for T, number in kinetic)


def _has_open_speed(kinetic: sp.Expr) -> bool:
    """Whether an energy has a term m*v**2/2 in a speed that no formula states by coordinates."""
    speeds = (s for s in kinetic.free_symbols if SPEED.match(s.name))
    others = {s for s in kinetic.free_symbols if order(s.name)}
    return bool(others) and any(kinetic.diff(s).free_symbols.isdisjoint(others) for s in speeds)


def _sums_of_parts(
    formulas: Sequence[DocumentFormula], values: Mapping[str, Value]
) -> Iterator[Energies]:
    """Yield the sums of energies of parts, such as T_1 and T_2, that no other part contains."""
    parts: dict[str, tuple[sp.Expr, int]] = {}
    words = {one.subject: {*one.words} for one in formulas if energy_of_part(one.subject)}
    for number, formula in enumerate(formulas):
        name = formula.subject
        is_inner = any(name in own for subject, own in words.items() if subject != name)
        if name in words and name not in parts and not is_inner:
            with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
                value = parse(formula.sides[-1].text, values)
                if isinstance(value, sp.Expr) and not isinstance(value, sp.MatrixBase):
                    parts[name] = value, number
    sums = {"kinetic_energy": sp.S.Zero, "potential_energy": sp.S.Zero}
    for name, (value, _) in parts.items():
        sums[str(energy_of_part(name))] += value
    if all(sums.values()):
        numbers = frozenset(number for _, number in parts.values())
        yield sums["kinetic_energy"], sums["potential_energy"], numbers


def stated_values(
    letters: Letters, formulas: Sequence[DocumentFormula], symbols: Mapping[str, sp.Symbol]
) -> tuple[Stated, Mapping[str, Value]]:
    """The energies that formulas state, and the values of letters and names with definitions.

    Coordinates without a symbol are such names.
    """
    moving = [symbols[q] for q in letters.coordinates if q in symbols]

    def rate(value: sp.Expr) -> sp.Expr:
        if value.has(*map(acceleration, moving)):
            raise ValueError("a third derivative")
        pairs = [(one, velocity(one)) for one in moving]
        pairs += [(v, acceleration(one)) for one, v in pairs]
        return sp.Add(*(value.diff(one) * v for one, v in pairs), value.diff(TIME))

    namespace: dict[str, Any] = {**FUNCTIONS, **symbols, "t": TIME, "ddt": rate}
    namespace["transpose"] = lambda matrix: matrix.T
    if letters.column and {*letters.ordered} <= {*symbols}:
        rates = [velocity(symbols[q]) for q in letters.ordered]
        namespace[f"{letters.column}_dot"] = sp.ImmutableDenseMatrix(rates)
    for q in {*letters.coordinates} & {*symbols}:
        one = symbols[q]
        namespace |= {f"{q}_dot": velocity(one), f"{q}_ddot": acceleration(one)}
    for name, (function, angles) in letters.abbreviations.items():
        with suppress(ExpressionError):
            namespace[name] = parse(f"{function}({' + '.join(angles)})", namespace)
    result: dict[str, list[tuple[sp.Expr, int]]] = {}
    for _ in range(ROUNDS):
        for number, formula in enumerate(formulas):
            for name, text in definitions(formula):
                kind = letters.quantities.get(name, "")
                if name in symbols or is_derivative(name) or (name in namespace and not kind):
                    continue
                try:
                    value = parse(text, namespace)
                except (ExpressionError, NotImplementedError, TypeError, ValueError):
                    continue
                if isinstance(value, sp.MatrixBase) and kind and value.shape == (1, 1):
                    value = value[0]
                namespace.setdefault(name, value)
                with suppress(ValueError, AttributeError):
                    namespace.setdefault(f"{name}_dot", rate(value))
                    namespace.setdefault(f"{name}_ddot", rate(namespace[f"{name}_dot"]))
                values = result.setdefault(kind, [])
                is_new = not any(value == one for one, _ in values)
                if kind and is_new and len(values) < MOST and not isinstance(value, sp.MatrixBase):
                    values.append((value, number))
    return result, namespace
