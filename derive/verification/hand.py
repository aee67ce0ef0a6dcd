"""Hand derivations in TOML: the equations of a source, its system and its notation."""

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unicodedata import normalize

import sympy as sp

from derive.formulas.expression import FUNCTIONS, ExpressionError, Scope, Value, parse
from derive.mechanics.derivation import Derivation
from derive.mechanics.specialisation import substituted
from derive.system.catalogue import load, published
from derive.system.parts import SystemDefinitionError
from derive.system.system import System
from derive.system.tables import Table, read
from derive.verification.model import Model, depends_on, own_names, time_derivative
from derive.verification.quantities import QUANTITIES, judge_formula
from derive.verification.verdict import Verdict
from solvers.io.toml_input import InputError

#: Quantities with one formula for each coordinate.
BY_COORDINATE = ("momenta", "accelerations", "hamilton")
#: Keys of a file that describe the equations, and keys of equations.
HEADER = ("system", "source", "note", "equal", "names")
EQUATIONS = (*QUANTITIES, "euler_lagrange")


@dataclass(frozen=True)
class HandDerivation:
    """The verdicts on the equations of a source, in the order of the file."""

    file: str  # its path, or the name of a system that ships
    system: str
    source: str
    note: str
    equations: tuple[Verdict, ...]


def judge(source: str | Path) -> HandDerivation:
    """Judge every equation of a file that ends in ``.toml``, or of a system that ships.

    Unreadable equations have a verdict, too. An `InputError` names an invalid file, or a system
    without published equations.
    """
    path, label = Path(source), str(source)
    try:
        if path.suffix == ".toml":
            return _judged(label, read(path), path.parent)
        if text := published(label):
            return _judged(label, tomllib.loads(text), Path())
    except (InputError, SystemDefinitionError) as error:
        message = str(error)
        raise InputError(message if label in message else f"{label}: {message}") from error
    raise InputError(f"the file of system {label!r} has no published equations")


def _judged(label: str, values: Mapping[str, Any], folder: Path) -> HandDerivation:
    table = Table(label, values, (*HEADER, *EQUATIONS))
    name = table.text("system")
    system = load(folder / name if name.endswith(".toml") else name)
    names = table.entries("names")
    model = Model(Derivation(_with_equal_parameters(table, system)), _meanings(names, system))
    verdicts = tuple(judge_formula(model, *row) for row in _formulas(table, system, names))
    if not verdicts:
        raise InputError(f"{label} has no equations: give at least one of {', '.join(EQUATIONS)}")
    return HandDerivation(label, name, table.text("source", ""), table.text("note", ""), verdicts)


def _with_equal_parameters(table: Table, system: System) -> System:
    """Substitute the parameters that the source sets equal to others, or to numbers."""
    symbols = {s.name: s for s in system.params}
    values = {}
    for name, text in table.entries("equal").items():
        if name not in symbols:
            raise InputError(f"equal.{name[:50]}: parameters are {', '.join(symbols)}")
        value = _value(f"equal.{name}", text, symbols | FUNCTIONS)
        if isinstance(value, sp.MatrixBase):
            raise InputError(f"equal.{name}: {text[:50]!r} is a column or matrix, not a number")
        values[symbols[name]] = value
    return substituted(system, values)


def _meanings(names: Mapping[str, str], system: System) -> dict[str, Any]:
    """Parse the source's names; functions of coordinates have derivatives, coordinates momenta."""
    own = own_names(system)
    momenta = dict(zip(system.q, system.p, strict=True))
    meanings: dict[str, Any] = {}
    for printed, text in names.items():
        # as the names in a formula, which Python's parser normalises
        name = normalize("NFKC", printed)
        if not name.isidentifier():
            raise InputError(f"names: {printed[:50]!r} is no name: use letters, digits and _")
        value = _value(f"names.{name}", text, own)
        meanings[name] = value
        if value in momenta:
            meanings[f"p_{name}"] = momenta[value]
        if depends_on(value, system.q):
            meanings[f"{name}_dot"] = velocity = time_derivative(system, value)
            meanings[f"{name}_ddot"] = time_derivative(system, velocity)
    return meanings


def _value(key: str, text: str, scope: Scope) -> Value:
    try:
        return parse(text, scope)
    except ExpressionError as error:
        raise InputError(f"{key}: {error}") from error


def _formulas(
    table: Table, system: System, names: Mapping[str, str]
) -> Iterator[tuple[str, str, str, str]]:
    """Label, text, kind and coordinate of each equation."""
    coordinates = {q.name: q.name for q in system.q}
    coordinates |= {name: text for name, text in names.items() if text in coordinates}
    momenta = {f"p_{name}": f"p_{q}" for name, q in coordinates.items()}
    for kind in table.values:
        if kind in BY_COORDINATE:
            keys = coordinates | momenta if kind == "hamilton" else coordinates
            row = Table(kind, table.values[kind], [*keys])
            for key in row.values:
                yield f"{kind}.{key}", row.formula(key), kind, keys[key]
        elif kind == "euler_lagrange":
            for number, text in enumerate(table.formulas(kind), 1):
                yield f"{kind} {number}", text, kind, ""
        elif kind in QUANTITIES:
            yield kind, table.formula(kind), kind, ""
