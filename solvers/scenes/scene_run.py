"""Run a scene: select a model, and compute the motion."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from math import nan
from time import perf_counter

import numpy as np

from solvers.equations.energy import supplied_energy
from solvers.equations.module import GeneratedModule, has_function
from solvers.integration.accuracy.checked_motion import Array, Motion
from solvers.integration.accuracy.method_choice import MethodChoice, cheapest
from solvers.io.quantity import with_unit
from solvers.player.playable import Playable
from solvers.player.sampled_motion import SampledMotion
from solvers.scenes.scene import ENERGY, Scene
from solvers.scenes.selection import ModelSelection, motion_of, select_model

#: Takes a module, parameters and a method choice; returns the module for these parameters alone.
Specialiser = Callable[[GeneratedModule, tuple[float, ...], MethodChoice], GeneratedModule]


@dataclass(frozen=True)
class SceneResult(Playable):
    """The motion of a scene, its model and its cost.

    Attributes
    ----------
    scene : Scene
        The scene.
    selection : ModelSelection
        The selected model, and the reasons against smaller ones.
    t : ndarray of shape (samples,)
        Times in s.
    y : ndarray of shape (state, samples)
        Coordinates and velocities; NaN for coordinates without inertia.
    energy : ndarray of shape (samples,) or None
        In J, if it is requested.
    selection_seconds, work_seconds : float
        Time of the selection, and of the state at the end with the selected model.
    full_equations_seconds : float
        Time of the full equations for this duration, by recorded measurements.
    general_code_seconds : float
        Time of general code where specialised code is used; NaN elsewhere.

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
    selection_seconds: float
    work_seconds: float
    full_equations_seconds: float
    general_code_seconds: float

    def __repr__(self) -> str:
        scene, model, units = self.scene, self.selection.model, self.scene.module.UNITS
        by = f" by {self.method}, {self.form} form" if self.method else ""
        values = [f"{name} = {with_unit(x, units[name])}" for name, x in self.final_state.items()]
        return (
            f"SceneResult: {scene.title}\n"
            f"  t = {self.t[0]:.6g} to {self.t[-1]:.6g} s, {len(self.t)} samples\n"
            f"  model: {model.name}{by}\n"
            f"  error estimate {model.error_estimate:.1e}, requested {scene.accuracy:.0e}\n"
            f"  final state: {', '.join(values) or 'not requested'}"
        )

    @property
    def method(self) -> str | None:
        """The method of integration; None for a closed form."""
        run = self.selection.model.run
        return run.method_choice.method if run else None

    @property
    def form(self) -> str | None:
        """The form of the equations; None for a closed form."""
        run = self.selection.model.run
        return run.method_choice.form if run else None

    @property
    def specialised_module(self) -> GeneratedModule | None:
        """The module that was generated for this scene alone; None for general code."""
        run = self.selection.model.run
        return run.motion.module if run and run.motion.module is not self.scene.module else None

    @property
    def final_state(self) -> dict[str, float]:
        """The requested components of the state at the end, by name."""
        state = dict(zip(self.scene.module.STATE, self.y[:, -1].tolist(), strict=True))
        return {k: v for k, v in state.items() if k in self.scene.outputs and np.isfinite(v)}

    @cached_property
    def supplied_energy(self) -> Array:
        """Energy in J from forces, friction and prescribed motions, shape (samples,)."""
        scene, model, t = self.scene, self.selection.model, self.t
        run = model.run if has_function(scene.module, "power") else None
        times = np.union1d(t, run.step_times()) if run else t
        energy = supplied_energy(scene.module, scene.params, times, model.states)
        return energy[np.searchsorted(times, t)]

    def sampled_motions(self) -> list[SampledMotion]:
        """The motion for pages, films and plots, with the model and its error in the note."""
        scene, model = self.scene, self.selection.model
        by = "" if self.method is None else f" by {self.method}"
        h = "" if scene.step is None else f" with h = {scene.step:g} s"
        start = f" Start {scene.completed}." if scene.completed else ""
        error = f"error estimate {model.error_estimate:.1g}"
        note = " ".join([*scene.note.split(), f"[{model.name}{by}{h}, {error}.{start}]"])
        energy = energies(scene, self.t, self.y) - self.supplied_energy
        return [
            SampledMotion(
                scene.module, scene.params, self.t, self.y, scene.title, scene.label, note,
                scene.pictures, energy,
            )
        ]  # fmt: skip

    @property
    def is_met(self) -> bool:
        """Whether the error estimate is below the requested accuracy."""
        return self.selection.model.error_estimate <= self.scene.accuracy


def run_scene(
    scene: Scene,
    specialiser: Specialiser | None = None,
    report: Callable[[str], None] = lambda _: None,
) -> SceneResult:
    """The motion of a scene by the smallest sufficient model.

    `NotAccurateError` where no model reaches the accuracy, `TooLongError` above the limit of steps,
    `OutsideDomainError` where no model applies, or the one that the scene names does not.
    """

    def specialise(motion: Motion, choice: MethodChoice) -> Motion:
        if scene.code != "specialised":
            return motion
        if specialiser is None:
            raise ValueError("code = 'specialised' needs a specialiser, which generates it")
        report("specialised code")
        return replace(motion, module=specialiser(motion.module, motion.params, choice), params=())

    before = perf_counter()
    selection = select_model(scene, specialise, report)
    selection_seconds = perf_counter() - before
    model, t = selection.model, scene.times
    report(model.name)
    y = model.states(t).T
    if t[0] == 0:
        y[:, 0] = np.where(np.isfinite(y[:, 0]), scene.y0, np.nan)
    energy = energies(scene, t, y) if ENERGY in scene.outputs else None
    full_seconds = cheapest(scene.module, scene.params, scene.accuracy).seconds * scene.duration
    costs = (selection_seconds, model.seconds(scene.duration), full_seconds, nan)
    result = SceneResult(scene, selection, t, y, energy, *costs)
    if result.specialised_module and model.run:
        general = replace(model.run, motion=motion_of(scene))
        return replace(result, general_code_seconds=general.seconds())
    return result


def energies(scene: Scene, t: Array, y: Array) -> Array:
    """Energy in J along states of shape (state, samples); NaN counts as 0."""
    states = np.nan_to_num(y)
    return np.asarray(scene.module.energy_many(t, states, scene.params))
