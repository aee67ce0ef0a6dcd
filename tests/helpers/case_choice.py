"""The choice of the cases of long tests that the short part keeps."""

from collections.abc import Iterable, Mapping, Sequence
from random import Random
from typing import Any

import pytest


def chosen_cases(cases: Sequence[Mapping[str, Any]], count: int, rng: Random) -> list[int]:
    """Indices of random cases, each with as many new values of the arguments as possible.

    So cases of a test in every loop, form and method are in as many of them as `count` allows.
    """
    values = [{(name, repr(value)) for name, value in one.items()} for one in cases]
    rest, seen = rng.sample(range(len(cases)), len(cases)), set[tuple[str, str]]()
    chosen: list[int] = []
    while rest and len(chosen) < count:
        best = max(rest, key=lambda k: len(values[k] - seen))
        rest.remove(best)
        chosen.append(best)
        seen |= values[best]
    return chosen


def planted(mistakes: Iterable[str], keep: int) -> list[Any]:
    """Cases of a test with planted mistakes, of which the short part keeps some, and ``none``."""
    long = pytest.mark.long("more planted mistakes", keep=keep)
    return [one if one == "none" else pytest.param(one, marks=long) for one in mistakes]
