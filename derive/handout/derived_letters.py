"""Letters of derived quantities, and the order of a system's symbols in formulas."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain, count

import sympy as sp

from derive.formulas.typeset.lettering import lettering
from derive.formulas.typeset.textbook_order import Kind, TextbookOrder
from derive.system.symbols import TIME
from derive.system.system import System

KIND_OF_UNIT: dict[str, Kind] = {"kg": "mass", "m/s^2": "gravity"}
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class DerivedLetters:
    """Names for the quantities of a derivation that no symbol of the system has."""

    system: System

    def letter(self, name: str) -> str:
        """`name`, or with the index ``sys`` if a symbol of the system has this name."""
        taken = {symbol.name for symbol in self._symbols}
        names = chain((name, f"{name}_sys"), (f"{name}_sys{k}" for k in count(2)))
        return next(one for one in names if one not in taken)

    @property
    def routhian(self) -> str:
        """The letter of the Routhian, which is not that of Rayleigh's function."""
        return self.letter("R" if self.system.dissipation == 0 else "R_cyc")

    @cached_property
    def positions(self) -> list[str]:
        """The letters of the positions: r for a single one, or with the indices of the masses."""
        masses = [mass.mass for mass in self.system.masses]
        read = [lettering(mass.name) for mass in masses if mass.is_Symbol]
        indices = ["".join(one.indices) for one in read]
        if len(masses) == 1:
            return ["r"]
        if not all(map(str.isdigit, indices)) or len({*indices}) < len(masses):
            indices = [str(k) for k in range(1, len(masses) + 1)]
        return [f"r{index}" for index in indices]

    def force(self, i: int) -> str:
        """The generalized force without a potential of a coordinate: "" if there is none."""
        system = self.system
        return f"{self.letter('Q')}_{system.q[i].name}" if system.applied[i] != 0 else ""

    @property
    def constraints(self) -> list[str]:
        """The names of the constraints."""
        letter, n = self.letter("phi"), len(self.system.conditions)
        return [f"{letter}_{k}" for k in range(1, n + 1)]

    def reaction(self, i: int) -> str:
        """The reactions on a coordinate, with their sign: "" if there are none."""
        system, terms = self.system, ""
        q, qdot = system.q[i], system.qdot[i]
        for name, one in zip(self.constraints, system.conditions, strict=True):
            is_rate = one.formula.free_symbols & {*system.qdot}
            variable = qdot if is_rate else q
            if one.formula.has(variable):
                terms += f" - {one.symbol}*d({name}, {variable})"
        return terms

    @cached_property
    def order(self) -> TextbookOrder:
        """The order of factors and terms: masses, gravity, other parameters, coordinates."""
        system = self.system
        omega = sp.Symbol(self.letter("omega"), positive=True)  # of normal modes
        kinds: dict[sp.Symbol, Kind] = {
            **{
                p.symbol: KIND_OF_UNIT.get(p.unit, "parameter")
                for p in system.parameters_and_inputs
            },
            **dict.fromkeys((*system.q, TIME), "coordinate"),
            **dict.fromkeys((*system.qdot, *system.p, omega), "rate"),
            **dict.fromkeys((*system.multipliers, *system.qddot), "acceleration"),
        }
        return TextbookOrder(kinds)

    @property
    def _symbols(self) -> tuple[sp.Symbol, ...]:
        system = self.system
        moving = (*system.q, *system.qdot, *system.qddot, *system.p)
        return (*system.params, *moving, *system.multipliers)


def names_of(symbols: Sequence[sp.Symbol]) -> str:
    """A column of symbols, or a single one, as a formula."""
    names = ", ".join(symbol.name for symbol in symbols)
    return f"({names})" if len(symbols) > 1 else names


def words(text: str) -> str:
    """A text of the system, inside which nothing is a formula."""
    return text.replace("`", "'")


def unit_words(unit: str) -> str:
    """A unit with raised exponents: m/s² of m/s^2; that of a plain number is empty."""
    raised = re.sub(r"\^(-?\d+)", lambda power: power[1].translate(SUPERSCRIPTS), unit)
    return "" if unit == "1" else words(raised)
