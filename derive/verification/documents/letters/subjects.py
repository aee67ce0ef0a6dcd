"""The subjects of a document: its examples with energies of their own, and cases of positions."""

from collections.abc import Iterator, Sequence
from itertools import takewhile

from derive.reading.headings import below_each
from derive.verification.documents.letters.letter_roles import equal_letters, letters_of
from derive.verification.documents.letters.letters import QUANTITIES
from derive.verification.documents.letters.stated_positions import POINT
from derive.verification.documents.statements import WORD, DocumentFormula, Translated
from derive.verification.documents.text import stem

#: Most cases of a document with positions of their own.
MAX_CASES = 6

Formulas = tuple[DocumentFormula, ...]


def subjects(text: str, statements: Translated) -> list[Formulas]:
    """The formulas of each subject of a document, in order.

    Those before a special case, such as m_1 = m_2 = m, are a subject of their own as well.
    """
    parts = [case for part in _examples(text, statements) for case in _cases(part)]
    return [one for part in parts for one in (*_before_equalities(part), part)]


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
    coordinate in common with the energies since.
    """
    letters = letters_of(statements.formulas, statements.derivatives)
    example, seen = list[DocumentFormula](), dict[str, set[str]]()
    for part in below_each(text, statements.formulas, lambda one: one.occurrence.start):
        own: dict[str, set[str]] = {}
        for formula in part:
            if formula.subject in letters.quantities:
                words = {stem(word) for word in WORD.findall(formula.sides[-1].text)}
                moving = words & {*letters.coordinates}
                if moving:
                    own.setdefault(formula.subject, set()).update(moving)
        before, after = (set[str]().union(*one.values()) for one in (seen, own))
        if {*own} & {*seen} and before.isdisjoint(after):
            yield tuple(example)
            example, seen = [], {}
        example += part
        for name, moving in own.items():
            seen.setdefault(name, set()).update(moving)
    yield tuple(example)


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
