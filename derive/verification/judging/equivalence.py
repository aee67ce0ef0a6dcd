"""Formulas that differ from the derived ones, but have the same equations of motion."""

from collections.abc import Iterator

import sympy as sp

from derive.formulas.budget import is_expandable
from derive.system.symbols import TIME
from derive.system.system import System
from derive.verification.judging.engine import joined
from derive.verification.judging.reference_system import ReferenceSystem, depends_on, euler_lagrange
from derive.verification.judging.routhians import equivalents

Differences = tuple[sp.Expr, ...]


def equivalence(model: ReferenceSystem, kind: str, value: sp.Expr) -> str | None:
    """Return the reason for which a formula is equivalent to the derived one; None if it is not."""
    candidates = CANDIDATES.get(kind)
    for differences, reason in candidates(model, value) if candidates else ():
        note = model.context.agreement(*differences)
        if note is not None:
            return joined(reason, note)
    return None


def _lagrangians(model: ReferenceSystem, value: sp.Expr) -> Iterator[tuple[Differences, str]]:
    system, mass = model.derivation.system, model.derivation.mass_matrix[0, 0]
    difference = value - model.lagrangian
    own = euler_lagrange(system, difference)
    constant = _gradient(difference, system.multipliers)
    gauge = "it differs by a total time derivative: it has the same equations of motion"
    yield (*own, *constant), gauge
    if (absorbed := _absorbed(system, own)) is not None:
        potential = (
            "it contains a potential of applied forces: with the other forces alone, it has the "
            "same equations of motion"
        )
        yield (*(a + force for a, force in zip(own, absorbed, strict=True)), *constant), potential
    factor = value.diff(system.qdot[0], 2) / mass
    # a negative factor exchanges kinetic and potential energy; applied forces admit no factor
    if any(system.applied) or not model.context.value(factor).is_positive:
        return
    multiple = "it is a constant times the Lagrangian: it has the same equations of motion"
    constant = _gradient(factor, (*system.q, *system.qdot, TIME))
    own, derived = euler_lagrange(system, value), model.derivation.euler_lagrange
    yield (*constant, *(a - factor * b for a, b in zip(own, derived, strict=True))), multiple


def _absorbed(system: System, own: Differences) -> list[sp.Expr] | None:
    """The terms of applied forces that a term in the Lagrangian gives; None if it gives others."""
    forces = list[sp.Expr]()
    for force, given in zip(system.applied, own, strict=True):
        if not all(map(is_expandable, (force, given))):
            return None
        terms = {*sp.Add.make_args(sp.expand(-given))}
        forces.append(sp.Add(*(t for t in sp.Add.make_args(sp.expand(force)) if t in terms)))
    return forces if any(forces) else None


def _potentials(model: ReferenceSystem, value: sp.Expr) -> Iterator[tuple[Differences, str]]:
    difference, system = value - model.derivation.potential_energy, model.derivation.system
    state = (*system.q, *system.qdot, *system.multipliers)
    yield _gradient(difference, (*state, *_of_time(system))), "it differs by a constant"
    yield _gradient(difference, state), "it differs by a function of time, which exerts no force"


def _of_time(system: System) -> tuple[sp.Symbol, ...]:
    """The time, and inputs, which are functions of it."""
    return (TIME, *(one.symbol for one in system.inputs))


def _energies(model: ReferenceSystem, value: sp.Expr) -> Iterator[tuple[Differences, str]]:
    derivation, system = model.derivation, model.derivation.system
    variables = (*system.q, *system.qdot, *system.multipliers, *_of_time(system))
    terms = sp.Add.make_args(derivation.potential_energy)
    of_time = sp.Add(*(term for term in terms if not depends_on(term, derivation.system.q)))
    total = derivation.kinetic_energy + derivation.potential_energy
    is_total = model.context.is_small(total - model.energy)
    for energy, reason in ((model.energy, "" if is_total else JACOBI), (total, TOTAL_ENERGY)):
        difference, others = value - energy, variables
        if reason == TOTAL_ENERGY:  # T is not arbitrary: the constant is one of V
            known = derivation.potential_energy.free_symbols
            others += tuple(p for p in system.params if p not in known)
        yield _gradient(difference, others), joined(reason, "it differs by a constant")
        if depends_on(of_time, _of_time(system)):
            lacking = "it lacks a function of time in the potential energy, which exerts no force"
            yield _gradient(difference + of_time, variables), joined(reason, lacking)


def _hamiltonians(model: ReferenceSystem, value: sp.Expr) -> Iterator[tuple[Differences, str]]:
    system = model.derivation.system
    difference = value.xreplace(model.momenta) - model.energy
    state = (*system.q, *system.qdot, *system.multipliers)
    yield _gradient(difference, (*state, *_of_time(system))), "it differs by a constant"
    yield _gradient(difference, state), "it differs by a function of time: the same motions follow"


#: Differences that vanish if a formula is equivalent, and the reason.
CANDIDATES = {
    "lagrangian": _lagrangians,
    "potential_energy": _potentials,
    "energy": _energies,
    "hamiltonian": _hamiltonians,
    "routhian": equivalents,
}

#: The notes on Jacobi's integral and on T + V where positions depend on time.
JACOBI = "it is Jacobi's integral, not T + V"
TOTAL_ENERGY = "it is T + V; Jacobi's integral, the value of H, is another quantity"


def _gradient(value: sp.Expr, symbols: tuple[sp.Symbol, ...]) -> Differences:
    return tuple(value.diff(symbol) for symbol in symbols)
