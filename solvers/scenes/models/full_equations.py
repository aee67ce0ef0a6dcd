"""The full equations, integrated by one choice and checked by another."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from time import perf_counter
from typing import Any

import numpy as np

from solvers.equations.forms import fastest_form
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.integrate import integrate
from solvers.integration.predictability import ignore_predictability
from solvers.integration.prepare import prepare
from solvers.integration.solution import Status
from solvers.integration.timing import median_seconds
from solvers.references.taylor import taylor
from solvers.scenes.models.method_choice import MethodChoice
from solvers.scenes.models.model import Array, Motion, scattered

#: By what a run is checked: at least so many times as accurate, or the finest.
CHECKS, TIGHTER, FINEST = ("dop853", "verner98"), 100.0, 1e-14
#: Errors may be so many times as large as the difference between run and check.
MARGIN = 2.0
#: How often tolerances or steps are tried, and by how much errors then stay below what is asked.
TRIES, RESERVE = 6, 0.3
#: Digits of Taylor series that are tried where ordinary numbers have too few.
DIGITS, MORE, MOST_DIGITS = 24, 12, 96
#: Sizes of a state in rad or m that are resolved relatively; and steps of a run.
BEGINNING, MOST_STEPS = 1e-3, 3 * 10**6
#: Of so many steps errors are looked at; angles in rad and turns that series can do.
MOST_LOOKS, LARGEST_ANGLE, MOST_TURNS = 100_000, 1e6, 3000.0


class NotAccurateError(ArithmeticError):
    """No run came as close as was asked; the message says how close."""


class TooLongError(ArithmeticError):
    """A motion that takes more steps than anybody waits for."""


@dataclass(frozen=True)
class Full:
    """The full equations, by one choice with one tolerance or step.

    Attributes
    ----------
    asked : Motion
        The motion; its module may be a specialised one.
    method_choice : MethodChoice
        Method and form.
    setting : float
        Tolerance, or step in s, or digits.
    error_estimate : float
        Twice the largest difference from the check, and the check's tolerance.
    took : float
        What a run took in s, where it is too long to be timed again.
    kept : pair of ndarray, optional
        Times and states of that run.
    name : str
        What to call it.
    """

    asked: Motion
    method_choice: MethodChoice
    setting: float
    error_estimate: float
    took: float = nan
    kept: tuple[Array, Array] | None = None
    name: str = "full equations"

    @property
    def why(self) -> str:
        """Why this choice."""
        return self.method_choice.why

    def states(self, t: Array) -> Array:
        """Integrated to these times, shape (n, state)."""
        if self.kept and np.array_equal(self.kept[0], t):
            return self.kept[1]
        return run(self.asked, self.method_choice, self.setting, t)

    def seconds(self) -> float:
        """What an integration to the end takes, without what is prepared once."""
        if self.method_choice.is_series:
            return self.took
        end = np.array([self.asked.duration])
        try:
            choice = self.method_choice
            once = prepare(
                self.asked.module, self.asked.params, method=choice.method, form=choice.form,
                max_steps=MOST_STEPS, **options(choice, self.setting),
            )  # fmt: skip
        except (ValueError, NoCompilerError):  # SciPy's methods, or no compiler
            return median_seconds(lambda: self.states(end))
        return median_seconds(lambda: once((0.0, self.asked.duration), self.asked.y0))


def run(asked: Motion, choice: MethodChoice, setting: float, t: Array) -> Array:
    """States at times, shape (n, state).

    Parameters
    ----------
    asked : Motion
        The motion.
    choice : MethodChoice
        Method and form.
    setting : float
        Tolerance, or step in s, or digits.
    t : ndarray of shape (n,)
        Times in s, increasing, within the motion's duration.

    Returns
    -------
    ndarray of shape (n, state)
        Coordinates and velocities.

    Raises
    ------
    NotAccurateError
        When the integration does not reach its end.
    TooLongError
        When it takes more steps than anybody waits for.
    solvers.references.taylor.NoSeriesError
        When the equations have no Taylor series, as in `taylor`.
    """
    if choice.is_series:
        # its times begin with the start
        times = t if t[0] == 0 else [0.0, *t]
        return taylor(asked.module, asked.params, asked.y0, times, int(setting))[-len(t) :]
    return _integrated(asked, choice, setting, t)[1]


def _integrated(
    asked: Motion, choice: MethodChoice, setting: float, t: Array | None
) -> tuple[Array, Array]:
    """Times and states: at `t`, or at the end of every step."""
    with ignore_predictability():
        found = integrate(
            asked.module, (0.0, asked.duration), asked.y0, asked.params, method=choice.method,
            form=choice.form, t_eval=t, max_steps=MOST_STEPS, **options(choice, setting),
        )  # fmt: skip
    if found.status is Status.STEP_LIMIT:
        raise TooLongError(
            f"more than {MOST_STEPS:.0e} steps of {choice.method} are needed: shorten the "
            "duration, or ask for less accuracy"
        )
    if found.status is not Status.FINISHED:
        raise NotAccurateError(f"{choice.method}, {setting:g}: {found.message}")
    return found.t, found.y.T


def options(choice: MethodChoice, setting: float) -> dict[str, Any]:
    """A step, or tolerances, as the integrator takes them."""
    if choice.is_fixed:
        return {"h": setting}
    # what begins small may grow, as next to the upright place
    return {"rtol": setting, "atol": BEGINNING * setting}


def full(
    asked: Motion,
    accuracy: float,
    choice: MethodChoice,
    checked: Motion,
    setting: float | None,
) -> Full:
    """The run that is as accurate as asked, at the largest tolerance or step that is.

    Parameters
    ----------
    asked : Motion
        The motion.
    accuracy : float
        How large errors may be.
    choice : MethodChoice
        How to integrate.
    checked : Motion
        The same motion, by which the run is checked.
    setting : float, optional
        The one tolerance or step that is tried: then the error is what it is.

    Returns
    -------
    Full
        With the estimate of its error.

    Raises
    ------
    NotAccurateError
        When no run is as accurate, or none reaches its end.
    TooLongError
        When that takes more steps than anybody waits for.
    """
    _refuse_endless(checked, MOST_STEPS)
    if setting is not None:
        return Full(asked, choice, setting, _error(asked, choice, setting, checked))
    setting, power = (
        (asked.duration / 200, choice.order) if choice.is_fixed else (accuracy / 3, 1.0)
    )
    best = np.inf
    for _ in range(TRIES):
        error = _error(asked, choice, setting, checked)
        if error <= accuracy:
            return Full(asked, choice, setting, error)
        best = min(best, error)
        if not choice.is_fixed and setting <= FINEST:
            break
        shorter = (RESERVE * accuracy / error) ** (1 / power) if np.isfinite(error) else 0.1
        setting = max(setting * min(max(shorter, 1e-4), 0.5), FINEST)
    raise NotAccurateError(
        f"{choice.method} comes to {best:.1g} at best where {accuracy:.1g} was asked: a motion "
        "that loses more digits than numbers have"
    )


def _error(asked: Motion, choice: MethodChoice, setting: float, checked: Motion) -> float:
    """Estimated error of a run; infinity for one that does not reach its end."""
    try:
        times, _ = _integrated(asked, choice, setting, None)
    except NotAccurateError:
        return np.inf
    if len(times) > MOST_LOOKS:
        times = times[np.unique((len(times) * scattered(MOST_LOOKS)).astype(int))]
    # steps crowd where the motion is quick; between two of them it may be quicker
    times = np.unique([*times, *(times[1:] + times[:-1]) / 2, *asked.looks])
    found = run(asked, choice, setting, times)
    # another method in another form: they share no rounding, not even of the start
    method = next(name for name in CHECKS if name != choice.method)
    fastest = fastest_form(checked.module)
    truth = MethodChoice(method, fastest if choice.form == "lagrangian" else "lagrangian", "")
    tolerance = FINEST
    if not choice.is_fixed:
        tolerance = max(setting / TIGHTER, FINEST)
    fine = run(checked, truth, tolerance, times)
    # the check is as wrong as its tolerance, if the run is righter than it should be
    return _apart(asked, found, fine) + tolerance * float(np.abs(fine).max())


def _apart(asked: Motion, one: Array, other: Array) -> float:
    difference = np.abs(one - other)[:, list(asked.wanted)].max()
    return float(MARGIN * difference)


def series(asked: Motion, accuracy: float, choice: MethodChoice, times: Array) -> Full:
    """Taylor series to these times, with as many digits as it takes.

    Parameters
    ----------
    asked : Motion
        The motion.
    accuracy : float
        How large errors may be.
    choice : MethodChoice
        Series, and the form that they are made of.
    times : ndarray of shape (n,)
        In s, increasing.

    Returns
    -------
    Full
        With the states at `times`, and the seconds that they took.

    Raises
    ------
    NotAccurateError
        When not even the most digits are enough.
    TooLongError
        When they take longer than anybody waits for.
    solvers.references.taylor.NoSeriesError
        When the equations have no Taylor series, as in `taylor`.
    """
    _refuse_endless(asked, MOST_TURNS)
    if max(map(abs, asked.y0)) > LARGEST_ANGLE:
        raise TooLongError(f"series of angles above {LARGEST_ANGLE:g} rad take for ever: wind back")
    digits, error = DIGITS, np.inf
    rough = run(asked, choice, digits, times)
    while digits + MORE <= MOST_DIGITS:
        digits += MORE
        before = perf_counter()
        fine = run(asked, choice, digits, times)
        took = perf_counter() - before
        # what comes back is rounded to ordinary numbers
        error = _apart(asked, rough, fine) + float(np.spacing(np.abs(fine).max()))
        if error <= accuracy:
            return Full(asked, choice, digits, error, took, (times, fine))
        rough = fine
    raise NotAccurateError(
        f"{MOST_DIGITS} digits come to {error:.1g} where {accuracy:.1g} is asked"
    )


def _refuse_endless(asked: Motion, most: float) -> None:
    """Refuse motions that turn more often than anybody waits for, by the rates they begin with."""
    jacobian = np.array(asked.module.jacobian(0.0, asked.y0, asked.params))
    if not np.isfinite(jacobian).all():
        raise NotAccurateError(f"the equations are not finite at {asked.y0}")
    rate = max(np.abs(np.linalg.eigvals(jacobian)).max(), *np.abs(asked.y0[asked.coordinates :]))
    if rate * asked.duration > most:
        raise TooLongError(
            f"rates of {rate:.3g} per s over {asked.duration:g} s are more than {most:g} turns: "
            "shorten the duration, or ask for less accuracy"
        )
