"""Other meanings of a document's letters with the support of the one that is taken."""

from collections.abc import Iterator, Mapping, Sequence

from derive.verification.documents.convention import difference, names_of
from derive.verification.documents.corrections import corrected
from derive.verification.documents.interpretation import Interpretation, judge_of
from derive.verification.documents.judged import Alternative, Difference
from derive.verification.documents.matching import Match
from derive.verification.documents.side_verdict import CORRECT, SideVerdict
from derive.verification.documents.statements import DocumentFormula, Translated

#: Most meanings that are judged beside the one that is taken.
MAX_ALTERNATIVES = 3
JUDGED = (*CORRECT, "wrong")

Results = Sequence[tuple[DocumentFormula, SideVerdict]]


def alternatives(
    statements: Translated, found: Interpretation, results: Results, written: Mapping[str, str]
) -> Iterator[Alternative]:
    """Yield the rivals of the meaning that is taken which change a verdict or a correction."""
    assert found.match
    seen: set[tuple[object, ...]] = set()
    for rival in found.rivals[:MAX_ALTERNATIVES]:
        pairs = _rejudged(statements, found, rival, results)
        own = sum(one.verdict.verdict not in CORRECT for _, one, _ in pairs)
        other = sum(one.verdict.verdict not in CORRECT for _, _, one in pairs)
        changed = tuple(_differences(pairs, written))
        kinds = tuple((one.line, one.latex, one.verdict) for one in changed)
        is_usual = rival.candidate.is_usual and not found.match.candidate.is_usual
        if changed and kinds not in seen and (other <= own or is_usual):
            seen.add(kinds)
            yield _alternative(found.match, rival, changed)


def _rejudged(
    statements: Translated, found: Interpretation, rival: Match, results: Results
) -> list[tuple[DocumentFormula, SideVerdict, SideVerdict]]:
    """The formulas that do not hold with both meanings, and their verdicts with each."""
    assert found.match
    failed = found.match.failed | rival.failed
    if not failed:
        return []
    judge = judge_of(statements, found.letters, rival.candidate)
    pairs = ((k, *pair) for k, pair in enumerate(results) if k in failed)
    return [(formula, result, judge.verdict(formula)) for _, formula, result in pairs]


def _differences(
    pairs: Sequence[tuple[DocumentFormula, SideVerdict, SideVerdict]], written: Mapping[str, str]
) -> Iterator[Difference]:
    for formula, own, other in pairs:
        names = [one.verdict.verdict for one in (own, other)]
        if any(name not in JUDGED for name in names):
            continue
        first, second = (corrected(formula, one, written).correction for one in (own, other))
        if (names[0] == "wrong") != (names[1] == "wrong") or first != second:
            place = formula.occurrence
            yield Difference(
                place.line, place.display, place.source, names[1], names[0], second, place.cell
            )


def _alternative(match: Match, rival: Match, changed: tuple[Difference, ...]) -> Alternative:
    system, own = rival.candidate.system, match.candidate
    meaning = difference(rival.candidate, own) if system is own.system else ""
    return Alternative(system.title, system.name, names_of(rival.candidate), meaning, changed)
