"""Which wrong verdicts a document bears out: no right formula is to be called wrong."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from derive.verification.documents.letters.candidates import SystemCandidate
from derive.verification.documents.rules.consequences import FOLLOWS, WithVerdict
from derive.verification.documents.rules.side_verdict import plain
from derive.verification.engine import joined

#: The reason of a verdict on a single formula that holds with an unusual meaning of angles alone.
UNSTATED = "it holds with angles from the horizontal alone, which nothing states: use --names"
UNDECIDED = "nothing else in the document decides which of them is wrong"
#: The reason of a verdict that a system without enough support gives.
UNSUPPORTED = (
    "it does not hold for the system that fits best, but this fits too few other formulas to call "
    "it wrong: state the system by --system"
)


def weighed(
    results: Sequence[WithVerdict],
    candidate: SystemCandidate,
    doubts: Mapping[int, frozenset[int]],
    is_stated: bool,
) -> Iterator[WithVerdict]:
    """Yield the verdicts, with `context` for formulas that are wrong by too weak evidence.

    A formula is wrong by a system that the user states, or that follows from positions or energies
    in the document. It is not if other formulas of the document, which `doubts` has for its number,
    fit the rest as well and agree with it. A system that is known from elsewhere must have a letter
    for each of its parameters, and more formulas that hold than independent ones that do not.
    """
    lines = {k: formula.occurrence.line for k, (formula, _) in enumerate(results)}
    wrong = [one for _, one in results if one.verdict.verdict == "wrong"]
    independent = sum(FOLLOWS not in one.verdict.note for one in wrong)
    holding = sum(one.verdict.verdict in ("verified", "equivalent") for _, one in results)
    is_known = candidate.basis == "catalogue" and not is_stated
    is_weak = is_known and (candidate.lacking > 0 or independent > max(1, holding))
    is_guess = (
        is_known
        and holding < 2
        and any(isinstance(one, int) and one % 2 for one in candidate.offsets)
    )
    given = _lines(lines[k] for k in candidate.stating)
    for number, (formula, result) in enumerate(results):
        verdict = result.verdict
        if is_guess and verdict.verdict in ("verified", "equivalent", "wrong"):
            result = plain("context", formula, UNSTATED)
        elif verdict.verdict == "wrong" and number in doubts:
            other = _lines(lines[k] for k in doubts[number])
            note = f"it contradicts {given or 'the system'} and agrees with {other}: {UNDECIDED}"
            result = plain("context", formula, note)
        elif verdict.verdict == "wrong" and is_weak:
            result = plain("context", formula, UNSUPPORTED)
        elif verdict.verdict == "wrong" and given:
            note = joined(verdict.note, f"given {given}")
            result = replace(result, verdict=replace(verdict, note=note))
        yield formula, result


def _lines(numbers: Iterable[int]) -> str:
    """Lines in words."""
    words = [*map(str, sorted({*numbers}))]
    if not words:
        return ""
    *first, last = words
    return f"lines {', '.join(first)} and {last}" if first else f"line {last}"
