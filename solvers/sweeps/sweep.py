"""The definition of a sweep: many motions of one system, and maps of them."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from math import prod
from pathlib import Path
from typing import Any

from solvers.equations.forms import fastest_form
from solvers.equations.module import GeneratedModule, header, state_names
from solvers.integration import validation
from solvers.integration.problem import Options
from solvers.runge_kutta.catalogue import load, names
from solvers.sweeps import checks
from solvers.sweeps.axes import Axes
from solvers.sweeps.maps import Map


@dataclass(frozen=True)
class Sweep:
    """A system, the quantities that vary from motion to motion, and the maps to compute.

    Parameters
    ----------
    module : module
        The generated equations of the system.
    axes : Grid, Table or Random
        Quantities that vary.
    maps : mapping of str to Map
        Maps by name.
    duration : float
        Duration of each motion in s.
    values : mapping of str to float or str, optional
        Quantities that do not vary: coordinates, velocities, parameters and energy, in their
        units. Velocities that are not named are 0, parameters have their default. One velocity
        may be ``"energy"``: it is 0 or more and follows from the energy.
    method : str, optional
        One of ``solvers.runge_kutta.catalogue.names()`` that estimates its error.
    rtol, atol : float, optional
        Tolerances of each step, as in `solvers.integration.ensemble.ensemble`.
    max_steps : int, optional
        Largest number of steps of a motion.
    name, title : str, optional
        Name for files, and title for people.

    Raises
    ------
    ValueError
        When an argument is invalid; the message states the allowed values.
    solvers.runge_kutta.catalogue.UnknownMethodError
        When no method has this name.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> from solvers import Extremes, Grid, Sweep
    >>> axes = Grid({"theta1": [0.1, 0.2, 0.3], "theta2": [0.0, 0.1]})
    >>> Sweep(dp, axes, {"reach": Extremes(("theta2",))}, duration=5).motions
    6
    """

    module: GeneratedModule
    axes: Axes
    maps: Mapping[str, Map]
    duration: float
    values: Mapping[str, float | str] = field(default_factory=dict)
    method: str = "verner87"
    rtol: float = 1e-9
    atol: float = 1e-12
    max_steps: int = 1_000_000
    name: str = "sweep"
    title: str = "a sweep"

    def __post_init__(self) -> None:
        validation.check_positive(duration=self.duration)
        if not load(self.method).b_hat:
            able = ", ".join(name for name in names() if load(name).b_hat)
            raise ValueError(
                f"method = {self.method!r} does not estimate its error: use one of {able}"
            )
        checks.check_names(self.module, self.axes, self.values)
        checks.check_energy(self.module, (*self.axes.smallest, *self.values), self.values)
        checks.check_maps(self.module, self.axes, self.maps, self.values)
        limit, (rtol, atol) = self.max_steps, (self.rtol, self.atol)
        options = Options(self.method, self.form, rtol, atol, max_steps=limit)
        validation.problem_at_rest(self.module, (0.0, self.duration), options)

    @property
    def form(self) -> str:
        """The form of the equations; variational where a map needs it."""
        if any(one.is_variational for one in self.maps.values()):
            return "variational"
        return fastest_form(self.module)

    @property
    def state(self) -> tuple[str, ...]:
        """Names of the components of an initial state."""
        return state_names(self.module, self.form)

    @property
    def samples(self) -> int:
        """Number of evenly spaced times at which states are stored, both ends included."""
        return max(one.sample_count for one in self.maps.values())

    @property
    def options(self) -> dict[str, Any]:
        """Options of `solvers.integration.ensemble.ensemble`."""
        return {"method": self.method, "form": self.form, **self._limits}

    @property
    def _limits(self) -> dict[str, Any]:
        return {"rtol": self.rtol, "atol": self.atol, "max_steps": self.max_steps}

    @property
    def motions(self) -> int:
        """Number of motions."""
        return prod(self.axes.shape)

    @property
    def as_json(self) -> dict[str, Any]:
        """All that determines the results, as JSON values."""
        generated = header(self.module) or Path(str(self.module.__file__))
        return {
            "system": self.module.SYSTEM,
            "equations": hashlib.sha256(generated.read_bytes()).hexdigest(),
            "duration": self.duration,
            "values": dict(sorted(self.values.items())),
            "method": self.method,
            **self._limits,
            "axes": self.axes.as_json,
            "maps": {
                name: {"kind": type(one).__name__} | asdict(one)  # type: ignore[call-overload]
                for name, one in self.maps.items()
            },
        }
