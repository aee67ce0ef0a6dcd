"""The roles of letters in a document: which of them move, are defined, or are parameters."""

import re
from collections import Counter, defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import islice, permutations

import sympy as sp

from derive.formulas.expression import FUNCTIONS, parse
from derive.formulas.syntax import ExpressionError
from derive.verification.documents.formula_translation import order, stem
from derive.verification.documents.letters.letters import (
    ABBREVIATION,
    ANGLES,
    COLUMN,
    GENERIC,
    KINDS,
    OPERATORS,
    Letters,
    energy_of_part,
    matrices_by_entries,
)
from derive.verification.documents.letters.quantities import (
    matrices_of,
    partners,
    quantities_of,
    resting_functions,
    routhians,
)
from derive.verification.documents.letters.stated_constraints import (
    multipliers_of,
    stated_constraints,
)
from derive.verification.documents.statements import (
    POINT,
    SQUARE,
    WORD,
    DocumentFormula,
    entries_of_chain,
    is_motion_of_several,
)

#: A letter with a number.
INDEXED = re.compile(r"[A-Za-z]+_\d+")
#: A product of two letters.
PRODUCT = re.compile(r"\b(\w+)\*(\w+)\b")
#: The sine or cosine of a difference of two angles.
DIFFERENCE = re.compile(r"(?:sin|cos)\(\w+ - \w+\)")
#: A number, perhaps with a unit.
NUMBER = re.compile(r"[\d.]+(?:\*\*?(?:kg|cm|mm|rad|deg|circ|Hz|J)\b.*)?|\d+\.\d+\*[msN]\b.*")
#: An angle from another direction.
TURNED_ANGLE = re.compile(r"(?:(?=\w+ \+ pi\Z)|pi [+-] )(\w+)(?: \+ pi)?")
#: A function of an angle and its argument.
TURNED = re.compile(r"\b(?:sin|cos|tan)\([^()]*\)")
#: The sine or cosine of a letter.
TURNED_LETTER = re.compile(r"\b(sin|cos)\((\w+)\)")
#: Orders of the rows of a matrix that are tried.
MAX_ORDERS = 6


def letters_of(
    formulas: Sequence[DocumentFormula], derivatives: Mapping[str, tuple[str, tuple[str, ...]]]
) -> Letters:
    """The letters of all formulas, and of names such as ``dL_dtheta``."""
    words: Counter[str] = Counter()
    for formula in formulas:
        for name in formula.words:
            if name not in OPERATORS:
                operand, variables = derivatives.get(name, (name, ()))
                words.update((operand, *variables))
    stems = list(dict.fromkeys(map(stem, words)))
    orders = {one: max(order(name) for name in words if stem(name) == one) for one in stems}
    orders |= dict.fromkeys(_angles_of_moving_points(formulas, orders), 1)
    quantities = quantities_of(formulas, derivatives, stems)
    defined = _defined(formulas, orders)
    varied = {stem(v) for _, variables in derivatives.values() for v in variables}
    resting = _resting(formulas)
    moving = [
        one
        for one in stems
        if (orders[one] or one in varied)
        and one not in resting
        and one not in {*quantities, *defined, "t"}
        and not GENERIC.match(one)
        and not one.endswith("_column")
    ]
    functions = resting_functions(formulas, moving)
    quantities |= partners(quantities, functions)
    matrices = {*matrices_of(formulas), *matrices_by_entries(stems)}
    turned = _turned_angles(formulas, moving)
    columns = _columns(formulas, (*moving, *turned), matrices)
    generic = _generic(formulas, derivatives) | columns
    moving = [one for one in moving if one not in generic] or moving
    momenta = {}
    displacements = {w for one in formulas if one.is_displacement for w in one.words}
    displacements -= {one.subject for one in formulas}
    main = [one for one in moving if one not in displacements] or moving
    for one in stems:
        coordinate = _coordinate(one, main) if orders[one] < 2 else None
        if one not in {*quantities, *functions} and coordinate is not None:
            momenta[one] = coordinate
    # beside p, P can be a power
    momenta = {p: q for p, q in momenta.items() if p == p.lower() or p.lower() not in momenta}
    quantities |= routhians(formulas, momenta)
    # c of c_1 = c_2 = c is no further parameter, nor is c_3 of c_1 = c_2 = c_3 = c
    equal = [one for one in formulas if equal_letters(one)]
    defined |= {
        side.text for one in equal for k, side in enumerate(one.sides)
        if k > 1 or "_" not in side.text
    }  # fmt: skip
    defined -= {*quantities}
    coordinates = [one for one in moving if one not in momenta]
    coordinates.sort(key=lambda one: (-orders[one], stems.index(one)))
    if all(re.fullmatch(r"q_\d", one) for one in coordinates):
        # with abbreviations such as s_1, angles need not be written
        indices = {i for one in stems if ABBREVIATION.match(one) for i in re.findall(r"\d", one)}
        coordinates += [q for i in sorted(indices) if (q := f"q_{i}") not in coordinates]
    # a document can define r by other coordinates, and go on with r alone
    accelerated = tuple(one for one in coordinates if orders.get(one) == 2)
    related = {*_related(formulas, {*quantities}, coordinates), *turned}
    coordinates += [one for one in stems if orders[one] == 2 and one in defined - related]
    known = {*quantities, *defined, *moving, *momenta, "t"}
    parameters = [
        one
        for one in stems
        if one not in {*known, *columns} and not GENERIC.match(one) and not one.endswith("_column")
    ]
    abbreviations = _abbreviations(stems, coordinates, formulas)
    used = {*abbreviations, *matrices_by_entries(stems)}
    parameters = [one for one in parameters if one not in used]
    ordered, *others = _orders(formulas, coordinates, stems, turned)
    energies = {
        name for name, kind in quantities.items() if kind in ("kinetic_energy", "potential_energy")
    }
    of_energies = {word for one in formulas if one.subject in energies for word in one.words}
    is_parameter = any(
        name in of_energies or _is_inertial(name, formulas) for name in multipliers_of(stems)
    )
    multipliers = () if is_parameter else multipliers_of(stems)
    lengths = [one for one in parameters if one.partition("_")[0] in KINDS["length"]]
    constraints = stated_constraints(
        formulas, coordinates, parameters, multipliers, derivatives, lengths
    )
    if multipliers and not constraints:  # lambda = k/m defines another quantity
        multipliers = multipliers_of(parameters)
    return Letters(
        tuple(coordinates), momenta, quantities, tuple(parameters), accelerated, abbreviations,
        ordered, tuple(others), multipliers=multipliers, constraints=constraints,
        turning=frozenset(_turning(formulas, coordinates)),
    )  # fmt: skip


def _angles_of_moving_points(
    formulas: Iterable[DocumentFormula], orders: Mapping[str, int]
) -> Iterator[str]:
    """Yield the angles by whose sine and cosine alone components of a point with rates are given.

    They move with the point, even if no formula has their rates: x = l*sin(theta) and
    y = -l*cos(theta) beside x_ddot.
    """
    points = defaultdict[str, dict[str, set[str]]](lambda: defaultdict(set))
    for formula in formulas:
        point = POINT.match(formula.subject)
        if point and orders.get(formula.subject) and len(formula.sides) == 2:
            text = formula.sides[1].text
            angles = TURNED_LETTER.findall(text)
            others = {*WORD.findall(text)} - {*FUNCTIONS} - {angle for _, angle in angles}
            first = {name.partition("_")[0].rstrip("0123456789") for name in others}
            if first <= {*KINDS["length"], *"xyzXYZ"}:
                for function, angle in angles:
                    points[point[2] or ""][angle].add(function)
    for angles_of_point in points.values():
        for angle, functions in angles_of_point.items():
            is_angle = angle.partition("_")[0] in ANGLES
            if is_angle and functions == {"sin", "cos"} and not orders.get(angle):
                yield angle


def _turning(formulas: Iterable[DocumentFormula], coordinates: Sequence[str]) -> Iterator[str]:
    """Yield the coordinates that stand in nothing but sines, cosines and tangents."""
    texts = [side.text for one in formulas for side in one.sides]
    outside = {name for text in texts for name in WORD.findall(TURNED.sub("", text))}
    inside = {name for text in texts for one in TURNED.findall(text) for name in WORD.findall(one)}
    yield from (q for q in coordinates if q in inside - outside)


def equal_letters(formula: DocumentFormula) -> set[str]:
    """The names of a special case, such as m_1 = m_2 = m: a letter with numbers, and alone."""
    names = {side.text for side in formula.sides}
    indexed = {name for name in names if INDEXED.fullmatch(name)}
    is_case = len(indexed) > 1 and len({name.partition("_")[0] for name in names}) == 1
    return names if is_case and {*formula.relations} == {"="} else set()


def _orders(
    formulas: Iterable[DocumentFormula],
    coordinates: Sequence[str],
    stems: Sequence[str],
    turned: Mapping[str, str],
) -> Iterator[tuple[str, ...]]:
    """Orders of coordinates: of a column of them, of their indices, or any, from the first use."""
    for formula in formulas:
        for column in COLUMN.findall(formula.text):
            written = map(stem, column.split(", "))
            names = [turned.get(name, name) for name in written]
            if set(names) <= set(coordinates) and len(set(names)) == len(names):
                yield (*names, *(q for q in coordinates if q not in names))
                return
    if len({q.partition("_")[0] for q in coordinates}) == 1:
        yield tuple(sorted(coordinates))
        return
    used = sorted(coordinates, key=lambda q: stems.index(q) if q in stems else 0)
    yield from islice(permutations(used), MAX_ORDERS)


def _generic(
    formulas: Iterable[DocumentFormula], derivatives: Mapping[str, tuple[str, tuple[str, ...]]]
) -> set[str]:
    """Names such as q_1 that only statements with an index have, such as that about all q_i."""
    result: dict[bool, set[str]] = {True: set(), False: set()}
    for formula in formulas:
        for name in formula.words:
            operand, variables = derivatives.get(name, (name, ()))
            result[bool(formula.index)].update(map(stem, (operand, *variables)))
    return result[True] - result[False]


def _columns(
    formulas: Sequence[DocumentFormula], moving: Sequence[str], matrices: Collection[str]
) -> set[str]:
    """Names such as x that stand for a column of x_1, x_2 ... beside a matrix: M*x_ddot.

    And those that are defined as a column of coordinates, or are one with another value, as x_d,
    or stand for any of them in a single formula, as x of x_ddot = -omega**2*x.
    """
    columns = {name for name in moving if f"{name}_1" in moving}
    factors = {
        stem(factor)
        for formula in formulas
        for matrix, factor in PRODUCT.findall(formula.text)
        if matrix in matrices
    }
    for formula in formulas:
        if {*formula.words}.isdisjoint(matrices) and "[[" not in formula.text:
            columns -= {stem(word) for word in formula.words} - factors
    single = Counter(name for one in formulas for name in {*map(stem, one.words)})
    columns |= {name for name in moving if {f"{name}_1", f"{name}_2"} <= {*moving}
                and single[name] == 1}  # fmt: skip
    columns |= {
        one for name in columns & factors for one in moving
        if one.startswith(f"{name}_") and not INDEXED.match(one)
    }  # fmt: skip
    for formula in formulas:
        entries = {one.text for one in formula.sides[-1].entries}
        if entries and formula.subject in moving and entries <= {*moving} - {formula.subject}:
            columns.add(formula.subject)
    return columns


def _abbreviations(
    names: Iterable[str], coordinates: Sequence[str], formulas: Iterable[DocumentFormula]
) -> dict[str, tuple[str, tuple[str, ...]]]:
    """Names such as s_1 and c_12, if there are sines and cosines.

    Documents can define those of several angles by differences, as cos(q_1 - q_2).
    """
    stated = {one.subject: one.sides[-1].text for one in formulas}
    names = [one for one in names if not DIFFERENCE.fullmatch(stated.get(one, ""))]
    result: dict[str, tuple[str, tuple[str, ...]]] = {}
    for name in names:
        if match := ABBREVIATION.match(name):
            indices = re.findall(r"\d", match[2])
            angles = [q for i in indices for q in coordinates if q.partition("_")[2] == i]
            if len(angles) == len(indices):
                result[name] = {"s": "sin", "c": "cos"}[match[1]], tuple(angles)
    return result if len({function for function, _ in result.values()}) == 2 else {}


def _resting(formulas: Iterable[DocumentFormula]) -> set[str]:
    """Letters of which the rates vanish, as ``l_dot = 0`` states, and occur nowhere else."""
    stated, others = set[str](), set[str]()
    for formula in formulas:
        rates = {stem(word) for word in formula.words if order(word)}
        *first, last = (side.text for side in formula.sides)
        (stated if last == "0" and all(map(str.isidentifier, first)) else others).update(rates)
    return stated - others


def _is_inertial(name: str, formulas: Iterable[DocumentFormula]) -> bool:
    """Whether a letter is a factor of products of velocities, as no multiplier of a force is."""
    for text in (side.text for one in formulas if name in one.words for side in one.sides):
        slope = _slope(text, name)
        rates = [one for one in slope.free_symbols if order(one.name) == 1]
        if any(slope.diff(one).has(*rates) for one in rates):
            return True
    return False


def _slope(text: str, name: str) -> sp.Expr:
    """The derivative of a formula by a letter; 0 where it cannot be formed."""
    symbols = {word: sp.Symbol(word) for word in WORD.findall(text)}
    with suppress(ExpressionError, NotImplementedError, AttributeError, TypeError):
        return parse(text, {**symbols, **FUNCTIONS}).diff(sp.Symbol(name))
    return sp.S.Zero


def _defined(formulas: Iterable[DocumentFormula], orders: Mapping[str, int]) -> set[str]:
    """Names that a formula in others defines, but for solutions such as theta = a*cos(omega*t)."""
    defined = set[str]()
    mechanical = _mechanical(formulas, orders)
    equal = [{side.text for side in one.sides} for one in formulas]
    for formula in formulas:
        defined.update(entry for entry, _ in entries_of_chain(formula))
        name = formula.subject
        others = {stem(word) for side in formula.sides[1:] for word in WORD.findall(side.text)}
        others -= OPERATORS
        moves = any(orders.get(one) for one in others)
        is_solution = orders.get(name) and not moves
        # x = p_x/m has lost a dot: no coordinate is defined by its own momentum
        lost_dot = orders.get(name) and any(_coordinate(one, [name]) for one in others)
        # so has phi = w beside phi_dot = w
        lost_dot = lost_dot or any({f"{name}_dot", one} in equal for one in others)
        last = formula.sides[-1]
        is_displaced = orders.get(name) == 2 and formula.is_displacement
        if NUMBER.fullmatch(last.text) or is_motion_of_several(formula):  # such as m = l = 1
            continue
        if last.entries and orders.get(name) == 2:  # the state (x, x_dot) is often called x, too
            continue
        # m_2 = h*f(t, w) is about another quantity with the name of a mass
        is_foreign = name in mechanical and not moves and not others <= mechanical
        is_foreign &= not equal_letters(formula)
        if (
            name
            and not order(name)
            and name not in others
            and not (is_solution or lost_dot or is_foreign or is_displaced)
        ):
            defined.add(name)
        # theta_dot = omega defines omega
        is_name = last.text.isidentifier() and not order(last.text) and len(formula.sides) == 2
        if name and order(name) and is_name and orders.get(last.text, 0) < 2:
            defined.add(last.text)
        # v_1**2 = x_dot**2 + y_dot**2 defines a speed, omega**2 = g/l a frequency
        square = SQUARE.fullmatch(formula.sides[0].text)
        is_new = square and not orders.get(square[1]) and square[1] not in others
        if square and others and is_new and not formula.is_special_case:
            defined.add(square[1])
    return defined


def _turned_angles(formulas: Iterable[DocumentFormula], moving: Collection[str]) -> dict[str, str]:
    """Angles from another direction, as theta = pi + phi, and the coordinates that give them."""
    pairs = ((one.subject, TURNED_ANGLE.fullmatch(one.sides[-1].text)) for one in formulas)
    return {name: match[1] for name, match in pairs if name and match and match[1] in moving}


def _related(
    formulas: Sequence[DocumentFormula], energies: Collection[str], coordinates: Collection[str]
) -> set[str]:
    """Names that a coordinate gives, as x = R*theta does, if energies have the rates of both."""
    own = [one for one in formulas if one.subject in energies or energy_of_part(one.subject)]
    rates = {stem(word) for one in own for word in one.words if order(word)}
    result = set[str]()
    for formula in formulas:
        words = WORD.findall(formula.sides[-1].text)
        others = rates & {*words} & {*coordinates} - {formula.subject}
        if formula.subject in rates and len(others) == 1:
            (other,) = others
            slope = _slope(formula.sides[-1].text, other)
            if slope and not slope.has(sp.Symbol(other)):
                result.add(formula.subject)
    return result


def _mechanical(formulas: Iterable[DocumentFormula], orders: Mapping[str, int]) -> set[str]:
    """Names in formulas with letters that move."""
    words = [{stem(word) for word in formula.words} - OPERATORS for formula in formulas]
    return {name for one in words if any(orders.get(word) for word in one) for name in one}


def _coordinate(name: str, moving: Sequence[str]) -> str | None:
    """The coordinate of a momentum, such as p_theta_1, p_1 or p."""
    letter, _, index = name.partition("_")
    if letter not in ("p", "P", "Pi"):
        return None
    others = [one for one in moving if one.partition("_")[0] not in ("p", "P", "Pi")]
    if index in others:
        return index
    if not index and len(others) == 1:
        return others[0]
    numbered = [one for one in others if index and one.endswith(index)]
    return numbered[0] if numbered else None
