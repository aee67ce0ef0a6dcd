"""Verdicts on formulas for quantities of a derivation, and on equations of motion."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial

from derive.formulas.expression import number
from derive.formulas.syntax import ExpressionError
from derive.verification.corrections.advice import advised
from derive.verification.judging.derived import QUANTITIES, foreign_symbols
from derive.verification.judging.engine import UNDECIDED, joined
from derive.verification.judging.equivalence import TOTAL_ENERGY, equivalence
from derive.verification.judging.motion_verdicts import judge_equation
from derive.verification.judging.reference_system import ReferenceSystem
from derive.verification.judging.routhians import eliminated_names, without_legendre_term
from derive.verification.judging.substitution import substituted_constraints
from derive.verification.judging.terms import difference
from derive.verification.judging.verdict import Verdict

#: Quantities that follow from a Lagrangian and differ between equivalent ones.
ENERGIES = ("kinetic_energy", "potential_energy", "energy")
FROM_LAGRANGIAN = ("momenta", "energy", "hamiltonian", "hamilton", "routhian")
#: Notes on common mistakes.
MISTAKES = (substituted_constraints, without_legendre_term)


def judge_formula(
    model: ReferenceSystem,
    label: str,
    text: str,
    kind: str,
    name: str = "",
    source: ReferenceSystem | None = None,
    others: Sequence[str] = (),
) -> Verdict:
    """Judge a formula for a key of `QUANTITIES`, or an equation of motion, ``euler_lagrange``.

    `source` is the model with the source's Lagrangian, if this is an equivalent one, and `others`
    are the other equations of motion of the source.
    """
    if kind == "routhian":
        name = eliminated_names(model, text)
    with suppress(ExpressionError):
        value = difference(text, model.context.namespace)
        model, source = model.about(value), source and source.about(value)
    verdict = _judged(model, label, text, kind, name)
    if verdict.verdict == "wrong" and source and kind in FROM_LAGRANGIAN:
        other = _judged(source, label, text, kind, name)
        if other.verdict in ("verified", "equivalent"):
            note = joined("it follows from the Lagrangian of the source", other.note)
            return replace(other, verdict="equivalent", note=note)
    if verdict.verdict != "wrong":
        return verdict
    own = source if source and kind in FROM_LAGRANGIAN else model

    def holds(changed: str) -> bool:
        result = _judged(own, label, changed, kind, name)
        return result.verdict in ("verified", "equivalent")

    result = advised(verdict, own, kind, name, holds, others)
    if verdict.witness:
        value = difference(text, model.context.namespace)
        reasons = (find(model, kind, value) for find in MISTAKES)
        return replace(result, note=joined(result.note, *reasons))
    return result


def _judged(model: ReferenceSystem, label: str, text: str, kind: str, name: str) -> Verdict:
    """Judge a formula without advice; what is undecided is `context`."""
    try:
        about = model.about(difference(text, model.context.namespace))
        if kind == "euler_lagrange":
            verdict = judge_equation(about, label, text)
        else:
            verdict = _judge_quantity(about, label, text, kind, name)
        is_undecided = UNDECIDED in verdict.note and verdict.verdict in ("verified", "equivalent")
        return replace(verdict, verdict="context") if is_undecided else verdict
    except ExpressionError as error:
        return Verdict(label, "unreadable", text, note=str(error))


def _judge_quantity(model: ReferenceSystem, label: str, text: str, kind: str, name: str) -> Verdict:
    value = number(text, model.context.namespace)
    derivation, system = model.derivation, model.derivation.system
    verdict = partial(Verdict, label, printed=text)
    context = model.motions if kind == "accelerations" else model.context
    foreign = foreign_symbols(model, kind, name)
    if invalid := sorted(symbol.name for symbol in value.free_symbols & foreign):
        raise ExpressionError(f"{', '.join(invalid)} cannot occur in a formula of this kind")
    derived = QUANTITIES[kind](model, name)
    # energies and other values, but not the Lagrangian, may contain the constraints
    is_of_motion = system.conditions and kind in (*ENERGIES, "value")
    agreement = model.agreement if is_of_motion else context.agreement
    if (note := agreement(value - derived)) is not None:
        return verdict(verdict="verified", note=note)
    total = derivation.kinetic_energy + derivation.potential_energy
    if kind == "energy" and (note := context.agreement(value - total)) is not None:
        return verdict(verdict="verified", note=joined(TOTAL_ENERGY, note))
    if (note := equivalence(model, kind, value)) is not None:
        return verdict(verdict="equivalent", note=note)
    return verdict(verdict="wrong", witness=context.witness(value, derived))
