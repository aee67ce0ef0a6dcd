"""An event that compiled loops understand, too: a component of the state crosses a value."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule
from solvers.io.suggestion import did_you_mean


@dataclass(frozen=True)
class Event:
    """A coordinate or velocity crosses a value; angles are unwrapped, so that π is not -π.

    Parameters
    ----------
    module : module
        The generated module.
    name : str
        One of ``module.STATE``.
    value : float
        In the unit of that component, ``module.UNITS[name]``.
    direction : {0, 1, -1}, optional
        Both ways, only upwards, only downwards.
    terminal : bool, optional
        Whether the motion ends there.

    Raises
    ------
    ValueError
        When there is no such component, or a value or direction makes no sense.

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
            hint, known = (
                did_you_mean(str(self.name), self.module.STATE),
                ", ".join(self.module.STATE),
            )
            raise ValueError(f"no component is called {self.name!r}{hint}; known are: {known}")
        if isinstance(self.value, bool) or not _is_finite(self.value):
            raise ValueError(f"value = {self.value!r} of {self.name} must be a finite number")
        if self.direction not in (0, 1, -1):
            raise ValueError(f"direction = {self.direction!r} must be 0, 1 or -1")

    def __call__(self, t: float, y: Sequence[float] | NDArray[np.float64]) -> float:
        """By how much the component exceeds the value."""
        return float(y[self.module.STATE.index(self.name)]) - self.value


@dataclass(frozen=True)
class Extremum(Event):
    """A velocity vanishes; of all these places those are kept where its coordinate is extreme.

    Ensembles keep two occurrences, with the smallest and the largest value; an integration of
    one motion keeps all.

    Parameters
    ----------
    module : module
        The generated module.
    name : str
        A velocity, such as ``theta1_dot``.
    value, direction, terminal
        As in `Event`; a velocity vanishes at 0.

    Raises
    ------
    ValueError
        When it is no velocity.

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> from solvers import Extremum, integrate
    >>> motion = integrate(sp, (0, 5), (0.5, 0), sp.DEFAULTS, events=Extremum(sp, "theta_dot"))
    >>> round(float(motion.y_events[0][0][0]), 6)
    -0.5
    """

    value: float = 0.0

    def __post_init__(self) -> None:
        if self.name.endswith("_dot_dot"):
            raise ValueError(
                f"the extremes of {self.name.removesuffix('_dot')} are not known: extremes are "
                f"those of coordinates, {', '.join(self.module.COORDINATES)}"
            )
        super().__post_init__()
        if self.coordinate not in self.module.COORDINATES or self.coordinate == self.name:
            rates = ", ".join(self.module.STATE[len(self.module.COORDINATES) :])
            raise ValueError(f"{self.name} has no extremes that are known: name one of {rates}")

    @property
    def coordinate(self) -> str:
        """What has the extremes."""
        return self.name.removesuffix("_dot")


def _is_finite(value: object) -> bool:
    try:
        return isfinite(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return False
