"""``holonomic stability``: exact regions beside running steppers, and where methods fail."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from solvers.app.commands.options import options
from solvers.equations.module import GeneratedModule
from solvers.equations.normal_modes import Modes, local_eigenvalues
from solvers.integration.integrate import integrate
from solvers.integration.prepare import no_compiler
from solvers.io.figures import save
from solvers.io.json_values import jsonable
from solvers.io.progress import Progress
from solvers.runge_kutta.catalogue import names
from solvers.scenes.scene import Scene
from solvers.studies.failure_modes.study import studies
from solvers.studies.stability.critical_step import CriticalStep, critical_step
from solvers.studies.stability.plots import regions

#: Whose small motions are judged if none is named; then failures are studied, too.
USUAL = ("report",)
#: How often along a scene's motion its modes are looked at.
LOOKS = 100


def main(argv: Sequence[str], module: Callable[[str], GeneratedModule]) -> int:
    """Compute, draw and print.

    Parameters
    ----------
    argv : sequence of str
        Options.
    module : callable
        Gives a generated module by its name; raises `LookupError` for an unknown one.

    Returns
    -------
    int
        Exit code 0; what goes wrong is raised.
    """
    scenes, arguments = options(
        argv, module, name="stability", scenes="whose small motions to judge", usual=USUAL,
        example="single --json",
        description="For every method the exact stability function and its intervals, and the "
        "longest stable step of a scene's small motions, predicted and measured. Without a scene: "
        "the report's, and then where methods fail, which takes about two minutes.",
    )  # fmt: skip
    found: dict[str, Any] = {"methods": [], "failures": {}, "pictures": []}
    for one in scenes:
        with Progress() as tell:
            steps = scene_steps(one, tell)
        path = arguments.output / f"stability_{one.name}.png"
        save(picture(one, steps), path)
        found["methods"] += [row(one, step) for step in steps]
        found["pictures"].append(str(path))
        if not arguments.json:
            print(*told(one, steps), f"picture: {path}", "", sep="\n", flush=True)
    if not arguments.scenes and (missing := no_compiler(module("single_pendulum"))):
        print(f"where methods fail is left out: {missing}", file=sys.stderr)
    elif not arguments.scenes:
        for study in studies():
            with Progress() as report:
                report(f"where methods fail: {study.name}")
                results = study.run(module)
            path = arguments.output / f"failures_{study.name}.png"  # scenes have names, too
            save(study.plot(results), path)
            found["failures"][study.name] = results
            found["pictures"].append(str(path))
            if not arguments.json:
                print(*study.summary(results), f"picture: {path}", "", sep="\n", flush=True)
    if arguments.json:
        print(json.dumps(jsonable(found), indent=2))
    return 0


def scene_steps(one: Scene, tell: Callable[[str], None] = lambda _: None) -> list[CriticalStep]:
    """Every method's critical step in small motion with a scene's parameters."""
    found = []
    for method in names():
        tell(f"{one.name}: {method}")
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
    t = np.linspace(0, one.duration, LOOKS)
    motion = integrate(module, (0, one.duration), one.y0, params, t_eval=t)
    return regions(
        f"|R(hλ)| ≤ 1, small motions (dots) and the motion (grey) of {one.title}",
        steps, Modes.at_rest(module, params).frequencies,
        local_eigenvalues(module, params, motion.y.T).ravel(),
    )  # fmt: skip
