"""The meaning of the letters of a document: the system for which most of its formulas hold."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from derive.verification.documents.candidates import Candidate, candidates
from derive.verification.documents.hints import Hints
from derive.verification.documents.letter_search import letters_of
from derive.verification.documents.letters import Letters
from derive.verification.documents.matching import Match, best_match, trivial_comparisons
from derive.verification.documents.meaning import meaning
from derive.verification.documents.positions import stated_candidates, stated_systems
from derive.verification.documents.resolution import resolved
from derive.verification.documents.scope import DocumentScope
from derive.verification.documents.statements import Translated
from derive.verification.documents.templates import templates
from derive.verification.documents.verdicts import Judge

#: The least part of the comparisons that must hold for a system to be that of a document, unless
#: so many hold.
LEAST, ENOUGH = 0.3, 3


@dataclass(frozen=True)
class Interpretation:
    """What a document is about: its letters and the system that suits them best."""

    letters: Letters
    match: Match | None


def interpretation(statements: Translated, hints: Hints | None = None) -> Interpretation:
    """Find the meaning of letters for which most formulas hold.

    If there is none, parameters without a letter are taken for numbers: gravity for that of the
    formulas, others for 1.
    """
    letters = letters_of(statements.formulas, statements.derivatives)
    if hints:
        return Interpretation(letters, _best(letters, statements, hints.candidates(letters), 0))
    found = _best(letters, statements, _candidates(letters, statements))
    if found is None or found.holding < 1:
        numbers = {"gravity": _gravity(statements)}
        other = _best(letters, statements, _of_templates(letters, numbers))
        found = max(filter(None, (found, other)), key=lambda match: match.score, default=None)
    return Interpretation(letters, found)


def _best(
    letters: Letters,
    statements: Translated,
    groups: Iterable[Sequence[Candidate]],
    least: float = LEAST,
) -> Match | None:
    """The candidate that most formulas support, if a part of them does."""
    formulas, derivatives = statements.formulas, statements.derivatives
    trivial = trivial_comparisons(letters, formulas, derivatives)
    matches = (best_match(tried, letters, formulas, derivatives, trivial) for tried in groups)
    supported = [match for match in matches if match and (match.holding or not least)]
    best = max(supported, key=lambda match: match.score, default=None)  # the first of several
    if best is None or best.holding < min(ENOUGH, least * best.compared):
        return None
    return best


def _candidates(letters: Letters, statements: Translated) -> Iterator[Sequence[Candidate]]:
    """Candidates of one system after another: of those that the document states first."""
    for system in stated_systems(letters, statements.formulas):
        yield [*stated_candidates(system, letters)]
    yield from _of_templates(letters)


def _of_templates(
    letters: Letters, numbers: Mapping[str, str] | None = None
) -> Iterator[Sequence[Candidate]]:
    for count in range(len(letters.coordinates), 0, -1):
        for system in templates(count):
            yield [*candidates(system, letters, numbers)]


def _gravity(statements: Translated) -> str:
    """The number in the formulas that is gravity, or 1."""
    texts = " ".join(formula.text for formula in statements.formulas)
    found = re.search(r"\b9\.[78]\d*\b", texts)
    return found[0] if found else "1"


def judge_of(statements: Translated, letters: Letters, candidate: Candidate) -> Judge:
    """The judge of a document's formulas with the meanings of a candidate."""
    meanings = resolved(candidate, letters, statements.formulas, statements.derivatives)
    system, formulas = meaning(candidate), statements.formulas
    return Judge(DocumentScope(system, letters, formulas, statements.derivatives, meanings))
