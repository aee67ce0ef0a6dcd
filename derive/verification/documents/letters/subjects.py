"""The subjects of a document, and what it implies: all that precedes the meaning of letters.

Subjects are examples with energies of their own, and cases of positions. Implied are rates without
dots, as v and a of a place and those of Euler's equations, and potentials such as V(r).
"""

import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import accumulate, chain, combinations_with_replacement, takewhile

from derive.reading.document import below_each
from derive.reading.latex.tree import Application, Letter, Statement, nodes
from derive.verification.documents.formula_translation import FormulaText, order, stem
from derive.verification.documents.letters.letter_roles import equal_letters, letters_of
from derive.verification.documents.letters.letters import ANGLES, QUANTITIES, Letters
from derive.verification.documents.statements import (
    IMPLIED,
    PLACE,
    POINT,
    WORD,
    DocumentFormula,
    Occurrence,
    Translated,
)

#: Most cases of a document with positions of their own.
MAX_CASES = 6
#: Letters of accelerations and of velocities, of velocities along a line, and of places.
ACCELERATION, VELOCITY = re.compile(r"a(?:_\w+)?\Z"), re.compile(r"(?:omega|w|v|u)(?:_\w+)?\Z")
#: A load in an equation of motion.
LOAD = re.compile(r"u|tau|F|f")
#: Letters of the coefficients of potentials, and the degree of these.
ARBITRARY, DEGREE = "arbitrary", 3
#: A relation of two coordinates.
RELATION = re.compile(r"(\w+) \+ (\w+) = (\w+)")
SPEEDS, PLACES = ("v", "u"), ("s", "x", "y", "z", "X", "Y")
#: Energies from which equations of motion follow.
STATING = ("kinetic_energy", "potential_energy", "lagrangian")

Formulas = tuple[DocumentFormula, ...]


def subjects(text: str, statements: Translated) -> list[Formulas]:
    """The formulas of each subject of a document, in order.

    Those before a special case, such as m_1 = m_2 = m, are a subject of their own as well.
    """
    return _with_cases(_examples(text, statements))


def restated_subjects(text: str, statements: Translated) -> list[Formulas]:
    """The formulas of each subject if another one begins where an energy is stated anew.

    That is after an equation of motion or, by another value, below another heading. What is below
    the first heading after the equation, or after the energy before, belongs to it, or positions
    just before.
    """
    letters = letters_of(statements.formulas, statements.derivatives)
    parts = [
        own
        for part in _examples(text, statements)
        for own in _divided_at_energies(text, part, letters)
    ]
    return _with_cases(parts)


def _with_cases(examples: Iterable[Formulas]) -> list[Formulas]:
    """The formulas of each case of examples, and those before special cases."""
    parts = [case for part in examples for case in _cases(part)]
    return [one for part in parts for one in (*_before_equalities(part), part)]


def _divided_at_energies(text: str, formulas: Formulas, letters: Letters) -> Iterator[Formulas]:
    """Yield the formulas before and after each energy that is stated anew."""
    sections = below_each(text, formulas, lambda one: one.occurrence.start)
    headings = [*accumulate(map(len, sections))]
    rates = {f"{name}_dot" for name in letters.momenta}
    velocities = {f"{name}_dot" for name in letters.momenta.values()}
    start, equation, canonical, energy, known = 0, -1, -1, -1, dict[str, set[str]]()
    for number, formula in enumerate(formulas):
        stated = formula.sides[-1].text
        if kind := letters.quantities.get(formula.subject):
            after_energy = [k for k in headings if max(start, energy) < k <= number]
            begins = [k for k in after_energy if k > equation] or after_energy
            is_other = stated not in known.get(formula.subject, {stated})
            is_after = equation >= start and (is_other or kind in STATING)
            is_after |= canonical >= start and is_other and kind in STATING
            if is_after or (is_other and begins):
                before = formulas[start:number][::-1]
                places = [*takewhile(_is_position, before)]
                first = begins[0] if begins else number - len(places)
                yield formulas[start:first]
                start, known = first, {}
            known.setdefault(formula.subject, set()).add(stated)
            energy = number
        if formula.subject in rates or any(order(word) == 2 for word in formula.words):
            equation = number
        elif formula.subject in velocities:
            canonical = number
    yield formulas[start:]


def _is_position(formula: DocumentFormula) -> bool:
    """Whether a formula states a component of a position."""
    return bool(POINT.match(formula.subject)) and not order(formula.subject)


def _before_equalities(formulas: Formulas) -> Iterator[Formulas]:
    """The formulas before parameters are set equal, without those with their common letter.

    A slip of an index can only be found by these.
    """
    for number, formula in enumerate(formulas):
        equal = equal_letters(formula)
        if equal:
            common = {name for name in equal if "_" not in name}
            before = tuple(one for one in formulas[:number] if common.isdisjoint(one.words))
            if any(one.subject in QUANTITIES for one in before):
                yield before
            return


def _examples(text: str, statements: Translated) -> Iterator[Formulas]:
    """Yield the formulas of examples below headings of their own.

    An example begins below a heading with an energy that has been stated before, but has no
    coordinate in common with the energies since, but for places that it states by others. Relations
    of its coordinates alone just before belong to it.
    """
    letters = letters_of(statements.formulas, statements.derivatives)
    example, seen = list[Formulas](), dict[str, set[str]]()
    for part in below_each(text, statements.formulas, lambda one: one.occurrence.start):
        own: dict[str, set[str]] = {}
        places = {one.subject: _moving(one, letters) for one in part if POINT.match(one.subject)}
        for formula in part:
            if formula.subject in letters.quantities:
                moving = {
                    one for name in _moving(formula, letters) for one in places.get(name) or {name}
                }
                if moving:
                    own.setdefault(formula.subject, set()).update(moving)
        before, after = (set[str]().union(*one.values()) for one in (seen, own))
        if {*own} & {*seen} and before.isdisjoint(after):
            named = ({stem(word) for one in each for word in one.words} for each in example[::-1])
            are_new = [bool(one & after) and not one & before for one in named]
            count = len(example) - len([*takewhile(bool, are_new)])
            yield tuple(chain.from_iterable(example[:count]))
            example, seen = example[count:], {}
        example.append(tuple(part))
        for name, moving in own.items():
            seen.setdefault(name, set()).update(moving)
    yield tuple(chain.from_iterable(example))


def _moving(formula: DocumentFormula, letters: Letters) -> set[str]:
    """The coordinates of the last side of a formula."""
    words = {stem(word) for word in WORD.findall(formula.sides[-1].text)}
    return words & {*letters.coordinates}


def _cases(formulas: Sequence[DocumentFormula]) -> list[Formulas]:
    """The formulas of cases with positions of their own, such as (a), (b) and (c).

    A case begins where a component of a position is defined anew, and states an energy.
    """
    cases, known = [list[DocumentFormula]()], dict[str, str]()
    for formula in formulas:
        name, text = formula.subject, formula.sides[-1].text
        if POINT.match(name) and known.get(name, text) != text:
            before = cases[-1]
            others = takewhile(lambda one: POINT.match(one.subject), reversed(before))
            own = [*others][::-1]  # positions just before, which belong to it
            cases[-1] = before[: len(before) - len(own)]
            cases.append(own)
            known = {one.subject: one.sides[-1].text for one in own}
        if POINT.match(name):
            known[name] = text
        cases[-1].append(formula)
    has_energies = all(any(one.subject in QUANTITIES for one in case) for case in cases)
    are_cases = has_energies and len(cases) <= MAX_CASES
    return [tuple(case) for case in cases] if are_cases else [tuple(formulas)]


def with_loads_behind(statements: Translated) -> Translated:
    """The statements with equations such as u = m*x_ddot the other way round.

    The letter of a load that nothing else defines is no name for what balances it.
    """
    defined = Counter(one.subject for one in statements.formulas)

    def turned(one: DocumentFormula) -> DocumentFormula:
        is_load = LOAD.fullmatch(one.subject) and defined[one.subject] == 1
        if not is_load or len(one.sides) != 2 or 2 not in map(order, one.words):
            return one
        return replace(one, sides=one.sides[::-1])

    return replace(statements, formulas=tuple(map(turned, statements.formulas)))


def of_single_coordinates(statements: Translated, formulas: Formulas) -> list[Formulas]:
    """The equations of motion that contain one coordinate, by this coordinate."""
    letters = letters_of(formulas, statements.derivatives)
    result: dict[str, list[DocumentFormula]] = {}
    for one in formulas:
        moving = {*map(stem, one.words)} & {*letters.coordinates}
        if len(moving) == 1 and 2 in map(order, one.words):
            result.setdefault(moving.pop(), []).append(one)
    return [*map(tuple, result.values())]


def implied_rates(statements: Translated) -> Translated:
    """The statements after such that make a letter the rate of a place, as a is in F = m*a.

    These are accelerations of a document without rates, and velocities without places: those of
    Euler's equations, and any letters of equations of first order. Beside energies in rates, they
    are v, a and alpha alone, and components of velocities such as v_x2.
    """
    letters = letters_of(statements.formulas, statements.derivatives)
    words = Counter(word for one in statements.formulas for word in one.words)
    energies = (one for one in statements.formulas if one.subject in letters.quantities)
    has_rates = any(order(word) for one in energies for word in one.words)
    rates = {stem(name) for name in words if order(name)}
    has_powers = any("_dot**" in one.text for one in statements.formulas)
    is_first = rates == {*letters.coordinates} and {*map(order, words)} == {0, 1} and not has_powers
    are_velocities = is_first and not has_rates and all(map(VELOCITY.match, rates))
    if "kinetic_energy" in letters.quantities.values() and not are_velocities:
        places = _implied_places(letters, statements.formulas)
        named = _unnamed(letters, statements.formulas)
        return _with_components(_with_rates(statements, (*named, *places)))
    if (letters.quantities and not are_velocities) or letters.momenta or statements.derivatives:
        return statements
    if not letters.coordinates:
        has_mass = bool(letters.of_kind("mass"))
        names = [name for name in words if ACCELERATION.match(name) and words[name] > 1] * has_mass
        ending = "_ddot"
    else:
        second = {stem(name) for name in words if order(name) > 1}
        has_places = any(not name.startswith("omega") for name in second)
        names = [
            name
            for name in letters.coordinates
            if is_first or (VELOCITY.match(name) and not has_places)
        ]
        ending = "_dot"
    return _with_rates(statements, ((f"{PLACE}{one}{ending}", one) for one in names))


def _implied_places(
    letters: Letters, formulas: Sequence[DocumentFormula]
) -> Iterator[tuple[str, str]]:
    """Yield coordinates that relations such as x_1 + x_2 = c give, and their formulas.

    They have no acceleration and no definition, unlike the other one.
    """
    subjects = {one.subject for one in formulas}
    for formula in formulas:
        match = RELATION.fullmatch(formula.text)
        names = match and {match[1], match[2]}
        others = {*letters.coordinates} - {*letters.accelerated} - subjects
        if match and names and names <= {*letters.coordinates} and len(names & others) == 1:
            (name,) = names & others
            (other,) = names - {name}
            if match[3] in letters.parameters and other in letters.accelerated:
                yield name, f"{match[3]} - {other}"


def _with_rates(statements: Translated, pairs: Iterable[tuple[str, str]]) -> Translated:
    return replace(statements, formulas=(*_implied(pairs), *statements.formulas))


def _implied(pairs: Iterable[tuple[str, str]]) -> Iterator[DocumentFormula]:
    """Yield equations that are not written, by their sides."""
    place = Occurrence(IMPLIED, 0, 0, 0, 0, "", Statement((), (), (0, 0)))
    for left, right in pairs:
        yield DocumentFormula(place, (FormulaText(left), FormulaText(right)), ("=",))


def _unnamed(letters: Letters, formulas: Sequence[DocumentFormula]) -> Iterator[tuple[str, str]]:
    """Yield the rates v and a of a place in positions that has no dots, and alpha of an angle."""
    counts = Counter(word for one in formulas for word in one.words)
    kinetic, positions = set[str](), set[str]()
    for one in formulas:
        if letters.quantities.get(one.subject) == "kinetic_energy":
            kinetic |= {*one.words}
        if POINT.match(one.subject):
            positions |= {*one.words}
    places = [name for name in PLACES if name in positions and name in letters.parameters]
    speeds = [name for name in SPEEDS if name in kinetic and name in letters.parameters]
    angles = [q for q in letters.coordinates if q.partition("_")[0] in ANGLES[:-1]]
    if len(places) == 1 == len(speeds):
        yield f"{places[0]}_dot", speeds[0]
        if counts["a"] > 1:
            yield f"{places[0]}_ddot", "a"
        if len(angles) == 1 and counts["alpha"] > 1 and not counts[f"{angles[0]}_ddot"]:
            yield f"{angles[0]}_ddot", "alpha"


def _with_components(statements: Translated) -> Translated:
    """The statements, with v_x2 as the rate of a position x_2 behind the formula of this."""
    formulas = statements.formulas
    stated = Counter(one.subject for one in formulas if POINT.match(one.subject))
    words = {word for one in formulas for word in one.words}
    result = list[DocumentFormula]()
    for formula in formulas:
        result.append(formula)
        name = formula.subject
        axis, _, index = name.partition("_")
        if index and stated[name] == 1 and f"{name}_dot" not in words:
            spellings = {f"v_{axis}{index}", f"v_{axis}_{index}", f"v_{index}{axis}"}
            result += _implied((one, f"{name}_dot") for one in sorted(spellings & words))
    return replace(statements, formulas=tuple(result))


def with_arbitrary_potentials(statements: Translated) -> Translated:
    """The statements, with polynomials for potentials of which they state the variables alone.

    An equation with V(r) and its first derivatives that holds for any polynomial holds for any
    function. These polynomials are no formulas of the document, and stand behind them.
    """
    formulas = statements.formulas
    letters = letters_of(formulas, statements.derivatives)
    of_energies = {
        word
        for one in formulas
        if letters.quantities.get(one.subject) in ("lagrangian", "energy", "hamiltonian")
        for word in one.words
    }
    sides = ((one.subject, side.text) for one in formulas for side in one.sides[1:])
    of_energies -= {subject for subject, text in sides if subject != text}
    potentials = [one for one in sorted(of_energies) if QUANTITIES.get(one) == "potential_energy"]
    pairs: list[tuple[str, str]] = []
    for name in potentials:
        variables = [q for q in letters.coordinates if q in _variables(name, statements)]
        if not variables:
            continue
        monomials = (
            "*".join(one)
            for degree in range(1, DEGREE + 1)
            for one in combinations_with_replacement(variables, degree)
        )
        terms = (f"{ARBITRARY}_{name}_{k}*{one}" for k, one in enumerate(monomials, 1))
        pairs.append((name, " + ".join(terms)))
        if len(variables) == 1:
            derivative = f"d{name}_d{variables[0]}"
            pairs.append((f"{name}_prime", derivative))
            own = {**statements.derivatives, derivative: (name, (variables[0],))}
            statements = replace(statements, derivatives=own)
    return replace(statements, formulas=(*formulas, *_implied(pairs)))


def has_arbitrary_potential(names: Collection[str]) -> bool:
    """Whether coefficients of such a potential are among the letters of a system."""
    return any(one.startswith(ARBITRARY) for one in names)


def _variables(name: str, statements: Translated) -> set[str]:
    """The letters of which a document writes a name as a function, or by which it derives it."""
    result = set[str]()
    for formula in statements.formulas:
        for node in nodes(formula.occurrence.sides):
            match node:
                case Application(head=Letter(identifier=own), arguments=arguments) if own == name:
                    result.update(one.identifier for one in arguments if isinstance(one, Letter))
        for word in formula.words:
            operand, variables = statements.derivatives.get(word, ("", ()))
            result.update(variables if operand == name else ())
    return result
