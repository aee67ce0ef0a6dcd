"""An integration that makes sense, ready to be run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from solvers.equations.forms import Form
from solvers.integration.solution import Status
from solvers.runge_kutta.step_control import Controller
from solvers.runge_kutta.tableau import Tableau

Array = NDArray[np.float64]
#: The shortest step, in parts of the time's last digit: below it a shorter step rounds to itself.
SHORTEST = 10
EventFunction = Callable[[float, Array], float]


@dataclass(frozen=True)
class Problem:
    """What is integrated, how, and what is wanted of it.

    Attributes
    ----------
    form : Form
        The equations, with parameters.
    method : Tableau or str
        One of ours, or the name of one of SciPy's.
    span : pair of float
        Beginning and end.
    start : ndarray of shape (state,)
        Coordinates and velocities at the beginning.
    h : float or None
        Length of fixed steps.
    rtol, atol : float and ndarray
        Tolerances of steps that are controlled.
    samples : ndarray or None
        Times that are wanted; the end of every step if None.
    events : list of callable
        What to watch.
    max_steps : int
        How many steps may be taken.
    """

    form: Form
    method: Tableau | str
    span: tuple[float, float]
    start: Array
    h: float | None
    rtol: float
    atol: Array
    samples: Array | None
    events: list[EventFunction]
    max_steps: int

    @property
    def controller(self) -> Controller | None:
        """What controls the steps, with nothing behind it yet."""
        assert isinstance(self.method, Tableau)
        if self.h is not None:
            return None
        return Controller(self.method.error_order, self.rtol, self.atol)

    @property
    def tolerance(self) -> float:
        """The largest error, absolute or relative, that a step may have."""
        return max(self.rtol, float(self.atol.max()))

    @property
    def description(self) -> str:
        """Method, form and step control in words."""
        title = self.method.title if isinstance(self.method, Tableau) else self.method
        steps = f"rtol = {self.rtol}" if self.h is None else f"h = {self.h}"
        return f"{title}, {self.form.name} form, {steps}"


@dataclass
class Outcome:
    """What a run has found so far.

    Its fields are those of `Solution`; times and states are kept in blocks, of shape
    (rows,) and (rows, state), events as lists.

    Attributes
    ----------
    end : pair of float and ndarray
        Time in s and ordinary state up to which it has come.
    t_events, y_events : list of list
        Times in s and ordinary states, a list for each event.
    t, y : list of ndarray
        Blocks of times in s, and of ordinary states in rows.
    status, nfev, njev, steps, rejected
        As in `Solution`.
    backend : str
        What runs it, and by which compiler.
    """

    end: tuple[float, Array]
    t_events: list[list[float]]
    y_events: list[list[Array]]
    t: list[Array] = field(default_factory=list)
    y: list[Array] = field(default_factory=list)
    status: Status = Status.INTERRUPTED
    nfev: int = 0
    njev: int = 0
    steps: int = 0
    rejected: int = 0
    backend: str = "python"

    @classmethod
    def at_start(cls, problem: Problem) -> Outcome:
        """Nothing but the beginning."""
        nothing: tuple[list[list[float]], list[list[Array]]] = (
            [[] for _ in problem.events],
            [[] for _ in problem.events],
        )
        return cls((problem.span[0], problem.start), *nothing)

    def rows(self) -> tuple[Array, Array]:
        """All times, and all states in rows."""
        y = np.concatenate([np.empty((0, len(self.end[1]))), *self.y])
        # an interruption may come when times are kept and their states are not yet
        return np.concatenate([np.empty(0), *self.t])[: len(y)], y
