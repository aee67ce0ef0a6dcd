"""What a TOML file says, read strictly: what makes no sense is refused with its name and value."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from solvers.io.quantity import QuantityError, quantity, shortened
from solvers.io.suggestion import did_you_mean

#: Bytes of the largest file, and characters of the longest text.
LARGEST, LONGEST = 100_000, 2000

Said = TypeVar("Said")


class InputError(ValueError):
    """A file that makes no sense; the message says which key, its value and what is allowed."""


def names(folder: Path) -> tuple[str, ...]:
    """Names of the files in a folder, in alphabetical order."""
    return tuple(sorted(path.stem for path in folder.glob("*.toml")))


def path(kind: str, name: str, folder: Path) -> Path:
    """The file that is meant by a name: one of a folder, or somebody's own, which ends in .toml.

    Parameters
    ----------
    kind : str
        What it is, in a message: ``scene`` or ``sweep``.
    name : str
        What somebody wrote.
    folder : Path
        The folder.

    Returns
    -------
    Path
        Somebody's own need not be there.

    Raises
    ------
    InputError
        When there is none.
    """
    known = names(folder)
    if name in known:
        return folder / f"{name}.toml"
    if name.endswith(".toml"):
        return Path(name)
    own = Path(f"{name}.toml")
    hint = f" (did you mean '{own}'?)" if own.is_file() else did_you_mean(name, known)
    raise InputError(
        f"{kind} {name[:80]!r} is not one of {', '.join(known)}{hint}; your own end in .toml"
    )


def read(path: Path, meaning: Callable[[Mapping[str, Any]], Said]) -> Said:
    """What a file means.

    Parameters
    ----------
    path : Path
        A TOML file.
    meaning : callable
        Takes its table; raises `ValueError` when that makes no sense.

    Returns
    -------
    object
        What `meaning` gives.

    Raises
    ------
    InputError
        When it is not there or makes no sense; the message begins with the path.
    OSError
        When the file cannot be read.
    """
    try:
        if path.stat().st_size > LARGEST:
            raise InputError(f"it has more than {LARGEST} bytes")
        return meaning(tomllib.loads(path.read_bytes().decode()))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise InputError(
            f"{path} is no TOML file: {error}; a number with a unit stands in quotes, and a "
            "decimal point is a point"
        ) from error
    except ValueError as error:
        raise InputError(f"{path}: {error}") from error
    except FileNotFoundError as error:
        raise InputError(f"{error.filename}: there is no such file") from error


def check_keys(
    where: str, given: Mapping[str, Any], known: Sequence[str], above: Sequence[str] = ()
) -> None:
    """Refuse unknown keys; those of `above` belong above the first table of the file."""
    for key in given:
        if key not in known:
            hint = (
                f": {key!r} belongs above the first [table]"
                if key in above
                else did_you_mean(key, known)
            )
            raise InputError(f"{where} has no key {key[:50]!r}{hint}; known are {', '.join(known)}")


def table(key: str, value: object) -> dict[str, Any]:
    """A table."""
    if not isinstance(value, dict):
        raise InputError(f"{key} = {shortened(value)} must be a table: write [{key}]")
    return value


def text(key: str, value: object) -> str:
    """A printable text."""
    if not isinstance(value, str):
        raise InputError(f"{key} = {shortened(value)} must be text in quotes")
    if len(value) > LONGEST or not all(c.isprintable() or c in "\n\t" for c in value):
        raise InputError(f"{key} = {shortened(value)} must be up to {LONGEST} printable characters")
    return value


def texts(key: str, value: object, most: int) -> tuple[str, ...]:
    """A list of texts."""
    if not isinstance(value, list):
        raise InputError(f"{key} = {shortened(value)} must be a list of texts in square brackets")
    if len(value) > most:
        raise InputError(f"{key} are {len(value)}: up to {most} are allowed")
    return tuple(text(key, item) for item in value)


def number(key: str, value: object, unit: str) -> float:
    """A number in `unit`, or a text that says one."""
    try:
        return quantity(value, unit)
    except QuantityError as error:
        raise InputError(f"{key}: {error}") from error


def positive(key: str, value: object, unit: str, way: str = "") -> float:
    """A positive number; `way` says what else can be meant by 0."""
    found = number(key, value, unit)
    if found <= 0:
        raise InputError(f"{key} = {value} must be positive, in {unit}{way}")
    return found


def whole(key: str, value: object, least: int, most: int) -> int:
    """A whole number."""
    if value is None:
        raise InputError(f"{key} is missing: give a whole number from {least} to {most}")
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise InputError(
            f"{key} = {shortened(value)} must be a whole number from {least} to {most}"
        )
    return value
