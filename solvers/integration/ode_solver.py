"""Methods of `solvers.runge_kutta` as solver classes for SciPy's ``solve_ivp``."""

from typing import Any

import numpy as np
from scipy.integrate import DenseOutput, OdeSolver

from solvers.equations.number_checks import positive, real_number, real_numbers
from solvers.integration.loops.attempts import Accepted, Rejected, StepAttempts, TimedState
from solvers.integration.problem.problem import shortest_step
from solvers.integration.problem.validation import tolerances, warn_if_flushed
from solvers.runge_kutta.method_catalogue import load
from solvers.runge_kutta.step_control import Controller
from solvers.runge_kutta.stepper import Array, Stepper, evaluated
from solvers.runge_kutta.tableau import Tableau

#: Options of the solver classes, with SciPy's default values.
OPTIONS = {"max_step": np.inf, "first_step": None, "rtol": 1e-3, "atol": 1e-6}


def ode_solver(method: str) -> type[OdeSolver]:
    """A Runge–Kutta method as a class for SciPy's ``solve_ivp``.

    SciPy calls the function that it is given, about which the class knows nothing more: constraints
    are not projected, and where these depend on each other a motion may change its branch without a
    notice. `solvers.integrate` follows its own branch.

    Parameters
    ----------
    method : str
        An explicit method that estimates its error, such as ``verner853``.

    Returns
    -------
    type
        A subclass of ``scipy.integrate.OdeSolver`` with the options `max_step` and `first_step`
        in s, `rtol` and `atol`.

    Raises
    ------
    ValueError
        For a method without error estimate, or an implicit one.
    solvers.runge_kutta.method_catalogue.UnknownMethodError
        When no method has this name.

    Examples
    --------
    >>> from scipy.integrate import solve_ivp
    >>> verner853 = ode_solver("verner853")
    >>> solution = solve_ivp(lambda t, y: -y, (0, 1), [1.0], method=verner853, rtol=1e-10)
    >>> round(float(solution.y[0, -1]), 6)
    0.367879
    """
    warn_if_flushed()
    tableau = load(str(method))
    if not tableau.estimates_error or not tableau.is_explicit:
        raise ValueError(f"method {method!r} is implicit, or does not estimate its error")
    return type(method, (_Method,), {"name": method, "tableau": tableau})


class _Method(OdeSolver):
    """A Runge–Kutta method with PI step size control, in the interface of SciPy's solvers."""

    name: str
    tableau: Tableau
    t: float
    y: Array

    def __init__(
        self, fun: Any, t0: float, y0: Array, t_bound: float, vectorized: bool = False, **given: Any
    ) -> None:
        if unknown := sorted(given.keys() - OPTIONS):
            raise ValueError(f"method {self.name!r} has no option {', '.join(unknown)}")
        super().__init__(
            lambda t, y: evaluated("right-hand side", fun, t, y, y.shape),
            *(real_number("t_span[0]", t0, "s"), real_numbers("y0", y0)),
            real_number("t_span[1]", t_bound, "s", finite=False),
            vectorized,
        )
        options: dict[str, Any] = OPTIONS | given
        duration, first_step = abs(self.t_bound - t0), options["first_step"]
        positive("max_step", options["max_step"], finite=False)
        if first_step is not None:
            positive("first_step", first_step)
        if first_step is not None and first_step > duration:
            raise ValueError(f"first_step = {first_step} must be at most {duration}, all of t_span")
        limits = tolerances(options["rtol"], options["atol"], self.n)
        self._controller = Controller.of(self.tableau, *limits)
        stepper = Stepper(self.tableau, self.fun)
        self._attempts = StepAttempts(stepper, self._controller)
        self._point = TimedState(self.t, self.y, stepper.derivative(self.t, self.y))
        self._max_step, self._h = options["max_step"], first_step or 0.0
        if first_step is None and duration:
            guess = self._attempts.first_step_size
            self._h = guess(self._point, t_bound, self._shortest_step)

    @property
    def _shortest_step(self) -> float:
        """The shortest step up to the end of the time span, or from now on if that is infinite."""
        return shortest_step(self.t, self.t_bound if np.isfinite(self.t_bound) else self.t)

    def _step_impl(self) -> tuple[bool, str | None]:
        while True:
            h = min(self._h, self._max_step, abs(self.t_bound - self.t))
            t = float(self.t) + float(h * self.direction)
            if not np.isfinite(t):
                return False, "The time span is infinite, and no event ended the motion."
            if abs(t - self.t) < self._shortest_step and t != self.t_bound:
                return False, self.TOO_SMALL_STEP
            trial = self._attempts.attempt(self._point, t, h, is_last=False)
            if isinstance(trial, Rejected):
                self._h = trial.h
                continue
            self._h = h * self._controller.factor(trial.norm)
            self._accepted, self._point = trial, trial.end
            self.t, self.y = trial.end.t, trial.end.y
            return True, None

    def _dense_output_impl(self) -> DenseOutput:
        return _Repeated(self._accepted)


class _Repeated(DenseOutput):
    """States within a step, computed by shorter steps from its start."""

    def __init__(self, step: Accepted) -> None:
        super().__init__(step.start.t, step.end.t)
        self._step = step

    def _call_impl(self, t: Array) -> Array:
        state = self._step.state
        return state(float(t)) if t.ndim == 0 else np.array([state(float(s)) for s in t]).T
