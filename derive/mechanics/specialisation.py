"""A system whose parameters have values: they are folded in, and what is zero vanishes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import sympy as sp

from derive.system.parts import SystemDefinitionError, formula
from derive.system.system import System


def specialised(system: System, values: Mapping[str, float]) -> System:
    """The system with parameters replaced by numbers, exactly as their digits say.

    Parameters
    ----------
    system : System
        With parameters.
    values : mapping of str to float
        By name; parameters that are not named stay.

    Returns
    -------
    System
        Of the same name, with the other parameters only.

    Raises
    ------
    SystemDefinitionError
        When no parameter is called so, or a value is no number; when what is left is no
        system, since a mass is 0 for instance.
    """
    symbols = {symbol.name: symbol for symbol in system.params}
    for name in values:
        if name not in symbols:
            raise SystemDefinitionError(
                f"system {system.name!r} has no parameter {name[:50]!r}; known are "
                f"{', '.join(symbols)}"
            )
    return substituted(system, {symbols[name]: formula(value) for name, value in values.items()})


def substituted(system: System, values: Mapping[sp.Symbol, sp.Expr]) -> System:
    """The system with parameters replaced by numbers, or by what other parameters make of them."""

    def folded(expression: sp.Expr) -> sp.Expr:
        return expression.subs(values)

    return replace(
        system,
        parameters=[p for p in system.parameters if p.symbol not in values],
        masses=[mass.mapped(folded) for mass in system.masses],
        potential=folded(system.potential_energy),
        gravity=(sp.S.Zero,) * system.dimension,  # it is in the potential
        dissipation=folded(system.dissipation),
        forces=tuple(map(folded, system.forces)),
        equilibrium=None if system.equilibrium is None else tuple(map(folded, system.equilibrium)),
        reactions=[length for length in system.reactions if length not in values],
    )
