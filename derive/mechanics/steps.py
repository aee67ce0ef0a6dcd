"""A derivation step by step, in words and formulas, for notebooks and pages."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import sympy as sp

from derive.formulas.typesetting import Formula
from derive.mechanics.derivation import Derivation

WORDS = {
    "Positions": "The positions of the masses; with the forces, they define the system.",
    "Constraints": "Functions that remain 0; multipliers are the strengths of their reactions.",
    "Velocities": "Time derivatives of the positions, by the chain rule.",
    "Energies": "Kinetic energy of the masses, and potential energy of gravity and springs.",
    "Lagrangian": "Kinetic minus potential energy.",
    "Euler–Lagrange equations": "One for each coordinate.",
    "Mass matrix": "The equations are linear in the accelerations.",
    "Constraints of accelerations": "Rates of the constraints, until accelerations occur.",
    "Momenta": "Derivatives of the Lagrangian with respect to the velocities.",
    "Hamiltonian": "The energy as a function of coordinates and momenta.",
    "Hamilton's equations": "Rates of coordinates and momenta, from the derivatives of the "
    "Hamiltonian.",
    "Routhian": "Momenta of cyclic coordinates are constant; L less the products with their "
    "velocities is a Lagrangian of the others.",
}


@dataclass(frozen=True)
class Step:
    """A step of a derivation: the name of a result, its origin, and the result."""

    title: str
    words: str
    formulas: tuple[Formula, ...]


def steps(derivation: Derivation) -> Iterator[Step]:
    """The steps of a derivation, from positions to Hamilton's equations and Routh's.

    With constraints, G contains their derivatives by coordinates, or by velocities, and there are
    no Hamilton's equations. K and P denote kinetic and potential energy, as in the report on the
    double pendulum.

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
    residuals = [*map(_zero, d.euler_lagrange)]
    accelerations = _column(system.qddot)
    reactions = f" + G**T*{_column(system.multipliers)}" if system.conditions else ""
    formulas = {
        "Positions": _each(names, positions),
        "Constraints": [_zero(one.formula) for one in system.conditions],
        "Velocities": _each([f"{name}_dot" for name in names], d.velocities),
        "Energies": _each("KP", (d.kinetic_energy, d.potential_energy)),
        "Lagrangian": _each("L", (d.lagrangian,)),
        "Euler–Lagrange equations": residuals,
        "Mass matrix": [
            Formula(f"M*{accelerations} = f{reactions}"),
            *_each("Mf", (d.mass_matrix, d.forcing)),
        ],
        "Constraints of accelerations": [
            Formula(f"G*{accelerations} = gamma"),
            *_each(("G", "gamma"), (d.constraint_jacobian, d.constraint_forcing)),
        ],
        "Momenta": _each(_names(system.p), d.momenta),
    }
    if not system.conditions:
        rates, forces = d.hamilton_equations
        pdot = [symbol.name.replace("p_", "pdot_", 1) for symbol in system.p]
        formulas["Hamiltonian"] = _each("H", (d.hamiltonian,))
        both = _each((*_names(system.qdot), *pdot), (*rates, *forces))
        formulas["Hamilton's equations"] = both
    if 0 < len(d.cyclic_coordinates) < len(system.q):
        equations = [*map(_zero, d.routh_equations)]
        formulas["Routhian"] = [*_each("R", (d.routhian,)), *equations]
    for title, results in formulas.items():
        if system.conditions or not title.startswith("Constraints"):
            yield Step(title, WORDS[title], tuple(results))


def _zero(expression: sp.Expr) -> Formula:
    return Formula(f"{sp.sstr(expression, order='lex')} = 0")


def _column(symbols: Iterable[sp.Symbol]) -> str:
    return f"[{', '.join(f'[{name}]' for name in _names(symbols))}]"


def _names(symbols: Iterable[sp.Symbol]) -> list[str]:
    return [symbol.name for symbol in symbols]


def _each(names: Iterable[str], values: Iterable[sp.Expr | sp.MatrixBase]) -> list[Formula]:
    return [Formula.of(name, value) for name, value in zip(names, values, strict=True)]
