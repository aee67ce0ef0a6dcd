"""Map kinds: the numbers that a sweep stores for each motion. Every module here is one kind."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from solvers.equations.module import GeneratedModule, has_function
from solvers.integration.problem.events import Event
from solvers.integration.results.ensemble_solution import Ensemble
from solvers.io.argument_types import check_texts
from solvers.io.suggestion import did_you_mean
from solvers.sweeps.definition.axes import Array, Axes
from solvers.sweeps.definition.map_table import MapTable
from solvers.sweeps.definition.sampling import Sampling


@dataclass(frozen=True)
class Motions:
    """Integrated motions as input of a map; `events` selects its own in the ensemble."""

    module: GeneratedModule
    begin: float  # time in s of the starts
    starts: Array  # states there, of shape (n, state)
    params: list[Array]
    ensemble: Ensemble
    events: slice
    rtol: float = 1e-9

    def indices(self, components: tuple[str, ...]) -> list[int]:
        """Indices of components of the state."""
        return [self.module.STATE.index(name) for name in components]


class Map:
    """One number for each motion; the base of all map kinds.

    A kind is a frozen dataclass in a module of this package. Its word in a sweep file is the
    module's name, with spaces for underscores; the keys of its table are the class's fields.
    """

    #: Keys of a table of this kind, as a sweep file of the double pendulum has them.
    example: ClassVar[str] = ""
    #: Name of the quantity, for labels; by default that of the component, or of the map.
    quantity: ClassVar[str] = ""
    #: Unit of the numbers; by default that of the components.
    own_unit: ClassVar[str] = ""
    #: Names of the dimensions of the numbers of one motion.
    dimensions: ClassVar[tuple[str, ...]] = ()
    #: A colour map of matplotlib's whose range includes 0; by default the signs of the values
    #: decide: diverging about 0 where both occur, else sequential.
    colour_map: ClassVar[str] = ""
    #: Kind of panels: ``numbers``, ``curves`` over time, or a ``section``.
    plot: ClassVar[str] = "numbers"
    #: Whether images show absolute values on a logarithmic scale.
    is_logarithmic: ClassVar[bool] = False
    #: Whether plots show angles modulo 2π.
    wraps_angles: ClassVar[bool] = False
    #: Whether a linear perturbation is integrated, too.
    is_variational: ClassVar[bool] = False
    #: Whether the first event of the map may end the motion.
    ends_motion: ClassVar[bool] = False
    #: Plural of the records that all motions share, such as ``attractors``; see `finish`.
    records: ClassVar[str] = ""
    #: Number of occurrences of each event that come first and are not stored.
    skip: int = 0
    #: Positions at rest: motions with less energy than the lowest have no event.
    barrier: tuple[Mapping[str, float], ...] = ()

    @classmethod
    def read(cls, table: MapTable) -> Self:
        """The map that a table of a sweep file specifies."""
        return cls()

    @property
    def labels(self) -> tuple[tuple[str, ...], ...]:
        """Labels along the leading dimensions; the others are numbered."""
        return ()

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the numbers of one motion."""
        return tuple(map(len, self.labels))

    def stored_shape(self, module: GeneratedModule) -> tuple[int, ...]:
        """Shape of the numbers that are stored of one motion; `finish` may change it."""
        return self.shape

    @property
    def components(self) -> tuple[str, ...]:
        """Components of the state that the map refers to."""
        return ()

    @property
    def sample_count(self) -> int:
        """Number of times at which states are stored; evenly spaced without a `sampling`."""
        return 0

    @property
    def sampling(self) -> Sampling | None:
        """Multiples of a period at which states are stored; the motion ends with the last."""
        return None

    @property
    def occurrences(self) -> int:
        """Number of occurrences of each event that are stored."""
        return 1

    @property
    def continued_along(self) -> str:
        """Axis along which each motion starts where its neighbour ended, or an empty text."""
        return ""

    @property
    def uses_energy(self) -> bool:
        """Whether the energy must be conserved."""
        return bool(self.barrier)

    def unit(self, module: GeneratedModule, component: str = "") -> str:
        """Unit of the numbers, or of those of one component; empty if they have different units."""
        if self.own_unit:
            return self.own_unit
        units = {module.UNITS[name] for name in ([component] if component else self.components)}
        return units.pop() if len(units) == 1 else ""

    def remark(self, module: GeneratedModule) -> str:
        """A remark below the figures of the map, if any."""
        return ""

    def events(self, module: GeneratedModule) -> list[Event]:
        """Events to locate."""
        return []

    def check(self, module: GeneratedModule, axes: Axes, values: Mapping[str, float | str]) -> None:
        """Check the map against its sweep."""
        for name in self.components:
            if name not in module.STATE:
                hint, known = did_you_mean(name, module.STATE), ", ".join(module.STATE)
                raise ValueError(f"unknown component {name[:50]!r}{hint}; known are {known}")
        self.events(module)
        if self.sampling:
            self.sampling.check(module)
        if self.uses_energy and has_function(module, "power"):
            raise ValueError(f"{module.SYSTEM} does not conserve its energy")

    def values(self, motions: Motions) -> Array:
        """The numbers, one entry of `stored_shape` for each motion; NaN where there are none."""
        raise NotImplementedError

    def finish(self, module: GeneratedModule, stored: Array) -> tuple[Array, list[dict[str, Any]]]:
        """The map of all motions, from their stored numbers, and records as JSON values.

        It is called only by kinds with `records`, after the last motion.
        """
        return stored, []


@dataclass(frozen=True)
class ComponentMap(Map):
    """Base of the kinds that store numbers for the components `of` of the state."""

    of: tuple[str, ...]

    dimensions: ClassVar[tuple[str, ...]] = ("component",)

    @classmethod
    def read(cls, table: MapTable) -> Self:
        return cls(table.components("of"))

    @property
    def labels(self) -> tuple[tuple[str, ...], ...]:
        return (self.of,)

    @property
    def components(self) -> tuple[str, ...]:
        return self.of

    def check(self, module: GeneratedModule, axes: Axes, values: Mapping[str, float | str]) -> None:
        check_texts("of", self.of)
        if not self.of:
            raise ValueError(f"`of` is empty; name some of {', '.join(module.STATE)}")
        super().check(module, axes, values)


@dataclass(frozen=True)
class CountedMap(ComponentMap):
    """Base of the kinds that store `count` values of each component."""

    count: int

    dimensions: ClassVar[tuple[str, ...]] = ("component", "number")

    @classmethod
    def read(cls, table: MapTable) -> Self:
        return cls(table.components("of"), table.count("count"))

    @property
    def shape(self) -> tuple[int, ...]:
        return (len(self.of), self.count)
