"""The ladder of models: the smallest that is good enough is taken."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from solvers.equations.module import GeneratedModule, depends_on_time, has_function
from solvers.scenes.models.equilibrium import rest
from solvers.scenes.models.full_equations import NotAccurateError, full, series
from solvers.scenes.models.light_masses import light
from solvers.scenes.models.method_choice import SERIES, MethodChoice, cheapest, usual_form
from solvers.scenes.models.model import Model, Motion, OutsideDomainError
from solvers.scenes.models.normal_modes import small
from solvers.scenes.models.pendulum import pendulum
from solvers.scenes.models.quadrature import quadrature
from solvers.scenes.scene import Scene

#: Errors above this say nothing any more.
USELESS = 1e3
#: From the smallest model on, those that integrate nothing.
RUNGS: dict[str, Callable[[Motion], Model]] = {
    "rest": rest,
    "normal modes": small,
    "pendulum": pendulum,
    "pendulum and light masses": light,
    "quadrature": quadrature,
}


@dataclass(frozen=True)
class ModelSelection:
    """The model that was taken, and why no smaller one.

    Attributes
    ----------
    model : Model
        What was taken.
    declined : dict of str to str
        Smaller models, and what was wrong with each.
    """

    model: Model
    declined: dict[str, str]


def select_model(
    scene: Scene, code: Callable[[Motion, MethodChoice], Motion], report: Callable[[str], None]
) -> ModelSelection:
    """The smallest model whose error stays below what is asked.

    Parameters
    ----------
    scene : Scene
        What is asked.
    code : callable
        Takes a motion and a choice to integrate it; returns the motion with the module to
        integrate it with, which may be specialised.
    report : callable
        Called with the progress.

    Returns
    -------
    ModelSelection
        One of `RUNGS` that the scene names is taken whatever its error.

    Raises
    ------
    solvers.scenes.models.full_equations.NotAccurateError
        When not even the full equations come as close as asked.
    solvers.scenes.models.full_equations.TooLongError
        When they take longer than anybody waits for.
    solvers.scenes.models.model.OutsideDomainError
        When the model that the scene names says nothing about its motion, or nothing that is
        asked for moves mass; when there are no full equations, since a coordinate moves none.
    """
    asked = motion_of(scene)
    declined: dict[str, str] = {}
    if scene.model in RUNGS:
        if obstacle := _obstacle(scene.module, scene.model):
            raise OutsideDomainError(obstacle)
        with np.errstate(all="ignore"):
            return ModelSelection(RUNGS[scene.model](asked), {})
    if not scene.is_fixed:
        for name, rung in RUNGS.items():
            if obstacle := _obstacle(scene.module, name):
                declined[name] = obstacle
                continue
            report(name)
            try:
                with np.errstate(all="ignore"):
                    model = rung(asked)
            except OutsideDomainError as reason:
                declined[name] = str(reason)
                continue
            except (ArithmeticError, np.linalg.LinAlgError) as reason:
                declined[name] = f"its numbers are not finite: {reason}"
                continue
            if model.error_estimate <= scene.accuracy:
                return ModelSelection(model, declined)
            declined[name] = (
                f"its error may reach {model.error_estimate:.1g}"
                if model.error_estimate < USELESS
                else "the motion leaves its domain"
            )
    asked.require_mass()
    choice = _method_choice(scene)
    report(f"full equations by {choice.method}")
    try:
        return ModelSelection(
            full(code(asked, choice), scene.accuracy, choice, asked, scene.step), declined
        )
    except NotAccurateError as reason:
        if scene.method or scene.form:
            raise
        declined["ordinary numbers"] = str(reason)
    report("full equations by Taylor series")
    form = usual_form(scene.module, SERIES)
    choice = MethodChoice(SERIES, form, "the motion loses more digits than ordinary numbers have")
    return ModelSelection(series(asked, scene.accuracy, choice, scene.times), declined)


def _obstacle(module: GeneratedModule, rung: str) -> str:
    """Why a rung says nothing about a system, whatever its motion; empty if it may."""
    if depends_on_time(module):
        return "the equations depend on time"
    if has_function(module, "power") and rung != "rest":
        return "energy is not kept"
    if not has_function(module, "linear") and rung != "rest":
        return "small motions are not those of masses and springs"
    return ""


def motion_of(scene: Scene) -> Motion:
    """The motion of a scene, and what is wanted of it that exists."""
    asked = Motion(scene.module, scene.params, scene.y0, scene.duration, scene.wanted)
    wanted = tuple(k for k in scene.wanted if k % asked.coordinates in asked.alive)
    if not wanted:
        raise OutsideDomainError("nothing that is asked for moves mass")
    return replace(asked, wanted=wanted)


def _method_choice(scene: Scene) -> MethodChoice:
    """The choice that the scene names, and the cheapest where it does not."""
    found = cheapest(scene.module, scene.params, scene.accuracy)
    if scene.method is None and scene.form is None:
        return found
    method = scene.method or found.method
    form = scene.form or usual_form(scene.module, method)
    return MethodChoice(method, form, "named in the scene")
