"""Routhians of a source: their coordinates, equivalent ones, and the classic mistake."""

from collections.abc import Iterator

import sympy as sp

from derive.formulas.expression import number
from derive.formulas.syntax import ExpressionError
from derive.mechanics.routhian import Routhian
from derive.system.system import System
from derive.verification.judging.reference_system import (
    ReferenceSystem,
    depends_on,
    time_derivative,
)


def eliminated(model: ReferenceSystem, value: sp.Expr) -> tuple[int, ...]:
    """Indices of the coordinates whose momenta a formula contains.

    Of a formula without momenta, these are the cyclic coordinates whose velocities it lacks.
    """
    system, used = model.derivation.system, value.free_symbols
    own = tuple(k for k, p in enumerate(system.p) if p in used)
    cyclic = model.derivation.cyclic_coordinates
    rows = enumerate(zip(system.q, system.qdot, strict=True))
    return own or tuple(k for k, (q, v) in rows if q in cyclic and v not in used)


def eliminated_names(model: ReferenceSystem, text: str) -> str:
    """The name of the Routhian that a formula states: that of its eliminated coordinates."""
    try:
        value = number(text, model.context.namespace)
    except ExpressionError:
        return ""
    return names_of(model.derivation.system, eliminated(model, value))


def names_of(system: System, indices: tuple[int, ...]) -> str:
    """The coordinates of a Routhian as the name of the quantity."""
    return " ".join(system.q[k].name for k in indices)


def routhian(model: ReferenceSystem, name: str) -> Routhian:
    """The derived Routhian of the coordinates in a name."""
    q = [one.name for one in model.derivation.system.q]
    return Routhian(model.derivation, tuple(q.index(one) for one in name.split()))


def value_of(model: ReferenceSystem, name: str) -> sp.Expr:
    """L - Σ p q̇ over the coordinates in a name, as a function of velocities."""
    system = model.derivation.system
    rows = zip(system.q, system.p, system.qdot, strict=True)
    work = (model.momenta[p] * v for q, p, v in rows if q.name in name.split())
    return model.lagrangian - sp.Add(*work)


def equivalents(
    model: ReferenceSystem, value: sp.Expr
) -> Iterator[tuple[tuple[sp.Expr, ...], str]]:
    """Differences that vanish for other Routhians with the same equations, and the reasons."""
    system, indices = model.derivation.system, eliminated(model, value)
    derived = routhian(model, names_of(system, indices))
    opposite = "it has the opposite sign, sum p*q_dot - L: it has the same equations of motion"
    yield (value + derived.function,), opposite
    if any(system.q[k] not in model.derivation.cyclic_coordinates for k in indices):
        return
    for sign, note in ((1, ""), (-1, "it has the opposite sign; ")):
        difference = sign * value - derived.function
        state = [s for k in derived.remaining for s in (system.q[k], system.qdot[k])]
        gradient = tuple(difference.diff(s) for s in state)
        yield (
            gradient,
            f"{note}it differs by a function of the constant momenta: it has the same "
            "equations of the other coordinates, but not of the eliminated ones",
        )
        yield (
            _residuals(model, derived, difference),
            (f"{note}it differs by a total time derivative: it has the same equations of motion"),
        )


def _residuals(model: ReferenceSystem, derived: Routhian, function: sp.Expr) -> tuple[sp.Expr, ...]:
    """d/dt ∂F/∂q̇ - ∂F/∂q of the remaining coordinates, with constant momenta."""
    system = model.derivation.system
    pairs = [(system.q[k], system.qdot[k]) for k in derived.remaining]
    return tuple(time_derivative(system, function.diff(v)) - function.diff(q) for q, v in pairs)


def without_legendre_term(model: ReferenceSystem, kind: str, value: sp.Expr) -> str:
    """A note if momenta are substituted into L as if this were a Routhian, or else ""."""
    system = model.derivation.system
    indices = eliminated(model, value)
    if kind not in ("routhian", "euler_lagrange") or not depends_on(value, system.p):
        return ""
    names = ", ".join(system.p[k].name for k in indices)
    reason = (
        "momenta in place of velocities leave a function that is no Lagrangian of the other "
        "coordinates, since the velocities then depend on these; subtract sum p*q_dot"
    )
    if kind == "routhian" and model.context.is_small(value - model.lagrangian):
        return f"it is the Lagrangian with {names}: {reason}"
    if kind == "euler_lagrange" and not system.conditions:
        derived = routhian(model, names_of(system, indices))
        substituted = model.derivation.lagrangian.xreplace(derived.velocities)
        rows = zip(derived.remaining, _residuals(model, derived, substituted), strict=True)
        for k, row in rows:
            force = system.applied[k].xreplace(derived.velocities)
            if model.context.are_multiples(value, row - force, system.qddot):
                return f"it follows from the Lagrangian with {names}: {reason}"
    return ""
