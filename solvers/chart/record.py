"""What charts keep of what they measured: the cheapest compiled run for each error, by scene."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from solvers import stated
from solvers.chart.findings import Charted
from solvers.chart.frontier import frontier
from solvers.jsonable import jsonable
from solvers.stability.modes import mode_spread

#: Written by ``holonomic chart --record``; scenes are run in the ways that it says are cheapest.
RECORD = Path(__file__).with_name("measured.json")


def recorded(charts: Sequence[Charted]) -> str:
    """The text of the record."""
    rows = [
        {
            "scene": chart.scene.name,
            "system": stated.system(chart.scene.module),
            "duration": chart.scene.duration,
            "spread": mode_spread(chart.scene.module, chart.scene.params),
            "frontier": frontier([c for c in chart.curves if c.backend == "compiled"]),
        }
        for chart in charts
    ]
    return json.dumps(jsonable(rows), indent=1) + "\n"
