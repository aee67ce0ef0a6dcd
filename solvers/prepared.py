"""One motion after another, with as little as possible around the compiled loop."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import atan2, isfinite, pi, ulp
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike

from solvers import compiled, request
from solvers.integration import fastest_form
from solvers.kernel import STATUSES, Batch, kernel
from solvers.problem import SHORTEST, Problem
from solvers.solution import Status


class NotFinishedError(ArithmeticError):
    """A motion did not reach its end.

    Attributes
    ----------
    status : Status
        Why.
    t : float
        Where it got to.
    y : tuple of float
        Its state there.
    """

    def __init__(self, status: Status, t: float, y: tuple[float, ...]) -> None:
        super().__init__(f"{status.value} (t = {t}, y = {y})")
        self.status, self.t, self.y = status, t, y


def prepare(
    module: ModuleType,
    params: ArrayLike,
    *,
    method: str = "verner87",
    form: str | None = None,
    rtol: float = 1e-9,
    atol: float = 1e-12,
    h: float | None = None,
    max_steps: int = 1_000_000,
    compensated: bool = False,
) -> Callable[[tuple[float, float], Sequence[float]], tuple[float, ...]]:
    """A function ``run((t0, t1), y0)`` that returns the state at t1, compiled now.

    Parameters
    ----------
    module, params, method, form, rtol, atol, h, max_steps, compensated
        As in `solvers.integration.integrate`.

    Returns
    -------
    callable
        Takes a time span and an ordinary state, returns the state at the span's end as
        a tuple. Raises `ValueError` for a state or span that makes no sense and
        `NotFinishedError` where the motion does not reach its end. Each thread needs a
        function of its own.

    Raises
    ------
    ValueError
        When an argument makes no sense.
    solvers.catalogue.UnknownMethodError
        When no method has this name.
    solvers.compiler.NoCompilerError
        When no compiler could build the loop.
    """

    def asked(form: str) -> Problem:
        rest = (0.0,) * len(module.STATE)
        return request.problem(
            module, (0.0, 1.0), rest, params, method, form, rtol, atol, h, [], (), max_steps
        )

    problem = asked(form or "lagrangian")
    obstacle = compiled.obstacle(problem)
    if obstacle:
        raise ValueError(f"no compiled loop can do this: {obstacle}")
    if form is None:
        problem = asked(fastest_form(module))
    equations = problem.form
    program = kernel(
        module, equations.name, method, lanes=False, compensated=compensated, reproducible=False
    )
    batch = Batch(
        program, problem, equations, problem.start[np.newaxis],
        capacity=0, occurrences=0, pauses=False,
    )  # fmt: skip
    return _Prepared(batch, problem).run


class _Prepared:
    """One motion in memory, written and read as plain numbers."""

    def __init__(self, batch: Batch, problem: Problem) -> None:
        form, motions = problem.form, batch.motions
        self._batch, self._form, self._h = batch, form, problem.h
        self._size, self._params = len(problem.start), form.params
        if form.name != "lagrangian":
            self._inside = getattr(form.module, f"{form.name}_state")
        self._blank = motions.tobytes()
        self._memory = motions.data.cast("B")
        self._numbers, self._words = self._memory.cast("d"), self._memory.cast("q")
        fields = motions.dtype.fields
        assert fields is not None
        self._at = {name: field[1] // 8 for name, field in fields.items()}
        self._z = slice(self._at["z"], self._at["z"] + len(form.state))

    def run(self, t_span: tuple[float, float], y0: Sequence[float]) -> tuple[float, ...]:
        """The state at the end of `t_span` of the motion that begins with `y0`."""
        begin, end = t_span
        if len(y0) != self._size or not all(map(isfinite, (begin, end, *y0))):
            request.time_span(t_span)
            request.numbers("y0", y0, self._form.module.STATE)
        if begin == end:
            return tuple(y0)
        resolution = SHORTEST * ulp(max(abs(begin), abs(end)))
        if self._h is not None and self._h < resolution:
            request.step(self._h, t_span)
        numbers, at = self._numbers, self._at
        self._memory[:] = self._blank
        numbers[0], numbers[at["t_end"]], numbers[at["shortest"]] = begin, end, resolution
        z = y0 if self._form.name == "lagrangian" else self._inside(y0, self._params)
        for k, value in enumerate(z, at["z"]):
            numbers[k] = value
        for k, (angle, sine) in enumerate(self._form.turning, at["turns"]):
            wrapped = atan2(z[sine], z[sine + 1])
            numbers[k] = round((y0[angle] - wrapped) / (2 * pi))
        status = None
        while status is None:
            self._batch.restart(compiled.PATIENCE)
            self._batch.go()
            status = STATUSES[self._words[at["status"]]]
        y = self._outside(list(numbers[self._z]))
        if status is not Status.FINISHED:
            raise NotFinishedError(status, numbers[0], y)
        return y

    def _outside(self, z: Sequence[float]) -> tuple[float, ...]:
        form = self._form
        if form.name == "lagrangian":
            return tuple(z)
        if form.name == "hamiltonian":
            return form.module.lagrangian_state(z, self._params)
        y = [0.0] * self._size
        for k, i in form.kept:
            y[k] = z[i]
        for turns, (k, i) in enumerate(form.turning, self._at["turns"]):
            y[k] = atan2(z[i], z[i + 1]) + 2 * pi * self._numbers[turns]
        return tuple(y)
