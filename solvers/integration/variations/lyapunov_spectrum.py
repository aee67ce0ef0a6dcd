"""All Lyapunov exponents of a motion."""

from dataclasses import dataclass

import numpy as np

from solvers.equations.module import GeneratedModule, independent_perturbations
from solvers.equations.number_checks import Values, positive, real_number
from solvers.equations.signature_checks import checked
from solvers.integration.prepare import NotFinishedError
from solvers.integration.problem import validation
from solvers.integration.variations.frames import FINISHED, Frames
from solvers.runge_kutta.stepper import Array

#: Parts of a run whose means give the standard error.
PARTS = 20


@dataclass(frozen=True)
class LyapunovSpectrum:
    """Lyapunov exponents.

    Attributes
    ----------
    exponents : ndarray of shape (state - residuals,)
        In 1/s, from the largest to the smallest; of systems with constraints, one for each
        independent perturbation that keeps them.
    errors : ndarray of the same shape
        Their standard errors in 1/s, from the means over `PARTS` parts of the motion, each of which
        should be much longer than the motion's correlation.
    t, y : float and ndarray of shape (state,)
        Time in s and state at the end, from which the motion can go on.
    """

    exponents: Array
    errors: Array
    t: float
    y: Array


@checked
def lyapunov_spectrum(
    module: GeneratedModule,
    y0: Values,
    params: Values,
    duration: float,
    *,
    interval: float = 2.0,
    rtol: float = 1e-9,
    atol: float = 1e-9,
) -> LyapunovSpectrum:
    """All Lyapunov exponents along a motion.

    Perturbations follow the variational equations and are made orthogonal again after every
    interval (G. Benettin, L. Galgani, A. Giorgilli, J.-M. Strelcyn, Meccanica 15 (1980) 9-30), in
    the metric of the mass matrix: so the exponents of a system without friction add up to 0.

    Parameters
    ----------
    module, y0, params, rtol, atol
        As in `integrate`; a transient motion, if any, is to precede `y0`.
    duration : float
        Length of the motion in s, at least `PARTS` intervals.
    interval : float, optional
        Time in s between orthogonalisations, in which the largest perturbation should not grow by
        more than a factor of 1e6 relative to the smallest.

    Returns
    -------
    LyapunovSpectrum
        Exponents and their errors.

    Raises
    ------
    ValueError
        When an argument is invalid, or `module` has no variational form.
    solvers.integration.prepare.NotFinishedError
        When the motion does not last that long.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> from solvers import lyapunov_spectrum
    >>> spectrum = lyapunov_spectrum(dp, {"theta1": 2.0, "theta2": 2.5}, {}, 1000.0)
    >>> bool(spectrum.exponents[0] > 0.9 and abs(spectrum.exponents.sum()) < 1e-6)
    True
    """
    positive("interval", interval)
    if not real_number("duration", duration, "s") >= PARTS * interval:
        raise ValueError(
            f"duration = {duration} s must be at least {PARTS} intervals of {interval} s: "
            "lengthen it, or shorten the interval"
        )
    constants = validation.parameters(module, params)
    start = validation.initial_state(module, y0, params=constants.tolist())
    count = independent_perturbations(module)
    frames = Frames(module, start[np.newaxis], constants.tolist(), count, rtol=rtol, atol=atol)
    growth = frames.growth(np.array([duration]), round(duration / interval))[:, 0]
    if frames.status[0] != FINISHED:
        raise NotFinishedError(frames.status_of(0), float(frames.t[0]), tuple(frames.y[0].tolist()))
    means = [part.mean(axis=0) for part in np.array_split(growth * (len(growth) / duration), PARTS)]
    # parts may differ by one interval, the mean counts all alike
    exponents = growth.sum(axis=0) / duration
    errors = np.std(means, axis=0, ddof=1) / np.sqrt(PARTS)
    order = np.argsort(-exponents)
    return LyapunovSpectrum(exponents[order], errors[order], float(frames.t[0]), frames.y[0])
