"""One motion in a compiled loop."""

from contextlib import suppress
from threading import Thread

from solvers.equations.forms import fastest_form
from solvers.equations.module import GeneratedModule, has_header
from solvers.equations.number_checks import NotFiniteNumberError
from solvers.integration.compiled.compiler import NoCompilerError, is_ahead
from solvers.integration.compiled.kernel import Batch, Kernel, kernel
from solvers.integration.compiled.memory_layout import MAX_EVENTS, STATUSES
from solvers.integration.problem.events import Event
from solvers.integration.problem.problem import Problem
from solvers.integration.problem.status import Status
from solvers.integration.results.recorder import Outcome
from solvers.io.suggestion import warn_caller
from solvers.runge_kutta.method_catalogue import load
from solvers.runge_kutta.tableau import Tableau

#: Steps, and occurrences of an event, that C stores before Python collects them.
ROW_CAPACITY, EVENT_CAPACITY = 4096, 64
#: Seconds of C between checks for an interruption by the user.
TIME_LIMIT = 0.05
#: Threads that compile, by the arguments of `kernel`.
_threads: dict[tuple[GeneratedModule, str, str, bool, bool], Thread] = {}


def obstacle(problem: Problem) -> str:
    """The reason why no compiled loop can solve the problem; empty if one can."""
    if not isinstance(problem.method, Tableau):
        return "the method is SciPy's"
    if problem.atol.ndim:
        return "atol differs by component"
    if problem.form.feedback:
        return (
            "inputs is a Python function; hold them between samples (solvers.Held), or replace "
            "them by formulas (derive.with_inputs)"
        )
    if len(problem.all_events) > MAX_EVENTS:
        return f"there are more than {MAX_EVENTS} events"
    if not has_header(problem.form.module):
        return "there is no C header beside the module"
    count = problem.form.switching_count
    if count and problem.method.is_parallel:
        return "forces have kinks or jumps, at which parallel stages do not end steps"
    if count and len(problem.all_events) + count > MAX_EVENTS:
        return f"there are more than {MAX_EVENTS} events and switching functions"
    for event in problem.all_events:
        if not isinstance(event, Event):
            return "an event is a Python function; use solvers.integration.problem.events.Event"
        for name in event.components:
            if problem.form.locate(name) is None:
                return f"the {problem.form.name} form does not hold {name}"
    return ""


def select(problem: Problem, *, lanes: bool) -> tuple[Problem, Kernel | None]:
    """The problem in the form to integrate, and its compiled loop; None if it runs in Python.

    Raises `ValueError` or `NoCompilerError` when it must be compiled and cannot; warns when no
    compiler could, and it runs in Python.
    """
    must_compile = problem.backend == "compiled"
    reason = "it is to run in Python" if problem.backend == "python" else ""
    reason = reason or obstacle(problem)
    if reason and must_compile:
        raise ValueError(f"no compiled loop can solve this problem: {reason}")
    if reason and lanes and problem.backend is None and isinstance(problem.method, Tableau):
        warn_caller(f"integrating one motion after another in Python: {reason}")
    if reason:
        return problem, None
    is_free = problem.options.form is None and load(problem.options.method).takes_any_form
    compilable = problem.with_form(fastest_form(problem.form.module)) if is_free else problem
    try:
        return compilable, loop(compilable, lanes=lanes)
    except NoCompilerError as error:
        if must_compile:
            raise
        warn_caller(f"integrating in Python: {error}")
        return problem, None


def loop(problem: Problem, *, lanes: bool = False) -> Kernel:
    """The compiled loop for the problem."""
    form, options = problem.form, problem.options
    arguments = form.module, form.name, options.method, lanes, options.compensated
    if thread := _threads.get(arguments):
        thread.join()
    return kernel(*arguments)


def compile_ahead(
    module: GeneratedModule, form: str, method: str, *, compensated: bool = False
) -> None:
    """Start to compile a loop in another thread, for which `loop` waits."""
    arguments = module, form, method, False, compensated

    def compile_loop() -> None:
        is_ahead.set(True)
        with suppress(Exception):  # `loop` raises it again
            kernel(*arguments)

    if arguments not in _threads and has_header(module):
        _threads[arguments] = Thread(target=compile_loop, daemon=True)
        _threads[arguments].start()


def run(problem: Problem, outcome: Outcome, program: Kernel) -> None:
    """Integrate `problem`; `outcome` holds the results so far at any time."""
    samples = problem.samples
    outcome.backend = f"compiled by {program.library.compiler}"
    capacity = ROW_CAPACITY if samples is None else len(samples)
    batch, status = None, Status.FINISHED
    table = problem.held_table(outcome.history)
    parts = iter([problem.with_inputs(table[1][0])]) if table else None
    try:
        for part in parts or problem.segments(lambda: outcome.end[1], outcome.history):
            if batch is None:
                room = EVENT_CAPACITY
                batch = Batch(program, part, capacity=capacity, occurrences=room, pauses=True)
                if table:
                    batch.hold(*table)
            else:
                batch.resume(part)
            running = None
            while running is None:
                batch.restart(TIME_LIMIT)
                try:
                    batch.run()
                finally:  # an interruption arrives when C returns: collect its results first
                    running = STATUSES[batch.motions["status"][0]]
                    _collect(batch, part, outcome)
            status = running
            if status is not Status.FINISHED:
                break
    except NotFiniteNumberError as failure:
        status = outcome.fail(failure)
    outcome.end_with(status, problem)


def _collect(batch: Batch, problem: Problem, outcome: Outcome) -> None:
    """Move the results of the motion into `outcome`, and free their rows."""
    motion, events = batch.motions[0], range(len(problem.all_events))
    collected = 0 if problem.samples is None else sum(map(len, outcome.t))
    rows = batch.rows[0, collected : motion["rows"]]
    times = rows["t"] if problem.samples is None else problem.samples[collected : motion["rows"]]
    states = batch.ordinary(rows)
    if len(states) and not outcome.t and times[0] == problem.span[0]:
        states[0] = problem.start  # as given, not as sine and cosine return it
    occurred = [batch.event_rows[0, k, : motion["occurred"][k]] for k in events]
    event_states = [list(batch.ordinary(rows)) for rows in occurred]
    end = batch.ordinary(batch.motions)[0]
    outcome.t.append(times.copy())
    outcome.y.append(states)
    for k in events:
        outcome.t_events[k] += occurred[k]["t"].tolist()
        outcome.y_events[k] += event_states[k]
    if motion["steps"]:
        outcome.end = float(motion["t"]), end
    outcome.nfev, outcome.njev = int(batch.nfev[0]), int(batch.njev[0])
    outcome.steps, outcome.rejected = int(motion["steps"]), int(motion["rejected"])
    motion["occurred"] = 0
    if problem.samples is None:  # else the number of rows tells the next sample
        motion["rows"] = 0
