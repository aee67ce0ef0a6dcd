"""The quantities among a document's letters: energies, functions of Lagrange, and matrices."""

import re
from collections.abc import Collection, Iterable, Mapping, Sequence

import sympy as sp

from derive.formulas.expression import FUNCTIONS, parse
from derive.formulas.syntax import ExpressionError
from derive.verification.documents.formula_translation import FormulaText, order, stem
from derive.verification.documents.letters.letters import (
    COLUMNS,
    ENERGIES,
    MATRICES,
    QUANTITIES,
    SQUARES,
    TOTAL,
    energy_of_part,
    matrices_by_entries,
)
from derive.verification.documents.statements import GRAVITY, PLACE, WORD, DocumentFormula

#: Letters of momenta.
MOMENTUM = re.compile(r"(?:[pP]|Pi)(?:_|\Z)")
#: Letters of potential energies beside those of kinetic ones; alone they can be momenta.
PARTNERS = {"K": ("P", "Pi")}
#: A multiple of a quantity on the left, such as that in 2 T = m v**2.
MULTIPLE = re.compile(r"\d+\*(\w+)")
#: A sum or difference of two names, such as T - V.
SUM_OF_ENERGIES = re.compile(r"(\w+) ([+-]) (\w+)\Z")


def quantities_of(
    formulas: Sequence[DocumentFormula],
    derivatives: Mapping[str, tuple[str, tuple[str, ...]]],
    stems: Sequence[str],
) -> dict[str, str]:
    """The kinds of energies and matrices among letters, by their names and by what they equal."""
    combined = _combinations(formulas)
    operands = {operand for operand, _ in derivatives.values()}
    # a function K that is differentiated by a momentum is a Hamiltonian of other coordinates
    transformed = {one for one, by in derivatives.values() if any(map(MOMENTUM.match, by))}
    subjects = {formula.subject for formula in formulas}
    # no energy has accelerations, as a force does in H = m*x_ddot
    forces = {one.subject for one in formulas if any(map(_is_of_second_order, one.sides[1:]))}
    # nor a kinetic energy a weight, as the tension T = m*g*cos(theta) + m*l*theta_dot**2 has
    weights = {
        one.subject
        for one in formulas
        for side in one.sides[1:]
        if GRAVITY in WORD.findall(side.text)
    }
    subjects |= {match[1] for one in formulas if (match := MULTIPLE.fullmatch(one.sides[0].text))}
    functions_of_forces = _functions_of_forces(formulas)
    quantities = {
        one: kind
        for one in stems
        if (kind := combined.get(one) or _quantity(one))
        and (one in subjects or one in operands or one in combined)
        and not (kind == "kinetic_energy" and _is_constant(one, formulas))
        and not (kind == "kinetic_energy" and one in {*transformed, *weights})
        and not (kind == "potential_energy" and _is_effective(one, formulas))
        and not (kind == "potential_energy" and one not in subjects and _is_general(one, formulas))
        and one not in {*forces, *functions_of_forces}
        and not (kind == "lagrangian" and one not in operands and _is_momentum(one, formulas))
    }
    if any(one.subject.startswith(PLACE) for one in formulas):  # no coordinates for an energy
        quantities = {}
    written_out = {one.subject for one in formulas if any(side.entries for side in one.sides)}
    quantities = {name: kind for name, kind in quantities.items() if name not in written_out}
    return quantities | matrices_of(formulas)


def _is_general(name: str, formulas: Iterable[DocumentFormula]) -> bool:
    """Whether a potential energy without a value stands beside a kinetic energy in velocities."""
    sides = ({*WORD.findall(side.text)} for one in formulas for side in one.sides)
    return any(name in words and 1 in map(order, words) for words in sides)


def _quantity(name: str) -> str | None:
    letter, _, index = name.partition("_")
    if letter == "E" and index in ENERGIES:
        return ENERGIES[index]
    return QUANTITIES.get(letter) if index in TOTAL else None


def _combinations(formulas: Iterable[DocumentFormula]) -> dict[str, str]:
    """Energies by statements such as L = K - P and H = T + U."""
    result: dict[str, str] = {}
    for formula in formulas:
        kind = _quantity(formula.subject)
        for side in formula.sides[1:]:
            match = SUM_OF_ENERGIES.match(side.text)
            signs = {"lagrangian": "-", "energy": "+", "hamiltonian": "+"}
            if match and signs.get(kind or "") == match[2]:
                result |= {match[1]: "kinetic_energy", match[3]: "potential_energy"}
    return result


def _functions_of_forces(formulas: Iterable[DocumentFormula]) -> set[str]:
    """Names U of L = T + U in a document that states L = T - V as well: U is -V."""
    partners = dict[str, set[str]]()
    for formula in formulas:
        for side in formula.sides[1:]:
            match = SUM_OF_ENERGIES.match(side.text)
            if match and _quantity(formula.subject) == "lagrangian":
                partners.setdefault(match[2], set()).add(match[3])
    return partners["+"] - partners["-"] if len(partners) == 2 else set()


def _is_constant(name: str, formulas: Iterable[DocumentFormula]) -> bool:
    """Whether all definitions of a name contain parameters alone, as that of K = m l**2.

    They may contain coordinates if another kinetic energy is stated by it, T = m K x_dot**2/2, or
    by velocities.
    """
    own = [one for one in formulas if one.subject == name]
    words = {word for one in own for side in one.sides[1:] for word in WORD.findall(side.text)}
    moving = {stem(word) for one in formulas for word in one.words if order(word)}
    is_used = any(name in one.words and one.subject != name for one in formulas)
    has_other = any(
        _quantity(one.subject) == "kinetic_energy"
        and (name in one.words or any(map(order, one.words)))
        for one in formulas
        if one.subject not in ("", name)
    )
    excluded = set() if has_other else moving
    return (
        bool(words)
        and (is_used or has_other)
        and not any(
            order(word)
            or word in excluded
            or _quantity(word)
            or energy_of_part(word)
            or word[0] in "pv"
            for word in words
        )
    )


def _is_effective(name: str, formulas: Sequence[DocumentFormula]) -> bool:
    """Whether a potential energy contains a constant of the motion, as c of r**2*phi_dot = c."""
    own = {word for one in formulas if one.subject == name for word in one.words} - {name}
    own -= {stem(word) for one in formulas for word in one.words if order(word)}
    for formula in formulas:
        first, last = formula.sides[0].text, formula.sides[-1].text
        for one, other in ((first, last), (last, first)):
            is_constant = one in own and not other.isidentifier()
            orders = {order(word) for word in {*WORD.findall(other)} - {one}}
            if is_constant and formula.relations == ("=",) and max(orders, default=0) == 1:
                return True
    return False


def _is_momentum(name: str, formulas: Sequence[DocumentFormula]) -> bool:
    """Whether a name is odd in velocities, as the momentum L = x*y_dot - y*x_dot; none is T - V."""
    sides = [side.text for one in formulas if one.subject == name for side in one.sides[1:]]
    rates = {one.sides[-1].text for one in formulas if order(one.subject) == 1}
    return bool(sides) and all(_is_odd(text, rates) for text in sides)


def _is_odd(text: str, rates: set[str]) -> bool:
    """Whether a formula changes its sign with all velocities, some of which have other names."""
    symbols = {word: sp.Symbol(word) for word in WORD.findall(text)}
    point = {one: sp.Rational(k + 7, k + 5) for k, one in enumerate(symbols.values())}
    back = {s: -value for s, value in point.items() if order(s.name) == 1 or s.name in rates}
    try:
        value = parse(text, {**symbols, **FUNCTIONS})
        values = [value.xreplace(one).evalf(30) for one in (point, {**point, **back})]
    except (ExpressionError, NotImplementedError, AttributeError, TypeError, ValueError):
        return False
    return bool(back) and all(one.is_number for one in values) and abs(sum(values)) < 1e-20


def matrices_of(formulas: Sequence[DocumentFormula]) -> dict[str, str]:
    """Names of the matrices of M q̈ + C q̇ = G that a document writes out, or their entries."""
    by_entries = {*matrices_by_entries(one.subject for one in formulas)} & {*MATRICES}
    result = {letter: MATRICES[letter] for letter in by_entries if letter not in "Gg"}
    for formula in formulas:
        letter, _, index = formula.subject.removesuffix("_column").partition("_")
        count = max(len(side.entries) for side in formula.sides)
        if index == "0":
            continue  # the value at an equilibrium
        if letter in MATRICES and count in (COLUMNS if letter in "Gg" else SQUARES):
            result[formula.subject] = MATRICES[letter]
    return result


def routhians(formulas: Iterable[DocumentFormula], momenta: Mapping[str, str]) -> dict[str, str]:
    """Names R of functions of momenta; other quantities of this name, as radii, contain none."""
    subjects = {one.subject for one in formulas if {*momenta} & {*one.words}}
    return {name: "routhian" for name in subjects if name.partition("_")[0] == "R"}


def partners(quantities: Mapping[str, str], functions: Collection[str]) -> dict[str, str]:
    """Potential energies P or Pi beside kinetic ones or matrices: functions of coordinates."""
    if "potential_energy" in quantities.values():
        return {}
    names = {partner for name, kind in quantities.items() if kind == "kinetic_energy"
             for partner in PARTNERS.get(name, ("Pi",))}  # fmt: skip
    if "mass_matrix" in quantities.values():
        names.update(*PARTNERS.values())
    return dict.fromkeys(names & {*functions}, "potential_energy")


def resting_functions(formulas: Iterable[DocumentFormula], moving: Sequence[str]) -> set[str]:
    """Names P and Pi of functions of coordinates alone, which no momentum is."""
    words = {name: {word for one in formulas if one.subject == name
                    for side in one.sides[1:] for word in WORD.findall(side.text)}
             for name in PARTNERS["K"]}  # fmt: skip
    return {
        name
        for name, own in words.items()
        if own & {*moving} and not any(order(word) or MOMENTUM.match(word) for word in own)
    }


def _is_of_second_order(side: FormulaText) -> bool:
    return "ddt(ddt(" in side.text or any(order(word) == 2 for word in WORD.findall(side.text))
