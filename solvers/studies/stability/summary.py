"""Critical steps of every method for a scene, as text, as JSON and as a plot."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from solvers.equations.normal_modes import Modes, local_eigenvalues
from solvers.integration.integrate import integrate
from solvers.runge_kutta.catalogue import names
from solvers.scenes.scene import Scene
from solvers.studies.stability.critical_step import CriticalStep, critical_step
from solvers.studies.stability.plots import regions

#: Samples of a scene's motion at which its modes are computed.
SAMPLES = 100


def scene_steps(one: Scene, report: Callable[[str], None] = lambda _: None) -> list[CriticalStep]:
    """Every method's critical step in small motion with a scene's parameters."""
    found = []
    for method in names():
        report(f"{one.name}: {method}")
        found.append(critical_step(method, one.module, one.params))
    return found


def row(one: Scene, step: CriticalStep) -> dict[str, Any]:
    """A method's figures; None stands for no limit."""
    function = step.function
    return {
        "scene": one.name,
        "method": step.method,
        "title": step.title,
        "order": step.order,
        "stages": step.stages,
        "stability_function": {
            "numerator": [str(c) for c in function.numerator],
            "denominator": [str(c) for c in function.denominator],
        },
        "real_stability_interval": function.real_stability_interval,
        "imaginary_stability_interval": function.imaginary_stability_interval,
        "critical_step_predicted": step.predicted,
        "critical_step_measured": step.measured,
        "critical_step_measured_linear": step.linear,
        "probe": {
            "h": step.probe,
            "growth_predicted": step.growth_predicted,
            "growth_measured": step.growth_measured,
        },
    }


def told(one: Scene, steps: Sequence[CriticalStep]) -> Iterator[str]:
    """The same as text."""
    yield f"Longest stable steps of {one.title}: its fastest small motion, in s"
    yield (
        f"{'method':<10}{'order':>5}{'real':>9}{'imaginary':>11}{'predicted':>12}"
        f"{'linear':>10}{'nonlinear':>11}   ln growth a step, at h"
    )
    for s in steps:
        function = s.function
        yield (
            f"{s.method:<10}{s.order:>5}{function.real_stability_interval:>9.4g}"
            f"{function.imaginary_stability_interval:>11.5g}{s.predicted:>12.5g}{s.linear:>10.5g}"
            f"{s.measured:>11.5g}   {s.growth_measured:>8.1e} ({s.growth_predicted:.1e}), "
            f"{s.probe:.3g}"
        )
    yield "0: oscillations grow whatever the step; inf: they never do; measured (predicted)"


def picture(one: Scene, steps: Sequence[CriticalStep]) -> Any:
    """Regions of all methods with the scene's modes."""
    module, params = one.module, one.params
    t = np.linspace(0, one.duration, SAMPLES)
    motion = integrate(module, (0, one.duration), one.y0, params, t_eval=t)
    return regions(
        f"|R(hλ)| ≤ 1, small motions (dots) and the motion (grey) of {one.title}",
        steps, Modes.at_rest(module, params).frequencies,
        local_eigenvalues(module, params, motion.y.T).ravel(),
    )  # fmt: skip
