"""A derivation step by step, in words and formulas, for notebooks and pages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import sympy as sp

from derive.formulas.typesetting import Formula
from derive.mechanics.derivation import Derivation


@dataclass(frozen=True)
class Step:
    """A step of a derivation.

    Attributes
    ----------
    title, words : str
        The name of the result, and its origin.
    formulas : tuple of Formula
        The result.
    """

    title: str
    words: str
    formulas: tuple[Formula, ...]


def steps(derivation: Derivation) -> Iterator[Step]:
    """The steps of a derivation, from positions to Hamilton's equations.

    K and P denote kinetic and potential energy, as in the report on the double pendulum.

    Parameters
    ----------
    derivation : Derivation
        The derivation of any system.

    Yields
    ------
    Step
        One result, in words and formulas.

    Examples
    --------
    >>> from derive import Derivation, load
    >>> [step.title for step in steps(Derivation(load("single_pendulum")))][:3]
    ['Positions', 'Velocities', 'Energies']
    """
    system, d = derivation.system, derivation
    names = [f"r{k}" for k in range(1, len(system.masses) + 1)]
    positions = [sp.Matrix(mass.position) for mass in system.masses]
    velocities = [f"{name}_dot" for name in names]
    rates, forces = d.hamilton_equations
    pdot = [symbol.name.replace("p_", "pdot_", 1) for symbol in system.p]
    yield Step(
        "Positions",
        "The positions of the masses; with the forces, they define the system.",
        _each(names, positions),
    )
    yield Step(
        "Velocities",
        "Time derivatives of the positions, by the chain rule.",
        _each(velocities, d.velocities),
    )
    yield Step(
        "Energies",
        "Kinetic energy of the masses, and potential energy of gravity and springs.",
        _each("KP", (d.kinetic_energy, d.potential_energy)),
    )
    lagrangian = _each("L", (d.lagrangian,))
    yield Step("Lagrangian", "Kinetic minus potential energy.", lagrangian)
    yield Step(
        "Euler–Lagrange equations",
        "One for each coordinate.",
        tuple(Formula(f"{sp.sstr(left, order='lex')} = 0") for left in d.euler_lagrange),
    )
    yield Step(
        "Mass matrix",
        "The equations are linear in the accelerations.",
        (
            Formula(f"M*[{', '.join(f'[{name}]' for name in _names(system.qddot))}] = f"),
            *_each("Mf", (d.mass_matrix, d.forcing)),
        ),
    )
    yield Step(
        "Momenta",
        "Derivatives of the Lagrangian with respect to the velocities.",
        _each(_names(system.p), d.momenta),
    )
    yield Step(
        "Hamiltonian",
        "The energy as a function of coordinates and momenta.",
        _each("H", (d.hamiltonian,)),
    )
    yield Step(
        "Hamilton's equations",
        "Rates of coordinates and momenta, from the derivatives of the Hamiltonian.",
        _each((*_names(system.qdot), *pdot), (*rates, *forces)),
    )


def _names(symbols: Iterable[sp.Symbol]) -> tuple[str, ...]:
    return tuple(symbol.name for symbol in symbols)


def _each(names: Iterable[str], values: Iterable[sp.Expr | sp.MatrixBase]) -> tuple[Formula, ...]:
    pairs = zip(names, values, strict=True)
    return tuple(Formula.of(name, value) for name, value in pairs)
