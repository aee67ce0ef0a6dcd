"""The end of a scene's motion as it is, and how sure that is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solvers.equations.normal_modes import mode_spread
from solvers.references.elliptic import pendulum
from solvers.references.extrapolation import extrapolated
from solvers.references.taylor import taylor
from solvers.scenes.scene import Scene

Array = NDArray[np.float64]

#: Digits of the reference, and of the one that tells its error.
DIGITS, FEWER = 32, 24
#: Steps of the extrapolated midpoint rule, in s, and modes so far apart that it cannot follow.
STEP, STIFF = 0.01, 100.0


@dataclass(frozen=True)
class Reference:
    """A state at the end, by Taylor series.

    Attributes
    ----------
    end : ndarray of shape (state,)
        Coordinates and velocities.
    global_error : float
        Its own: the difference from a run with fewer digits, and the last rounding.
    apart : dict of str to float
        Differences from references of other families.
    """

    end: Array
    global_error: float
    apart: dict[str, float]

    METHOD = f"Taylor series, {DIGITS} digits"


def reference(scene: Scene) -> Reference:
    """The end of a scene's motion, and differences between three families of references.

    Parameters
    ----------
    scene : Scene
        Whose equations are free of time.

    Returns
    -------
    Reference
        With the end by Taylor series. The extrapolated midpoint rule stands beside it unless
        a mode is `STIFF` times as fast as another, elliptic functions if it is the single
        pendulum.

    Raises
    ------
    TypeError
        When the equations call a function beside sines and cosines of angles.
    """
    module, params, span = scene.module, scene.params, (0.0, scene.duration)
    end, rough = (taylor(module, params, scene.y0, span, digits)[-1] for digits in (DIGITS, FEWER))
    error = max(float(np.abs(end - rough).max()), float(np.spacing(np.abs(end).max())))
    others = {}
    if mode_spread(module, params) < STIFF:
        others["extrapolated midpoint rule"] = extrapolated(
            module, params, scene.y0, span, STEP
        )[-1]  # fmt: skip
    if module.STATE == ("theta", "theta_dot"):
        _, length, gravity = params
        start = (scene.y0[0], scene.y0[1])
        others["elliptic functions"] = pendulum(length, gravity, start, scene.duration)
    apart = {name: float(np.abs(end - other).max()) for name, other in others.items()}
    return Reference(end, error, apart)
