"""The table of generated functions: what each takes, and what it returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from derive.derivation import Derivation
from derive.lowering import Lowering
from derive.mechanics import Mechanics
from derive.system import System

Form = Literal["lagrangian", "hamiltonian", "parameters"]

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
        "Total energy T + V.",
        "Energy in J.",
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
        "Hamiltonian H(q, p), the total energy.",
        "Energy in J.",
    ),
    (
        "lagrangian_state", "hamiltonian", "state",
        "State (q, qdot) of the Lagrangian form that belongs to y = (q, p).",
        "Coordinates, then velocities from M qdot = p.",
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
    form : {"lagrangian", "hamiltonian", "parameters"}
        Which state it takes as ``y``; ``parameters`` means none.
    shape : tuple of int
        Shape of the result; ``()`` is a single number.
    lowering : Lowering
        The operations; its outputs are the result, flat in C order.
    """

    name: str
    summary: str
    returns: str
    form: Form
    shape: tuple[int, ...]
    lowering: Lowering

    @property
    def takes_time(self) -> bool:
        """Whether ``t`` comes first, as solvers ask of a right-hand side and its Jacobian."""
        return self.name.startswith(("rhs", "jacobian"))


def functions(derivation: Derivation) -> tuple[Function, ...]:
    """Every function of the module generated for `derivation`."""
    system = derivation.system
    parameters = {symbol.name for symbol in system.params}
    return tuple(
        Function(
            name,
            summary.format(equilibrium=f"({', '.join(map(str, system.equilibrium))})"),
            returns,
            form,
            _shape(shape, system),
            Lowering(getattr(Mechanics(derivation), name), parameters),
        )
        for name, form, shape, summary, returns in TABLE
    )


def state_names(system: System, form: Form) -> tuple[str, ...]:
    """Names of the components of ``y``, in order."""
    second = {"lagrangian": system.qdot, "hamiltonian": system.p}
    return tuple(s.name for s in system.q + second[form]) if form in second else ()


def _shape(words: str, system: System) -> tuple[int, ...]:
    lengths = {
        "q": len(system.q),
        "state": 2 * len(system.q),
        "masses": len(system.masses),
        "axes": system.dimension,
        "2": 2,
    }
    return tuple(lengths[word] for word in words.split())
