"""The mistake to remove velocities from a Lagrangian by constraints that are not integrable."""

from collections.abc import Iterator
from itertools import combinations

import sympy as sp

from derive.verification.judging.reference_system import ReferenceSystem, time_derivative

Removed = dict[sp.Symbol, sp.Expr]


def substituted_constraints(model: ReferenceSystem, kind: str, value: sp.Expr) -> str:
    """A note if a wrong Lagrangian or equation of motion follows from this mistake, or else "".

    Such a Lagrangian is that of motions alone: its derivatives lack the displacements by which
    varied motions leave the constraints.
    """
    derivation, note = model.derivation, ""
    if not derivation.system.conditions:
        return ""
    reason = (
        "constraints that are not integrable must not be used before the Lagrangian is "
        "differentiated: they restrict velocities, not varied motions; add multipliers instead"
    )
    if kind == "lagrangian" and model.motions.is_small(value - derivation.lagrangian):
        note = f"it is the Lagrangian of motions alone; {reason}"
    elif kind == "euler_lagrange":
        for removed in _removals(model):
            if any(
                _is_multiple(model, value, wrong, removed) for wrong in _equations(model, removed)
            ):
                names = ", ".join(map(str, removed))
                note = f"it follows from the Lagrangian without {names}; {reason}"
                break
    # which takes long for some constraints
    return note if note and derivation.integrability.nonholonomic else ""


def _removals(model: ReferenceSystem) -> Iterator[Removed]:
    """Velocities that constraints give as functions of the others."""
    derivation, qdot = model.derivation, model.derivation.system.qdot
    G = derivation.constraint_jacobian
    for dependent in combinations(qdot, G.rows):
        columns = G.extract([*range(G.rows)], [qdot.index(v) for v in dependent])
        if not model.context.is_small(columns.det()):
            solution = columns.LUsolve(
                -derivation.constraint_rates.subs(dict.fromkeys(dependent, 0))
            )
            yield dict(zip(dependent, solution, strict=True))


def _equations(model: ReferenceSystem, removed: Removed) -> Iterator[sp.Expr]:
    """Lagrange's equations of the Lagrangian without the velocities."""
    system = model.derivation.system
    lagrangian = model.derivation.lagrangian.xreplace(removed)
    for q, qdot, force in zip(system.q, system.qdot, system.applied, strict=True):
        if qdot not in removed:
            change = time_derivative(system, lagrangian.diff(qdot))
            yield change - lagrangian.diff(q) - force


def _is_multiple(model: ReferenceSystem, value: sp.Expr, wrong: sp.Expr, removed: Removed) -> bool:
    """Whether two equations are multiples of each other where the constraints hold."""
    system = model.derivation.system
    accelerations = {
        qddot: time_derivative(system, removed[qdot])
        for qdot, qddot in zip(system.qdot, system.qddot, strict=True)
        if qdot in removed
    }
    one, other = (form.xreplace(accelerations).xreplace(removed) for form in (value, wrong))
    remaining = [a for a in system.qddot if a not in accelerations]
    return model.context.are_multiples(one, other, remaining)
