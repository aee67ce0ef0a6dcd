"""Switching functions of generated equations: forces are smooth between their zeros.

Within a step, the signs of switching functions are held, so that the equations are smooth beyond a
zero, too. A zero is an event at which the step ends and the signs are determined anew (E. Hairer,
S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, section II.6). Hence methods
keep their order. A function to whose zero the motion returns at once from both sides stays 0
(`solvers.equations.sliding`), until its sign leaves the interval from -1 to 1.

The compiled loop does the same in ``compiled/c/switching.h``.
"""

from collections.abc import Callable, Collection
from dataclasses import replace

import numpy as np

from solvers.equations.forms import Form
from solvers.equations.number_checks import NotFiniteNumberError
from solvers.equations.sliding import is_affine
from solvers.integration.problem.events import SwitchEvent
from solvers.integration.problem.problem import Problem
from solvers.integration.problem.status import Status
from solvers.integration.results.recorder import Outcome, Recorder
from solvers.runge_kutta.stepper import Array, NotFiniteError

#: Parts between switches that are shorter than this many spacings of times, in succession, after
#: which all functions that changed their signs in turn are at 0.
BRIEF, MOST_BRIEF_PARTS = 1000, 20
#: Most changes of signs, for each function, until they agree with their rates.
MOST_CHANGES = 20
#: Largest difference of 1 - s² from its change by the slopes at both ends of a step, and the part
#: of the step by which slopes are differences.
COARSE, PART = 0.1, 2**-20
#: Rounding errors of signs between -1 and 1.
ROUNDING = 1e-12


class UndeterminedError(ArithmeticError):
    """Switching functions at 0 do not determine the motion."""


def is_coarse(form: Form, begin: float, start: Array, end: float, state: Array) -> bool:
    """Whether a step is too long to follow the signs by which functions stay 0.

    The error of the state, which is between two states of the form, does not show it.
    """
    stays = np.array(form.signs) == 0
    if not stays.any():
        return False
    h, margins, slopes = end - begin, [], []
    for t, z in ((begin, start), (end, state)):
        now, part = form.switching(t, z), h * PART
        later = form.switching(t + part, z + part * now.derivative)
        margins.append(1 - now.signs**2)
        slopes.append((now.signs**2 - later.signs**2) / part)
    defect = margins[1] - margins[0] - h * (slopes[0] + slopes[1]) / 2
    return bool((np.abs(defect[stays]) > COARSE).any())


def started(
    problem: Problem, t: float, y: Array, signs: tuple[float, ...]
) -> tuple[Problem, Array]:
    """The problem with signs of its switching functions, and its state.

    The signs were `signs` before if these are not empty.
    """
    if not problem.form.switching_count:
        return problem, y
    lagrangian, state = _lagrangian(problem, y)
    before = np.array(signs or [1.0] * problem.form.switching_count)
    held = np.where(before == 0, 1.0, before)
    for _ in held:  # the value of a function may depend on the signs of those before it
        values = lagrangian.with_signs(held).values(t, state)
        held = np.where((values == 0) | (before == 0), held, np.sign(values))
    active = np.flatnonzero((values == 0) | (before == 0)).tolist()
    return _settled(problem, t, y, held, active)


def switched(
    problem: Problem, t: float, y: Array, indices: Collection[int]
) -> tuple[Problem, Array]:
    """The problem from time `t` on, where switching functions have changed their signs."""
    lagrangian, state = _lagrangian(problem, y)
    signs = np.array(problem.form.signs)
    motion = lagrangian.with_signs(signs).switching(t, state)
    (index, *others) = indices
    if signs[index] == 0 and not others:  # forces are continuous where it leaves 0
        signs[index] = np.sign(motion.signs[index])
        return _with_signs(problem, t, y, signs, [index, *np.flatnonzero(signs == 0)])
    changed = {*indices, *np.flatnonzero(motion.switching[0] * signs < 0)}
    active = sorted(changed | {*np.flatnonzero(signs == 0)})
    signs[[*changed]] *= -1
    return _settled(problem, t, y, signs, active)


def perturbed(before: Problem, after: Problem, index: int, t: float, y: Array) -> Array:
    """The change of an ordinary state by a switch: perturbations of velocities jump.

    The perturbed motion switches dt later, with dt = -δg/g' (P. C. Mueller, Chaos, Solitons &
    Fractals 5 (1995) 1671).
    """
    n, change = len(before.form.module.COORDINATES), np.zeros(len(y))
    if len(y) == 2 * n or before.form.signs[index] == 0:
        return change
    _, rates, changes, _ = before.form.switching(t, before.form.from_ordinary(t, y)).switching
    pairs = [_lagrangian(problem, y) for problem in (before, after)]
    jump = np.subtract(*(form.rhs(t, state)[n:] for form, state in pairs))
    if jump.any():
        change[3 * n : 4 * n] = -jump * (changes[index] / rates[index])
    return change


def _lagrangian(problem: Problem, y: Array) -> tuple[Form, Array]:
    lagrangian = problem.form.in_form("lagrangian")
    return lagrangian, y[: len(lagrangian.state)]


def _with_signs(
    problem: Problem, t: float, y: Array, signs: Array, active: Collection[int]
) -> tuple[Problem, Array]:
    """The problem with signs of switching functions, of which the `active` ones are at 0.

    The state is that with which functions that stay 0 are 0.
    """
    problem, y = problem.with_form_of(problem.form.with_signs(signs)), y.copy()
    lagrangian, state = _lagrangian(problem, y)
    y[: len(state)] -= lagrangian.switching(t, state).excess
    levels = [0.0] * len(signs)
    for k in active:
        value = SwitchEvent(_lagrangian(problem, y)[0], k, 0.0).value(t, y)
        levels[k] = value if signs[k] else min(value, 0.0)
    return replace(problem, levels=tuple(levels), span=(t, problem.span[1])), y


def _settled(
    problem: Problem, t: float, y: Array, signs: Array, active: Collection[int]
) -> tuple[Problem, Array]:
    """The problem with the signs that its switching functions have after time `t`.

    `signs` are preferred for the `active` functions, which are 0, and hold for others.
    """
    lagrangian, state = _lagrangian(problem, y)
    direction = np.sign(problem.span[1] - problem.span[0])
    others = [k for k in range(len(signs)) if k not in active]
    for _ in range(len(signs) + 1):
        signs = _consistent(lagrangian, t, state, signs, active, direction)
        values = lagrangian.with_signs(signs).values(t, state)
        beyond = [k for k in others if signs[k] * values[k] < 0]
        if not beyond:
            return _with_signs(problem, t, y, signs, active)
        signs[beyond] *= -1
    raise UndeterminedError


def _consistent(
    form: Form, t: float, y: Array, signs: Array, active: Collection[int], direction: float
) -> Array:
    """Signs of functions at 0 with which each moves to the side of its sign, or stays.

    The first sign that disagrees is changed, again and again, between 1, 0 and -1 (K. G. Murty,
    Linear Algebra and its Applications 7 (1974) 65: this ends if all principal minors of the matrix
    of rates by signs have the sign of friction). Friction without a lever arm changes its rate by
    rounding errors alone: then the sign by which the function would stay 0 is none, or is beyond
    the one that disagrees.
    """
    signs = signs.copy()
    for _ in range(MOST_CHANGES * len(signs)):
        motion = form.with_signs(signs).switching(t, y)
        rates = direction * motion.switching[1]
        agrees = np.where(signs, signs * rates >= 0, np.abs(motion.signs) <= 1 + ROUNDING)
        wrong = [k for k in active if not agrees[k]]
        if not wrong:
            if np.count_nonzero(signs == 0) < 2 or is_affine(form.by_signs(t, y), signs):
                return signs
            break
        k, sign = wrong[0], signs[wrong[0]]
        signs[k] = 0.0 if sign else np.sign(motion.signs[k])
        stays = form.with_signs(signs).switching(t, y).signs
        if sign and not (np.isfinite(stays).all() and sign * stays[k] < 1):
            signs[k] = -sign  # the rate does not depend on the sign
    raise UndeterminedError


def run_parts(
    problem: Problem, outcome: Outcome, run: Callable[[Problem, Recorder], Status]
) -> None:
    """Integrate the parts of a problem between samples of held inputs and switches, one by one.

    ``run(part, recorder)`` integrates a part from the recorder's state on.
    """
    recorder, status = Recorder(problem, outcome), Status.FINISHED
    try:
        for segment in problem.segments(lambda: recorder.y, outcome.history):
            part, status = _first_part(segment, outcome)
            while part is not None:
                recorder.restart(part)
                part, status = _next_part(part, outcome, run(part, recorder))
            if status is not Status.FINISHED:
                break
    except (NotFiniteError, NotFiniteNumberError) as failure:
        status = outcome.fail(failure)
    outcome.end_with(status, problem)


def _first_part(problem: Problem, outcome: Outcome) -> tuple[Problem | None, Status]:
    """The problem up to the first switch, and its status if there is none to solve."""
    try:
        part, y = started(problem, *outcome.end, outcome.signs)
    except UndeterminedError:
        return None, Status.UNDETERMINED
    except ArithmeticError:
        return None, Status.NOT_FINITE
    outcome.signs, outcome.end = part.form.signs, (outcome.end[0], y)
    return part, Status.FINISHED


def _next_part(problem: Problem, outcome: Outcome, status: Status) -> tuple[Problem | None, Status]:
    """The problem after the switch that ended a part with `status`; None if there was none."""
    index = _switch_of(problem, outcome) if status is Status.EVENT else None
    if index is None:
        return None, status
    (begin, end), (t, y) = problem.span, outcome.end
    is_brief = abs(t - begin) < BRIEF * float(np.spacing(max(abs(begin), abs(end))))
    outcome.recent = [*outcome.recent, index] if is_brief else [index]
    indices = {index: None}
    if len(outcome.recent) > MOST_BRIEF_PARTS:
        indices |= dict.fromkeys(outcome.recent)
    try:
        if len(outcome.recent) > 2 * MOST_BRIEF_PARTS:
            raise UndeterminedError
        part, corrected = switched(problem, t, y, indices)
        outcome.end = t, corrected + perturbed(problem, part, index, t, y)
    except UndeterminedError:
        return None, Status.UNDETERMINED
    except ArithmeticError:
        return None, Status.NOT_FINITE
    outcome.signs = part.form.signs
    return part, status


def _switch_of(problem: Problem, outcome: Outcome) -> int | None:
    """The index of the switching function whose zero ended a run; None if another event did."""
    first = len(problem.all_events) - len(problem.switches)
    for index, times in enumerate(outcome.t_events[first:]):
        if times:
            times.clear()
            outcome.y_events[first + index].clear()
            return index
    return None
