"""Hand derivations in TOML: the equations of a source, its system and its notation."""

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from derive.formulas.expression import FUNCTIONS, number, parse
from derive.mechanics.derivation import Derivation
from derive.mechanics.specialisation import substituted
from derive.system.files.part_tables import TomlTable, read
from derive.system.files.system_catalogue import load, published
from derive.system.parts import SystemDefinitionError
from derive.system.system import System
from derive.verification.judging.derived import QUANTITIES
from derive.verification.judging.motion_verdicts import judge_set
from derive.verification.judging.reference_system import ReferenceSystem
from derive.verification.judging.system_names import (
    meanings,
    names_of_coordinates,
    normalised,
    parsed,
    with_multipliers,
)
from derive.verification.judging.verdict import Verdict
from derive.verification.quantity_verdicts import judge_formula
from solvers.io.toml_input import InputError

#: Quantities with one formula for each coordinate.
BY_COORDINATE = ("momenta", "accelerations", "hamilton")
#: Keys of a file that describe the equations, and keys of equations.
HEADER = ("system", "source", "note", "equal", "names")
EQUATIONS = (*(kind for kind in QUANTITIES if kind != "value"), "euler_lagrange")


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
    table = TomlTable(label, values, (*HEADER, *EQUATIONS))
    name = table.text("system")
    system = load(folder / name if name.endswith(".toml") else name)
    names = table.entries("names")
    model = ReferenceSystem(
        Derivation(_with_equal_parameters(table, system)), meanings(names, system)
    )
    texts = table.formulas("euler_lagrange") if "euler_lagrange" in table.values else []
    model = with_multipliers(model, texts)
    verdicts = tuple(_verdicts(table, model))
    if not verdicts:
        raise InputError(f"{label} has no equations: give at least one of {', '.join(EQUATIONS)}")
    return HandDerivation(label, name, table.text("source", ""), table.text("note", ""), verdicts)


def _with_equal_parameters(table: TomlTable, system: System) -> System:
    """Substitute the parameters that the source sets equal to others, or to numbers."""
    symbols = {s.name: s for s in system.params}
    values = {}
    for name, text in table.entries("equal").items():
        if name not in symbols:
            raise InputError(f"equal.{name[:50]}: parameters are {', '.join(symbols)}")
        values[symbols[name]] = parsed(f"equal.{name}", text, symbols | FUNCTIONS, number)
    return substituted(system, values)


def _verdicts(table: TomlTable, model: ReferenceSystem) -> list[Verdict]:
    """Judge all equations; the Lagrangian first, because others can follow from an equivalent."""
    judged: dict[str, list[Verdict]] = {}
    source = None
    for kind in sorted(table.values, key=lambda kind: kind != "lagrangian"):
        rows = [*_formulas(table, kind, model)]
        judged[kind] = [
            judge_formula(
                model, *row, source=source, others=[one[1] for one in rows if one is not row]
            )
            for row in rows
        ]
        if kind == "lagrangian" and judged[kind][0].verdict == "equivalent":
            text = table.formula(kind)
            source = model.with_lagrangian(parse(text, model.context.namespace))
        if kind == "euler_lagrange":
            judged[kind] = judge_set(model, judged[kind])
    return [verdict for kind in table.values for verdict in judged[kind]]


def _formulas(
    table: TomlTable, kind: str, model: ReferenceSystem
) -> Iterator[tuple[str, str, str, str]]:
    """Label, text, kind and coordinate of each equation of a kind."""
    values = table.values[kind]
    if kind in EQUATIONS and values in ([], {}):
        raise InputError(f"{kind} is empty: give at least one equation, or omit it")
    if kind == "euler_lagrange":
        for number, text in enumerate(table.formulas(kind), 1):
            yield f"{kind} {number}", text, kind, ""
    elif kind in BY_COORDINATE:
        if isinstance(values, Mapping):
            values = {normalised(key): value for key, value in values.items()}
        row = TomlTable(kind, values, names_of_coordinates(kind, model))
        for key in row.values:
            yield f"{kind}.{key}", row.formula(key), kind, key
    elif kind in QUANTITIES:
        yield kind, table.formula(kind), kind, ""
