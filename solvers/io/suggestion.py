"""Suggestions and quotations in messages about wrong input."""

from collections.abc import Iterable
from difflib import get_close_matches


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """The closest known name, ignoring case, as the end of a message; empty if none is close."""
    by_lower = {other.lower(): other for other in known}
    close = get_close_matches(name.lower(), by_lower, n=1)
    return f" (did you mean {by_lower[close[0]]!r}?)" if close else ""


def shortened(value: object) -> str:
    """A value as a message quotes it: its first fifty characters."""
    try:
        return repr(value)[:50]
    except ValueError:  # Python writes no number of thousands of digits
        return "a number of thousands of digits"
