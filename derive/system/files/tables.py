"""Tables of TOML files, read strictly: unknown keys are refused."""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

from solvers.io import toml_input
from solvers.io.suggestion import did_you_mean, shortened
from solvers.io.toml_input import InputError

#: Characters of the longest text.
MAX_TEXT = 20_000


def read(path: Path) -> dict[str, Any]:
    """The table of a TOML file; an `InputError` says why it cannot be read."""
    try:
        return toml_input.read_table(path, "formulas stand in quotes")
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from error


class TomlTable:
    """A table with a name for messages, whose keys are among those that are `known`."""

    def __init__(self, name: str, values: object, known: Collection[str]) -> None:
        if not isinstance(values, Mapping):
            raise InputError(f"{name} = {shortened(values)} must be a table")
        self.name, self.values = name, values
        for key in values:
            if key not in known:
                raise InputError(
                    f"unknown key {key[:50]!r} in {name}{did_you_mean(key, known)}; "
                    f"known are {', '.join(known)}"
                )

    def text(self, key: str, default: str | None = None) -> str:
        """A text; refused if it is missing and there is no default."""
        value = self.values.get(key, default)
        if value is None:
            raise InputError(f"{key!r} is missing in {self.name}")
        return toml_input.text(key, value, f" in {self.name}", MAX_TEXT)

    def formula(self, key: str, default: str | None = None) -> str:
        """A formula as text; numbers may stand without quotes."""
        value = self.values.get(key, default)
        if isinstance(value, int | float) and not isinstance(value, bool):
            return repr(value)
        return " ".join(self.text(key, default).split())

    def formulas(self, key: str) -> list[str]:
        """A list of formulas; empty if it is missing."""
        value = self.values.get(key, [])
        if not isinstance(value, list):
            raise InputError(
                f"{key} = {shortened(value)} in {self.name} must be a list in square brackets"
            )
        return [TomlTable(self.name, {key: item}, (key,)).formula(key) for item in value]

    def entries(self, key: str) -> dict[str, str]:
        """Names and formulas of a table in this one; none if it is missing."""
        values = self.values.get(key, {})
        row = TomlTable(key, values, values if isinstance(values, Mapping) else ())
        return {name: row.formula(name) for name in row.values}

    def flag(self, key: str, *, default: bool) -> bool:
        """True or false."""
        value = self.values.get(key, default)
        if not isinstance(value, bool):
            raise InputError(f"{key} = {shortened(value)} in {self.name} must be true or false")
        return value

    def tables(self, key: str, known: Collection[str]) -> "dict[str, TomlTable]":
        """The tables of a table, by name."""
        inner = self.values.get(key, {})
        if not isinstance(inner, Mapping):
            raise InputError(f"{key} = {shortened(inner)} must be a table: write [{key}]")
        return {name: TomlTable(f"{key}.{name}", values, known) for name, values in inner.items()}

    def listed(self, key: str, known: Collection[str], short: str = "") -> "list[TomlTable]":
        """The tables of a list, in which a text or number may be short for one key's value."""
        inner = self.values.get(key, [])
        if not isinstance(inner, list):
            form = "a list in square brackets" if short else f"tables: write [[{key}]]"
            raise InputError(f"{key} = {shortened(inner)} must be {form}")
        if short:
            inner = [one if isinstance(one, Mapping) else {short: one} for one in inner]
        return [TomlTable(f"{key} {k}", values, known) for k, values in enumerate(inner, 1)]

    def rows(self, key: str, columns: Sequence[str]) -> "list[TomlTable]":
        """The lists of a list as tables, with these names of their entries."""
        inner = self.values.get(key, [])
        form = f"[{', '.join(columns)}]"
        if not isinstance(inner, list):
            raise InputError(f"{key} = {shortened(inner)} must be a list of lists {form}")
        tables = []
        for k, entries in enumerate(inner, 1):
            if not isinstance(entries, list) or len(entries) != len(columns):
                raise InputError(f"{key} {k} = {shortened(entries)} must be a list {form}")
            values = dict(zip(columns, entries, strict=True))
            tables.append(TomlTable(f"{key} {k}", values, columns))
        return tables
