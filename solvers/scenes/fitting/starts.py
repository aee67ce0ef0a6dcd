"""First guesses of the states at nodes, from the samples around them."""

from collections.abc import Iterator, Sequence

import numpy as np

from solvers.equations.quantities import Array
from solvers.integration.prepare import NotFinishedError
from solvers.scenes.fitting.experiment import Experiment
from solvers.scenes.fitting.least_squares import NotConvergedError, minimise

#: Samples of the parabola whose value and slope are those of a coordinate at a node.
SAMPLES = 7
#: Attempts from random first guesses of runs' starts, how many each, and their spread.
ATTEMPTS, GUESSES, SPREAD = 10, 1, 1.5


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
    yield _from_fits(experiment, [start], params, noise)
    for _ in range(ATTEMPTS):
        guesses = start + SPREAD * random.normal(size=(GUESSES, len(start)))
        yield _from_fits(experiment, [*guesses], params, noise)


def _from_coordinates(experiment: Experiment, rows: dict[str, int]) -> Array:
    module, nodes = experiment.module, []
    n = len(module.COORDINATES)
    for segment in experiment.segments:
        t, table = experiment.runs[segment.run].t, experiment.tables[segment.run]
        node = np.zeros(2 * n)
        for k, name in enumerate(module.STATE):
            if name not in rows or (k >= n and not np.isfinite(table[rows[name]]).any()):
                continue
            finite = np.flatnonzero(np.isfinite(table[rows[name]]))
            nearest = finite[np.argsort(np.abs(t[finite] - segment.begin), kind="stable")[:SAMPLES]]
            times, degree = t[nearest] - segment.begin, min(2, len(nearest) - 1)
            powers = (times[:, np.newaxis] / (span := np.ptp(times) or 1.0)) ** np.arange(
                degree + 1
            )
            value, *slopes = np.linalg.lstsq(powers, table[rows[name], nearest], rcond=None)[0]
            node[k] = value
            if k < n and slopes:
                node[n + k] = slopes[0] / span
        nodes.append(node)
    return np.array(nodes)


def _from_fits(
    experiment: Experiment, starts: Sequence[Array], params: Array, noise: Array
) -> Array:
    """One segment after the other, each from the end of the one before."""
    nodes, end = list[Array](), starts[0]
    for k in range(len(experiment.segments)):
        guesses = starts if k in experiment.firsts else [end]
        alone = experiment.alone(k, params)
        fits = [_fitted(alone, guess, noise) for guess in guesses]
        _, node, end = min(fits, key=lambda fit: fit[0])
        nodes.append(node)
    return np.array(nodes)


def _fitted(alone: Experiment, guess: Array, noise: Array) -> tuple[float, Array, Array]:
    """Sum of squares of a segment with known parameters, state at its node and at its end."""
    linearise, none = alone.linearise(noise), np.empty(0)
    try:
        nodes = minimise(
            linearise, guess[np.newaxis], none, alone.positive, np.ones(len(guess))
        ).nodes
    except NotConvergedError:
        nodes = guess[np.newaxis]
    try:
        return linearise(nodes, none).squares, nodes[0], alone.shooting(nodes, alone.params).ends[0]
    except NotFinishedError:
        return np.inf, guess, guess
