"""The systems that ship with holonomic, found by their files' names, and descriptions of them.

A file whose name ends in ``_n`` holds a family: its ``system`` is a function of n, and
``chain_5`` is its member with n = 5. A file may also define ``PUBLISHED``: published equations of
the system, as TOML text in the format of ``holonomic verify``. The modules of the systems in the
folder ``large`` are too long to ship: they are derived when they are first used.
"""

import re
import tomllib
from importlib import import_module
from itertools import groupby
from os import PathLike, fspath
from textwrap import TextWrapper
from types import ModuleType

from derive.system.files.shipped import USUAL, large_names, names, stems
from derive.system.files.system_file import read_system
from derive.system.parts import SystemDefinitionError
from derive.system.system import System
from solvers.io.suggestion import did_you_mean

#: The largest member of a family that is derived.
LARGEST = 100


class UnknownSystemError(ValueError):
    """No system has this name; the message lists the names that exist."""


def load(name: str | PathLike[str]) -> System:
    """The system of this name, or in this TOML file.

    Parameters
    ----------
    name : str or path
        Name of a system, such as ``double_pendulum``; a member of a family, such as ``chain_5``,
        up to `LARGEST`; or the path of a system file that ends in ``.toml``.

    Returns
    -------
    System

    Raises
    ------
    UnknownSystemError
        When no system has this name.
    SystemDefinitionError
        When the file does not define a system, or defines one of another name.

    Examples
    --------
    >>> from derive import load
    >>> load("double_pendulum").title
    'Double pendulum: two point masses on rigid massless rods in a vertical plane'
    >>> len(load("chain_7").coordinates)
    7
    """
    name = fspath(name)
    if name.endswith(".toml"):
        return read_system(name)
    stem, n = _file(name)
    try:
        system = _module(stem).system
        if n:
            system = system(n)
    except Exception as error:
        raise SystemDefinitionError(
            f"{stem}.py does not define a system: {type(error).__name__}: {error}"
        ) from error
    if not isinstance(system, System) or system.name != name:
        raise SystemDefinitionError(
            f"`system` in {stem}.py is {getattr(system, 'name', system)!r}: it must be a System "
            f"with the name {name!r}"
        )
    return system


def drawing(name: str) -> str:
    """The docstring of a system's file: a description, a drawing and a reference."""
    return (_module(_file(name)[0]).__doc__ or "").rstrip()


def published(name: str) -> str:
    """Published equations of a system or of a member of its family, as TOML text; may be empty."""
    stem, n = _file(name)
    text: str = getattr(_module(stem), "PUBLISHED", "")
    return text if n or not text else f'system = "{name}"{text}'


def _module(stem: str) -> ModuleType:
    package = "derive.systems.large" if stem in large_names() else "derive.systems"
    return import_module(f"{package}.{stem}")


def _file(name: str) -> tuple[str, int]:
    """The file of a system, and n of a member of a family, otherwise 0."""
    family = re.match(r"(\w+)_([1-9]\d{0,2})\Z", name)
    if family and f"{family[1]}_n" in stems() and int(family[2]) <= LARGEST:
        return f"{family[1]}_n", int(family[2])
    known = (*names(), *large_names())
    if name not in {*stems(), *large_names()} or name.endswith("_n"):
        raise UnknownSystemError(
            f"no system is called {name[:50]!r}{did_you_mean(name, known)}; known are "
            f"{', '.join(known)}, with any number up to {LARGEST} instead of {USUAL}; the path "
            "of a system file ends in .toml"
        )
    return name, 0


WIDTH = 96
#: Remark on systems whose modules do not ship.
LARGE = "derived when it is first used"


def description(name: str) -> str:
    """Drawing of a system, and names and units of its coordinates, state and parameters."""
    system = load(name)
    _, *picture = drawing(name).splitlines()  # the title replaces the first line
    coordinates = [
        f"{', '.join(str(c.symbol) for c in group)} [{unit}], {meaning}"
        for (unit, meaning), group in groupby(system.coordinates, lambda c: (c.unit, c.meaning))
    ]
    parameters = [f"{p.symbol} = {p.default:g} {p.unit}" for p in system.parameters]
    rows = {
        "coordinates": "; ".join(coordinates),
        "state": ", ".join(s.name for s in system.q + system.qdot),
        "parameters": ", ".join(parameters) or "none",
    }
    if system.inputs:
        rows["inputs"] = ", ".join(f"{u.symbol} [{u.unit}]" for u in system.inputs)
    if name in large_names():
        rows["module"] = LARGE
    layout = TextWrapper(WIDTH + 2, initial_indent="  ", subsequent_indent=" " * 6)
    lines = [layout.fill(f"{title}: {text}") for title, text in rows.items()]
    return "\n".join([f"{name}: {system.title}", *picture, "", *lines])


def markdown_table() -> str:
    """The systems that ship, as a table in Markdown; each row comes from the system's file."""
    head = "| system | coordinates | description | source of the published equations |"
    return "\n".join([head, "|---|---|---|---|", *map(_row, (*names(), *large_names())), ""])


def _row(name: str) -> str:
    coordinates = ", ".join(f"`{q.name}`" for q in load(name).q)
    summary = drawing(name).partition("\n")[0].rstrip(".")
    source = tomllib.loads(published(name)).get("source", "")
    stem = re.sub(rf"{USUAL}\Z", "", name)
    family = f"; `{stem}1` to `{stem}{LARGEST}`" if stem != name else ""
    remark = f" ({LARGE})" if name in large_names() else ""
    return f"| `{name}`{family}{remark} | {coordinates} | {summary} | {source} |"
