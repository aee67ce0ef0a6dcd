"""Verdicts on the formulas of a document whose letters are known."""

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace

import sympy as sp

from derive.formulas.expression import ExpressionError, Value, parse
from derive.formulas.zero import vanishes
from derive.verification.documents.consequences import Consequences
from derive.verification.documents.linear import Linear
from derive.verification.documents.manipulator import Manipulator
from derive.verification.documents.partial_energies import PartialEnergies
from derive.verification.documents.rates import order, stem
from derive.verification.documents.scope import DocumentScope
from derive.verification.documents.side_verdict import CORRECT, SideVerdict, not_understood, plain
from derive.verification.documents.statements import INDICES, WORD, DocumentFormula
from derive.verification.documents.text import Text
from derive.verification.engine import joined
from derive.verification.model import Model, depends_on
from derive.verification.quantities import judge_formula
from derive.verification.verdict import Correction

#: The largest denominator of a factor that is looked for.
MAX_DENOMINATOR = 100


class Judge:
    """Verdicts on formulas in the scope of a document."""

    def __init__(self, scope: DocumentScope) -> None:
        self._scope, self._model = scope, scope.model
        self._linear = Linear(scope.derivation)
        self._energies, self._manipulator = PartialEnergies(scope), Manipulator(scope)

    def verdicts(
        self, formulas: Sequence[DocumentFormula]
    ) -> list[tuple[DocumentFormula, SideVerdict]]:
        """The verdicts on formulas in their order, with what follows from wrong ones."""
        judged = [(formula, self.verdict(formula)) for formula in formulas]
        return Consequences(self._scope).marked(judged)

    def verdict(self, formula: DocumentFormula) -> SideVerdict:
        """The verdict on a formula: that on its first side that is not correct."""
        if not formula.relations:
            return plain("context", formula, "it is no statement")
        if any(one not in ("=", ":=", "~") for one in formula.relations):
            return plain("context", formula, "it is no equation")
        if formula.subject in INDICES or self._is_special(formula):
            return plain("context", formula, "it states a value")
        unknown = self._unknown(formula.sides)
        if unknown and self._is_identity(formula, unknown):
            return plain("verified", formula, f"for any {', '.join(unknown)}")
        if self._unknown(formula.sides[:1]):
            return not_understood(formula, unknown)
        known = [k for k in range(1, len(formula.sides)) if not self._unknown([formula.sides[k]])]
        results = [self._side(formula, k) for k in known]
        for result in results:
            if result.verdict.verdict not in CORRECT:
                return self._first_side(formula) or result
        if unknown:
            return not_understood(formula, unknown)
        notes = dict.fromkeys(one.verdict.note for one in results)
        best = next((one for one in results if one.verdict.verdict != "definition"), results[0])
        return replace(best, verdict=replace(best.verdict, note=joined(*notes)))

    def _is_identity(self, formula: DocumentFormula, unknown: Sequence[str]) -> bool:
        """Whether neighbouring sides are equal for all values of letters without a meaning."""
        scope = {**self._scope.all_names, **{name: sp.Symbol(name) for name in unknown}}
        sides = [one for one in formula.sides if one.text != "0"]  # det(K - omega**2*M) = 0
        with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
            first, *others = (parse(one.text, scope) for one in sides)
            differences = [one - first for one in others]
            numbers = all(not isinstance(one, sp.MatrixBase) for one in differences)
            return bool(others) and numbers and all(map(vanishes, differences))
        return False

    def _first_side(self, formula: DocumentFormula) -> SideVerdict | None:
        """The verdict on the first side if all others agree, so that it is the wrong one."""
        first, *others = formula.sides
        if len(others) < 2 or "~" in formula.relations or self._unknown(others):
            return None
        with suppress(ExpressionError, NotImplementedError):
            required, *rest = (self._scope.value(one.text) for one in others)
            if all(not isinstance(one, sp.MatrixBase) for one in (required, *rest)) and all(
                self._holds(one - required) is not None for one in rest
            ):
                result = self._value(first, "first_side", required)
                return result if result.verdict.corrections else None
        return None

    def _is_special(self, formula: DocumentFormula) -> bool:
        """Whether a formula states the value of a coordinate, of its rate or of a parameter."""
        names, last = self._scope.all_names, formula.sides[-1].text
        try:
            value = self._scope.value(last)
        except ExpressionError:
            return False
        others = [side.text for side in formula.sides[:-1]]
        return (
            not isinstance(value, sp.MatrixBase)
            and value.is_number
            and all(one in names and isinstance(names[one], sp.Symbol) for one in others)
        )

    def _unknown(self, sides: Sequence[Text]) -> list[str]:
        """The names in some sides of a formula that have no meaning."""
        words = dict.fromkeys(word for side in sides for word in WORD.findall(side.text))
        return [name for name in words if name not in self._scope.all_names]

    def _side(self, formula: DocumentFormula, k: int) -> SideVerdict:
        first, side = formula.sides[0], formula.sides[k]
        defined = self._scope.defining.get(formula.subject)
        if defined and defined[0] is formula and defined[1] == side.text:
            required = self._energies.required(formula)
            if required is not None:
                return self._value(side, formula.subject, required)
            return self._manipulator_matrix(formula, side)
        last = self._scope.defining.get(side.text)
        if last and last[0] is formula:
            return plain("definition", formula, "")
        is_approximate = formula.relations[k - 1] == "~"
        first = formula.sides[k - 1] if is_approximate else first
        try:
            values = [self._scope.value(one.text) for one in (first, side)]
            if is_approximate:
                return self._approximated(formula, *values)
            return self._compared(formula, first, side, *values)
        except (ExpressionError, NotImplementedError) as error:
            return plain("context", formula, f"not judged: {error}")

    def _manipulator_matrix(self, formula: DocumentFormula, side: Text) -> SideVerdict:
        """The verdict on a definition, which can be that of a matrix of M q̈ + C q̇ = G."""
        required = self._manipulator.required(formula.subject)
        if required is None:
            return plain("definition", formula, "")
        wrong = [k for k, value in enumerate(required) if value is not None]
        if not wrong:
            return plain("verified", formula, "")
        results = [
            self._value(side.entries[k], "entry", required[k]) for k in wrong if side.entries
        ]
        found = [one for one in results if one.verdict.corrections]
        shortest = min(found, key=lambda one: len(one.verdict.corrections[0].correct), default=None)
        return shortest or plain("wrong", formula, "it has not the forces of this system")

    def _approximated(self, formula: DocumentFormula, left: Value, right: Value) -> SideVerdict:
        """The verdict on an approximation, which is never wrong: others can be meant."""
        if self._linear.agrees(left - right, self._model):
            return plain("verified", formula, "it holds to first order at the origin")
        return plain("context", formula, "it is an approximation")

    def _compared(
        self, formula: DocumentFormula, first: Text, side: Text, left: Value, right: Value
    ) -> SideVerdict:
        is_product = getattr(right, "shape", ()) == (1, 1)
        left, right = _number(left), _number(right)
        if isinstance(left, sp.MatrixBase) or isinstance(right, sp.MatrixBase):
            return self._matrices(formula, first, side, left, right)
        note = self._holds(left - right)
        if note is not None:
            return plain("verified", formula, note)
        small = "it holds for small motions about the origin"
        if is_product:
            return self._scaled(formula, side, left, right)
        result = self._role(formula, first, side, left, right)
        if result.verdict.verdict in CORRECT:
            return result
        if self._linear.holds(left - right, self._model):
            return plain("verified", formula, small)
        if side.text.startswith("sqrt(") and self._holds(left**2 - right**2) is not None:
            return plain("verified", formula, "it holds for one sign of the root")
        values = self._special_values(left, right)
        difference = (left - right).xreplace(self._model.momenta).xreplace(values)
        if values and self._holds(difference) is not None:
            text = ", ".join(f"{symbol} = {value}" for symbol, value in values.items())
            return plain("equivalent", formula, f"it holds for {text}")
        return result

    def _scaled(
        self, formula: DocumentFormula, side: Text, left: sp.Expr, right: sp.Expr
    ) -> SideVerdict:
        """The verdict on a wrong scalar product of columns, perhaps but for a factor."""
        context = self._model.context
        result = plain("wrong", formula, "", context.witness(right, left))
        ratio = sp.nsimplify(context.value(left) / context.value(right), rational=True)
        if ratio.q < MAX_DENOMINATOR and self._holds(left - ratio * right) is not None:
            correction = Correction(side.text, f"{ratio}*{side.text}")
            verdict = replace(result.verdict, corrections=(correction,))
            return SideVerdict(verdict, ((0, side),), "value")
        return result

    def _special_values(self, left: Value, right: Value) -> dict[sp.Symbol, sp.Expr]:
        """Values of parameters that the document states; units, if one side has no parameters."""
        parameters = left.free_symbols & {*self._scope.derivation.system.params}
        # one parameter that is lacking is a mistake
        if len(parameters) > 1 and not right.free_symbols & parameters:
            return dict.fromkeys(sorted(parameters, key=str), sp.S.One)
        return self._scope.special_values

    def _matrices(
        self, formula: DocumentFormula, first: Text, side: Text, left: Value, right: Value
    ) -> SideVerdict:
        """The verdict on the first entries that differ, or on the whole."""
        shapes = [getattr(one, "shape", None) for one in (left, right)]
        if shapes[0] != shapes[1]:
            return plain("context", formula, "it compares quantities of different shapes")
        for index, (a, b) in enumerate(zip(left, right, strict=True)):
            if self._holds(a - b) is not None or self._linear.holds(a - b, self._model):
                continue
            mine, other = (one.entries[index] if one.entries else None for one in (first, side))
            if mine and other and depends_on(a - b, self._scope.derivation.system.qddot):
                return self._equation(mine, other)
            if other:
                return self._value(other, "entry", a)
            if mine:
                return self._value(mine, "entry", b)
            return plain("wrong", formula, "", self._model.context.witness(b, a))
        return plain("verified", formula, "")

    def _holds(self, difference: sp.Expr) -> str | None:
        """A note if a difference is zero at all states or along motions, otherwise None."""
        for context in (self._model.context, self._model.motions):
            note = context.agreement(difference)
            if note is not None:
                return note
        return None

    def _role(
        self, formula: DocumentFormula, first: Text, side: Text, left: Value, right: Value
    ) -> SideVerdict:
        system, subject = self._scope.derivation.system, first.text
        letters = self._scope.letters
        kind, name = "", ""
        if subject in letters.quantities:
            kind = letters.quantities[subject]
        elif subject in letters.momenta:
            kind, name = "momenta", letters.momenta[subject]
        elif (
            subject.isidentifier() and order(subject) == 2 and stem(subject) in letters.coordinates
        ):
            kind, name = "accelerations", stem(subject)
        if kind == "accelerations" and depends_on(right, system.qddot):
            kind = ""
        if kind in ("hamiltonian", "energy"):
            kind = "hamiltonian" if depends_on(right, system.p) else "energy"
        if kind == "accelerations":
            small = self._linear.acceleration(self._scope.all_names[subject], right)
            if small is not None:
                return self._value(side, "linearised", small)
        if kind:
            with suppress(ExpressionError):
                verdict = judge_formula(self._model_of(side, name), "", side.text, kind, name)
                if verdict.verdict != "unreadable":
                    return SideVerdict(verdict, ((0, side),), kind)
        inside = self._inside_rate(first, side)
        if inside is not None:
            return inside
        if not depends_on((left - right).xreplace(self._model.momenta), system.qddot):
            return self._value(side, subject, left)
        if subject.isidentifier():
            result = self._value(side, subject, left)
            if result.verdict.corrections:
                return result
        return self._equation(first, side)

    def _inside_rate(self, first: Text, side: Text) -> SideVerdict | None:
        """The verdict on a wrong momentum whose rate is taken, if there is one."""
        system, names = self._scope.derivation.system, self._scope.all_names
        for one, other in ((first, side), (side, first)):
            for start, end in _rates(one.text):
                inner = one.part(start, end)
                for q, p in zip(system.q, self._model.momenta.values(), strict=True):
                    name = next(n for n, v in names.items() if v == q)
                    scope = {**names, "momentum": p}
                    text = f"{one.text[:start]}momentum{one.text[end:]}"
                    with suppress(ExpressionError):
                        if (
                            self._holds(parse(text, scope) - self._scope.value(other.text))
                            is not None
                        ):
                            model = self._model_of(inner, name)
                            verdict = judge_formula(model, "", inner.text, "momenta", name)
                            return SideVerdict(verdict, ((0, inner),), "momenta")
        return None

    def _equation(self, first: Text, side: Text) -> SideVerdict:
        """The verdict on an equation of motion."""
        text = f"{first.text} = {side.text}"
        verdict = judge_formula(self._model_of(first, side), "", text, "euler_lagrange")
        return SideVerdict(verdict, ((0, first), (len(first.text) + 3, side)), "euler_lagrange")

    def _model_of(self, *sides: Text | str) -> Model:
        """The model with the names of these sides alone, in which corrections are written."""
        texts = [one.text if isinstance(one, Text) else one for one in sides]
        words = {word for text in texts for word in WORD.findall(text)}
        words |= {f"p_{word}" for word in words}
        names = {name: value for name, value in self._scope.names.items() if name in words}
        functions = {n: v for n, v in self._scope.names.items() if not isinstance(v, Value)}
        return replace(self._model, names={**functions, **names})

    def _value(self, side: Text, name: str, value: sp.Expr) -> SideVerdict:
        """The verdict on a side that must have a value, to which a name is given."""
        name = name if name.isidentifier() else "left_side"
        model = self._model_of(side)
        model = replace(model, names={**model.names, name: value})
        return SideVerdict(
            judge_formula(model, "", side.text, "value", name), ((0, side),), "value"
        )


def _number(value: Value) -> Value:
    """The entry of a matrix that has one, such as a scalar product."""
    return value[0] if getattr(value, "shape", ()) == (1, 1) else value


def _rates(text: str) -> Iterator[tuple[int, int]]:
    """The places of operands of d/dt."""
    for match in re.finditer(r"\bddt\(", text):
        depth, end = 1, match.end()
        while depth:
            depth += {"(": 1, ")": -1}.get(text[end], 0)
            end += 1
        yield match.end(), end - 1
