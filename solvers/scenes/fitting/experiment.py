"""Runs in segments, and the residuals of motions from nodes of their own."""

from collections.abc import Sequence
from copy import copy
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from solvers.equations.number_checks import Array
from solvers.scenes.fitting.least_squares import Linearise, LinearisedResiduals
from solvers.scenes.fitting.measurement import Measurement, Outputs, wrapped
from solvers.scenes.fitting.multiple_shooting import (
    Arcs,
    MultipleShooting,
    NoResidualsError,
    Segment,
    segments,
)

#: Most segments of a run, fewest samples of one, and fewest values for a component of the state.
MOST_SEGMENTS, FEWEST_SAMPLES, FEWEST_VALUES = 200, 5, 3
#: Smallest standard deviation of the noise, as a part of the spread of the values.
LEAST_NOISE = 1e-6


class Experiment:
    """Measured runs of a system, of which some parameters are unknown.

    Parameters
    ----------
    outputs : Outputs
        The measured quantities.
    runs : sequence of Measurement
        The runs, each with a start of its own.
    unknown : sequence of str
        Names of the unknown parameters.
    params : ndarray of shape (params,)
        Values of the known parameters; those of the others are ignored.
    cuts : sequence of sequence of int, optional
        For each run the samples at which segments begin; by default as many as the values allow.
    most : int, optional
        Most segments of a run.
    """

    def __init__(
        self,
        outputs: Outputs,
        runs: Sequence[Measurement],
        unknown: Sequence[str],
        params: Array,
        cuts: Sequence[Sequence[int]] | None = None,
        most: int = MOST_SEGMENTS,
    ) -> None:
        self.outputs, self.module, self.params = outputs, outputs.module, params
        self.runs, self.unknown = list(runs), tuple(unknown)
        self.tables = [unwrapped(outputs, run) for run in runs]
        self.indices = [self.module.PARAMETERS.index(name) for name in unknown]
        n = len(self.module.STATE)
        cuts = cuts or [_cuts(table, n, most) for table in self.tables]
        self.segments: list[Segment] = []
        for k, (run, own) in enumerate(zip(runs, cuts, strict=True)):
            self.segments += segments(k, run.t, own, run.held(self.module, params))
        self.shooting = MultipleShooting(self.module, self.indices, self.segments)
        shape = (len(self.segments), len(outputs.names), self.shooting.missing.shape[1])
        self.data = np.full(shape, np.nan)
        for values, segment in zip(self.data, self.segments, strict=True):
            last = segment.first + len(segment.times)
            values[:, : len(segment.times)] = self.tables[segment.run][:, segment.first : last]
        self.masks = np.isfinite(self.data)

    @property
    def positive(self) -> NDArray[np.bool_]:
        """Which of the unknown parameters are positive."""
        return np.array([name in self.module.POSITIVE for name in self.unknown], bool)

    @property
    def firsts(self) -> list[int]:
        """Indices of the first segments of the runs."""
        runs = [segment.run for segment in self.segments]
        return [runs.index(k) for k in range(len(self.runs))]

    @property
    def counts(self) -> NDArray[np.int64]:
        """Number of values of each output."""
        return self.masks.sum(axis=(0, 2))

    def all_params(self, unknown: Array) -> Array:
        """All parameters, with these values of the unknown ones."""
        params = self.params.copy()
        params[self.indices] = unknown
        return params

    def alone(self, k: int, unknown: Array) -> "Experiment":
        """The segment `k` alone, with these values of the unknown parameters as known ones."""
        other = copy(self)
        other.segments, other.runs = [replace(self.segments[k], run=0)], self.runs[:1]
        count = len(self.segments[k].times)
        other.data, other.masks = self.data[k : k + 1, :, :count], self.masks[k : k + 1, :, :count]
        other.params, other.unknown, other.indices = self.all_params(unknown), (), []
        other.shooting = MultipleShooting(self.module, [], other.segments)
        return other

    def linearise(self, noise: Array) -> Linearise:
        """The residuals in units of the noise, as a function of nodes and unknown parameters."""
        runs = np.array([segment.run for segment in self.segments])
        joined = np.append(np.diff(runs) == 0, False)[:, np.newaxis]
        weights = self.masks / noise[:, np.newaxis]

        def linearised(nodes: Array, unknown: Array) -> LinearisedResiduals:
            params, count = self.all_params(unknown), len(nodes)
            arcs = self.shooting(nodes, params)
            differences, by = self._residuals(arcs, params)
            gaps = wrapped((arcs.ends - np.roll(nodes, -1, axis=0)).T, self.outputs.angles).T
            return LinearisedResiduals(
                runs,
                (weights * differences).reshape(count, -1),
                (weights[..., np.newaxis] * by).reshape(count, -1, by.shape[-1]),
                joined * gaps,
                joined[:, :, np.newaxis] * arcs.ends_by,
            )

        return linearised

    def _residuals(self, arcs: Arcs, params: Array) -> tuple[Array, Array]:
        """Differences of motions and measurements, (segments, outputs, times), and derivatives.

        Both are 0 where there is no measurement; `NoResidualsError` where a formula has no value.
        """
        outputs, n = self.outputs, arcs.y.shape[1]
        if outputs.formulas is None:
            values, by = arcs.y[:, outputs.rows], arcs.by[:, :, :, outputs.rows]
            by = np.ascontiguousarray(np.moveaxis(by, (1, 3), (3, 1)))
        else:
            times, y = self.shooting.times, np.moveaxis(arcs.y, 1, 0)
            values = np.moveaxis(outputs.values(times, y, params.tolist()), 0, 1)
            by_state, by_params = outputs.derivatives(times, y, params.tolist())
            by = np.einsum("oskm,kdms->komd", by_state, arcs.by)
            by[..., n:] += np.moveaxis(by_params[:, self.indices], (2, 3, 1), (0, 2, 3))
        differences = np.moveaxis(values - self.data, 1, 0)
        differences = np.moveaxis(wrapped(differences, outputs.turns), 0, 1)
        differences = np.where(self.masks, differences, 0.0)
        by = np.where(self.masks[..., np.newaxis], by, 0.0)
        without = ~(np.isfinite(differences) & np.isfinite(by).all(axis=-1))
        for segment, output, sample in np.argwhere(without):
            name, t = outputs.names[output], self.shooting.times[segment, sample]
            raise NoResidualsError(f"{name}, or a derivative of it, has no value at t = {t:.6g} s")
        return differences, by

    def first_noise(self) -> Array:
        """Rough standard deviations of the noise, from third differences of successive values."""
        deviations = []
        for row in range(len(self.outputs.names)):
            columns = [table[row][np.isfinite(table[row])] for table in self.tables]
            spread = max((float(np.ptp(column)) for column in columns if len(column)), default=0.0)
            thirds = np.concatenate([np.abs(np.diff(column, 3)) for column in columns])
            rough = float(np.median(thirds)) / 3 if len(thirds) else spread
            deviations.append(max(rough, LEAST_NOISE * spread, 1e-12))
        return np.array(deviations)


def unwrapped(outputs: Outputs, run: Measurement) -> Array:
    """The measured values in rows, angles without jumps by whole turns."""
    table = run.table(outputs.names)
    for k in outputs.turns:
        row = table[k]
        finite = np.isfinite(row)
        row[finite] = np.unwrap(row[finite])
    return table


def _cuts(table: Array, n: int, most: int) -> list[int]:
    """Samples at which segments begin, each with enough values for its node."""
    values = np.isfinite(table).sum(axis=0)
    total, samples = int(values.sum()), table.shape[1]
    enough = max(FEWEST_VALUES * n, total / most)
    cuts, collected = [0], 0
    for k in range(samples):
        if collected >= enough and k - cuts[-1] >= max(FEWEST_SAMPLES, samples / most):
            cuts.append(k)
            collected = 0
        collected += int(values[k])
    if len(cuts) > 1 and (collected < enough or cuts[-1] > samples - FEWEST_SAMPLES):
        cuts.pop()
    return cuts
