"""How a motion depends on its start: the state-transition matrix."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from solvers.equations.module import GeneratedModule
from solvers.equations.number_checks import Values
from solvers.equations.signature_checks import checked
from solvers.integration.problem.validation import time_span
from solvers.integration.variations.tangents import Tangents
from solvers.runge_kutta.stepper import Array


@dataclass(frozen=True)
class Transition:
    """The end of a motion, and its derivatives by the start.

    Attributes
    ----------
    y : ndarray of shape (state,)
        Coordinates and velocities at the end.
    matrix : ndarray of shape (state, state)
        ∂y/∂y0: column k is the change of y by a small change of component k of the start. Of
        systems with constraints, the nearest change that they permit, in the metric of the mass
        matrix, takes its place.
    """

    y: Array
    matrix: Array


@checked
def transition_matrix(
    module: GeneratedModule,
    t_span: ArrayLike,
    y0: Values,
    params: Values,
    *,
    rtol: float = 1e-12,
    atol: float = 1e-12,
) -> Transition:
    """The end of a motion and the state-transition matrix, by the variational equations.

    Parameters
    ----------
    module, t_span, y0, params, rtol, atol
        As in `integrate`; the tolerances apply to the matrix, too.

    Returns
    -------
    Transition
        The end and the matrix.

    Raises
    ------
    ValueError
        When an argument is invalid, or `module` has no variational form.
    solvers.integration.prepare.NotFinishedError
        When the motion does not reach its end.

    Examples
    --------
    >>> import numpy as np
    >>> import generated.single_pendulum as sp
    >>> from solvers import transition_matrix
    >>> matrix = transition_matrix(sp, (0, 10), {"theta": 1.0}, {}).matrix
    >>> bool(abs(np.linalg.det(matrix) - 1) < 1e-9)  # Liouville's theorem
    True
    """
    identity = np.eye(len(module.STATE))
    motion = Tangents(module, t_span, y0, params, identity, rtol=rtol, atol=atol)
    motion.advance(time_span(t_span)[1])
    return Transition(motion.y, motion.changes)
