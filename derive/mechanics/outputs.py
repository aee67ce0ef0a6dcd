"""Measured quantities as formulas of state, time and parameters."""

from collections.abc import Sequence

import sympy as sp

from derive.formulas.expression import FUNCTIONS
from derive.mechanics.energies.kinetics import Kinetics
from derive.mechanics.linearisation.point import Formula, expression
from derive.system.parts import SystemDefinitionError
from derive.system.symbols import TIME
from solvers.io.suggestion import did_you_mean, shortened


def named_outputs(kinetics: Kinetics) -> dict[str, sp.Expr]:
    """Quantities with names: ``energy``, positions ``x1``, ``y1`` ..., outputs, and the state.

    The number is that of the mass, in the order of the system; two axes are x and y.
    """
    system = kinetics.system
    positions = {
        f"{axis}{k}": part
        for k, mass in enumerate(system.masses, 1)
        for axis, part in zip("xyz", mass.position, strict=False)
    }
    state = {s.name: s for s in (*system.q, *system.qdot)}
    return {"energy": kinetics.energy} | positions | dict(system.measured) | state


def outputs(kinetics: Kinetics, formulas: Sequence[Formula]) -> tuple[sp.Expr, ...]:
    """Formulas, or names of `named_outputs`, as expressions; `SystemDefinitionError` if invalid."""
    system, named = kinetics.system, named_outputs(kinetics)
    symbols = {s.name: s for s in (*system.params, TIME)}
    namespace, results = FUNCTIONS | symbols | named, []
    for given in formulas:
        if isinstance(given, str) and given.isidentifier() and given not in namespace:
            raise SystemDefinitionError(
                f"{shortened(given)} is no output{did_you_mean(given, named)}; known are "
                f"{', '.join(named)}, and formulas of these and of parameters"
            )
        results.append(expression(f"output {shortened(given)}", given, namespace))
    return tuple(results)
