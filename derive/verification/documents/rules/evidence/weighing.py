"""Which verdicts stand by the evidence of a document.

No right formula is to be called wrong: a verdict without enough evidence becomes `context`.
"""

import ast
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property

import sympy as sp

from derive.formulas.expression import FUNCTIONS
from derive.formulas.syntax import syntax_tree
from derive.reading.latex.grammar.products import AMBIGUOUS
from derive.verification.documents.formula_translation import order, stem
from derive.verification.documents.letters.candidates import BY_POTENTIAL, SystemCandidate
from derive.verification.documents.letters.dimensions import Restoration
from derive.verification.documents.letters.letters import QUANTITIES
from derive.verification.documents.letters.subjects import ARBITRARY
from derive.verification.documents.rules.consequences import (
    UNDECIDED,
    Contradictions,
    WithVerdict,
    opposed,
    without_sources,
)
from derive.verification.documents.rules.evidence.contrary_statements import ContraryStatements
from derive.verification.documents.rules.evidence.loads import (
    adds_constant_force,
    adds_letters,
    exchanges_loads,
    is_driven,
    of_friction,
)
from derive.verification.documents.rules.evidence.support import (
    OF_ENERGIES,
    Support,
    acceleration,
    is_ambiguous,
    is_linear_in_rates,
)
from derive.verification.documents.rules.mass_positions import is_no_rate
from derive.verification.documents.rules.side_verdict import HOLDING, SideVerdict, plain
from derive.verification.documents.statements import POINT, WORD, DocumentFormula
from derive.verification.judging.engine import joined
from derive.verification.judging.motion_verdicts import NOT_LINEAR

#: A Lagrangian or a Hamiltonian with a word as its index.
FURTHER = re.compile(r"[LH]_([A-Za-z]{2,})")
#: The place of one of several bodies.
INDEXED_PLACE = re.compile(r"[xyzXYZ]_\d+")
#: Moments of inertia.
INERTIA = re.compile(r"[IJ](_\w+)?")
#: The reason of a verdict on a single formula that holds with an unusual meaning of angles alone.
UNSTATED = "it holds with angles from the horizontal alone, which nothing states: use --names"
#: The note on a formula whose dimensions contradict those of the others.
INHOMOGENEOUS = "its dimensions contradict those of the other formulas"
#: The note on a rate that contradicts any position.
NO_RATE = "nothing that depends on the coordinates has this rate"
#: The reason of a verdict that a system without enough support gives.
UNSUPPORTED = (
    "it does not hold for the system that fits best, but this fits too few other formulas to call "
    "it wrong: state the system by --system"
)
#: The end of a reason of a verdict on a formula with more than a slip.
UNEXPLAINED = "but not by one slip: it can be one of another system"
#: The reason of a verdict on an equation that differs from other equations.
OTHER_CASE = "it can be another case, or one of these can be wrong"


def weighed(
    results: Sequence[WithVerdict],
    candidate: SystemCandidate,
    contradictions: Contradictions,
    is_stated: bool,
    is_partial: bool = False,
) -> Iterator[WithVerdict]:
    """Yield the verdicts, with `context` for formulas that are wrong by too weak evidence.

    A formula is wrong by a system that the user states, or that follows from positions or energies
    in the document. It is not if other formulas of the document fit the rest as well and agree with
    it, in which case neither these nor what holds with them alone is verified; nor if one of
    several wrong ones, between it and the stated system, is an energy that is stated correctly
    elsewhere, as for another case; nor if
    it has the index of a further Lagrangian, as of L_small; nor if it is the rate of a position
    that a system of energies or equations does not contain; nor if it gives a name a number, as in
    an example. One slip must explain it, or all others must hold, but for a few. A system that is
    known from elsewhere must have a formula that holds, or corrections in the letters of the
    formula; a letter for each of its parameters in formulas that are judged, unless that is a
    factor of the Lagrangian, such as the mass of a single body, and the accelerations as written
    have no potential of their own; a letter for several of them, such as for both masses, in a
    formula that holds; no other equation that contradicts it alike; four formulas that hold for
    each that no slip explains; and no more slips, if one is in an energy, than half of the formulas
    that hold. With a partial search for it, none is wrong. A formula whose dimensions contradict
    those of all others needs no more evidence if one term is wrong.
    """
    evidence = _Evidence(results, candidate, contradictions, is_stated, is_partial)
    own = [(formula, evidence.weighed(number)) for number, (formula, _) in enumerate(results)]
    yield from without_sources(own)


class _Evidence:
    """What supports and what contradicts the verdicts on formulas by a system."""

    def __init__(
        self,
        results: Sequence[WithVerdict],
        candidate: SystemCandidate,
        contradictions: Contradictions,
        is_stated: bool,
        is_partial: bool,
    ) -> None:
        self._results, self._candidate, self._contradictions = results, candidate, contradictions
        self._is_stated = is_stated
        self._is_known = candidate.basis == "catalogue" and not is_stated
        self._lines = {k: formula.occurrence.line for k, (formula, _) in enumerate(results)}
        self._support = Support(results, candidate, is_partial)
        self._contrary = ContraryStatements(results, candidate, self._support, self._lines)
        self._given = _lines(self._lines[k] for k in candidate.stating)
        self._undecided = {*of_friction(results, candidate)}

    def weighed(self, number: int) -> SideVerdict:
        """The verdict on a formula in the light of the others."""
        formula, result = self._results[number]
        if number in self._contradictions.inhomogeneous:
            own = self._of_dimensions(number)
            if own is not None:
                return own
        is_wrong = result.verdict.verdict == "wrong"
        if is_wrong and is_no_rate(formula, self._candidate):
            return _noted(result, NO_RATE)
        if self._is_known and self._support.holding == 0 and result.verdict.verdict in HOLDING:
            return plain("context", formula, UNSUPPORTED)  # nothing but zeros holds
        if self._is_guess and (is_wrong or result.verdict.verdict in HOLDING):
            return plain("context", formula, UNSTATED)
        if result.verdict.verdict in HOLDING and number in self._contradictions.disputed:
            line = self._lines[min(self._contradictions.disputed[number])]
            return plain("context", formula, opposed(line))
        if is_wrong and (doubt := self._doubt(number)):
            return plain("context", formula, doubt)
        given = _lines(self._lines[k] for k in self._candidate.stating if k != number)
        return _noted(result, f"given {given}") if is_wrong and given else result

    def _of_dimensions(self, number: int) -> SideVerdict | None:
        """The verdict on a formula whose dimensions contradict those of all others."""
        formula, result = self._results[number]
        verdict = result.verdict
        if verdict.verdict == "wrong" and len(verdict.corrections) == 1:
            noted = _noted(result, INHOMOGENEOUS)
            return _noted(noted, f"given {self._given}") if self._given else noted
        if restoration := self._contradictions.inhomogeneous[number]:
            return of_dimensions(formula, restoration)
        if verdict.verdict == "definition":
            return plain("context", formula, INHOMOGENEOUS)
        return None

    def _doubt(self, number: int) -> str:
        """Why a formula that contradicts the system need not be wrong; empty if it is."""
        formula, result = self._results[number]
        if is_ambiguous(formula):
            return AMBIGUOUS
        other_case = f"it differs from {self._given or 'others'}: {OTHER_CASE}"
        if any(ARBITRARY in one.correct for one in result.verdict.corrections):
            return f"it contradicts {self._given or 'the system'}, {UNEXPLAINED}"
        if odd := {*self._contradictions.inhomogeneous} & {*self._candidate.stating}:
            return opposed(self._lines[min(odd)])
        if (line := self._line_of_inertia(number)) is not None:
            subject = "it" if line == self._lines[number] else f"line {line}"
            return f"{subject} states an inertia beside the positions"
        if number in self._contradictions.doubts:
            others = self._contradictions.doubts[number] - {number}
            beside = f" and agrees with {_lines(self._lines[k] for k in others)}" if others else ""
            return f"it contradicts {self._given or 'the system'}{beside}: {UNDECIDED}"
        if self._support.is_of_definitions(formula, result):
            return ""
        if (line := self._support.defining_a_part(formula, result)) is not None:
            return opposed(line)
        if formula.subject in self._unused:
            return opposed(self._unused[formula.subject])
        if number in self._undecided:
            return f"it contradicts the stated friction: {UNDECIDED}"
        is_open = not self._is_stated and not _contradicts_itself(formula, result)
        if is_open and self._contrary.can_be_of_another_case(number):
            return other_case
        if self._is_known and self._is_repeated(number):
            return other_case
        if any(index in word for index in self._other_indices for word in formula.words):
            return other_case
        if self._is_known and (
            self._has_other_energies
            or (self._support.is_weak and not self._support.holds_elsewhere(formula, result))
            or self._unsure & {*formula.words}
            or exchanges_loads(result, self._candidate)
        ):
            return UNSUPPORTED
        is_by_one = self._candidate.basis == "energies" and len(self._candidate.stating) == 1
        if is_by_one and self._support.is_minor:  # of a total energy, L or H alone
            return other_case
        if not (self._is_stated or self._support.is_explained(result)):
            return f"it contradicts {self._given or 'the system'}, {UNEXPLAINED}"
        if not self._is_stated and (doubt := self._contrary.doubt(number)):
            return doubt
        if result.kind == "lagrangian" and is_linear_in_rates(formula):
            return "it can be an angular momentum"
        if place := self._other_place(result):
            return f"{place} can be another place"
        surplus = [t for t in result.verdict.corrections if t.correct == "0"]
        if any(not WORD.search(t.wrong) for t in surplus) and 2 in map(order, formula.words):
            return "a number that is added can be a constant force"
        if line := self._special_motion(number) or self._value_in_time(formula, result):
            return f"it can hold with line {line}"
        if self._is_restated(number) or self._is_number(formula, result):
            return other_case
        if self._holds_constant(formula):
            return "a derivative can hold a constant of the motion"
        if result.kind in OF_ENERGIES and (
            self._has_further_coordinates or self._has_further_rates(formula)
        ):
            return other_case
        if result.kind in OF_ENERGIES and len(result.verdict.corrections) == 1:
            has_load = adds_constant_force(formula, result, self._candidate)
            return other_case if has_load or is_driven(self._candidate) else ""
        if self._is_tie(number) or adds_letters(formula, result, self._candidate):
            return other_case
        return ""

    def _is_repeated(self, number: int) -> bool:
        """Whether another equation that a known system contradicts has the same acceleration."""
        own = self._wrong_accelerations[number]
        others = (one for k, one in self._wrong_accelerations.items() if k != number)
        return own is not None and own in others

    @cached_property
    def _has_other_energies(self) -> bool:
        """Whether all statements of a potential or of L have letters that the system does not have.

        A letter T can be that of a tension.
        """
        stated = [(formula.subject, one) for formula, one in self._results]
        understood = {name for name, one in stated if one.is_understood}
        others = {name for name, one in stated if not one.is_understood} - understood
        kinds = {QUANTITIES.get(name) for name in others}
        return not kinds.isdisjoint(("potential_energy", "lagrangian", "hamiltonian"))

    @cached_property
    def _wrong_accelerations(self) -> dict[int, sp.Expr | None]:
        """The accelerations of wrong equations, by the numbers of formulas."""
        return {
            k: acceleration(formula)
            for k, (formula, one) in enumerate(self._results)
            if one.verdict.verdict == "wrong"
        }

    def _other_place(self, result: SideVerdict) -> str:
        """A place without a rate in the wrong term of an energy, which no other formula shows."""
        if result.kind not in OF_ENERGIES or self._candidate.basis == "positions":
            return ""
        words = [w for t in result.verdict.corrections for w in WORD.findall(t.wrong)]
        known = {*self._candidate.coordinates, *self._shown}
        places = (w for w in words if INDEXED_PLACE.fullmatch(w) and w not in known)
        return next(places, "")

    def _line_of_inertia(self, number: int) -> int | None:
        """The line of an energy with a moment of inertia, which positions do not state.

        Or that of the formula itself, if it has one, unless a side of it contradicts another.
        """
        formula, result = self._results[number]
        if self._candidate.basis != "positions" or result.verdict.note.endswith(NOT_LINEAR):
            return None
        own = self._candidate.letters
        if result.verdict.verdict == "wrong" and formula.is_conserved:
            return None  # a momentum, such as J = m*r**2*phi_dot
        if {*filter(INERTIA.fullmatch, formula.words)} - own:
            return None if _contradicts_itself(formula, result) else self._lines[number]
        for k, (other, one) in enumerate(self._results):
            others = {*filter(INERTIA.fullmatch, other.words)} - own
            if others and not one.is_understood and 1 in map(order, other.words):
                return self._lines[k]
        return None

    def _special_motion(self, number: int) -> int | None:
        """The line of a special motion with which an equation can hold.

        It gives a coordinate as a function of time, the acceleration of which the equation states,
        or of other coordinates, which stand in its place.
        """
        formula, own = self._results[number][0], {*self._candidate.coordinates}
        given = {*self._candidate.given, *self._candidate.stating}
        for k, (other, result) in enumerate(self._results):
            q = other.subject
            if k in given or q not in own or result.verdict.verdict != "context":
                continue
            is_acceleration = order(formula.subject) == 2 and stem(formula.subject) == q
            if is_acceleration and "t" in other.words:
                return self._lines[k]
            is_before = k < number and (own - {q}) & {*other.words}
            if is_before and q not in map(stem, formula.words):
                return self._lines[k]
        return None

    def _value_in_time(self, formula: DocumentFormula, result: SideVerdict) -> int | None:
        """The line of a value of a function of time that has no meaning, such as its start."""
        is_energy = result.kind in OF_ENERGIES
        has_meaning = is_energy or formula.subject in self._candidate.coordinates
        if has_meaning or "t" not in formula.words:
            return None
        return next(
            (
                self._lines[k]
                for k, (one, _) in enumerate(self._results)
                if one.subject == formula.subject and "t" not in one.words
            ),
            None,
        )

    def _is_restated(self, number: int) -> bool:
        """Whether a component of a position is stated again with further letters."""
        formula, _ = self._results[number]
        if self._candidate.basis != "positions" or not POINT.match(formula.subject):
            return False
        earlier = [
            {*one.words} for one, _ in self._results[:number] if one.subject == formula.subject
        ]
        return bool(earlier) and not {*formula.words} <= set[str]().union(*earlier)

    def _is_number(self, formula: DocumentFormula, result: SideVerdict) -> bool:
        """Whether a name that is no coordinate has a number alone, as in an example."""
        values = {word for side in formula.sides[1:] for word in WORD.findall(side.text)}
        is_other = result.kind not in OF_ENERGIES and not order(formula.subject)
        is_name = formula.subject not in {"", *self._candidate.coordinates}
        return is_other and is_name and values <= {*FUNCTIONS}

    def _holds_constant(self, formula: DocumentFormula) -> bool:
        """Whether a derivative contains a letter for a function of velocities, as ℓ of m r² φ̇."""
        operands = set[str]().union(*(one for s in formula.sides for one in _operands(s.text)))
        return any(
            operands & {side.text for side in one.sides} and any(map(order, one.words))
            for one, _ in self._results
            if one is not formula
        )

    @property
    def _is_guess(self) -> bool:
        """Whether a single formula supports an unusual meaning of angles."""
        return self._is_known and self._support.holding < 2 and self._candidate.is_turned

    def _is_tie(self, number: int) -> bool:
        """Whether equations that state a system are no more certain than one that differs.

        A term with velocities that follows from the inertia is more certain, and so is one with
        the parameters of an energy that holds.
        """
        result = self._results[number][1]
        least = 1 if number in self._contradictions.decided else 2
        is_alone = (
            len(self._support.independent) == 1
            and self._support.holding >= least
            and self._support.misfits == 0
        )
        if not self._candidate.is_of_equations or is_alone:
            return False
        if len(result.verdict.corrections) != 1 or self._support.misfits:
            return True
        (change,) = result.verdict.corrections
        words = {*WORD.findall(f"{change.wrong} {change.correct}")}
        if any(map(order, words)):
            return self._candidate.system.name != BY_POTENTIAL
        own = words & self._candidate.letters
        return not any(
            one.kind in OF_ENERGIES and one.verdict.verdict in HOLDING and own <= {*formula.words}
            for formula, one in self._results
        )

    @cached_property
    def _has_further_coordinates(self) -> bool:
        """Whether equations that state the system have a coordinate that no energy contains."""
        energies = (formula for formula, one in self._results if one.kind in OF_ENERGIES)
        moving = {stem(word) for formula in energies for word in formula.words}
        return self._candidate.is_of_equations and not {*self._candidate.coordinates} <= moving

    def _has_further_rates(self, formula: DocumentFormula) -> bool:
        """Whether an energy has rates of coordinates that the stating equations do not contain."""
        moving = {stem(word) for word in formula.words if order(word)}
        return self._candidate.is_of_equations and not moving <= {*self._candidate.coordinates}

    @cached_property
    def _other_indices(self) -> set[str]:
        """Indices of further Lagrangians with another value, such as L_small for small angles."""
        return {
            f"_{match[1]}"
            for k, (formula, one) in enumerate(self._results)
            if k not in self._candidate.stating
            and not order(formula.subject)
            and (match := FURTHER.fullmatch(formula.subject))
            and one.verdict.verdict not in HOLDING
            and any(map(order, formula.words))
        }

    @cached_property
    def _shown(self) -> set[str]:
        """The names in formulas that are verified."""
        return {
            word
            for formula, one in self._results
            if one.verdict.verdict == "verified"
            for word in formula.words
        }

    @cached_property
    def _unsure(self) -> set[str]:
        """Letters for several parameters of a known system that no formula shows to be right."""
        counts = Counter(self._candidate.parameters.values())
        several = {letter for letter, count in counts.items() if count > 1}
        return several - self._shown if self._is_known else set()

    @cached_property
    def _unused(self) -> dict[str, int]:
        """Rates of positions, or of other names, of which nothing shows that they hold.

        With the lines of their definitions, which the system does not contain.
        """
        is_any = bool(self._candidate.stating)
        return {
            f"{formula.subject}_dot": self._lines[k]
            for k, (formula, one) in enumerate(self._results)
            if (is_any or (self._is_known and not POINT.match(formula.subject)))
            and one.verdict.verdict == "definition"
            and k not in self._candidate.stating
            and formula.subject not in self._shown
        }


def _operands(text: str) -> Iterator[set[str]]:
    """The names in each operand of a derivative."""
    for node in ast.walk(syntax_tree(text)) if "diff(" in text else ():
        match node:
            case ast.Call(func=ast.Name(id="diff"), args=[operand, *_]):
                names = (one.id for one in ast.walk(operand) if isinstance(one, ast.Name))
                yield {name for name in names if not order(name)}


def _noted(result: SideVerdict, note: str) -> SideVerdict:
    """The verdict with one more note."""
    verdict = result.verdict
    return replace(result, verdict=replace(verdict, note=joined(verdict.note, note)))


def _contradicts_itself(formula: DocumentFormula, result: SideVerdict) -> bool:
    """Whether a factor of one side is wrong, and a side before it holds."""
    sides, corrections = [side for _, side in result.parts], result.verdict.corrections
    if len(sides) != 1 or len(corrections) != 1 or sides[0] not in formula.sides[2:]:
        return False
    return bool(corrections[0].wrong) and corrections[0].correct != "0"


def of_dimensions(formula: DocumentFormula, restoration: Restoration) -> SideVerdict:
    """The verdict on a formula with a term that its dimensions alone refute."""
    choices = " or ".join(restoration.choices)
    note = f"{INHOMOGENEOUS}, but not with {choices}" if choices else INHOMOGENEOUS
    result = plain("wrong", formula, note)
    verdict = replace(result.verdict, corrections=restoration.corrections)
    return replace(result, verdict=verdict, parts=((0, formula.sides[restoration.side]),))


def _lines(numbers: Iterable[int]) -> str:
    """Lines in words, without those of formulas that are not written."""
    words = [str(one) for one in sorted({*numbers}) if one]
    if not words:
        return ""
    *first, last = words
    return f"lines {', '.join(first)} and {last}" if first else f"line {last}"
