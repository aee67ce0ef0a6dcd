"""The results of one stage of the demonstration."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Number:
    """A reported number and its origin.

    Attributes
    ----------
    quantity, value : str
        The quantity and its value with a unit.
    method : str
        How the value was obtained: proof, computation or measurement.
    command : str
        The command that reproduces it.
    """

    quantity: str
    value: str
    method: str
    command: str


@dataclass(frozen=True)
class Stage:
    """Results of a stage: `lines` for the terminal, `html` and `numbers` for the page."""

    lines: tuple[str, ...]
    html: str = ""
    numbers: tuple[Number, ...] = ()
