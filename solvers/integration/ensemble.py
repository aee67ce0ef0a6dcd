"""Many motions at once: in vector lanes, over all cores."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solvers.equations.forms import Form
from solvers.equations.module import GeneratedModule, state_names
from solvers.integration import compiled_loop, python_loop, scipy_loop, validation
from solvers.integration.compiled.kernel import Batch
from solvers.integration.compiled.layout import STATUSES
from solvers.integration.events import Event, Extremum
from solvers.integration.problem import Outcome, Problem
from solvers.integration.solution import Ensemble, Interrupted, Status
from solvers.runge_kutta.tableau import Tableau

Array = NDArray[np.float64]


def ensemble(
    module: GeneratedModule,
    t_span: ArrayLike,
    Y0: ArrayLike,
    params: ArrayLike,
    *,
    method: str = "verner87",
    form: str | None = None,
    rtol: float = 1e-9,
    atol: float = 1e-12,
    h: float | None = None,
    t_eval: ArrayLike | None = None,
    events: Event | Sequence[Event] = (),
    occurrences: int = 1,
    max_steps: int = 1_000_000,
    backend: str | None = None,
    compensated: bool = False,
    workers: int | None = None,
) -> Ensemble:
    """Integrate many motions over the same time span.

    What a motion's numbers are depends neither on the other motions nor on `workers`.

    Parameters
    ----------
    module : module
        A generated module, such as ``generated.double_pendulum``.
    t_span : pair of float
        Beginning and end in s; the end may come first.
    Y0 : array_like of shape (n, state)
        Coordinates and velocities at the beginning of each motion, in the order of
        ``module.STATE``; in the variational form each is followed by a small change.
    params : array_like of shape (parameters,) or (n, parameters)
        In the order of ``module.PARAMETERS``; the same for all motions or a row for each.
    method : str, optional
        One of ``solvers.runge_kutta.catalogue.names()``, or a method of SciPy's ``solve_ivp``.
    form : {"lagrangian", "hamiltonian", "rational", "variational"}, optional
        The equations that are integrated, as in `solvers.integration.integrate.integrate`.
    rtol, atol : float, optional
        A step's error in a component may be atol + rtol |y|; without effect on fixed steps.
    h : float, optional
        A fixed step in s; methods without error estimate need one.
    t_eval : array_like of shape (times,), optional
        Times in s at which states are wanted, none by default.
    events : Event or sequence of Event, optional
        What to watch.
    occurrences : int, optional
        How many occurrences of each event to keep, counted from the beginning; of an
        `solvers.Extremum` the two with the smallest and the largest value, so that it must
        be 2 or more.
    max_steps : int, optional
        After so many steps a motion stops with what it has.
    backend : {"compiled", "python"}, optional
        Where the loop runs; by default compiled if that is possible.
    compensated : bool, optional
        Whether a compiled loop carries the states' rounding errors along.
    workers : int, optional
        Number of threads; by default one for each processor.

    Returns
    -------
    Ensemble
        Motions in the order of `Y0`. One that does not reach its end raises nothing: its
        ``status`` says why.

    Raises
    ------
    ValueError
        When an argument makes no sense, before anything is computed.
    solvers.runge_kutta.catalogue.UnknownMethodError
        When no method has this name.
    solvers.integration.compiled.compiler.NoCompilerError
        When ``backend="compiled"`` or ``compensated=True``, and no compiler could build the loop.
    solvers.integration.solution.Interrupted
        When the user interrupts; it holds the `Ensemble` up to there.

    Warns
    -----
    UserWarning
        When no compiler could build the loop, and it runs in Python.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> starts = [(0.1 * k, 0.0, 0.0, 0.0) for k in range(20)]
    >>> motions = ensemble(dp, (0, 5), starts, dp.DEFAULTS)
    >>> motions.y.shape
    (20, 4)
    """
    names = state_names(module, form or "")
    starts = validation.table("Y0", Y0, names)
    constants = validation.table("params", np.atleast_2d(np.asarray(params)), module.PARAMETERS)
    if len(constants) not in (1, len(starts)):
        raise ValueError(
            f"params has {len(constants)} rows: give one, or one for each of {len(starts)} motions"
        )
    watched = [events] if isinstance(events, Event) else events
    extremes = any(isinstance(event, Extremum) for event in watched)
    occurrences = validation.count("occurrences", occurrences, 2 if extremes else 1)
    threads = len(os.sched_getaffinity(0)) if workers is None else workers
    threads = validation.count("workers", threads, 1)
    times = () if t_eval is None else t_eval
    where = validation.rung(backend, compensated)

    def asked(form: str) -> Problem:
        rest = (0.0,) * len(names)
        return validation.problem(
            module, t_span, rest, module.DEFAULTS, method, form, rtol, atol, h, times, events,
            max_steps,
        )  # fmt: skip

    problem, program = compiled_loop.choice(
        asked, form, where, method, lanes=True, compensated=compensated
    )
    assert problem.samples is not None
    rung = f"compiled by {program.library.compiler}" if program else "python"
    result = Ensemble.unknown(
        len(starts), len(names), len(problem.samples), len(problem.events), occurrences,
        f"{problem.description}, {rung}",
    )  # fmt: skip
    is_variational = problem.form.name == "variational"
    if is_variational:
        result.growth[:] = _logarithm(starts[:, len(module.STATE) :])
    try:
        if program:
            batch = Batch(
                program, problem, Form(module, problem.form.name, list(constants.T)), starts,
                capacity=len(problem.samples), occurrences=occurrences, pauses=False,
            )  # fmt: skip
            try:
                _run(batch, threads)
            finally:
                _collect(batch, result)
                # as they were given, not as sine and cosine give them back
                result.y[result.steps == 0] = starts[result.steps == 0]
                if len(problem.samples) and problem.samples[0] == problem.span[0]:
                    result.samples[:, :, 0] = starts
            return result
        try:
            _run_one_by_one(problem, starts, constants, result)
        finally:
            if is_variational:
                result.growth[:] = _logarithm(result.y[:, len(module.STATE) :]) - result.growth
    except KeyboardInterrupt as interruption:
        raise Interrupted(result) from interruption
    return result


def _run(batch: Batch, workers: int) -> None:
    """Run all motions in threads; C works without Python's lock, this thread hears the user."""
    batch.restart()
    _running.append(batch.stop)
    try:
        with ThreadPoolExecutor(workers) as pool:
            threads = [pool.submit(batch.run) for _ in range(workers)]
            try:
                wait(threads)
            except KeyboardInterrupt:
                batch.stop[0] = 1
                raise
    finally:
        _running[:] = [stop for stop in _running if stop is not batch.stop]
    for thread in threads:
        thread.result()


#: The stops of all batches that are running, in whatever thread.
_running: list[NDArray[np.int64]] = []


def stop() -> None:
    """Let every ensemble that runs in this process stop where it is.

    Only the main thread hears an interruption: it passes it on to the others.
    """
    for running in _running[:]:
        running[0] = 1


def _run_one_by_one(
    problem: Problem, starts: Array, constants: Array, result: Ensemble
) -> None:  # fmt: skip
    rung = python_loop if isinstance(problem.method, Tableau) else scipy_loop
    for k, start in enumerate(starts):
        params = constants[k % len(constants)].tolist()
        form = Form(problem.form.module, problem.form.name, params)
        one = replace(problem, start=start, form=form)
        outcome = Outcome.at_start(one)
        try:
            rung.run(one, outcome)
        finally:
            _take(outcome, k, problem.events, result)


def _collect(batch: Batch, result: Ensemble) -> None:
    """What the motions of a batch have found."""
    motions = batch.motions
    result.t[:], result.y[:] = _passed(batch, np.arange(len(motions)), motions)
    if motions["scale"].size:
        changes = motions["z"][:, -(result.y.shape[1] // 2) :], motions["scale"][:, 0]
        result.growth[:] = _logarithm(*changes) - result.growth
    result.status[:] = np.array(STATUSES, object)[motions["status"]]
    result.status[motions["status"] < STATUSES.index(Status.FINISHED)] = Status.INTERRUPTED
    for name in ("steps", "rejected"):
        getattr(result, name)[:] = motions[name]
    result.nfev[:] = batch.nfev
    for k in range(result.samples.shape[-1]):
        there = np.flatnonzero(motions["rows"] > k)
        _, result.samples[there, :, k] = _passed(batch, there, batch.rows[there, k])
    result.occurred[:] = motions["occurred"][:, : result.occurred.shape[1]]
    kept = np.where(batch.extremes_only, np.minimum(result.occurred, 2), result.occurred)
    for event, k in np.ndindex(result.t_events.shape[1:]):
        there = np.flatnonzero(kept[:, event] > k)
        times, states = _passed(batch, there, batch.event_rows[there, event, k])
        result.t_events[there, event, k], result.y_events[there, event, k] = times, states


def _passed(batch: Batch, there: NDArray[np.intp], rows: NDArray[np.void]) -> tuple[Array, Array]:
    """Times and ordinary states of rows that some motions have written."""
    form = batch.form
    if any(np.size(parameter) > 1 for parameter in form.params):
        own = [np.broadcast_to(p, len(batch.motions))[there] for p in form.params]
        form = Form(form.module, form.name, own)
    states = form.to_ordinary_many(rows["t"], rows["z"], rows["turns"])
    if rows["scale"].size:
        n = states.shape[1] // 2
        with np.errstate(over="ignore"):
            states[:, n:] = np.ldexp(states[:, n:], rows["scale"].astype(int))
    return rows["t"], states


def _logarithm(change: Array, scale: ArrayLike = 0.0) -> Array:
    """Natural logarithms of the lengths of small changes in rows, times powers of two."""
    largest = np.abs(change).max(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        length = np.log(largest) + np.log(np.linalg.norm(change.T / largest, axis=0))
    return np.asarray(length + np.log(2) * np.asarray(scale))


def _take(found: Outcome, k: int, events: Sequence[object], result: Ensemble) -> None:
    """What one motion, integrated by itself, has found."""
    result.t[k], result.y[k] = found.end
    result.status[k], result.nfev[k] = found.status, found.nfev
    result.steps[k], result.rejected[k] = found.steps, found.rejected
    _, rows = found.rows()
    result.samples[k, :, : len(rows)] = rows.T
    kept = result.t_events.shape[-1]
    for event, (times, states) in enumerate(zip(found.t_events, found.y_events, strict=True)):
        result.occurred[k, event] = len(times)
        places, watched = [*range(len(times))], events[event]
        if isinstance(watched, Extremum) and times:
            values = [y[watched.module.STATE.index(watched.coordinate)] for y in states]
            places = [int(np.argmin(values)), int(np.argmax(values))]
        for which, place in enumerate(places[:kept]):
            result.t_events[k, event, which] = times[place]
            result.y_events[k, event, which] = states[place]
