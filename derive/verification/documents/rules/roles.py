"""Verdicts on a side of a formula by what its first side is: an energy, a momentum, an equation."""

import ast
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

import sympy as sp

from derive.formulas.expression import Value, parse
from derive.formulas.syntax import ExpressionError, place, summands, syntax_tree
from derive.mechanics.derivation import Derivation
from derive.system.symbols import TIME
from derive.verification.documents.formula_translation import FormulaText, order, stem
from derive.verification.documents.letters.candidates import BY_LAGRANGIAN
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.side_verdict import SideVerdict
from derive.verification.documents.rules.small_motions import SmallMotions
from derive.verification.documents.statements import WORD
from derive.verification.judging.engine import joined
from derive.verification.judging.reference_system import (
    LARGEST_INVERSE,
    ReferenceSystem,
    depends_on,
)
from derive.verification.judging.verdict import Correction, Verdict
from derive.verification.quantity_verdicts import judge_formula

#: The index of a name with one, and the ending of its rate behind it.
INDEX = re.compile(r"_\d+(?=_d+ot\Z|\Z)")
#: The note on terms that the kinetic or the potential energy can have.
OPEN = "the stated Lagrangian leaves open which energy has the other terms"


class Roles:
    """Verdicts of the judging engine, with corrections in the names of a side."""

    def __init__(self, namespace: DocumentNamespace, linear: SmallMotions) -> None:
        self._namespace, self._model, self._linear = namespace, namespace.model, linear

    def judged(
        self, first: FormulaText, side: FormulaText, left: Value, right: Value
    ) -> SideVerdict:
        """The verdict on a side that is not equal to the first one."""
        system, subject = self._namespace.derivation.system, first.text
        letters = self._namespace.letters
        kind, name = "", ""
        if subject in letters.quantities:
            kind = letters.quantities[subject]
        elif subject in letters.momenta:
            kind, name = "momenta", letters.momenta[subject]
        elif (
            subject.isidentifier()
            and order(subject) == 2
            and stem(subject) in letters.coordinates
            and stem(subject) in self._namespace.names
        ):
            kind, name = "accelerations", stem(subject)
        if kind == "accelerations" and depends_on(right, system.qddot):
            kind = ""
        if kind in ("kinetic_energy", "potential_energy") and system.name == BY_LAGRANGIAN:
            if self._is_open(left, right):
                verdict = Verdict("", "context", side.text, note=OPEN)
                return SideVerdict(verdict, ((0, side),), kind)
            kind = ""
        if kind in ("hamiltonian", "energy"):
            kind = "hamiltonian" if depends_on(right, system.p) else "energy"
        if kind == "accelerations":
            small = self._linear.acceleration(self._namespace.all_names[subject], right)
            if small is not None:
                return self.value(side, "linearised", small)
        is_static = kind == "potential_energy" and not depends_on(left, system.qdot)
        if is_static and depends_on(self._namespace.derivation.potential_energy, system.qdot):
            return self._energy(side, subject, left, right)
        if kind == "energy" and self._relates_energies(subject, side):
            return self._energy(side, subject, left, right)
        if kind:
            with suppress(ExpressionError):
                verdict = judge_formula(self._model_of(side, name), "", side.text, kind, name)
                if verdict.verdict != "unreadable":
                    return SideVerdict(verdict, ((0, side),), kind)
        inside = self._inside_rate(first, side)
        if inside is not None:
            return inside
        # the rate of a velocity by another name, as omega_dot
        if left in system.qddot and not depends_on(right, system.qddot) and self._model.has_inverse:
            small = self._linear.acceleration(left, right)
            derived = self._namespace.derivation.accelerations[system.qddot.index(left)]
            return self.value(side, subject, derived if small is None else small)
        if system.conditions and self._is_relation(first):
            return self.equation(first, side)
        if (canonical := self._canonical(subject, left, right)) is not None:
            return self.value(side, subject, canonical)
        if not depends_on((left - right).xreplace(self._model.momenta), system.qddot):
            return self.value(side, subject, left)
        # d/dt(∂L/∂q̇) is a name for its value where the other side has accelerations
        is_rate = (4, len(subject) - 1) in _rates(subject) and depends_on(right, system.qddot)
        if subject.isidentifier() or is_rate:
            result = self.value(side, subject, left)
            if result.verdict.corrections:
                return result
        return self.equation(first, side)

    def _is_open(self, left: sp.Expr, right: sp.Expr) -> bool:
        """Whether energies differ in terms that a Lagrangian can have from either of them.

        These contain the time, or are linear in velocities.
        """
        system = self._namespace.derivation.system
        difference = (right - left).xreplace(self._model.momenta)
        slopes = [difference.diff(v) for v in system.qdot]
        curvatures = [slope.diff(v) for slope in slopes for v in system.qdot]
        is_moving = depends_on(difference, (*system.qdot, TIME))
        return is_moving and all(map(self._model.context.is_zero, curvatures))

    def _relates_energies(self, subject: str, side: FormulaText) -> bool:
        """Whether a side states H, or another energy by H, where this is not T + V."""
        quantities, d = self._namespace.letters.quantities, self._namespace.derivation
        words = (subject, *WORD.findall(side.text))
        total = d.kinetic_energy + d.potential_energy
        has_hamiltonian = any(quantities.get(word) == "hamiltonian" for word in words)
        return has_hamiltonian and not self._model.context.is_small(total - d.energy)

    def _energy(
        self, side: FormulaText, subject: str, left: sp.Expr, right: sp.Expr
    ) -> SideVerdict:
        """The verdict on an energy that must be that of the document up to a constant."""
        if (note := self._model.constancy(right - left)) is None:
            return self.value(side, subject, left)
        note = joined("it differs by a constant", note)
        return SideVerdict(Verdict("", "equivalent", side.text, note=note), ((0, side),), "energy")

    def _inside_rate(self, first: FormulaText, side: FormulaText) -> SideVerdict | None:
        """The verdict on a wrong momentum whose rate is taken, if there is one."""
        system, names = self._namespace.derivation.system, self._namespace.all_names
        for one, other in ((first, side), (side, first)):
            for start, end in _rates(one.text):
                inner = one.part(start, end)
                for q, p in zip(system.q, self._model.momenta.values(), strict=True):
                    name = next(n for n, v in names.items() if v == q)
                    namespace = {**names, "momentum": p}
                    text = f"{one.text[:start]}momentum{one.text[end:]}"
                    with suppress(ExpressionError):
                        difference = parse(text, namespace) - self._namespace.value(other.text)
                        if self._model.agreement(difference) is not None:
                            model = self._model_of(inner, name)
                            verdict = judge_formula(model, "", inner.text, "momenta", name)
                            return SideVerdict(verdict, ((0, inner),), "momenta")
        return None

    def _is_relation(self, first: FormulaText) -> bool:
        """Whether a side contains coordinates, velocities and parameters alone."""
        values = [self._namespace.all_names[word] for word in WORD.findall(first.text)]
        return all(one.is_Symbol for one in values if isinstance(one, Value))

    def equation(
        self, first: FormulaText, side: FormulaText, derivation: Derivation | None = None
    ) -> SideVerdict:
        """The verdict on an equation of motion, perhaps on one of another derivation."""
        text, model = f"{first.text} = {side.text}", self._model_of(first, side)
        if derivation is not None:
            model = model.of(derivation, model.names)
        verdict = judge_formula(model, "", text, "euler_lagrange")
        verdict = replace(verdict, corrections=self._in_place(verdict.corrections, first))
        return SideVerdict(verdict, ((0, first), (len(first.text) + 3, side)), "euler_lagrange")

    def _in_place(
        self, corrections: tuple[Correction, ...], side: FormulaText
    ) -> tuple[Correction, ...]:
        """A missing term in place of one that vanishes, such as that with sin(q1 - q1)."""
        if len(corrections) != 1 or corrections[0].wrong:
            return corrections
        for term, sign in summands(syntax_tree(side.text)):
            start, end = place(side.text, term)
            text = side.text[start:end]
            if self._namespace.value(text) == 0 and text != "0":
                text = f"-{text}" if sign < 0 else text
                return (Correction(text, corrections[0].correct, (start, end)),)
        return corrections

    def value(
        self,
        side: FormulaText,
        name: str,
        value: sp.Expr,
        letters: Mapping[str, sp.Symbol] | None = None,
    ) -> SideVerdict:
        """The verdict on a side that must have a value, to which a name is given.

        Some letters of the side can stand for symbols of the system.
        """
        name = name if name.isidentifier() else "left_side"
        texts: tuple[Sequence[str], ...] = ((), [*self._partners(side)])  # a slip of an index
        for others in texts:
            model = self._model_of(side, *others)
            model = replace(model, names={**model.names, **(letters or {}), name: value})
            verdict = judge_formula(model, "", side.text, "value", name)
            if verdict.verdict != "wrong" or verdict.corrections:
                break
        return SideVerdict(verdict, ((0, side),), "value")

    def _canonical(self, subject: str, left: sp.Expr, right: sp.Expr) -> sp.Expr | None:
        """The right-hand side of a canonical equation, in the variables that a document uses.

        None if the formula is none, or the mass matrix is too large. The rate of a momentum is
        a function of velocities, too: ∂L/∂q and the forces.
        """
        d, names = self._namespace.derivation, self._namespace.all_names
        system, has_momenta = d.system, depends_on(right, d.system.p)
        if system.conditions or (has_momenta and len(system.q) > LARGEST_INVERSE):
            return None
        if left in system.qdot and has_momenta:
            return d.hamilton_equations[0][system.qdot.index(left)]
        momentum = names.get(stem(subject)) if order(subject) == 1 else None
        if momentum not in system.p or depends_on(right, system.qddot):
            return None
        k = system.p.index(momentum)
        if has_momenta:
            return d.hamilton_equations[1][k]
        return self._model.lagrangian.diff(system.q[k]) + self._model.forces[k]

    def _partners(self, side: FormulaText) -> Iterator[str]:
        """Names that differ from those of a side by their index alone."""
        letters = {
            letter for word in WORD.findall(side.text) if (letter := INDEX.sub("", word)) != word
        }
        return (name for name in self._namespace.names if INDEX.sub("", name) in letters)

    def _model_of(self, *sides: FormulaText | str) -> ReferenceSystem:
        """The model with the names of these sides alone, in which corrections are written."""
        texts = [one.text if isinstance(one, FormulaText) else one for one in sides]
        words = {word for text in texts for word in WORD.findall(text)}
        words |= {f"p_{word}" for word in words}
        names = {name: value for name, value in self._namespace.names.items() if name in words}
        functions = {n: v for n, v in self._namespace.names.items() if not isinstance(v, Value)}
        return replace(self._model, names={**functions, **names})


def _rates(text: str) -> Iterator[tuple[int, int]]:
    """The places of operands of d/dt."""
    for node in ast.walk(syntax_tree(text)):
        match node:
            case ast.Call(func=ast.Name(id="ddt"), args=[operand]):
                yield place(text, operand)
