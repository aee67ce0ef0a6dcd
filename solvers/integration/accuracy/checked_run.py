"""Integrations by one method, checked by others in another form of the equations."""

from dataclasses import dataclass, replace

import numpy as np

from solvers.equations.forms import fastest_form
from solvers.integration.accuracy.checked_motion import Array, Motion
from solvers.integration.accuracy.double_precision import check_times, sufficient
from solvers.integration.accuracy.integration_run import (
    MAX_STEPS,
    EndsEarlyError,
    IntegrationRun,
    NotAccurateError,
    TooLongError,
)
from solvers.integration.accuracy.method_choice import MethodChoice
from solvers.integration.loops.compiled_loop import compile_ahead
from solvers.runge_kutta.method_catalogue import SCIPY, load

#: Methods of the check, how much finer its tolerance is, and the finest tolerance.
CHECKS, TIGHTER, FINEST = ("dop853", "verner98"), 100.0, 1e-14
#: Safety factor of the difference between run and check.
MARGIN = 2.0
#: Number of tolerances or steps to try, and the share of the requested accuracy to aim at.
TRIES, RESERVE = 6, 0.3
#: How much smaller an error may be than in proportion to the tolerance, by compensated sums, too.
MOST_GAIN = 2e4


@dataclass(frozen=True)
class CheckedRun:
    """An integration with one tolerance, step size or number of digits, and its error."""

    run: IntegrationRun
    #: Largest error of any requested component at any time, in rad, m, rad/s or m/s.
    error_estimate: float
    computed: tuple[Array, Array] | None = None  # times and states that are known already
    computing_seconds: float | None = None  # where it takes too long to be repeated

    def states(self, t: Array) -> Array:
        """Coordinates and velocities at times of the motion, shape (n, state)."""
        if self.computed and np.array_equal(self.computed[0], t):
            return self.computed[1]
        return self.run.states(t)

    def seconds(self) -> float:
        """Seconds of an integration to the end, without preparations that are done once."""
        return self.computing_seconds or self.run.seconds()


def checked_run(
    motion: Motion, choice: MethodChoice, accuracy: float, checked: Motion
) -> CheckedRun:
    """An integration at the largest tolerance or step that is sufficient; else an error.

    `checked` is the same motion with general code. Where no check is much more accurate than the
    run, several that are as accurate as double precision permits check each other.
    """
    check_length(checked, MAX_STEPS)
    if choice.step is not None:
        run = IntegrationRun(motion, choice, choice.step)
        return CheckedRun(run, estimated_error(run, checked))
    finest = FINEST if choice.method in SCIPY else TIGHTER * FINEST
    setting, power = max(accuracy / 3, finest), 1.0
    if choice.is_fixed:
        setting, power = abs(motion.duration) / 200, float(load(choice.method).order)
    may_compensate = not choice.is_fixed and choice.method not in SCIPY
    best = np.inf
    for _ in range(TRIES):
        run = IntegrationRun(motion, choice, setting)
        error = estimated_error(run, checked)
        if error <= accuracy:
            return CheckedRun(run, error)
        best = min(best, error)
        least = error * finest / setting / MOST_GAIN
        if may_compensate and not choice.is_named and accuracy < least < np.inf:
            best, may_compensate = least, False
            break
        if not choice.is_fixed and setting <= finest:
            break
        factor = (RESERVE * accuracy / error) ** (1 / power) if np.isfinite(error) else 0.1
        setting = max(setting * min(max(factor, 1e-4), 0.5), 0.0 if choice.is_fixed else finest)
    if may_compensate:
        run, error = sufficient(checked, accuracy, choice if choice.is_named else None)
        if error <= accuracy:
            return CheckedRun(run, error)
        best = min(best, error)
    method = choice.method if choice.is_named else "double precision"
    raise NotAccurateError(
        f"{method} reaches {best:.1g} at best where {accuracy:.1g} is requested: the motion "
        "loses more digits than double precision has"
    )


def estimated_error(run: IntegrationRun, checked: Motion) -> float:
    """Estimated error of a run; infinity for one that does not reach its end.

    `EndsEarlyError` where the motion itself does not.
    """
    checks = _checks(run, checked)
    compile_checks(run, checked)
    try:
        times = check_times(run)
        states = run.states(times)
        references = [check.states(times) for check in checks]
    except NotAccurateError:
        _refuse_early_end(checks[0])
        return np.inf
    # a check's own error counts where the run is more accurate than its tolerance
    rest = checks[0].setting * float(np.abs(references[0]).max())
    return max(difference(run.motion, states, reference) for reference in references) + rest


def compile_checks(run: IntegrationRun, checked: Motion) -> None:
    """Start to compile the loops of the checks of a run, while that of the run is compiled."""
    for check in _checks(run, checked) if checked.inputs is None else ():
        compile_ahead(checked.module, check.method_choice.form, check.method_choice.method)


def _checks(run: IntegrationRun, checked: Motion) -> list[IntegrationRun]:
    """Runs with a finer tolerance to compare with."""
    # another form has no rounding in common, not even of the initial state; two methods, since
    # the error of one may exceed its tolerance by so much that it equals the run's
    choice = run.method_choice
    others = checked.forms[1:] and [fastest_form(checked.module)]
    form = others[0] if others and choice.form == "lagrangian" else "lagrangian"
    tolerance = FINEST if choice.is_fixed else max(run.setting / TIGHTER, FINEST)
    return [IntegrationRun(checked, MethodChoice(name, form, ""), tolerance) for name in CHECKS]


def _refuse_early_end(check: IntegrationRun) -> None:
    """Raise `EndsEarlyError` where the finest check ends early, as every other run would."""
    try:
        replace(check, setting=FINEST).integrate(None)
    except NotAccurateError as failure:
        raise EndsEarlyError(f"{failure}: end the motion before") from failure


def difference(motion: Motion, one: Array, other: Array) -> float:
    """The error that the difference of two results, shape (n, state), stands for."""
    return float(MARGIN * np.abs(one - other)[:, list(motion.requested)].max())


def check_length(motion: Motion, most: float) -> None:
    """Refuse motions of more than `most` turns, by the rates at the start."""
    jacobian = np.array(motion.module.jacobian(motion.begin, motion.y0, motion.params))
    if not np.isfinite(jacobian).all():
        raise NotAccurateError(f"the equations are not finite at {motion.y0}")
    velocities = np.abs(motion.y0[motion.n_coordinates :])
    rate = max(np.abs(np.linalg.eigvals(jacobian)).max(), *velocities)
    if rate * abs(motion.duration) > most:
        raise TooLongError(
            f"rates of {rate:.3g} per s over {abs(motion.duration):g} s are more than {most:g} "
            "turns: shorten the duration or request less accuracy"
        )
