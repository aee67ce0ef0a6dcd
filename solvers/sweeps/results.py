"""The maps of a sweep, opened: NumPy arrays with what stands along their axes, and units."""

from __future__ import annotations

import json
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solvers.sweeps.axes import Grid
from solvers.sweeps.checks import ENERGY
from solvers.sweeps.job import STATUSES
from solvers.sweeps.sweep import Sweep

#: What the dimensions of a motion's numbers are called.
PARTS = ("component", "number")


@dataclass(frozen=True)
class Results:
    """What a sweep has found, whole or so far.

    Attributes
    ----------
    asked : Sweep
        What was asked.
    folder : Path
        Where it is: a file ``<map>.npy`` for each map, ``status.npy``, and ``sweep.json``.
    maps : dict of str to ndarray
        The maps; of a grid their first axes are those of the grid, else the first counts
        motions. Files are mapped into memory.
    axes : dict of str to ndarray
        What varies: the values along each axis of a grid, else of each motion.
    status : ndarray of int
        How each motion ended, as a place in `solvers.sweeps.job.STATUSES`.
    """

    asked: Sweep
    folder: Path
    maps: dict[str, NDArray[np.float64]]
    axes: dict[str, NDArray[np.float64]]
    status: NDArray[np.int8]

    @classmethod
    def of(cls, asked: Sweep, folder: Path) -> Results:
        """Open the maps in a folder.

        Parameters
        ----------
        asked : Sweep
            What was asked.
        folder : Path
            Where a finished sweep is kept.

        Returns
        -------
        Results
            With arrays that are read when they are looked at, and cannot be written to.

        Raises
        ------
        OSError
            When they are not there.
        """

        def opened(name: str) -> NDArray[Any]:
            return np.load(folder / f"{name}.npy", mmap_mode="r")

        varied = asked.axes.smallest
        return cls(
            asked, folder, {name: opened(name) for name in asked.maps},
            {name: opened(name) for name in varied}, opened("status"),
        )  # fmt: skip

    @property
    def count(self) -> dict[str, int]:
        """How many motions ended in each way."""
        found = np.bincount(self.status.ravel(), minlength=len(STATUSES))
        return {name: int(n) for name, n in zip(STATUSES, found, strict=True) if n}

    def unit(self, name: str) -> str:
        """Unit of what varies."""
        return "J" if name == ENERGY else str(self.asked.module.UNITS[name])

    def dataset(self) -> Any:
        """All maps in one ``xarray.Dataset``, with named axes and units; ``to_zarr`` writes it.

        Returns
        -------
        xarray.Dataset
            Its dimensions are the axes of a grid, else ``motion``; ``status`` is in it, too.

        Raises
        ------
        ImportError
            When xarray is not installed: it comes with the extra ``xarray``.
        """
        xarray = import_module("xarray")  # an extra, for those who have it
        is_grid = isinstance(self.asked.axes, Grid)
        names = tuple(self.axes) if is_grid else ("motion",)
        along: dict[str, Any] = {
            name: ((name,) if is_grid else names, column, {"units": self.unit(name)})
            for name, column in self.axes.items()
        }
        found: dict[str, Any] = {"status": (names, self.status, {"meanings": list(STATUSES)})}
        for name, one in self.asked.maps.items():
            kinds = ("component", "extreme") if one.labels[1:] and one.labels[1] else PARTS
            inner = [f"{name}_{kind}" for kind in kinds[: len(one.shape)]]
            for dimension, labels in zip(inner, one.labels, strict=True):
                if labels:
                    along[dimension] = ((dimension,), np.array(labels, object))
            units = {"units": one.unit(self.asked.module)}
            found[name] = ((*names, *inner), self.maps[name], units)
        title = {"title": self.asked.title, "asked": json.dumps(self.asked.asked)}
        return xarray.Dataset(found, along, title)
