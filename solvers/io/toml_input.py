"""TOML files, read strictly: a wrong entry is refused with its name, its value and the choices."""

import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from stat import S_ISREG
from typing import Any, TypeVar

from solvers.io.quantity import QuantityError, quantity
from solvers.io.suggestion import did_you_mean, shortened

#: Bytes of the largest input file, and characters of the longest text.
MAX_BYTES, MAX_TEXT = 500_000, 2000
#: Dots of the longest key, whose reading time grows with the square of their number.
MAX_DOTS = 100
LONG_KEY = re.compile(
    rf"""(?<![\w-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')\s*+\.\s*+){{{MAX_DOTS + 1}}}"""
)
#: How messages about TOML end for files of quantities.
QUANTITY_HINT = "quote numbers with units, and use a point as decimal separator"

T = TypeVar("T")


class InputError(ValueError):
    """An invalid input file; the message names the key, its value and the choices."""


def names(folder: Path) -> tuple[str, ...]:
    """Names of the TOML files in a folder, in alphabetical order."""
    return tuple(sorted(path.stem for path in folder.glob("*.toml")))


def path(kind: str, name: str, folder: Path) -> Path:
    """The path of a shipped file by its name in `folder`, or of any file that ends in .toml."""
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


def read_table(path: Path, hint: str) -> dict[str, Any]:
    """The table of a TOML file; `hint` ends the message about a file that is not TOML."""
    content = read_bytes(path, MAX_BYTES)
    try:
        text = content.decode("utf-8-sig")  # without a byte-order mark, which editors may write
        if LONG_KEY.search(text):
            raise ValueError(f"a key has more than {MAX_DOTS} dots")
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # also a number of thousands of digits
        raise InputError(f"{path} is not valid TOML: {error}; {hint}") from error


def read_bytes(path: Path, most: int) -> bytes:
    """The content of a regular file of up to `most` bytes."""
    if not S_ISREG(path.stat().st_mode):  # a pipe or device may never end
        raise InputError(f"{path} is no file")
    with open(path, "rb") as file:
        content = file.read(most + 1)
    if len(content) > most:
        raise InputError(f"{path} has more than {most} bytes")
    return content


def read(path: Path, interpret: Callable[[Mapping[str, Any]], T]) -> T:
    """Read a file and `interpret` its table; errors of both name the file."""
    try:
        table = read_table(path, QUANTITY_HINT)
        try:
            return interpret(table)
        except ValueError as error:
            raise InputError(f"{path}: {error}") from error
    except FileNotFoundError as error:
        raise InputError(f"{error.filename}: there is no such file") from error


def check_keys(
    where: str, given: Mapping[str, Any], known: Sequence[str], above: Sequence[str] = ()
) -> None:
    """Refuse unknown keys; those in `above` belong above the first table of the file."""
    for key in given:
        if key not in known:
            place = f": {key!r} belongs above the first [table]"
            hint = place if key in above else did_you_mean(key, known)
            raise InputError(f"{where} has no key {key[:50]!r}{hint}; known are {', '.join(known)}")


def table(key: str, value: object) -> dict[str, Any]:
    """A table."""
    if not isinstance(value, dict):
        raise InputError(f"{key} = {shortened(value)} must be a table: write [{key}]")
    return value


def text(key: str, value: object, where: str = "", most: int = MAX_TEXT) -> str:
    """A printable text of up to `most` characters."""
    is_text = isinstance(value, str) and all(c.isprintable() or c in "\n\t" for c in value)
    if not is_text or len(str(value)) > most:
        raise InputError(
            f"{key} = {shortened(value)}{where} must be a text in quotes, of up to {most} "
            "printable characters"
        )
    return str(value)


def texts(key: str, value: object, most: int) -> tuple[str, ...]:
    """A list of texts."""
    if not isinstance(value, list):
        raise InputError(f"{key} = {shortened(value)} must be a list of texts in square brackets")
    if len(value) > most:
        raise InputError(f"{key} are {len(value)}: up to {most} are allowed")
    return tuple(text(key, item) for item in value)


def number(key: str, value: object, unit: str) -> float:
    """A number in `unit`, or a text such as ``90 deg``."""
    try:
        return quantity(value, unit)
    except QuantityError as error:
        raise InputError(f"{key}: {error}") from error


def positive(key: str, value: object, unit: str, hint: str = "") -> float:
    """A positive number; the message of refusal ends with `hint`."""
    result = number(key, value, unit)
    if result <= 0:
        raise InputError(f"{key} = {value} must be positive, in {unit}{hint}")
    return result


def whole(key: str, value: object, least: int, most: int) -> int:
    """A whole number."""
    if value is None:
        raise InputError(f"{key} is missing: give a whole number from {least} to {most}")
    if type(value) is int and least <= value <= most:
        return value
    raise InputError(f"{key} = {shortened(value)} must be a whole number from {least} to {most}")
