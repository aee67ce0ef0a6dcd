"""Systems with numbers in place of parameters, or formulas in place of inputs."""

from collections.abc import Mapping
from dataclasses import replace

import sympy as sp

from derive.formulas.expression import FUNCTIONS, number
from derive.formulas.syntax import ExpressionError
from derive.system.parts import SystemDefinitionError, formula
from derive.system.symbols import TIME, motions
from derive.system.system import System, as_system
from solvers.io.suggestion import did_you_mean


def specialised(system: System, values: Mapping[str, float]) -> System:
    """The system of the same name with the named parameters replaced by their exact values."""
    symbols = {symbol.name: symbol for symbol in system.params}
    for name in sorted(values.keys() - symbols):
        known = ", ".join(symbols)
        raise SystemDefinitionError(
            f"system {system.name!r} has no parameter {name[:50]!r}; known are {known}"
        )
    return substituted(system, {symbols[name]: formula(value) for name, value in values.items()})


def with_inputs(system: System, formulas: Mapping[str, sp.Expr | float | str]) -> System:
    """The system with functions of time and state in place of inputs.

    Parameters
    ----------
    system : System
        A system with inputs.
    formulas : mapping of str to sympy.Expr, number or str
        For each input to replace, by name, a function of time, coordinates, velocities and
        parameters, such as ``"-k*x - c*x_dot"``; text is parsed, never executed. In positions
        and potentials inputs cannot depend on velocities. A prescribed motion s is a function of
        time, which replaces its velocity and acceleration, too.

    Returns
    -------
    System
        Its other inputs remain inputs.

    Raises
    ------
    SystemDefinitionError
        When the system has no such input, or a formula is invalid.

    Examples
    --------
    >>> from sympy import Symbol
    >>> from derive import Coordinate, Derivation, Input, Parameter, PointMass, System, with_inputs
    >>> x, F = Symbol("x", real=True), Symbol("F", real=True)
    >>> m = Symbol("m", positive=True)
    >>> cart = System("cart", "A cart", [Coordinate(x, "m", "position")],
    ...     [Parameter(m, "kg", 1.0, "mass")], [PointMass(m, (x, 0))], potential=0, forces=(F,),
    ...     inputs=[Input(F, "N", "force on the cart")])
    >>> Derivation(with_inputs(cart, {"F": "-3*x - 2*x_dot"})).forcing[0]
    -3*x - 2*x_dot
    """
    inputs = {symbol.name: symbol for symbol in as_system(system).u}
    for name in formulas:
        if name not in inputs:
            hint, known = did_you_mean(str(name), inputs), ", ".join(inputs) or "none"
            raise SystemDefinitionError(
                f"system {system.name!r} has no input {str(name)[:50]!r}{hint}; inputs are {known}"
            )
    others = [symbol for symbol in system.params if symbol.name not in formulas]
    namespace = FUNCTIONS | {s.name: s for s in (*system.q, *system.qdot, *others, TIME)}

    def value(name: str) -> sp.Expr:
        given = formulas[name]
        try:
            return formula(number(given, namespace) if isinstance(given, str) else given)
        except (ExpressionError, SystemDefinitionError) as error:
            raise SystemDefinitionError(f"input {name}: {error}") from error

    values = {inputs[name]: value(name) for name in formulas}
    for s, *others in motions(system.inputs).values():
        if s in values:  # the motion at any time, which no velocity continues
            values |= dict.fromkeys(others, sp.S.Zero)
    return substituted(system, values)


def substituted(system: System, values: Mapping[sp.Symbol, sp.Expr]) -> System:
    """The system with parameters or inputs replaced by numbers or by formulas of others."""

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
        inputs=[part for part in system.inputs if part.symbol not in values],
        outputs={name: substitute(output) for name, output in system.measured},
        constraints=[one.with_formula(substitute(one.formula)) for one in system.conditions],
        links=[link.mapped(substitute) for link in system.links],
        eliminated=[one.mapped(substitute) for one in system.eliminated],
    )
