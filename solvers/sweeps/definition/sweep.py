"""The definition of a sweep: many motions of one system, and maps of them."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import lru_cache
from importlib import import_module
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from solvers.equations.forms import fastest_form
from solvers.equations.module import GeneratedModule, header
from solvers.equations.module_cache import cached_module
from solvers.equations.signature_checks import check_module
from solvers.equations.singularities import check_condition
from solvers.integration.problem import validation
from solvers.integration.problem.problem import Options
from solvers.io.argument_types import check_type
from solvers.runge_kutta.method_catalogue import load, names
from solvers.sweeps.definition import sweep_checks
from solvers.sweeps.definition.axes import Array, Axes
from solvers.sweeps.definition.sampling import Sampling
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
    duration : float, optional
        Duration of each motion in s; none where a map has a period `every`, which determines it.
    values : mapping of str to float or str, optional
        Quantities that do not vary: coordinates, velocities, parameters and energy, in their
        units. Velocities that are not named are 0, parameters have their default. One velocity
        may be ``"energy"``: it is 0 or more and follows from the energy.
    method : str, optional
        One of ``solvers.runge_kutta.method_catalogue.names()`` that estimates its error.
    rtol, atol : float, optional
        Tolerances of each step, as in `solvers.integration.ensemble.ensemble`. With the defaults
        half of the times of `flips` are within 1e-10 s, and 98 % within 1e-6 s.
    max_steps : int, optional
        Largest number of steps of a motion.
    skip : float, optional
        Time in s at the start of each motion that no map includes: a transient. The equations are
        integrated over it without perturbations and events.
    name, title : str, optional
        Name for files, and title for people.

    Raises
    ------
    ValueError
        When an argument is invalid; the message states the allowed values.
    solvers.runge_kutta.method_catalogue.UnknownMethodError
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
    duration: float | None = None
    values: Mapping[str, float | str] = field(default_factory=dict)
    method: str = "verner853"
    rtol: float = 5e-8
    atol: float = 5e-11
    max_steps: int = 1_000_000
    skip: float = 0.0
    name: str = "sweep"
    title: str = "a sweep"

    def __post_init__(self) -> None:
        check_module(self.module)
        check_type("axes", self.axes, Axes, "a Grid, Random or Table")
        check_type("maps", self.maps, Mapping, "a mapping of names to maps")
        check_type("values", self.values, Mapping, "a mapping of names to numbers")
        if not load(str(self.method)).estimates_error:
            able = ", ".join(name for name in names() if load(name).estimates_error)
            raise ValueError(
                f"method = {self.method!r} does not estimate its error: use one of {able}"
            )
        sweep_checks.check_names(self.module, self.axes, self.values)
        sweep_checks.check_energy(self.module, (*self.axes.smallest, *self.values), self.values)
        sweep_checks.check_maps(self.module, self.axes, self.maps, self.values)
        sweep_checks.check_duration(self.maps, self.duration, self.skip)
        validation.problem_at_rest(self.module, (0.0, 1.0), Options(**self.options))
        some = sweep_checks.examined_motions(self.module, self.axes, self.values)
        check_condition(self.module, some)
        for _, params, _ in sweep_checks.examined_motions(self.module, self.axes, self.values):
            self.times([np.array([value]) for value in params])  # periods must be positive

    def __getstate__(self) -> dict[str, Any]:
        """A module cannot be pickled: its source takes its place."""
        return {**vars(self), "module": _source(self.module)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state, module=_module(*state["module"]))

    def unchecked(self, **changes: Any) -> "Sweep":
        """A copy with other values of some fields, which are not checked."""
        copy = object.__new__(Sweep)
        vars(copy).update(vars(self), **changes)
        return copy

    @property
    def form(self) -> str:
        """The form of the equations: variational where a map needs it, or with a Jacobian."""
        if any(one.is_variational for one in self.maps.values()):
            return "variational"
        return fastest_form(self.module) if load(self.method).takes_any_form else "lagrangian"

    @property
    def samples(self) -> int:
        """Number of times at which states are stored."""
        return max(one.sample_count for one in self.maps.values())

    @property
    def sampling(self) -> Sampling | None:
        """Multiples of a period at which states are stored, if a map has any."""
        return next(filter(None, (one.sampling for one in self.maps.values())), None)

    def times(self, params: Sequence[Array]) -> tuple[Array, Array]:
        """Ends and sample times in s, in one row or a row for each set of parameters."""
        if self.sampling:
            times = self.sampling.times(self.module, params)
            return times[:, -1], times
        assert self.duration is not None
        samples = np.linspace(self.skip, self.duration, self.samples)
        return np.array([self.duration]), samples[np.newaxis]

    @property
    def continued_along(self) -> str:
        """The axis along which each motion starts where its neighbour ended, or an empty text."""
        (one, *_) = self.maps.values()
        return one.continued_along

    @property
    def branch_length(self) -> int:
        """Number of successive motions that depend on each other."""
        return self.axes.shape[-1] if self.continued_along else 1

    @property
    def extent(self) -> str:
        """Duration of each motion, in words."""
        if self.sampling:
            unit = f" of {self.sampling.every}" + " s" * (not isinstance(self.sampling.every, str))
            return f"{self.sampling.skip + self.sampling.count - 1} periods{unit}"
        return f"{self.duration:g} s"

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
    def ends_at_event(self) -> bool:
        """Whether motions end at their first event: nothing after it matters to the only map."""
        return len(self.maps) == 1 and all(one.ends_motion for one in self.maps.values())

    @property
    def barrier(self) -> tuple[Mapping[str, float], ...]:
        """Positions at rest; motions with less energy than the lowest are not integrated."""
        (one, *_) = self.maps.values()
        return one.barrier if self.ends_at_event else ()

    @property
    def dtype(self) -> np.dtype[np.void]:
        """The record that is stored for each motion; with what varies, unless on a grid."""
        columns = () if self.axes.is_grid else self.axes.smallest
        fields = [(name, "<f8", one.stored_shape(self.module)) for name, one in self.maps.items()]
        return np.dtype([("status", "i1"), *((name, "<f8") for name in columns), *fields])

    @property
    def as_json(self) -> dict[str, Any]:
        """All that determines the results, as JSON values."""
        generated = header(self.module) or Path(str(self.module.__file__))
        maps = {
            name: {"kind": type(one).__name__} | asdict(one)  # type: ignore[call-overload]
            for name, one in self.maps.items()
        }
        return {
            "system": self.module.SYSTEM,
            "equations": hashlib.sha256(generated.read_bytes()).hexdigest(),
            "duration": self.duration,
            "skip": self.skip,
            "values": dict(sorted(self.values.items())),
            "method": self.method,
            **self._limits,
            "axes": self.axes.as_json,
            "maps": maps,
        }


def _source(module: GeneratedModule) -> tuple[str, tuple[tuple[str, str], ...]]:
    """The name of a module that ships; else of the system, and names and texts of its files."""
    if module.__name__.startswith("generated."):
        return module.__name__, ()
    files = filter(None, (Path(str(module.__file__)), header(module)))
    return module.SYSTEM, tuple((path.name, path.read_text(encoding="utf-8")) for path in files)


@lru_cache
def _module(name: str, texts: tuple[tuple[str, str], ...]) -> GeneratedModule:
    """The module from this source; each process loads it once."""
    return cached_module(name, repr(texts), lambda: dict(texts)) if texts else import_module(name)
