"""Verdicts on formulas for quantities of a derivation, and on equations of motion."""

from collections.abc import Callable, Iterable
from functools import partial
from itertools import chain

import sympy as sp

from derive.formulas.expression import ExpressionError, parse
from derive.mechanics.derivation import Derivation
from derive.verification.advice import advised, closest_equation
from derive.verification.model import Model, depends_on, time_derivative, variables
from derive.verification.terms import terms_of_equation
from derive.verification.verdict import Verdict


def _entry(derivation: Derivation, entries: Iterable[sp.Expr], name: str) -> sp.Expr:
    """The entry for a coordinate, or for its momentum: these follow, and their names have p_."""
    names = [q.name for q in derivation.system.q]
    return [*entries][[*names, *(f"p_{q}" for q in names)].index(name)]


#: The derived formula of each quantity; the last three have one for each coordinate.
QUANTITIES: dict[str, Callable[[Derivation, str], sp.Expr]] = {
    "kinetic_energy": lambda d, _: d.kinetic_energy,
    "potential_energy": lambda d, _: d.potential_energy,
    "lagrangian": lambda d, _: d.lagrangian,
    "energy": lambda d, _: d.energy,
    "hamiltonian": lambda d, _: d.hamiltonian,
    "momenta": lambda d, name: _entry(d, d.momenta, name),
    "accelerations": lambda d, name: _entry(d, d.accelerations, name),
    "hamilton": lambda d, name: _entry(d, chain(*d.hamilton_equations), name),
}
#: Functions of momenta instead of velocities, and quantities with an arbitrary constant.
CANONICAL = ("hamiltonian", "hamilton")
UP_TO_A_CONSTANT = ("potential_energy", "energy", "hamiltonian")


def judge_formula(model: Model, label: str, text: str, kind: str, coordinate: str = "") -> Verdict:
    """Judge a formula for a key of `QUANTITIES`, or an equation of motion, ``euler_lagrange``."""
    verdict = _judged(model, label, text, kind, coordinate)
    if not verdict.correction:
        return verdict
    derived = QUANTITIES[kind](model.derivation, coordinate) if kind in QUANTITIES else None
    return advised(verdict, model, derived)


def _judged(model: Model, label: str, text: str, kind: str, coordinate: str) -> Verdict:
    """Judge a formula without advice; if it is wrong, the correction is the derived one."""
    try:
        if kind == "euler_lagrange":
            return _judge_equation_of_motion(label, text, model)
        derived = QUANTITIES[kind](model.derivation, coordinate)
        return _judge_quantity(label, text, model, kind, derived)
    except ExpressionError as error:
        return Verdict(label, "unreadable", text, note=str(error))


def _judge_quantity(label: str, text: str, model: Model, kind: str, derived: sp.Expr) -> Verdict:
    value = parse(text, model.context.scope)
    if isinstance(value, sp.MatrixBase):
        raise ExpressionError(f"{text[:50]!r} is a column or matrix, not a number")
    derivation, is_zero = model.derivation, model.context.is_zero
    system, verdict = derivation.system, partial(Verdict, label, printed=text)
    foreign = {*system.qddot, *(system.qdot if kind in CANONICAL else system.p)}
    if invalid := sorted(symbol.name for symbol in value.free_symbols & foreign):
        raise ExpressionError(f"{', '.join(invalid)} cannot occur in a formula of this kind")
    difference = value - derived
    if is_zero(difference):
        return verdict(verdict="verified")
    if kind == "lagrangian" and _is_gauge_term(difference, model):
        return verdict(verdict="equivalent", note="it has the same equations of motion")
    total = derivation.kinetic_energy + derivation.potential_energy
    if kind == "energy" and is_zero(value - total):
        note = "it is T + V; Jacobi's integral, the value of H, is another quantity"
        return verdict(verdict="verified", note=note)
    if kind in UP_TO_A_CONSTANT and all(is_zero(difference.diff(s)) for s in variables(system)):
        return verdict(verdict="equivalent", note="it differs by a constant")
    return verdict(verdict="wrong", correction=str(derived))


def _is_gauge_term(difference: sp.Expr, model: Model) -> bool:
    """Whether a part of a Lagrangian cancels in the equations of motion."""
    system = model.derivation.system
    return all(
        model.context.is_zero(time_derivative(system, difference.diff(qdot)) - difference.diff(q))
        for q, qdot in zip(system.q, system.qdot, strict=True)
    )


def _judge_equation_of_motion(label: str, text: str, model: Model) -> Verdict:
    """Judge an equation that must hold along every motion, and depend on accelerations."""
    if text.count("=") > 1:
        raise ExpressionError(f"an equation has one equals sign, not {text.count('=')}")
    terms = terms_of_equation(text, model.context.scope)
    accelerations = model.derivation.system.qddot
    verdict = partial(Verdict, label, printed=text)
    value = sp.Add(*(term.value for term in terms))
    if not depends_on(value, accelerations):
        return verdict(verdict="wrong", note="it contains no acceleration")
    derived = closest_equation(terms, model)
    if model.context.is_zero(value - derived):
        return verdict(verdict="verified")
    if not all(value.diff(a, b).equals(0) for a in accelerations for b in accelerations):
        return verdict(verdict="wrong", note="it is not linear in the accelerations")
    if model.holds_along_motions(value):
        return verdict(verdict="verified", note="it is a combination of the equations of motion")
    return verdict(verdict="wrong", correction=f"{derived} = 0")
