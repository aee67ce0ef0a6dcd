"""Verdicts on the formulas of a document whose letters are known."""

import re
from collections.abc import Collection, Sequence
from contextlib import suppress
from dataclasses import replace

import sympy as sp

from derive.formulas.expression import FUNCTIONS, parse
from derive.formulas.syntax import ExpressionError, summands, syntax_tree
from derive.formulas.zero import vanishes
from derive.verification.documents.formula_translation import FormulaText
from derive.verification.documents.letters.stated_constraints import WAY_OUT
from derive.verification.documents.rules.consequences import (
    UNDECIDED,
    Consequences,
    WithVerdict,
    opposed,
)
from derive.verification.documents.rules.defined_names import Abbreviations, PartialEnergies
from derive.verification.documents.rules.evidence.open_definitions import with_open_definitions
from derive.verification.documents.rules.evidence.slips import is_change, is_slip
from derive.verification.documents.rules.evidence.stated_loads import (
    AS_FORCES,
    with_contrary_loads,
)
from derive.verification.documents.rules.evidence.stated_reactions import with_reactions
from derive.verification.documents.rules.frequencies import Amplitudes, Frequencies, StatedMotions
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.mass_positions import MassPositions
from derive.verification.documents.rules.matrices import DerivedMatrices
from derive.verification.documents.rules.other_statements import AppliedLoads, OtherStatements
from derive.verification.documents.rules.roles import Roles
from derive.verification.documents.rules.side_comparison import SideComparison
from derive.verification.documents.rules.side_verdict import (
    CORRECT,
    SideVerdict,
    not_understood,
    plain,
)
from derive.verification.documents.rules.small_motions import SmallMotions
from derive.verification.documents.statements import (
    EQUALITIES,
    INDICES,
    OWN_CONSTANT,
    POINT,
    SQUARE,
    WORD,
    DocumentFormula,
    Occurrence,
    entries_of_chain,
    has_neighbours,
)
from derive.verification.judging.engine import joined
from derive.verification.judging.reference_system import depends_on, time_derivative
from derive.verification.judging.verdict import Correction, Verdict

#: A number with a decimal point.
DECIMAL = re.compile(r"\d\.\d")
#: The note on components of a position of which one is wrong.
EITHER = f"it contradicts another component of the position: {UNDECIDED}"
#: The note on formulas of which the system follows.
STATES = "it states the system"
#: An exponent that is no power.
FIRST_POWER = re.compile(r"\*\*1(?![\d./])")


class Judge:
    """Verdicts on formulas in the scope of a document."""

    def __init__(
        self,
        namespace: DocumentNamespace,
        given: Collection[Occurrence] = (),
        stating: Collection[Occurrence] = (),
        is_stated: bool = False,
    ) -> None:
        self._given, self._stating, self._is_stated = given, stating, is_stated
        self._abbreviations = Abbreviations(namespace, namespace.formulas)
        linear = SmallMotions(namespace.derivation)
        self._constants = self._slips_of_constants(namespace, linear)
        if self._constants:
            namespace.correct(self._constants)
        # these give names their correct values, and the scope another model
        self._positions = MassPositions(namespace)
        self._linear = linear
        self._matrices, self._energies = (
            DerivedMatrices(namespace, linear),
            PartialEnergies(namespace),
        )
        self._namespace, self._model = namespace, namespace.model
        self._roles = Roles(namespace, linear)
        self._amplitudes = Amplitudes(namespace, linear, self._roles)
        self._comparison = SideComparison(namespace, linear, self._roles)
        self._frequencies = Frequencies(namespace, linear, self._roles)
        self._motions = StatedMotions(namespace, linear, self._roles)
        self._others = OtherStatements(namespace, self._frequencies)
        self._loads = AppliedLoads(namespace, linear, self._comparison)
        self._judged: dict[DocumentFormula, SideVerdict] = {}

    @property
    def has_motions(self) -> bool:
        """Whether constraints can be satisfied; where multipliers have letters, it is assumed."""
        try:
            return self._namespace.has_multipliers or bool(self._model.motions.evaluators)
        except ExpressionError:
            return False

    def verdicts(
        self, formulas: Sequence[DocumentFormula]
    ) -> list[tuple[DocumentFormula, SideVerdict]]:
        """The verdicts on formulas in their order, with what follows from wrong ones."""
        own = [(formula, self.verdict(formula)) for formula in formulas]
        judged = self._frequencies.contradicted(own)
        return Consequences(self._namespace).marked(judged)

    def with_loads(self, verdicts: Sequence[WithVerdict]) -> list[WithVerdict]:
        """The verdicts, with those on equations by the loads and reactions of others.

        And without those that the definition of a letter explains as well.
        """
        loaded = with_contrary_loads(self._namespace, self._linear, verdicts)
        judged = with_reactions(self._namespace, self._linear, loaded)
        return with_open_definitions(self._namespace, judged)

    def verdict(self, formula: DocumentFormula) -> SideVerdict:
        """The verdict on a formula: that on its first side that is not correct."""
        if formula not in self._judged:
            self._judged[formula] = self._new_verdict(formula)
        return self._judged[formula]

    def _new_verdict(self, formula: DocumentFormula) -> SideVerdict:
        try:
            result = self._verdict(formula)
        except (ExpressionError, NotImplementedError) as error:  # it has no value at a state
            return plain("context", formula, f"not judged: {error}")
        if formula.is_conserved and formula.subject in self._constants:
            side, momentum = formula.sides[-1], self._constants[formula.subject]
            return self._roles.value(side, formula.subject, momentum)
        if formula.has_two_signs and result.verdict.verdict not in CORRECT:
            return plain("context", formula, "it has two signs at once")
        if formula.occurrence in self._stating and result.verdict.verdict in CORRECT:
            return plain("definition", formula, STATES)
        if result.verdict.verdict == "wrong" and has_neighbours(formula):
            return plain("context", formula, "it sums over neighbours, of any number")
        if result.verdict.verdict == "wrong" and "dots" in formula.words:
            return plain("context", formula, "dots stand for some of its terms")
        return replace(result, verdict=self._in_own_letters(result.verdict))

    def _in_own_letters(self, verdict: Verdict) -> Verdict:
        """The verdict with a correction in the letters of its term, or one other letter.

        The opposite term has the same letters. A correction that writes out the value of a letter
        is this letter in the place of another one, which is as likely as any slip of a letter.
        """
        if len(verdict.corrections) != 1:
            return verdict
        (correction,) = verdict.corrections
        if self._has_wrong_sign(correction):
            wrong = correction.wrong
            opposite = wrong[1:].lstrip() if wrong.startswith("-") else f"-{wrong}"
            return replace(verdict, corrections=(replace(correction, correct=opposite),))
        if is_slip(verdict.corrections):
            return verdict
        params = {*self._namespace.derivation.system.params}
        with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
            required = self._namespace.value(correction.correct)
            for name in self._namespace.defining:
                value = self._namespace.names.get(name)
                if not isinstance(value, sp.Expr) or not value.free_symbols <= params:
                    continue
                for letter in dict.fromkeys(WORD.findall(correction.wrong)):
                    text = re.sub(rf"\b{letter}\b", name, correction.wrong)
                    if self._model.context.is_zero(self._namespace.value(text) - required):
                        own = replace(correction, correct=text)
                        return replace(verdict, corrections=(own,))
        return verdict

    def _has_wrong_sign(self, correction: Correction) -> bool:
        """Whether a term that is a product has the wrong sign, in whatever letters."""
        with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
            values = map(self._namespace.value, (correction.wrong, correction.correct))
            is_product = len(summands(syntax_tree(correction.wrong))) == 1
            return is_product and self._model.context.is_zero(sum(values))
        return False

    def _verdict(self, formula: DocumentFormula) -> SideVerdict:
        if not formula.relations:
            return plain("context", formula, "it is no statement")
        if {*formula.relations} - {*EQUALITIES}:
            return plain("context", formula, "it is no equation")
        if any(FIRST_POWER.search(side.text) for side in formula.sides):
            return plain("context", formula, "its superscripts are indices")
        if formula.is_update:
            return plain("context", formula, "it is a step in time")
        if formula.has_two_signs and (mode := self._frequencies.of_mode(formula)) is not None:
            return mode
        if reused := self._namespace.letters.reused(formula):
            return plain("context", formula, f"{reused} is no energy beside accelerations")
        if formula.subject in INDICES or self._others.states_value(formula):
            return plain("context", formula, "it states a value")
        if (dotted := self._comparison.with_lost_dot(formula)) is not None:
            return dotted
        if (of_motion := self._motions.verdict(formula)) is not None:
            return of_motion
        if formula.occurrence in self._given:
            return plain("definition", formula, STATES)
        if constant := self._constant_of_motion(formula):
            name, value = constant
            if OWN_CONSTANT.fullmatch(name):
                if self._is_conserved(value):
                    return plain("verified", formula, "it is a constant of the motion")
                return plain("context", formula, "it changes along most motions")
            if self._is_conserved(value):
                return plain("verified", formula, f"{name} is a constant of the motion")
            return plain("definition", formula, f"{name} is its value along the motion")
        unknown = self._unknown(formula.sides)
        if unknown and self._is_identity(formula, unknown):
            return plain("verified", formula, f"for any {', '.join(unknown)}")
        loads = unknown or self._loads.own(formula)
        if loads and self._loads.complete(formula, loads):
            return plain("verified", formula, f"with {', '.join(loads)} {AS_FORCES}")
        if unknown and (result := self._amplitudes.verdict(formula, unknown)) is not None:
            return result
        if loads and self._is_stated and (result := self._loads.beside(formula, loads)) is not None:
            return result
        if unknown and (result := self._frequencies.determining(formula, unknown)) is not None:
            return result
        if unknown and self._others.relates_parameters(formula):
            return plain("definition", formula, "")
        if self._unknown(formula.sides[:1]):
            return self._not_understood(formula, unknown)
        named = {name for name, _ in entries_of_chain(formula)}  # by the side behind them
        known = [k for k in range(1, len(formula.sides)) if not self._unknown([formula.sides[k]])]
        known = [k for k in known if named.isdisjoint(WORD.findall(formula.sides[k].text))]
        if len(formula.sides) > 2 and any(map(self._has_numbers, formula.sides)):
            known = [k for k in known if k == 1]  # others have the numbers of an example
            if not known:
                return plain("context", formula, "it states a value")
            unknown = self._unknown(formula.sides[:2])
        results = [self._side(formula, k) for k in known]
        for k, result in zip(known, [*results], strict=True):
            if result.verdict.verdict not in CORRECT:
                if own := self._own_letters(formula, k):  # such as I of I θ̇²/2 = m l² θ̇²/2
                    unknown = [*unknown, *own]
                    results.remove(result)
                    continue
                if (definition := self._positions.opposite(formula.subject)) is not None:
                    return plain("context", formula, opposed(definition.occurrence.line))
                other = self._others.verdict(formula, result)
                return other or self._first_side(formula) or result
        inner = {*self._unknown([formula.sides[0], formula.sides[-1]])}
        if unknown and ({*unknown} & inner or len(known) < 1 or "~" in formula.relations):
            return self._not_understood(formula, unknown)
        if unknown:  # of a step between
            note = f"the side with {', '.join(unknown)} is not judged"
            is_definition = all(one.verdict.verdict == "definition" for one in results)
            kind = "definition" if is_definition else "verified"
            results.append(plain(kind, formula, note))
        notes = dict.fromkeys(one.verdict.note for one in results)
        best = next((one for one in results if one.verdict.verdict != "definition"), results[0])
        return replace(best, verdict=replace(best.verdict, note=joined(*notes)))

    def _own_letters(self, formula: DocumentFormula, k: int) -> list[str]:
        """Parameters that a side between others has, and nothing else in the document."""
        if k == len(formula.sides) - 1:
            return []
        side = {*WORD.findall(formula.sides[k].text)} & {*self._namespace.letters.parameters}
        others = (one.text for j, one in enumerate(formula.sides) if j != k)
        used = {word for text in others for word in WORD.findall(text)}
        used |= {w for one in self._namespace.formulas if one is not formula for w in one.words}
        names, constants = self._namespace.all_names, self._namespace.derivation.system.params
        side = {one for one in side - used if names.get(one) in constants}  # z can be that of r
        return sorted(one for one in side if not self._is_component(one))

    def _is_component(self, name: str) -> bool:
        """Whether a name can be a component of a position that a document states."""
        subjects = (one.subject.removesuffix("_column") for one in self._namespace.formulas)
        places = [one for one in map(POINT.match, subjects) if one]
        own = POINT.match(name)
        return own is not None and any(one[2] == own[2] for one in places)

    def _not_understood(self, formula: DocumentFormula, unknown: Sequence[str]) -> SideVerdict:
        result = not_understood(formula, unknown)
        if not {*unknown} & {*self._namespace.letters.multipliers}:
            return result
        note = joined(result.verdict.note, f"if this is a multiplier, {WAY_OUT}")
        return replace(result, verdict=replace(result.verdict, note=note))

    def _is_identity(self, formula: DocumentFormula, unknown: Sequence[str]) -> bool:
        """Whether neighbouring sides are equal for all values of letters without a meaning."""
        namespace = {**self._namespace.all_names, **{name: sp.Symbol(name) for name in unknown}}
        sides = [one for one in formula.sides if one.text != "0"]  # det(K - omega**2*M) = 0
        with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
            first, *others = (parse(one.text, namespace) for one in sides)
            differences = [one - first for one in others]
            numbers = all(not isinstance(one, sp.MatrixBase) for one in differences)
            return bool(others) and numbers and all(map(vanishes, differences))
        return False

    def _first_side(self, formula: DocumentFormula) -> SideVerdict | None:
        """The verdict on the first side if all others agree, so that it is the wrong one.

        A coordinate that is equal to its rate lacks a dot.
        """
        first, *others = formula.sides
        rate = f"{first.text}_dot"
        if first.text in self._namespace.letters.coordinates and len(others) == 1:
            with suppress(ExpressionError, NotImplementedError):
                values = [self._namespace.value(text) for text in (rate, others[0].text)]
                if self._model.agreement(values[0] - values[1]) is not None:
                    result = self._roles.value(first, "first_side", values[1])
                    dotted = Correction(first.text, rate, (0, len(first.text)))
                    return replace(result, verdict=replace(result.verdict, corrections=(dotted,)))
        if len(others) < 2 or "~" in formula.relations or self._unknown(others):
            return None
        with suppress(ExpressionError, NotImplementedError):
            required, *rest = (self._namespace.value(one.text) for one in others)
            if all(not isinstance(one, sp.MatrixBase) for one in (required, *rest)) and all(
                self._model.agreement(one - required) is not None for one in rest
            ):
                result = self._roles.value(first, "first_side", required)
                return result if result.verdict.corrections else None
        return None

    def _has_numbers(self, side: FormulaText) -> bool:
        """Whether a side has the numbers of an example, perhaps with units, in place of letters."""
        words = {*WORD.findall(side.text)} - {*FUNCTIONS, "t"}
        return bool(DECIMAL.search(side.text)) and (not words or bool(self._unknown([side])))

    def _constant_of_motion(self, formula: DocumentFormula) -> tuple[str, sp.Expr] | None:
        """The parameter that a formula with velocities is equal to, as J in m r² θ̇ = J.

        No term can be wrong there: such a letter stands for the value of the other side.
        """
        system, names = self._namespace.derivation.system, self._namespace.all_names
        if len(formula.sides) != 2 or formula.relations != ("=",):
            return None
        for one, other in (formula.sides, formula.sides[::-1]):
            if names.get(one.text) in system.params and one.text not in other.text:
                with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
                    value = self._namespace.value(other.text).xreplace(dict(self._model.momenta))
                    moving = value.free_symbols
                    if not moving.isdisjoint(system.qdot) and moving.isdisjoint(system.qddot):
                        return one.text, value
        return None

    def _is_conserved(self, value: sp.Expr) -> bool:
        """Whether a function is constant along motions with the constants that formulas state."""
        pairs = filter(None, map(self._constant_of_motion, self._namespace.formulas))
        stated = {self._namespace.names[name]: one for name, one in pairs if one != value}
        rate = time_derivative(self._namespace.derivation.system, value).xreplace(stated)
        with suppress(ExpressionError, NotImplementedError):
            return self._model.agreement(rate) is not None
        return False

    def _slips_of_constants(
        self, namespace: DocumentNamespace, linear: SmallMotions
    ) -> dict[str, sp.Expr]:
        """Letters that a document states to be constant, with the momenta that one slip hides."""
        d, roles = namespace.derivation, Roles(namespace, linear)
        momenta = namespace.model.momenta.values()
        cyclic = [p for q, p in zip(d.system.q, momenta, strict=True) if q in d.cyclic_coordinates]
        result: dict[str, sp.Expr] = {}
        for formula in namespace.formulas if cyclic else ():
            name, value = formula.subject, namespace.names.get(formula.subject)
            is_own = namespace.defining.get(name, (None, ""))[0] is formula
            if not (formula.is_conserved and is_own and isinstance(value, sp.Expr)):
                continue
            rate = time_derivative(d.system, value)
            if depends_on(value, d.system.qdot) and namespace.model.agreement(rate) is None:
                for momentum in cyclic:
                    found = roles.value(formula.sides[-1], name, momentum)
                    if is_change(found.verdict.corrections):
                        result[name] = momentum
        return result

    def _unknown(self, sides: Sequence[FormulaText]) -> list[str]:
        """The names in some sides of a formula that have no meaning."""
        words = dict.fromkeys(word for side in sides for word in WORD.findall(side.text))
        return [name for name in words if name not in self._namespace.all_names]

    def _side(self, formula: DocumentFormula, k: int) -> SideVerdict:
        first, side = formula.sides[0], formula.sides[k]
        defined = self._namespace.defining.get(formula.subject)
        if defined and defined[0] is formula and defined[1] == side.text:
            required = self._energies.required(formula.subject)
            if required is not None:
                return self._roles.value(side, formula.subject, required)
            return self._position(formula, side) or self._definition(formula, side)
        if first.entries and (position := self._position(formula, side)):
            return position
        if square := SQUARE.fullmatch(first.text):
            defined = self._namespace.defining.get(square[1])
            if defined and defined[0] is formula and defined[1] == f"sqrt({side.text})":
                result = self._frequencies.verdict(formula, square[1], side, 2)
                return result or plain("definition", formula, "")
        last = self._namespace.defining.get(side.text)
        if last and last[0] is formula:
            value = self._namespace.names[side.text]
            is_moving = depends_on(value, self._namespace.derivation.system.qdot)
            if is_moving and not first.text.isidentifier() and self._is_conserved(value):
                return plain("verified", formula, f"{side.text} is a constant of the motion")
            return plain("definition", formula, "")
        is_approximate = formula.relations[k - 1] == "~"
        first = formula.sides[k - 1] if is_approximate else first
        try:
            values = [self._namespace.value(one.text) for one in (first, side)]
            if is_approximate:
                return self._comparison.approximated(formula, *values)
            return self._comparison.compared(formula, first, side, *values)
        except (ExpressionError, NotImplementedError) as error:
            return plain("context", formula, f"not judged: {error}")

    def _position(self, formula: DocumentFormula, side: FormulaText) -> SideVerdict | None:
        """The verdict on a definition of a position with a wrong component, if one is known."""
        first = formula.sides[0]
        names = [one.text for one in first.entries] or [first.text] * max(1, len(side.entries))
        for index, (name, entry) in enumerate(zip(names, side.entries or (side,), strict=False)):
            place = name, 0 if first.entries else index
            if (value := self._positions.required(*place)) is not None:
                return self._roles.value(entry, "position", value)
            if self._positions.is_undecided(*place):
                return plain("context", formula, EITHER)
        return None

    def _definition(self, formula: DocumentFormula, side: FormulaText) -> SideVerdict:
        """The verdict on a definition, which can be that of a matrix of the system."""
        name, entries = formula.subject, side.entries
        if (frequency := self._frequencies.verdict(formula, name, side, 1)) is not None:
            return frequency
        if (value := self._abbreviations.required(name)) is not None:
            return self._roles.value(side, name, value)
        required = self._matrices.required(name)
        if required is None:
            required, entries = self._matrices.entry(name), (side,)
        if required is None:
            return plain("definition", formula, "")
        wrong = [k for k, value in enumerate(required) if value is not None]
        if not wrong:
            return plain("verified", formula, "")
        results = [self._roles.value(entries[k], "entry", required[k]) for k in wrong if entries]
        result = [one for one in results if one.verdict.corrections]
        shortest = min(
            result, key=lambda one: len(one.verdict.corrections[0].correct), default=None
        )
        return shortest or plain("wrong", formula, "it has not the forces of this system")
