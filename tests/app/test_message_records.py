"""Messages about files with one invalid value each."""

import tomllib
from collections.abc import Callable, Iterator
from copy import deepcopy
from itertools import cycle
from pathlib import Path
from typing import Any

import pytest
from damage import toml
from recording import Record
from valid_files import BEAD, HAND, SCENE, SWEEP

from derive import load
from derive.verification.hand_derivation_files import judge
from solvers.app.modules import load as load_module
from solvers.scenes.scene_reading import read
from solvers.sweeps.definition.sweep_reading import find

#: Values that are hardly anywhere allowed, and None for another key.
INVALID = (None, True, "", -1, "q", [], {}, 0, "2 furlong", [1, "a", 2], 1e300, "1/0")
FILES: dict[str, tuple[str, Callable[[Path], object]]] = {
    "system": (BEAD, load),
    "hand derivation": (HAND, judge),
    "scene": (SCENE, lambda path: read(path, load_module)),
    "sweep": (SWEEP, lambda path: find(str(path), load_module)),
}


def places(value: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The keys and indices of all values in a document, and of what holds them."""
    if place:
        yield place
    if isinstance(value, list):
        value = dict(enumerate(value))
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from places(inner, (*place, key))


def damaged(document: dict[str, Any], place: tuple[Any, ...], new: object) -> dict[str, Any]:
    """A document with another value, or with a misspelt key, at a place."""
    copy: Any = deepcopy(document)
    inner = copy
    for key in place[:-1]:
        inner = inner[key]
    if new is None and isinstance(place[-1], str):
        inner[place[-1][:-1] + "x"] = inner.pop(place[-1])
    else:
        inner[place[-1]] = new
    return copy


@pytest.mark.parametrize("kind", FILES)
def test_messages_about_a_file_are_as_recorded(kind: str, record: Record, tmp_path: Path) -> None:
    text, reader = FILES[kind]
    document, path, lines = tomllib.loads(text), tmp_path / "mine.toml", []
    for place, new in zip(places(document), cycle(INVALID), strict=False):
        path.write_text(toml(damaged(document, place, new)), encoding="utf-8")
        try:
            reader(path)
            message = "accepted"
        except ValueError as error:
            message = str(error).replace(f"{path}: ", "").replace(str(tmp_path), "")
        lines.append(f"{'.'.join(map(str, place))} = {new!r}: {message}")
    record.check("\n".join(lines))
