"""Measurements of motions, and the quantities that they measure."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike

from solvers.equations.module import GeneratedModule, function
from solvers.equations.module import inputs as input_names
from solvers.equations.number_checks import Array, real_numbers
from solvers.equations.signature_checks import checked
from solvers.io.suggestion import counted, shortened

#: How an input acts between its values: held from each to the next one, or linear.
Interpolation: TypeAlias = Literal["held", "linear"]


@checked
@dataclass(frozen=True)
class Measurement:
    """One motion, measured at several times.

    Parameters
    ----------
    t : array_like of shape (times,)
        Times in s, increasing.
    values : mapping of str to array_like of shape (times,)
        Measured quantities by name, or by formula, in SI units; NaN in gaps.
    name : str, optional
        A name for messages and plots, such as that of a file.
    inputs : mapping of str to array_like of shape (times,), optional
        Inputs of the system by name, in SI units, which act from each time to the next one; those
        of the last time do not matter.

    Raises
    ------
    ValueError
        When times are not finite or do not increase, lengths differ, or there is no value.

    Examples
    --------
    >>> from solvers import Measurement
    >>> Measurement([0, 0.1, 0.2], {"theta": [0.5, float("nan"), 0.4]})
    Measurement of theta: 3 times, 2 values
    """

    t: Array
    values: Mapping[str, Array]
    name: str = "measurement"
    inputs: Mapping[str, Array] = field(default_factory=dict)

    def __init__(
        self,
        t: ArrayLike,
        values: Mapping[str, ArrayLike],
        name: str = "measurement",
        inputs: Mapping[str, ArrayLike] = MappingProxyType({}),
    ) -> None:
        times = real_numbers(f"{name}: t", t, "s")
        if times.ndim != 1 or not times.size:
            raise ValueError(f"{name}: t has shape {times.shape}: give one time or more")
        if (wrong := np.flatnonzero(np.diff(times) <= 0)).size:
            k = int(wrong[0]) + 1
            raise ValueError(
                f"{name}: t[{k}] = {times[k]} s is not after t[{k - 1}] = {times[k - 1]} s: sort "
                "the rows by time, and give each time once"
            )
        columns, held = (_columns(name, times, part) for part in (values, inputs))
        for column, array in held.items():
            if np.isnan(array[:-1]).any():
                raise ValueError(
                    f"{name}: the input {column} has gaps: it needs a value at each time"
                )
        if not any(np.isfinite(array).any() for array in columns.values()):
            raise ValueError(f"{name} holds no measured value: give a column besides t")
        object.__setattr__(self, "t", times)
        object.__setattr__(self, "values", columns)
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "inputs", held)

    @property
    def count(self) -> int:
        """Number of values, gaps aside."""
        return sum(int(np.isfinite(column).sum()) for column in self.values.values())

    def __repr__(self) -> str:
        times, values = counted(len(self.t), "time"), counted(self.count, "value")
        return f"Measurement of {', '.join(self.values)}: {times}, {values}"

    def table(self, names: Sequence[str]) -> Array:
        """Values of these quantities in rows; NaN for those that were not measured."""
        gap = np.full(len(self.t), np.nan)
        return np.array([self.values.get(name, gap) for name in names])

    def between(self, begin: float, end: float) -> "Measurement":
        """The part from a time up to another, which is not included."""
        part = (self.t >= begin) & (self.t < end)
        values, inputs = (
            {name: column[part] for name, column in columns.items()}
            for columns in (self.values, self.inputs)
        )
        return Measurement(self.t[part], values, self.name, inputs)

    def with_inputs(self, names: Collection[str], interpolation: Interpolation) -> "Measurement":
        """The same with the columns of these names as inputs, and gaps of them filled.

        They are held from each value to the next one; or they change linearly between values, of
        which the mean acts from each time to the next one.
        """
        if interpolation not in (kinds := get_args(Interpolation)):
            raise ValueError(f"inputs = {shortened(interpolation)}: give one of {', '.join(kinds)}")
        inputs = dict(self.inputs)
        for name in [name for name in self.values if name in names]:
            column = self.values[name]
            known = np.isfinite(column)
            if not known.any() or (interpolation == "held" and not known[0]):
                place = "any time" if not known.any() else f"the first time, t = {self.t[0]:g} s"
                raise ValueError(f"{self.name}: the input {name} has no value at {place}: give one")
            if interpolation == "held":
                inputs[name] = column[np.maximum.accumulate(np.where(known, range(len(column)), 0))]
            else:
                filled = np.interp(self.t, self.t[known], column[known])
                inputs[name] = np.append((filled[:-1] + filled[1:]) / 2, filled[-1])
        others = {name: column for name, column in self.values.items() if name not in names}
        return Measurement(self.t, others, self.name, inputs)

    def held(self, module: GeneratedModule, params: Array) -> Array | None:
        """All inputs, shape (inputs, times), of which others are those of `params`; or None."""
        if not self.inputs:
            return None
        names, table = input_names(module), np.empty((len(input_names(module)), len(self.t)))
        for row, name, constant in zip(table, names, params[-len(names) :], strict=True):
            row[:] = self.inputs.get(name, constant)
        return table


def check_inputs(runs: Sequence[Measurement]) -> None:
    """Raise `ValueError` where a run lacks an input that another one has."""
    for run in runs:
        if missing := sorted({*runs[0].inputs} ^ {*run.inputs}):
            without, other = (runs[0], run) if missing[0] in run.inputs else (run, runs[0])
            raise ValueError(
                f"{without.name} has no column of the input {missing[0]}, which {other.name} has: "
                "give it, with zeros if the input did not act, or leave it out of all runs"
            )


def _columns(name: str, times: Array, values: Mapping[str, ArrayLike]) -> dict[str, Array]:
    """Columns as arrays, with as many values as there are times; NaN in gaps."""
    columns = {}
    for column, given in values.items():
        array = np.array(given, float)
        if array.shape != times.shape:
            count = counted(len(times), "time")
            raise ValueError(f"{name}: {column} has shape {array.shape}, but t has {count}")
        if np.isinf(array).any():
            raise ValueError(f"{name}: {column} is infinite: write NaN where there is no value")
        columns[column] = array
    return columns


@dataclass(frozen=True)
class Outputs:
    """Measured quantities as functions of state, time and parameters.

    Attributes
    ----------
    names : tuple of str
        Components of the state, or other names.
    units : tuple of str
        Their units.
    module : module
        The generated equations of the system.
    formulas : module or None
        Has the functions ``outputs``, ``outputs_jacobian`` and ``outputs_parameter_jacobian`` of
        all quantities; None if all are components of the state.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    module: GeneratedModule
    formulas: GeneratedModule | None = None

    @property
    def components(self) -> list[int | None]:
        """Index of each quantity in the state; None for those that are formulas."""
        state = self.module.STATE
        return [state.index(name) if name in state else None for name in self.names]

    @property
    def turns(self) -> list[int]:
        """Indices of the quantities that are measured modulo whole turns."""
        return [k for k, component in enumerate(self.components) if component in self.angles]

    @cached_property
    def angles(self) -> list[int]:
        """Indices in the state of the angles on which the equations depend by sine and cosine."""
        rational = self.module.STATES.get("rational", ())
        names = enumerate(self.module.COORDINATES)
        return [k for k, name in names if f"sin_{name}" in rational]

    @np.errstate(all="ignore")  # formulas may have no values where nothing is measured
    def values(self, t: Array, y: Array, params: Sequence[float]) -> Array:
        """Their values, shape (outputs, times), at states of shape (state, times)."""
        if self.formulas is None:
            return y[self.rows]
        return np.asarray(function(self.formulas, "outputs_many")(t, y, params))

    @np.errstate(all="ignore")
    def derivatives(self, t: Array, y: Array, params: Sequence[float]) -> tuple[Array, Array]:
        """By state and by parameters, shapes (outputs, state, times), (outputs, params, times)."""
        if self.formulas is None:
            state = np.eye(len(self.module.STATE))[self.rows]
            own = np.zeros((len(self.names), len(self.module.PARAMETERS), len(t)))
            return np.broadcast_to(state[:, :, np.newaxis], (*state.shape, len(t))), own
        pair = (
            function(self.formulas, f"outputs{kind}_jacobian_many")(t, y, params)
            for kind in ("", "_parameter")
        )
        by_state, by_params = map(np.asarray, pair)
        return by_state, by_params

    @property
    def rows(self) -> list[int]:
        """Indices in the state of the quantities that are components of it."""
        return [k for k in self.components if k is not None]


def wrapped(differences: Array, rows: Sequence[int]) -> Array:
    """Differences, of which those in these rows are without whole turns."""
    own = differences[rows]
    differences[rows] = own - 2 * np.pi * np.round(own / (2 * np.pi))
    return differences
