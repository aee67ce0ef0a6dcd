"""Times of first events."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np

from solvers.equations.module import GeneratedModule
from solvers.equations.signature_checks import checked
from solvers.integration.problem.events import Event
from solvers.io.argument_types import check_type
from solvers.sweeps.barrier import lower_position
from solvers.sweeps.definition.axes import Array, Axes
from solvers.sweeps.definition.map_table import MapTable
from solvers.sweeps.maps import Map, Motions


@checked
@dataclass(frozen=True)
class First(Map):
    """Time in s at which one of the components `of` first crosses one of its values.

    Motions with less energy than every position at rest of a `barrier` are not integrated.

    Parameters
    ----------
    of : mapping of str to tuple of float
        Values by component.
    barrier : tuple of mapping of str to float
        Positions at rest that include the lowest with a crossing; coordinates that are not
        named are 0. It excludes motions only if the sweep has no other map.

    Examples
    --------
    >>> First({"theta1": (-3.14159, 3.14159)}).unit(None)
    's'
    """

    of: Mapping[str, tuple[float, ...]]
    barrier: tuple[Mapping[str, float], ...] = ()

    example = 'of = { theta1 = ["-180 deg", "180 deg"] }, barrier = [{ theta1 = "180 deg" }]'
    quantity = "time"
    own_unit = "s"
    colour_map = "viridis_r"
    is_logarithmic = True
    ends_motion = True

    @classmethod
    def read(cls, table: MapTable) -> Self:
        return cls(table.values_by_component("of"), table.positions("barrier"))

    @property
    def components(self) -> tuple[str, ...]:
        return (*self.of, *(name for position in self.barrier for name in position))

    def events(self, module: GeneratedModule) -> list[Event]:
        return [Event(module, name, value) for name, values in self.of.items() for value in values]

    def check(self, module: GeneratedModule, axes: Axes, values: Mapping[str, float | str]) -> None:
        check_type("of", self.of, Mapping, "a mapping of names to numbers")
        super().check(module, axes, values)
        if not any(self.of.values()):
            raise ValueError("`of` is empty; give values by component")
        if not self.barrier:
            return
        for name in self.of:
            if name not in module.COORDINATES:
                raise ValueError(f"with a barrier only coordinates can be watched, not {name}")
        varied = [name for name in axes.smallest if name in module.PARAMETERS]
        if varied:
            raise ValueError(
                f"{varied[0]} varies and the lowest position depends on it, so that a barrier "
                "proves nothing; remove one of them"
            )
        defaults = zip(module.PARAMETERS, module.DEFAULTS, strict=True)
        params = [float(values.get(name, default)) for name, default in defaults]
        if lower := lower_position(module, self.of, self.barrier, params):
            position = ", ".join(f"{q} = {value:.6g}" for q, value in lower.items())
            raise ValueError(
                f"the barrier is too high: the energy is lower at {position}; add this position"
            )

    def values(self, motions: Motions) -> Array:
        times = motions.ensemble.t_events[:, motions.events, 0]
        first = np.where(np.isnan(times), np.inf, times).min(axis=1, initial=np.inf)
        return np.where(np.isinf(first), np.nan, first)
