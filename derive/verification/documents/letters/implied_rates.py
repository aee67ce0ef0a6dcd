"""Rates of places that a document has letters for, but no dots: v and a, and those of Euler."""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from derive.reading.latex.tree import Statement
from derive.verification.documents.letters.letter_roles import letters_of
from derive.verification.documents.letters.letters import ANGLES, Letters
from derive.verification.documents.statements import (
    IMPLIED,
    DocumentFormula,
    Occurrence,
    Translated,
)
from derive.verification.documents.text import FormulaText, order, stem

#: Letters of accelerations and of velocities, of velocities along a line, and of places.
ACCELERATION, VELOCITY = re.compile(r"a(?:_\w+)?\Z"), re.compile(r"(?:omega|w|v|u)(?:_\w+)?\Z")
SPEEDS, PLACES = ("v", "u"), ("s", "x", "y", "z", "X", "Y")
#: A component of a position.
COMPONENT = re.compile(r"[xyzXYZ](?:_\w+)?\Z")


def implied_rates(statements: Translated) -> Translated:
    """The statements after such that make a letter the rate of a place, as a is in F = m*a.

    These are accelerations of a document without rates, and velocities without places: those of
    Euler's equations. Beside energies, they are v, a and alpha alone.
    """
    letters = letters_of(statements.formulas, statements.derivatives)
    if "kinetic_energy" in letters.quantities.values():
        return _with_rates(statements, _unnamed(letters, statements.formulas))
    if letters.quantities or letters.momenta or statements.derivatives:
        return statements
    words = Counter(word for one in statements.formulas for word in one.words)
    if not letters.coordinates:
        has_mass = bool(letters.of_kind("mass"))
        names = [name for name in words if ACCELERATION.match(name) and words[name] > 1] * has_mass
        ending = "_ddot"
    else:
        second = {stem(name) for name in words if order(name) > 1}
        is_first = not any(name for name in second if not name.startswith("omega"))
        names = [name for name in letters.coordinates if VELOCITY.match(name) and is_first]
        ending = "_dot"
    return _with_rates(statements, ((f"place_{one}{ending}", one) for one in names))


def _with_rates(statements: Translated, pairs: Iterable[tuple[str, str]]) -> Translated:
    place = Occurrence(IMPLIED, 0, 0, 0, 0, "", Statement((), (), (0, 0)))
    rates = [
        DocumentFormula(place, (FormulaText(rate), FormulaText(letter)), ("=",))
        for rate, letter in pairs
    ]
    return replace(statements, formulas=(*rates, *statements.formulas))


def _unnamed(letters: Letters, formulas: Sequence[DocumentFormula]) -> Iterator[tuple[str, str]]:
    """Yield the rates v and a of a place in positions that has no dots, and alpha of an angle."""
    counts = Counter(word for one in formulas for word in one.words)
    kinetic, positions = set[str](), set[str]()
    for one in formulas:
        if letters.quantities.get(one.subject) == "kinetic_energy":
            kinetic |= {*one.words}
        if COMPONENT.match(one.subject):
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
