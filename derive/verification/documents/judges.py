"""Judges of a document's formulas by each of the systems that can be meant."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace

from derive.verification.documents.formula_translation import order, stem
from derive.verification.documents.letters.candidates import SystemCandidate
from derive.verification.documents.letters.document_system import system_letters
from derive.verification.documents.letters.letters import OPERATORS, Letters
from derive.verification.documents.numbers.matching import best_matches
from derive.verification.documents.numbers.resolution import resolved
from derive.verification.documents.rules.consequences import WithVerdict
from derive.verification.documents.rules.formula_verdicts import Judge
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.side_verdict import CORRECT, plain
from derive.verification.documents.statements import Translated
from derive.verification.judging.verdict import Verdict

#: Verdicts on formulas that are no definitions and hold.
HOLDING = ("verified", "equivalent")
#: The note on a formula that holds in other units than the rest of a document.
OWN_UNITS = "it holds in units in which the other parameters are 1, which nothing states"

Results = Sequence[WithVerdict]


class Judges:
    """Judges of a document's formulas by systems that can be meant, and their verdicts."""

    def __init__(self, statements: Translated, letters: Letters) -> None:
        self.statements, self.letters = statements, letters
        # by identity, for as long as the candidate exists
        self._judges: dict[int, tuple[SystemCandidate, Judge]] = {}
        self._verdicts: dict[int, Results] = {}

    def judge(self, candidate: SystemCandidate) -> Judge:
        """The judge with the meanings of a candidate."""
        if id(candidate) not in self._judges:
            self._judges[id(candidate)] = candidate, self._judge(candidate)
        return self._judges[id(candidate)][1]

    def _judge(self, candidate: SystemCandidate) -> Judge:
        statements, formulas = self.statements, self.statements.formulas
        letters = _with_order(statements, self.letters, candidate)
        meanings = resolved(candidate, letters, formulas, statements.derivatives)
        given, stating = (
            [formulas[number].occurrence for number in numbers]
            for numbers in (candidate.given, candidate.stating)
        )
        namespace = DocumentNamespace(
            system_letters(candidate), letters, formulas, statements.derivatives, meanings
        )
        return Judge(namespace, given, stating)

    def verdicts(self, candidate: SystemCandidate) -> Results:
        """The verdicts on all formulas."""
        if id(candidate) not in self._verdicts:
            verdicts = self.judge(candidate).verdicts(self.statements.formulas)
            self._verdicts[id(candidate)] = [*self._in_own_units(candidate, verdicts)]
        return self._verdicts[id(candidate)]

    def _in_own_units(self, candidate: SystemCandidate, verdicts: Results) -> Iterator[WithVerdict]:
        """Yield the verdicts; no equation is wrong that holds with 1 for what it does not contain.

        It has no parameter that other formulas contain, as one without dimensions has not.
        """
        used = Counter(w for one in self.statements.formulas for w in one.words)
        common = {*self.letters.coordinates, *self.letters.quantities, *OPERATORS}
        for formula, result in verdicts:
            is_alone = all(used[w] == 1 or stem(w) in common for w in formula.words)
            has_acceleration = any(order(word) == 2 for word in formula.words)
            if result.verdict.verdict == "wrong" and is_alone and has_acceleration:
                own = {p: one for p, one in candidate.parameters.items() if one in formula.words}
                names = (one.symbol.name for one in candidate.system.parameters)
                ones = {name: "1" for name in names if name not in own}
                units = replace(candidate, parameters=own, numbers=ones)
                if self._judge(units).verdict(formula).verdict.verdict in HOLDING:
                    result = plain("context", formula, OWN_UNITS)
            yield formula, result

    def incorrect(self, candidate: SystemCandidate) -> list[Verdict]:
        """The verdicts on formulas that are not correct."""
        verdicts = (one.verdict for _, one in self.verdicts(candidate))
        return [one for one in verdicts if one.verdict not in CORRECT]

    def count_wrong(self, candidate: SystemCandidate) -> int:
        """The number of formulas that are wrong."""
        return len(self.wrong(candidate))

    def wrong(self, candidate: SystemCandidate) -> list[int]:
        """The numbers of the formulas that are wrong."""
        verdicts = self.verdicts(candidate)
        return [k for k, (_, one) in enumerate(verdicts) if one.verdict.verdict == "wrong"]


def _with_order(statements: Translated, letters: Letters, candidate: SystemCandidate) -> Letters:
    """The letters in the order of the rows of M with which most formulas hold."""
    if "mass_matrix" not in letters.quantities.values():
        return letters
    formulas, derivatives = statements.formulas, statements.derivatives

    def holding(one: Letters) -> float:
        matches = best_matches([candidate], one, formulas, derivatives, frozenset())
        return matches[0].holding if matches else 0

    orders = (letters.ordered, *letters.other_orders)
    return max((replace(letters, ordered=one) for one in orders), key=holding)
