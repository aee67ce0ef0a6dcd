"""A derivation step by step, in words and formulas, for notebooks and pages."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from html import escape

import sympy as sp

from derive.formulas.typeset.typesetting import Formula
from derive.mechanics.routhian import CyclicCoordinates

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

    def _repr_html_(self) -> str:
        """A section that can be folded."""
        formulas = "".join(formula.html for formula in self.formulas)
        head = f"<summary><b>{escape(self.title)}</b>: {escape(self.words)}</summary>"
        body = f'<div style="margin: 0.3em 1.5em; line-height: 1.8">{formulas}</div>'
        return f"<details open>{head}{body}</details>"


@dataclass(frozen=True)
class StepByStep(CyclicCoordinates):
    """A derivation that shows its steps."""

    @property
    def steps(self) -> tuple[Step, ...]:
        """The steps, from positions to Hamilton's equations and Routh's, which notebooks display.

        With constraints, G contains their derivatives by coordinates, or by velocities, and there
        are no Hamilton's equations. K and P denote kinetic and potential energy, as in the report
        on the double pendulum.

        Examples
        --------
        >>> from derive import Derivation, load
        >>> [step.title for step in Derivation(load("single_pendulum")).steps][:3]
        ['Positions', 'Velocities', 'Energies']
        """
        return tuple(self._steps())

    def _repr_html_(self) -> str:
        title = f"<h3>{escape(self.system.title)}</h3>"
        return title + "".join(step._repr_html_() for step in self.steps)

    def _steps(self) -> Iterator[Step]:
        system = self.system
        names = [f"r{k}" for k in range(1, len(system.masses) + 1)]
        positions = [sp.Matrix(mass.position) for mass in system.masses]
        residuals = [*map(_zero, self.euler_lagrange)]
        accelerations = _column(system.qddot)
        reactions = f" + G**T*{_column(system.multipliers)}" if system.conditions else ""
        formulas = {
            "Positions": _each(names, positions),
            "Constraints": [_zero(one.formula) for one in system.conditions],
            "Velocities": _each([f"{name}_dot" for name in names], self.velocities),
            "Energies": _each("KP", (self.kinetic_energy, self.potential_energy)),
            "Lagrangian": _each("L", (self.lagrangian,)),
            "Euler–Lagrange equations": residuals,
            "Mass matrix": [
                Formula(f"M*{accelerations} = f{reactions}"),
                *_each("Mf", (self.mass_matrix, self.forcing)),
            ],
            "Constraints of accelerations": [
                Formula(f"G*{accelerations} = gamma"),
                *_each(("G", "gamma"), (self.constraint_jacobian, self.constraint_forcing)),
            ],
            "Momenta": _each(_names(system.p), self.momenta),
        }
        if not system.conditions:
            rates, forces = self.hamilton_equations
            pdot = [symbol.name.replace("p_", "pdot_", 1) for symbol in system.p]
            formulas["Hamiltonian"] = _each("H", (self.hamiltonian,))
            both = _each((*_names(system.qdot), *pdot), (*rates, *forces))
            formulas["Hamilton's equations"] = both
        if 0 < len(self.cyclic_coordinates) < len(system.q):
            equations = [*map(_zero, self.routh_equations)]
            formulas["Routhian"] = [*_each("R", (self.routhian,)), *equations]
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
