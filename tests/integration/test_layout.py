"""Structures that C and Python share: read from one file, and compared when a library is loaded."""

import ctypes
import shutil
from collections.abc import Callable

import pytest

import generated.double_pendulum as dp
from solvers.integration.compiled import memory_layout
from solvers.integration.compiled.kernel import Kernel
from solvers.integration.compiled.memory_layout import LayoutError, members

pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")


def load() -> Kernel:
    options = {"lanes": False, "compensated": True, "reproducible": False}
    return Kernel(dp, "rational", "rk4", **options)


def test_every_member_of_the_header_is_read() -> None:
    assert [name for _, name, _ in members("Row")] == ["t", "z", "turns", "scale"]
    assert members("Motion")[: len(members("State"))] == members("State")
    assert len(members("Event")) == 12
    kernel = load()
    assert kernel.trajectory["z"].shape == kernel.trajectory["z_low"].shape == (6,)
    assert kernel.row["turns"].shape == (2,)
    assert kernel.row["scale"].shape == (0,)


def without_first(structure: str) -> Callable[[str], tuple[memory_layout.Member, ...]]:
    return lambda name: members(name)[1:] if name == structure else members(name)


@pytest.mark.parametrize("structure", ["Trajectory", "Row", "Event", "Motion"])
def test_a_member_that_python_misses_is_reported(
    structure: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(memory_layout, "members", without_first(structure))
    name = "Trajectory" if structure == "Motion" else structure
    with pytest.raises(
        LayoutError, match=rf"structure {name} has \d+ bytes in C and \d+ in Python"
    ):
        load()


def test_a_task_that_python_misses_a_member_of_is_reported(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Short(ctypes.Structure):
        _fields_ = memory_layout.Task._fields_[:-1]

    monkeypatch.setattr(memory_layout, "Task", Short)
    with pytest.raises(LayoutError, match="structure Task has 200 bytes in C and 192 in Python"):
        load()


def test_a_member_that_is_not_of_eight_bytes_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    text = (memory_layout.SOURCES / "layout.h").read_text(encoding="utf-8")
    narrow = text.replace("    int64_t direction;", "    int direction : 3;")
    monkeypatch.setattr(memory_layout, "_text", lambda: narrow)
    members.cache_clear()
    with pytest.raises(LayoutError, match=r"Event in layout\.h has an unreadable member: int dir"):
        members("Event")
    members.cache_clear()
