"""Runs in segments, and the residuals of motions from nodes of their own."""

from collections.abc import Sequence
from copy import copy
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from solvers.equations.quantities import Array
from solvers.scenes.fitting.least_squares import Linearise, Piece
from solvers.scenes.fitting.measurement import Measurement, Outputs, wrapped
from solvers.scenes.fitting.shooting import Arc, Segment, Shooting, segments

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
    """

    def __init__(
        self,
        outputs: Outputs,
        runs: Sequence[Measurement],
        unknown: Sequence[str],
        params: Array,
        cuts: Sequence[Sequence[int]] | None = None,
    ) -> None:
        self.outputs, self.module, self.params = outputs, outputs.module, params
        self.runs, self.unknown = list(runs), tuple(unknown)
        self.tables = [unwrapped(outputs, run) for run in runs]
        self.indices = [self.module.PARAMETERS.index(name) for name in unknown]
        n = len(self.module.STATE)
        cuts = cuts or [_cuts(table, n) for table in self.tables]
        self.segments: list[Segment] = []
        for k, (run, own) in enumerate(zip(runs, cuts, strict=True)):
            self.segments += segments(k, run.t, own)
        self.data = [self.tables[s.run][:, s.first : s.first + len(s.times)] for s in self.segments]
        self.masks = [np.isfinite(data) for data in self.data]
        self.shooting = Shooting(self.module, self.indices, self.segments)

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
        return np.sum([mask.sum(axis=1) for mask in self.masks], axis=0)

    def all_params(self, unknown: Array) -> Array:
        """All parameters, with these values of the unknown ones."""
        params = self.params.copy()
        params[self.indices] = unknown
        return params

    def alone(self, k: int, unknown: Array) -> "Experiment":
        """The segment `k` alone, with these values of the unknown parameters as known ones."""
        other = copy(self)
        other.segments, other.runs = [replace(self.segments[k], run=0)], self.runs[:1]
        other.data, other.masks = [self.data[k]], [self.masks[k]]
        other.params, other.unknown, other.indices = self.all_params(unknown), (), []
        other.shooting = Shooting(self.module, [], other.segments)
        return other

    def linearise(self, noise: Array) -> Linearise:
        """The residuals in units of the noise, as a function of nodes and unknown parameters."""

        def linearised(nodes: Array, unknown: Array) -> list[Piece]:
            params, pieces = self.all_params(unknown), []
            for k, arc in enumerate(self.shooting(nodes, params)):
                is_last = k + 1 == len(nodes) or self.segments[k + 1].run != self.segments[k].run
                residuals, by = self._residuals(k, arc, params)
                weights = np.repeat(1 / noise, self.masks[k].sum(axis=1))
                gap = None if is_last else wrapped(arc.end - nodes[k + 1], self.outputs.angles)
                own = self.segments[k].run
                weighted = (weights * residuals, weights[:, np.newaxis] * by)
                pieces.append(Piece(own, *weighted, gap, arc.end_by))
            return pieces

        return linearised

    def _residuals(self, k: int, arc: Arc, params: Array) -> tuple[Array, Array]:
        """Differences of motion and measurement in a segment, and their derivatives."""
        outputs, mask, times = self.outputs, self.masks[k], self.segments[k].times
        differences = outputs.values(times, arc.y, params.tolist()) - self.data[k]
        differences = wrapped(differences, outputs.turns)
        if outputs.formulas is None:
            by = arc.by[outputs.rows]
        else:
            by_state, by_params = outputs.derivatives(times, arc.y, params.tolist())
            by = np.einsum("osm,sdm->odm", by_state, arc.by)
            by[:, len(arc.y) :] += by_params[:, self.indices]
        return differences[mask], np.moveaxis(by, 1, 2)[mask]

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


def _cuts(table: Array, n: int) -> list[int]:
    """Samples at which segments begin, each with enough values for its node."""
    values = np.isfinite(table).sum(axis=0)
    total, samples = int(values.sum()), table.shape[1]
    enough = max(FEWEST_VALUES * n, total / MOST_SEGMENTS)
    cuts, collected = [0], 0
    for k in range(samples):
        if collected >= enough and k - cuts[-1] >= max(FEWEST_SAMPLES, samples / MOST_SEGMENTS):
            cuts.append(k)
            collected = 0
        collected += int(values[k])
    if len(cuts) > 1 and (collected < enough or cuts[-1] > samples - FEWEST_SAMPLES):
        cuts.pop()
    return cuts
