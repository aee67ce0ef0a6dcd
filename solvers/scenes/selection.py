"""Selection of the smallest sufficient model."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from solvers.integration.accuracy.checked_motion import Motion, OutsideDomainError
from solvers.integration.accuracy.method_choice import MethodChoice, cheapest, usual_form
from solvers.integration.accuracy.sufficient_run import sufficient_run
from solvers.scenes.models.full_equations import FullEquations
from solvers.scenes.models.model_catalogue import ClosedForm, Model, closed_forms
from solvers.scenes.scene import Scene

#: An error estimate above this is not reported as a number.
USELESS = 1e3


@dataclass(frozen=True)
class ModelSelection:
    """The selected model, and the reason against each smaller one by its name."""

    model: Model
    declined: dict[str, str]


def select_model(
    scene: Scene,
    specialise: Callable[[Motion, MethodChoice], Motion],
    report: Callable[[str], None],
) -> ModelSelection:
    """The smallest sufficient model: the first whose error stays below the requested accuracy.

    A closed form that the scene names is selected whatever its error. `specialise` takes a motion
    and a method choice, and returns the motion with the module to integrate.
    """
    motion, models = motion_of(scene), closed_forms()
    if scene.model in models:
        return ModelSelection(_closed_form(models[scene.model], motion), {})
    declined: dict[str, str] = {}
    for name, model_class in models.items() if not scene.prescribes_integration else ():
        report(name)
        try:
            model = _closed_form(model_class, motion)
        except OutsideDomainError as error:
            declined[name] = str(error)
            continue
        except ArithmeticError as error:
            declined[name] = f"its numbers are not finite: {error}"
            continue
        except np.linalg.LinAlgError:  # the message is LAPACK's
            declined[name] = "its matrices are singular or not finite"
            continue
        if model.error_estimate <= scene.accuracy:
            return ModelSelection(model, declined)
        declined[name] = "the motion leaves its domain"
        if model.error_estimate < USELESS:
            declined[name] = f"its error may reach {model.error_estimate:.1g}"
    motion.require_inertia()
    choice = _method_choice(scene)
    specialised = specialise(motion, choice)
    run, reasons = sufficient_run(motion, choice, scene.accuracy, scene.times, report, specialised)
    return ModelSelection(FullEquations.of(run), declined | reasons)


def _closed_form(model: type[ClosedForm], motion: Motion) -> ClosedForm:
    if reason := model.not_applicable(motion.module):
        raise OutsideDomainError(reason)
    with np.errstate(all="ignore"):
        return model.of(motion)


def motion_of(scene: Scene) -> Motion:
    """The motion of a scene, without requested components that have no inertia."""
    times = tuple(scene.times.tolist())
    motion = Motion(scene.module, scene.params, scene.y0, scene.duration, scene.requested, times)
    n = motion.n_coordinates
    requested = tuple(k for k in scene.requested if k % n in motion.inertial)
    if not requested:
        raise OutsideDomainError("no requested component of the state has inertia")
    return replace(motion, requested=requested)


def _method_choice(scene: Scene) -> MethodChoice:
    """The method choice of the scene, completed by the cheapest."""
    choice = cheapest(scene.module, scene.params, scene.accuracy)
    if scene.method is None and scene.form is None:
        return choice
    method = scene.method or choice.method
    form = scene.form or usual_form(scene.module, method)
    why = "method or form named in the scene"
    return MethodChoice(method, form, why, step=scene.step, is_named=True)
