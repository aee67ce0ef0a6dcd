"""Names of energies of parts and abbreviations, as T_1 and C_1, that a document defines wrongly."""

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property

import sympy as sp

from derive.formulas.expression import parse
from derive.formulas.syntax import ExpressionError
from derive.mechanics.energies.kinetics import Kinetics
from derive.system.symbols import TIME
from derive.verification.documents.formula_translation import order
from derive.verification.documents.letters.letters import energy_of_part
from derive.verification.documents.letters.stated_equations import is_reaction
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.statements import DocumentFormula
from derive.verification.judging.reference_system import depends_on

#: Most operations of a formula from which the value of a name is computed.
MAX_OPERATIONS = 400
#: Formulas that must agree on the value of a name, unless its slip is one of a factor.
AGREEING = 2


def differs_by_one_factor(own: sp.Expr, value: sp.Expr) -> bool:
    """Whether two sums have the same terms, one of them with another factor, as of a slip."""
    terms = [sp.expand(one).as_coefficients_dict() for one in (own, value)]
    same = [terms[0][key] == terms[1][key] for key in terms[0]]
    return {*terms[0]} == {*terms[1]} and any(same) and same.count(False) == 1


def required_value(
    namespace: DocumentNamespace, name: str, formula: DocumentFormula
) -> sp.Expr | None:
    """The value of a letter with which a formula holds along motions; None if it is not known."""
    symbol, model = sp.Dummy(real=True), namespace.model
    scope = {**namespace.all_names, name: symbol}
    left, right = (parse(one.text, scope) for one in (formula.sides[0], formula.sides[-1]))
    difference = sp.sympify(left - right).xreplace(dict(model.momenta))
    rates = namespace.derivation.system.qddot
    if depends_on(difference, rates):
        own = difference.xreplace({symbol: namespace.names[name]})
        if model.motions.is_small(own):
            return namespace.names[name]
        if not model.has_inverse:
            return None
        moving = dict(zip(rates, namespace.derivation.accelerations, strict=True))
        difference = difference.xreplace(moving)
    slope = difference.diff(symbol)
    if slope == 0 or slope.has(symbol) or sp.count_ops(difference) > MAX_OPERATIONS:
        return None
    return sp.cancel(-difference.xreplace({symbol: sp.S.Zero}) / slope)


class Abbreviations:
    """Values that names must have for several known quantities to be right."""

    def __init__(self, namespace: DocumentNamespace, formulas: Sequence[DocumentFormula]) -> None:
        self._namespace = namespace
        #: Correct values of wrongly defined names.
        self._required: dict[str, sp.Expr] = {}
        found: dict[str, tuple[sp.Expr, list[sp.Expr], sp.Expr]] = {}
        for name in [*namespace.defining]:
            own = namespace.names[name]
            if not isinstance(own, sp.MatrixBase):
                values = [*self._values(name, formulas)]
                found[name] = own, values, min(values, key=sp.count_ops, default=own)
        momenta = namespace.model.momenta
        slips = {
            name
            for name, (own, _, value) in found.items()
            if differs_by_one_factor(own.xreplace(momenta), value.xreplace(momenta))
        }
        for name, (own, values, shortest) in found.items():
            others = slips - {name}  # each of which can be the slip as well
            is_slip = name in slips and not any(
                name in one.words and others & {*one.words} for one in formulas
            )
            is_shown = len(values) >= AGREEING or is_slip
            is_agreed = is_shown and self._are_equal([shortest, *values])
            # a name that must be 0 is one that a known system has not
            if is_agreed and shortest != 0 and not self._are_equivalent(own, shortest):
                self._required[name] = shortest
        if self._required:
            namespace.correct(self._required)

    def required(self, name: str) -> sp.Expr | None:
        """The value of a name with a wrong definition; None for others."""
        return self._required.get(name)

    def _values(self, name: str, formulas: Sequence[DocumentFormula]) -> Iterator[sp.Expr]:
        """The values of a name with which formulas about known quantities that contain it hold."""
        names, system = self._namespace.all_names, self._namespace.derivation.system
        moving = {*system.q, *system.qdot, *system.qddot}
        allowed = names[name].free_symbols | {*system.params}
        for formula in formulas:
            subject = formula.subject
            known = subject in names and subject not in self._namespace.defining
            # an equation of motion shows a reaction, and no inertia of a known system
            known |= is_reaction(name) and not subject and 2 in map(order, formula.words)
            if not known or name not in formula.words:
                continue
            with suppress(ExpressionError, NotImplementedError, ValueError, TypeError):
                value = required_value(self._namespace, name, formula)
                if value is not None and (value.free_symbols & moving) <= allowed:
                    yield sp.factor_terms(value)

    def _are_equal(self, values: Sequence[sp.Expr]) -> bool:
        first, *others = values
        return all(self._namespace.model.context.is_zero(one - first) for one in others)

    def _are_equivalent(self, own: sp.Expr, value: sp.Expr) -> bool:
        """Whether values are equal, or differ by a constant, as lengths in an energy can."""
        system, model = self._namespace.derivation.system, self._namespace.model
        if depends_on(own, (*system.q, *system.qdot, TIME)):
            return model.constancy(own - value) is not None
        return model.context.is_zero(own - value)


#: Names of effective potentials, which contain the energies of conserved momenta.
EFFECTIVE = re.compile(r"_eff?(?:ective)?\Z")


class PartialEnergies:
    """The values that definitions of partial energies must have for their sum to be correct.

    In other formulas, these energies have their correct values.
    """

    def __init__(self, namespace: DocumentNamespace) -> None:
        self._namespace, self._model = namespace, namespace.model
        self._wrong = {
            name: value
            for name, (formula, _) in namespace.defining.items()
            if formula.subject == name and (value := self._correct(formula)) is not None
        }
        if self._wrong:
            namespace.correct(self._wrong)

    def required(self, name: str) -> sp.Expr | None:
        """The value that a name must have; None if it is not known to have another."""
        return self._wrong.get(name)

    def _correct(self, formula: DocumentFormula) -> sp.Expr | None:
        """The value of another side that is a part of the energy, or what the sum requires."""
        name = formula.subject
        kind = energy_of_part(name)
        own = self._namespace.names[name]
        if kind is None or isinstance(own, sp.MatrixBase) or self._is_part(kind, own):
            return None
        if EFFECTIVE.search(name):
            return self._effective(own)
        for side in formula.sides[1:]:
            with suppress(ExpressionError):
                value = self._namespace.value(side.text)
                if not isinstance(value, sp.MatrixBase) and self._is_part(kind, value):
                    return value
        return self._required.get(name)

    def _effective(self, own: sp.Expr) -> sp.Expr | None:
        """The energy at rest but for the rates of conserved momenta, if one factor differs."""
        d = self._namespace.derivation
        own = own.xreplace(dict(self._model.momenta))
        resting = {v: sp.S.Zero for v in d.system.qdot if not own.has(v)}
        value = d.energy.xreplace(resting)
        is_moving = depends_on(own, d.system.q) and not depends_on(own, d.system.qddot)
        return value if is_moving and differs_by_one_factor(own, value) else None

    @cached_property
    def _required(self) -> Mapping[str, sp.Expr]:
        result: dict[str, sp.Expr] = {}
        totals = {
            "kinetic_energy": self._namespace.derivation.kinetic_energy,
            "potential_energy": self._namespace.derivation.potential_energy,
        }
        for kind, names in self._groups().items():
            values = {name: self._namespace.names[name] for name in names}
            if self._is_constant(sp.Add(*values.values()) - totals[kind]):
                continue
            wrong = [name for name, value in values.items() if not self._is_part(kind, value)]
            if len(wrong) == 1:
                others = sp.Add(*(value for name, value in values.items() if name != wrong[0]))
                result[wrong[0]] = totals[kind] - others
        return result

    def _groups(self) -> Mapping[str, list[str]]:
        """The names of partial energies that the document defines, one for each body or force."""
        groups: dict[str, list[str]] = {}
        for name in self._namespace.defining:
            kind = energy_of_part(name)
            is_number = not isinstance(self._namespace.names[name], sp.MatrixBase)
            if kind and is_number and not EFFECTIVE.search(name):
                groups.setdefault(kind, []).append(name)
        masses = len(self._namespace.derivation.system.masses)
        return {
            kind: names
            for kind, names in groups.items()
            if len(names) > 1 and (len(names) == masses or kind == "potential_energy")
        }

    def _is_part(self, kind: str, value: sp.Expr) -> bool:
        return any(self._is_constant(value - part) for part in self._parts[kind])

    @cached_property
    def _parts(self) -> Mapping[str, list[sp.Expr]]:
        """Energies of the masses, and the rest."""
        d = self._namespace.derivation
        kinetic = [
            Kinetics(replace(d.system, masses=[mass])).kinetic_energy for mass in d.system.masses
        ]
        terms = sp.Add.make_args(sp.expand(d.potential_energy))
        of_one = [
            sp.Add(*(term for term in terms if p in term.free_symbols)) for p in d.system.params
        ]
        potential = [*terms, *of_one, d.potential_energy]
        return {"kinetic_energy": kinetic, "potential_energy": potential}

    def _is_constant(self, difference: sp.Expr) -> bool:
        """Whether a difference does not depend on the state."""
        try:
            return self._model.constancy(difference) is not None
        except (ExpressionError, NotImplementedError):
            return False
