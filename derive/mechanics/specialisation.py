"""Systems with numbers in place of parameters; terms that become zero vanish."""

from collections.abc import Mapping
from dataclasses import replace

import sympy as sp

from derive.system.parts import SystemDefinitionError, formula
from derive.system.system import System


def specialised(system: System, values: Mapping[str, float]) -> System:
    """The system of the same name with the named parameters replaced by their exact values."""
    symbols = {symbol.name: symbol for symbol in system.params}
    for name in sorted(values.keys() - symbols):
        known = ", ".join(symbols)
        raise SystemDefinitionError(
            f"system {system.name!r} has no parameter {name[:50]!r}; known are {known}"
        )
    return substituted(system, {symbols[name]: formula(value) for name, value in values.items()})


def substituted(system: System, values: Mapping[sp.Symbol, sp.Expr]) -> System:
    """The system with parameters replaced by numbers or by formulas of other parameters."""

    def substitute(expression: sp.Expr) -> sp.Expr:
        return expression.subs(values)

    return replace(
        system,
        parameters=[p for p in system.parameters if p.symbol not in values],
        masses=[mass.mapped(substitute) for mass in system.masses],
        potential=substitute(system.potential_energy),
        gravity=(sp.S.Zero,) * system.dimension,  # included in the potential
        dissipation=substitute(system.dissipation),
        forces=tuple(map(substitute, system.forces)),
        equilibrium=system.equilibrium and tuple(map(substitute, system.equilibrium)),
        reactions=[length for length in system.reactions if length not in values],
    )
