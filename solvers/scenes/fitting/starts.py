"""First guesses of the states at nodes, from the samples around them."""

from collections.abc import Iterator
from contextlib import suppress

import numpy as np

from solvers.equations.number_checks import Array
from solvers.scenes.fitting.experiment import Experiment
from solvers.scenes.fitting.least_squares import NotConvergedError, minimise
from solvers.scenes.fitting.multiple_shooting import NoResidualsError

#: Samples of the parabola whose value and slope are those of a coordinate at a node.
SAMPLES = 7
#: Attempts from random first guesses of runs' starts, and their spread.
ATTEMPTS, SPREAD = 10, 1.5


def first_nodes(
    experiment: Experiment, start: Array, params: Array, noise: Array
) -> Iterator[Array]:
    """States for all segments: by parabolas if all coordinates are measured, else by fits.

    `start` is the first guess of every run's start, `params` those of the unknown parameters.
    Fits may find another configuration that is measured alike; then there are several guesses.
    """
    outputs, module = experiment.outputs, experiment.module
    rows = {name: k for k, name in enumerate(outputs.names)}
    if all(q in rows and experiment.counts[rows[q]] for q in module.COORDINATES):
        yield _from_coordinates(experiment, rows)
        return
    random = np.random.default_rng(0)
    yield _from_fits(experiment, start, params, noise)
    for _ in range(ATTEMPTS):
        guess = start + SPREAD * random.normal(size=len(start))
        yield _from_fits(experiment, guess, params, noise)


def _from_coordinates(experiment: Experiment, rows: dict[str, int]) -> Array:
    module, n = experiment.module, len(experiment.module.COORDINATES)
    nodes = np.zeros((len(experiment.segments), 2 * n))
    for run, (measurement, table) in enumerate(
        zip(experiment.runs, experiment.tables, strict=True)
    ):
        own = [k for k, segment in enumerate(experiment.segments) if segment.run == run]
        begins = np.array([experiment.segments[k].begin for k in own])
        for k, name in enumerate(module.STATE):
            finite = np.isfinite(table[rows[name]]) if name in rows else np.array([False])
            if finite.any():
                t, values = measurement.t[finite], table[rows[name], finite]
                value, slope = _parabolas(t, values, begins)
                nodes[own, k] = value
                if k < n:
                    nodes[own, n + k] = slope
    return nodes


def _parabolas(t: Array, values: Array, begins: Array) -> tuple[Array, Array]:
    """Values and slopes, at some times, of parabolas through the samples around them."""
    count = min(SAMPLES, len(t))
    # a window that is near and has no gap, beyond which angles may be wrong by whole turns
    starts = np.searchsorted(t, begins)[:, np.newaxis] - np.arange(count + 1)
    starts = np.clip(starts, 0, len(t) - count)
    begins = begins[:, np.newaxis]
    left, right = t[starts], t[starts + count - 1]
    extents = right - left + np.maximum(abs(left - begins), abs(right - begins))
    first = np.take_along_axis(starts, extents.argmin(axis=1)[:, np.newaxis], axis=1)
    near = first + np.arange(count)
    times = t[near] - begins
    span = np.ptp(times, axis=1)
    span[span == 0] = 1.0
    powers = (times / span[:, np.newaxis])[:, :, np.newaxis] ** np.arange(min(3, count))
    fits = np.linalg.pinv(powers) @ values[near][:, :, np.newaxis]
    slopes = fits[:, 1, 0] / span if count > 1 else np.zeros(len(begins))
    return fits[:, 0, 0], slopes


def _from_fits(experiment: Experiment, start: Array, params: Array, noise: Array) -> Array:
    """One segment after the other, each from the end of the one before."""
    nodes, end = list[Array](), start
    for k in range(len(experiment.segments)):
        guess = start if k in experiment.firsts else end
        node, end = _fitted(experiment.alone(k, params), guess, noise)
        nodes.append(node)
    return np.array(nodes)


def _fitted(alone: Experiment, guess: Array, noise: Array) -> tuple[Array, Array]:
    """States at the node and at the end of a segment with known parameters."""
    linearise, none = alone.linearise(noise), np.empty(0)
    nodes = guess[np.newaxis]
    with suppress(NotConvergedError):
        nodes = minimise(linearise, nodes, none, alone.positive, np.ones(len(guess))).nodes
    try:
        return nodes[0], alone.shooting(nodes, alone.params).ends[0]
    except NoResidualsError:
        return guess, guess
