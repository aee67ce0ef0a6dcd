"""What a station of the demonstration has found."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Number:
    """A number that is shown, and where it comes from.

    Attributes
    ----------
    what, value : str
        What it is, and how large.
    how : str
        How it was obtained: proved, computed against what, or measured.
    command : str
        What anybody types to obtain it again.
    """

    what: str
    value: str
    how: str
    command: str


@dataclass(frozen=True)
class Station:
    """A station on the way from positions to motion.

    Attributes
    ----------
    lines : tuple of str
        For the terminal.
    html : str
        For the page.
    numbers : tuple of Number
        Its numbers.
    """

    lines: tuple[str, ...]
    html: str
    numbers: tuple[Number, ...] = ()
