"""What is done with every motion of a sweep, so small that it can travel.

It is names and numbers, and the text of a module that does not ship.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from pathlib import Path

import numpy as np

from solvers.equations.module import GeneratedModule, header
from solvers.equations.module_cache import cached_module
from solvers.integration.solution import Status
from solvers.sweeps.axes import Grid
from solvers.sweeps.map import Map
from solvers.sweeps.maps import First
from solvers.sweeps.sweep import Sweep

#: How a motion ended, by the number that stands in a map; the first is not done yet.
STATUSES = (
    "not done yet", *(status.name.lower().replace("_", " ") for status in Status), "proved",
    "no such energy",
)  # fmt: skip
CODES = {status: code for code, status in enumerate(Status, 1)}
PROVED, NO_SUCH_ENERGY = STATUSES.index("proved"), STATUSES.index("no such energy")


@dataclass(frozen=True)
class Source:
    """Where a worker finds a module: under its name, or as texts by file name."""

    name: str
    texts: tuple[tuple[str, str], ...] = ()

    @classmethod
    def of(cls, module: GeneratedModule) -> Source:
        """The source of a module that is loaded here."""
        if module.__name__.startswith("generated."):
            return cls(module.__name__)
        files = filter(None, (Path(str(module.__file__)), header(module)))
        texts = tuple((path.name, path.read_text(encoding="utf-8")) for path in files)
        return cls(module.SYSTEM, texts)


@lru_cache
def loaded(source: Source) -> GeneratedModule:
    """The module; each process loads it once."""
    if not source.texts:
        return import_module(source.name)
    return cached_module(source.name, repr(source.texts), lambda: dict(source.texts))


@dataclass(frozen=True)
class Job:
    """What is done with every motion of a sweep; a few kilobytes."""

    source: Source
    values: Mapping[str, float | str]
    duration: float
    method: str
    form: str
    rtol: float
    atol: float
    max_steps: int
    samples: int
    maps: Mapping[str, Map]
    columns: tuple[str, ...]

    @classmethod
    def of(cls, sweep: Sweep) -> Job:
        """The job of a sweep."""
        return cls(
            Source.of(sweep.module), dict(sweep.values), sweep.duration, sweep.method, sweep.form,
            sweep.rtol, sweep.atol, sweep.max_steps, sweep.samples, dict(sweep.maps),
            () if isinstance(sweep.axes, Grid) else tuple(sweep.axes.smallest),
        )  # fmt: skip

    @property
    def only_first(self) -> First | None:
        """The only map, if it is of a first event: then nothing is asked of a motion after it."""
        one, *others = self.maps.values()
        return one if isinstance(one, First) and not others else None

    @property
    def dtype(self) -> np.dtype[np.void]:
        """What is kept of one motion."""
        fields = [(name, "<f8", one.shape) for name, one in self.maps.items()]
        # what varies on no grid stands beside what came of it
        columns = [(name, "<f8") for name in self.columns]
        return np.dtype([("status", "i1"), *columns, *fields])
