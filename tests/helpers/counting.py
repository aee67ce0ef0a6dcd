"""Work of functions in calls of functions, which a busy machine does not change."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType


@dataclass
class Calls:
    """Calls of functions, also of those that are written in C."""

    count: int = 0


@contextmanager
def counted_calls() -> Iterator[Calls]:
    """Count the calls in the context, also where it ends with an exception."""
    calls = Calls()

    def profile(_frame: FrameType, event: str, _argument: object) -> None:
        calls.count += event in ("call", "c_call")

    before = sys.getprofile()
    sys.setprofile(profile)
    try:
        yield calls
    finally:
        sys.setprofile(before)


def assert_linear(function: Callable[[int], object], size: int) -> None:
    """Assert that twice the size takes at most two and a half times the calls."""
    function(size)  # fills caches
    with counted_calls() as once:
        function(size)
    with counted_calls() as twice:
        function(2 * size)
    assert twice.count <= 2.5 * once.count + 1000
