"""What somebody may have meant."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """The nearest known name, whatever its capitals, as it ends a message; empty if none is."""
    small = {one.lower(): one for one in known}
    found = [small[one] for one in get_close_matches(name.lower(), small, n=1)]
    return f" (did you mean {found[0]!r}?)" if found else ""
