"""Periodic orbits that are born at the normal modes of an equilibrium."""

import numpy as np

from solvers.equations.linearisation.linear_system import LinearSystem, Mode
from solvers.equations.module import GeneratedModule
from solvers.equations.number_checks import real_number
from solvers.equations.signature_checks import checked
from solvers.integration.orbits.orbit_newton import solve
from solvers.integration.orbits.orbit_shooting import OrbitConditions, OrbitStart
from solvers.integration.orbits.periodic_orbit import PeriodicOrbit
from solvers.integration.orbits.solution_curve import SolutionCurve
from solvers.integration.orbits.symmetry import Nature, Reversal
from solvers.runge_kutta.stepper import Array

#: Damping ratio below which a mode has none; distance of a ratio of frequencies from a whole
#: number; rate of the state at an equilibrium, relative to the frequency.
UNDAMPED, RESONANT, AT_REST = 1e-9, 1e-6, 1e-6
#: Amplitudes of orbits whose periods give the slope, relative to the largest; their first largest
#: amplitude, how often it is halved, and the relative change of the slope that ends this.
SHARES, LARGEST, HALVINGS, CLOSE = np.array([0.25, 0.5, 0.75, 1.0]), 0.2, 6, 1e-9


@checked
def normal_mode_orbit(
    module: GeneratedModule,
    equilibrium: LinearSystem,
    mode: Mode,
    amplitude: float,
    *,
    rtol: float = 1e-12,
    atol: float = 1e-12,
) -> PeriodicOrbit:
    """The periodic orbit of a given amplitude in the family born at a normal mode.

    An undamped mode whose frequency is not a divisor of another one's is the limit of a family of
    periodic orbits (A. M. Lyapunov's centre theorem, 1892), which `orbit_family` continues.

    Parameters
    ----------
    module, rtol, atol
        As in `integrate`.
    equilibrium : LinearSystem
        An equilibrium, as `equilibria` and `linearise` return it, with its parameters.
    mode : Mode
        One of ``equilibrium.modes``.
    amplitude : float
        Displacement at t = 0, from the equilibrium, of the coordinate that is largest in the mode,
        in the unit of that coordinate.

    Returns
    -------
    PeriodicOrbit
        The orbit; it has the symmetry of all velocities if the system has it.

    Raises
    ------
    ValueError
        When an argument is invalid, the system does not conserve its energy, the mode is damped,
        or another mode is in resonance with it.
    NoPeriodicOrbitError
        When the iteration does not converge.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> from solvers import equilibria, normal_mode_orbit
    >>> rest = equilibria(dp, {})[0]
    >>> orbit = normal_mode_orbit(dp, rest, rest.modes[0], 0.1)
    >>> orbit.stability, orbit.symmetry
    ('neutral', ('theta1_dot', 'theta2_dot'))
    """
    amplitude = real_number("amplitude", amplitude)
    if len(equilibrium.y) != len(module.STATE):
        raise ValueError(f"equilibrium = {equilibrium!r} is not one of {module.SYSTEM}")
    frequency = _frequency(equilibrium, mode)
    n, largest = len(mode.shape), int(np.argmax(np.abs(mode.shape)))
    shape = mode.shape / mode.shape[largest]
    displacement = amplitude * np.concatenate([shape, mode.eigenvalue * shape]).real
    params = np.array(equilibrium.params)
    reversal = Reversal.of_velocities(module, equilibrium.y, params)
    nature = Nature.of(module, equilibrium.y, params)
    shooting = OrbitConditions(module, nature, rtol, atol, reversal)
    point = OrbitStart(equilibrium.y + displacement, 2 * np.pi / frequency, params)
    if not shooting.nature.is_conservative:
        raise ValueError(f"{module.SYSTEM} does not conserve its energy: no family is born at rest")
    if amplitude == 0:
        raise ValueError("amplitude = 0 is the equilibrium: give another one, such as 0.1")
    fixed = np.eye(2 * n + 2)[[largest]]
    if reversal is None:
        fixed = np.concatenate([fixed, SolutionCurve(shooting, np.ones(2 * n + 2)).phase(point)])
    point, shot = solve(shooting, point, fixed)
    return PeriodicOrbit.of(shooting, point, shot)


@checked
def backbone_slope(module: GeneratedModule, equilibrium: LinearSystem, mode: Mode) -> float:
    """The slope dT/da² at the birth of a family of orbits at a normal mode.

    T is the period in s, and a the amplitude of `normal_mode_orbit`. It is the limit of the slopes
    of polynomials in a² through the periods of orbits with decreasing amplitudes.

    Parameters
    ----------
    module, equilibrium, mode
        As in `normal_mode_orbit`, whose errors are raised, too.

    Returns
    -------
    float
        In s, over the square of the unit of the coordinate that is largest in the mode.

    Examples
    --------
    >>> import generated.single_pendulum as sp
    >>> from solvers import backbone_slope, equilibria
    >>> rest = equilibria(sp, {"l": 9.81})[0]
    >>> slope = backbone_slope(sp, rest, rest.modes[0])  # T = 2π (1 + a²/16 + ...)
    >>> bool(abs(slope - 3.141592653589793 / 8) < 1e-9)
    True
    """
    birth, largest, slope = 2 * np.pi / _frequency(equilibrium, mode), LARGEST, np.inf
    for _ in range(HALVINGS):
        amplitudes: Array = largest * SHARES
        orbits = [normal_mode_orbit(module, equilibrium, mode, a) for a in amplitudes]
        quotients = [(o.period - birth) / a**2 for o, a in zip(orbits, amplitudes, strict=True)]
        limit = np.polynomial.polynomial.polyfit(amplitudes**2, quotients, len(SHARES) - 1)[0]
        before, slope = slope, float(limit)
        if abs(slope - before) <= CLOSE * abs(slope):
            break
        largest /= 2
    return slope


def _frequency(equilibrium: LinearSystem, mode: Mode) -> float:
    """The angular frequency of a mode at which a family is born."""
    frequency = mode.eigenvalue.imag
    if np.abs(equilibrium.rate).max() > AT_REST * max(1.0, frequency):
        raise ValueError(f"y = {equilibrium.y} is no equilibrium: its rate is {equilibrium.rate}")
    if frequency <= 0 or abs(mode.damping_ratio) > UNDAMPED:
        raise ValueError(f"no family is born at {mode}: it must oscillate without damping")
    for other in equilibrium.modes:
        ratio = other.eigenvalue.imag / frequency
        is_same = abs(other.eigenvalue - mode.eigenvalue) <= RESONANT * frequency
        if not is_same and round(ratio) > 0 and abs(ratio - round(ratio)) < RESONANT:
            raise ValueError(
                f"the mode of {mode.frequency} Hz is in resonance with that of {other.frequency} "
                "Hz, and may have no family: change a parameter"
            )
    return float(frequency)
