"""A scene answered: which model, how it moves, and how sure that is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import nan
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule
from solvers.integration.timing import median_seconds
from solvers.scenes.models.full_equations import Full
from solvers.scenes.models.method_choice import MethodChoice, cheapest
from solvers.scenes.models.model import Motion
from solvers.scenes.models.selection import ModelSelection, motion_of, select_model
from solvers.scenes.scene import ENERGY, Scene

Array = NDArray[np.float64]

#: Takes a module, parameters and a choice; gives the module with these parameters folded in.
Specialiser = Callable[[GeneratedModule, tuple[float, ...], MethodChoice], GeneratedModule]


@dataclass(frozen=True)
class SceneResult:
    """What a scene asked, answered.

    Attributes
    ----------
    scene : Scene
        What was asked.
    selection : ModelSelection
        Which model was taken, and why no smaller one.
    t : ndarray of shape (samples,)
        Times in s.
    y : ndarray of shape (state, samples)
        Coordinates and velocities; NaN for those that do not exist.
    energy : ndarray of shape (samples,) or None
        In J, if it was asked for.
    choosing_seconds, work_seconds : float
        What it took to choose, and what the state at the end takes with the model.
    full_seconds : float
        What the full equations take for a motion of this length, by the record of charts.
    general_seconds : float
        What general code takes where specialised code was made; NaN elsewhere.

    Examples
    --------
    >>> from solvers import run_scene
    >>> result = run_scene("single")
    >>> result.t[-1], result.is_met
    (np.float64(10.0), True)
    """

    scene: Scene
    selection: ModelSelection
    t: Array
    y: Array
    energy: Array | None
    choosing_seconds: float
    work_seconds: float
    full_seconds: float
    general_seconds: float

    @property
    def method(self) -> str | None:
        """How it was integrated; None if nothing was."""
        model = self.selection.model
        return model.method_choice.method if isinstance(model, Full) else None

    @property
    def form(self) -> str | None:
        """In which form of the equations."""
        model = self.selection.model
        return model.method_choice.form if isinstance(model, Full) else None

    @property
    def final_state(self) -> dict[str, float]:
        """What was asked for of the state at the end, by name."""
        state = dict(zip(self.scene.module.STATE, self.y[:, -1].tolist(), strict=True))
        return {k: v for k, v in state.items() if k in self.scene.outputs and np.isfinite(v)}

    @property
    def is_met(self) -> bool:
        """Whether the error stays below what was asked."""
        return self.selection.model.error_estimate <= self.scene.accuracy


def run_scene(
    scene: Scene, specialiser: Specialiser | None = None,
    report: Callable[[str], None] = lambda _: None,
) -> SceneResult:  # fmt: skip
    """The smallest model of a scene that is good enough, and its motion.

    Parameters
    ----------
    scene : Scene
        What is asked.
    specialiser : callable, optional
        ``specialiser(module, params, choice)`` gives the module with these parameters folded in;
        needed where ``scene.code`` is ``"specialised"``.
    report : callable, optional
        ``report(text)`` is called with the progress.

    Returns
    -------
    SceneResult
        Its ``is_met`` says whether the error estimate stays below ``scene.accuracy``, which it
        need not where the scene names a model or a step.

    Raises
    ------
    solvers.scenes.models.full_equations.NotAccurateError
        When not even the full equations come as close as asked.
    solvers.scenes.models.full_equations.TooLongError
        When they take longer than anybody waits for.
    solvers.scenes.models.model.OutsideDomainError
        When there is no model, since a coordinate moves no mass; or when the model that the scene
        names says nothing about its motion.
    ValueError
        When the scene asks for special code and nobody makes any.

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> from solvers.scenes.scene import Scene
    >>> result = run_scene(Scene(sp, sp.DEFAULTS, (0.001, 0.0), 10.0, accuracy=1e-6))
    >>> result.selection.model.name
    'normal modes'
    >>> result.is_met
    True
    """

    def code(asked: Motion, choice: MethodChoice) -> Motion:
        if scene.code != "specialised":
            return asked
        if specialiser is None:
            raise ValueError("code = 'specialised' needs a specialiser, which generates it")
        report("specialised code")
        return replace(asked, module=specialiser(asked.module, asked.params, choice), params=())

    before = perf_counter()
    chosen = select_model(scene, code, report)
    choosing = perf_counter() - before
    report(chosen.model.name)
    t = scene.times
    y = chosen.model.states(t).T
    y[:, 0] = np.where(np.isfinite(y[:, 0]), scene.y0, np.nan)
    energy = energies(scene, t, y) if ENERGY in scene.outputs else None
    return SceneResult(
        scene, chosen, t, y, energy, choosing, _work(chosen, scene), _full(scene),
        _general(chosen, scene),
    )  # fmt: skip


def energies(scene: Scene, t: Array, y: Array) -> Array:
    """Energy in J along states of shape (state, samples); what does not exist has none."""
    states = np.nan_to_num(y)
    return np.asarray(scene.module.energy_many(t, states, scene.params))


def _work(chosen: ModelSelection, scene: Scene) -> float:
    if isinstance(chosen.model, Full):
        return chosen.model.seconds()
    end = np.array([scene.duration])
    return median_seconds(lambda: chosen.model.states(end))


def _general(chosen: ModelSelection, scene: Scene) -> float:
    if not isinstance(chosen.model, Full) or chosen.model.asked.module is scene.module:
        return nan
    return replace(chosen.model, asked=motion_of(scene)).seconds()


def _full(scene: Scene) -> float:
    choice = cheapest(scene.module, scene.params, scene.accuracy)
    return choice.seconds * scene.duration
