"""Formulas that differ from the derived ones, but have the same equations of motion."""

from collections.abc import Iterator

import sympy as sp

from derive.system.symbols import TIME
from derive.verification.engine import joined
from derive.verification.model import Model, depends_on, time_derivative
from derive.verification.routhians import equivalents

Differences = tuple[sp.Expr, ...]


def equivalence(model: Model, kind: str, value: sp.Expr) -> str | None:
    """Return the reason for which a formula is equivalent to the derived one; None if it is not."""
    candidates = CANDIDATES.get(kind)
    for differences, reason in candidates(model, value) if candidates else ():
        note = model.context.agreement(*differences)
        if note is not None:
            return joined(reason, note)
    return None


def _lagrangians(model: Model, value: sp.Expr) -> Iterator[tuple[Differences, str]]:
    system, mass = model.derivation.system, model.derivation.mass_matrix[0, 0]
    difference = value - model.lagrangian
    gauge = "it differs by a total time derivative: it has the same equations of motion"
    yield _euler_lagrange(model, difference), gauge
    factor = value.diff(system.qdot[0], 2) / mass
    # a negative factor exchanges kinetic and potential energy; applied forces admit no factor
    if any(system.applied) or not model.context.value(factor).is_positive:
        return
    multiple = "it is a constant times the Lagrangian: it has the same equations of motion"
    constant = _gradient(factor, (*system.q, *system.qdot, TIME))
    own, derived = _euler_lagrange(model, value), model.derivation.euler_lagrange
    yield (*constant, *(a - factor * b for a, b in zip(own, derived, strict=True))), multiple


def _potentials(model: Model, value: sp.Expr) -> Iterator[tuple[Differences, str]]:
    difference, q = value - model.derivation.potential_energy, model.derivation.system.q
    yield _gradient(difference, (*q, TIME)), "it differs by a constant"
    yield _gradient(difference, q), "it differs by a function of time, which exerts no force"


def _energies(model: Model, value: sp.Expr) -> Iterator[tuple[Differences, str]]:
    derivation = model.derivation
    variables = (*derivation.system.q, *derivation.system.qdot, TIME)
    terms = sp.Add.make_args(derivation.potential_energy)
    of_time = sp.Add(*(term for term in terms if not depends_on(term, derivation.system.q)))
    total = derivation.kinetic_energy + derivation.potential_energy
    for energy, reason in ((model.energy, ""), (total, TOTAL_ENERGY)):
        difference = value - energy
        yield _gradient(difference, variables), joined(reason, "it differs by a constant")
        if depends_on(of_time, (TIME,)):
            lacking = "it lacks a function of time in the potential energy, which exerts no force"
            yield _gradient(difference + of_time, variables), joined(reason, lacking)


def _hamiltonians(model: Model, value: sp.Expr) -> Iterator[tuple[Differences, str]]:
    system = model.derivation.system
    difference = value.xreplace(model.momenta) - model.energy
    state = (*system.q, *system.qdot)
    yield _gradient(difference, (*state, TIME)), "it differs by a constant"
    yield _gradient(difference, state), "it differs by a function of time: the same motions follow"


#: Differences that vanish if a formula is equivalent, and the reason.
CANDIDATES = {
    "lagrangian": _lagrangians,
    "potential_energy": _potentials,
    "energy": _energies,
    "hamiltonian": _hamiltonians,
    "routhian": equivalents,
}

#: The note on T + V where positions depend on time.
TOTAL_ENERGY = "it is T + V; Jacobi's integral, the value of H, is another quantity"


def _gradient(value: sp.Expr, symbols: tuple[sp.Symbol, ...]) -> Differences:
    return tuple(value.diff(symbol) for symbol in symbols)


def _euler_lagrange(model: Model, lagrangian: sp.Expr) -> Differences:
    """d/dt ∂L/∂q̇ - ∂L/∂q for each coordinate."""
    system = model.derivation.system
    pairs = zip(system.q, system.qdot, strict=True)
    return tuple(
        time_derivative(system, lagrangian.diff(qdot)) - lagrangian.diff(q) for q, qdot in pairs
    )
