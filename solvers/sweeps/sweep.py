"""A sweep: very many motions of one system, and what is kept of each."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from math import isfinite
from pathlib import Path
from types import ModuleType
from typing import Any

from solvers import request
from solvers.catalogue import load
from solvers.native import header
from solvers.scenes.checks import check_positive, near
from solvers.sweeps.axes import Axes, motions
from solvers.sweeps.barrier import lower_place
from solvers.sweeps.maps import EnergyError, First, Lyapunov, Map, Samples

#: What may vary or be given beside coordinates, velocities and parameters.
ENERGY = "energy"
#: Instead of a velocity's value: so much as the energy leaves for it.
FROM_ENERGY = "energy"


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
    values : mapping of str to float
        What does not vary, of coordinates, velocities, parameters and energy, in their units.
        Velocities that are not named are 0, parameters have their default. One velocity may
        be ``"energy"``: it is positive, and as large as the energy demands.
    method : str
        One of ours.
    rtol, atol : float
        Tolerances of each step, as in `solvers.ensemble.ensemble`.
    max_steps : int
        How many steps a motion may take.
    name, title : str
        What to call it, for files and for people.

    Raises
    ------
    ValueError
        When something makes no sense; the message says what is allowed.
    solvers.catalogue.UnknownMethodError
        When no method has this name.
    """

    module: ModuleType
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
        check_positive(duration=self.duration)
        load(self.method)
        self._check_names()
        self._check_energy()
        self._check_maps()
        samples = {one.count for one in self.maps.values() if type(one) is Samples}
        if len(samples) > 1:
            raise ValueError(f"maps sample at {sorted(samples)} times: all must have as many")
        request.problem(
            self.module, (0.0, self.duration), (0.0,) * len(self.start), self.module.DEFAULTS,
            self.method, self.form, self.rtol, self.atol, None, None, (), self.max_steps,
        )  # fmt: skip

    def _check_names(self) -> None:
        module = self.module
        known = (*module.STATE, *module.PARAMETERS, ENERGY)
        varied = tuple(self.axes.columns(0, 1))
        for name in (*varied, *self.values):
            if name not in known:
                raise ValueError(
                    f"{name[:50]!r}{near(name, known)} cannot vary or be given: known are "
                    f"{', '.join(known)}"
                )
        for name in varied:
            if name in self.values:
                raise ValueError(f"{name} varies, and is given as {self.values[name]}: leave one")
        for name in module.COORDINATES:
            if name not in (*varied, *self.values):
                raise ValueError(f"{name} is missing: give its value, or let it vary")
        for name, value in self.values.items():
            if value != FROM_ENERGY and (isinstance(value, str) or not isfinite(value)):
                raise ValueError(f"{name} = {value!r} must be a finite number")
        for name, low in {**self.values, **self.axes.smallest}.items():
            if name in module.POSITIVE and not isinstance(low, str) and low <= 0:
                raise ValueError(f"{name} = {low} must be positive, in {module.UNITS[name]}")

    def _check_energy(self) -> None:
        free = [name for name, value in self.values.items() if value == FROM_ENERGY]
        rates = self.module.STATE[len(self.module.COORDINATES) :]
        if len(free) > 1 or not {*free} <= {*rates}:
            raise ValueError(
                f'{", ".join(free)} = "{FROM_ENERGY}": the energy sets one velocity, one of '
                f"{', '.join(rates)}"
            )
        if bool(free) != (ENERGY in self.given):
            raise ValueError(
                f'an energy and a velocity that it sets belong together: give energy, and "'
                f'{FROM_ENERGY}" as the value of one of {", ".join(rates)}'
            )

    def _check_maps(self) -> None:
        if not self.maps:
            raise ValueError("no maps: say what is to be kept of each motion")
        for name, one in self.maps.items():
            if not name.isidentifier() or name in ("status", *self.axes.columns(0, 1)):
                raise ValueError(
                    f"{name[:50]!r} cannot be a map's name: use letters, digits and _, and "
                    "neither 'status' nor what varies"
                )
            for component in one.components:
                if component not in self.module.STATE:
                    raise ValueError(
                        f"map {name} names {component[:50]!r}{near(component, self.module.STATE)}: "
                        f"known are {', '.join(self.module.STATE)}"
                    )
            one.events(self.module)
            keeps = isinstance(one, EnergyError) or (isinstance(one, First) and one.barrier)
            if keeps and hasattr(self.module, "power"):
                raise ValueError(f"map {name}: of this system the energy is not kept")
            if isinstance(one, First) and one.barrier:
                self._check_barrier(name, one)

    def _check_barrier(self, name: str, one: First) -> None:
        for watched in one.of:
            if watched not in self.module.COORDINATES:
                raise ValueError(f"map {name} has a barrier: then {watched} cannot be watched, for "
                                 "its value says nothing of the energy")  # fmt: skip
        columns, known = self.axes.columns(0, 1), zip(
            self.module.PARAMETERS, self.module.DEFAULTS, strict=True
        )  # fmt: skip
        values = {**dict(known), **self.values, **{k: v[0] for k, v in columns.items()}}
        params = [float(values[parameter]) for parameter in self.module.PARAMETERS]
        lower = lower_place(self.module, one.of, one.barrier, params)
        if lower:
            place = ", ".join(f"{q} = {value:.6g}" for q, value in lower.items())
            raise ValueError(
                f"map {name}: its barrier is too high, there is less energy at {place}; name that "
                "place, too"
            )

    @property
    def given(self) -> tuple[str, ...]:
        """Names of what varies and what is given."""
        return (*self.axes.columns(0, 1), *self.values)

    @property
    def form(self) -> str:
        """The form of the equations: small changes are followed where a map needs them."""
        if any(isinstance(one, Lyapunov) for one in self.maps.values()):
            return "variational"
        return "rational" if hasattr(self.module, "rhs_rational") else "lagrangian"

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
            "system": self.module.__name__.rpartition(".")[2],
            "equations": hashlib.sha256(generated.read_bytes()).hexdigest(),
            "duration": self.duration,
            "values": dict(sorted(self.values.items())),
            "method": self.method,
            "rtol": self.rtol,
            "atol": self.atol,
            "max_steps": self.max_steps,
            "axes": self.axes.asked,
            "maps": {
                name: {"kind": type(one).__name__, **_parts(one)} for name, one in self.maps.items()
            },
        }


def _parts(one: Any) -> dict[str, Any]:
    return asdict(one)
