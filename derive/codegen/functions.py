"""The table of generated functions: what each takes, and what it returns."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from derive.codegen.assignments import Assignments, assignments
from derive.codegen.equations_of_motion import Mechanics
from derive.codegen.factorisation import LARGE
from derive.codegen.graph import Node
from derive.codegen.hamiltonian_form import HamiltonianForm
from derive.codegen.lagrangian_form import LagrangianForm
from derive.codegen.lowering import Lowering
from derive.codegen.rational import opened
from derive.mechanics.derivation import Derivation
from derive.system.symbols import TIME
from derive.system.system import System

Form = Literal["lagrangian", "hamiltonian", "rational", "variational", "parameters"]

#: What is kept in place of the energy where positions depend on time.
ENERGY = "Jacobi's integral qdot dL/dqdot - L, which is not T + V since positions depend on time"

#: name, form of the state, shape of the result, first line of the docstring, what comes back
TABLE: tuple[tuple[str, Form, str, str, str], ...] = (
    (
        "rhs", "lagrangian", "state",
        "Right-hand side of y' = rhs(t, y, params) for y = (q, qdot).",
        "Time derivative of y: velocities, then accelerations from M qddot = f.",
    ),
    (
        "jacobian", "lagrangian", "state state",
        "Jacobian of `rhs`.",
        "Entry [i][j] is the derivative of rhs[i] with respect to y[j].",
    ),
    (
        "energy", "lagrangian", "",
        "{energy}.",
        "Energy in J.",
    ),
    (
        "power", "lagrangian", "",
        "Rate at which `energy` grows: work of applied forces, friction and what moves by itself.",
        "Power in W.",
    ),
    (
        "reactions", "lagrangian", "reactions",
        "Forces that hold {held}, by Lagrange's multipliers.",
        "One for each: a rod's tension, positive where it pulls.",
    ),
    (
        "mass_matrix", "lagrangian", "q q",
        "Mass matrix M(q): the kinetic energy is qdot M qdot / 2.",
        "M, symmetric and positive definite, row by row.",
    ),
    (
        "positions", "lagrangian", "masses axes",
        "Positions of the masses.",
        "One row a mass: its Cartesian components in m, the last one upwards.",
    ),
    (
        "hamiltonian_state", "lagrangian", "state",
        "State (q, p) of the Hamiltonian form that belongs to y = (q, qdot).",
        "Coordinates, then momenta p = M qdot.",
    ),
    (
        "rhs_hamiltonian", "hamiltonian", "state",
        "Right-hand side of y' = rhs_hamiltonian(t, y, params) for y = (q, p).",
        "Time derivative of y: velocities from M qdot = p, then -dH/dq.",
    ),
    (
        "jacobian_hamiltonian", "hamiltonian", "state state",
        "Jacobian of `rhs_hamiltonian`.",
        "Entry [i][j] is the derivative of rhs_hamiltonian[i] with respect to y[j].",
    ),
    (
        "energy_hamiltonian", "hamiltonian", "",
        "Hamiltonian H(q, p): `energy` by momenta.",
        "Energy in J.",
    ),
    (
        "lagrangian_state", "hamiltonian", "state",
        "State (q, qdot) of the Lagrangian form that belongs to y = (q, p).",
        "Coordinates, then velocities from M qdot = p.",
    ),
    (
        "rational_state", "lagrangian", "rational",
        "State of the rational form that belongs to y = (q, qdot).",
        "Sine and cosine of every angle, other coordinates, velocities.",
    ),
    (
        "rhs_rational", "rational", "rational",
        "Right-hand side of y' = rhs_rational(t, y, params): no function is called.",
        "Time derivative of y.",
    ),
    (
        "rhs_variational", "variational", "variational",
        "Right-hand side of y' = rhs_variational(t, y, params): a motion and a small change of it.",
        "Time derivative of y: the motion's, then that of the change, to first order.",
    ),
    (
        "equilibrium", "parameters", "q",
        "Coordinates at rest.",
        "q = {equilibrium}.",
    ),
    (
        "linear", "parameters", "2 q q",
        "Matrices of small motions x about rest at q = {equilibrium}.",
        "M0 and K of M0 xddot + K x = 0.",
    ),
)  # fmt: skip


@dataclass(frozen=True)
class Function:
    """A function of a generated module.

    Attributes
    ----------
    name, summary, returns : str
        Its name, the first line of its docstring, and what it returns.
    form : {"lagrangian", "hamiltonian", "rational", "variational", "parameters"}
        Which state it takes as ``y``; ``parameters`` means none.
    state : tuple of str
        Names of the components of ``y``, in order.
    shape : tuple of int
        Shape of the result; ``()`` is a single number.
    lowering : Lowering
        The operations; its outputs are the result, flat in C order.
    """

    name: str
    summary: str
    returns: str
    form: Form
    state: tuple[str, ...]
    shape: tuple[int, ...]
    lowering: Lowering

    @property
    def depends_on_time(self) -> bool:
        """Whether the result does."""
        operations = self.lowering.operations.values()
        return any(o.kind == "leaf" and o.label == TIME.name for o in operations)


@dataclass(frozen=True)
class Contents:
    """What the generated files of a system hold, whatever language they are in.

    Attributes
    ----------
    derivation : Derivation
        Where everything comes from.
    states : dict of form to tuple of str
        Names of the components of ``y`` in each form that exists.
    functions : tuple of Function
        The functions that exist: without angles there is no rational form, without a
        known equilibrium no ``equilibrium`` and no ``linear``.
    """

    derivation: Derivation
    states: dict[Form, tuple[str, ...]]
    functions: tuple[Function, ...]

    @property
    def system(self) -> System:
        """The system."""
        return self.derivation.system


def contents(derivation: Derivation, only: Collection[str] | None = None) -> Contents:
    """Everything that is generated for `derivation`, or `only` the functions of these names."""
    system = derivation.system
    states = _states(derivation)
    sizes = {
        "q": len(system.q),
        "state": 2 * len(system.q),
        "rational": len(states.get("rational", ())),
        "variational": len(states["variational"]),
        "masses": len(system.masses),
        "axes": system.dimension,
        "reactions": len(system.reactions),
        "2": 2,
    }
    parameters = {symbol.name for symbol in system.params}
    return Contents(
        derivation,
        states,
        tuple(
            Function(
                name,
                _said(summary, derivation),
                _said(returns, derivation),
                form,
                states.get(form, ()),
                tuple(sizes[word] for word in shape.split()),
                Lowering(_nodes(derivation, name, form), parameters),
            )
            for name, form, shape, summary, returns in TABLE
            if (only is None or name in only)
            and ("rational" not in (form, shape) or "rational" in states)
            and (name not in EXISTS or EXISTS[name](derivation))
        ),
    )


def _nodes(derivation: Derivation, name: str, form: Form) -> list[Node]:
    """The outputs of a function, with as few calls as may be."""
    of_form = HamiltonianForm if form == "hamiltonian" else LagrangianForm
    return opened(getattr(of_form(derivation), name), [q.name for q in derivation.system.q])


def _said(text: str, derivation: Derivation) -> str:
    """A text with what it leaves open filled in."""
    return re.sub(r"{(\w+)}", lambda found: WORDS[found[1]](derivation), text)


#: What the texts of the table leave open.
WORDS: dict[str, Callable[[Derivation], str]] = {
    "equilibrium": lambda derivation: f"({', '.join(map(str, derivation.rest or ()))})",
    "held": lambda derivation: ", ".join(s.name for s in derivation.system.reactions),
    "energy": lambda derivation: ENERGY if TIME in derivation.variables else "Total energy T + V",
}

#: Functions that only some systems have, and which.
EXISTS: dict[str, Callable[[Derivation], bool]] = {
    "power": lambda derivation: derivation.power != 0,
    "reactions": lambda derivation: bool(derivation.system.reactions),
    # n² entries of n terms each: for a large system that is too much text
    "jacobian_hamiltonian": lambda derivation: len(derivation.system.q) < LARGE,
    "equilibrium": lambda derivation: derivation.rest is not None,
    "linear": lambda derivation: derivation.rest is not None and derivation.is_sprung,
}


def named(stem: str, form: str) -> str:
    """The name of a function in a form: ``rhs`` in Lagrange's form, else ``rhs_rational`` etc."""
    return stem if form == "lagrangian" else f"{stem}_{form}"


def _states(derivation: Derivation) -> dict[Form, tuple[str, ...]]:
    system, angles = derivation.system, Mechanics(derivation).angles
    places = [
        name
        for q in system.q
        for name in ([f"sin_{q.name}", f"cos_{q.name}"] if q in angles else [q.name])
    ]
    states: dict[Form, tuple[str, ...]] = {
        "lagrangian": tuple(s.name for s in system.q + system.qdot),
        "hamiltonian": tuple(s.name for s in system.q + system.p),
    }
    rational = (*places, *(s.name for s in system.qdot))
    if angles:
        states["rational"] = rational
    states["variational"] = (*rational, *(s.name for s in system.variations))
    return states


def body(
    part: Function, system: System, called: Mapping[str, str] = MappingProxyType({})
) -> Assignments:
    """The function's assignments; what it takes and the parameters are `called` as they are."""
    taken = {*part.state, *(s.name for s in system.params), "t", "y", "state", "params", "result"}
    return assignments(part.lowering, taken, called)
