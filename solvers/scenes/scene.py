"""A scene: a motion, its accuracy and its outputs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule, has_constraints
from solvers.equations.number_checks import positive
from solvers.equations.signature_checks import check_module, known_names
from solvers.equations.singularities import check_condition
from solvers.equations.starts.consistent_start import consistent_start, given_names
from solvers.equations.starts.default_start import default_coordinates, default_words
from solvers.integration.problem import validation
from solvers.io.argument_types import check_texts, check_type
from solvers.io.toml_input import whole
from solvers.player.sampled_motion import sample_times
from solvers.scenes import scene_checks

#: An output that is no component of the state.
ENERGY = "energy"


@known_names
@dataclass(frozen=True)
class Scene:
    """A motion, its accuracy and its outputs.

    Parameters
    ----------
    module : module
        The generated equations of its system.
    params : tuple of float, or mapping of str to float
        In the order of ``module.PARAMETERS``, or by name: parameters that are left out have their
        default values. A mass or length of 0 is absent.
    y0 : tuple of float, or mapping of str to float
        Initial coordinates and velocities, in the order of ``module.STATE``, or by name:
        velocities that are left out are 0. Of systems with constraints, also coordinates may be
        left out (`solvers.consistent_start`).
    duration : float
        In s.
    accuracy : float, optional
        Largest permitted error of any requested component at any time, in rad, rad/s, m, m/s.
    outputs : tuple of str, optional
        The requested outputs: components of the state, and ``energy``; by default the state.
    samples : int or sequence of float, optional
        Number of times, evenly spaced over the duration, both ends included; 0 for a hundred a
        second, at least 501 and at most 20,001. Or increasing times in s.
    model : str or None
        A key of `solvers.scenes.models.model_catalogue.load`; by default the smallest sufficient
        model.
    method, form : str or None
        A method of this package or of SciPy's ``solve_ivp``, and form of the equations,
        ``lagrangian``, ``hamiltonian`` or ``rational``; by default the cheapest.
    step : float or None
        A fixed step size in s instead of step control.
    code : {"general", "specialised"} or None
        Whether to integrate with code that contains the parameters as numbers; by default it is
        general.
    pictures : tuple of str, optional
        The pictures, each such as ``theta1, theta2 over t``, or ``path`` or ``energy``; by
        default no plot is written, and `figure` plots all.
    title, name : str, optional
        A title for plots, and a name for files.
    label : str, optional
        The label of this run beside others; by default the title.
    note : str, optional
        A text below the plots.
    beside : tuple of Scene, optional
        Scenes to show beside this one.
    guess : mapping of str to float, optional
        Values near which to find components of `y0` that constraints determine, by default 0.
    completed : str, optional
        A description of the coordinates that a mapping `y0` leaves out.

    Raises
    ------
    ValueError
        When an argument is not valid; the message states what is allowed.

    Warns
    -----
    solvers.equations.singularities.MassMatrixWarning
        When the mass matrix is nearly singular.

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> Scene(sp, sp.DEFAULTS, (0.1, 0.0), 10.0).times.shape
    (1001,)
    >>> Scene(sp, sp.DEFAULTS, (0.1,), 10.0)
    Traceback (most recent call last):
    ...
    ValueError: ...
    """

    module: GeneratedModule
    params: tuple[float, ...]
    y0: tuple[float, ...]
    duration: float
    accuracy: float = 1e-6
    outputs: tuple[str, ...] = ()
    samples: int | Sequence[float] = 0
    model: str | None = None
    method: str | None = None
    form: str | None = None
    step: float | None = None
    code: str | None = None
    pictures: tuple[str, ...] = ()
    title: str = "a scene"
    name: str = "scene"
    label: str = ""
    note: str = ""
    beside: tuple["Scene", ...] = ()
    guess: Mapping[str, float] = field(default_factory=dict)
    completed: str = ""

    def __post_init__(self) -> None:
        check_module(self.module)
        for name in ("model", "method", "form", "code", "title", "name", "label", "note"):
            check_type(name, getattr(self, name), str | None, "a text")
        for name in ("outputs", "pictures"):
            check_texts(name, getattr(self, name))
        state = self.module.STATE
        params = validation.parameters(self.module, self.params).tolist()
        completed: dict[str, object] = {
            "params": tuple(params),
            **self._start(params),
            "outputs": tuple(self.outputs) or state,
            "label": self.label or self.title,
        }
        for name, value in completed.items():
            object.__setattr__(self, name, value)
        for name in ("duration", "accuracy", *(["step"] if self.step is not None else [])):
            positive(name, getattr(self, name))
        scene_checks.check_accuracy(self.accuracy)
        scene_checks.check_masses(self.module, self.params, self.y0)
        check_condition(self.module, [("", self.params, self.y0)])
        scene_checks.check_method(self.module, self.method, self.form, self.step, self.duration)
        if self.model is not None:
            from solvers.scenes.models import model_catalogue

            scene_checks.check_choice("model", self.model, tuple(model_catalogue.load()))
        scene_checks.check_choice("code", self.code, ("general", "specialised"))
        if not isinstance(self.samples, int):
            samples = scene_checks.sample_times(self.samples, self.duration)
            object.__setattr__(self, "samples", samples)
        elif self.samples:
            whole("samples", self.samples, 2, scene_checks.MOST_SAMPLES)
        scene_checks.check_outputs(self.outputs, state, (*state, ENERGY))
        scene_checks.check_pictures(self.pictures, state)

    def _start(self, params: list[float]) -> dict[str, object]:
        """The initial state, and a description of the coordinates that are not given."""
        if not isinstance(self.y0, Mapping):  # it may have been completed before
            y0 = validation.initial_state(self.module, self.y0, params=params)
            return {"y0": tuple(y0.tolist())}
        if has_constraints(self.module):
            start = consistent_start(self.module, self.y0, params, guess=self.guess)
            return {"y0": tuple(start.y.tolist()), "guess": {}, "completed": start.words}
        state = validation.initial_state(self.module, self.y0, params=params)
        given = given_names(self.module, self.y0)
        own = default_coordinates(self.module, given, np.array(params))
        return {"y0": tuple(state.tolist()), "completed": default_words(self.module, own)}

    @property
    def times(self) -> NDArray[np.float64]:
        """Times of the samples, in s."""
        if not isinstance(self.samples, int):
            return np.array(self.samples)
        if self.samples:
            return np.linspace(0, self.duration, self.samples)
        return sample_times(0.0, self.duration)

    @property
    def requested(self) -> tuple[int, ...]:
        """Indices of the requested components of the state."""
        return tuple(k for k, name in enumerate(self.module.STATE) if name in self.outputs)

    @property
    def prescribes_integration(self) -> bool:
        """Whether it names a model or a method, so that no smaller model is considered."""
        return bool(self.model or self.method or self.form or self.step)
