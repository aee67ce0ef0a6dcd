"""A scene: what moves, from where, for how long, and what is asked of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule
from solvers.integration import validation
from solvers.scenes import checks

#: Usual samples: so many a second, and at least and at most so many.
RATE, FEWEST, MOST = 100, 501, 20_001
#: What can be named instead of the smallest model that is good enough.
MODELS = (
    "full", "rest", "normal modes", "pendulum", "pendulum and light masses", "quadrature",
)  # fmt: skip
#: What else can be asked for, beside components of the state.
ENERGY = "energy"


@dataclass(frozen=True)
class Scene:
    """What is there, and what is asked.

    Parameters
    ----------
    module : module
        The generated equations of its system.
    params : tuple of float, or mapping of str to float
        In the order of ``module.PARAMETERS``, or by name: parameters that are left out have their
        default values. A mass or length of 0 is absent.
    y0 : tuple of float, or mapping of str to float
        Coordinates and velocities at time 0, in the order of ``module.STATE``, or by name:
        velocities that are left out are 0.
    duration : float
        In s.
    accuracy : float, optional
        How large the error of what is asked for may be at any time: in rad, rad/s, m, m/s.
    outputs : tuple of str, optional
        What is asked for: components of the state, and ``energy``; by default the state.
    samples : int, optional
        At how many times, evenly over the duration, both ends included; 0 for a hundred a
        second, within `FEWEST` and `MOST`.
    model : str or None
        One of `MODELS`; by default the smallest that is good enough.
    method, form : str or None
        Method of integration, one of those that ship or of SciPy's, and form of the
        equations, ``lagrangian``, ``hamiltonian`` or ``rational``; by default the cheapest.
    step : float or None
        A fixed step in s instead of one that is controlled.
    code : {"general", "specialised"} or None
        Whether to integrate with code in which the parameters are folded in; by default
        it is general.
    pictures : tuple of str, optional
        What to draw, each as ``theta1, theta2 over t``, or ``path`` or ``energy``; by
        default all that there is.
    title, name : str, optional
        What to call it, for people and for files.
    label : str, optional
        What to call this run beside others; by default its title.
    note : str, optional
        What it shows, and how sure that is.
    beside : tuple of Scene, optional
        What to show beside it.

    Raises
    ------
    ValueError
        When something makes no sense; the message says what is allowed.

    Warns
    -----
    solvers.scenes.checks.MassMatrixWarning
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
    samples: int = 0
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
    beside: tuple[Scene, ...] = ()

    def __post_init__(self) -> None:
        known = self.module.STATE
        params = validation.parameters(self.module, self.params)
        object.__setattr__(self, "params", tuple(params.tolist()))
        y0 = validation.initial_state(self.module, self.y0)
        object.__setattr__(self, "y0", tuple(y0.tolist()))
        object.__setattr__(self, "outputs", tuple(self.outputs) or known)
        object.__setattr__(self, "label", self.label or self.title)
        validation.check_positive(duration=self.duration, accuracy=self.accuracy, step=self.step)
        checks.check_accuracy(self.accuracy)
        checks.check_params(self.module, self.params)
        checks.check_masses(self.module, self.params, self.y0)
        checks.check_method(self.module, self.method, self.form, self.step, self.duration)
        checks.check_choice("model", self.model, MODELS)
        checks.check_choice("code", self.code, ("general", "specialised"))
        if self.samples:
            checks.check_samples(self.samples)
        checks.check_outputs(self.outputs, known, (*known, ENERGY))
        checks.check_pictures(self.pictures, known)

    @property
    def times(self) -> NDArray[np.float64]:
        """When the motion is looked at, in s."""
        usual = min(max(round(RATE * self.duration) + 1, FEWEST), MOST)
        return np.linspace(0, self.duration, self.samples or usual)

    @property
    def wanted(self) -> tuple[int, ...]:
        """Which components of the state are asked for."""
        return tuple(k for k, name in enumerate(self.module.STATE) if name in self.outputs)

    @property
    def is_fixed(self) -> bool:
        """Whether it says how to integrate, so that no smaller model will do."""
        return bool(self.model or self.method or self.form or self.step)
