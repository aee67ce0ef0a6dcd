"""What follows from wrong formulas, and what contradicts verdicts."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace

import sympy as sp

from derive.formulas.syntax import ExpressionError
from derive.verification.documents.letters.dimensions import Restoration
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.side_verdict import SideVerdict, plain
from derive.verification.documents.statements import DocumentFormula
from derive.verification.judging.engine import joined
from derive.verification.judging.reference_system import time_derivative

#: The note on a formula that follows correctly from a wrong one.
FOLLOWS = "it follows from line"
#: The note on a Lagrangian of fewer coordinates, from which others can follow.
SUBSTITUTED = "with the constraints substituted"
#: Energies from which others follow.
ENERGIES = ("kinetic_energy", "potential_energy", "lagrangian")


#: The end of a note on formulas that contradict each other.
UNDECIDED = "nothing else in the document decides which of them is wrong"

WithVerdict = tuple[DocumentFormula, SideVerdict]


@dataclass(frozen=True)
class Contradictions:
    """What contradicts the verdicts by a system, by the numbers of formulas."""

    #: Formulas that do not hold, and those that state another system with which they do.
    doubts: Mapping[int, frozenset[int]] = field(default_factory=dict)
    #: Formulas that hold, and those that do not hold unless these are wrong.
    disputed: Mapping[int, frozenset[int]] = field(default_factory=dict)
    #: The formulas whose dimensions contradict those of all others, and what restores them.
    inhomogeneous: Mapping[int, Restoration | None] = field(default_factory=dict)
    #: Formulas that do not hold, if all systems with which they do need larger changes of others.
    decided: frozenset[int] = frozenset()


@dataclass(frozen=True)
class _Source:
    """A wrong energy: the line of its formula, and the Lagrangian that it gives."""

    line: int
    lagrangian: sp.Expr


class Consequences:
    """The formulas of a document that follow from its own energies, which can be wrong."""

    def __init__(self, namespace: DocumentNamespace) -> None:
        self._namespace, self._context = namespace, namespace.model.context

    def marked(self, verdicts: Sequence[WithVerdict]) -> list[WithVerdict]:
        """The verdicts, with a note on wrong formulas that follow from a wrong one before them.

        Those that follow from a Lagrangian with the constraints substituted are right.
        """
        reduced: _Source | None = None
        values = {kind: getattr(self._namespace.derivation, kind) for kind in ENERGIES}
        source: _Source | None = None
        result: list[WithVerdict] = []
        for formula, verdict in verdicts:
            if verdict.verdict.note == SUBSTITUTED:
                value = self._value(verdict.verdict.correction or formula.sides[-1].text)
                reduced = None if value is None else _Source(formula.occurrence.line, value)
            if verdict.verdict.verdict == "wrong" and reduced and self._follows(formula, reduced):
                verdict = plain("verified", formula, f"{FOLLOWS} {reduced.line}")
            elif verdict.verdict.verdict == "wrong" and source and self._follows(formula, source):
                note = joined(verdict.verdict.note, f"{FOLLOWS} {source.line}")
                own = replace(verdict.verdict, note=note)
                verdict = replace(verdict, verdict=own, source=source.line)
            elif verdict.verdict.verdict == "wrong" and verdict.kind in ENERGIES:
                value = self._written(formula)
                if value is not None:
                    values[verdict.kind] = value
                    L = values["kinetic_energy"] - values["potential_energy"]
                    lagrangian = value if verdict.kind == "lagrangian" else L
                    source = _Source(formula.occurrence.line, lagrangian)
            result.append((formula, verdict))
        return result

    def _written(self, formula: DocumentFormula) -> sp.Expr | None:
        """The value of the last side of a formula."""
        return self._value(formula.sides[-1].text)

    def _value(self, text: str) -> sp.Expr | None:
        with suppress(ExpressionError):
            value = self._namespace.value(text)
            return None if isinstance(value, sp.MatrixBase) else value
        return None

    def _follows(self, formula: DocumentFormula, source: _Source) -> bool:
        value, subject = self._written(formula), formula.subject
        if value is None:
            return False
        try:
            if subject in self._namespace.letters.quantities or subject.isidentifier():
                required = self._required(subject, source.lagrangian)
                if required is not None and self._context.is_zero(value - required):
                    return True
            return self._is_equation(formula, source.lagrangian)
        except (ExpressionError, NotImplementedError):
            return False

    def _required(self, name: str, lagrangian: sp.Expr) -> sp.Expr | None:
        """The value of a name that follows from a Lagrangian."""
        system, letters = self._namespace.derivation.system, self._namespace.letters
        if letters.quantities.get(name) == "lagrangian":
            return lagrangian
        operand, variables = self._namespace.derivatives.get(name, ("", ()))
        if letters.quantities.get(operand) == "lagrangian" and len(variables) == 1:
            variable = self._namespace.all_names.get(variables[0])
            return lagrangian.diff(variable) if isinstance(variable, sp.Symbol) else None
        coordinate = self._namespace.all_names.get(letters.momenta.get(name, ""))
        if coordinate in system.q:
            return lagrangian.diff(system.qdot[system.q.index(coordinate)])
        if letters.quantities.get(name) in ("energy", "hamiltonian"):
            pairs = ((v, lagrangian.diff(v)) for v in system.qdot)
            return sp.Add(*(v * p for v, p in pairs)) - lagrangian
        return None

    def _is_equation(self, formula: DocumentFormula, lagrangian: sp.Expr) -> bool:
        """Whether a formula is an equation of motion of a Lagrangian, times any factor."""
        system = self._namespace.derivation.system
        left, right = (
            self._namespace.value(one.text) for one in (formula.sides[0], formula.sides[-1])
        )
        if isinstance(left, sp.MatrixBase) or isinstance(right, sp.MatrixBase):
            return False
        difference = left - right
        for q, v, force in zip(system.q, system.qdot, system.applied, strict=True):
            rate = time_derivative(system, lagrangian.diff(v))
            equation = rate - lagrangian.diff(q) - force
            for a in system.qddot:
                factors = equation.diff(a), difference.diff(a)
                if all(factors):
                    cross = difference * factors[0] - equation * factors[1]
                    if self._context.is_zero(cross):
                        return True
                    break
        return False


def without_sources(verdicts: Sequence[WithVerdict]) -> list[WithVerdict]:
    """The verdicts, with `context` for a formula that follows from one that is not wrong."""
    wrong = {one.occurrence.line for one, result in verdicts if result.verdict.verdict == "wrong"}
    result = [*verdicts]
    for number, (formula, one) in enumerate(verdicts):
        if one.verdict.verdict == "wrong" and one.source and one.source not in wrong:
            result[number] = formula, plain("context", formula, one.verdict.note)
    return result


def opposed(line: int) -> str:
    """The note on a formula that contradicts another one, which can be wrong as well."""
    return f"it contradicts line {line}: {UNDECIDED}"
