"""The maps of a sweep as NumPy arrays, with their axes and units."""

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solvers.integration.problem.status import Status
from solvers.io.exports import dataset
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.definition.sweep_checks import unit

ENDS = (status.name.lower().replace("_", " ") for status in Status)
#: Status of a motion, by its number in ``status.npy``.
STATUSES = ("not done yet", *ENDS, "proved", "no such energy", "no configuration")
CODES = {status: code for code, status in enumerate(Status, 1)}
#: Those of motions that have values in the maps.
GOOD = ("finished", "event", "proved")
PROVED, NO_SUCH_ENERGY = STATUSES.index("proved"), STATUSES.index("no such energy")
#: That of motions whose start no configuration satisfies.
NO_CONFIGURATION = STATUSES.index("no configuration")


@dataclass(frozen=True, repr=False)
class Results:
    """Maps of a sweep, complete or so far.

    Attributes
    ----------
    definition : Sweep
        The motions and maps.
    folder : Path
        Their folder: a file ``<map>.npy`` for each map, ``status.npy``, and ``sweep.json``.
    maps : dict of str to ndarray
        The maps; the first axes are those of the grid, else the first axis counts motions.
        Files are mapped into memory.
    axes : dict of str to ndarray
        Quantities that vary: the values along each axis of a grid, else of each motion.
    status : ndarray of int
        Status of each motion, as an index of `solvers.sweeps.results.STATUSES`.
    records : dict of str to list of dict
        Attractors of each map of basins.

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> from solvers import Final, Grid, Sweep, sweep
    >>> definition = Sweep(sp, Grid({"theta": [0.1, 0.2]}), {"end": Final(("theta",))}, duration=5)
    >>> sweep(definition, "ends")
    Results of 'sweep' in ends: 2 motions, finished 2; maps: end (2, 1)
    """

    definition: Sweep
    folder: Path
    maps: dict[str, NDArray[np.float64]]
    axes: dict[str, NDArray[np.float64]]
    status: NDArray[np.int8]
    records: dict[str, list[dict[str, Any]]] = field(default_factory=dict)

    @classmethod
    def of(cls, definition: Sweep, folder: Path) -> "Results":
        """Open the maps in a folder."""
        names = ("status", *definition.maps, *definition.axes.smallest)
        files = {name: np.load(folder / f"{name}.npy", mmap_mode="r") for name in names}
        maps = {name: files[name] for name in definition.maps}
        axes = {name: files[name] for name in definition.axes.smallest}
        records = {
            name: json.loads((folder / f"{name}_{one.records}.json").read_text(encoding="utf-8"))
            for name, one in definition.maps.items()
            if one.records
        }
        return cls(definition, folder, maps, axes, files["status"], records)

    def __repr__(self) -> str:
        counts = ", ".join(f"{name} {n:,}" for name, n in self.count.items())
        maps = ", ".join(f"{name} {numbers.shape}" for name, numbers in self.maps.items())
        return (
            f"Results of {self.definition.name!r} in {self.folder}: "
            f"{self.definition.motions:,} motions, {counts}; maps: {maps}"
        )

    @property
    def count(self) -> dict[str, int]:
        """Number of motions by status."""
        counts = np.bincount(self.status.ravel(), minlength=len(STATUSES))
        return {name: int(n) for name, n in zip(STATUSES, counts, strict=True) if n}

    def unit(self, name: str) -> str:
        """Unit of a quantity that varies."""
        return unit(self.definition.module, name)

    def dataset(self) -> Any:
        """All maps in one ``xarray.Dataset``, with named axes and units; ``to_zarr`` writes it.

        Its dimensions are the axes of a grid, else ``motion``; it contains ``status``. The package
        xarray comes with the extra ``xarray``.
        """
        is_grid = self.definition.axes.is_grid
        names = tuple(self.axes) if is_grid else ("motion",)
        coordinates: dict[str, Any] = {
            name: ((name,) if is_grid else names, column, {"units": self.unit(name)})
            for name, column in self.axes.items()
        }
        variables: dict[str, Any] = {"status": (names, self.status, {"meanings": list(STATUSES)})}
        for name, one in self.definition.maps.items():
            dimensions = [f"{name}_{dimension}" for dimension in one.dimensions]
            for dimension, labels in zip(dimensions, one.labels, strict=False):
                coordinates[dimension] = ((dimension,), np.array(labels, object))
            units = {"units": one.unit(self.definition.module)}
            variables[name] = ((*names, *dimensions), self.maps[name], units)
        definition = json.dumps(self.definition.as_json)
        attributes = {"title": self.definition.title, "definition": definition}
        return dataset(variables, coordinates, attributes)
