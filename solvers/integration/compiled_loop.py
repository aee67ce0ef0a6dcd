"""Whether a loop can be compiled, and one motion in it."""

from __future__ import annotations

from collections.abc import Callable
from warnings import warn

import numpy as np

from solvers.equations.forms import fastest_form
from solvers.equations.module import header
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.compiled.kernel import Batch, Kernel, kernel
from solvers.integration.compiled.layout import MAX_EVENTS, STATUSES
from solvers.integration.events import Event, Extremum
from solvers.integration.problem import Outcome, Problem
from solvers.runge_kutta.tableau import Tableau

#: Steps, and occurrences of an event, that are written before Python collects them.
ROOM, ROOM_FOR_EVENTS = 4096, 64
#: Unknowns of an implicit step that C solves for; more would not fit on a thread's stack.
MOST_UNKNOWNS = 100
#: Seconds between looks whether the user has interrupted.
PATIENCE = 0.05


def obstacle(problem: Problem) -> str:
    """Why the problem cannot be run in a compiled loop; empty if it can."""
    if not isinstance(problem.method, Tableau):
        return "the method is SciPy's"
    unknowns = problem.method.stages * len(problem.form.state)
    if not problem.method.is_explicit and unknowns > MOST_UNKNOWNS:
        return f"its stages have {unknowns} unknowns, more than {MOST_UNKNOWNS}"
    if problem.atol.ndim:
        return "atol differs by component"
    if len(problem.events) > MAX_EVENTS:
        return f"there are more than {MAX_EVENTS} events"
    if header(problem.form.module) is None:
        return "there is no C header beside the module"
    for event in problem.events:
        if not isinstance(event, Event):
            return "an event is a Python function; solvers.integration.events.Event is known in C"
        kept = [event.coordinate] if isinstance(event, Extremum) else []
        for name in (event.name, *kept):
            if problem.form.locate(name) is None:
                return f"the {problem.form.name} form does not hold {name}"
    return ""


def choice(
    asked: Callable[[str], Problem], form: str | None, where: str | None, method: str,
    *, lanes: bool, compensated: bool,
) -> tuple[Problem, Kernel | None]:  # fmt: skip
    """The problem in the form that will run, and the loop for it; None if it runs in Python.

    Parameters
    ----------
    asked : callable
        Gives the problem in a form.
    form : str or None
        The form that is wanted, if any.
    where : {"compiled", "python"} or None
        Where it must run, if that is not free.
    method, lanes, compensated
        As in `solvers.integration.compiled.kernel.Kernel`.

    Returns
    -------
    problem : Problem
        In the form that is wanted; or else in the fastest one where a loop of an explicit method is
        compiled, and in Lagrange's elsewhere.
    program : Kernel or None
        The compiled loop.

    Raises
    ------
    ValueError
        When it must be compiled and cannot.
    solvers.integration.compiled.compiler.NoCompilerError
        When it must be compiled and no compiler could.

    Warns
    -----
    UserWarning
        When no compiler could, and it runs in Python.
    """
    plain = asked(form or "lagrangian")
    reason = "" if where == "python" else obstacle(plain)
    if reason and where == "compiled":
        raise ValueError(f"no compiled loop can do this: {reason}")
    if reason or where == "python":
        return plain, None
    module = plain.form.module
    assert isinstance(plain.method, Tableau)
    quick = asked(form or (fastest_form(module) if plain.method.is_explicit else "lagrangian"))
    try:
        return quick, kernel(
            module, quick.form.name, method,
            lanes=lanes, compensated=compensated, reproducible=False,
        )  # fmt: skip
    except NoCompilerError as error:
        if where == "compiled":
            raise
        warn(f"integrating in Python: {error}", stacklevel=3)
        return plain, None


def run(problem: Problem, outcome: Outcome, program: Kernel) -> None:
    """Integrate `problem`, keeping in `outcome` what is found as it is found."""
    samples = problem.samples
    outcome.backend = f"compiled by {program.library.compiler}"
    batch = Batch(
        program, problem, problem.form, problem.start[np.newaxis],
        capacity=ROOM if samples is None else len(samples), occurrences=ROOM_FOR_EVENTS,
        pauses=True,
    )  # fmt: skip
    status = None
    while status is None:
        batch.restart(PATIENCE)
        try:
            batch.run()
        finally:  # an interruption is heard when C returns: keep what C has done
            status = STATUSES[batch.motions["status"][0]]
            _collect(batch, problem, outcome)
    outcome.status = status


def _collect(batch: Batch, problem: Problem, outcome: Outcome) -> None:
    """Move what the motion has written into `outcome`, and make room for more."""
    motion, events = batch.motions[0], range(len(problem.events))
    taken = 0 if problem.samples is None else sum(map(len, outcome.t))
    rows = batch.rows[0, taken : motion["rows"]]
    times = rows["t"] if problem.samples is None else problem.samples[taken : motion["rows"]]
    states = batch.form.to_ordinary_many(rows["t"], rows["z"], rows["turns"])
    if len(states) and not outcome.t and times[0] == problem.span[0]:
        states[0] = problem.start  # as it was given, not as sine and cosine give it back
    occurred = [batch.event_rows[0, k, : motion["occurred"][k]] for k in events]
    places = [
        list(batch.form.to_ordinary_many(rows["t"], rows["z"], rows["turns"])) for rows in occurred
    ]
    place = batch.form.to_ordinary_many(
        motion["t"], motion["z"][np.newaxis], motion["turns"][np.newaxis]
    )[0]
    outcome.t.append(times.copy())
    outcome.y.append(states)
    for k in events:
        outcome.t_events[k] += occurred[k]["t"].tolist()
        outcome.y_events[k] += places[k]
    if motion["steps"]:
        outcome.end = float(motion["t"]), place
    outcome.nfev, outcome.njev = int(batch.nfev[0]), int(batch.njev[0])
    outcome.steps, outcome.rejected = int(motion["steps"]), int(motion["rejected"])
    motion["occurred"] = 0
    if problem.samples is None:  # else the number of rows says which sample is next
        motion["rows"] = 0
