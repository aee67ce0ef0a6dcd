"""The gyroscope in gimbals: quadratures of its nutation, its drift, and a body without gimbals."""

import numpy as np
import pytest
from mpmath import cos, findroot, mpf, pi, quad, sin, sqrt, workdps

import generated.gyroscope as gyroscope
from solvers import integrate

STRICT = {"method": "verner98", "rtol": 1e-13, "atol": 1e-13}
START = (0.0, 0.5, 0.0, 0.4, 0.0, 6.0)


def momenta(params: tuple[float, ...], y: tuple[float, ...]) -> tuple[mpf, mpf]:
    """Of the outer gimbal and of the rotor."""
    I, A1, _, C1, A, C = map(mpf, params)  # noqa: E741
    _, beta, _, rate, _, spin = map(mpf, y)
    own = C * (spin + rate * sin(beta))
    across = I + (A + A1) * cos(beta) ** 2 + C1 * sin(beta) ** 2
    return across * rate + own * sin(beta), own


def nutation(params: tuple[float, ...], y: tuple[float, ...]) -> tuple[mpf, mpf]:
    """Period of β, and the angle α of the outer gimbal in it, by quadratures from β̇ = 0.

    (A + B1) β̇² = 2 E - n² - (a - c sin β)²/(I + (A + A1) cos² β + C1 sin² β), with the momenta.
    """
    I, A1, B1, C1, A, _ = map(mpf, params)  # noqa: E741
    total, own = momenta(params, y)

    def inertia(beta: mpf) -> mpf:
        return I + (A + A1) * cos(beta) ** 2 + C1 * sin(beta) ** 2

    def rate(beta: mpf) -> mpf:
        return (total - own * sin(beta)) / inertia(beta)

    def energy(beta: mpf) -> mpf:
        return inertia(beta) * rate(beta) ** 2

    first = mpf(y[1])
    last = findroot(lambda b: (energy(b) - energy(first)) / (b - first), first + mpf("0.1"))
    middle, half = (first + last) / 2, (last - first) / 2

    def slowness(angle: mpf) -> mpf:  # dt/du with β = middle + half sin u
        beta = middle + half * sin(angle)
        return half * cos(angle) / sqrt((energy(first) - energy(beta)) / (A + B1))

    ends = [-pi / 2, 0, pi / 2]
    period = 2 * quad(slowness, ends, method="gauss-legendre")
    drift = 2 * quad(
        lambda u: rate(middle + half * sin(u)) * slowness(u), ends, method="gauss-legendre"
    )
    return period, drift


def test_nutation_and_drift_are_those_of_quadratures() -> None:
    params = gyroscope.DEFAULTS
    with workdps(30):
        period, drift = map(float, nutation(params, START))
    motion = integrate(gyroscope, (0, 50 * period), START, params, t_eval=[50 * period], **STRICT)
    alpha, beta, _, rate, change, spin = motion.y[:, -1]
    assert (beta, rate, change) == pytest.approx((0.5, 0.4, 0.0), abs=1e-10)
    assert spin == pytest.approx(6.0, abs=1e-10)
    assert alpha == pytest.approx(50 * drift, abs=1e-10)
    with workdps(30):
        other = float(nutation(gyroscope.params(I=2 + 1e-8), START)[1])
    assert abs(other - drift) > 1e-11
    energy = gyroscope.energy(motion.t[-1], motion.y[:, -1], params)
    assert energy == pytest.approx(gyroscope.energy(0.0, START, params), rel=1e-13)


def test_small_nutations_have_the_published_frequency() -> None:
    # K. Magnus, of an axis across the outer gimbal's: C n/sqrt((A + B1) (I + A + A1))
    I, A1, B1, _, A, C = gyroscope.DEFAULTS  # noqa: E741
    still = (0.0, 0.0, 0.0, 0.0, 0.0, 5.0)
    jacobian = np.array(gyroscope.jacobian(0.0, still, gyroscope.DEFAULTS))
    frequency = np.linalg.eigvals(jacobian).imag.max()
    assert frequency == pytest.approx(C * 5 / np.sqrt((A + B1) * (I + A + A1)), rel=1e-13)


def test_without_gimbals_the_axis_turns_about_the_angular_momentum() -> None:
    # a free symmetric body: L. D. Landau, E. M. Lifshitz, Mechanics, § 33
    params = gyroscope.params(I=1e-13, A1=1e-13, B1=1e-13, C1=1e-13)
    times = np.linspace(0, 10, 41)
    motion = integrate(gyroscope, (0, 10), START, params, t_eval=times, **STRICT)
    alpha, beta = motion.y[:2]
    axis = np.array([-np.sin(alpha) * np.cos(beta), np.cos(alpha) * np.cos(beta), np.sin(beta)])
    momentum = np.array(gyroscope.angular_momentum(0.0, START, params))
    size = np.linalg.norm(momentum)
    about, angles = momentum / size, size / 2.0 * times
    first = axis[:, 0]
    along = about * (about @ first)
    expected = (
        along[:, None]
        + np.outer(first - along, np.cos(angles))
        + np.outer(np.cross(about, first), np.sin(angles))
    )
    assert np.abs(axis - expected).max() < 1e-10
