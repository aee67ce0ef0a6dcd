"""Rigid bodies in closed form, by Jacobi's elliptic functions: free bodies, and Lagrange's top.

Sources: L. D. Landau, E. M. Lifshitz, Mechanics, § 37 (free body) and § 35 (top); E. T. Whittaker,
Analytical Dynamics, § 69 and § 71.
"""

import numpy as np
import scipy
from numpy.typing import NDArray

Array = NDArray[np.float64]


def free_body(
    moments: tuple[float, float, float], rates: tuple[float, float], times: Array
) -> Array:
    """Angular velocity of a free body about its principal axes, a row for each.

    Parameters
    ----------
    moments : tuple of float
        Principal moments A < B < C.
    rates : tuple of float
        Angular velocities about the axes of A and C at t = 0, positive; that about B's axis is 0.
    times : array of float
        Times in s.
    """
    (A, B, C), (first, third) = moments, rates
    twice_energy = A * first**2 + C * third**2
    square = (A * first) ** 2 + (C * third) ** 2
    is_about_first = square < twice_energy * B  # then the roles of A and C change
    if is_about_first:
        A, C, first, third = C, A, third, first
    low, high = twice_energy * C - square, square - twice_energy * A
    pace = np.sqrt((C - B) * high / (A * B * C))
    sn, cn, dn, _ = scipy.special.ellipj(pace * times, (B - A) * low / ((C - B) * high))
    omega = np.array([first * cn, np.sqrt(low / (B * (C - B))) * sn, third * dn])
    return omega[::-1] if is_about_first else omega


def top_inclination(
    inertia: tuple[float, float], weight: float, start: tuple[float, float, float], times: Array
) -> Array:
    """Cosine of the angle between the vertical and the axis of a heavy symmetric top.

    Parameters
    ----------
    inertia : tuple of float
        Moments of inertia about the fixed point: across the axis, and about it.
    weight : float
        Weight times the distance of the centre of mass, in J.
    start : tuple of float
        Inclination θ, and rates of precession φ and spin ψ at t = 0, where θ̇ = 0.
    times : array of float
        Times in s.
    """
    (across, along), (theta, precession, spin) = inertia, start
    u = np.cos(theta)
    own = along * (precession * u + spin)  # about the axis
    vertical = across * precession * np.sin(theta) ** 2 + own * u
    energy = across * (precession * np.sin(theta)) ** 2 / 2 + weight * u
    # u̇² = 2 (E - W u) (1 - u²)/A - ((L - M u)/A)², a cubic whose first two roots bound the motion
    slope = 2 * weight / across
    cubic = [
        slope,
        -2 * energy / across - (own / across) ** 2,
        2 * vertical * own / across**2 - slope,
        2 * energy / across - (vertical / across) ** 2,
    ]
    low, high, outer = np.sort(np.roots(cubic).real)
    m = (high - low) / (outer - low)
    phase = scipy.special.ellipk(m) if abs(u - high) < abs(u - low) else 0.0
    sn, *_ = scipy.special.ellipj(np.sqrt(slope * (outer - low) / 4) * times + phase, m)
    return np.asarray(low + (high - low) * sn**2)
