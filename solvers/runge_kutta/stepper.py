"""One step of any Runge–Kutta method, explicit or implicit.

A step can be repeated from the same start with a shorter h at the cost of its
stages; that is how states between steps are computed, to the method's own order
and without a coefficient of their own.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from solvers.runge_kutta.tableau import Tableau

Array = NDArray[np.float64]
Rhs = Callable[[float, Array], Array]

#: Newton's iteration ends when a change is this small beside the state, or after so many rounds.
CLOSE, ROUNDS = 1e-14, 100
#: Numbers that are not much larger have fewer digits than others.
FAINT = 1e-290


class NotFiniteError(ArithmeticError):
    """A stage was not finite."""


class NoConvergenceError(ArithmeticError):
    """The stage equations of an implicit method were not solved."""


class Stepper:
    """Steps of one method for one right-hand side.

    Parameters
    ----------
    tableau : Tableau
        The method.
    rhs : callable
        ``rhs(t, y)``, an array of the state's shape.
    jacobian : callable, optional
        ``jacobian(t, y)``, state × state; implicit methods need it.

    Attributes
    ----------
    nfev, njev : int
        Evaluations so far.
    """

    def __init__(self, tableau: Tableau, rhs: Rhs, jacobian: Rhs | None = None) -> None:
        self._A = np.array([[float(a) for a in row] for row in tableau.A])
        self._b, self._c = (np.array([float(x) for x in xs]) for xs in (tableau.b, tableau.c))
        self._error_weights = np.array([[float(w) for w in row] for row in tableau.error_weights])
        self._tableau, self._rhs, self._jacobian = tableau, rhs, jacobian
        self.nfev = self.njev = 0

    def derivative(self, t: float, y: Array) -> Array:
        """The right-hand side, counted and found finite.

        Parameters
        ----------
        t : float
            In s.
        y : ndarray of shape (state,)
            The state.

        Returns
        -------
        ndarray of shape (state,)
            In the units of the state, a second.

        Raises
        ------
        NotFiniteError
            When an entry is NaN or infinite.
        """
        self.nfev += 1
        if not np.isfinite(y).all():
            raise NotFiniteError(f"the state at t = {t} is {y}")
        try:
            value = np.asarray(self._rhs(t, y), dtype=float)
        except ArithmeticError as error:
            raise NotFiniteError(f"the right-hand side at t = {t}, y = {y}: {error}") from error
        if not np.isfinite(value).all():
            raise NotFiniteError(f"the right-hand side at t = {t}, y = {y} is {value}")
        return value

    def step(self, t: float, y: Array, h: float, first: Array) -> tuple[Array, Array, Array | None]:
        """The state after `h`, estimates of its local error, and the slope there if known.

        Parameters
        ----------
        t, y : float and ndarray
            Where the step begins, in s and in the units of the state.
        h : float
            Its length in s, negative backwards.
        first : ndarray
            The slope at the beginning.

        Returns
        -------
        end : ndarray of shape (state,)
            The state.
        error : ndarray of shape (estimates, state)
            One row of zeros for a method that does not estimate it.
        slope : ndarray of shape (state,) or None
            Of methods whose last stage is the first of the next step.

        Raises
        ------
        NotFiniteError
            When a stage of an explicit method is not finite.
        NoConvergenceError
            When the stage equations of an implicit method are not solved.
        """
        if self._tableau.is_explicit:
            slopes = self._explicit(t, y, h, first)
        else:
            slopes = self._implicit(t, y, h, first)
        end = y + h * (self._b @ slopes)
        error = h * (self._error_weights @ slopes) if self._tableau.b_hat else np.zeros((1, len(y)))
        return end, error, slopes[-1] if self._tableau.is_fsal else None

    def _explicit(self, t: float, y: Array, h: float, first: Array) -> Array:
        slopes = np.empty((len(self._b), len(y)))
        slopes[0] = first
        for i in range(1, len(self._b)):
            slopes[i] = self.derivative(t + self._c[i] * h, y + h * (self._A[i, :i] @ slopes[:i]))
        return slopes

    def _implicit(self, t: float, y: Array, h: float, first: Array) -> Array:
        """Simplified Newton iteration on all stages at once, from the slope at the beginning."""
        assert self._jacobian is not None
        stages, n = len(self._b), len(y)
        self.njev += 1
        J = np.asarray(self._jacobian(t, y), dtype=float)
        matrix = np.eye(stages * n) - h * np.kron(self._A, J)
        slopes = np.tile(first, (stages, 1))
        # rounding, which a steep slope multiplies, may keep the iteration from getting closer
        rounding = CLOSE * (100 + np.abs(h * J).max())
        previous = np.inf
        for _ in range(ROUNDS):
            states = y + h * (self._A @ slopes)
            try:
                values = np.array([
                    self.derivative(t + c * h, state)
                    for c, state in zip(self._c, states, strict=True)
                ])  # fmt: skip
                change = np.linalg.solve(matrix, (values - slopes).ravel()).reshape(stages, n)
            except (NotFiniteError, np.linalg.LinAlgError) as error:
                raise NoConvergenceError(f"stages at t = {t}, h = {h}: {error}") from error
            slopes = slopes + change
            scale = np.abs(y).max() + np.abs(h * slopes).max() + FAINT
            size = float(np.abs(h * change).max() / scale)
            if size <= CLOSE or (size < rounding and size >= previous / 2):
                return slopes
            previous = size
        raise NoConvergenceError(f"stages at t = {t}, h = {h} still change by {size:.1e}")
