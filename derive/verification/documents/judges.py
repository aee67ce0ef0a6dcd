"""Judges of a document's formulas by systems that can be meant, and of contrary statements."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import chain, islice, product
from typing import TypeAlias

from derive.formulas.syntax import ExpressionError
from derive.system.parts import SystemDefinitionError
from derive.verification.documents.formula_translation import FormulaText, order, stem
from derive.verification.documents.letters.candidates import SystemCandidate
from derive.verification.documents.letters.document_system import system_letters
from derive.verification.documents.letters.letters import KINDS, OPERATORS, Letters
from derive.verification.documents.numbers.matching import Match, best_matches
from derive.verification.documents.numbers.resolution import resolved
from derive.verification.documents.rules.consequences import Contradictions, WithVerdict
from derive.verification.documents.rules.evidence.slips import is_change
from derive.verification.documents.rules.formula_verdicts import Judge
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.other_statements import GENERALIZED_FORCE
from derive.verification.documents.rules.side_verdict import CORRECT, SideVerdict, plain
from derive.verification.documents.statements import (
    POINT,
    DocumentFormula,
    Translated,
    without_unknown_terms,
)
from derive.verification.judging.verdict import Verdict

#: Verdicts on formulas that are no definitions and hold.
HOLDING = ("verified", "equivalent")
#: The note on a formula that holds in other units than the rest of a document.
OWN_UNITS = "it holds in units in which the other parameters are 1"
#: Formulas that contain an abbreviation.
SEVERAL = 2
#: Formulas that hold, from which on a complete known system decides which one is wrong.
DECISIVE = 3
#: The largest difference of scores that decides nothing.
TIE = 0.25
#: Formulas more that hold, so that it decides.
CLEARLY = 2
#: Most potential energies of stated positions that are compared by their verdicts.
MAX_DIRECTIONS = 4

Results = Sequence[WithVerdict]
#: Other meanings of a formula: what they suppose, and a judge of another form of it.
Meanings: TypeAlias = Iterator[tuple[str, Judge, DocumentFormula]]


class Judges:
    """Judges of a document's formulas by systems that can be meant, and their verdicts."""

    def __init__(self, statements: Translated, letters: Letters) -> None:
        self.statements, self.letters = statements, letters
        # by identity, for as long as the candidate exists
        self._judges: dict[int, tuple[SystemCandidate, Judge]] = {}
        self._verdicts: dict[int, Results] = {}
        self._used = Counter(word for one in statements.formulas for word in one.words)

    def judge(self, candidate: SystemCandidate) -> Judge:
        """The judge with the meanings of a candidate."""
        if id(candidate) not in self._judges:
            self._judges[id(candidate)] = candidate, self._judge(candidate)
        return self._judges[id(candidate)][1]

    def has_motions(self, candidate: SystemCandidate) -> bool:
        """Whether the constraints of a candidate can be satisfied, and its coordinates vary."""
        try:
            return self.judge(candidate).has_motions
        except (ExpressionError, SystemDefinitionError):
            return False

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
        return Judge(namespace, given, stating, candidate.basis in ("positions", "energies"))

    def verdicts(self, candidate: SystemCandidate) -> Results:
        """The verdicts on all formulas."""
        if id(candidate) not in self._verdicts:
            judge = self.judge(candidate)
            self._verdicts[id(candidate)] = judge.with_loads(
                [
                    (formula, self._unless_meant_otherwise(candidate, formula, result))
                    for formula, result in judge.verdicts(self.statements.formulas)
                ]
            )
        return self._verdicts[id(candidate)]

    def _unless_meant_otherwise(
        self, candidate: SystemCandidate, formula: DocumentFormula, result: SideVerdict
    ) -> SideVerdict:
        """The verdict; a wrong formula that holds with another meaning is not judged."""
        if result.verdict.verdict == "wrong":
            meanings = (self._in_own_units, self._without_forces, self._with_angular_velocities)
            for note, judge, other in chain(*(one(candidate, formula) for one in meanings)):
                if judge.verdict(other).verdict.verdict in HOLDING:
                    return plain("context", formula, note)
        return result

    def _in_own_units(self, candidate: SystemCandidate, formula: DocumentFormula) -> Meanings:
        """Yield an equation, or a momentum, with 1 for what it does not contain.

        It has no parameter that other formulas contain, as one without dimensions has not.
        """
        letters = self.letters
        common = {*letters.coordinates, *letters.quantities, *letters.momenta, *OPERATORS}
        common |= {name for name, _ in candidate.forces}
        is_alone = all(self._used[w] == 1 or stem(w) in common for w in formula.words)
        # an equation of motion, or a canonical one
        is_equation = order(formula.subject) or any(order(word) == 2 for word in formula.words)
        if is_alone and (is_equation or formula.subject in letters.momenta):
            own = {p: one for p, one in candidate.parameters.items() if one in formula.words}
            names = (one.symbol.name for one in candidate.system.parameters)
            ones = {name: "1" for name in names if name not in own}
            units = replace(candidate, parameters=own, numbers=ones)
            yield OWN_UNITS, self._judge(units), formula

    def _without_forces(self, candidate: SystemCandidate, formula: DocumentFormula) -> Meanings:
        """Yield an equation without the forces of which a document states values.

        These can be those of generalized forces.
        """
        subjects = {one.subject for one in self.statements.formulas} - {formula.subject}
        forces = {name for name in subjects if name.partition("_")[0] in KINDS["force"]}
        if any(map(GENERALIZED_FORCE.fullmatch, subjects)):
            forces |= {name for name, _ in candidate.forces}
        if own := sorted(forces & {*formula.words}):
            rest = without_unknown_terms(formula, own)
            if rest is not None:
                note = f"it holds but for {', '.join(own)}, which the system does not contain"
                loads = tuple(one for one in candidate.forces if one[0] not in own)
                free = candidate if loads == candidate.forces else replace(candidate, forces=loads)
                yield note, self.judge(free), rest

    def _with_angular_velocities(
        self, candidate: SystemCandidate, formula: DocumentFormula
    ) -> Meanings:
        """Yield a formula with the rate of each angle in place of ω."""
        words = sorted(formula.words)
        names = [one for one in words if one.partition("_")[0] == "omega" and not order(one)]
        for name, q in product(names, self.letters.coordinates):
            rate = f"{q}_dot"
            sides = [re.sub(rf"\b{name}\b", rate, side.text) for side in formula.sides]
            other = replace(formula, sides=tuple(map(FormulaText, sides)))
            note = f"it holds if {name} is {rate}, which nothing states"
            yield note, self.judge(candidate), other

    def incorrect(self, candidate: SystemCandidate) -> list[Verdict]:
        """The verdicts on formulas that are not correct."""
        verdicts = (one.verdict for _, one in self.verdicts(candidate))
        return [one for one in verdicts if one.verdict not in CORRECT]

    def count_wrong(self, candidate: SystemCandidate) -> int:
        """The number of formulas that are wrong."""
        return len(self.wrong(candidate))

    def has_several_wrong(self, candidate: SystemCandidate) -> bool:
        """Whether more than one formula is wrong; those after the second are not judged."""
        if candidate.constraints:  # with which wrong formulas can follow from others
            return self.count_wrong(candidate) > 1
        judge = self.judge(candidate)
        results = (
            self._unless_meant_otherwise(candidate, formula, judge.verdict(formula))
            for formula in self.statements.formulas
        )
        wrong = (one for one in results if one.verdict.verdict == "wrong")
        return len([*islice(wrong, 2)]) > 1

    def count_holding(self, candidate: SystemCandidate) -> int:
        """The number of formulas that hold."""
        return sum(one.verdict.verdict in HOLDING for _, one in self.verdicts(candidate))

    def has_more(self, one: Match, other: Match) -> bool:
        """Whether clearly more formulas hold with a match than with another one.

        Such as frequencies, which numbers at states do not show.
        """
        own, its = (
            self.count_holding(match.candidate) + len(match.candidate.stating)
            for match in (one, other)
        )
        return own >= its + CLEARLY

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


def with_direction(best: Match, matches: Sequence[Match], judges: Judges) -> Match:
    """Of stated positions with both directions of gravity, that with fewest wrong formulas."""
    same = [
        one for one in matches
        if one.candidate.basis == "positions" and one.score == best.score
    ]  # fmt: skip
    if best.candidate.basis != "positions" or not best.failed or len(same) < 2:
        return best
    first: dict[int, Match] = {}
    for one in (best, *same):
        first.setdefault(id(one.candidate.system), one)
    tried = [*first.values()][:MAX_DIRECTIONS]
    return min(tried, key=lambda one: judges.count_wrong(one.candidate))


def contradictions_of(best: Match, matches: Sequence[Match], judges: Judges) -> Contradictions:
    """Formulas that do not hold, but do by other stated energies with as much support.

    What holds by the best alone is disputed. As much is also as many formulas that fail by one term
    each: the score does not show that one is missing. Equations, which follow from energies, must
    not contradict more formulas than these; nor are they as likely as other equations, if no change
    of one term reconciles them with what they contradict, unlike these.
    """

    def has_as_few_slips(match: Match) -> bool:
        explains_less = match.compared < best.compared  # such as no positions
        leaves_out = explains_less and not match.candidate.is_of_equations
        if leaves_out or len(match.failed) > len(best.failed):
            return False
        wrong, own = (judges.incorrect(one.candidate) for one in (match, best))
        return all(len(one.corrections) == 1 for one in wrong) and len(wrong) <= len(own)

    def is_less_likely(match: Match) -> bool:
        is_unexplained = bool(match.unexplained) and match.candidate.is_of_equations
        if not (is_unexplained and best.candidate.is_of_equations):
            return False
        wrong = (one for one in judges.incorrect(best.candidate) if one.verdict == "wrong")
        has_slips = all(is_change(one.corrections) for one in wrong)
        return has_slips and not match.unexplained.isdisjoint(judges.wrong(match.candidate))

    others = (one for one in matches if one.candidate.stating and best.failed - one.failed)
    ranked = sorted(others, key=lambda one: one.score)
    # of those of the same statements that fail alike, the likeliest
    stated = [*{(one.candidate.stating, one.failed): one for one in ranked}.values()]
    is_best = all(one.score <= best.score + TIE for one in stated)
    is_decided = stated and is_best and _is_decisive(best, matches)
    if is_decided and judges.count_wrong(best.candidate) == 1:
        return Contradictions()
    doubts, disputed = _rates_and_energies(best, judges), dict[int, frozenset[int]]()
    decided = set[int]()
    verdicts = enumerate(judges.verdicts(best.candidate)) if stated else ()
    understood = {k for k, (_, one) in verdicts if one.is_understood}
    for match in stated:
        is_worse = match.candidate.is_of_equations and len(match.failed) > len(best.failed)
        is_tie = match.score >= best.score - TIE and not is_worse
        more = best.failed.intersection(understood) - match.failed
        if more and is_less_likely(match):
            decided.update(more)
        elif more and (is_tie or has_as_few_slips(match)) and not judges.has_more(best, match):
            for number in more:
                doubts.setdefault(number, match.candidate.stating)
            for number in match.failed - best.failed:
                disputed.setdefault(number, more)
    return Contradictions(doubts, disputed, decided=frozenset(decided - {*doubts}))


def _is_decisive(best: Match, matches: Sequence[Match]) -> bool:
    """Whether a known system fits most formulas, and no other one fits as well in another way."""
    return (
        best.candidate.basis == "catalogue"
        and not best.candidate.lacking
        and best.compared - len(best.failed) >= DECISIVE
        and all(
            match.failed == best.failed or match.score < best.score - TIE
            for match in matches
            if match.candidate.basis == "catalogue"
        )
    )


def with_fewest_slips(best: Match, matches: Sequence[Match], judges: Judges) -> tuple[Match, bool]:
    """The match of stated energies, or one of positions or a known system with fewer slips.

    What follows from a slip is none. Positions that do not lead to the stated energies are one.
    The second value is whether there are fewer, and as much support.
    """
    if best.candidate.basis == "positions":
        return _with_one_wrong_position(best, matches, judges)
    if best.candidate.basis != "energies":
        return best, False
    formulas, letters = judges.statements.formulas, judges.letters
    written = {p for one in formulas for p in one.words} & {*letters.parameters}
    written &= best.candidate.letters
    others = dict[str, Match]()
    for match in sorted(matches, key=lambda one: -one.score):
        one = match.candidate
        is_likely = one.basis == "positions" or match.support >= 0
        if one.basis != "energies" and is_likely and not one.lacking and written <= one.letters:
            others.setdefault(one.basis, match)
    is_contradicted = "positions" in others and bool(others["positions"].failed)
    abbreviations = _abbreviations(formulas, letters)
    if not others or (len(best.failed) + is_contradicted < 2 and not abbreviations):
        return best, False

    def slips(match: Match) -> float:
        verdicts = judges.verdicts(match.candidate)
        wrong = [(formula, one) for formula, one in verdicts if one.verdict.verdict == "wrong"]
        own = [formula for formula, one in wrong if not one.source]
        has_wrong_positions = is_contradicted and match.candidate.basis == "energies"
        if has_wrong_positions:
            own = [one for one in own if not POINT.match(one.subject.removesuffix("_dot"))]
        if len(own) == 1 and own[0].subject in abbreviations:
            return -1  # all that contains it is right
        return len(own) + has_wrong_positions

    matched = {**others, "energies": best}
    fewest = {basis: slips(match) for basis, match in matched.items()}
    order = [basis for basis in ("positions", "energies", "catalogue") if basis in fewest]
    first = min(order, key=lambda basis: (fewest[basis], -matched[basis].support))
    has_fewer = fewest[first] < fewest["energies"]
    return matched[first], has_fewer and matched[first].score >= best.score - TIE


def _with_one_wrong_position(
    best: Match, matches: Sequence[Match], judges: Judges
) -> tuple[Match, bool]:
    """The match of stated positions, or of a known system that fits all but one of these.

    The second value is whether it does.
    """
    formulas = judges.statements.formulas
    for match in matches if len(best.failed) > 1 else ():
        one = match.candidate
        is_known = one.basis == "catalogue" and one.is_usual and not one.lacking
        if is_known and match.score >= best.score - TIE:
            wrong = judges.wrong(one)
            subject = formulas[wrong[0]].subject if len(wrong) == 1 else ""
            is_position = POINT.match(subject) and not order(subject)
            if is_position and judges.count_wrong(best.candidate) > 1:
                return match, True
    return best, False


def _rates_and_energies(best: Match, judges: Judges) -> dict[int, frozenset[int]]:
    """What differs from stated positions, if rates of these and energies both do.

    A slip in a position is as likely, with which both can agree, and what follows from them.
    """
    if best.candidate.basis != "positions":
        return {}
    formulas, wrong = judges.statements.formulas, judges.wrong(best.candidate)
    places = {k: stem(formulas[k].subject) for k in wrong}
    rates = [k for k, one in places.items()
             if POINT.match(one) and one not in judges.letters.coordinates]  # fmt: skip
    energies = [k for k in wrong if formulas[k].subject in judges.letters.quantities]
    both = frozenset((*rates, *energies))
    return dict.fromkeys(wrong, both) if rates and energies else {}


def _abbreviations(formulas: Sequence[DocumentFormula], letters: Letters) -> set[str]:
    """Names that a document defines by others, and uses several times."""
    used = Counter(word for one in formulas for word in one.words if word != one.subject)
    known = {*letters.quantities, *letters.coordinates, *letters.momenta, *letters.parameters}
    subjects = {one.subject for one in formulas} - known - {""}
    return {name for name in subjects if used[name] >= SEVERAL and name.isidentifier()}
