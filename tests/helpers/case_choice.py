"""The choice of the cases of long tests that the short part keeps, and the long one of a day."""

import sys
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from random import Random
from typing import Any

import pytest

#: Cases of a long test without a number for the short part (``keep``) and the long one (``daily``).
DEFAULT_COUNTS = {"keep": 0, "daily": sys.maxsize}


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


def cases_beyond(items: Iterable[pytest.Item], key: str, seed: str) -> set[pytest.Item]:
    """Cases of long tests beyond the number that ``key`` of their marker states.

    Those of the smaller number are among those of the larger one.
    """
    cases: dict[str, list[pytest.Item]] = defaultdict(list)
    for item in items:
        if item.get_closest_marker("long") and not item.get_closest_marker("campaign"):
            cases[item.nodeid.partition("[")[0]].append(item)
    beyond: set[pytest.Item] = set()
    for name, own in cases.items():
        marker = own[0].get_closest_marker("long")
        count = marker.kwargs.get(key, DEFAULT_COUNTS[key]) if marker else 0
        arguments = [item.callspec.params if hasattr(item, "callspec") else {} for item in own]
        beyond |= {*own} - {
            own[k] for k in chosen_cases(arguments, count, Random(f"{seed} {name}"))
        }
    return beyond


def planted(mistakes: Iterable[str], keep: int) -> list[Any]:
    """Cases of a test with planted mistakes, of which the short part keeps some, and ``none``."""
    long = pytest.mark.long("more planted mistakes", keep=keep)
    return [one if one == "none" else pytest.param(one, marks=long) for one in mistakes]
