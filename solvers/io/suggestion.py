"""Suggestions, quotations and counts in messages, and warnings."""

import sys
import warnings
from collections.abc import Iterable, Sequence
from difflib import get_close_matches

#: Names of the step size, of which functions and files know one.
STEP_SIZES = ("h", "step", "step_size", "stepsize", "dt", "delta_t")
#: Characters of the shortest beginning of a name for which the whole name is suggested.
SHORTEST = 3


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """The closest known name, or the first that begins with `name`, as the end of a message."""
    by_lower = {other.lower(): other for other in known}
    lower = name.lower()
    longer = [other for other in by_lower if len(lower) >= SHORTEST and other.startswith(lower)]
    close = get_close_matches(lower, by_lower, n=1) or longer
    if lower in STEP_SIZES:
        close = [size for size in STEP_SIZES if size in by_lower] or close
    return f" (did you mean {by_lower[close[0]]!r}?)" if close else ""


def counted(number: int, noun: str) -> str:
    """A number and a noun, which is in the plural unless the number is 1."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def listed(names: Sequence[str]) -> str:
    """Names as a sentence lists them: with "and" before the last one."""
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last


def shortened(value: object) -> str:
    """A value as a message quotes it: its first fifty characters, on one line."""
    try:
        return " ".join(map(str.strip, repr(value).splitlines()))[:50]
    except ValueError:  # Python writes no number of thousands of digits
        return "a number of thousands of digits"


def warn_caller(message: Warning | str, category: type[Warning] = UserWarning) -> None:
    """Warn at the first line outside of this project that led here."""
    level, frame = 1, sys._getframe(1)
    own = ("solvers.", "derive.", "functools")  # the last one calls cached properties
    while frame.f_back and frame.f_globals.get("__name__", "").startswith(own):
        level, frame = level + 1, frame.f_back
    warnings.warn(message, category, stacklevel=level + 1)
