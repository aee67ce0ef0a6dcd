"""A flag that stops integrations from another thread."""

import numpy as np


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
