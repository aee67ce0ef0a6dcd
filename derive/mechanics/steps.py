"""A derivation step by step, in words and formulas: what notebooks and pages show."""

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
        What it gives, and where that comes from.
    formulas : tuple of Formula
        The result.
    """

    title: str
    words: str
    formulas: tuple[Formula, ...]


def steps(derivation: Derivation) -> Iterator[Step]:
    """From positions to equations of motion, one step after the other.

    Letters are those of the report: K and P are kinetic and potential energy.

    Parameters
    ----------
    derivation : Derivation
        Of any system.

    Yields
    ------
    Step
        From the positions to Hamilton's equations.

    Examples
    --------
    >>> from derive import Derivation, load
    >>> [step.title for step in steps(Derivation(load("single_pendulum")))][:3]
    ['Positions', 'Velocities', 'Energies']
    """
    system, d = derivation.system, derivation
    places = [f"r{k}" for k in range(1, len(system.masses) + 1)]
    positions = [sp.Matrix(mass.position) for mass in system.masses]
    velocities = [f"{place}_dot" for place in places]
    rates, pushes = d.hamilton_equations
    pdot = [symbol.name.replace("p_", "pdot_", 1) for symbol in system.p]
    yield Step(
        "Positions",
        "Where the masses are: all that is said of the system, beside its forces.",
        _each(places, positions),
    )
    yield Step(
        "Velocities", "Their derivatives, by the chain rule.", _each(velocities, d.velocities)
    )
    yield Step(
        "Energies",
        "Half of mass times speed squared; and what gravity and springs store.",
        _each("KP", (d.kinetic_energy, d.potential_energy)),
    )
    yield Step(
        "Lagrangian", "Kinetic minus potential energy.", _each("L", (d.lagrangian,))
    )  # fmt: skip
    yield Step(
        "Euler–Lagrange equations",
        "One for each coordinate: what the motion makes zero.",
        tuple(Formula(f"{sp.sstr(left, order='lex')} = 0") for left in d.euler_lagrange),
    )
    yield Step(
        "Mass matrix",
        "The equations are linear in the accelerations, and are solved for them.",
        (
            Formula(f"M*[{', '.join(f'[{name}]' for name in _names(system.qddot))}] = f"),
            *_each("Mf", (d.mass_matrix, d.forcing)),
        ),
    )
    yield Step(
        "Momenta",
        "The Lagrangian's derivatives by the velocities.",
        _each(_names(system.p), d.momenta),
    )
    yield Step(
        "Hamiltonian",
        "The energy, by coordinates and momenta instead of velocities.",
        _each("H", (d.hamiltonian,)),
    )
    yield Step(
        "Hamilton's equations",
        "Its derivatives are the rates of coordinates and momenta.",
        _each((*_names(system.qdot), *pdot), (*rates, *pushes)),
    )


def _names(symbols: Iterable[sp.Symbol]) -> tuple[str, ...]:
    return tuple(symbol.name for symbol in symbols)


def _each(names: Iterable[str], values: Iterable[sp.Expr | sp.MatrixBase]) -> tuple[Formula, ...]:
    pairs = zip(names, values, strict=True)
    return tuple(Formula.of(name, value) for name, value in pairs)
