"""A hand derivation as a TOML file: whose equations, of which system, in which letters."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from derive.formulas.expression import FUNCTIONS, parse
from derive.mechanics.derivation import Derivation
from derive.mechanics.specialisation import substituted
from derive.system.catalogue import load, published
from derive.system.system import System
from derive.system.tables import Table, read
from derive.verification.hand.judgement import VALUES, Judgement, judged
from derive.verification.hand.meaning import Meaning
from solvers.io.toml_input import InputError

#: Of these formulas each coordinate has one; of the others the system has.
EACH = ("momenta", "accelerations", "hamilton")
#: What there is to say of equations, and the equations.
ABOUT, EQUATIONS = ("system", "source", "note", "equal", "names"), (*VALUES, "euler_lagrange")


@dataclass(frozen=True)
class HandDerivation:
    """Equations as somebody wrote them down, and what was found about each.

    Attributes
    ----------
    system : str
        Of which system.
    source, note : str
        Where they stand, and what there is to say about them.
    judgements : tuple of Judgement
        In the order of the file.
    """

    system: str
    source: str
    note: str
    judgements: tuple[Judgement, ...]


def judge(source: str | Path) -> HandDerivation:
    """Judge every equation in a file, or every published equation of a system.

    Parameters
    ----------
    source : str or path
        The path of a TOML file, which ends in ``.toml``, or the name of a system that ships.

    Returns
    -------
    HandDerivation
        With a judgement on each equation, those that cannot be read among them.

    Raises
    ------
    InputError
        When it is no such file, or names what a system has not.
    ExpressionError
        When a parameter is set to what is no formula.
    UnknownSystemError
        When no system has this name.
    SystemDefinitionError
        When the file of the system is wrong.
    """
    path = Path(source)
    table = Table(str(path), _tables(str(source)), (*ABOUT, *EQUATIONS))
    name = table.text("system")
    system = load(path.parent / name if name.endswith(".toml") else name)
    meaning = Meaning(Derivation(_equalled(table, system)), table.entries("names"))
    found = [
        judged(place, text, meaning, kind, key)
        for place, kind, key, text in _equations(table, system)
    ]
    if not found:
        raise InputError(f"{path} has no equations: give some of {', '.join(EQUATIONS)}")
    return HandDerivation(name, table.text("source", ""), table.text("note", ""), tuple(found))


def _tables(source: str) -> dict[str, Any]:
    if source.endswith(".toml"):
        return read(Path(source))
    text = published(source)
    if not text:
        raise InputError(f"the file of system {source!r} has no published equations")
    return tomllib.loads(text)


def _equalled(table: Table, system: System) -> System:
    """The system with parameters set to what the equations take them for."""
    symbols = {s.name: s for s in system.params}
    values = {}
    for name, text in table.entries("equal").items():
        if name not in symbols:
            raise InputError(f"equal.{name[:50]}: parameters are {', '.join(symbols)}")
        values[symbols[name]] = parse(text, symbols | FUNCTIONS)
    return substituted(system, values)


def _equations(table: Table, system: System) -> Iterator[tuple[str, str, str, str]]:
    """Place, kind, key and text of every equation."""
    coordinates = [q.name for q in system.q]
    for kind in table.values:
        if kind in EACH:
            own = {q: q for q in coordinates}
            own |= {name: text for name, text in table.entries("names").items() if text in own}
            if kind == "hamilton":
                own |= {f"p_{name}": f"p_{q}" for name, q in own.items()}
            row = Table(kind, table.values[kind], [*own])
            for key in row.values:
                yield f"{kind}.{key}", kind, own[key], row.formula(key)
        elif kind == "euler_lagrange":
            for k, text in enumerate(table.formulas(kind), 1):
                yield f"{kind} {k}", kind, "", text
        elif kind in VALUES:
            yield kind, kind, "", table.formula(kind)
