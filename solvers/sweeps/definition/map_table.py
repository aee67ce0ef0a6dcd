"""The table of a map in a sweep file."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from solvers.equations.module import GeneratedModule
from solvers.io import toml_input
from solvers.io.quantity import QuantityError, quantity
from solvers.io.suggestion import did_you_mean, shortened
from solvers.io.toml_input import InputError

#: Largest number of values of one motion.
MAX_COUNT = 10**6


@dataclass(frozen=True)
class MapTable:
    """Values of a map's table by key; methods raise `InputError` for invalid ones."""

    path: str  # name of the table in the file, such as maps.flip
    module: GeneratedModule
    table: Mapping[str, Any]

    def components(self, key: str) -> tuple[str, ...]:
        """Different components of the state."""
        state = self.module.STATE
        names = toml_input.texts(f"{self.path}.{key}", as_list(self.table.get(key, [])), len(state))
        if not names or len({*names}) < len(names):
            raise InputError(f"{self.path}.{key} = {list(names)} must list different components")
        for name in names:
            if name not in state:
                word, known = f"{name[:50]!r}{did_you_mean(name, state)}", ", ".join(state)
                raise InputError(f"{self.path}.{key}: unknown component {word}; known are {known}")
        return names

    def count(self, key: str, default: int | None = None) -> int:
        """A number of values, 1 or more, or the default or more."""
        least, value = 1 if default is None else default, self.table.get(key, default)
        return toml_input.whole(f"{self.path}.{key}", value, least, MAX_COUNT)

    def period(self, key: str) -> str | float:
        """A time in s, or a formula of parameters, which is returned as it is."""
        value, path = self.table.get(key), f"{self.path}.{key}"
        if value is None:
            raise InputError(f'{path} is missing: give a period such as "2*pi/Omega" or "0.5 s"')
        try:
            return quantity(value, "s")
        except QuantityError as error:
            if not isinstance(value, str):
                raise InputError(f"{path}: {error}") from error
            return toml_input.text(path, value)  # checked with the sweep

    def number(self, key: str, unit: str, default: float) -> float:
        """A number in a unit."""
        return toml_input.number(f"{self.path}.{key}", self.table.get(key, default), unit)

    def choice(self, key: str, options: Sequence[str], default: str | None = None) -> str:
        """One of some words."""
        word = self.table.get(key, default)
        if not isinstance(word, str) or word not in options:
            known = ", ".join(options)
            raise InputError(f"{self.path}.{key} = {shortened(word)} must be one of {known}")
        return word

    def values_by_component(self, key: str) -> dict[str, tuple[float, ...]]:
        """Some values of each of some components of the state."""
        path = f"{self.path}.{key}"
        given = toml_input.table(path, self.table.get(key, {}))
        toml_input.check_keys(path, given, self.module.STATE)
        return {
            name: tuple(self._quantity(path, name, value) for value in as_list(values))
            for name, values in given.items()
        }

    def positions(self, key: str) -> tuple[dict[str, float], ...]:
        """Positions, by coordinate."""
        path, positions = f"{self.path}.{key}", []
        if key in self.table and not self.table[key]:
            raise InputError(f"{path} = {self.table[key]} must list positions, or be left out")
        for given in as_list(self.table.get(key, [])):
            toml_input.check_keys(path, toml_input.table(path, given), self.module.COORDINATES)
            positions.append({q: self._quantity(path, q, value) for q, value in given.items()})
        return tuple(positions)

    def _quantity(self, path: str, name: str, value: object) -> float:
        return toml_input.number(f"{path}.{name}", value, self.module.UNITS[name])


def as_list(value: object) -> list[Any]:
    """A list, or one value as a list."""
    return value if isinstance(value, list) else [value]
