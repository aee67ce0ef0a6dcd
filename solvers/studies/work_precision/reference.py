"""Reference solutions of scenes, and their errors."""

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from solvers.equations.linearisation.normal_modes import mode_spread
from solvers.references.elliptic import pendulum
from solvers.references.extrapolation import extrapolated
from solvers.references.taylor import taylor
from solvers.scenes.scene import Scene

Array = NDArray[np.float64]

#: Digits of the reference, and of the run that estimates its error.
DIGITS, FEWER = 32, 24
#: Step of the extrapolated midpoint rule in s, and the ratio of frequencies that it cannot resolve.
STEP, STIFF = 0.01, 100.0
#: The system that elliptic functions solve, and its parameters.
PENDULUM = "single_pendulum", ("m", "l", "g")


@dataclass(frozen=True)
class Reference:
    """The final state of a scene, from Taylor series.

    Attributes
    ----------
    end : ndarray of shape (state,)
        Coordinates and velocities.
    global_error : float
        Difference from a run with fewer digits, and at least the last rounding.
    differences : dict of str to float
        Differences from references of other families.
    """

    end: Array
    global_error: float
    differences: dict[str, float]

    METHOD = f"Taylor series, {DIGITS} digits"

    @classmethod
    def of(cls, scene: Scene) -> "Reference":
        """The reference of a scene.

        It is compared with the extrapolated midpoint rule unless a mode is `STIFF` times as fast
        as another, and with elliptic functions if the scene is a single pendulum.
        """
        module, params, span = scene.module, scene.params, (0.0, scene.duration)
        solve = partial(taylor, module, params, scene.y0, span)
        end, rough = (solve(digits)[-1] for digits in (DIGITS, FEWER))
        error = max(float(np.abs(end - rough).max()), float(np.spacing(np.abs(end).max())))
        others = {}
        if mode_spread(module, params) < STIFF:
            solution = extrapolated(module, params, scene.y0, span, STEP)
            others["extrapolated midpoint rule"] = solution[-1]
        if (module.SYSTEM, module.PARAMETERS) == PENDULUM:
            _, length, gravity = params
            start = (scene.y0[0], scene.y0[1])
            others["elliptic functions"] = pendulum(length, gravity, start, scene.duration)
        differences = {name: float(np.abs(end - other).max()) for name, other in others.items()}
        return cls(end, error, differences)
