"""The single pendulum in closed form, by Jacobi's elliptic functions."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ellipj, ellipkinc

Array = NDArray[np.float64]


def pendulum(
    length: float, gravity: float, y0: tuple[float, float], times: ArrayLike
) -> Array:  # fmt: skip
    """States (theta, theta_dot) of a single pendulum that has the state `y0` at time 0.

    Parameters
    ----------
    length, gravity : float
        In m and m/s², both positive.
    y0 : pair of float
        Angle from the downward vertical in rad, and its velocity in rad/s.
    times : array_like of shape (n,)
        In s.

    Returns
    -------
    ndarray of shape (n, 2)
        Angles, not wrapped, and velocities.

    Notes
    -----
    With ω = √(g/l) and s = sin(θ/2), energy is k² = s² + (θ̇/2ω)². Swinging (k < 1),
    sin(θ/2) = k sn(u, k²) with u = ωt + u₀; turning over (k > 1), θ/2 = am(ku, 1/k²);
    on the separatrix (k = 1), tan(θ/4) = tanh(u/2) (NIST Digital Library of
    Mathematical Functions, 22.19(i)).
    """
    t = np.asarray(times, dtype=float)
    omega = np.sqrt(gravity / length)
    theta, rate = y0
    whole = np.round(theta / (2 * np.pi))
    theta = theta - 2 * np.pi * whole
    speed = rate / (2 * omega)
    sine = np.sin(theta / 2)
    k = np.hypot(sine, speed)
    if k == 0:
        angle, velocity = np.zeros_like(t), np.zeros_like(t)
    elif k < 1:
        amplitude = np.arctan2(sine, speed)
        u = omega * t + ellipkinc(amplitude, k * k)
        sn, cn, dn, _ = ellipj(u, k * k)
        angle, velocity = 2 * np.arctan2(k * sn, dn), 2 * omega * k * cn
    elif k == 1:
        way = np.sign(speed)
        u = omega * t + way * 2 * np.arctanh(np.tan(theta / 4))
        angle = 4 * np.arctan(np.tanh(way * u / 2))
        velocity = way * 2 * omega / np.cosh(u)
    else:
        way = np.sign(speed)
        u = omega * k * t + way * ellipkinc(theta / 2, 1 / k**2)
        _, _, dn, am = ellipj(u, 1 / k**2)
        angle, velocity = way * 2 * am, way * 2 * omega * k * dn
    return np.stack([angle + 2 * np.pi * whole, velocity], axis=-1)
