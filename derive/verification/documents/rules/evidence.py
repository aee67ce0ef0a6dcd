"""Which verdicts stand by the evidence of a document.

No right formula is to be called wrong: a verdict without enough evidence becomes `context`.
"""

import ast
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import combinations

import sympy as sp

from derive.formulas.expression import FUNCTIONS, parse
from derive.formulas.syntax import ExpressionError, syntax_tree
from derive.reading.latex.grammar.products import AMBIGUOUS
from derive.reading.latex.tree import Quotient, nodes
from derive.system.symbols import TIME
from derive.verification.documents.formula_translation import order, stem
from derive.verification.documents.letters.candidates import SystemCandidate, kind_of
from derive.verification.documents.letters.document_system import derivation
from derive.verification.documents.rules.consequences import (
    FOLLOWS,
    UNDECIDED,
    Contradictions,
    WithVerdict,
    opposed,
)
from derive.verification.documents.rules.mass_positions import is_no_rate
from derive.verification.documents.rules.side_verdict import SideVerdict, plain
from derive.verification.documents.statements import POINT, WORD, DocumentFormula
from derive.verification.judging.engine import joined
from derive.verification.judging.motion_verdicts import NOT_LINEAR
from derive.verification.judging.verdict import Correction

#: Kinds of formulas that no other case of the system gives.
OF_ENERGIES = ("kinetic_energy", "potential_energy", "lagrangian", "energy", "hamiltonian")
#: Verdicts on formulas that hold.
HOLDING = ("verified", "equivalent")

#: Letters outside of wrong terms from which on a formula speaks for a system by itself.
AGREEING = 6
#: A Lagrangian or a Hamiltonian with a word as its index.
FURTHER = re.compile(r"[LH]_([A-Za-z]{2,})")
#: Moments of inertia.
INERTIA = re.compile(r"[IJ](_\w+)?")
#: The reason of a verdict on a single formula that holds with an unusual meaning of angles alone.
UNSTATED = "it holds with angles from the horizontal alone, which nothing states: use --names"
#: The note on a formula whose dimensions contradict those of all others.
INHOMOGENEOUS = "its dimensions contradict those of all other formulas"
#: The note on a rate that contradicts any position.
NO_RATE = "nothing that depends on the coordinates has this rate"
#: The reason of a verdict that a system without enough support gives.
UNSUPPORTED = (
    "it does not hold for the system that fits best, but this fits too few other formulas to call "
    "it wrong: state the system by --system"
)
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
    several wrong ones is an energy that is stated correctly elsewhere, as for another case; nor if
    it has the index of a further Lagrangian, as of L_small; nor if it is the rate of a position
    that a system of energies or equations does not contain; nor if it gives a name a number, as in
    an example. A system that is known from elsewhere must have a formula that holds, or corrections
    in the letters of the formula; a letter for each of its parameters in formulas that are
    judged, unless that is a factor of the Lagrangian, such as the mass of a single body, and the
    accelerations as written have no potential of their own; a letter for several of them, such as
    for both masses, in a formula that holds; and no more formulas with more than one wrong term, or
    slips if one is in an energy, than half of those that hold, of which there must be one. With a
    partial search for it, none is wrong. A formula whose dimensions contradict those of all others
    needs no more evidence if one term is wrong.
    """
    evidence = _Evidence(results, candidate, contradictions, is_stated, is_partial)
    for number, (formula, _) in enumerate(results):
        yield formula, evidence.weighed(number)


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
        self._is_stated, self._is_partial = is_stated, is_partial
        self._is_known = candidate.basis == "catalogue" and not is_stated
        self._lines = {k: formula.occurrence.line for k, (formula, _) in enumerate(results)}
        self._wrong = [one for _, one in results if one.verdict.verdict == "wrong"]
        self._independent = [one for one in self._wrong if FOLLOWS not in one.verdict.note]
        self._misfits = sum(len(one.verdict.corrections) != 1 for one in self._independent)
        held = (formula for formula, one in results if one.verdict.verdict in HOLDING)
        self._holding = sum(not _is_vacant(formula) for formula in held)
        self._has_energy = any(one.kind in OF_ENERGIES for one in self._wrong)
        self._given = _lines(self._lines[k] for k in candidate.stating)
        self._undecided = {*_of_friction(results, candidate)}

    def weighed(self, number: int) -> SideVerdict:
        """The verdict on a formula in the light of the others."""
        formula, result = self._results[number]
        if number == self._contradictions.inhomogeneous:
            own = self._of_dimensions(formula, result)
            if own is not None:
                return own
        is_wrong = result.verdict.verdict == "wrong"
        if is_wrong and is_no_rate(formula, self._candidate):
            return _noted(result, NO_RATE)
        if self._is_known and self._holding == 0 and result.verdict.verdict in HOLDING:
            return plain("context", formula, UNSUPPORTED)  # nothing but zeros holds
        if self._is_guess and (is_wrong or result.verdict.verdict in HOLDING):
            return plain("context", formula, UNSTATED)
        if result.verdict.verdict in HOLDING and number in self._contradictions.disputed:
            line = self._lines[min(self._contradictions.disputed[number])]
            return plain("context", formula, opposed(line))
        if is_wrong and (doubt := self._doubt(number)):
            return plain("context", formula, doubt)
        return _noted(result, f"given {self._given}") if is_wrong and self._given else result

    def _of_dimensions(self, formula: DocumentFormula, result: SideVerdict) -> SideVerdict | None:
        """The verdict on the formula whose dimensions contradict those of all others."""
        verdict = result.verdict
        if verdict.verdict == "wrong":
            if len(verdict.corrections) != 1:
                return None
            noted = _noted(result, INHOMOGENEOUS)
            return _noted(noted, f"given {self._given}") if self._given else noted
        if self._contradictions.lost_dots:
            return of_lost_dots(formula, self._contradictions)
        if verdict.verdict == "definition":
            return plain("context", formula, INHOMOGENEOUS)
        return None

    def _doubt(self, number: int) -> str:
        """Why a formula that contradicts the system need not be wrong; empty if it is."""
        formula, result = self._results[number]
        if any(
            isinstance(one, Quotient) and one.is_ambiguous
            for one in nodes(formula.occurrence.sides)
        ):
            return AMBIGUOUS
        other_case = f"it differs from {self._given or 'others'}: {OTHER_CASE}"
        inhomogeneous = self._contradictions.inhomogeneous
        if inhomogeneous is not None and inhomogeneous in self._candidate.stating:
            return opposed(self._lines[inhomogeneous])
        if self._further_inertia and not result.verdict.note.endswith(NOT_LINEAR):
            return f"line {self._further_inertia} states an inertia beside the positions"
        if number in self._contradictions.doubts:
            others = self._contradictions.doubts[number] - {number}
            beside = f" and agrees with {_lines(self._lines[k] for k in others)}" if others else ""
            return f"it contradicts {self._given or 'the system'}{beside}: {UNDECIDED}"
        if formula.subject in self._unused:
            return opposed(self._unused[formula.subject])
        if number in self._undecided:
            return f"it contradicts the stated friction: {UNDECIDED}"
        if self._has_cases:
            return other_case
        if any(index in word for index in self._other_indices for word in formula.words):
            return other_case
        if self._is_weak or self._unsure & {*formula.words} or self._is_of_loads(result):
            return UNSUPPORTED
        added = [t for t in result.verdict.corrections if t.correct == "0"]
        if any(not WORD.search(t.wrong) for t in added) and 2 in map(order, formula.words):
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
            return other_case if _is_driven(self._candidate) else ""
        if self._is_tie or _adds_letters(formula, result, self._candidate):
            return other_case
        return ""

    @cached_property
    def _further_inertia(self) -> int | None:
        """The line of an energy with a moment of inertia, which positions do not state."""
        if self._candidate.basis != "positions":
            return None
        own = self._candidate.letters
        for number, (formula, one) in enumerate(self._results):
            others = {*filter(INERTIA.fullmatch, formula.words)} - own
            if others and not one.is_understood and 1 in map(order, formula.words):
                return self._lines[number]
        return None

    @cached_property
    def _is_weak(self) -> bool:
        """Whether a system that is known from elsewhere fits too little."""
        lacking = {*_lacking(self._results, self._candidate)}
        scales = {*_scales(self._candidate, lacking)}
        has_all = not lacking or (self._misfits == 0 < self._holding and lacking == scales)
        formulas = [formula for formula, _ in self._results]
        has_units = bool(self._candidate.numbers) and any(
            order(one.subject) == 2 for one in formulas
        )
        if lacking or has_units:  # other accelerations can have a potential of their own
            has_all = has_all and not _is_conservative(formulas)
        # an energy and an equation that contradict the system alike speak against the system
        terms = {tuple(t.wrong for t in one.verdict.corrections) for one in self._independent}
        slips = max(self._misfits, len(terms) if self._has_energy else 0)
        few = max(1, min(self._holding, max(2, self._holding // 2)))
        is_unsure = self._has_energy or self._are_signs
        is_several = is_unsure and len(self._wrong) > 1
        hardly_agrees = any(_agreeing(*one) < AGREEING for one in self._results if _is_wrong(one))
        has_none = self._holding == 0 and (
            is_several
            or hardly_agrees
            or bool(self._candidate.constraints)
            or any(_added(*one) for one in self._results)
        )
        is_open = self._is_partial or self._candidate.has_unusual_letters
        return self._is_known and (is_open or not has_all or has_none or slips > few)

    def _loads_in(self, term: Correction) -> set[str]:
        """The letters of forces and friction in a term or in its correction."""
        loads = {name for name, _ in (*self._candidate.forces, *self._candidate.friction)}
        return loads & {*WORD.findall(f"{term.wrong} {term.correct}")}

    def _is_of_loads(self, result: SideVerdict) -> bool:
        """Whether a known system has other letters of forces and friction, and else agrees."""
        terms = result.verdict.corrections
        written = [{*WORD.findall(t.wrong)} & self._loads_in(t) for t in terms]
        other = [{*WORD.findall(t.correct)} & self._loads_in(t) for t in terms]
        pairs = [*zip(written, other, strict=True)]
        is_exchanged = any(a and b and a != b for a, b in pairs)
        return self._is_known and is_exchanged and all(a or b for a, b in pairs)

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
    def _are_signs(self) -> bool:
        """Whether all corrections are of the sign of gravity, as with angles from upright."""
        own, words = self._candidate.parameters, Counter[str]()
        names = (one.symbol.name for one in self._candidate.system.parameters
                 if kind_of(one) == "gravity")  # fmt: skip
        gravity = {own[name] for name in names if name in own}
        for formula, one in self._results:
            if one.verdict.verdict == "wrong":
                words.update(w for side in formula.sides for w in WORD.findall(side.text))
        terms = [t for one in self._wrong for t in one.verdict.corrections]
        corrected = Counter(word for t in terms for word in WORD.findall(t.wrong))
        is_whole = gravity and all(words[one] == corrected[one] > 0 for one in gravity)
        return bool(is_whole) and all(_unsigned(t.wrong) == _unsigned(t.correct) for t in terms)

    @property
    def _is_guess(self) -> bool:
        """Whether a single formula supports an unusual meaning of angles."""
        return self._is_known and self._holding < 2 and self._candidate.is_turned

    @property
    def _is_tie(self) -> bool:
        """Whether equations that state a system are no more certain than one that differs."""
        is_alone = len(self._independent) == 1 and self._holding >= 2 and self._misfits == 0
        return self._candidate.is_of_equations and not is_alone

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
    def _has_cases(self) -> bool:
        """Whether an energy is stated again, with other equations, as for another case."""
        if len(self._wrong) < 2 or self._is_stated:
            return False
        stating = self._candidate.stating
        held = {
            formula.subject
            for k, (formula, one) in enumerate(self._results)
            if k in stating or one.verdict.verdict in HOLDING
        }
        return self._candidate.basis in ("energies", "catalogue") and any(
            one.verdict.verdict == "wrong" and one.kind in OF_ENERGIES and formula.subject in held
            for k, (formula, one) in enumerate(self._results)
            if k not in stating and formula.subject
        )

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


def _is_wrong(one: WithVerdict) -> bool:
    return one[1].verdict.verdict == "wrong"


def _is_vacant(formula: DocumentFormula) -> bool:
    """Whether a formula states nothing but that an acceleration or a rate is zero."""
    if not order(formula.subject):
        return False
    names = {word: sp.Symbol(word) for word in formula.words if word not in FUNCTIONS}
    try:
        return bool(parse(formula.sides[-1].text, {**names, **FUNCTIONS}) == 0)
    except (ExpressionError, TypeError, ValueError):
        return False


def _agreeing(formula: DocumentFormula, result: SideVerdict) -> int:
    """How many letters of a formula stand outside its wrong terms."""
    written = sum(len(WORD.findall(side.text)) for side in formula.sides)
    return written - sum(len(WORD.findall(one.wrong)) for one in result.verdict.corrections)


def _unsigned(term: str) -> str:
    return term.lstrip("+- ").removeprefix("(").removesuffix(")").replace(" ", "")


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


def of_lost_dots(formula: DocumentFormula, contradictions: Contradictions) -> SideVerdict:
    """The verdict on a formula that lacks dots, which its dimensions alone show."""
    result = plain("wrong", formula, INHOMOGENEOUS)
    verdict = replace(result.verdict, corrections=contradictions.lost_dots)
    return replace(result, verdict=verdict, parts=((0, formula.sides[-1]),))


def _is_driven(candidate: SystemCandidate) -> bool:
    """Whether equations of a driven motion state the system, which leave its energies open."""
    return candidate.is_of_equations and candidate.system.potential_energy.has(TIME)


def _of_friction(results: Sequence[WithVerdict], candidate: SystemCandidate) -> Iterator[int]:
    """Yield the numbers of wrong formulas that differ in friction of Rayleigh's function.

    This can be wrong, too: it is right if it leads to other formulas that contain its letters.
    """
    if candidate.basis not in ("positions", "energies"):
        return
    names = {symbol.name for symbol in sp.Tuple(*candidate.system.forces).free_symbols}
    letters = {letter for name, letter in candidate.parameters.items() if name in names}
    supported = {
        word
        for formula, one in results
        if one.verdict.verdict in HOLDING and formula.subject not in letters
        for word in formula.words
    }
    for number, (formula, result) in enumerate(results):
        if result.verdict.verdict == "wrong":
            terms = [
                text for one in result.verdict.corrections for text in (one.wrong, one.correct)
            ]
            words = {w for text in terms for w in WORD.findall(text)} or {*formula.words}
            own = words & letters
            if own and not own <= supported:
                yield number


def _adds_letters(
    formula: DocumentFormula, result: SideVerdict, candidate: SystemCandidate
) -> bool:
    """Whether a correction has forces or friction that a formula, as of a case without, has not.

    Of a system that equations state, these are all letters; of a known system parameters, too, if
    the formula is that of a free motion.
    """
    added = _added(formula, result)
    if candidate.is_of_equations:
        return bool(added)
    loads = {name for name, _ in (*candidate.forces, *candidate.friction)}
    loads |= {*_of_drives(candidate)}
    parameters = {*candidate.parameters.values()}
    is_zero = any(side.text == "0" for side in formula.sides)
    is_free = is_zero and all(order(one) == 2 or one in parameters for one in formula.words)
    if candidate.basis == "catalogue" and is_free:
        loads |= parameters
    return bool(added & loads)


def _added(formula: DocumentFormula, result: SideVerdict) -> set[str]:
    """The letters of corrections that a formula has not, but for a lost dot."""
    terms = [one for one in result.verdict.corrections if one.correct != f"{one.wrong}_dot"]
    names = {word for one in terms for word in WORD.findall(one.correct)}
    return names - {*formula.words, *FUNCTIONS}


def _of_drives(candidate: SystemCandidate) -> Iterator[str]:
    """The letters of friction and of given functions of time in a system."""
    system = candidate.system
    places = (component for one in system.masses for component in one.position)
    energies = sp.Add.make_args(sp.expand(system.potential_energy))
    driving = [one for one in (*places, *energies) if one.has(TIME)]
    if driving and not derivation(system).lagrangian.has(TIME):
        driving = []  # in a rotating frame
    symbols = sp.Tuple(system.dissipation, *system.forces, *driving).free_symbols
    for parameter in system.parameters:
        if parameter.symbol in symbols and parameter.symbol.name in candidate.parameters:
            yield candidate.parameters[parameter.symbol.name]


def _lacking(results: Sequence[WithVerdict], candidate: SystemCandidate) -> Iterator[str]:
    """The parameters of a system that have no number, and no letter in a formula that is judged.

    A letter of other formulas alone can be one of another system.
    """
    judged = {w for formula, one in results if one.verdict.verdict != "context"
              for w in formula.words}  # fmt: skip
    known = {name for name, letter in candidate.parameters.items() if letter in judged}
    known |= {*candidate.numbers}
    return (p.symbol.name for p in candidate.system.parameters if p.symbol.name not in known)


def _scales(candidate: SystemCandidate, names: Collection[str]) -> Iterator[str]:
    """Those that drop out of the equations of motion: factors of the Lagrangian."""
    system = candidate.system
    if any(system.applied) or candidate.forces or candidate.friction:
        return
    for name in names:
        symbol = next(p.symbol for p in system.parameters if p.symbol.name == name)
        if not sp.expand(derivation(system).lagrangian / symbol).has(symbol):
            yield name


def _is_conservative(formulas: Sequence[DocumentFormula]) -> bool:
    """Whether accelerations that formulas state are the gradient of a potential energy."""
    words = {word for formula in formulas for word in formula.words}
    symbols = {word: sp.Symbol(word, positive=True) for word in words}
    rows = {stem(one.subject): one.sides[-1].text for one in formulas if order(one.subject) == 2}
    try:
        values = {q: parse(text, {**symbols, **FUNCTIONS}) for q, text in rows.items()}
    except ExpressionError:
        return False
    if any(order(str(symbol)) for value in values.values() for symbol in value.free_symbols):
        return False
    point = {symbols[word]: sp.Rational(k + 7, k + 5) for k, word in enumerate(sorted(words))}
    q = {name: sp.Symbol(name, positive=True) for name in rows}
    curls = (values[a].diff(q[b]) - values[b].diff(q[a]) for a, b in combinations(rows, 2))
    return all(abs(one.subs(point).evalf(30)) < 1e-20 for one in curls)


def _lines(numbers: Iterable[int]) -> str:
    """Lines in words."""
    words = [*map(str, sorted({*numbers}))]
    if not words:
        return ""
    *first, last = words
    return f"lines {', '.join(first)} and {last}" if first else f"line {last}"
