"""How to integrate, and the cheapest way by what was measured."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import log, nan
from pathlib import Path
from typing import Any

from solvers.equations.forms import fastest_form
from solvers.equations.module import GeneratedModule
from solvers.equations.normal_modes import mode_spread
from solvers.runge_kutta.catalogue import SCIPY, load, names

RECORD = Path(__file__).with_name("measured.json")
SERIES = "taylor"


@dataclass(frozen=True)
class MethodChoice:
    """A method and a form.

    Attributes
    ----------
    method : str
        One of the catalogue's or SciPy's, or ``taylor`` for series with many digits.
    form : str
        Of the equations.
    why : str
        Why this one.
    seconds : float
        What it was measured to take for a second of motion.
    """

    method: str
    form: str
    why: str
    seconds: float = nan

    @property
    def is_series(self) -> bool:
        """Whether digits are what is set."""
        return self.method == SERIES

    @property
    def is_fixed(self) -> bool:
        """Whether steps do not follow a tolerance."""
        return not self.is_series and self.method not in SCIPY and not load(self.method).b_hat

    @property
    def order(self) -> float:
        """Order of the method."""
        return float(load(self.method).order)


def usual_form(module: GeneratedModule, method: str) -> str:
    """The form that runs fastest; where a Jacobian is needed, or it is SciPy's, Lagrange's."""
    is_ours = method in (SERIES, *names())
    is_plain = is_ours and (method == SERIES or load(method).is_explicit)
    return fastest_form(module) if is_plain else "lagrangian"


@cache
def _record() -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(RECORD.read_text(encoding="utf-8"))
    return found


def cheapest(module: GeneratedModule, params: Sequence[float], accuracy: float) -> MethodChoice:
    """The way that was cheapest for this accuracy in the charted scene most like this one.

    Scenes of the same system are alike, and of these those whose modes are: a method that
    pays where the fastest mode is hundreds of times as fast as the slowest does not where
    both are alike. Of scenes as alike the one that was charted first counts.

    Parameters
    ----------
    module : module
        A generated module.
    params : sequence of float
        In the order of ``module.PARAMETERS``.
    accuracy : float
        How large errors may be.

    Returns
    -------
    MethodChoice
        Where nothing charted is as accurate, that for the smallest error charted.
    """
    spread = mode_spread(module, params)
    system = module.SYSTEM
    own = [scene for scene in _record() if scene["system"] == system] or _record()
    nearest = min(own, key=lambda scene: abs(log(scene["spread"] / spread)))
    rows: list[dict[str, Any]] = nearest["frontier"]
    good = [row for row in rows if row["global_error"] <= accuracy] or rows[-1:]
    best = good[0]
    others = ", ".join(
        f"{name} {factor:.2g} x"
        for choice in ("method", "form")
        for name, factor in list(best["cost_ratios"][choice].items())[:2]
    )
    return MethodChoice(
        best["method"],
        best["form"] if best["form"] in module.FORMS else usual_form(module, best["method"]),
        f"cheapest for {best['global_error']:.0e} as measured in scene {nearest['scene']!r}, whose "
        f"modes are most alike: {best['work_seconds'] * 1e6:.3g} us for {nearest['duration']:g} s; "
        f"others there: {others}",
        best["work_seconds"] / nearest["duration"],
    )
