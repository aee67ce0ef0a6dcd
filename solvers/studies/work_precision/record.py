"""What charts keep of what they measured: the cheapest compiled run for each error, by scene."""

from __future__ import annotations

import json
from collections.abc import Sequence

from solvers.equations.normal_modes import mode_spread
from solvers.io.json_values import jsonable
from solvers.studies.work_precision.findings import Charted
from solvers.studies.work_precision.frontier import frontier


def recorded(charts: Sequence[Charted]) -> str:
    """The text of the record."""
    rows = [
        {
            "scene": chart.scene.name,
            "system": chart.scene.module.SYSTEM,
            "duration": chart.scene.duration,
            "spread": mode_spread(chart.scene.module, chart.scene.params),
            "frontier": frontier([c for c in chart.curves if c.backend == "compiled"]),
        }
        for chart in charts
    ]
    return json.dumps(jsonable(rows), indent=1) + "\n"
