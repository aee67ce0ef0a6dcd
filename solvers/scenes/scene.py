"""A scene: a motion, its accuracy and its outputs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from solvers.equations.consistent_start import (
    consistent_start,
    default_coordinates,
    default_words,
    given_names,
)
from solvers.equations.module import GeneratedModule, has_constraints, has_perturbation
from solvers.equations.number_checks import positive, real_numbers
from solvers.equations.signature_checks import check_module, known_names
from solvers.equations.singularities import check_condition
from solvers.integration.problem import validation
from solvers.integration.problem.validation import check_splitting
from solvers.io.argument_types import check_texts, check_type
from solvers.io.suggestion import did_you_mean
from solvers.io.toml_input import whole
from solvers.player.sampled_motion import curves_of, sample_times
from solvers.runge_kutta.method_catalogue import SCIPY, load

#: Most samples, and the finest accuracy.
MOST_SAMPLES, FINEST = 1_000_001, 1e-13


def check_masses(module: GeneratedModule, params: Sequence[float], y0: Sequence[float]) -> None:
    """Refuse a mass matrix that is not finite, or has no inertia at all."""
    M = np.array(module.mass_matrix(0.0, y0, params))
    if not np.isfinite(M).all():
        raise ValueError("the mass matrix is not finite: numbers are too large")
    if not M.any():
        raise ValueError("no coordinate has inertia")


def check_method(
    module: GeneratedModule, method: object, form: object, step: float | None, duration: float
) -> None:
    """Refuse a method, a form and a step that are unknown or exclude each other."""
    forms = [name for name in module.FORMS if not has_perturbation(name)]
    if form is not None and form not in forms:
        raise ValueError(f"form = {str(form)[:50]!r} must be one of {', '.join(forms)}")
    if step is not None and method is None:
        raise ValueError(f'step = {step} s needs a method: name one, such as method = "rk4"')
    if step is not None and step > duration:
        raise ValueError(f"step = {step} s is longer than the duration, {duration} s")
    if method is None or method in SCIPY:
        if method and step is not None:
            raise ValueError(f"method = {method!r} is SciPy's: it controls its steps")
        return
    if not isinstance(method, str):
        raise ValueError(f"method = {str(method)[:50]} must be text in quotes")
    if load(method).is_splitting:
        check_splitting(module, method, str(form or "lagrangian"))
    if load(method).needs_jacobian and form == "rational":
        raise ValueError(f"method = {method!r} needs a Jacobian: not form = 'rational'")


def check_pictures(pictures: Sequence[str], state: Sequence[str]) -> None:
    """Refuse pictures of quantities that do not exist."""
    known = ("t", *state)
    for picture in pictures:
        names, over = curves_of(picture)
        if picture not in ("path", "energy") and not {*names, over} <= set(known):
            forms = f"'path', 'energy' or such as '{state[0]} over t', of {', '.join(known)}"
            raise ValueError(f"pictures name {picture[:50]!r}: write {forms}")


def check_outputs(outputs: Sequence[str], state: Sequence[str], known: Sequence[str]) -> None:
    """Refuse outputs that do not exist, or that contain no component of the state."""
    for name in outputs:
        if name not in known:
            guess, names = did_you_mean(name, known), ", ".join(known)
            raise ValueError(f"outputs name {name[:50]!r}{guess}: known are {names}")
    if not set(outputs) & set(state):
        text = f"outputs = {list(outputs)} names no component of the state"
        raise ValueError(f"{text}: add one of {', '.join(state)}")


def check_accuracy(accuracy: float) -> None:
    """Refuse more digits than double precision has."""
    if accuracy < FINEST:
        raise ValueError(f"accuracy = {accuracy} is below {FINEST}, the limit of double precision")


def check_choice(name: str, value: object, allowed: Sequence[str]) -> None:
    """Refuse a value that is neither None nor one of the allowed words."""
    if value is not None and value not in allowed:
        words = " or ".join(map(repr, allowed))
        raise ValueError(f"{name} = {str(value)[:50]!r} must be {words}, or be left out")


def given_times(values: object, duration: float) -> tuple[float, ...]:
    """Increasing times in s of at least two samples, within the duration."""
    times = real_numbers("samples", values, "s")
    allowed = f"times in s that increase, two at least, from 0 to {duration:g} s"
    if times.ndim != 1 or not 2 <= len(times) <= MOST_SAMPLES:
        raise ValueError(f"samples has shape {times.shape}: give a number, or {allowed}")
    wrong = np.flatnonzero((times < 0) | (times > duration) | (np.diff(times, prepend=-1) <= 0))
    if wrong.size:
        raise ValueError(f"samples[{wrong[0]}] = {times[wrong[0]]:g} s: give {allowed}")
    return tuple(times.tolist())


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
        check_accuracy(self.accuracy)
        check_masses(self.module, self.params, self.y0)
        check_condition(self.module, [("", self.params, self.y0)])
        check_method(self.module, self.method, self.form, self.step, self.duration)
        if self.model is not None:
            from solvers.scenes.models import model_catalogue

            check_choice("model", self.model, tuple(model_catalogue.load()))
        check_choice("code", self.code, ("general", "specialised"))
        if not isinstance(self.samples, int):
            samples = given_times(self.samples, self.duration)
            object.__setattr__(self, "samples", samples)
        elif self.samples:
            whole("samples", self.samples, 2, MOST_SAMPLES)
        check_outputs(self.outputs, state, (*state, ENERGY))
        check_pictures(self.pictures, state)

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
