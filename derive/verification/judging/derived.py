"""The derived formula of each quantity: one to compare with, and one to print."""

from collections.abc import Callable, Iterable

import sympy as sp

from derive.system.symbols import TIME
from derive.verification.judging.reference_system import ReferenceSystem, time_derivative
from derive.verification.judging.routhians import routhian, value_of


def _acceleration(model: ReferenceSystem, name: str) -> sp.Expr:
    system, value = model.derivation.system, model.context.namespace[name]
    return time_derivative(system, time_derivative(system, value))


def _hamilton(model: ReferenceSystem, name: str) -> sp.Expr:
    """The rate of a coordinate or momentum; that of a momentum is ∂L/∂q + Q."""
    system = model.derivation.system
    pairs = zip(system.q, model.forces, strict=True)
    return _rate(model, name, system.qdot, [model.lagrangian.diff(q) + force for q, force in pairs])


def _rate(
    model: ReferenceSystem, name: str, velocities: Iterable[sp.Expr], forces: Iterable[sp.Expr]
) -> sp.Expr:
    system, value = model.derivation.system, model.context.namespace[name]
    rates = zip((*system.q, *system.p), (*velocities, *forces), strict=True)
    return sp.Add(value.diff(TIME), *(value.diff(symbol) * rate for symbol, rate in rates))


#: Functions of coordinates, velocities, accelerations and momenta. Momenta, accelerations and rates
#: have a formula for each coordinate, or name of one: a mirrored angle has the opposite momentum.
#: The name of a Routhian is that of its eliminated coordinates. The last is any other quantity that
#: a name stands for.
QUANTITIES: dict[str, Callable[[ReferenceSystem, str], sp.Expr]] = {
    "kinetic_energy": lambda model, _: model.derivation.kinetic_energy,
    "potential_energy": lambda model, _: model.derivation.potential_energy,
    "lagrangian": lambda model, _: model.lagrangian,
    "energy": lambda model, _: model.energy,
    "hamiltonian": lambda model, _: model.energy,
    "momenta": lambda model, name: model.context.namespace[f"p_{name}"],
    "accelerations": _acceleration,
    "hamilton": _hamilton,
    "routhian": value_of,
    "value": lambda model, name: model.context.namespace[name],
}

#: Quantities that are functions of momenta instead of velocities.
CANONICAL = ("hamiltonian", "hamilton")


def foreign_symbols(model: ReferenceSystem, kind: str, name: str) -> frozenset[sp.Symbol]:
    """Symbols that a formula for a quantity cannot contain."""
    system = model.derivation.system
    if kind == "value":
        return frozenset()
    others = [*(system.qdot if kind in CANONICAL else system.p)]
    if kind == "routhian":
        indices = [k for k, q in enumerate(system.q) if q.name in name.split()]
        others = [v if k in indices else p
                  for k, (v, p) in enumerate(zip(system.qdot, system.p, strict=True))]  # fmt: skip
    return frozenset((*system.qddot, *others))


def printed_formula(model: ReferenceSystem, kind: str, name: str) -> sp.Expr | None:
    """The formula in the variables of its kind; None if it requires a large inverse."""
    derivation, system = model.derivation, model.derivation.system
    if kind in ("accelerations", *CANONICAL) and not model.has_inverse:
        return None
    match kind:
        case "hamiltonian":
            return derivation.hamiltonian
        case "routhian":
            return routhian(model, name).function
        case "hamilton":
            return _rate(model, name, *derivation.hamilton_equations)
        case "accelerations":
            known = dict(zip(system.qddot, derivation.accelerations, strict=True))
            return QUANTITIES[kind](model, name).xreplace(known)
        case "momenta":
            return QUANTITIES[kind](model, name).xreplace(model.momenta)
    return QUANTITIES[kind](model, name)
