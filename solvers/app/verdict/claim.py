"""A claim of the report, what became of it, and where that can be seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: Pictures, each after the command that draws it.
CHART, STEPS = (
    f"holonomic chart: {name}.png" for name in ("work_precision_report", "steps_report")
)
CHAOS, TOLERANCES = (
    f"holonomic stability: failures_{name}.png" for name in ("chaos", "tolerances")
)


@dataclass(frozen=True)
class Claim:
    """A claim of the report, in our words, and what was found.

    Attributes
    ----------
    id : str
        Section, and a letter.
    claim : str
        What is said there.
    verdict : {"supported", "contradicted", "untestable"}
        What was found.
    number : str
        The number that says so, or why there is none.
    figure : str
        The picture that shows it, and the command that draws it; empty if none does.
    """

    id: str
    claim: str
    verdict: str
    number: str
    figure: str = ""


def judged(holds: bool | np.bool) -> str:
    """In a word."""
    return "supported" if holds else "contradicted"
