"""The description of a system in the docstring of its generated module."""

from collections.abc import Iterable
from functools import lru_cache
from itertools import accumulate
from textwrap import indent

import sympy as sp

from derive.codegen.function_specs import Form
from derive.codegen.module_functions import Contents
from derive.mechanics.derivation import Derivation
from derive.system.system import System

#: Unit of the momentum conjugate to a coordinate of this unit.
MOMENTUM_UNIT = {"rad": "J s", "m": "kg m/s"}

#: Equations of systems with more coordinates, or of Lagrangians with more operations, are too long
#: to read.
READABLE, READABLE_OPERATIONS = 4, 150

STATES: dict[Form, str] = {
    "lagrangian": "State y = (q, qdot)",
    "hamiltonian": "State y = (q, p), in functions of the Hamiltonian form",
    "rational": "State y in functions of the rational form",
    "variational": "State y of `rhs_variational`",
    "sensitivity": "State y of `rhs_sensitivity`",
}
#: Of the last two, where their states have the same components.
PERTURBED = "State y of `rhs_variational` and `rhs_sensitivity`"
#: Forms of which a state and a linear perturbation are those of the last two.
UNPERTURBED: dict[Form, str] = {"rational": "the rational one", "lagrangian": "(q, qdot)"}


def units(system: System) -> dict[str, str]:
    """Units of all names."""
    rows = {part.symbol.name: part.unit for part in system.parameters_and_inputs}
    rows |= {f"delta_{name}": unit for name, unit in rows.items()}
    symbols = zip(system.coordinates, system.qdot, system.qddot, system.p, strict=True)
    for coordinate, qdot, qddot, p in symbols:
        rows[coordinate.symbol.name] = coordinate.unit
        rows[qdot.name] = f"{coordinate.unit}/s"
        rows[qddot.name] = f"{coordinate.unit}/s^2"
        rows[p.name] = MOMENTUM_UNIT.get(coordinate.unit, f"J s/({coordinate.unit})")
        for changed in (coordinate.symbol.name, qdot.name):
            rows[f"delta_{changed}"] = rows[changed]
        rows[f"sin_{coordinate.symbol.name}"] = rows[f"cos_{coordinate.symbol.name}"] = "1"
    return rows | {one.name: one.unit for one in system.all_conditions}


def summary(contents: Contents, forms: Iterable[Form]) -> str:
    """Coordinates, states of these forms, parameters, Lagrangian and equations of motion."""
    coordinates = [
        f"{c.symbol} [{c.unit}]{' > 0' if c.symbol.is_positive else ''}: {c.meaning}"
        for c in contents.system.coordinates
    ]
    parts = _section("Coordinates q", coordinates), states(contents, forms)
    return "\n\n".join([*parts, _equations(contents.derivation)])


def states(contents: Contents, forms: Iterable[Form]) -> str:
    """The components of the state in these forms, with units."""
    unit, rows = units(contents.system), {form: contents.states[form] for form in forms}
    titles = {form: STATES[form] for form in rows}
    if {"variational", "sensitivity"} <= {*rows} and rows["variational"] == rows["sensitivity"]:
        del rows["sensitivity"]
        titles["variational"] = PERTURBED
    for form in rows.keys() - UNPERTURBED.keys():
        for first, words in UNPERTURBED.items():
            names = contents.states.get(first, ())
            if names and rows[form][: len(names)] == names:
                rows[form] = rows[form][len(names) :]
                titles[form] += f": {words}, and a linear perturbation"
    sections = ((titles[form], [f"{x} [{unit[x]}]" for x in names]) for form, names in rows.items())
    return "\n\n".join(_section(title, lines) for title, lines in sections)


@lru_cache(maxsize=1)  # for the files of all languages, and of parts of a module
def _equations(derivation: Derivation) -> str:
    system, sections = derivation.system, dict[str, list[str]]()
    sections["Parameters params"] = [
        f"{p.symbol} [{p.unit}] {'> 0' if p.symbol.is_positive else 'real'}, "
        f"default {p.default}: {p.meaning}"
        for p in system.parameters
    ]
    if system.inputs:
        sections["Inputs, the last of params"] = [
            f"{u.symbol} [{u.unit}]: {u.meaning}" for u in system.inputs
        ]
    sections["Masses and their positions"] = [mass.words for mass in system.masses]
    if system.conditions:
        sections["Constraints, with their multipliers"] = [
            f"{one.formula} = 0: {one.name} [{one.unit}], {one.meaning}"
            for one in system.conditions
        ]
    if derivation.redundant:
        sections["Redundant constraints, which follow from the others with default parameters"] = [
            f"{one.formula} = 0: {one.name}, left out" for one in derivation.redundant
        ]
    if system.all_conditions:
        sections["Degrees of freedom"] = [mobility(derivation)]
    if system.eliminated:
        sections["Eliminated coordinates, which are outputs"] = [
            f"{one.coordinate.symbol} [{one.coordinate.unit}]: {one.formula}, "
            f"{one.coordinate.meaning}"
            for one in system.eliminated
        ]
        sections["Multipliers of eliminated constraints"] = [
            f"{one.constraint.name} [{one.constraint.unit}]: {one.constraint.meaning}"
            for one in system.eliminated
        ]
    is_short = len(system.q) <= READABLE
    if is_short and derivation.lagrangian.count_ops() <= READABLE_OPERATIONS:
        sections["Lagrangian"] = [f"L = {_text(derivation.lagrangian)}"]
        residuals = map(_text, derivation.euler_lagrange)
        sections["Equations of motion"] = [f"{residual} = 0" for residual in residuals]
    return "\n\n".join(_section(title, lines) for title, lines in sections.items())


def mobility(derivation: Derivation) -> str:
    """Numbers of coordinates, constraints and degrees of freedom, and eliminated coordinates."""
    system, eliminated = derivation.system, derivation.system.eliminated
    counts = [
        _count(len(system.q) + len(eliminated), "coordinate"),
        _count(len(system.all_conditions), "constraint"),
        _count(derivation.degrees_of_freedom, "degree", " of freedom"),
    ]
    if not eliminated:
        return ", ".join(counts)
    gone, kept = _names(one.coordinate.symbol for one in eliminated), _names(system.q)
    return f"{', '.join(counts)}: {gone} follow{'s' * (len(eliminated) == 1)} from {kept}"


def _count(number: int, noun: str, rest: str = "") -> str:
    return f"{number} {noun}{'s' * (number != 1)}{rest}"


def _names(symbols: Iterable[sp.Symbol]) -> str:
    *first, last = (symbol.name for symbol in symbols)
    return f"{', '.join(first)} and {last}" if first else last


def broken_sum(text: str, width: int) -> str:
    """A long expression on several lines, broken before signs and after commas.

    It is broken outside of brackets where lines become short enough, else inside of some, too.
    """
    depths = accumulate((letter == "(") - (letter == ")") for letter in text)
    for depth in range(max(depths, default=0) + 1):
        lines = _broken_outside(text, width, depth)
        if max(map(len, lines)) <= width:
            break
    return "\n".join(lines)


def _broken_outside(text: str, width: int, most: int) -> list[str]:
    """Lines of an expression, broken in at `most` so many brackets."""
    lines, depth, start = [""], 0, 0
    for i, letter in enumerate(text):
        depth += (letter == "(") - (letter == ")")
        last = i + 1 == len(text)
        is_between = letter == " " and (last or text[i + 1] in "+-" or text[i - 1] == ",")
        if last or (depth <= most and is_between):
            piece = text[start:] if last else text[start:i]
            if lines[-1] and len(lines[-1]) + len(piece) > width:
                lines.append(piece.lstrip())
            else:
                lines[-1] += piece
            start = i
    return lines


def _text(expression: sp.Expr) -> str:
    return sp.sstr(expression, order="lex")


def _section(title: str, lines: Iterable[str]) -> str:
    broken = (indent(broken_sum(line, 84), " " * 8)[4:] for line in lines)
    return "\n".join([f"{title}:", *broken])
