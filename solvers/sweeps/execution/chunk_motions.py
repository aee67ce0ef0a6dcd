"""Integration of the motions of a chunk, in one thread."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from solvers.equations.singularities.mass_matrix import checked_before
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.ensemble import ensemble
from solvers.integration.loops.stop_flag import StopFlag
from solvers.integration.problem.status import Status
from solvers.integration.results.ensemble_solution import Ensemble
from solvers.sweeps.definition.axes import Array
from solvers.sweeps.definition.sweep import Sweep


def after_transient(
    sweep: Sweep, starts: Array, params: list[Array], stop: StopFlag | None
) -> tuple[Array, Ensemble]:
    """States at `sweep.skip`, and the motions up to there; those that fail keep their start."""
    module, form = sweep.module, sweep.unchecked(maps={}).form
    n = len(module.STATE)
    options = sweep.options | {"form": form}
    span = 0.0, sweep.skip
    motions = integrate_all(sweep, span, starts[:, :n], params, stop, options)
    return np.hstack([np.where(motions.success, motions.y, starts.T[:n]).T, starts[:, n:]]), motions


def integrated(
    sweep: Sweep, starts: Array, params: list[Array], stop: StopFlag | None = None
) -> Ensemble:
    """The motions after `sweep.skip`, in one thread."""
    maps = sweep.maps.values()
    events = [(event, one.skip) for one in maps for event in one.events(sweep.module)]
    ends, samples = sweep.times(params)
    options = sweep.options | {
        "events": [replace(event, terminal=sweep.ends_at_event) for event, _ in events],
        "skip": [skip for _, skip in events],
        "occurrences": max(one.occurrences for one in maps),
        "t_eval": samples if samples.size else None,
    }
    return integrate_all(sweep, (sweep.skip, ends), starts, params, stop, options)


def integrate_all(
    sweep: Sweep,
    span: tuple[float, float | Array],
    starts: Array,
    params: list[Array],
    stop: StopFlag | None,
    options: Mapping[str, Any],
) -> Ensemble:
    """Motions with these options, in one thread; `InterruptedError` once `stop` is set."""
    constants = np.stack(params) if params else ()
    with ignore_predictability(), checked_before():
        motions = ensemble(sweep.module, span, starts.T, constants, workers=1, stop=stop, **options)
    if (motions.status == Status.INTERRUPTED).any():
        raise InterruptedError("the sweep was stopped")
    return motions
