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
from solvers.scenes.models.method_choice import Way, cheapest
from solvers.scenes.models.model import Asked
from solvers.scenes.models.selection import Choice, asked_of, choice
from solvers.scenes.scene import ENERGY, Scene

Array = NDArray[np.float64]

#: Takes a module, parameters and a way; gives the module with these parameters folded in.
Specialiser = Callable[[GeneratedModule, tuple[float, ...], Way], GeneratedModule]


@dataclass(frozen=True)
class Answer:
    """What a scene asked, answered.

    Attributes
    ----------
    scene : Scene
        What was asked.
    choice : Choice
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
    """

    scene: Scene
    choice: Choice
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
        model = self.choice.model
        return model.way.method if isinstance(model, Full) else None

    @property
    def form(self) -> str | None:
        """In which form of the equations."""
        model = self.choice.model
        return model.way.form if isinstance(model, Full) else None

    @property
    def final_state(self) -> dict[str, float]:
        """What was asked for of the state at the end, by name."""
        state = dict(zip(self.scene.module.STATE, self.y[:, -1].tolist(), strict=True))
        return {k: v for k, v in state.items() if k in self.scene.outputs and np.isfinite(v)}

    @property
    def is_met(self) -> bool:
        """Whether the error stays below what was asked."""
        return self.choice.model.error_estimate <= self.scene.accuracy


def answer(
    scene: Scene, specialiser: Specialiser | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> Answer:  # fmt: skip
    """The smallest model of a scene that is good enough, and its motion.

    Parameters
    ----------
    scene : Scene
        What is asked.
    specialiser : callable, optional
        ``specialiser(module, params, way)`` gives the module with these parameters folded in;
        needed where ``scene.code`` is ``"specialised"``.
    tell : callable, optional
        ``tell(text)`` is told what is going on.

    Returns
    -------
    Answer
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
    >>> found = answer(Scene(sp, sp.DEFAULTS, (0.001, 0.0), 10.0, accuracy=1e-6))
    >>> found.choice.model.name
    'normal modes'
    >>> found.is_met
    True
    """

    def code(asked: Asked, way: Way) -> Asked:
        if scene.code != "specialised":
            return asked
        if specialiser is None:
            raise ValueError("code = 'specialised' needs a specialiser, which generates it")
        tell("specialised code")
        return replace(asked, module=specialiser(asked.module, asked.params, way), params=())

    before = perf_counter()
    chosen = choice(scene, code, tell)
    choosing = perf_counter() - before
    tell(chosen.model.name)
    t = scene.times
    y = chosen.model.states(t).T
    y[:, 0] = np.where(np.isfinite(y[:, 0]), scene.y0, np.nan)
    energy = energies(scene, t, y) if ENERGY in scene.outputs else None
    return Answer(
        scene, chosen, t, y, energy, choosing, _work(chosen, scene), _full(scene),
        _general(chosen, scene),
    )  # fmt: skip


def energies(scene: Scene, t: Array, y: Array) -> Array:
    """Energy in J along states of shape (state, samples); what does not exist has none."""
    states = np.nan_to_num(y)
    return np.asarray(scene.module.energy_many(t, states, scene.params))


def _work(chosen: Choice, scene: Scene) -> float:
    if isinstance(chosen.model, Full):
        return chosen.model.seconds()
    end = np.array([scene.duration])
    return median_seconds(lambda: chosen.model.states(end))


def _general(chosen: Choice, scene: Scene) -> float:
    if not isinstance(chosen.model, Full) or chosen.model.asked.module is scene.module:
        return nan
    return replace(chosen.model, asked=asked_of(scene)).seconds()


def _full(scene: Scene) -> float:
    way = cheapest(scene.module, scene.params, scene.accuracy)
    return way.seconds * scene.duration
