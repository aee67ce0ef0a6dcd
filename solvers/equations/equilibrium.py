"""The state of a system at rest in its equilibrium."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule, function, has_function


def equilibrium_state(module: GeneratedModule, params: Sequence[Any]) -> NDArray[np.float64] | None:
    """The state (q, 0) of the equilibrium; None if no equilibrium is known.

    Parameters that are arrays, for several motions, give states in columns.
    """
    if not has_function(module, "equilibrium"):
        return None
    name = "equilibrium_many" if any(map(np.ndim, params)) else "equilibrium"
    q = np.asarray(function(module, name)(params))
    return np.concatenate([q, np.zeros_like(q)])
