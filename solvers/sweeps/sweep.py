"""A sweep: very many motions of one system, and what is kept of each."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from solvers.equations.forms import fastest_form
from solvers.equations.module import GeneratedModule, header
from solvers.integration import validation
from solvers.runge_kutta.catalogue import load, names
from solvers.sweeps import checks
from solvers.sweeps.axes import Axes, motions
from solvers.sweeps.map import Map
from solvers.sweeps.maps import Lyapunov, Samples


@dataclass(frozen=True)
class Sweep:
    """What moves, what varies from motion to motion, and what is kept of each.

    Parameters
    ----------
    module : module
        The generated equations of its system.
    axes : Grid, Table or Random
        What varies.
    maps : mapping of str to Map
        What is kept of each motion, by the name of the map.
    duration : float
        In s.
    values : mapping of str to float or str, optional
        What does not vary, of coordinates, velocities, parameters and energy, in their units.
        Velocities that are not named are 0, parameters have their default. One velocity may
        be ``"energy"``: it is 0 or more, and as large as the energy demands.
    method : str, optional
        One of ``solvers.runge_kutta.catalogue.names()`` that estimates its error.
    rtol, atol : float, optional
        Tolerances of each step, as in `solvers.integration.ensemble.ensemble`.
    max_steps : int, optional
        How many steps a motion may take.
    name, title : str, optional
        What to call it, for files and for people.

    Raises
    ------
    ValueError
        When something makes no sense; the message says what is allowed.
    solvers.runge_kutta.catalogue.UnknownMethodError
        When no method has this name.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> from solvers.sweeps.axes import Grid
    >>> from solvers.sweeps.maps import Extremes
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
        checks.check_energy(self.module, self.given, self.values)
        checks.check_maps(self.module, self.axes, self.maps, self.values)
        validation.problem(
            self.module, (0.0, self.duration), (0.0,) * len(self.start), self.module.DEFAULTS,
            self.method, self.form, self.rtol, self.atol, None, None, (), self.max_steps,
        )  # fmt: skip

    @property
    def given(self) -> tuple[str, ...]:
        """Names of what varies and what is given."""
        return (*self.axes.smallest, *self.values)

    @property
    def form(self) -> str:
        """The form of the equations: small changes are followed where a map needs them."""
        if any(isinstance(one, Lyapunov) for one in self.maps.values()):
            return "variational"
        return fastest_form(self.module)

    @property
    def start(self) -> tuple[str, ...]:
        """What the state outside is made of."""
        changes = [f"delta_{name}" for name in self.module.STATE]
        return (*self.module.STATE, *(changes if self.form == "variational" else ()))

    @property
    def samples(self) -> int:
        """At how many times motions are looked at, evenly, both ends included."""
        return max((m.count for m in self.maps.values() if type(m) is Samples), default=0)

    @property
    def motions(self) -> int:
        """How many there are."""
        return motions(self.axes)

    @property
    def asked(self) -> dict[str, Any]:
        """All that decides what its numbers are, as JSON knows it."""
        generated = header(self.module) or Path(str(self.module.__file__))
        return {
            "system": self.module.SYSTEM,
            "equations": hashlib.sha256(generated.read_bytes()).hexdigest(),
            "duration": self.duration,
            "values": dict(sorted(self.values.items())),
            "method": self.method,
            "rtol": self.rtol,
            "atol": self.atol,
            "max_steps": self.max_steps,
            "axes": self.axes.asked,
            "maps": {
                name: {"kind": type(one).__name__} | asdict(one)  # type: ignore[call-overload]
                for name, one in self.maps.items()
            },
        }
