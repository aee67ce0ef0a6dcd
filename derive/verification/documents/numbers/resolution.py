"""Letters without a definition: what they must be for the formulas that contain them to hold."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

import numpy as np

from derive.verification.documents.formula_translation import RATES, stem
from derive.verification.documents.jets import Jet, UnknownNameError, Value, evaluated
from derive.verification.documents.letters.candidates import SystemCandidate
from derive.verification.documents.letters.letters import OPERATORS, Letters
from derive.verification.documents.numbers.candidate_motions import CandidateMotions
from derive.verification.documents.numbers.numbers import Numbers
from derive.verification.documents.statements import (
    OWN_CONSTANT,
    WORD,
    DocumentFormula,
)
from derive.verification.judging.system_names import FACTORS

#: Unknown letters of a formula that are sought at once, and comparisons that must hold.
MAX_UNKNOWN, SUPPORT = 2, 2


def resolved(
    candidate: SystemCandidate,
    letters: Letters,
    formulas: Sequence[DocumentFormula],
    derivatives: Mapping[str, tuple[str, tuple[str, ...]]],
) -> dict[str, str]:
    """Formulas in known letters for letters without a meaning.

    A meaning is accepted if at least two comparisons and more than half of them hold with it, so
    that a mistake in a single letter is not taken for another letter. A letter is a constant, as l
    of a potential energy m*g*(l - x), if so many hold whatever its value is, and no more with a
    meaning: it stands for itself.
    """
    numbers = Numbers(CandidateMotions([candidate], letters), letters, derivatives)
    meanings: dict[str, str] = {}
    constants = {
        name: numbers.values.pop(name)  # random numbers
        for name in letters.parameters
        if name not in candidate.letters and name in numbers.values
    }
    for name in filter(OWN_CONSTANT.fullmatch, constants):
        meanings[name], numbers.values[name] = name, constants[name]
    solutions = [one for one in formulas if numbers.is_solution(one)]
    amplitudes = {word for one in solutions for word in one.words} - {*letters.coordinates}
    others = [q for q in letters.coordinates if q not in candidate.coordinates]
    for name in (q + ending for q in others for ending in RATES[:3]):
        numbers.values.pop(name, None)
    numbers.define(formulas)
    for names in _aliases(others, candidate):
        meanings |= _accepted(names, formulas, numbers)
    numbers.define(formulas)
    while True:
        unknown = {
            f: u
            for f in formulas
            if 0 < len(u := _unknown(f, numbers)) <= MAX_UNKNOWN
            # with a reaction all would hold, other coordinates are those of other systems, and
            # amplitudes have any value
            and not {*map(stem, u)} & {*letters.multipliers, *others, *amplitudes}
        }
        result = next((m for u in dict.fromkeys(unknown.values())
                      if (m := _meaning(u, [f for f in unknown if set(unknown[f]) <= set(u)],
                                        candidate, numbers, constants))), None)  # fmt: skip
        if not result:
            return meanings
        for name, text in [*result.items(), *_rates(result, letters)]:
            meanings[name] = text
            value = constants[name] if text == name else evaluated(text, numbers.values)
            numbers.set_rates(name, value)
        numbers.define(formulas)


def _aliases(names: Sequence[str], candidate: SystemCandidate) -> Iterator[dict[str, str]]:
    """Other letters with the same indices as the coordinates, such as phi_1 for theta_1."""
    indexed = {q.partition("_")[2]: q for q in candidate.coordinates}
    for letter in dict.fromkeys(name.partition("_")[0] for name in names):
        pairs = {n: indexed.get(n.partition("_")[2]) for n in names if n.startswith(letter)}
        result = {name: q for name, q in pairs.items() if q}
        if len(result) == len(candidate.coordinates):
            yield result


def _accepted(
    result: Mapping[str, str], formulas: Sequence[DocumentFormula], numbers: Numbers
) -> Mapping[str, str]:
    """The meanings if several formulas hold with them, which no other meaning would achieve.

    Two letters that a formula relates in another way are no names of one coordinate.
    """
    for name, q in result.items():
        numbers.set_rates(name, numbers.values[q])
    words = {name + ending for name in result for ending in RATES}
    votes = [
        (bool(vote.all()), {*map(stem, one.words)})
        for one in formulas
        if words & {*one.words}
        for _, vote in numbers.comparisons(one)
    ]
    holding = sum(holds for holds, _ in votes)
    related = any(
        {*pair} <= letters for holds, letters in votes if not holds for pair in result.items()
    )
    if holding >= max(SUPPORT, len(votes) // 4) and not related:
        return result
    for name in (n + ending for n in result for ending in RATES[:3]):
        numbers.values.pop(name, None)
    return {}


def _rates(result: Mapping[str, str], letters: Letters) -> Iterator[tuple[str, str]]:
    """Names such as td_1 and tdd_1, if t_1 is a coordinate."""
    for name, text in result.items():
        letter, _, index = name.partition("_")
        for mark, ending in (("d", "_dot"), ("dd", "_ddot")):
            rate = f"{letter}{mark}_{index}"
            if rate in letters.parameters and text in letters.coordinates:
                yield rate, text + ending


def _unknown(formula: DocumentFormula, numbers: Numbers) -> tuple[str, ...]:
    return tuple(
        name
        for name in formula.words
        if name not in numbers.values and name not in OPERATORS and name != formula.subject
    )


def _meaning(
    names: tuple[str, ...],
    formulas: Sequence[DocumentFormula],
    candidate: SystemCandidate,
    numbers: Numbers,
    constants: Mapping[str, Value],
) -> dict[str, str] | None:
    own, as_constants = dict[str, str](), 0  # comparisons that hold whatever the values are
    if {*names} <= {*constants}:
        votes = _votes({name: constants[name] for name in names}, formulas, numbers)
        own, as_constants = {name: name for name in names}, votes.count(True)
        if votes and all(votes):
            return own
    pool = [*_pool(candidate)]
    if len(names) == 1:
        pool += _reactions(candidate, numbers)
    for texts in product(pool, repeat=len(names)):
        try:
            jets = {
                name: evaluated(text, numbers.values)
                for name, text in zip(names, texts, strict=True)
            }
        except UnknownNameError:
            continue
        if any(np.allclose(one.value, 0) for one in jets.values() if isinstance(one, Jet)):
            continue  # with which any factor would hold, as the acceleration of a free body
        votes = _votes(jets, formulas, numbers)
        # no mistake in a letter makes a sum of it
        is_sum = all("+" in text for text in texts)
        least = max(1, len(votes) // 2) if is_sum else max(SUPPORT, len(votes) // 2 + 1)
        if votes.count(True) >= max(least, as_constants + 1):
            return dict(zip(names, texts, strict=True))
    return own if own and as_constants >= max(SUPPORT, len(votes) // 2 + 1) else None


def _votes(
    values: Mapping[str, Value], formulas: Sequence[DocumentFormula], numbers: Numbers
) -> list[bool]:
    """Whether each comparison in which these names stand holds with their values."""
    numbers.values.update(values)
    votes = [
        bool(vote.all())
        for one in formulas
        for side, vote in numbers.comparisons(one)
        if {*values} & {*WORD.findall(f"{side} {one.sides[0].text}")}
    ]
    for name in values:
        del numbers.values[name]
    return votes


def _pool(candidate: SystemCandidate) -> Iterator[str]:
    """Quantities that a letter can stand for."""
    for signs, offset in zip(candidate.signs, candidate.offsets, strict=True):
        terms = [q for q, sign in zip(candidate.coordinates, signs, strict=True) if sign]
        if isinstance(offset, str):
            yield " + ".join([offset, *terms])
        elif len(terms) > 1:
            yield " + ".join(terms)
    for ending in RATES[:3]:
        for q in candidate.coordinates:
            yield q + ending
    yield from dict.fromkeys(candidate.parameters.values())


def _reactions(candidate: SystemCandidate, numbers: Numbers) -> Iterator[str]:
    """Forces that a letter can stand for: multipliers, times or over a letter."""
    letters = {word for one in candidate.constraints for word in WORD.findall(one.text)}
    letters &= {*numbers.parameters}
    for name, factor in product(numbers.reactions, FACTORS):
        yield f"{factor}*{name}"
        yield from (f"{factor}*{name}{sign}{letter}" for letter in sorted(letters) for sign in "*/")
