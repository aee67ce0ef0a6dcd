"""How well a system that is known from elsewhere fits the formulas of a document."""

import re
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from functools import cached_property
from itertools import combinations

import sympy as sp

from derive.formulas.expression import FUNCTIONS, number, parse
from derive.formulas.syntax import ExpressionError
from derive.reading.latex.tree import Quotient, nodes
from derive.verification.documents.formula_translation import order, stem
from derive.verification.documents.letters.candidates import SystemCandidate, kind_of
from derive.verification.documents.letters.document_system import derivation
from derive.verification.documents.rules.consequences import WithVerdict
from derive.verification.documents.rules.evidence.loads import added
from derive.verification.documents.rules.evidence.slips import is_change, is_slip
from derive.verification.documents.rules.side_verdict import CORRECT, HOLDING, SideVerdict
from derive.verification.documents.statements import WORD, DocumentFormula
from derive.verification.judging.motion_verdicts import NOT_LINEAR

#: Kinds of formulas that no other case of the system gives.
OF_ENERGIES = ("kinetic_energy", "potential_energy", "lagrangian", "energy", "hamiltonian")
#: Formulas that hold for each that no slip explains, so that these are wrong.
MANY = 4
#: Formulas that do not hold, which can be slips even if as few hold.
FEW = 3
#: Signs between terms.
TERMS = re.compile(r"\s[-+]\s")
#: Letters outside of wrong terms from which on a formula speaks for a system by itself.
AGREEING = 6


class Support:
    """The formulas that hold with a system and those that do not."""

    def __init__(
        self, results: Sequence[WithVerdict], candidate: SystemCandidate, is_partial: bool
    ) -> None:
        self._results, self._candidate, self._is_partial = results, candidate, is_partial
        wrong = [one for one in results if _is_wrong(one)]
        corrections = {one.verdict.corrections for _, one in wrong}
        self._slips = {one for one in corrections if is_slip(one)}
        self.wrong = [one for formula, one in wrong if not is_ambiguous(formula)]
        self.independent = [one for one in self.wrong if not one.source]
        self.misfits = sum(one.verdict.corrections not in self._slips for one in self.independent)
        held = (formula for formula, one in results if one.verdict.verdict in HOLDING)
        self.holding = sum(not _is_vacant(formula) for formula in held)

    def is_explained(self, result: SideVerdict) -> bool:
        """Whether a slip explains that a formula does not hold, its form, or all others hold."""
        verdict = result.verdict
        is_slip_or_form = verdict.corrections in self._slips or verdict.note.endswith(NOT_LINEAR)
        # of two energies that differ in several terms, either can be the wrong one
        is_free = self._candidate.basis == "energies" and not self._candidate.constraints
        is_energy = is_free and result.kind in OF_ENERGIES
        is_one_term = len(verdict.corrections) < 2 or not is_energy
        return is_slip_or_form or (is_one_term and self._is_rest_right)

    def holds_elsewhere(self, formula: DocumentFormula, result: SideVerdict) -> bool:
        """Whether one slip explains a formula of which the document has the right form, too."""
        return is_change(result.verdict.corrections) and any(
            one.subject == formula.subject != "" and other.verdict.verdict in HOLDING
            for one, other in self._results
        )

    def is_of_definitions(self, formula: DocumentFormula, result: SideVerdict) -> bool:
        """Whether a slip explains a relation of coordinates and names that they define.

        It depends on no system, as θ₁² + θ₂² = (h² + q²)/2 with h = θ₁ + θ₂ and q = θ₁ - θ₂.
        """
        own, coordinates = {*formula.words} - {*FUNCTIONS}, {*self._candidate.coordinates}
        defined = {
            one.subject
            for one, other in self._results
            if other.verdict.verdict == "definition" and one is not formula
            if {*one.words} - {one.subject, *FUNCTIONS} <= coordinates
        } - coordinates
        is_one = is_change(result.verdict.corrections)
        return is_one and bool(own & defined) and own <= coordinates | defined

    def defining_a_part(self, formula: DocumentFormula, result: SideVerdict) -> int | None:
        """The line that defines a part of a sum of parts, where a lost term is none of these.

        The lost term can be one of the part, as of H_0 in H = H_0 + H_1.
        """
        defined = {
            one.subject: one.occurrence.line
            for one, other in self._results
            if other.verdict.verdict == "definition" and one.subject and one is not formula
        }
        corrections = result.verdict.corrections
        terms = [WORD.findall(one) for one in TERMS.split(formula.sides[-1].text)]
        lines = [defined[word] for term in terms for word in term if word in defined]
        is_lost = len(corrections) == 1 and not corrections[0].wrong
        are_all = len(terms) > 1 and all(any(word in defined for word in term) for term in terms)
        return min(lines) if is_lost and are_all else None

    @cached_property
    def _is_rest_right(self) -> bool:
        """Whether all formulas of motions hold, but for one, or a few that no slip explains."""
        own = {*self._candidate.coordinates}
        undecided = any(
            one.verdict.verdict not in (*CORRECT, "wrong") and own & {*map(stem, formula.words)}
            for formula, one in self._results
        )
        is_stated = self.holding > 0 or self._candidate.basis == "positions"
        are_few = len(self.independent) == 1 or self._are_few
        return is_stated and are_few and not undecided

    @property
    def is_minor(self) -> bool:
        """Whether many formulas do not hold, more than do: most are of another case."""
        return len(self.independent) > max(self.holding, FEW)

    @cached_property
    def is_weak(self) -> bool:
        """Whether the system holds for too little, or a slip does not explain all differences."""
        lacking = {*_lacking(self._results, self._candidate)}
        scales = {*_scales(self._candidate, lacking)}
        has_all = not lacking or (self.holding > 0 and lacking == scales)
        formulas = [formula for formula, _ in self._results]
        has_units = bool(self._candidate.numbers) and any(
            order(one.subject) == 2 for one in formulas
        )
        if lacking or has_units:  # other accelerations can have a potential of their own
            has_all = has_all and not _is_conservative(formulas)
        is_open = self._is_partial or self._candidate.has_unusual_letters
        return is_open or not has_all or self._has_none or self._has_other_mistakes

    @property
    def _has_none(self) -> bool:
        """Whether no formula holds, and those that do not are no evidence of the system."""
        hardly_agrees = any(_agreeing(*one) < AGREEING for one in self._results if _is_wrong(one))
        return self.holding == 0 and (
            ((self._has_energy or self._are_signs) and len(self.wrong) > 1)
            or hardly_agrees
            or bool(self._candidate.constraints)
            or any(added(*one) for one in self._results)
        )

    @property
    def _has_other_mistakes(self) -> bool:
        """Whether there are many mistakes that are no slips, or many slips, one in an energy.

        An energy and an equation that contradict the system alike speak against the system.
        """
        slips = {tuple(t.wrong for t in one.verdict.corrections) for one in self.independent}
        few = max(1, min(self.holding, max(2, self.holding // 2)))
        are_many = not (self._are_few or self._is_rest_right)
        return are_many or (self._has_energy and len(slips) > few)

    @property
    def _are_few(self) -> bool:
        """Whether formulas that no slip explains are few beside those that hold."""
        return self.holding >= MANY * self.misfits

    @property
    def _has_energy(self) -> bool:
        return any(one.kind in OF_ENERGIES for one in self.wrong)

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
        terms = [t for one in self.wrong for t in one.verdict.corrections]
        corrected = Counter(word for t in terms for word in WORD.findall(t.wrong))
        is_whole = gravity and all(words[one] == corrected[one] > 0 for one in gravity)
        return bool(is_whole) and all(_unsigned(t.wrong) == _unsigned(t.correct) for t in terms)


def is_ambiguous(formula: DocumentFormula) -> bool:
    """Whether it is not certain what stands below a slash of a formula."""
    parts = nodes(formula.occurrence.sides)
    return any(isinstance(one, Quotient) and one.is_ambiguous for one in parts)


def is_linear_in_rates(formula: DocumentFormula) -> bool:
    """Whether a value is a sum of rates with factors, as an angular momentum is."""
    value = _own_value(formula)
    if value is None:
        return False
    rates = [one for one in value.free_symbols if order(str(one)) == 1]
    scale = sp.Symbol("scale of rates")
    return bool(rates) and sp.expand(value.subs({v: scale * v for v in rates}) - scale * value) == 0


def _is_wrong(one: WithVerdict) -> bool:
    return one[1].verdict.verdict == "wrong"


def _is_vacant(formula: DocumentFormula) -> bool:
    """Whether a formula states nothing but that an acceleration or a rate is zero."""
    return bool(order(formula.subject)) and _own_value(formula) == 0


def _own_value(formula: DocumentFormula) -> sp.Expr | None:
    """The last side of a formula in its own names; None if it is no number."""
    names = {word: sp.Symbol(word) for word in formula.words if word not in FUNCTIONS}
    try:
        return number(formula.sides[-1].text, {**names, **FUNCTIONS})
    except (ExpressionError, TypeError, ValueError):
        return None


def acceleration(formula: DocumentFormula) -> sp.Expr | None:
    """The only acceleration of an equation, in its own names; None of others."""
    names = {word: sp.Symbol(word) for word in formula.words if word not in FUNCTIONS}
    unknown = [symbol for word, symbol in names.items() if order(word) == 2]
    try:
        left, right = (number(one.text, {**names, **FUNCTIONS}) for one in formula.sides)
        difference = sp.expand(left - right)
    except (ExpressionError, TypeError, ValueError):
        return None
    slope = difference.diff(unknown[0]) if len(unknown) == 1 else sp.S.Zero
    if slope == 0 or slope.has(unknown[0]):
        return None
    return sp.cancel(-difference.subs(unknown[0], 0) / slope)


def _agreeing(formula: DocumentFormula, result: SideVerdict) -> int:
    """How many letters of a formula stand outside its wrong terms."""
    written = sum(len(WORD.findall(side.text)) for side in formula.sides)
    return written - sum(len(WORD.findall(one.wrong)) for one in result.verdict.corrections)


def _unsigned(term: str) -> str:
    return term.lstrip("+- ").removeprefix("(").removesuffix(")").replace(" ", "")


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
