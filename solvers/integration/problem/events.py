"""Events: a component of the state crosses a value, or a function changes its sign."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from solvers.equations.forms import Form
from solvers.equations.module import GeneratedModule
from solvers.equations.number_checks import REAL, real_number
from solvers.equations.signature_checks import checked
from solvers.io.argument_types import check_direction
from solvers.io.suggestion import did_you_mean, shortened
from solvers.runge_kutta.stepper import Array, NotFiniteError


@checked
@dataclass(frozen=True)
class Event:
    """A coordinate or velocity crosses a value; angles count whole turns, so that π is not -π.

    Parameters
    ----------
    module : module
        The generated module.
    name : str
        One of ``module.STATE``.
    value : float
        In the unit of that component, ``module.UNITS[name]``.
    direction : {0, 1, -1}, optional
        Crossings in both directions, upwards, or downwards.
    terminal : bool, optional
        Whether the integration ends there.

    Raises
    ------
    ValueError
        When there is no such component, or the value or direction is invalid.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> flip = Event(dp, "theta2", 3.14159, terminal=True)
    >>> round(flip(0.0, [0.0, 3.0, 0.0, 0.0]), 5)
    -0.14159
    """

    module: GeneratedModule
    name: str
    value: float
    direction: int = 0
    terminal: bool = False

    def __post_init__(self) -> None:
        if self.name not in self.module.STATE:
            hint = did_you_mean(str(self.name), self.module.STATE)
            known = ", ".join(self.module.STATE)
            raise ValueError(f"no component is called {self.name!r}{hint}; known names: {known}")
        real_number(f"value of {self.name}", self.value, self.module.UNITS[self.name])
        check_direction("direction", self.direction)
        if not isinstance(self.terminal, bool | np.bool_):
            raise ValueError(f"terminal = {self.terminal!r} must be True or False")

    @property
    def components(self) -> tuple[str, ...]:
        """Components of the state that it needs."""
        return (self.name,)

    def __call__(self, t: float, y: Sequence[float] | NDArray[np.float64]) -> float:
        """The component minus the value."""
        return float(y[self.module.STATE.index(self.name)]) - self.value


@checked
@dataclass(frozen=True)
class Extremum(Event):
    """A velocity vanishes; the occurrences where its coordinate is extreme are stored.

    An ensemble stores two occurrences, with the smallest and the largest value; an integration of
    one motion stores all.

    Parameters
    ----------
    name : str
        A velocity, such as ``theta1_dot``.
    module, value, direction, terminal
        As in `Event`; a velocity vanishes at 0.

    Raises
    ------
    ValueError
        When it is not a velocity.

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> from solvers import integrate
    >>> event = Extremum(sp, "theta_dot", direction=-1)
    >>> solution = integrate(sp, (0, 5), (0.5, 0.0), sp.DEFAULTS, events=event)
    >>> solution.y_events[0].shape
    (1, 2)
    """

    value: float = 0.0

    def __post_init__(self) -> None:
        coordinates = self.module.COORDINATES
        if self.name.endswith("_dot_dot"):
            known = ", ".join(coordinates)
            raise ValueError(
                f"{self.coordinate} is not a coordinate: extremes are those of {known}"
            )
        super().__post_init__()
        if self.coordinate not in coordinates or self.coordinate == self.name:
            rates = ", ".join(self.module.STATE[len(coordinates) :])
            raise ValueError(f"{self.name} is not a velocity: extremes need one of {rates}")

    @property
    def coordinate(self) -> str:
        """The coordinate with the extremes."""
        return self.name.removesuffix("_dot")

    @property
    def components(self) -> tuple[str, ...]:
        """Components of the state that it needs."""
        return (self.name, self.coordinate)


@dataclass(frozen=True)
class Limit(Event):
    """A coordinate that must be positive falls to 0, which ends the motion."""

    value: float = 0.0
    direction: int = -1
    terminal: bool = True


class UserEvent:
    """A user's function as an event, called `name`, whose values must be finite numbers."""

    def __init__(self, name: str, function: Callable[..., Any]) -> None:
        self._name = f"{name} ({getattr(function, '__name__', shortened(function))})"
        self._function = function
        check_direction(f"direction of {self._name}", self.direction)
        if self.terminal not in (True, False):
            raise ValueError(f"terminal of {self._name} = {self.terminal!r} must be True or False")

    @property
    def direction(self) -> Any:
        """As that of `Event`."""
        return getattr(self._function, "direction", 0)

    @property
    def terminal(self) -> Any:
        """As that of `Event`."""
        return getattr(self._function, "terminal", False)

    def __call__(self, t: float, y: NDArray[np.float64]) -> float:
        """The value of the function."""
        value = self._function(t, y)
        if type(value) in REAL and isfinite(value):
            return float(value)  # at once, since events are called often
        return real_number(f"the value of {self._name} at t = {t}", value)


#: Stands for a switching function that is 0, with the sign that is held.
TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True)
class SwitchEvent:
    """An event that ends a step: a switching function changes its sign, or does not stay 0."""

    form: Form  # Lagrange's, with the signs that are held
    index: int
    level: float  # the value that counts as 0, up to rounding errors
    terminal: ClassVar[bool] = True

    def __call__(self, t: float, y: Array) -> float:
        """The switching function at an ordinary state, or 1 - s² of one that stays 0."""
        value = self.value(t, y) - self.level
        return value or TINY * (self.form.signs[self.index] or 1.0)

    def value(self, t: float, y: Array) -> float:
        """The same without the level."""
        k, state = self.index, y[: len(self.form.state)]
        try:
            if self.form.signs[k]:
                return float(self.form.values(t, state)[k])
            return float(1 - self.form.switching(t, state).signs[k] ** 2)
        except ArithmeticError as error:
            raise NotFiniteError(f"a switching function at t = {t}: {error}") from error
