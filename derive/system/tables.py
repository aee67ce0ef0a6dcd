"""TOML files and their tables, read strictly: what is not known is refused."""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from solvers.io.suggestion import did_you_mean

#: Bytes of the largest file, and letters of the longest text.
LARGEST, LONGEST = 500_000, 20_000


class TableError(ValueError):
    """A file that does not say what it should; the message says where, and what is allowed."""


def read(path: Path) -> dict[str, Any]:
    """The table of a TOML file.

    Parameters
    ----------
    path : Path
        A file of at most `LARGEST` bytes.

    Returns
    -------
    dict of str
        Values by key, as `tomllib` reads them.

    Raises
    ------
    TableError
        When it cannot be read, is too large, or is no TOML.
    """
    try:
        if path.exists() and not path.is_file():
            raise TableError(f"{path} is no file")
        if path.stat().st_size > LARGEST:
            raise TableError(f"{path} has more than {LARGEST} bytes")
        return tomllib.loads(path.read_bytes().decode())
    except TableError:
        raise
    except OSError as error:
        raise TableError(f"{path} cannot be read: {error.strerror}") from error
    except (ValueError, RecursionError) as error:  # also a number of thousands of digits
        raise TableError(f"{path} is no TOML file: {error}; formulas stand in quotes") from error


class Table:
    """A table with a name, whose keys are among those that are `known`.

    Parameters
    ----------
    name : str
        What messages call it.
    values : object
        What was read; a mapping, if it is right.
    known : collection of str
        Keys that it may have.

    Raises
    ------
    TableError
        When it is no table, or has another key.
    """

    def __init__(self, name: str, values: object, known: Collection[str]) -> None:
        if not isinstance(values, Mapping):
            raise TableError(f"{name} = {_shown(values)} must be a table")
        self.name, self.values = name, values
        for key in values:
            if key not in known:
                raise TableError(
                    f"unknown key {key[:50]!r} in {name}{did_you_mean(key, known)}; "
                    f"known are {', '.join(known)}"
                )

    def text(self, key: str, default: str | None = None) -> str:
        """A text; refused if it is missing and there is no default."""
        value = self.values.get(key, default)
        if value is None:
            raise TableError(f"{key!r} is missing in {self.name}")
        printable = isinstance(value, str) and all(c.isprintable() or c in "\n\t" for c in value)
        if not printable or len(value) > LONGEST:
            raise TableError(
                f"{key} = {_shown(value)} in {self.name} must be a text in quotes, of up to "
                f"{LONGEST} printable characters"
            )
        return str(value)

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
            raise TableError(
                f"{key} = {_shown(value)} in {self.name} must be a list in square brackets"
            )
        return [Table(self.name, {key: item}, (key,)).formula(key) for item in value]

    def entries(self, key: str) -> dict[str, str]:
        """Names and formulas of a table in this one; none if it is missing."""
        values = self.values.get(key, {})
        row = Table(key, values, values if isinstance(values, Mapping) else ())
        return {name: row.formula(name) for name in row.values}

    def flag(self, key: str, *, default: bool) -> bool:
        """True or false."""
        value = self.values.get(key, default)
        if not isinstance(value, bool):
            raise TableError(f"{key} = {_shown(value)} in {self.name} must be true or false")
        return value

    def tables(self, key: str, known: Collection[str]) -> dict[str, Table]:
        """The tables of a table, by name."""
        inner = self.values.get(key, {})
        if not isinstance(inner, Mapping):
            raise TableError(f"{key} = {_shown(inner)} must be a table: write [{key}]")
        return {name: Table(f"{key}.{name}", values, known) for name, values in inner.items()}

    def listed(self, key: str, known: Collection[str]) -> list[Table]:
        """The tables of a list."""
        inner = self.values.get(key, [])
        if not isinstance(inner, list):
            raise TableError(f"{key} = {_shown(inner)} must be tables: write [[{key}]]")
        return [Table(f"{key} {k}", values, known) for k, values in enumerate(inner, 1)]


def _shown(value: object) -> str:
    try:
        return repr(value)[:50]
    except ValueError:  # Python writes no number of thousands of digits
        return "a number of thousands of digits"
