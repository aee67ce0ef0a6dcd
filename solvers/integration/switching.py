"""Switching functions of generated equations: forces are smooth between their zeros.

Within a step, the signs of switching functions are held, so that the equations are smooth beyond a
zero, too. A zero is an event at which the step ends and the sign changes (E. Hairer, S. P. Norsett,
G. Wanner, Solving Ordinary Differential Equations I, section II.6). Hence methods keep their order.

Where the motion would return at once to the side that it comes from, it stays on the zero, a
sliding mode (A. F. Filippov, Differential Equations with Discontinuous Righthand Sides, 1988), such
as a body that dry friction holds. The motion ends there.
"""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from solvers.equations.forms import Form
from solvers.integration.solution import Array, Status
from solvers.runge_kutta.stepper import NotFiniteError
from solvers.runge_kutta.tableau import Tableau

if TYPE_CHECKING:
    from solvers.integration.problem import Outcome, Problem

#: Stands for a switching function that is 0, with the sign that is held.
TINY = float(np.finfo(float).tiny)
#: Parts between switches that are shorter than this many spacings of times, in succession, where
#: several functions change their signs in turn.
BRIEF, MOST_BRIEF_PARTS = 1000, 20


@dataclass(frozen=True)
class Switch:
    """An event that ends a step: a switching function changes its sign."""

    form: Form  # with the signs that are held
    index: int
    terminal: ClassVar[bool] = True

    def __call__(self, t: float, y: Array) -> float:
        """The switching function at an ordinary state."""
        try:
            value = float(self.form.switches(t, y)[0][self.index])
            return value or TINY * self.form.signs[self.index]
        except ArithmeticError as error:
            raise NotFiniteError(f"a switching function at t = {t}: {error}") from error


@dataclass(frozen=True)
class SlidingError(ArithmeticError):
    """A motion stays on a zero of a switching function."""

    name: str


def check_smooth(form: Form) -> None:
    """Refuse equations with kinks or jumps, where variational equations do not hold."""
    if form.switching_count:
        raise ValueError(
            f"forces of {form.module.SYSTEM} have kinks or jumps, where variational equations do "
            "not hold: replace abs, sign, min, max and Piecewise by smooth functions"
        )


def held(problem: "Problem", t: float, y: Array) -> "Problem":
    """The problem with the signs of its switching functions at an ordinary state held.

    `SlidingError` if the motion stays on a zero. Methods of SciPy use the values instead.
    """
    form, n = problem.form, problem.form.switching_count
    if not n or not isinstance(problem.method, Tableau):
        return problem
    signs = np.ones(n)
    for _ in range(n):  # the value of a function may depend on the signs of those before it
        values = form.with_signs(signs).switches(t, y)[0]
        signs = np.where(values == 0, signs, np.sign(values))
    for k in np.flatnonzero(values == 0).tolist():
        signs[k] = _leaving_sign(problem, t, y, signs, k)
    return problem.with_form_of(form.with_signs(signs))


def switched(problem: "Problem", t: float, y: Array, index: int) -> "Problem":
    """The problem from time `t` on, where a switching function has changed its sign."""
    signs = np.array(problem.form.signs)
    values, before = problem.form.switches(t, y)
    changed = {index, *np.flatnonzero(values * signs < 0)}
    signs[list(changed)] *= -1
    after, direction = problem.form.with_signs(signs).switches(t, y)[1], _direction(problem)
    for k in changed:
        if direction * before[k] * signs[k] > 0 > direction * after[k] * signs[k]:
            raise SlidingError(problem.form.module.SWITCHES[k])
    form = problem.form.with_signs(signs)
    return replace(problem.with_form_of(form), span=(t, problem.span[1]))


def _direction(problem: "Problem") -> float:
    return float(np.sign(problem.span[1] - problem.span[0]))


def _leaving_sign(problem: "Problem", t: float, y: Array, signs: Array, index: int) -> float:
    """The sign with which a switching function leaves 0."""
    form, direction, rates = problem.form, _direction(problem), {}
    for sign in (1.0, -1.0):
        signs[index] = sign
        rates[sign] = direction * float(form.with_signs(signs).switches(t, y)[1][index])
    if rates[1.0] < 0 < rates[-1.0]:
        raise SlidingError(form.module.SWITCHES[index])
    return 1.0 if rates[1.0] > 0 or rates[-1.0] >= 0 else -1.0


def first_part(problem: "Problem", outcome: "Outcome") -> tuple["Problem | None", Status]:
    """The problem up to the first switch, and its status if there is none to solve."""
    try:
        return held(problem, *outcome.end), Status.FINISHED
    except SlidingError as error:
        outcome.sliding = error.name
        return None, Status.SLIDING
    except ArithmeticError:
        return None, Status.NOT_FINITE


def next_part(
    problem: "Problem", outcome: "Outcome", status: Status
) -> tuple["Problem | None", Status]:
    """The problem after the switch that ended a part with `status`; None if there was none."""
    index = _switch_of(problem, outcome) if status is Status.EVENT else None
    if index is None:
        return None, status
    (begin, end), (t, _) = problem.span, outcome.end
    is_brief = abs(t - begin) < BRIEF * float(np.spacing(max(abs(begin), abs(end))))
    outcome.brief_parts = outcome.brief_parts + 1 if is_brief else 0
    try:
        if outcome.brief_parts > MOST_BRIEF_PARTS:
            raise SlidingError(problem.form.module.SWITCHES[index])
        return switched(problem, *outcome.end, index), status
    except SlidingError as error:
        outcome.sliding = error.name
        return None, Status.SLIDING
    except ArithmeticError:
        return None, Status.NOT_FINITE


def _switch_of(problem: "Problem", outcome: "Outcome") -> int | None:
    """The index of the switching function whose zero ended a run; None if another event did."""
    first = len(problem.all_events) - len(problem.switches)
    for index, times in enumerate(outcome.t_events[first:]):
        if times:
            times.clear()
            outcome.y_events[first + index].clear()
            return index
    return None
