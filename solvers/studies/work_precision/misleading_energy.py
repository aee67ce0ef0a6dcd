"""Runs that keep the energy although their trajectory is wrong."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from solvers.equations.energy import energy_error
from solvers.integration.integrate import integrate
from solvers.integration.predictability import ignore_predictability
from solvers.scenes.scene import Scene
from solvers.studies.work_precision.curve import Curve
from solvers.studies.work_precision.reference import Reference

#: A state is wrong if its error exceeds this part of the motion, or of 1 rad and 1 rad/s.
WRONG = 0.1
#: Largest energy error that counts as kept; number of runs examined, and of samples in each.
KEPT, CANDIDATES, SAMPLES = 1e-3, 20, 400


@dataclass(frozen=True)
class MisleadingEnergy:
    """A compiled run with a small energy error and a wrong trajectory.

    Attributes
    ----------
    method, form : str
        Method and form of the equations.
    setting : dict
        Its step or tolerance.
    energy_error : float
        Largest over the whole run, relative to the initial energy above that of the equilibrium.
    global_error : float
        Of the final state.
    """

    method: str
    form: str
    setting: dict[str, float]
    energy_error: float
    global_error: float

    def __str__(self) -> str:
        setting = ", ".join(f"{name} = {value:.2g}" for name, value in self.setting.items())
        return (
            f"misleading energy: {self.method}, {self.form}, {setting}: energy error "
            f"{self.energy_error:.0e}, error of the final state {self.global_error:.2g}"
        )


def misleading_energy(
    curves: Sequence[Curve], scene: Scene, reference: Reference
) -> MisleadingEnergy | None:
    """The run with the least energy error among those with a wrong trajectory, if it is kept."""
    limit = wrong_above(scene, reference)
    candidates = [
        (point.energy_error, n, curve, point)
        for n, curve in enumerate(curves)
        if curve.backend == "compiled"
        for point in curve.points
        if point.global_error > limit
    ]
    results = []
    for _, _, curve, point in sorted(candidates, key=lambda row: row[:2])[:CANDIDATES]:
        energy = _largest_energy_error(scene, curve, point.setting)
        run = curve.method, curve.form, point.setting, energy, point.global_error
        results.append(MisleadingEnergy(*run))
    best = min(results, key=lambda run: run.energy_error, default=None)
    return best if best and best.energy_error < KEPT else None


def wrong_above(scene: Scene, reference: Reference) -> float:
    """The error above which no significant digit of a state is right."""
    size = max(map(abs, (*scene.y0, *reference.end.tolist())))
    return WRONG * min(1.0, size)


def _largest_energy_error(scene: Scene, curve: Curve, setting: dict[str, float]) -> float:
    module, params = scene.module, scene.params
    t = np.linspace(0, scene.duration, SAMPLES)
    solve = partial(integrate, method=curve.method, form=curve.form, t_eval=t, energy=True)
    options: dict[str, Any] = dict(setting)
    if "rtol" in setting:
        options["atol"] = setting["rtol"]
    with ignore_predictability():
        span = (0, scene.duration)
        run = solve(module, span, scene.y0, params, max_steps=10**8, **options)
    assert run.energy is not None
    return float(np.abs(energy_error(module, params, run.energy)).max())
