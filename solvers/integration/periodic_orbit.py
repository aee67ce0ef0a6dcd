"""Periodic motions, and how perturbations of them grow in a period."""

from dataclasses import dataclass

import numpy as np

from solvers.equations.module import GeneratedModule, depends_on_time, function, has_function
from solvers.equations.quantities import Values, positive
from solvers.integration import validation
from solvers.integration.solution import Array
from solvers.integration.transition_matrix import transition_matrix

#: Most iterations of Newton's method.
MAX_ITERATIONS = 30
#: Defects below this may stagnate because of rounding errors of the motion.
SMALL = 1e-6
#: Relative step of differences of the energy, of which a few digits suffice.
STEP = 1e-5
#: Length of the gradient of the energy: short, since it is used where nothing else helps.
SHARE, TINY = 1e-3, float(np.finfo(float).tiny)


class NoPeriodicOrbitError(ArithmeticError):
    """Newton's method found no periodic motion near the guess."""


@dataclass(frozen=True)
class PeriodicOrbit:
    """A periodic motion.

    Attributes
    ----------
    y : ndarray of shape (state,)
        Coordinates and velocities at t = 0.
    period : float
        In s.
    monodromy : ndarray of shape (state, state)
        The transition matrix over the period.
    defect : float
        Largest difference of the state after the period from `y`, without whole turns.
    """

    y: Array
    period: float
    monodromy: Array
    defect: float

    @property
    def multipliers(self) -> Array:
        """Floquet multipliers, the eigenvalues of the monodromy matrix, the largest first.

        A perturbation that grows has one outside the unit circle. A motion of a system without
        explicit time has the multiplier 1, twice if energy is conserved.
        """
        values = np.linalg.eigvals(self.monodromy)
        return np.asarray(values[np.argsort(-np.abs(values))])


def periodic_orbit(
    module: GeneratedModule,
    y0: Values,
    period: float,
    params: Values,
    *,
    rtol: float = 1e-12,
    atol: float = 1e-12,
) -> PeriodicOrbit:
    """The periodic motion nearest to a guess, by Newton's method.

    Of a family of orbits, as those of different energies of a conservative system, the result is
    the member to which each step of Newton's method, the shortest that solves the linear equations,
    leads. Angles may turn by whole turns in a period.

    Parameters
    ----------
    module, params, rtol, atol
        As in `integrate`.
    y0 : array_like of shape (state,), or mapping of str to float
        Guess of the state at t = 0.
    period : float
        Guess of the period in s. If the system depends on time, it is the exact period: that of the
        system, or a multiple.

    Returns
    -------
    PeriodicOrbit
        The orbit, its monodromy matrix and Floquet multipliers.

    Raises
    ------
    ValueError
        When an argument is invalid, or `module` has no variational form.
    NoPeriodicOrbitError
        When the iteration does not converge.
    solvers.integration.prepare.NotFinishedError
        When a motion does not last for a period.

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> from solvers import periodic_orbit
    >>> orbit = periodic_orbit(sp, {"theta": 1.0}, 2.1, {"l": 1.0})
    >>> orbit.defect < 1e-11
    True
    """
    period = positive("period", period)
    y, constants = validation.initial_state(module, y0), validation.parameters(module, params)
    begin, end = (np.array(module.rhs(t, y.tolist(), constants.tolist())) for t in (0.0, period))
    if np.abs(end - begin).max() > SMALL * np.abs(begin).max():
        raise ValueError(
            f"period = {period} s is not one of {module.SYSTEM}: its equations differ after it"
        )
    angles = np.array([module.UNITS[name] == "rad" for name in module.STATE])
    turns, before = None, np.inf
    for _ in range(MAX_ITERATIONS):
        motion = transition_matrix(module, (0.0, period), y, constants, rtol=rtol, atol=atol)
        if turns is None:
            turns = angles * 2 * np.pi * np.round((motion.y - y) / (2 * np.pi))
        difference = motion.y - y - turns
        defect = float(np.abs(difference).max())
        rate = np.array(module.rhs(0.0, motion.y.tolist(), constants.tolist()))
        is_autonomous = not depends_on_time(module)
        if defect <= 10 * atol or before <= defect < SMALL:
            if is_autonomous and np.abs(rate).max() < SMALL:
                raise NoPeriodicOrbitError(f"{y} is an equilibrium: give a better guess")
            return PeriodicOrbit(y, period, motion.matrix, defect)
        n, unknowns = len(y), [motion.matrix - np.eye(len(y))]
        if is_autonomous:
            unknowns += [rate[:, np.newaxis], _energy_gradient(module, motion.y, constants)]
        change = np.linalg.lstsq(np.hstack(unknowns), -difference)[0]
        y, before = y + change[:n], defect
        period += float(change[n : n + 1].sum())
        if not 0 < period < np.inf:
            break
    raise NoPeriodicOrbitError(
        "the state still changes, after the last iteration of Newton's method, by "
        f"{defect:.1e} in a period of {period} s: give a better guess"
    )


def _energy_gradient(module: GeneratedModule, y: Array, params: Array) -> Array:
    """A short column along the gradient of the energy if it is conserved, else zeros.

    The equations of Newton's method for an orbit of a family are consistent in the limit only: a
    part along the gradient stays free, and vanishes (F. J. Muñoz-Almaraz et al., Physica D 181
    (2003) 1-38).
    """
    if has_function(module, "power") and function(module, "power")(0.0, y, params) != 0:
        return np.zeros((len(y), 1))
    energy, shifts = function(module, "energy"), STEP * np.diag(np.maximum(np.abs(y), 1.0))
    differences = [[energy(0.0, y + d, params) - energy(0.0, y - d, params)] for d in shifts]
    gradient = np.array(differences) / (2 * np.diag(shifts)[:, np.newaxis])
    return np.asarray(SHARE * gradient / max(float(np.linalg.norm(gradient)), TINY))
