"""The method and form of an integration, chosen by recorded measurements."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import chain
from math import log, nan
from pathlib import Path
from typing import Any

from solvers.equations.forms import fastest_form
from solvers.equations.linearisation.normal_modes import mode_spread
from solvers.equations.module import GeneratedModule
from solvers.runge_kutta.method_catalogue import SCIPY, load, names

RECORD = Path(__file__).with_name("measured.json")
SERIES = "taylor"


@dataclass(frozen=True)
class MethodChoice:
    """The method and form that the full equations are integrated with."""

    method: str  # a Runge–Kutta method, one of SciPy's, or "taylor" for series with many digits
    form: str
    why: str  # the reason for this choice
    seconds: float = nan  # measured, per second of motion
    step: float | None = None  # a fixed step size in s
    compensated: bool = False  # sums, where the loop is compiled
    is_named: bool = False  # in the scene
    precision: str = "double"  # else one of `solvers.integration.compiled.extended.PRECISIONS`

    @property
    def is_series(self) -> bool:
        """Whether it is a Taylor series, whose setting is the number of digits."""
        return self.method == SERIES

    @property
    def is_extended(self) -> bool:
        """Whether its numbers are compiled ones that are longer than doubles."""
        return self.precision != "double"

    @property
    def is_fixed(self) -> bool:
        """Whether the step size is fixed."""
        is_ours = not self.is_series and not self.is_extended and self.method not in SCIPY
        return self.step is not None or (is_ours and not load(self.method).estimates_error)


def usual_form(module: GeneratedModule, method: str) -> str:
    """The fastest form that a method takes; Lagrange's for SciPy's methods."""
    takes_any = method == SERIES or (method in names() and load(method).takes_any_form)
    return fastest_form(module) if takes_any else "lagrangian"


@cache
def _record() -> list[dict[str, Any]]:
    return json.loads(RECORD.read_text(encoding="utf-8"))


def cheapest(module: GeneratedModule, params: Sequence[float], accuracy: float) -> MethodChoice:
    """The cheapest method choice for an accuracy in the most similar recorded scene.

    Scenes of the same system are similar, and of these those with a similar spread of modes: a
    method that pays where the fastest mode is hundreds of times as fast as the slowest does not
    where both are alike. Of equally similar scenes the first in the record counts. Where nothing
    recorded is as accurate, the choice has the smallest recorded error.
    """
    spread = mode_spread(module, params)
    scenes = [scene for scene in _record() if scene["system"] == module.SYSTEM] or _record()
    nearest = min(scenes, key=lambda scene: abs(log(scene["spread"] / spread)))
    rows: list[dict[str, Any]] = nearest["frontier"]
    best = next((row for row in rows if row["global_error"] <= accuracy), rows[-1])
    method, form, seconds = best["method"], best["form"], best["work_seconds"]
    ratios = [[*best["cost_ratios"][axis].items()][:2] for axis in ("method", "form")]
    others = ", ".join(f"{name} {factor:.2g} x" for name, factor in chain(*ratios))
    why = (
        f"cheapest for {best['global_error']:.0e} as measured in scene {nearest['scene']!r}, the "
        f"most similar one: {seconds * 1e6:.3g} µs for {nearest['duration']:g} s; others "
        f"there: {others}"
    )
    form = form if form in module.FORMS else usual_form(module, method)
    return MethodChoice(method, form, why, seconds / nearest["duration"])
