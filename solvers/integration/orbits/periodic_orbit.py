"""Periodic orbits: period, multipliers and stability, and the orbit near a guess."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import GeneratedModule, function, integrals
from solvers.equations.number_checks import Values, positive, real_number
from solvers.equations.signature_checks import checked
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.given_tolerances import single_motion
from solvers.integration.orbits.orbit_newton import NoPeriodicOrbitError, solve
from solvers.integration.orbits.orbit_shooting import SMALL, TINY, OrbitConditions, OrbitStart, Shot
from solvers.integration.orbits.symmetry import Nature, Reversal
from solvers.integration.problem import validation
from solvers.integration.problem.events import Event
from solvers.integration.problem.problem import Options
from solvers.integration.problem.status import Status
from solvers.io.suggestion import shortened
from solvers.runge_kutta.stepper import Array

#: Name of the quantity that varies along a family of a conservative system.
ENERGY = "energy"
#: Distance from the unit circle at which a multiplier counts as on it: close to another one it
#: has errors of the square root of those of the matrix.
NEUTRAL = 1e-5


@dataclass(frozen=True, repr=False)
class PeriodicOrbit:
    """A periodic motion.

    Attributes
    ----------
    y : ndarray of shape (state,)
        Coordinates and velocities at t = 0.
    period : float
        In s.
    params : tuple of float
        All parameters.
    energy : float
        Energy in J at t = 0.
    monodromy : ndarray of shape (state, state)
        The transition matrix over the period.
    multipliers : ndarray of shape (state,)
        Floquet multipliers, the eigenvalues of the monodromy matrix, the largest first. A
        perturbation that grows has one outside the unit circle. A motion of a system without
        explicit time has the multiplier 1, twice if energy is conserved; these are exact, the
        others those of the perturbations that remain.
    defect : float
        Largest difference of the state after the period from `y`, without whole turns; of an orbit
        with a symmetry, of the components that are to vanish after half the period.
    symmetry : tuple of str
        Components of the state that vanish at t = 0 and after half the period, if these conditions
        determine the orbit.
    """

    y: Array
    period: float
    params: tuple[float, ...]
    energy: float
    monodromy: Array = field(repr=False)
    multipliers: NDArray[np.complex128]
    defect: float
    symmetry: tuple[str, ...] = ()

    @classmethod
    def of(cls, shooting: OrbitConditions, point: OrbitStart, shot: Shot) -> "PeriodicOrbit":
        """The orbit through a point."""
        others = np.linalg.eigvals(reduced(shooting, point, shot.monodromy))
        values = np.concatenate([others, np.ones(len(point.y) - len(others))])
        return cls(
            point.y,
            point.period,
            tuple(point.params.tolist()),
            shooting.energy(point),
            shot.monodromy,
            values[np.argsort(-np.round(np.abs(values), 8), kind="stable")].astype(complex),
            float(np.abs(shot.residual).max()),
            shooting.reversal.names if shooting.reversal else (),
        )

    @property
    def stability(self) -> str:
        """``asymptotically stable``, ``unstable``, or ``neutral``: linear terms do not decide.

        Motions near an orbit of a system without friction that is not unstable are neutral.
        """
        sizes = np.abs(self.multipliers)
        if sizes[0] > 1 + NEUTRAL:
            return "unstable"
        is_trivial = np.abs(self.multipliers - 1) == 0
        if is_trivial.sum() <= 1 and (sizes[~is_trivial] < 1 - NEUTRAL).all():
            return "asymptotically stable"
        return "neutral"

    def __repr__(self) -> str:
        return (
            f"PeriodicOrbit(y={self.y}, period={self.period} s, energy={self.energy} J, "
            f"{self.stability}, defect={self.defect:.1e})"
        )


def reduced(shooting: OrbitConditions, point: OrbitStart, monodromy: Array) -> Array:
    """The monodromy matrix for perturbations across the orbit that keep the energy.

    In an orthonormal basis of the direction of the motion, the remaining directions, and the
    gradient of a conserved energy, the matrix is block triangular; the first and the last block
    are 1.
    """
    if not shooting.nature.is_autonomous:
        return monodromy
    trivial = [shooting.rate(point)]
    if shooting.nature.is_conservative:
        trivial.append(shooting.unfolding(point))
    columns = [vector / max(float(np.linalg.norm(vector)), TINY) for vector in trivial]
    q = np.linalg.qr(np.column_stack([*columns, np.eye(len(point.y))]))[0]
    rest = q[:, len(columns) :]
    return np.asarray(rest.T @ monodromy @ rest)


#: Durations in s of motions to a section, one after the other: periods may be those of a molecule
#: or of a planet. A motion that has not come back after so many steps never does.
DURATIONS, MAX_STEPS = (1e3, 1e6, 1e9, 1e12), 100_000


@checked
def periodic_orbit(
    module: GeneratedModule,
    y0: Values,
    period: float | Event,
    params: Values,
    *,
    returns: int = 1,
    energy: float | None = None,
    symmetry: Sequence[str] = (),
    rtol: float = 1e-12,
    atol: float = 1e-12,
) -> PeriodicOrbit:
    """The periodic motion nearest to a guess, by Newton's method.

    A conservative system has a family of orbits of different energies. The result is the member of
    the energy of the guess, if a section is given, or of a given energy. Otherwise it is that to
    which each step of Newton's method, the shortest that solves the linear equations, leads. Steps
    towards an equilibrium, or a period of 0, are shortened. Angles may turn by whole turns in a
    period.

    Parameters
    ----------
    module, params, rtol, atol
        As in `integrate`.
    y0 : array_like of shape (state,), or mapping of str to float
        Guess of the state at t = 0.
    period : float or Event
        Guess of the period in s. If the system depends on time, it is the exact period: that of the
        system, or a multiple. An event is a section: the orbit starts on it where the motion from
        `y0` first meets it, and the guess is the time until its return.
    returns : int, optional
        How many crossings of the section make a period.
    energy : float, optional
        Energy in J of the orbit, if the system conserves its energy; by default that of `y0` if
        `period` is a section, else it is free.
    symmetry : sequence of str, optional
        Names of half of the components of the state that are 0 at t = 0 and after half the period,
        such as all velocities of an orbit between two points of rest; angles may be at any half
        turn. Only half the period is integrated. The equations must stay the same if time is
        reversed and these components change their signs.

    Returns
    -------
    PeriodicOrbit
        The orbit, its monodromy matrix and Floquet multipliers.

    Raises
    ------
    ValueError
        When an argument is invalid, `module` has no variational form, or an energy is given for a
        system that does not conserve it.
    NoPeriodicOrbitError
        When the iteration does not converge, or the guess or the result is an equilibrium.
    solvers.integration.prepare.NotFinishedError
        When the motion from the guess does not last for a period.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> from solvers import Event, periodic_orbit
    >>> orbit = periodic_orbit(dp, {"theta1": 0.5, "theta2": 0.7}, 3.7, {}, symmetry=dp.STATE[2:])
    >>> orbit.defect < 1e-11, orbit.stability
    (True, 'neutral')
    >>> section = Event(dp, "theta1", 0.0, direction=1)
    >>> bool(abs(periodic_orbit(dp, orbit.y, section, {}).y[0]) < 1e-9)
    True
    """
    constants = validation.parameters(module, params)
    y = validation.initial_state(module, y0, params=constants.tolist())
    nature = Nature.of(module, y, constants)
    if energy is not None and not nature.is_conservative:
        raise ValueError(
            f"energy = {shortened(energy)} cannot be held: {module.SYSTEM} does not conserve its "
            "energy with these parameters; leave it out"
        )
    shooting = OrbitConditions(module, nature, rtol, atol)
    fixed = np.empty((0, len(y) + 2))
    if isinstance(period, Event):
        y, duration = _returned(module, y, period, constants, returns)
        fixed = np.eye(len(y), len(y) + 2)[[module.STATE.index(period.name)]]
    else:
        duration = positive("period", period)
    if symmetry:
        reversal = Reversal.of(module, symmetry, y, constants)
        y[reversal.changed] = reversal.nearest(y)
        shooting = replace(shooting, reversal=reversal)
    point = OrbitStart(y, duration, constants)
    shooting.check_period(point)
    if energy is not None:
        shooting = replace(shooting, energy_held=real_number("energy", energy, "J"))
    elif isinstance(period, Event) and nature.is_conservative:
        shooting = replace(shooting, energy_held=shooting.energy(point))
    if integrals(module):
        values = function(module, "integrals")(0.0, y.tolist(), constants.tolist())
        shooting = replace(shooting, integrals_held=np.array(values))
    _check_moves(shooting, point)
    point, shot = solve(shooting, point, fixed, scales=_magnitudes(shooting, point))
    _check_moves(shooting, point)
    return PeriodicOrbit.of(shooting, point, shot)


def _magnitudes(shooting: OrbitConditions, point: OrbitStart) -> Array:
    """Those of components of the state, of the period and of a parameter, at least 1.

    Of a satellite in SI units they are millions of metres, thousands of metres per second, and the
    time in which it moves by one radian.
    """
    radian = point.period / (2 * np.pi)
    sizes = np.maximum(np.abs(point.y), np.abs(shooting.rate(point)) * radian)
    return np.maximum([*sizes, radian, 1.0], 1.0)


def _check_moves(shooting: OrbitConditions, point: OrbitStart) -> None:
    """`NoPeriodicOrbitError` at an equilibrium."""
    if shooting.nature.is_autonomous and np.abs(shooting.rate(point)).max() < SMALL:
        raise NoPeriodicOrbitError(f"{point.y} is an equilibrium: give a better guess")


def _returned(
    module: GeneratedModule, y0: Array, section: Event, params: Array, returns: int
) -> tuple[Array, float]:
    """The state at which a motion first meets a section, and the time until its return."""
    section = replace(section, terminal=True)
    y, duration, count = y0, 0.0, validation.count("returns", returns, 1)
    if section(0.0, y0) != 0:
        y = _met(module, y0, section, params)[1]
        y[module.STATE.index(section.name)] = section.value
    state = y
    for _ in range(count):
        t, state = _met(module, state, section, params)
        duration += t
    return y, duration


def _met(module: GeneratedModule, y0: Array, section: Event, params: Array) -> tuple[float, Array]:
    """The time after which a motion meets a section, and the state there."""
    for duration in DURATIONS:
        with ignore_predictability():  # of motions that do not meet the section
            options = Options(events=section, t_eval=(), max_steps=MAX_STEPS)
            motion = single_motion(module, (0.0, duration), y0, params, options)
        if len(motion.t_events[0]):
            return float(motion.t_events[0][0]), motion.y_events[0][0].copy()
        if motion.status is not Status.FINISHED:
            break
    raise NoPeriodicOrbitError(
        f"the motion does not meet {section.name} = {section.value} again "
        f"({motion.status.reason}): choose another section or start"
    )
