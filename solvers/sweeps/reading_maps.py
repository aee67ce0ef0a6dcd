"""What a file says is kept of each motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from solvers.equations.module import GeneratedModule
from solvers.io import toml_input
from solvers.io.quantity import shortened
from solvers.io.suggestion import did_you_mean
from solvers.io.toml_input import InputError
from solvers.sweeps.map import Map
from solvers.sweeps.maps import (
    EnergyError,
    Extremes,
    Final,
    First,
    Lyapunov,
    Samples,
    Section,
)

Given = Mapping[str, Any]
DIRECTIONS = {"both": 0, "up": 1, "down": -1}
#: Numbers that are kept of one motion, at most.
MOST = 10**6


def kept(key: str, module: GeneratedModule, given: Given) -> Map:
    """The map that a table says.

    Parameters
    ----------
    key : str
        Where the table stands in the file, such as ``maps.flip``.
    module : module
        A generated module.
    given : mapping
        The table.

    Returns
    -------
    Map
        Of the kind that is named.

    Raises
    ------
    solvers.io.toml_input.InputError
        When it makes no sense.
    """
    if "kind" not in given:
        raise InputError(f"{key}.kind is missing: give one of {', '.join(map(repr, KINDS))}")
    kind = given["kind"]
    if not isinstance(kind, str) or kind not in KINDS:
        hint = did_you_mean(kind, tuple(KINDS)) if isinstance(kind, str) else ""
        raise InputError(
            f"{key}.kind = {shortened(kind)}{hint} must be one of {', '.join(map(repr, KINDS))}"
        )
    known, meaning = KINDS[kind]
    toml_input.check_keys(key, given, ("kind", *known))
    return meaning(key, module, given)


def _first(key: str, module: GeneratedModule, given: Given) -> First:
    watched = toml_input.table(f"{key}.of", given.get("of", {}))
    toml_input.check_keys(f"{key}.of", watched, module.STATE)
    values = {
        name: tuple(
            toml_input.number(f"{key}.of.{name}", one, module.UNITS[name]) for one in _list(value)
        )
        for name, value in watched.items()
    }
    places = []
    for place in _list(given.get("barrier", [])):
        toml_input.check_keys(
            f"{key}.barrier", toml_input.table(f"{key}.barrier", place), module.COORDINATES
        )
        places.append({
            q: toml_input.number(f"{key}.barrier.{q}", value, module.UNITS[q])
            for q, value in place.items()
        })  # fmt: skip
    return First(values, tuple(places))


def _section(key: str, module: GeneratedModule, given: Given) -> Section:
    where, direction = given.get("where"), given.get("direction", "both")
    if not isinstance(where, str) or where not in module.STATE:
        raise InputError(
            f"{key}.where = {shortened(where)} must be one of {', '.join(module.STATE)}"
        )
    if not isinstance(direction, str) or direction not in DIRECTIONS:
        raise InputError(
            f"{key}.direction = {shortened(direction)} must be one of {', '.join(DIRECTIONS)}"
        )
    value = toml_input.number(f"{key}.value", given.get("value", 0.0), module.UNITS[where])
    of, count = _of(key, module, given), _count(key, given)
    return Section(of, count, where, value, DIRECTIONS[direction])


def _of(key: str, module: GeneratedModule, given: Given) -> tuple[str, ...]:
    """Components of the state."""
    of = toml_input.texts(f"{key}.of", _list(given.get("of", [])), len(module.STATE))
    if not of or len({*of}) < len(of):
        raise InputError(f"{key}.of = {list(of)} must name components, each of them once")
    for name in of:
        if name not in module.STATE:
            raise InputError(
                f"{key}.of names {name[:50]!r}{did_you_mean(name, module.STATE)}: known are "
                f"{', '.join(module.STATE)}"
            )
    return of


def _count(key: str, given: Given) -> int:
    return toml_input.whole(f"{key}.count", given.get("count"), 1, MOST)


def _list(value: object) -> list[Any]:
    """A list, or what may stand for a list of one."""
    return value if isinstance(value, list) else [value]


#: What a map of each kind is told, and what it becomes.
KINDS: dict[str, tuple[tuple[str, ...], Callable[[str, GeneratedModule, Given], Map]]] = {
    "first": (("of", "barrier"), _first),
    "final": (("of",), lambda key, module, given: Final(_of(key, module, given))),
    "extremes": (("of",), lambda key, module, given: Extremes(_of(key, module, given))),
    "samples": (
        ("of", "count"),
        lambda key, module, given: Samples(_of(key, module, given), _count(key, given)),
    ),
    "section": (("of", "count", "where", "value", "direction"), _section),
    "lyapunov": ((), lambda *_: Lyapunov()),
    "energy error": ((), lambda *_: EnergyError()),
}
