"""The work for each motion of a sweep, small enough to be sent to workers.

It consists of names and numbers, and of the text of a module that does not ship.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from solvers.equations.module import GeneratedModule, header
from solvers.equations.module_cache import cached_module
from solvers.integration.solution import Status
from solvers.sweeps.maps import Map
from solvers.sweeps.sweep import Sweep

ENDS = (status.name.lower().replace("_", " ") for status in Status)
#: Status of a motion, by its number in ``status.npy``.
STATUSES = ("not done yet", *ENDS, "proved", "no such energy")
CODES = {status: code for code, status in enumerate(Status, 1)}
PROVED, NO_SUCH_ENERGY = STATUSES.index("proved"), STATUSES.index("no such energy")


@dataclass(frozen=True)
class Source:
    """A generated module for workers: its name, or its files as pairs of name and text."""

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
    """The part of a sweep's definition that all its motions share; a few kilobytes."""

    source: Source
    values: Mapping[str, float | str]
    duration: float
    options: dict[str, Any]
    samples: int
    maps: Mapping[str, Map]
    columns: tuple[str, ...]

    @classmethod
    def of(cls, sweep: Sweep) -> Job:
        """The job of a sweep."""
        columns = () if sweep.axes.is_grid else tuple(sweep.axes.smallest)
        source, values, maps = Source.of(sweep.module), dict(sweep.values), dict(sweep.maps)
        return cls(source, values, sweep.duration, sweep.options, sweep.samples, maps, columns)

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
        """The record that is stored for each motion."""
        fields = [(name, "<f8", one.shape) for name, one in self.maps.items()]
        # quantities that vary on no grid are stored beside the results
        columns = [(name, "<f8") for name in self.columns]
        return np.dtype([("status", "i1"), *columns, *fields])


def status_table() -> str:
    """A Markdown table of the statuses of a motion."""
    rows = [f"| {code} | {status} |\n" for code, status in enumerate(STATUSES)]
    return "| number | status |\n|---|---|\n" + "".join(rows)
