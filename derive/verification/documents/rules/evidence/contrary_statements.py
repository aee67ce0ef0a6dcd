"""Statements of a document that contradict a formula, and can be the wrong ones."""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property

from derive.verification.documents.formula_translation import order, stem
from derive.verification.documents.letters.candidates import SystemCandidate
from derive.verification.documents.rules.consequences import WithVerdict, opposed
from derive.verification.documents.rules.evidence.support import OF_ENERGIES, Support
from derive.verification.documents.rules.frequencies import OF_SMALL_MOTIONS
from derive.verification.documents.rules.side_verdict import HOLDING, SideVerdict
from derive.verification.documents.statements import WORD, DocumentFormula

#: The derivative of an energy by a coordinate or a velocity.
DERIVATIVE = re.compile(r"d[A-Z]\w*_d")
#: Formulas that hold, for each that does not, where a document goes on with the same system.
CONTINUED = 2


class ContraryStatements:
    """Energies and definitions beside a formula that need not be wrong itself."""

    def __init__(
        self,
        results: Sequence[WithVerdict],
        candidate: SystemCandidate,
        support: Support,
        lines: Mapping[int, int],
    ) -> None:
        self._results, self._candidate = results, candidate
        self._support, self._lines = support, lines

    def doubt(self, number: int) -> str:
        """Why a formula that contradicts others need not be wrong; empty if none of these is."""
        lines = (
            find(number)
            for find in (self._wrong_part, self._one_energy, self._lone_energy, self._other_energy)
        )
        line = next(filter(None, lines), None)
        return "" if line is None else opposed(line)

    def _wrong_part(self, number: int) -> int | None:
        """The line of a wrong formula that states a name in this one.

        Or of any that states the wrong part of a sum of energies. A momentum is a variable of a
        Hamiltonian, whatever formula states it.
        """
        formula, own = self._results[number]
        words = {*formula.words} - {formula.subject}
        changes = own.verdict.corrections if own.kind in OF_ENERGIES else ()
        terms = {one.wrong.lstrip("+- ") for one in changes}
        return next(
            (
                self._lines[k]
                for k, (one, result) in enumerate(self._results)
                if result.verdict.verdict == "wrong"
                or (result.verdict.verdict == "definition" and one.subject in terms)
                if one.subject in words - self._candidate.letters
                and one.subject not in self._candidate.coordinates
                and not order(one.subject)
                and (own.kind, result.kind) != ("hamiltonian", "momenta")
            ),
            None,
        )

    def _other_energy(self, number: int) -> int | None:
        """The line of an energy before a formula that can be one of another system."""
        before = self._results[:number]
        return next(
            (
                self._lines[k]
                for k, (_, one) in enumerate(before)
                if one.kind in OF_ENERGIES
                and one.verdict.verdict == "wrong"
                and not self._support.is_explained(one)
                and not self._holds_after(k)
            ),
            None,
        )

    def _one_energy(self, number: int) -> int | None:
        """The line of the one energy that states the system, if no motion supports it.

        Against another energy, a formula of motions supports it, or another side of its chain;
        against several equations of motion, one of these that holds, or a frequency.
        """
        stating = [*self._candidate.stating]
        if self._candidate.basis != "energies" or len(stating) != 1:
            return None
        equations = {
            k: one.verdict.verdict in HOLDING
            for k, (formula, one) in enumerate(self._results)
            if len(formula.sides) > 1
            and (2 in map(order, formula.words) or any("ddt(" in s.text for s in formula.sides))
        }
        held = [formula for formula, one in self._results if one.verdict.verdict in HOLDING]
        frequencies = any(one.verdict.note == OF_SMALL_MOTIONS for _, one in self._results)
        words = {word for formula in held for word in formula.words}
        if self._results[number][1].kind in OF_ENERGIES:
            is_supported = any(order(one.subject) for one in held) or any(
                order(word) == 2 or DERIVATIVE.match(word) for word in words
            )
            is_supported = is_supported or self._has_another_side(number)
        else:
            is_supported = number not in equations or len(equations) == 1 or frequencies
            is_supported = is_supported or any(equations.values())
        return None if is_supported else self._lines[stating[0]]

    def _has_another_side(self, number: int) -> bool:
        """Whether a side of a wrong chain that moves is another than the wrong one."""
        formula, result = self._results[number]
        wrong = {side for _, side in result.parts}
        others = (one.text for one in formula.sides[1:] if one not in wrong)
        return any(map(order, WORD.findall(" ".join(others))))

    def _lone_energy(self, number: int) -> int | None:
        """The line of a stated energy if other equations contradict it, and none confirms a term.

        A slip in the energy is as likely. A wrong formula confirms parameters beside its wrong
        term; other energies, which follow from the stated one, confirm no equation.
        """
        _, result = self._results[number]
        is_of_energies = self._candidate.basis == "energies" and not self._candidate.is_of_equations
        if not is_of_energies or not result.verdict.corrections:
            return None
        text = " ".join(one.correct for one in result.verdict.corrections)
        own = {*WORD.findall(text)} & self._candidate.letters
        stating = self._candidate.stating
        is_confirmed = any(
            own <= set[str]().union(*_confirmed(formula, one))
            for k, (formula, one) in enumerate(self._results)
            if k not in stating
            and one is not result
            and (result.kind in OF_ENERGIES or one.kind not in OF_ENERGIES)
        )
        is_contradicted = any(
            one.verdict.verdict not in HOLDING and own <= {*formula.words}
            for k, (formula, one) in enumerate(self._results)
            if k not in stating and one is not result and 2 in map(order, formula.words)
        )
        lines = (self._lines[k] for k in stating if own & {*self._results[k][0].words})
        return min(lines, default=None) if is_contradicted and not is_confirmed else None

    def can_be_of_another_case(self, number: int) -> bool:
        """Whether an energy is stated again between the stated system and a formula."""
        held = (k for k, (_, one) in enumerate(self._results) if one.verdict.verdict in HOLDING)
        first = min(self._candidate.stating, default=next(held, 0))
        return any(first < k <= number or number <= k < first for k in self._cases)

    @cached_property
    def _cases(self) -> list[int]:
        """Energies that are stated again, with other equations, as for another case.

        Not if most formulas after one hold.
        """
        if len(self._support.wrong) < 2 or self._candidate.basis not in ("energies", "catalogue"):
            return []
        stating = self._candidate.stating
        held = {
            formula.subject
            for k, (formula, one) in enumerate(self._results)
            if k in stating or one.verdict.verdict in HOLDING
        }
        return [
            k
            for k, (formula, one) in enumerate(self._results)
            if one.verdict.verdict == "wrong"
            and one.kind in OF_ENERGIES
            and formula.subject in held
            if k not in stating and formula.subject and not self._holds_after(k)
        ]

    def _holds_after(self, number: int) -> bool:
        """Whether most formulas on the motion hold that follow a formula."""
        moving = {*self._candidate.coordinates}
        own = self._candidate.letters
        after = Counter(
            one.verdict.verdict
            for formula, one in self._results[number + 1 :]
            if moving & {*map(stem, formula.words)} and own & {*formula.words}
        )
        return after["verified"] + after["equivalent"] > CONTINUED * after["wrong"]


def _confirmed(formula: DocumentFormula, result: SideVerdict) -> Iterator[set[str]]:
    """The names in each side of a formula that holds, or holds but for one term."""
    changes = result.verdict.corrections
    for side in formula.sides:
        if result.verdict.verdict in HOLDING:
            yield {*WORD.findall(side.text)}
        elif len(changes) == 1 and changes[0].wrong in side.text:
            yield {*WORD.findall(side.text.replace(changes[0].wrong, ""))}
