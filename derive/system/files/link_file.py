"""Links of a system in a TOML file."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from derive.system.files.tables import TomlTable
from derive.system.links.centred_links import Block, Box, Cart, Wheel
from derive.system.links.line_links import Line, Plate, Rail, Rod, Spring, Thread
from derive.system.links.link import Link
from derive.system.parts import SystemDefinitionError
from solvers.io.suggestion import shortened
from solvers.io.toml_input import InputError

LINES: dict[str, type[Line]] = {
    "rod": Rod,
    "thread": Thread,
    "spring": Spring,
    "rail": Rail,
    "plate": Plate,
}
#: Kinds with a centre, and the names of their sizes.
CENTRED: dict[str, tuple[Callable[..., Link], tuple[str, ...]]] = {
    "wheel": (Wheel, ("radius",)),
    "block": (Block, ("width", "height")),
    "cart": (Cart, ("width", "height")),
    "box": (Box, ("length", "width", "height")),
}
#: Other keys of a kind, if they are not an angle.
OPTIONAL: dict[str, tuple[str, ...]] = {"wheel": ("angle", "plane"), "box": ()}
KINDS = (*LINES, *CENTRED)
KEYS = (*KINDS, "radius", "length", "width", "height", "angle", "plane")


def read_links(table: TomlTable, value: Callable[[str, str], object]) -> Iterator[Link]:
    """The links of a file; ``value(key, text)`` is the value of a formula."""
    for row in table.listed("links", KEYS):
        kinds = [kind for kind in KINDS if kind in row.values]
        if len(kinds) != 1:
            raise InputError(f"{row.name} must have one of the keys {', '.join(KINDS)}")
        try:
            yield _link(row, kinds[0], partial(value, row.name))
        except SystemDefinitionError as error:
            raise InputError(f"{row.name}: {error}") from error


def _link(row: TomlTable, kind: str, value: Callable[[str], object]) -> Link:
    if kind in LINES:
        known: tuple[str, ...] = (kind,)
        points = row.values[kind]
        if not isinstance(points, list):
            raise InputError(f"{kind} = {shortened(points)} in {row.name} must be a list of points")
    else:
        known = (kind, *CENTRED[kind][1], *OPTIONAL.get(kind, ("angle",)))
        points = [row.values[kind]]
    for key in row.values:
        if key not in known:
            raise InputError(f"a {kind} has no {key}, in {row.name}; known are {', '.join(known)}")
    places: list[Any] = [_place(row, kind, point, value) for point in points]
    if kind in LINES:
        return LINES[kind](*places)
    build, sizes = CENTRED[kind]
    values: dict[str, object] = {key: value(row.formula(key)) for key in sizes}
    if "angle" in row.values:
        values["angle"] = value(row.formula("angle"))
    if "plane" in row.values:
        axes = row.values["plane"]
        if not isinstance(axes, list) or len(axes) != 2:
            raise InputError(f"plane = {shortened(axes)} in {row.name} must be two unit vectors")
        values["plane"] = tuple(_place(row, "plane", axis, value) for axis in axes)
    return build(places[0], **values)


def _place(row: TomlTable, key: str, point: object, value: Callable[[str], object]) -> object:
    """A point: the number of a mass, or formulas of its components."""
    if isinstance(point, list):
        return tuple(map(value, TomlTable(row.name, {key: point}, (key,)).formulas(key)))
    return point
