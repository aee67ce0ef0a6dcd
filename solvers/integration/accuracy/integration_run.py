"""One integration of a motion: method, form, and tolerance, step size or digits."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from solvers.equations.singularities import checked_before
from solvers.integration.accuracy.checked_motion import Array, Motion
from solvers.integration.accuracy.method_choice import MethodChoice
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.integration.compiled.extended import ExtendedError, integrate_extended
from solvers.integration.given_tolerances import single_motion
from solvers.integration.prepare import no_compiler, prepare
from solvers.integration.problem.problem import Options
from solvers.integration.problem.status import Status
from solvers.references.taylor import taylor

#: Magnitude of a state in rad or m above which it is resolved relatively.
SMALL_STATE = 1e-3
#: Largest number of steps of a run, and of those that divide an integral over time.
MAX_STEPS, MOST_INTERVALS = 3 * 10**6, 20_000
#: Method, form and tolerance with the steps of a Taylor series.
SMOOTH, FINE = ("verner98", "lagrangian"), 1e-12
#: Seconds for which a short run is repeated to time it.
SECONDS = 0.01
#: Largest number of products of a Taylor series, which take up to half a minute.
MAX_PRODUCTS = 1e8


class NotAccurateError(ArithmeticError):
    """No run reaches the requested accuracy; the message states the accuracy that is reached."""


class TooLongError(ArithmeticError):
    """A motion takes more steps than the limit."""


class EndsEarlyError(ArithmeticError):
    """A motion cannot be continued, as at a collision; the message states time and state."""


@dataclass(frozen=True)
class IntegrationRun:
    """One integration of the full equations."""

    motion: Motion  # its module may be a specialised one
    method_choice: MethodChoice
    setting: float  # relative tolerance, or step size in s, or number of digits
    max_steps: int = MAX_STEPS

    @property
    def setting_name(self) -> str:
        """``rtol``, ``h`` or ``digits``."""
        choice = self.method_choice
        return "digits" if choice.is_series else "h" if choice.is_fixed else "rtol"

    @property
    def description(self) -> str:
        """Method, numbers, form and setting in words."""
        choice = self.method_choice
        if choice.is_series:
            return f"Taylor series of {self.setting:g} digits"
        numbers = f", {choice.precision} numbers" if choice.is_extended else ""
        return (
            f"{choice.method}{numbers}, {choice.form} form, {self.setting_name} = {self.setting:g}"
        )

    @property
    def is_compensated(self) -> bool:
        """Whether sums are compensated; that needs a compiled loop."""
        return self.method_choice.compensated and not no_compiler(self.motion.module)

    @property
    def options(self) -> dict[str, Any]:
        """Arguments of the integrator."""
        choice = self.method_choice
        options = {"method": choice.method, "form": choice.form, "max_steps": self.max_steps}
        if choice.is_fixed:
            return options | {"h": self.setting}
        # a component that starts small may grow, as next to the upright equilibrium
        options |= {"rtol": self.setting, "atol": SMALL_STATE * self.setting}
        return options | {"compensated": True} if self.is_compensated else options

    def states(self, t: Array, progress: Callable[[float], None] = lambda t: None) -> Array:
        """Coordinates and velocities at increasing times, shape (n, state).

        A series calls `progress` with the time in s after every step, longer numbers several times
        a second.
        """
        if self.method_choice.is_extended:
            return self.extended_states(t, progress)
        if self.method_choice.is_series:
            motion, times = self.motion, self.motion.with_start(t)
            arguments = motion.module, motion.params, motion.y0, times, int(self.setting)
            states = taylor(*arguments, max_products=MAX_PRODUCTS, progress=progress)
            return states[-len(t) :]
        return self.integrate(t)[1]

    def extended_states(
        self, t: Array, progress: Callable[[float], None], perturbation: int = 0
    ) -> Array:
        """As `states`, of a run in longer numbers with a `perturbation`."""
        motion, times = self.motion, self.motion.with_start(t)
        arguments = motion.module, motion.params, motion.y0, times, self.method_choice.precision
        options = self.setting, self.max_steps, progress, perturbation
        try:
            states = integrate_extended(*arguments, *options)
        except ExtendedError as error:
            is_long = error.status is Status.STEP_LIMIT
            raise (TooLongError if is_long else NotAccurateError)(str(error)) from error
        return states[-len(t) :]

    def integrate(self, t: Array | None) -> tuple[Array, Array]:
        """Times and states: at `t`, or at the end of every step."""
        motion, method = self.motion, self.method_choice.method
        options = Options(t_eval=t, inputs=motion.inputs, **self.options)
        with ignore_predictability(), checked_before():
            solution = single_motion(motion.module, motion.span, motion.y0, motion.params, options)
        if solution.status is Status.STEP_LIMIT:
            raise TooLongError(
                f"{method} needs more than {self.max_steps:.0e} steps: shorten the duration or "
                "request less accuracy"
            )
        if solution.status is not Status.FINISHED:
            raise NotAccurateError(f"{method}, {self.setting:g}: {solution.message}")
        return solution.t, solution.y.T

    def step_times(self) -> Array:
        """Times between which the motion is smooth: at most `MOST_INTERVALS` ends of steps."""
        run = self
        choice = self.method_choice
        if choice.is_series or choice.is_extended:  # steps as long as those of another method
            run = replace(self, method_choice=MethodChoice(*SMOOTH, ""), setting=FINE)
        times, _ = run.integrate(None)
        return times[:: -(-len(times) // MOST_INTERVALS)]

    def seconds(self) -> float:
        """Seconds of an integration to the end, without preparations that are done once."""
        motion, end = self.motion, self.motion.span[1]
        try:
            with checked_before():
                run = prepare(motion.module, motion.params, **self.options)
        except (ValueError, NoCompilerError):  # SciPy's methods, or no compiler
            return median_seconds(lambda: self.states(np.array([end])))
        return median_seconds(lambda: run(motion.span, motion.y0))


def median_seconds(run: Callable[[], object]) -> float:
    """Median time of a call."""
    times: list[float] = []
    until = time.perf_counter() + SECONDS
    while not times or time.perf_counter() < until:
        before = time.perf_counter()
        run()
        times.append(time.perf_counter() - before)
    return float(np.median(times))
