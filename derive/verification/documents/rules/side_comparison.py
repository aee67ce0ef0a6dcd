"""Verdicts on two sides of a formula, from their values, and on frequencies."""

import ast
import re
from collections.abc import Iterator
from contextlib import suppress
from copy import copy
from dataclasses import replace
from itertools import takewhile

import sympy as sp

from derive.formulas.expression import Value
from derive.formulas.syntax import ExpressionError, place, syntax_tree
from derive.verification.corrections.source_names import SourceNames
from derive.verification.documents.formula_translation import RATES, FormulaText, order, stem
from derive.verification.documents.letters.letters import energy_of_part
from derive.verification.documents.rules.consequences import SUBSTITUTED
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.matrices import MatrixTerms, has_scaled_rows
from derive.verification.documents.rules.roles import Roles
from derive.verification.documents.rules.side_verdict import CORRECT, SideVerdict, plain
from derive.verification.documents.rules.small_motions import SmallMotions
from derive.verification.documents.statements import OWN_CONSTANT, WORD, DocumentFormula
from derive.verification.judging.engine import UNDECIDED
from derive.verification.judging.reference_system import depends_on, time_derivative
from derive.verification.judging.verdict import Correction

#: The largest denominator of a factor that is looked for.
MAX_DENOMINATOR = 100

#: The note on a mass matrix with other factors in its rows.
SCALED = "its rows are those of equations with another factor"


#: The rate of a name, such as that of a momentum.
RATE = re.compile(r"ddt\(\w+\)")
#: The reason of a verdict on an equation that holds with other angles.
ELSEWHERE = "it holds for small motions about another equilibrium, with angles from there"
#: The reason of a verdict on the value of a rate that vanishes.
BOTH_ZERO = "both sides vanish along every motion, but differ at other accelerations"
#: Energies that have an arbitrary constant.
TOTAL_ENERGIES = ("energy", "hamiltonian")


class SideComparison:
    """Compares sides: as numbers, as matrices, for small motions, and in units of a system."""

    def __init__(self, namespace: DocumentNamespace, linear: SmallMotions, roles: Roles) -> None:
        self._namespace, self._model, self._linear, self._roles = (
            namespace,
            namespace.model,
            linear,
            roles,
        )
        self._terms = MatrixTerms(namespace, linear, roles)

    def approximated(self, formula: DocumentFormula, left: Value, right: Value) -> SideVerdict:
        """The verdict on an approximation, which is never wrong: others can be meant."""
        shapes = [getattr(one, "shape", ()) for one in (left, right)]
        if shapes[0] == shapes[1] and self._linear.agrees(left - right, self._model):
            return plain("verified", formula, "it holds to first order at the origin")
        return plain("context", formula, "it is an approximation")

    def compared(
        self,
        formula: DocumentFormula,
        first: FormulaText,
        side: FormulaText,
        left: Value,
        right: Value,
    ) -> SideVerdict:
        """The verdict on a side by its value and that of the first side."""
        is_product = getattr(right, "shape", ()) == (1, 1)
        left, right = _number(left), _number(right)
        if isinstance(left, sp.MatrixBase) or isinstance(right, sp.MatrixBase):
            return self._matrices(formula, first, side, left, right)
        # a Lagrangian of motions alone has other equations
        is_lagrangian = self._namespace.letters.quantities.get(first.text) == "lagrangian"
        about = self._model.about(left - right)
        model = about.context if is_lagrangian else about
        has_reactions = is_lagrangian and depends_on(
            right, self._namespace.derivation.system.multipliers
        )
        if has_reactions:
            left += self._reactions
        if (note := model.agreement(left - right)) is not None:
            if self._are_both_zero(first, left, right):
                return plain("context", formula, BOTH_ZERO)
            kind = self._namespace.letters.quantities.get(first.text, "")
            verdict = plain("context" if note == UNDECIDED else "verified", formula, note)
            return replace(verdict, kind=kind)
        if is_lagrangian and not has_reactions and self._is_substituted(left - right):
            return plain("verified", formula, SUBSTITUTED)
        if has_reactions:
            result = self._roles.value(side, first.text, left)
            if result.verdict.verdict not in CORRECT:
                return result
            # it has the value along motions alone
            multipliers = {*self._namespace.derivation.system.multipliers}
            of_rates = multipliers - self._reactions.free_symbols
            rest = right.xreplace(dict.fromkeys(of_rates, sp.S.Zero))
            if rest != right and model.agreement(left - rest) is not None:
                return plain("verified", formula, "its constraints of velocities vanish")
            note = "the multipliers have not the signs and factors of the equations of motion"
            return plain("wrong", formula, note, *self._witness(formula, right, left))
        if self._is_up_to_a_constant(formula) and self._model.constancy(left - right) is not None:
            return plain("equivalent", formula, "it differs by a constant")
        small = "it holds for small motions about the origin"
        if is_product:
            return self._scaled(formula, side, left, right)
        if self._holds_with_constraints(formula, first, side):
            return plain("verified", formula, SUBSTITUTED)
        if is_lagrangian and (reduced := self._without_dependent(left, right)) is not None:
            result = self._roles.value(side, first.text, reduced)
            return replace(result, verdict=replace(result.verdict, note=SUBSTITUTED))
        result = self._roles.judged(first, side, left, right)
        if result.verdict.verdict in CORRECT:
            return result
        if self._linear.holds(left - right, self._model):
            return plain("verified", formula, small)
        is_linear = first.text in self._namespace.defining and not right.atoms(sp.Function)
        is_linear &= depends_on(right, self._namespace.derivation.system.qddot)
        if is_linear and self._linear.holds(left - right, self._model, is_first_order=True):
            return plain("verified", formula, small)
        if (own := self._of_small_motions(formula, side, left - right, result)) is not None:
            return own
        match syntax_tree(side.text):
            case ast.Call(func=ast.Name(id="sqrt"), args=[operand]):
                radicand = side.part(*place(side.text, operand))
                inside = self._roles.value(radicand, "square", left**2)
                if inside.verdict.verdict in CORRECT:
                    return plain("verified", formula, "it holds for one sign of the root")
                is_relation = result.kind == "euler_lagrange"
                result = inside if inside.verdict.corrections and not is_relation else result
        if state := self._state_of_value(formula, left, right):
            q, angle = state
            return plain("context", formula, f"it is its value at {q} = {angle}")
        if values := self._special_values(formula, first, left, right):
            text = ", ".join(f"{symbol} = {value}" for symbol, value in values.items())
            if any(values.values()) and {*values} <= right.free_symbols:  # for which none stands
                return plain("context", formula, f"it holds for {text} alone")
            return plain("equivalent", formula, f"it holds for {text}")
        return result

    def with_lost_dot(self, formula: DocumentFormula) -> SideVerdict | None:
        """The verdict on an equation that is one of motion with another dot; None for others.

        With parameters, whose dimensions tell both apart, it can be no equation of a motion.
        """
        system, names = self._namespace.derivation.system, self._namespace.all_names
        words = [word for side in formula.sides for word in WORD.findall(side.text)]
        rates = [word for word in words if names.get(word) in system.qdot]
        if len(formula.sides) != 2 or len(rates) != 1 or not order(rates[0]):
            return None
        (rate,), accelerated = rates, stem(rates[0]) + RATES[2]
        with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
            left, right = (self._namespace.value(one.text) for one in formula.sides)
            if accelerated not in names:
                return None
            value, symbol = left - right, names[rate]
            slope = value.diff(symbol)
            other = value.xreplace({symbol: names[accelerated]})
            rest = sp.cancel(value.xreplace({symbol: sp.S.Zero}) / slope)
            is_plain = depends_on(value, system.qddot) or depends_on(slope, system.qdot)
            if is_plain or not depends_on(rest, system.params):
                return None
            if not self._model.motions.is_small(other) or self._model.motions.is_small(value):
                return None
            side = next(one for one in formula.sides if rate in WORD.findall(one.text))
            place_of = re.search(rf"\b{rate}\b", side.text)
            assert place_of
            result = plain("wrong", formula, "", *self._witness(formula, left, right))
            lost = Correction(rate, accelerated, place_of.span())
            verdict = replace(result.verdict, printed=side.text, corrections=(lost,))
            return SideVerdict(verdict, ((0, side),), "value")
        return None

    def _are_both_zero(self, first: FormulaText, left: sp.Expr, right: sp.Expr) -> bool:
        """Whether a rate and its value differ, but vanish along every motion, as without forces."""
        has_accelerations = depends_on(right, self._namespace.derivation.system.qddot)
        if not RATE.fullmatch(first.text) or not has_accelerations:
            return False
        is_identity = self._model.context.agreement(left - right) is not None
        return not is_identity and self._model.agreement(left) is not None

    def _of_small_motions(
        self, formula: DocumentFormula, side: FormulaText, difference: sp.Expr, result: SideVerdict
    ) -> SideVerdict | None:
        """The verdict on a linear equation of motion by those of small motions; None for others.

        It can hold with angles from another equilibrium, or for a mode.
        """
        if (own := self._of_mode(formula, side, difference)) is not None:
            return own
        is_explained = result.kind != "euler_lagrange" or len(result.verdict.corrections) == 1
        if is_explained or difference.atoms(sp.Function):
            return None
        derivation = self._linear.derivation
        if derivation is None:
            return None
        for one in self._linear.turned:
            if one.holds(difference, self._model, is_displaced=True):
                return plain("context", formula, ELSEWHERE)
        own = self._roles.equation(formula.sides[0], side, derivation)
        return own if len(own.verdict.corrections) == 1 else None

    def _of_mode(
        self, formula: DocumentFormula, side: FormulaText, difference: sp.Expr
    ) -> SideVerdict | None:
        """The verdict on an equation of one coordinate for motions with a stated relation of two.

        It is `wrong` by a relation just before it alone, and not if it lacks letters, as without
        coupling.
        """
        system, formulas = self._namespace.derivation.system, self._namespace.formulas
        moving = [q for q in system.q if difference.has(q)]
        accelerations = [one for one in system.qddot if difference.has(one)]
        if len(system.q) != 2 or len(moving) != 1 or len(accelerations) != 1:
            return None
        before = [*takewhile(lambda one: one != formula, formulas)]
        relations = {
            one.text: value for one in before if (value := self._relation(one)) is not None
        }
        for text, relation in relations.items():
            derivation = self._linear.of_mode(relation, moving[0])
            if derivation is None:
                continue
            own = self._roles.equation(formula.sides[0], side, derivation)
            is_slip = len(own.verdict.corrections) == 1 and text == before[-1].text
            added = {*WORD.findall(" ".join(one.correct for one in own.verdict.corrections))}
            is_wrong = is_slip and added <= {*formula.words}
            if is_wrong or own.verdict.verdict in CORRECT:
                return replace(own, verdict=replace(own.verdict, note=f"with {text}"))
        return None

    def _relation(self, formula: DocumentFormula) -> sp.Expr | None:
        """What a relation of coordinates alone states to vanish; None of others."""
        system = self._namespace.derivation.system
        with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
            left, right = (self._namespace.value(one.text) for one in formula.sides)
            moving = (left - right).free_symbols
            if len(moving) > 1 and moving <= {*system.q}:
                return left - right
        return None

    def _is_up_to_a_constant(self, formula: DocumentFormula) -> bool:
        """Whether a formula states the energy or one of a part, or has a constant of its own."""
        has_constant = any(map(OWN_CONSTANT.fullmatch, formula.words))
        is_energy = self._namespace.letters.quantities.get(formula.subject) in TOTAL_ENERGIES
        return has_constant or is_energy or energy_of_part(formula.subject) is not None

    def _is_substituted(self, difference: sp.Expr) -> bool:
        """Whether a difference vanishes by constraints that are integrable."""
        derivation = self._namespace.derivation
        if not derivation.system.conditions or derivation.integrability.nonholonomic:
            return False
        return self._model.about(difference).agreement(difference) not in (None, UNDECIDED)

    def _holds_with_constraints(
        self, formula: DocumentFormula, first: FormulaText, side: FormulaText
    ) -> bool:
        """Whether momenta and derivatives of L and T agree if constraints eliminate velocities."""
        derivation, namespace = self._namespace.derivation, copy(self._namespace)
        system, quantities = derivation.system, namespace.letters.quantities
        derivatives = {
            name: (namespace.names[operand], variables)
            for name, (operand, variables) in namespace.derivatives.items()
            if name in formula.words and quantities.get(operand) in ("lagrangian", "kinetic_energy")
        }
        derivatives |= {
            name: (derivation.lagrangian, (f"{coordinate}_dot",))
            for name, coordinate in namespace.letters.momenta.items()
            if name in map(stem, formula.words) and f"{coordinate}_dot" in namespace.names
        }
        if not derivatives or not system.conditions or derivation.integrability.nonholonomic:
            return False
        words = {*formula.words}.union(*(variables for _, variables in derivatives.values()))
        used = {namespace.names.get(stem(word)) for word in words}
        pairs = zip(system.q, system.qdot, strict=True)
        others = [v for q, v in pairs if q not in used]
        values = sp.solve([*derivation.constraint_rates], others, dict=True) if others else []
        if not values:
            return False
        reduced = {
            name: value.subs(values[0]).diff(*(namespace.names[one] for one in variables))
            for name, (value, variables) in derivatives.items()
        }
        rates = {f"{name}_dot": time_derivative(system, one) for name, one in reduced.items()}
        namespace.correct({**reduced, **rates})
        with suppress(ExpressionError, NotImplementedError):
            difference = namespace.value(first.text) - namespace.value(side.text)
            return self._model.agreement(difference) is not None
        return False

    def _without_dependent(self, lagrangian: sp.Expr, other: sp.Expr) -> sp.Expr | None:
        """A Lagrangian without the velocities that another one lacks, by its constraints."""
        derivation = self._namespace.derivation
        system = derivation.system
        if not system.conditions or derivation.integrability.nonholonomic:
            return None
        lacking = [v for v in system.qdot if lagrangian.has(v) and not other.has(v)]
        values = sp.solve([*derivation.constraint_rates], lacking, dict=True) if lacking else []
        return lagrangian.subs(values[0]) if values else None

    def _witness(
        self, formula: DocumentFormula, value: sp.Expr, derived: sp.Expr
    ) -> tuple[str, str]:
        """Two values at a state, and the numbers with which they can be computed again."""
        context = self._model.context
        names = SourceNames(formula.text, self._namespace.all_names)
        quantities = names.quantities((value - derived).free_symbols)
        numbers = context.state(value, derived, quantities)
        state = ", ".join(f"{name} = {number}" for name, number in numbers.items())
        return context.witness(value, derived), state

    @property
    def _reactions(self) -> sp.Expr:
        """The terms Σ λ φ that the constraints of coordinates add to a Lagrangian."""
        derivation = self._namespace.derivation
        pairs = zip(derivation.system.multipliers, derivation.system.conditions, strict=True)
        holonomic = derivation.holonomic
        return sp.Add(*(name * one.formula for name, one in pairs if one.formula in holonomic))

    def _scaled(
        self, formula: DocumentFormula, side: FormulaText, left: sp.Expr, right: sp.Expr
    ) -> SideVerdict:
        """The verdict on a wrong scalar product of columns, perhaps but for a factor."""
        context = self._model.context
        result = plain("wrong", formula, "", *self._witness(formula, right, left))
        ratio = sp.nsimplify(context.value(left) / context.value(right), rational=True)
        if ratio.q < MAX_DENOMINATOR and self._model.agreement(left - ratio * right) is not None:
            correction = Correction(side.text, f"{ratio}*{side.text}", (0, len(side.text)))
            verdict = replace(result.verdict, corrections=(correction,))
            return SideVerdict(verdict, ((0, side),), "value")
        return result

    def _state_of_value(
        self, formula: DocumentFormula, left: Value, right: Value
    ) -> tuple[sp.Symbol, sp.Expr] | None:
        """A right angle, and its coordinate, at which a defined name or an energy has a value.

        In the text, as in "at theta = 0, D = M".
        """
        names = {*self._namespace.defining, *self._namespace.letters.quantities}
        if formula.occurrence.display or formula.subject not in names:
            return None
        for q in self._namespace.derivation.system.q:
            for k in range(4) if left.has(q) and not right.has(q) else ():
                if self._model.agreement(left.subs(q, k * sp.pi / 2) - right) is not None:
                    return q, k * sp.pi / 2
        return None

    def _special_values(
        self, formula: DocumentFormula, first: FormulaText, left: Value, right: Value
    ) -> dict[sp.Symbol, sp.Expr]:
        """Values of parameters for which two sides are equal; empty if there are none.

        They are those that the document states, zeros before the formula, or units, if neither
        side is written with parameters.
        """
        difference = (left - right).xreplace(self._model.momenta)
        moving = difference
        for values in self._model.motions.substitutions:
            moving = moving.xreplace(values)
        for stated in self._stated_values(formula):
            # a zero that leaves nothing of the sides tests nothing
            is_empty = not any(stated.values()) and right.subs(stated) == 0
            if not is_empty and self._agree(moving.subs(stated)):
                return stated
        parameters = left.free_symbols & {*self._namespace.derivation.system.params}
        units = dict.fromkeys(sorted(parameters, key=str), sp.S.One)
        written = right.free_symbols | {
            symbol
            for word in WORD.findall(first.text)
            if isinstance(symbol := self._namespace.all_names[word], sp.Symbol)
        }
        # one parameter that is lacking is a mistake
        if len(parameters) > 1 and not written & parameters:
            return units if self._agree(difference.xreplace(units)) else {}
        return {}

    def _stated_values(self, formula: DocumentFormula) -> Iterator[dict[sp.Symbol, sp.Expr]]:
        """Yield values of parameters that the document states before a formula, or anywhere."""
        stated = self._namespace.special_values
        numbers = {name: value for name, (value, _) in stated.items() if value}
        here = formula.occurrence.span
        zeros = [
            s for s, (value, one) in stated.items() if not value and one.occurrence.span < here
        ]
        for names in ([], *([one] for one in zeros), zeros):
            if values := {**numbers, **dict.fromkeys(names, sp.S.Zero)}:
                yield values

    def _agree(self, difference: sp.Expr) -> bool:
        """Whether a difference is zero, by proof or at states between which it keeps its form."""
        return self._model.about(difference).agreement(difference) not in (None, UNDECIDED)

    def _matrices(
        self,
        formula: DocumentFormula,
        first: FormulaText,
        side: FormulaText,
        left: Value,
        right: Value,
    ) -> SideVerdict:
        """The verdict on the first entries that differ, or on the whole."""
        if _is_state(first, side):
            return plain("definition", formula, f"{first.text} denotes a state here")
        left, right = self._with_shape(left, right), self._with_shape(right, left)
        shapes = [getattr(one, "shape", None) for one in (left, right)]
        if shapes[0] != shapes[1]:
            return plain("context", formula, "it compares quantities of different shapes")
        is_mass_matrix = self._namespace.letters.quantities.get(first.text) == "mass_matrix"
        if is_mass_matrix and has_scaled_rows(self._namespace, right, left):
            return plain("verified", formula, SCALED * (left != right))
        is_displaced = any(name in self._namespace.displacements for name in formula.words)
        undecided = ""
        for index, (a, b) in enumerate(zip(left, right, strict=True)):
            note = self._model.about(a - b).agreement(a - b)
            undecided = UNDECIDED if note == UNDECIDED else undecided
            if note is not None or self._linear.holds(
                a - b, self._model, is_displaced=is_displaced
            ):
                continue
            mine, other = (
                one.entries[index] if len(one.entries) == len(left) else None
                for one in (first, side)
            )
            witness, state = self._witness(formula, b, a)
            if other is None and (result := self._terms.verdict(first, side, left, right, witness)):
                own = result.verdict.state or state
                return replace(result, verdict=replace(result.verdict, state=own))
            if mine and other and depends_on(a - b, self._namespace.derivation.system.qddot):
                return self._roles.equation(mine, other)
            if other:
                return self._roles.value(other, "entry", a)
            if mine:
                return self._roles.value(mine, "entry", b)
            return plain("wrong", formula, "", witness, state)
        return plain("context" if undecided else "verified", formula, undecided)

    def _with_shape(self, value: Value, other: Value) -> Value:
        """Zeros in place of zero on one side of a set of equations of motion."""
        is_zero = not isinstance(value, sp.MatrixBase) and value == 0
        is_equation = depends_on(other, self._namespace.derivation.system.qddot)
        return sp.zeros(*other.shape) if is_zero and is_equation else value


def _number(value: Value) -> Value:
    """The entry of a matrix that has one, such as a scalar product."""
    return value[0] if getattr(value, "shape", ()) == (1, 1) else value


def _is_state(first: FormulaText, side: FormulaText) -> bool:
    """Whether a side is a state, such as (x, x_dot, theta, theta_dot), and the first its name."""
    names = [entry.text for entry in side.entries]
    is_name = first.text.isidentifier() and all(map(str.isidentifier, names))
    return is_name and bool({first.text, f"{first.text}_dot"} & {*names})
