"""How an integration ends: its status, and a flag that stops it from another thread."""

from enum import Enum

import numpy as np


class Status(Enum):
    """How an integration ended; the value is a sentence.

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> from solvers import Status, integrate
    >>> integrate(sp, (0, 5), (0.5, 0), sp.DEFAULTS).status is Status.FINISHED
    True
    """

    FINISHED = "the integration reached the end of the time span"
    EVENT = "a terminal event occurred"
    STEP_LIMIT = (
        "the maximum number of steps was reached; raise max_steps, or resume from the last state"
    )
    NOT_FINITE = "the right-hand side or the state was not finite in the next step"
    STEP_TOO_SMALL = "the step size fell below the resolution of time, probably at a singularity"
    INTERRUPTED = "the integration was interrupted; resume from the last state"
    UNSTABLE = "the fixed step size is too large: small deviations grow exponentially"
    NO_CONVERGENCE = (
        "the stage equations of the next step could not be solved: reduce h, or let method radau "
        "control the steps, without h"
    )
    SINGULAR = (
        "the motion approaches a configuration at which constraints depend on each other, beyond "
        "which it is not known"
    )
    OUTSIDE_DOMAIN = "a coordinate that must be positive fell to 0"
    UNDETERMINED = (
        "at jumps of the forces, these determine no motion: replace sign(v) by tanh(v/w) with a "
        "small w"
    )

    @property
    def reason(self) -> str:
        """The sentence without arguments to change, which functions that integrate may lack."""
        return self.value.partition(";")[0]

    @property
    def without_events(self) -> "Status":
        """The status if no events were requested: a limit of a coordinate ended the motion."""
        return Status.OUTSIDE_DOMAIN if self is Status.EVENT else self


class StopFlag:
    """Stops ensembles from another thread; once set, it stays set.

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> from solvers import StopFlag, ensemble
    >>> flag = StopFlag()
    >>> flag.set()
    >>> motions = ensemble(sp, (0, 5), {"theta": [0.5, 1.0]}, {}, stop=flag)
    >>> [status.name for status in motions.status]
    ['INTERRUPTED', 'INTERRUPTED']
    """

    def __init__(self) -> None:
        self.array = np.zeros(1, np.int64)

    def set(self) -> None:
        """Stop the motions with the status ``INTERRUPTED``, after the current steps."""
        self.array[0] = 1

    @property
    def is_set(self) -> bool:
        """Whether the motions are to stop."""
        return bool(self.array[0])
