"""Options of an integration, the problem built from them, and the memory that it may take."""

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from solvers.equations.forms import Form
from solvers.equations.module import integrals
from solvers.equations.number_checks import Values
from solvers.integration.problem.events import SwitchEvent
from solvers.integration.problem.inputs import Controller, Held, History, Schedule
from solvers.runge_kutta.stepper import Array
from solvers.runge_kutta.tableau import Tableau

#: The shortest step, in units of the spacing of floating-point times.
SHORTEST = 10
#: Part of a motion's longest step below which its constraints may be singular: steps become as
#: short as the distance from such a configuration.
COLLAPSE = 1e-2
EventFunction = Callable[[float, Array], float]
#: The default method.
METHOD = "verner853"


def shortest_step(begin: float, end: float) -> float:
    """The shortest step between two times in s."""
    return SHORTEST * float(np.spacing(max(abs(begin), abs(end))))


@dataclass(frozen=True)
class Options:
    """Options of `integrate`, `ensemble` and `prepare`, before any check; documented there."""

    method: str = METHOD
    form: str | None = None
    rtol: float = 1e-9
    atol: ArrayLike = 1e-12
    h: float | None = None
    t_eval: ArrayLike | None = None
    events: EventFunction | Sequence[EventFunction] = ()
    max_steps: int = 1_000_000
    backend: str | None = None
    compensated: bool = False
    inputs: Held | Controller | Values | None = None


@dataclass(frozen=True)
class Problem:
    """A valid integration problem; `solvers.integration.problem.validation.problem` builds it."""

    form: Form
    method: Tableau | str  # a string is the name of a method of SciPy
    span: tuple[float, float]
    start: Array  # an ordinary state
    h: float | None  # None where steps are controlled
    rtol: float  # tolerances are 0 for fixed steps
    atol: Array
    samples: Array | None  # times of the states to record; None for the end of every step
    events: list[EventFunction]
    limits: Sequence[EventFunction]  # end the motion where a positive coordinate falls to 0
    max_steps: int
    options: Options  # as given
    schedule: Schedule | None = None  # of inputs that are held between samples
    levels: tuple[float, ...] = ()  # values of switching functions that count as 0

    def starting(self) -> "Problem":
        """The same problem, which keeps integrals at their values at the start."""
        return self.with_form_of(self.form.starting(self.span[0], self.start))

    def with_form(self, name: str) -> "Problem":
        """The same problem in another form with the same ordinary state."""
        return self.with_form_of(self.form.in_form(name))

    def with_form_of(self, form: Form) -> "Problem":
        """The same problem with another form, or other signs of switching functions."""
        return replace(self, form=form)

    def with_params(self, params: Sequence[Any]) -> "Problem":
        """The same problem with other parameters: numbers, or arrays for several motions."""
        return self.with_form_of(self.form.with_params(params))

    def motion(self, k: int, states: Array, params: Array) -> "Problem":
        """The problem of one of many motions, whose initial states and parameters are in rows."""
        return replace(self.with_params(params[k % len(params)].tolist()), start=states[k])

    def with_inputs(self, values: Array) -> "Problem":
        """The same problem with other inputs, the last parameters."""
        return self.with_params([*self.form.params[: -len(values)], *values])

    def segments(self, state: Callable[[], Array], history: History) -> "Iterator[Problem]":
        """The problem from sample to sample, with the inputs held there; all without samples.

        `state` returns the ordinary state that is reached, at which a controller is called.
        """
        schedule = self.schedule
        if schedule is None:
            yield self
            return
        first, begins, ends = schedule.pieces(self.span)
        for k, (begin, end) in enumerate(zip(begins.tolist(), ends.tolist(), strict=True), first):
            values = schedule.at(k, begin, state())
            history.times.append(begin)
            history.values.append(values)
            yield replace(self.with_inputs(values), span=(begin, end))

    def held_table(self, history: History) -> tuple[Array, Array] | None:
        """Times at which held inputs end, and these inputs in rows, for a loop that changes them.

        None without a table, as of a controller.
        """
        schedule = self.schedule
        if schedule is None or schedule.table is None:
            return None
        first, begins, ends = schedule.pieces(self.span)
        values = schedule.table.T[first : first + len(ends)]
        history.times += begins.tolist()
        history.values += [*values]
        return ends, values

    @property
    def has_varying_inputs(self) -> bool:
        """Whether inputs change during the motion, by samples or as a function of Python."""
        return self.schedule is not None or self.form.feedback is not None

    @property
    def all_events(self) -> list[EventFunction]:
        """The requested events, followed by the limits of coordinates and by switches."""
        return [*self.events, *self.limits, *self.switches]

    @property
    def switches(self) -> list[SwitchEvent]:
        """Events that end steps where switching functions, whose signs are held, are 0."""
        if not self.levels:  # a specialised module may have one form only
            return []
        lagrangian = self.form.in_form("lagrangian")
        return [SwitchEvent(lagrangian, k, level) for k, level in enumerate(self.levels)]

    @property
    def collapse(self) -> float:
        """Part of the longest step below which constraints may be singular; 0 without these."""
        watches = self.form.has_constraints and self.h is None
        schedule = self.schedule
        if watches and schedule is not None:  # a part of the motion must be able to start anew
            watches = schedule.table is not None and not integrals(self.form.module)
        return COLLAPSE * watches

    def held_at(self, t: float) -> "Problem":
        """The problem with the inputs of a table from the sample before `t` to the next one."""
        schedule = self.schedule
        if schedule is None or schedule.table is None:
            return self
        first, begins, ends = schedule.pieces(self.span)
        k = min(int(np.searchsorted(ends, t, "right")), len(ends) - 1)
        held = self.with_inputs(schedule.table[:, first + k])
        return replace(held, span=(float(begins[k]), float(ends[k])), schedule=None)

    @property
    def backend(self) -> str | None:
        """The required backend, ``compiled`` or ``python``; None for any."""
        return "compiled" if self.options.compensated else self.options.backend

    @property
    def units(self) -> dict[str, str]:
        """Units of the components of an ordinary state, in their order."""
        return {name: self.form.module.UNITS[name] for name in self.form.ordinary}

    @property
    def description(self) -> str:
        """Method, form and step control in words."""
        title = self.method.title if isinstance(self.method, Tableau) else self.method
        steps = f"rtol = {self.rtol}" if self.h is None else f"h = {self.h}"
        return f"{title}, {self.form.name} form, {steps}"


#: Share of the machine's memory that results may take, and their copies while they are collected.
SHARE, COPIES = 0.5, 3
#: Bytes of a number.
NUMBER = 8


def available_bytes() -> float:
    """Bytes that the results of one call may take."""
    return SHARE * os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")


def check_memory(what: str, rows: int, components: int, remedy: str) -> None:
    """Refuse results of so many states, each with its time, that do not fit into memory."""
    size = COPIES * NUMBER * rows * (1 + components)
    if size > available_bytes():
        raise ValueError(
            f"{what} would take {size / 1e9:.3g} GB of memory, more than the "
            f"{available_bytes() / 1e9:.3g} GB that results may take here: {remedy}"
        )


def check_times(t_eval: object, components: int) -> None:
    """Refuse more times than states fit into memory."""
    match t_eval:
        case np.ndarray():
            count = t_eval.size
        case list() | tuple():
            count = len(t_eval)
        case _:
            count = 0  # refused later
    check_memory(f"the states at {count} times t_eval", count, components, "give fewer times")


def limit_steps(problem: Problem) -> int:
    """The number of steps after which a run must stop, so that their ends fit into memory.

    Where steps are fixed, a run that would not reach its end is refused.
    """
    if problem.samples is not None:
        return problem.max_steps
    components = len(problem.start)
    if problem.h is not None:
        begin, end = problem.span
        steps = min(ceil(abs(end - begin) / problem.h), problem.max_steps)
        remedy = "give the times t_eval at which states are to be recorded, such as [t_end]"
        check_memory(f"the states at the ends of {steps} steps", steps, components, remedy)
    fitting = available_bytes() / (COPIES * NUMBER * (1 + components))
    return min(problem.max_steps, int(fitting))
