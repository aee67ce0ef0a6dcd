"""The verdict on each equation of a hand derivation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import sympy as sp

from derive.formulas.expression import ExpressionError, parse
from derive.verification.hand.meaning import Meaning
from derive.verification.hand.terms import Slip, Written, scale, slip, written, wrong


@dataclass(frozen=True)
class Judgement:
    """What was found about one equation.

    Attributes
    ----------
    place : str
        Which one, such as ``accelerations.theta1``.
    verdict : {"equal", "equivalent", "wrong", "unreadable"}
        An equivalent Lagrangian is another one with the same equations of motion.
    printed : str
        As it is written.
    term, should_be : str
        The first term that differs, and what should stand there.
    witness : str
        Both values at the state of `Meaning.numbers`.
    correction : str
        The whole right formula.
    note : str
        What else there is to say.
    """

    place: str
    verdict: str
    printed: str
    term: str = ""
    should_be: str = ""
    witness: str = ""
    correction: str = ""
    note: str = ""


def judged(place: str, text: str, meaning: Meaning, kind: str, key: str) -> Judgement:
    """The verdict on the equation `text`, which is of this `kind` and, for a coordinate, `key`."""
    try:
        if kind == "euler_lagrange":
            return _residual(place, text, meaning)
        return _value(place, text, meaning, VALUES[kind](meaning, key), kind)
    except ExpressionError as error:
        return Judgement(place, "unreadable", text, note=str(error))


def _value(place: str, text: str, meaning: Meaning, right: sp.Expr, kind: str) -> Judgement:
    """A formula that is to be one of the derivation."""
    value = parse(text, meaning.scope)
    if not isinstance(value, sp.Expr):
        raise ExpressionError(f"{text[:50]!r} is a column or matrix, not a number")
    system = meaning.system
    foreign = {*system.qddot, *(system.qdot if kind in CANONICAL else system.p)}
    if strange := sorted(s.name for s in value.free_symbols & foreign):
        raise ExpressionError(f"{', '.join(strange)} has no place in a formula of this kind")
    if meaning.is_zero(value - right):
        return Judgement(place, "equal", text)
    if kind == "lagrangian" and _moves_alike(value - right, meaning):
        return Judgement(
            place, "equivalent", text, note="it differs by what leaves the motion as it is"
        )
    total = meaning.derivation.kinetic_energy + meaning.derivation.potential_energy
    if kind == "energy" and meaning.is_zero(value - total):
        return Judgement(
            place, "equal", text, note="it is T + V; Jacobi's integral, which H is, is another"
        )
    if kind in UP_TO_A_CONSTANT and all(
        meaning.is_zero((value - right).diff(s)) for s in meaning.state
    ):
        return Judgement(place, "equivalent", text, note="it differs by a constant")
    found = _slip_of_quotient(text, meaning, right)
    return _differing(place, text, found, _witness(value, right, meaning), str(right))


#: Formulas in momenta instead of velocities, and those in which a constant is free.
CANONICAL = ("hamiltonian", "hamilton")
UP_TO_A_CONSTANT = ("potential_energy", "energy", "hamiltonian")


def _moves_alike(difference: sp.Expr, meaning: Meaning) -> bool:
    """Whether a part of a Lagrangian drops out of the equations of motion."""
    system = meaning.system
    return all(
        meaning.is_zero(meaning.rate(difference.diff(qdot)) - difference.diff(q))
        for q, qdot in zip(system.q, system.qdot, strict=True)
    )


def _slip_of_quotient(text: str, meaning: Meaning, right: sp.Expr) -> Slip | None:
    """The first wrong term of a sum, or of a quotient whose denominator is right."""
    parts = written(text, meaning.scope)
    if len(parts) == 1:
        above, below = sp.fraction(sp.together(parts[0].value))
        over, under = sp.fraction(sp.together(right))
        if below.free_symbols & {*meaning.state}:
            ratio = scale([Written("", below)], under, meaning.state)
            if not meaning.is_zero(below - ratio * under):
                return Slip(str(below), sp.expand(ratio * under))
            numerator = text.rpartition("/")[0].strip()
            inner = numerator[1:-1] if numerator[:1] == "(" and numerator[-1:] == ")" else ""
            try:
                parts = written(inner, meaning.scope) if inner else [Written(text, above)]
            except ExpressionError:  # brackets of two factors
                parts = [Written(text, above)]
            return slip(parts, over * ratio, meaning.state)
    return slip(parts, right, meaning.state)


def _residual(place: str, text: str, meaning: Meaning) -> Judgement:
    """An equation of motion: with its accelerations it must hold, and say something of them."""
    if text.count("=") > 1:
        raise ExpressionError(f"an equation has one sign of equality, not {text.count('=')}")
    left, equals, other = text.partition("=")
    parts = written(left, meaning.scope)
    if equals:
        parts += [Written(p.text, -p.value, -1) for p in written(other, meaning.scope)]
    value, accelerations = sp.Add(*(part.value for part in parts)), meaning.system.qddot
    if not value.free_symbols & {*accelerations}:
        return Judgement(place, "wrong", text, note="no acceleration is in it")
    rights = [
        right * scale(parts, right, meaning.state, meaning.system.qddot)
        for right in meaning.derivation.euler_lagrange
    ]
    # whichever coordinate it belongs to
    right = min(rights, key=lambda right: len(wrong(parts, right, meaning.state)))
    if meaning.is_zero(value - right):
        return Judgement(place, "equal", text)
    if not all(value.diff(a, b).equals(0) for a in accelerations for b in accelerations):
        return Judgement(place, "wrong", text, note="it is not linear in the accelerations")
    if meaning.holds(value):
        return Judgement(place, "equal", text, note="it follows from the others with it")
    found = slip(parts, right, meaning.state)
    return _differing(place, text, found, _witness(value, right, meaning), f"{right} = 0")


def _differing(
    place: str, text: str, found: Slip | None, witness: str, correction: str
) -> Judgement:
    """A wrong equation; which term is wrong is not always found, as in unusual quotients."""
    term, should_be = (found.term, str(found.should_be)) if found else ("", "")
    return Judgement(place, "wrong", text, term, should_be, witness, correction)


def _witness(value: sp.Expr, right: sp.Expr, meaning: Meaning) -> str:
    numbers = meaning.numbers()
    printed, derived = (sp.sstr(e.evalf(8, subs=numbers)) for e in (value, right))
    return f"{printed}, but it should be {derived}"


def _of(meaning: Meaning, column: sp.Matrix, key: str) -> sp.Expr:
    return column[[q.name for q in meaning.system.q].index(key)]


def _hamilton(meaning: Meaning, key: str) -> sp.Expr:
    velocities, slopes = meaning.derivation.hamilton_equations
    names = [q.name for q in meaning.system.q]
    if key in names:
        return velocities[names.index(key)]
    return slopes[names.index(key.removeprefix("p_"))]


#: What each kind of formula should be.
VALUES: dict[str, Callable[[Meaning, str], sp.Expr]] = {
    "kinetic_energy": lambda meaning, _: meaning.derivation.kinetic_energy,
    "potential_energy": lambda meaning, _: meaning.derivation.potential_energy,
    "lagrangian": lambda meaning, _: meaning.derivation.lagrangian,
    "energy": lambda meaning, _: meaning.derivation.energy,
    "hamiltonian": lambda meaning, _: meaning.derivation.hamiltonian,
    "momenta": lambda meaning, key: _of(meaning, meaning.derivation.momenta, key),
    "accelerations": lambda meaning, key: _of(meaning, meaning.derivation.accelerations, key),
    "hamilton": _hamilton,
}
