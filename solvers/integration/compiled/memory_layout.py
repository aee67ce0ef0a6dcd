"""Memory layouts that Python and C share: read from ``c/layout.h``, where they are written once."""

import ctypes
import re
from collections.abc import Mapping
from functools import cache
from importlib.resources import files

import numpy as np

from solvers.integration.problem.status import Status

#: Folder of the handwritten C files.
SOURCES = files(__package__) / "c"
MAX_EVENTS = 8
#: The numbers of ``enum Status`` in C, in order; the first two are of unfinished motions.
STATUSES = (
    *(None, None, Status.FINISHED, Status.EVENT, Status.STEP_LIMIT, Status.NOT_FINITE),
    *(Status.STEP_TOO_SMALL, Status.NO_CONVERGENCE, Status.UNDETERMINED, Status.SINGULAR),
)
UNFINISHED = ("WAITING", "RUNNING")

STRUCTURE = re.compile(r"typedef struct \{\n(.*?)\} (\w+);", re.DOTALL)
TYPE = r"(?:const )?(?:volatile )?(real|double|int64_t|[A-Z]\w+)"
MEMBER = re.compile(rf"    {TYPE} (\*?)(\w+)(?:\[(\w+)\])?; *(?:/\*.*\*/)?")

Member = tuple[str, str, str]


def source(name: str) -> str:
    """The text of a handwritten C file."""
    return (SOURCES / name).read_text(encoding="utf-8")


class LayoutError(RuntimeError):
    """C and Python disagree about the layout of a structure; the message names it."""


@cache
def members(structure: str) -> tuple[Member, ...]:
    """Type, name and length of every member of a structure; a nested one gives its own members."""
    bodies = {name: body for body, name in STRUCTURE.findall(_text())}
    result: list[Member] = []
    for line in bodies[structure].splitlines():
        member = MEMBER.fullmatch(line)
        if not member:
            raise LayoutError(f"{structure} in layout.h has an unreadable member: {line.strip()}")
        kind, star, name, length = member.groups(default="")
        if kind in bodies and not star:
            result += members(kind)
        else:
            result.append(("int64_t" if star else kind, name, length))
    return tuple(result)


def declarations(sizes: Mapping[str, int]) -> str:
    """The C text of sizes, statuses and structures."""
    return f"{sizes_and_statuses(sizes)}\n{_text()}"


def sizes_and_statuses(sizes: Mapping[str, int]) -> str:
    """Their C text."""
    names = [*UNFINISHED, *(status.name for status in STATUSES if status)]
    numbers = ", ".join(f"{name} = {size}" for name, size in sizes.items())
    return f"enum {{ {numbers} }};\nenum Status {{ {', '.join(names)} }};"


def _text() -> str:
    return source("layout.h")


def record(structure: str, sizes: Mapping[str, int]) -> np.dtype[np.void]:
    """The type of a structure in memory, with arrays of the given sizes."""
    fields = members(structure)
    if structure == "Trajectory":  # it begins with the numbers of a Motion
        fields = members("Motion") + fields[1:]
    types = {"int64_t": np.int64}
    shaped = ((name, types.get(kind, float), length) for kind, name, length in fields)
    return np.dtype([(name, kind, (sizes[n],) if n else ()) for name, kind, n in shaped])


EVENT = record("Event", {})


class Task(ctypes.Structure):
    """What a compiled loop does; pointers are addresses."""

    _fields_ = [
        (name, ctypes.c_int64 if kind == "int64_t" else ctypes.c_double)
        for kind, name, _ in members("Task")
    ]


def check(library: ctypes.CDLL, sizes: Mapping[str, int]) -> None:
    """Compare the sizes of all structures with those of a compiled library."""
    expected = {name: record(name, sizes).itemsize for name in ("Trajectory", "Row", "Event")}
    expected["Task"] = ctypes.sizeof(Task)
    compiled = (ctypes.c_int64 * len(expected)).in_dll(library, "LAYOUT_SIZES")
    for (name, size), there in zip(expected.items(), compiled, strict=True):
        if size != there:
            raise LayoutError(
                f"structure {name} has {there} bytes in C and {size} in Python: one of the members "
                "in c/layout.h is not of eight bytes, or memory_layout.py reads it as another type"
            )
