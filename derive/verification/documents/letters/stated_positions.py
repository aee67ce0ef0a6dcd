"""The system that a document states: positions of its masses, gravity, and its potential energy."""

import re
from collections.abc import Iterator, Mapping, Sequence, Set
from itertools import product

import sympy as sp

from derive.formulas.expression import FUNCTIONS, parse
from derive.formulas.syntax import ExpressionError
from derive.system.parts import Coordinate, Parameter, PointMass, SystemDefinitionError
from derive.system.symbols import TIME, velocity
from derive.system.system import System
from derive.verification.documents.formula_translation import order, stem
from derive.verification.documents.letters.candidates import (
    STATED,
    UNITS,
    SystemCandidate,
    constrained,
    frictions,
    loads,
)
from derive.verification.documents.letters.document_system import derivation, drag, valid_name
from derive.verification.documents.letters.energies import (
    stated_dissipation,
    stated_energies,
    stated_values,
)
from derive.verification.documents.letters.letters import KINDS, Letters
from derive.verification.documents.statements import POINT, WORD, DocumentFormula, definitions

#: Names of Cartesian components.
AXES = ("x", "y", "z")
#: Unit vectors along Cartesian axes, and the numbers of these.
UNIT_VECTOR = re.compile(
    r"(?:(?:e|u|\w*hat)_([ijkxyz])(?:_column)?|(i|j|k|imath|jmath|x|y|z)hat(?:_column)?"
    r"|([ijk])_column)\Z"
)
AXIS_NUMBERS = {"i": 0, "imath": 0, "x": 0, "j": 1, "jmath": 1, "y": 1, "k": 2, "z": 2}
#: The names of columns of positions, and of those that are called r.
COLUMN = re.compile(r"(?:vec)?[rRxXpq](?:_(\w+?))?(?:_column)?\Z")
RADIUS = re.compile(r"(?:vec)?[rR](?:_\w+?)?(?:_column)?\Z")


def stated_systems(letters: Letters, formulas: Sequence[DocumentFormula]) -> Iterator[System]:
    """Yield systems with the positions of a document, with its axis upwards or downwards."""
    symbols = {q: sp.Symbol(valid_name(q), real=True) for q in letters.coordinates}
    for name in letters.parameters:
        is_positive = any(name in letters.of_kind(kind) for kind in ("mass", "length"))
        assumptions = {"positive": True} if is_positive else {"real": True}
        symbols[name] = sp.Symbol(valid_name(name), **assumptions)
    points = _points(letters, formulas, symbols)
    masses = [*_masses(points, letters, symbols)]
    gravity = next((symbols[name] for name in letters.of_kind("gravity")), None)
    if not masses:
        return
    positions = sp.Tuple(*(r for mass in masses for r in mass.position)).free_symbols
    q = [symbols[name] for name in letters.coordinates if symbols[name] in positions]
    if not q or any(symbols[name] not in q for name in letters.accelerated):
        return  # the positions are those of a part of the system
    coordinates = [Coordinate(one, "m", "a coordinate") for one in q]
    stated, values = stated_values(letters, formulas, symbols)
    pairs = [*stated_energies(letters, formulas, stated, values)]
    others = {velocity(symbols[name]) for name in letters.coordinates if symbols[name] not in q}
    others |= {symbols[name] for name in letters.of_kind("mass")} - {m.mass for m in masses}
    if pairs and all(T.has(*others) for T, _, _ in pairs):
        return  # further parts move
    energies = [V for _, V, _ in pairs]
    energies += [value for value, _ in stated.get("potential_energy", ())]
    damping = stated_dissipation(letters, formulas, values)
    friction = [-damping.diff(velocity(one)) for one in q]
    axes = (-1, *_verticals(masses, gravity, energies))
    for axis, sign in product(axes, (1, -1) if gravity is not None else (0,)):
        weight = sp.Add(*(sign * (gravity or 0) * m.mass * m.position[axis] for m in masses))
        for potential in _potentials(weight, gravity, energies, positions | weight.free_symbols):
            used = sp.Tuple(potential, *friction, *(m.mass for m in masses)).free_symbols
            used |= positions
            parameters = [
                Parameter(symbols[name], _unit(name, letters), 1.0, "a parameter")
                for name in letters.parameters
                if symbols[name] in used
            ]
            title = "The system that the document states"
            if sign < 0 and weight:  # which formulas alone show, and a sentence can contradict
                title += ", with its vertical axis downwards"
            try:
                system = System(
                    STATED, title, coordinates, parameters,
                    masses, potential=potential, gravity=(sp.S.Zero,) * len(masses[0].position),
                    forces=friction if damping else (),
                )  # fmt: skip
                derivation(system)
            except SystemDefinitionError:  # such as of coordinates that are not independent
                continue
            yield system


def stated_candidates(system: System, letters: Letters) -> Iterator[SystemCandidate]:
    """Yield the candidates of a system in the document's own letters: its forces alone vary."""
    names = {symbol.name: name for name in letters.coordinates for symbol in system.q
             if symbol.name == valid_name(name)}  # fmt: skip
    own = tuple(names[symbol.name] for symbol in system.q)
    n = len(own)
    signs = tuple(tuple(int(i == j) for j in range(n)) for i in range(n))
    parameters = {p.name: name for name in letters.parameters for p in system.params
                  if p.name == valid_name(name)}  # fmt: skip
    has_masses = any(drag(system))  # of stated energies, it is not known what they move
    for forces in loads(letters, "force", n):
        for friction in frictions(letters, n):
            if not has_masses and any(damped == "masses" for _, damped in friction):
                continue
            if {name for name, _ in (*forces, *friction)} & {*parameters.values()}:
                continue  # a letter of the system
            one = SystemCandidate(system, own, signs, (0,) * n, parameters, forces, friction)
            yield from constrained(one, letters)


def axis_of(name: str) -> int | None:
    """The number of the Cartesian axis along which a name is the unit vector; None for others."""
    match = UNIT_VECTOR.match(name)
    return AXIS_NUMBERS[match[match.lastindex or 0]] if match else None


def unit_vectors(formulas: Sequence[DocumentFormula]) -> dict[str, sp.ImmutableDenseMatrix]:
    """The unit vectors of fixed Cartesian axes in formulas; none if one of them is defined."""
    words = {word for one in formulas for word in one.words}
    axes = {word: axis for word in words if (axis := axis_of(stem(word))) is not None}
    moving = {one.subject for one in formulas} | {one for one in words if order(one)}
    if len({*axes.values()}) < 2 or not moving.isdisjoint(axes):
        return {}
    size = 1 + max(axes.values())
    return {
        name: sp.ImmutableDenseMatrix([int(k == axis) for k in range(size)])
        for name, axis in axes.items()
    }


def has_angle(position: sp.MatrixBase) -> bool:
    """Whether a position contains an angle.

    Unit vectors beside one without can be those of a frame that turns.
    """
    return bool(position.has(sp.sin, sp.cos))


def _points(
    letters: Letters, formulas: Sequence[DocumentFormula], symbols: Mapping[str, sp.Symbol]
) -> dict[str, tuple[sp.Expr, ...]]:
    """The positions that formulas define, by the index of their names."""
    known: dict[str, sp.Expr] = {}
    columns: dict[str, tuple[sp.Expr, ...]] = {}
    units = unit_vectors(formulas)
    namespace = {**FUNCTIONS, **symbols, **units, "t": TIME}
    moving = {symbols[q] for q in letters.coordinates}
    stated = {one.subject: one.words for one in formulas}
    for formula in formulas:
        for name, text in definitions(formula):
            if name in known or name in columns or order(name):
                continue
            # components in another frame, by a prime or if the document gives both by each other
            axes = [one for one in WORD.findall(text) if one in AXES]
            if any(name == f"{one}_prime" or name in stated.get(one, ()) for one in axes):
                continue
            try:
                value = parse(text, {**namespace, **known})
            except ExpressionError:
                continue
            if TIME in value.free_symbols and not value.free_symbols & moving:
                namespace.setdefault(name, value)  # an angle that is prescribed
            if not value.free_symbols & moving and value != 0:  # a cart has y_0 = 0
                continue
            if isinstance(value, sp.MatrixBase) and value.cols == 1 and 1 < value.rows < 4:
                in_fixed_frame = units.keys().isdisjoint(formula.words) or has_angle(value)
                if in_fixed_frame and (match := COLUMN.match(name)):
                    columns[match[1] or ""] = tuple(value)
            elif POINT.match(name) and name not in letters.coordinates:
                known[name] = value
    points: dict[str, dict[int, sp.Expr]] = {}
    for name, value in known.items():
        match = POINT.match(name)
        assert match
        axis = AXES.index(match[1].lower())
        points.setdefault(match[2] or "", {})[axis] = value
    # beside a point in the plane, a mass can move along one axis alone
    indices = {name.partition("_")[2] for name in letters.of_kind("mass")} - {""}
    has_plane = any(len(axes) > 1 for axes in points.values())

    def component(index: str, axes: Mapping[int, sp.Expr], k: int) -> sp.Expr:
        name = f"{AXES[k]}_{index}" if index else AXES[k]
        return axes.get(k, symbols[name] if name in letters.coordinates else sp.S.Zero)

    result = {
        index: tuple(component(index, axes, k) for k in range(3 if 2 in axes else 2))
        for index, axes in points.items()
        if (len(axes) > 1 or (has_plane and index in indices))
        and any(value.free_symbols & moving for value in axes.values())
    }
    return result or columns


def _masses(
    points: Mapping[str, tuple[sp.Expr, ...]], letters: Letters, symbols: Mapping[str, sp.Symbol]
) -> Iterator[PointMass]:
    """A mass at each point: that of the same index, or the only one; a cart has the other."""
    names = letters.of_kind("mass")
    if not points or not names:
        return
    left = [*names]
    dimension = max(map(len, points.values()))
    for index, position in points.items():
        same = [n for n in names if n.partition("_")[2] == index or (index and n.endswith(index))]
        chosen = (same or left or names)[0]
        if chosen in left:
            left.remove(chosen)
        position = (*position[:-1], *[sp.S.Zero] * (dimension - len(position)), position[-1])
        yield PointMass(symbols[chosen], position)
    lines = [q for q in letters.coordinates if q.partition("_")[0] in ("x", "s", "X")]
    is_missing = not any(position[-1] == 0 for position in points.values())
    if len(left) == 1 and lines and dimension == 2 and is_missing:
        yield PointMass(symbols[left[0]], (symbols[lines[0]], sp.S.Zero))


def _verticals(
    masses: Sequence[PointMass], gravity: sp.Symbol | None, energies: Sequence[sp.Expr]
) -> Iterator[int]:
    """Yield the axes but for the last along which a stated potential energy has the weight."""
    for axis in range(len(masses[0].position) - 1 if gravity is not None else 0):
        weight = sp.Add(*(gravity * m.mass * m.position[axis] for m in masses))
        rests = (sp.expand(V - sign * weight) for V in energies for sign in (1, -1))
        if weight and any(gravity not in rest.free_symbols for rest in rests):
            yield axis


def _potentials(
    weight: sp.Expr, gravity: sp.Symbol | None, stated: Sequence[sp.Expr], own: Set[sp.Basic]
) -> Iterator[sp.Expr]:
    """Yield the weight, and the stated potential energies that contain it and springs.

    Beside springs with letters of their own, the weight alone is one only if it is stated, too.
    """
    known = [weight]
    for value in stated:
        rest = sp.expand(value - weight)
        is_new = all(sp.expand(value - one) != 0 for one in known)
        if is_new and (gravity is None or gravity not in rest.free_symbols):
            known.append(value)
    is_stated = any(sp.expand(value - weight) == 0 for value in stated)
    has_springs = any((value - weight).free_symbols - own for value in known[1:])
    yield from known[1:] if has_springs and not is_stated else known


def _unit(name: str, letters: Letters) -> str:
    kinds = {kind: unit for unit, kind in reversed(UNITS.items())}
    return next((kinds[k] for k in KINDS if k in kinds and name in letters.of_kind(k)), "1")
