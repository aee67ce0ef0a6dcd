"""Our methods inside SciPy: each tableau as a solver class for ``solve_ivp``."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DenseOutput, OdeSolver

from solvers.integration.problem import SHORTEST
from solvers.integration.validation import tolerances
from solvers.runge_kutta.catalogue import load
from solvers.runge_kutta.step_control import Controller
from solvers.runge_kutta.stepper import NoConvergenceError, NotFiniteError, Stepper

Array = NDArray[np.float64]


def ode_solver(method: str) -> type[OdeSolver]:
    """The method as a class: ``solve_ivp(rhs, span, y0, method=ode_solver("verner87"))``.

    Parameters
    ----------
    method : str
        An explicit method that estimates its error, such as ``verner87``.

    Returns
    -------
    type
        A subclass of ``scipy.integrate.OdeSolver`` with the options `max_step` and `first_step`
        in s, `rtol` and `atol`.

    Raises
    ------
    ValueError
        For a method without error estimate, or an implicit one.
    solvers.runge_kutta.catalogue.UnknownMethodError
        When no method has this name.

    Examples
    --------
    >>> from scipy.integrate import solve_ivp
    >>> from solvers import ode_solver
    >>> decay = solve_ivp(lambda t, y: -y, (0, 1), [1.0], method=ode_solver("dp54"), rtol=1e-9)
    >>> f"{decay.y[0, -1]:.6f}"
    '0.367879'
    """
    tableau = load(method)
    if not tableau.b_hat or not tableau.is_explicit:
        raise ValueError(f"method {method!r} is implicit, or does not estimate its error")

    class Method(OdeSolver):
        """A Runge–Kutta method with PI step control, as SciPy's solvers are used."""

        t: float
        y: Array

        def __init__(
            self, fun: Any, t0: float, y0: Array, t_bound: float, max_step: float = np.inf,
            rtol: float = 1e-3, atol: float = 1e-6, vectorized: bool = False,
            first_step: float | None = None, **unknown: Any,
        ) -> None:  # fmt: skip
            if unknown:
                raise ValueError(f"method {method!r} has no option {', '.join(sorted(unknown))}")
            super().__init__(fun, t0, y0, t_bound, vectorized)
            relative, absolute = tolerances(rtol, atol, self.n)
            for name, value in (("max_step", max_step), ("first_step", first_step)):
                if value is not None and not value > 0:
                    raise ValueError(f"{name} = {value} must be positive")
            self._stepper = Stepper(tableau, self.fun)
            self._control = Controller(tableau.error_order, relative, absolute)
            self._slope = self._stepper.derivative(self.t, self.y)
            self._longest = max_step
            self._shortest = SHORTEST * float(np.spacing(max(abs(t0), abs(t_bound))))
            self._size = first_step or max(
                2 * self._shortest,
                self._control.first_step(
                    self._stepper.derivative, t0, self.y, self._slope, t_bound - t0
                ),
            )

        def _step_impl(self) -> tuple[bool, str | None]:
            while True:
                size = min(self._size, self._longest, abs(self.t_bound - self.t))
                aim = self.t + size * self.direction
                if abs(aim - self.t) < self._shortest and aim != self.t_bound:
                    return False, self.TOO_SMALL_STEP
                try:
                    end, error, slope = self._stepper.step(
                        self.t, self.y, aim - self.t, self._slope
                    )
                    norm = self._control.norm(error, self.y, end)
                    if not np.isfinite(norm):
                        raise NotFiniteError(f"the error at t = {self.t} is {error}")
                    if norm <= 1:
                        following = self._stepper.derivative(aim, end) if slope is None else slope
                except (NotFiniteError, NoConvergenceError):
                    self._size = size / 4
                    continue
                self._size = size * self._control.factor(norm)
                if norm <= 1:
                    break
            self._start = (self.t, self.y, self._slope)
            self.t, self.y, self._slope = aim, end, following
            return True, None

        def _dense_output_impl(self) -> DenseOutput:
            return _Repeated(self._stepper, *self._start, self.t, self.y)

    Method.__name__ = method
    return Method


class _Repeated(DenseOutput):
    """States within a step: the step itself, taken with a shorter h."""

    def __init__(
        self, stepper: Stepper, t_old: float, y_old: Array, slope: Array, t: float, y: Array
    ) -> None:
        super().__init__(t_old, t)
        self._stepper, self._start, self._slope, self._end = stepper, y_old, slope, y

    def _at(self, t: float) -> Array:
        if t == self.t:
            return self._end
        return self._stepper.step(self.t_old, self._start, t - self.t_old, self._slope)[0]

    def _call_impl(self, t: Array) -> Array:
        return self._at(float(t)) if t.ndim == 0 else np.array([self._at(s) for s in t]).T
