"""Inputs that change during a motion: held between samples, or functions of time and state."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from solvers.equations.module import GeneratedModule, inputs, motion_times
from solvers.equations.number_checks import (
    Values,
    finite_row,
    positive,
    quantities,
    real_numbers,
)
from solvers.io.suggestion import shortened
from solvers.runge_kutta.stepper import Array

#: ``u(t, y)``: values of the inputs at a time in s and a state (q, q̇).
Controller: TypeAlias = Callable[[float, Array], Values]
#: Most samples of one motion.
MOST_SAMPLES = 10_000_000


@dataclass(frozen=True)
class Held:
    """Inputs that are constant between samples (a zero-order hold).

    Every sample is the end of a step, so that jumps cost no accuracy.

    Parameters
    ----------
    times : float or array_like of shape (n,)
        The period of the samples in s, counted from the start of the motion; or increasing times
        in s of the samples, of which the first is not after the start.
    values : callable or array_like of shape (inputs, n), or mapping of str to array_like
        A controller ``values(t, y)``, called at every sample with the time in s and the state
        (q, q̇), which returns the inputs in the order of ``module.INPUTS`` or by name; a single
        input may be a number. Or the inputs from each sample to the next, the last ones to the
        end.

    Raises
    ------
    ValueError
        When `times` are not a positive period or increasing times, or there are not as many
        `values`.

    Examples
    --------
    >>> from solvers import Held
    >>> Held(0.01, lambda t, y: -3 * y[0]).times
    0.01
    >>> Held([0.0, 1.0, 2.5], [[5.0, -5.0, 0.0]]).values
    [[5.0, -5.0, 0.0]]
    """

    times: float | ArrayLike
    values: Controller | Values

    def __post_init__(self) -> None:
        times = real_numbers("times", self.times, "s")
        if times.ndim == 0:
            positive("times", self.times)
        elif times.ndim > 1 or not times.size or not (np.diff(times) > 0).all():
            raise ValueError(f"times = {shortened(self.times)} must be a period or increase")


@dataclass(frozen=True)
class Schedule:
    """`Held` inputs of one problem, checked."""

    module: GeneratedModule
    times: Array  # of the samples in s; the first is not after the start
    table: Array | None  # of shape (inputs, samples); None for a controller
    controller: Controller | None

    @classmethod
    def of(cls, held: Held, module: GeneratedModule, span: tuple[float, float]) -> "Schedule":
        """The samples of `held` over a time span; ValueError where they do not cover it."""
        begin, end = span
        if end < begin:
            raise ValueError(
                f"t_span = {span} runs backwards: held inputs need one forwards, since they follow "
                "from the state at the sample before; give a function of time"
            )
        times = real_numbers("times", held.times, "s")
        if not times.ndim:
            period = float(times)
            if (end - begin) / period > MOST_SAMPLES:
                raise ValueError(f"times = {period}: t_span has more than {MOST_SAMPLES} samples")
            # a sample that rounding puts just before the end is not one
            count = max(int(np.ceil((end - begin) / period * (1 - 1e-12))), 1)
            times = np.asarray(begin + period * np.arange(count), float)
        if times[0] > begin:
            raise ValueError(
                f"the first of times, {times[0]}, is after the start of t_span = {span}"
            )
        if callable(held.values):
            return cls(module, times, None, held.values)
        table = held.values
        if not np.ndim(held.times):  # there may be more samples than the time span needs
            table = _first_samples(table, len(times))
        return cls(module, times, given("values", module, table, times.shape, times), None)

    def pieces(self, span: tuple[float, float]) -> tuple[int, Array, Array]:
        """The first sample that matters in a time span, and the times between which each does."""
        (begin, end), times = span, self.times
        first = int(np.searchsorted(times, begin, "right")) - 1
        last = max(int(np.searchsorted(times, end, "left")), first + 1)
        switches = np.concatenate([[begin], times[first + 1 : last], [end]])
        return first, switches[:-1], switches[1:]

    def at(self, sample: int, t: float, y: Array) -> Array:
        """The inputs from a sample at time `t` with state `y` on."""
        if self.controller is not None:
            return controlled(self.module, self.controller, t, y)
        assert self.table is not None
        return np.asarray(self.table[:, sample])


@dataclass
class History:
    """The inputs of a motion: times in s from which on, and values."""

    times: list[float] = field(default_factory=list)
    values: list[Array] = field(default_factory=list)

    def at(self, t: Array) -> Array:
        """The inputs at times `t`, shape (inputs, times); at a sample those from there on."""
        index = np.searchsorted(self.times, t, "right") - 1
        return np.array(self.values)[np.maximum(index, 0)].T


def _first_samples(table: Any, count: int) -> Any:
    if isinstance(table, Mapping):
        return {name: _first_samples(values, count) for name, values in table.items()}
    array = real_numbers("values", table)
    return array[..., :count] if array.ndim else table


def controlled(module: GeneratedModule, controller: Controller, t: float, y: Array) -> Array:
    """The inputs that a controller returns at time `t` and state `y`, or states in columns.

    NaN and infinity are refused, unless they end the motions of their columns only.
    """
    shape = y.shape[1:]
    values = controller(t, y.copy())
    return given(f"inputs at t = {t}", module, values, shape, t, nan=bool(shape))


def given(
    what: str,
    module: GeneratedModule,
    values: Any,
    shape: tuple[int, ...] = (),
    t: float | Array = 0.0,
    *,
    nan: bool = False,
) -> Array:
    """Values of all inputs, shape (inputs, *shape).

    Those that a mapping leaves out are 0, and times of prescribed motions `t`.
    """
    names = inputs(module)
    if not names:
        raise ValueError(
            f"{module.SYSTEM} has no inputs, but {what} = {shortened(values)}: leave it out, or "
            "declare them, System(..., inputs=[Input(...)])"
        )
    if not shape and (row := finite_row(values)) is not None and len(row) == len(names):
        return np.array(row, float)  # at once, since controllers are called often
    if len(names) == 1 and not isinstance(values, Mapping) and np.shape(values) in ((), shape):
        values = [values]  # a single input may be a number
    defaults = dict.fromkeys(names, 0.0) | dict.fromkeys(motion_times(module), t)
    array = quantities(module, what, names, values, defaults, nan=nan)
    expected = (len(names), *shape)
    if array.shape == expected[:1]:
        array = array.reshape(-1, *[1] * len(shape))
    if array.shape[:1] == expected[:1] and array.ndim == len(expected):
        with suppress(ValueError):
            return np.broadcast_to(array, expected)
    raise ValueError(
        f"{what} has shape {array.shape}: give {expected}, of which the first axis holds the "
        f"inputs {', '.join(names)}"
    )
