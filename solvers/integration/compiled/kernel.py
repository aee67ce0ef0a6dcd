"""Compiled loops: the C program for one form and one method, called from Python for many motions.

The program consists of the module's generated header, the method's stages written out from its
tableau, and the handwritten files in the folder ``c``.
"""

import ctypes
from collections.abc import Sequence
from functools import cache
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from solvers.equations.forms import Form
from solvers.equations.module import GeneratedModule
from solvers.integration.compiled.compiler import build
from solvers.integration.compiled.equations_source import (
    EquationsSource,
    equations_text,
    projection_text,
    sliding_text,
)
from solvers.integration.compiled.memory_layout import (
    EVENT,
    STATUSES,
    Task,
    check,
    declarations,
    record,
    source,
)
from solvers.integration.compiled.method_source import constants_text, extension_text, method_text
from solvers.integration.compiled.native import equations
from solvers.integration.problem.events import Event, Extremum
from solvers.integration.problem.problem import SHORTEST, Problem
from solvers.integration.problem.status import Status
from solvers.runge_kutta.method_catalogue import load
from solvers.runge_kutta.stepper import Array
from solvers.runge_kutta.tableau import Tableau

PROGRAM = """\
#include <float.h>
#include <stddef.h>
#include <string.h>
#include <time.h>
{lanes}
{lanes_h}
{functions}
{constants}
{equations}
{layout}
static const int SINE[] = {{{sine}}}, RATE[] = {{{rate}}};
{sliding}
#define COMPENSATED {compensated}
{step_h}
{projection}
{method}
{motion_h}
{switching}
{extension}
{loop}
{single}"""

#: Handwritten files of the loop over steps, in their order.
LOOP_FILES = (
    *("within_step.h", "event_location.h", "substeps.h", "motions.h", "event_brackets.h"),
    *("cubic.h", "process_step.h", "finish_step.h", "advance.h", "integrator.c", "probe.h"),
)

#: Conversion between ordinary states and those of the form, for single motions.
SINGLE = """\
enum {{ ORDINARY = {ordinary}, MIN_H_ULPS = {shortest} }};

static void from_ordinary(
    double t, const double *y, double *z, double *turns, const double *params)
{{
{from_ordinary}
    (void)t; (void)turns; (void)params;
}}

static void to_ordinary(
    double t, const double *z, const double *turns, double *y, const double *params)
{{
{to_ordinary}
    (void)t; (void)turns; (void)params;
}}
{single_h}
"""


def program(
    equations: EquationsSource,
    tableau: Tableau,
    *,
    lanes: bool,
    compensated: bool,
    variations: int = 0,
) -> str:
    """The text of the C99 program, with the functions ``run`` and, without lanes, ``single``.

    With lanes it integrates many motions at once, by explicit methods only. If `compensated`, it
    carries the rounding errors of the state along. The last `variations` components of the state
    are a variation, out of which powers of two are taken where it is large.
    """
    sines, rates = ([pair[part] for pair in equations.angles] or [0] for part in (0, 1))
    sizes = equations.sizes(tableau, compensated=compensated, variations=variations)
    single = SINGLE.format(
        ordinary=equations.ordinary,
        shortest=SHORTEST,
        from_ordinary="\n".join(f"    {line}" for line in equations.from_ordinary),
        to_ordinary="\n".join(f"    {line}" for line in equations.to_ordinary),
        single_h=source("single.h"),
    )
    files = ("lanes.h", "step.h", "motion.h")
    return PROGRAM.format(
        lanes="#define HOLONOMIC_VECTOR" if lanes else "#define ONE_LANE",
        functions=source("lane_functions.h") if lanes else "",
        constants=constants_text(tableau),
        equations=equations_text(equations, tableau),
        layout=declarations(sizes),
        sine=", ".join(map(str, sines)),
        rate=", ".join(map(str, rates)),
        compensated=int(compensated),
        method=method_text(tableau),
        sliding=sliding_text(equations, tableau),
        projection=projection_text(equations, tableau),
        switching=source("switching.h") if equations.switches else "",
        extension=extension_text(tableau),
        loop="\n".join(map(source, LOOP_FILES)),
        single="" if lanes else single,
        **{name.replace(".", "_"): source(name) for name in files},
    )


class Kernel:
    """The compiled program for one form of a module's equations and one method.

    With `lanes` it runs many motions at once, where right-hand side and method allow it; else it
    also has the function `single`, for a motion from start to end. Steps end at zeros of switching
    functions, but those of parallel stages. If `compensated`, the state's rounding errors are
    carried along; if `reproducible`, every compiler gives the same bits.
    """

    def __init__(
        self,
        module: GeneratedModule,
        form: str,
        method: str,
        lanes: bool = False,
        compensated: bool = False,
        *,
        reproducible: bool = False,
    ) -> None:
        tableau = load(method)
        source = equations(
            module, form, jacobian=tableau.needs_jacobian, switches=not tableau.is_parallel
        )
        # lanes have sines of their own, whose bits are not those of single motions
        vectors = lanes and tableau.is_explicit and (source.vectorises or not reproducible)
        # a single motion is rescaled in Python instead
        variations = source.ordinary // 2 if lanes and form == "variational" else 0
        extent: dict[str, Any] = {"compensated": compensated, "variations": variations}
        sizes = source.sizes(tableau, **extent)
        text = program(source, tableau, lanes=vectors, **extent)
        self.library = build(text, reproducible=reproducible)
        library = self.library.functions
        check(library, sizes)
        self.run = library.run  # releases the global interpreter lock
        self.run.restype, self.run.argtypes = None, [ctypes.POINTER(Task)]
        self.single = None if lanes else library.single
        library.fuses_products.restype = ctypes.c_int64
        self.fuses_products = bool(library.fuses_products())
        self.switches = source.switches
        self.trajectory, self.row = record("Trajectory", sizes), record("Row", sizes)


#: Kernels that this process has loaded.
kernel = cache(Kernel)


class Batch:
    """Motions in memory, and the task of integrating them.

    `starts` are ordinary initial states in rows, by default that of the problem; its form has
    arrays of parameters if they differ. Each motion may write `capacity` rows for its samples or
    the ends of its steps, and `occurrences` rows for each event; `pauses` when they are full.
    """

    def __init__(
        self,
        kernel: Kernel,
        problem: Problem,
        starts: Array | None = None,
        *,
        capacity: int = 0,
        occurrences: int = 0,
        pauses: bool = False,
    ) -> None:
        starts = problem.start[np.newaxis] if starts is None else starts
        n, form = len(starts), problem.form
        requested = cast("list[Event]", [*problem.events, *problem.limits])
        events = [_event(form, event, pauses) for event in requested]
        events += map(_switch, range(kernel.switches))
        self._kernel, self.form = kernel, form
        self.motions = np.zeros(n, kernel.trajectory)  # Trajectory in c/layout.h
        self.motions["t"], self.motions["t_end"] = problem.span
        self.motions["min_h"] = SHORTEST * np.spacing(np.abs(problem.span).max())
        self.motions["z"], self.motions["turns"] = form.from_ordinary_many(problem.span[0], starts)
        for k, parameter in enumerate(form.params):
            self.motions["params"][:, k] = parameter
        self.rows = np.zeros((n, capacity), kernel.row)
        self.event_rows = np.zeros((n, len(events), occurrences), kernel.row)
        self.stop = np.zeros(1, np.int64)  # any other value makes `run` return
        self._times = np.empty(0) if problem.samples is None else problem.samples
        self._events = np.array(events, EVENT)
        self.task = Task(
            count=n,
            trajectories=self.motions.ctypes.data,
            rtol=problem.rtol,
            atol=float(problem.atol),
            fixed_h=problem.h or 0.0,
            collapse=problem.collapse,
            max_steps=problem.max_steps,
            samples=-1 if problem.samples is None else len(problem.samples),
            times=self._times.ctypes.data,
            capacity=capacity,
            rows=self.rows.ctypes.data,
            event_count=len(events),
            events=self._events.ctypes.data,
            event_capacity=occurrences,
            event_rows=self.event_rows.ctypes.data,
            pauses=pauses,
            stop=self.stop.ctypes.data,
        )

    def resume(self, problem: Problem, starts: Array | None = None) -> None:
        """Let motions that are new or finished go on to the end of `problem`, with its params.

        `starts` are ordinary states in rows from which they go on, instead of those they reached.
        """
        motions, new = self.motions, STATUSES.index(None)
        motions["held"] = 0
        goes_on = np.isin(motions["status"], (new, STATUSES.index(Status.FINISHED)))
        motions["status"][goes_on] = new
        motions["t_end"][goes_on] = problem.span[1]
        motions["min_h"][goes_on] = SHORTEST * np.spacing(np.abs(problem.span).max())
        for k, parameter in enumerate(problem.form.params):
            motions["params"][:, k] = parameter
        if starts is not None:
            states = self.form.from_ordinary_many(problem.span[0], starts)
            motions["z"], motions["turns"] = states
            motions["scale"] = 0

    def set_times(self, ends: Array, samples: Array) -> None:
        """Give motions their own ends and sample times, in rows; one row is for all motions."""
        self.motions["t_end"] = ends
        latest = np.maximum(np.abs(self.motions["t"]), np.abs(ends))
        self.motions["min_h"] = SHORTEST * np.spacing(latest)
        self._times = np.ascontiguousarray(samples)
        self.task.samples, self.task.times = samples.shape[1], self._times.ctypes.data
        self.task.own_times = samples.shape[1] if len(samples) > 1 else 0

    def skip(self, numbers: Sequence[int]) -> None:
        """Leave out the first occurrences of each event, these many."""
        self._events["skip"][: len(numbers)] = numbers

    def hold(self, ends: Array, values: Array, first: NDArray[np.intp] | int = 0) -> None:
        """Let motions change their inputs at the ends of `values`, of shape (values, inputs).

        Motions begin with the values at the indices `first`, and end before an end that is NaN.
        """
        self._holds = (np.ascontiguousarray(ends), np.ascontiguousarray(values))
        self.task.holds, self.task.inputs = values.shape
        self.task.first_input = len(self.form.params) - values.shape[1]
        self.task.hold_ends, self.task.hold_values = (part.ctypes.data for part in self._holds)
        self.motions["held"], self.motions["t_end"] = first, ends[first]
        self.motions["params"][:, self.task.first_input :] = values[first]

    def restart(self, time_limit: float = 0.0) -> None:
        """Let the next `run` start with the first motion, and return after `time_limit` seconds."""
        self.task.next, self.task.time_limit = 0, time_limit

    def run(self) -> None:
        """Continue unfinished motions; several threads may do so at once."""
        self._kernel.run(self.task)

    def ordinary(self, rows: NDArray[np.void], motions: NDArray[np.intp] | None = None) -> Array:
        """Ordinary states, in rows, of `rows` of some motions, by default of all.

        Powers of two that were taken out of a variation are its rows' ``scale``.
        """
        form = self.form
        if motions is not None and any(np.size(parameter) > 1 for parameter in form.params):
            own = [np.broadcast_to(p, len(self.motions))[motions] for p in form.params]
            form = Form(form.module, form.name, own)
        states = form.to_ordinary_many(rows["t"], rows["z"], rows["turns"])
        if rows["scale"].size:
            n = states.shape[1] // 2
            with np.errstate(over="ignore"):
                states[:, n:] = np.ldexp(states[:, n:], rows["scale"].astype(int))
        return states

    @property
    def extremes_only(self) -> NDArray[np.bool_]:
        """Which events keep two rows only, of the smallest and the largest value."""
        return self._events["extremes_only"] != 0

    @property
    def nfev(self) -> NDArray[np.int64]:
        """Evaluations of the right-hand side by each motion."""
        evaluations = self.motions["evaluations"].astype(np.int64)
        first = 1 if self.task.fixed_h else 2  # at the start, and to choose the first step
        return evaluations + first * (evaluations > 0)

    @property
    def njev(self) -> NDArray[np.int64]:
        """Evaluations of the Jacobian."""
        return self.motions["jacobians"].astype(np.int64)


def _switch(index: int) -> tuple[float | int, ...]:
    """A switching function as an event that ends a step."""
    return (0.0, 0.0, 0.0, 0, index, 0, 1, 0, 0, 0, 0, 1)


def _event(form: Form, event: Event, pauses: bool) -> tuple[float | int, ...]:
    """An event as a record of type ``Event`` in ``c/layout.h``."""
    # a motion that pauses has room for every occurrence
    extremes_only = isinstance(event, Extremum) and not pauses
    component = form.locate(event.name)
    extremum = form.locate(event.coordinate) if isinstance(event, Extremum) else (False, 0)
    assert component is not None
    assert extremum is not None
    angle = event.value, np.sin(event.value), np.cos(event.value)
    flags = event.direction, int(event.terminal), int(extremes_only), 0
    return (*angle, *map(int, component), *flags, *map(int, extremum), 0)
