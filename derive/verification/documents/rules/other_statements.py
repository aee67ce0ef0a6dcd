"""Statements that do not hold for every motion, and are not wrong: relations, values, forces."""

import re
from contextlib import suppress
from functools import cached_property

import sympy as sp

from derive.formulas.syntax import ExpressionError
from derive.system.symbols import TIME
from derive.verification.documents.formula_translation import order
from derive.verification.documents.letters.document_system import is_length
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.side_comparison import Frequencies
from derive.verification.documents.rules.side_verdict import CORRECT, SideVerdict, plain
from derive.verification.documents.statements import SQUARE, DocumentFormula
from derive.verification.judging.reference_system import depends_on

#: Words of sentences about formulas that leave out terms, and about motions that have none.
SIMPLIFIED = re.compile(
    r"simplif|neglect|ignor|vereinfach|vernachl|despreci|négli|忽略|無視"
    r"|without|at rest|zero (?:\w+ )?(?:velocity|momentum|speed)",
    re.IGNORECASE,
)
#: Names of generalized forces, which nothing else in a document may state.
GENERALIZED_FORCE = re.compile(r"Q(?:_\w+)?")


class OtherStatements:
    """Finds statements that differ from those of a system, but are about something else."""

    def __init__(self, namespace: DocumentNamespace, frequencies: Frequencies) -> None:
        self._namespace, self._frequencies = namespace, frequencies

    def verdict(self, formula: DocumentFormula, result: SideVerdict) -> SideVerdict | None:
        """The verdict on a formula for which `result` is not correct; None if it is no other."""
        if self.relates_parameters(formula) or self._is_other_number(formula):
            return plain("definition", formula, "")
        operands = (self._namespace.derivatives.get(one, (one,))[0] for one in formula.words)
        if letters := sorted(self._ambiguous.intersection(operands)):
            return plain("context", formula, f"{', '.join(letters)} has two meanings")
        if GENERALIZED_FORCE.fullmatch(formula.subject):
            return plain("context", formula, "it states a generalized force")
        if self._is_foreign(formula):
            return plain("context", formula, "it has no parameter of the system")
        if (other := self._with_an_energy(formula)) is not None:
            return other
        if self._is_place(formula):
            return plain("context", formula, "it states a value")
        if (frequency := self._frequency(formula)) is not None:
            return frequency
        if _lacks_terms(formula, result) and SIMPLIFIED.search(formula.occurrence.prose):
            return plain("context", formula, "it lacks terms that it can neglect")
        return None

    def _is_foreign(self, formula: DocumentFormula) -> bool:
        """Whether an equation of motion has numbers by name, and no parameter of the system."""
        values = [self._namespace.names.get(word) for word in formula.words]
        known = [one for one in values if isinstance(one, sp.Expr)]
        params = {*self._namespace.derivation.system.params}
        is_equation = any(order(word) == 2 for word in formula.words)
        has_numbers = any(one.is_number for one in known)
        return is_equation and has_numbers and sp.Tuple(*known).free_symbols.isdisjoint(params)

    @cached_property
    def _ambiguous(self) -> set[str]:
        """Lengths that are parameters and that formulas define by coordinates, as r = sqrt(x*a)."""
        system, names = self._namespace.derivation.system, self._namespace.all_names
        result = set[str]()
        for formula in self._namespace.formulas:
            if names.get(formula.subject) in system.params and is_length(formula.subject):
                with suppress(ExpressionError, TypeError):
                    value = self._namespace.value(formula.sides[-1].text)
                    moving = value.free_symbols - {*system.params}
                    if moving and moving <= {*system.q} and not system.conditions:
                        result.add(formula.subject)
        return result

    def states_value(self, formula: DocumentFormula) -> bool:
        """Whether a formula states the value of a coordinate, of its rate or of a parameter.

        That of a name which the document defines by these is one at a place: θ = 0 beside ωt.
        """
        if formula.is_special_case:
            return True
        names, last = self._namespace.all_names, formula.sides[-1].text
        system = self._namespace.derivation.system
        moving = {TIME, *system.q, *system.qdot}
        try:
            value = self._namespace.value(last)
        except ExpressionError:
            return False
        sides = formula.sides[:-1]
        entries = [one.text for side in sides for one in side.entries or (side,)]
        rates = [names[one] for one in entries if names.get(one) in system.qddot]
        if not isinstance(value, sp.MatrixBase) and any(
            self._namespace.model.agreement(one - value) is not None for one in rates
        ):
            return False  # an equation of motion
        return not value.free_symbols and all(
            isinstance(names.get(one), sp.Symbol)
            or (one in self._namespace.letters.quantities and names.get(one) != value)
            or (one in self._namespace.defining and depends_on(names[one], moving))
            for one in entries
        )

    def relates_parameters(self, formula: DocumentFormula) -> bool:
        """Whether a formula defines a parameter by others, as b = d/2 does: any value is right.

        So is the number of a formula of parameters, as in m*l = 0.025, and a formula of parameters
        alone, as r_1*n_2 = r_2*n_1.
        """
        names, known = self._namespace.all_names, {*self._namespace.derivation.system.params}
        letters = self._namespace.letters
        values = (names.get(word) for word in formula.words if word not in letters.parameters)
        is_relation = formula.is_value or names.get(formula.subject) in known
        is_relation |= all(names.get(word) in known for word in formula.words)
        return is_relation and all(
            callable(one) or (isinstance(one, sp.Expr) and one.free_symbols <= known)
            for one in values
        )

    def _is_other_number(self, formula: DocumentFormula) -> bool:
        """Whether a formula gives a letter that is a number another one, as in another case."""
        values = [self._namespace.all_names.get(word) for word in formula.words]
        return all(isinstance(one, sp.Expr) and one.is_number is True for one in values)

    def _with_an_energy(self, formula: DocumentFormula) -> SideVerdict | None:
        """The verdict on a formula that contains an energy, which can have another constant."""
        quantities = self._namespace.letters.quantities
        named = {name: text for name, (_, text) in self._namespace.defining.items()}
        kinds = {word: quantities.get(named.get(word, word)) for word in formula.words}
        energies = {word for word, kind in kinds.items() if kind in ("energy", "hamiltonian")}
        if formula.subject in quantities or not energies - {formula.subject}:
            return None
        if len(formula.sides) == 2 and formula.sides[1].text in energies:
            left, right = (self._namespace.value(one.text) for one in formula.sides)
            is_constant = self._namespace.model.constancy(left - right) is not None
            return plain("verified", formula, "it differs by a constant") if is_constant else None
        # that of a potential with another value at the origin, where many documents take 0
        potential = self._namespace.derivation.potential_energy
        offset = potential.subs(dict.fromkeys(self._namespace.derivation.system.q, sp.S.Zero))
        if not offset.is_finite or offset == 0:
            return None
        return plain("context", formula, "it contains an energy, which can have another constant")

    def _is_place(self, formula: DocumentFormula) -> bool:
        """Whether a formula can state a place, as cos θ = g/(ω² a): it has no other quantities.

        Coordinates with constraints have such relations everywhere.
        """
        system, names = self._namespace.derivation.system, self._namespace.all_names
        known = {*system.q, *system.params}
        values = [
            (value in known or (value in system.qdot and not order(word)), value)
            for word in formula.words  # a constant rate can have a letter
            if isinstance(value := names.get(word), sp.Expr)
        ]
        is_relation = not all(side.text.isidentifier() for side in formula.sides)
        has_place = all(k for k, _ in values) and any(v in system.q for _, v in values)
        return is_relation and has_place and not system.conditions

    def _frequency(self, formula: DocumentFormula) -> SideVerdict | None:
        """The verdict on a frequency of another mode, whose letter the document uses before."""
        square = SQUARE.fullmatch(formula.sides[0].text)
        name, power = (square[1], 2) if square else (formula.subject, 1)
        with suppress(ExpressionError, NotImplementedError):
            result = self._frequencies.verdict(formula, name, formula.sides[-1], power)
            return result if result and result.verdict.verdict in CORRECT else None
        return None


def _lacks_terms(formula: DocumentFormula, result: SideVerdict) -> bool:
    """Whether no term of an equation of motion is wrong, so that it lacks others."""
    is_equation = any(order(word) == 2 for word in formula.words)
    return is_equation and not any(one.wrong for one in result.verdict.corrections)
