"""What charts keep of what they measured: the cheapest compiled run for each error, by scene."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from solvers.chart.findings import Charted
from solvers.chart.frontier import frontier
from solvers.jsonable import jsonable
from solvers.stability.modes import Modes

#: Written by ``holonomic chart --record``; scenes are run in the ways that it says are cheapest.
RECORD = Path(__file__).with_name("measured.json")


def recorded(charts: Sequence[Charted]) -> str:
    """The text of the record."""
    rows = [
        {
            "scene": chart.scene.name,
            "system": chart.scene.module.__name__.rpartition(".")[2],
            "duration": chart.scene.duration,
            "spread": mode_spread(chart.scene.module, chart.scene.params),
            "frontier": frontier([c for c in chart.curves if c.backend == "compiled"]),
        }
        for chart in charts
    ]
    return json.dumps(jsonable(rows), indent=1) + "\n"


def mode_spread(module: ModuleType, params: Sequence[float]) -> float:
    """How many times as fast as the slowest mode about rest the fastest is; 1 if none is known."""
    try:
        frequencies = Modes.at_rest(module, params).frequencies
    except ValueError:
        return 1.0
    return float(frequencies[-1] / frequencies[0])
