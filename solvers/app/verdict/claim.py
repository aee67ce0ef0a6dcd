"""A claim of the report with its verdict."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: Plots, each after the command that writes it.
CHART, STEPS = (
    f"holonomic chart: {name}.png" for name in ("work_precision_report", "steps_report")
)
CHAOS, TOLERANCES = (
    f"holonomic stability: failures_{name}.png" for name in ("chaos", "tolerances")
)


@dataclass(frozen=True)
class Claim:
    """A claim of the report, restated, with its verdict.

    Attributes
    ----------
    id : str
        Section, and a letter.
    claim : str
        The statement.
    verdict : {"supported", "contradicted", "untestable"}
        The result of the test.
    number : str
        The number that decides, or the reason why there is none.
    figure : str
        The plot that shows it, after the command that writes it; empty if there is none.
    """

    id: str
    claim: str
    verdict: str
    number: str
    figure: str = ""


def outcome(holds: bool | np.bool) -> str:
    """``supported`` or ``contradicted``."""
    return "supported" if holds else "contradicted"
