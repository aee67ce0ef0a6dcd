"""Compiled loops: many motions of one form by one method, driven from Python."""

from __future__ import annotations

import ctypes
from functools import cache
from typing import cast

import numpy as np
from numpy.typing import NDArray

from solvers.equations.forms import Form
from solvers.equations.module import GeneratedModule
from solvers.integration.compiled.compiler import build
from solvers.integration.compiled.kernel_source import program
from solvers.integration.compiled.native import equations
from solvers.integration.events import Event, Extremum
from solvers.integration.problem import SHORTEST, Problem
from solvers.integration.solution import Status
from solvers.runge_kutta.catalogue import load

Array = NDArray[np.float64]

#: What the numbers of ``enum Status`` in C mean; the first two are motions that are not done.
STATUSES = (
    None,
    None,
    Status.FINISHED,
    Status.EVENT,
    Status.STEP_LIMIT,
    Status.NOT_FINITE,
    Status.STEP_TOO_SMALL,
    Status.NO_CONVERGENCE,
)
MOST_EVENTS = 8


#: How ``motion.h`` lays out what C and Python share.
EVENT = np.dtype([
    *((name, float) for name in ("value", "sine", "cosine")),
    *((name, np.int64) for name in ("is_angle", "index", "direction", "terminal")),
    *((name, np.int64) for name in ("keeps_extremes", "kept_is_angle", "kept")),
])  # fmt: skip


class _Task(ctypes.Structure):
    _fields_ = [
        *((name, ctypes.c_int64) for name in ("count", "trajectories", "next")),
        *((name, ctypes.c_double) for name in ("rtol", "atol", "fixed")),
        *((name, ctypes.c_int64) for name in ("most_steps", "samples", "times")),
        *((name, ctypes.c_int64) for name in ("capacity", "rows", "events", "event")),
        *((name, ctypes.c_int64) for name in ("occurrences", "event_rows", "pauses")),
        ("patience", ctypes.c_double),
        ("stop", ctypes.c_int64),
    ]


class Kernel:
    """The compiled program for one form of a module's equations and one method.

    Parameters
    ----------
    module : module
        A generated module.
    form : str
        One of its forms.
    method : str
        One of ours.
    lanes : bool
        Whether it is to run many motions at once, where right-hand side and method allow it.
    compensated : bool
        Whether the state's rounding errors are carried along.
    reproducible : bool
        Whether every compiler is to give the same bits.

    Attributes
    ----------
    run : ctypes function
        Takes a task; releases Python's lock while it runs.
    once : ctypes function or None
        Takes a task of one motion, its span, start and room for its end; not with lanes.
    trajectory, row : numpy.dtype
        Layout of a motion in memory, and of a place that it passes; their ``scale`` is the
        power of two that was taken out of a small change, of many motions' variational form.
    library : Library
        What was built, and by what.

    Raises
    ------
    solvers.integration.compiled.compiler.NoCompilerError
        When no compiler could build it.
    """

    def __init__(
        self, module: GeneratedModule, form: str, method: str, *,
        lanes: bool, compensated: bool, reproducible: bool,
    ) -> None:  # fmt: skip
        tableau, source = load(method), equations(module, form)
        vectors = lanes and source.vectorises and tableau.is_explicit
        # of many motions there is nobody who could make a change small again
        changes = source.ordinary // 2 if lanes and form == "variational" else 0
        scale = (int(changes > 0),)
        text = program(
            source, tableau, lanes=vectors, compensated=compensated, changes=changes
        )  # fmt: skip
        self.library = build(text, reproducible=reproducible)
        library = ctypes.CDLL(str(self.library.path))
        self.run = library.run
        self.run.restype, self.run.argtypes = None, [ctypes.POINTER(_Task)]
        self.once = None if lanes else library.once
        state, angles = (source.state,), (len(source.angles),)
        fields: list[tuple[str, type, tuple[int, ...]]] = [
            ("t", float, ()), ("t_low", float, ()), ("z", float, state),
            ("low", float, (compensated * source.state,)), ("turns", float, angles),
            ("first", float, (tableau.is_fsal * source.state,)), ("scale", float, scale),
            *((name, float, ()) for name in ("h", "previous", "steps", "rejected")),
            *((name, float, ()) for name in ("trials", "rounds", "cuts", "t_end", "shortest")),
            ("params", float, (source.parameters,)),
            ("status", np.int64, ()), ("rows", np.int64, ()),
            ("occurred", np.int64, (MOST_EVENTS,)),
        ]  # fmt: skip
        self.trajectory = np.dtype(fields)
        self.row = np.dtype([
            ("t", float), ("z", float, state), ("turns", float, angles),
            ("scale", float, scale),
        ])  # fmt: skip
        self.slopes = tableau.stages - tableau.is_fsal
        self.is_explicit = tableau.is_explicit
        if library.trajectory_size() != self.trajectory.itemsize:
            raise AssertionError("C and Python disagree about the layout of a trajectory")


#: Kernels that this process has loaded.
kernel = cache(Kernel)


class Batch:
    """Motions in memory, and what is asked of them.

    Parameters
    ----------
    kernel : Kernel
        What runs them.
    problem : Problem
        What is asked of all of them.
    form : Form
        The problem's form, with parameters for each motion if they differ.
    starts : ndarray of shape (n, state)
        Ordinary states at the beginning.
    capacity : int
        How many rows each motion may write: its samples, or the ends of its steps.
    occurrences : int
        How many rows each motion may write for each event.
    pauses : bool
        Whether a motion waits when its rows are full.

    Attributes
    ----------
    motions : structured ndarray of shape (n,)
        As in ``Trajectory``.
    rows, event_rows : structured ndarray of shape (n, capacity), (n, events, occurrences)
        What they have written.
    stop : ndarray of shape (1,)
        Anything but 0 makes all motions wait.
    task : ctypes structure
        What C is given.
    """

    def __init__(
        self, kernel: Kernel, problem: Problem, form: Form, starts: Array,
        *, capacity: int, occurrences: int, pauses: bool,
    ) -> None:  # fmt: skip
        n, events = len(starts), cast("list[Event]", problem.events)
        self._kernel, self.form = kernel, form
        self.motions = np.zeros(n, kernel.trajectory)
        self.motions["t"], self.motions["t_end"] = problem.span
        self.motions["shortest"] = SHORTEST * np.spacing(np.abs(problem.span).max())
        self.motions["z"], self.motions["turns"] = form.from_ordinary_many(problem.span[0], starts)
        for k, parameter in enumerate(form.params):
            self.motions["params"][:, k] = parameter
        self.rows = np.zeros((n, capacity), kernel.row)
        self.event_rows = np.zeros((n, len(events), occurrences), kernel.row)
        self.stop = np.zeros(1, np.int64)
        self._times = np.empty(0) if problem.samples is None else problem.samples
        self._events = np.array([_event(form, crossing, pauses) for crossing in events], EVENT)
        self.task = _Task(
            count=n, trajectories=self.motions.ctypes.data,
            rtol=problem.rtol, atol=float(problem.atol), fixed=problem.h or 0.0,
            most_steps=problem.max_steps,
            samples=-1 if problem.samples is None else len(problem.samples),
            times=self._times.ctypes.data, capacity=capacity, rows=self.rows.ctypes.data,
            events=len(events), event=self._events.ctypes.data, occurrences=occurrences,
            event_rows=self.event_rows.ctypes.data, pauses=pauses, stop=self.stop.ctypes.data,
        )  # fmt: skip

    def restart(self, patience: float = 0.0) -> None:
        """Let the next `run` begin with the first motion; it returns after `patience` seconds."""
        self.task.next, self.task.patience = 0, patience

    def run(self) -> None:
        """Go on with motions that are not done; several threads may do so at once."""
        self._kernel.run(self.task)

    @property
    def keeps_extremes(self) -> NDArray[np.bool_]:
        """Of which events only two rows are kept, of the smallest and the largest value."""
        return self._events["keeps_extremes"] != 0

    @property
    def nfev(self) -> NDArray[np.int64]:
        """Evaluations of the right-hand side by each motion."""
        rounds = self.motions["rounds"].astype(np.int64)
        first = 1 if self.task.fixed else 2  # the slope at the beginning, and one to choose h
        return rounds * self._kernel.slopes + self.njev + first * (rounds > 0)

    @property
    def njev(self) -> NDArray[np.int64]:
        """Evaluations of the Jacobian; with each of them begins a guess, the slope there."""
        return self.motions["trials"].astype(np.int64) * (not self._kernel.is_explicit)


def _event(form: Form, crossing: Event, pauses: bool) -> tuple[float | int, ...]:
    # a motion that pauses has room for every occurrence
    extremes = isinstance(crossing, Extremum) and not pauses
    watched = form.locate(crossing.name)
    kept = form.locate(crossing.coordinate) if isinstance(crossing, Extremum) else (False, 0)
    assert watched is not None
    assert kept is not None
    value = crossing.value
    return (
        value, np.sin(value), np.cos(value), *map(int, watched), crossing.direction,
        int(crossing.terminal), int(extremes), *map(int, kept),
    )  # fmt: skip
