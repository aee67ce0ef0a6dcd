"""What an integration returns."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Status(Enum):
    """How an integration ended.

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> from solvers import Status, integrate
    >>> integrate(sp, (0, 5), (0.5, 0), sp.DEFAULTS).status is Status.FINISHED
    True
    """

    FINISHED = "the end of the time span was reached"
    EVENT = "an event that ends the integration occurred"
    STEP_LIMIT = "the number of steps was used up; go on from the last state"
    NOT_FINITE = "the right-hand side or the state was not finite in the next step"
    STEP_TOO_SMALL = "the step fell below the resolution of the time: a singularity, most likely"
    INTERRUPTED = "it was interrupted; go on from the last state"
    UNSTABLE = "the fixed step is too long: small deviations explode"
    NO_CONVERGENCE = "the stage equations of the next step could not be solved"


@dataclass(frozen=True)
class Solution:
    """An integrated motion, with the field names of SciPy's ``solve_ivp``.

    Attributes
    ----------
    t : ndarray of shape (n,)
        Times in s: those asked for, or the beginning and every step's end.
    y : ndarray of shape (state, n)
        Coordinates and velocities at these times, whatever form was integrated; of the
        variational form with their small changes below.
    t_events, y_events : list of ndarray
        Times in s and states, the latter of shape (occurrences, state), of each event.
    nfev, njev : int
        Evaluations of the right-hand side and of its Jacobian.
    status : Status
        How it ended.
    message : str
        The same in words, with time and state where it ended early.
    steps, rejected : int
        Steps taken, and steps tried in vain.
    energy : ndarray of shape (n,) or None
        Energy in J at these times, where asked for.
    run : str
        Method, form, step control, and what ran it.
    backend : str
        ``compiled``, ``python`` or ``scipy``.
    end : pair of float and ndarray
        Time in s and state where it ended, from which another integration can go on.

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> from solvers import integrate
    >>> motion = integrate(sp, (0, 5), (0.5, 0), sp.DEFAULTS, t_eval=[0, 2.5, 5])
    >>> motion.y.shape, motion.success
    ((2, 3), True)
    """

    t: Array
    y: Array
    t_events: list[Array]
    y_events: list[Array]
    nfev: int
    njev: int
    status: Status
    message: str
    steps: int
    rejected: int
    run: str
    backend: str
    energy: Array | None
    end: tuple[float, Array]

    @property
    def success(self) -> bool:
        """Whether it reached the end, or an event that was to end it."""
        return self.status in (Status.FINISHED, Status.EVENT)


@dataclass(frozen=True)
class Ensemble:
    """Where many motions ended, and what they passed.

    Attributes
    ----------
    t : ndarray of shape (n,)
        When each motion ended.
    y : ndarray of shape (n, state)
        Where: coordinates and velocities.
    growth : ndarray of shape (n,)
        Of the variational form, natural logarithms of how many times as long the small change
        is at the end as it was at the beginning, however large; else NaN.
    samples : ndarray of shape (n, state, times)
        States at the times asked for; NaN after a motion's end.
    t_events : ndarray of shape (n, events, occurrences)
        Times of the first occurrences of each event; NaN where there were fewer.
    y_events : ndarray of shape (n, events, occurrences, state)
        States at these times.
    occurred : ndarray of shape (n, events)
        How often each event occurred.
    status : ndarray of shape (n,)
        How each ended, a `Status`.
    steps, rejected, nfev : ndarray of shape (n,)
        Steps taken, steps tried in vain, evaluations of the right-hand side.
    run : str
        Method, form, step control, and what ran it.

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> from solvers import ensemble
    >>> motions = ensemble(sp, (0, 5), [(0.5, 0), (1.0, 0)], sp.DEFAULTS)
    >>> motions.y.shape, {status.name for status in motions.status}
    ((2, 2), {'FINISHED'})
    """

    t: Array
    y: Array
    growth: Array
    samples: Array
    t_events: Array
    y_events: Array
    occurred: NDArray[np.int64]
    status: NDArray[np.object_]
    steps: NDArray[np.int64]
    rejected: NDArray[np.int64]
    nfev: NDArray[np.int64]
    run: str

    @classmethod
    def unknown(
        cls, n: int, state: int, times: int, events: int, occurrences: int, run: str
    ) -> Ensemble:
        """An ensemble of `n` motions of which nothing is known yet."""
        return cls(
            np.full(n, np.nan),
            np.full((n, state), np.nan),
            np.full(n, np.nan),
            np.full((n, state, times), np.nan),
            np.full((n, events, occurrences), np.nan),
            np.full((n, events, occurrences, state), np.nan),
            np.zeros((n, events), np.int64),
            np.full(n, Status.INTERRUPTED, object),
            np.zeros(n, np.int64),
            np.zeros(n, np.int64),
            np.zeros(n, np.int64),
            run,
        )

    @property
    def success(self) -> NDArray[np.bool_]:
        """Which motions reached the end, or an event that was to end them."""
        return np.asarray((self.status == Status.FINISHED) | (self.status == Status.EVENT))


class Interrupted(KeyboardInterrupt):
    """The user has interrupted an integration.

    Attributes
    ----------
    solution
        What was computed before.
    """

    def __init__(self, solution: object) -> None:
        super().__init__("interrupted; its attribute `solution` holds what was computed")
        self.solution = solution
