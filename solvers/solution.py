"""What an integration returns."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Status(Enum):
    """How an integration ended."""

    FINISHED = "the end of the time span was reached"
    EVENT = "an event that ends the integration occurred"
    STEP_LIMIT = "the number of steps was used up; go on from the last state"
    NOT_FINITE = "the right-hand side or the state was not finite in the next step"
    STEP_TOO_SMALL = "the step fell below the resolution of the time: a singularity, most likely"
    NO_CONVERGENCE = "the stage equations of the next step could not be solved"


@dataclass(frozen=True)
class Solution:
    """An integrated motion, with the field names of SciPy's ``solve_ivp``.

    Attributes
    ----------
    t : ndarray of shape (n,)
        Times: those asked for, or every step's end.
    y : ndarray of shape (state, n)
        States of the module's Lagrangian or Hamiltonian form at these times.
    t_events, y_events : list of ndarray
        Times and states, the latter of shape (occurrences, state), of each event.
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
        Method, form and step control.
    end : pair of float and ndarray
        Time and state where it ended, from which another integration can go on.
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
    energy: Array | None
    end: tuple[float, Array]

    @property
    def success(self) -> bool:
        """Whether it reached the end, or an event that was to end it."""
        return self.status in (Status.FINISHED, Status.EVENT)
