"""The pendulum in closed form, by Jacobi's elliptic functions.

Source: E. T. Whittaker, Analytical Dynamics, § 69; functions as in NIST's DLMF, chapter 22.
"""

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def pendulum(length: float, gravity: float, y0: tuple[float, float], times: ArrayLike) -> Array:
    """States (theta, theta_dot) of a single pendulum with the state `y0` at time 0, shape (n, 2).

    Angles are measured from the downward vertical, and are not wrapped. All quantities are in SI
    units.

    With ω = √(g/l), energy is k² = sin²(θ/2) + (θ̇/2ω)². Swinging (k < 1),
    sin(θ/2) = k sn(u, k) with u = ωt + u₀; turning over (k > 1), θ/2 = am(ku, 1/k) (NIST
    Digital Library of Mathematical Functions, 22.19(i)); on the separatrix (k = 1), θ = 2 gd(u).
    1 - k² is computed as cos²(θ/2) - (θ̇/2ω)², which stays accurate close to the separatrix.
    """
    omega = np.sqrt(gravity / length)
    whole = np.round(y0[0] / (2 * np.pi))
    half, speed = (y0[0] - 2 * np.pi * whole) / 2, y0[1] / (2 * omega)
    states = swing(omega, np.sin(half), np.cos(half), speed, times)
    return states + np.array([2 * np.pi * whole, 0.0])


def swing(omega: float, sine: float, cosine: float, speed: float, times: ArrayLike) -> Array:
    """As `pendulum`, from ω = √(g/l) and sin θ/2, cos θ/2 and θ̇/2ω at time 0, with |θ| ≤ π."""
    t = np.asarray(times, dtype=float)
    k, complement = np.hypot(sine, speed), (cosine - speed) * (cosine + speed)  # 1 - k²
    direction = np.sign(speed)
    if k == 0:
        angle, velocity = np.zeros_like(t), np.zeros_like(t)
    elif complement > 0:
        u = omega * t + elliptic_integral(sine / k, speed / k, complement)
        sn, cn, dn = jacobi(u, complement)[:3]
        angle, velocity = 2 * np.arctan2(k * sn, dn), 2 * omega * k * cn
    elif complement < 0:
        reciprocal = -complement / k**2  # 1 - 1/k²
        u = omega * k * t + direction * elliptic_integral(sine, cosine, reciprocal)
        _, _, dn, am = jacobi(u, reciprocal)
        angle, velocity = direction * 2 * am, direction * 2 * omega * k * dn
    else:
        u = direction * omega * t + 2 * np.arctanh(sine / (1 + cosine))
        angle, velocity = 4 * np.arctan(np.tanh(u / 2)), direction * 2 * omega / np.cosh(u)
    return np.stack([angle, velocity], axis=-1)


def elliptic_integral(sine: float, cosine: float, complement: float) -> float:
    """F(φ, k) for |φ| ≤ π by its sine and cosine, with complement = 1 - k² in (0, 1].

    By Carlson's integral (NIST Digital Library of Mathematical Functions, 19.25.5).
    """
    if cosine < 0:
        whole = np.copysign(2 * scipy.special.elliprf(0.0, complement, 1.0), sine)  # ±2K
        return float(whole - elliptic_integral(sine, -cosine, complement))
    return float(sine * scipy.special.elliprf(cosine**2, cosine**2 + complement * sine**2, 1.0))


def jacobi(u: Array, complement: float) -> tuple[Array, Array, Array, Array]:
    """Jacobi's sn, cn, dn and am of real `u`, with complement = 1 - k² in (0, 1], am unwrapped.

    By the arithmetic-geometric mean (NIST Digital Library of Mathematical Functions,
    22.20(ii)), after reduction of `u` to at most half a quarter period by 22.4(iii), so
    that cn and dn keep their digits where they are small.
    """
    quarter = scipy.special.elliprf(0.0, complement, 1.0)  # K
    halves = np.round(u / (2 * quarter))
    rest = u - 2 * quarter * halves
    is_reflected = np.abs(rest) > quarter / 2
    v = np.where(is_reflected, quarter - np.abs(rest), np.abs(rest))
    a, b, c = 1.0, np.sqrt(complement), np.sqrt(1 - complement)
    ratios = []
    while c > np.finfo(float).eps * a:
        product = a * b
        a, b, c = (a + b) / 2, np.sqrt(product), (a - b) / 2
        ratios.append((c / a, product / a**2))
    phi = 2 ** len(ratios) * a * v
    for ratio, rest_of_square in reversed(ratios):
        # the arcsine of ratio sin φ, which loses half its digits where both are close to 1
        sine = ratio * np.sin(phi)
        cosine = np.hypot(np.cos(phi), np.sqrt(rest_of_square) * np.sin(phi))
        phi = (phi + np.arctan2(sine, cosine)) / 2
    sn, cn = np.sin(phi), np.cos(phi)
    dn = np.sqrt(cn**2 + complement * sn**2)
    root = np.sqrt(complement)
    sn, cn, dn = np.where(is_reflected, (cn / dn, root * sn / dn, root / dn), (sn, cn, dn))
    sn = np.copysign(sn, rest)
    am = np.arctan2(sn, cn) + np.pi * halves
    sign = np.where(halves % 2, -1.0, 1.0)
    return sign * sn, sign * cn, dn, am
