"""The rolling disc: Legendre functions, steady motions, and speeds at which it stays upright.

S. A. Chaplygin (1897), P. Appell and D. Korteweg (1899): the angular velocity n about the axle is
a Legendre function of the sine of the lean. Speeds: K. T. McDonald, arXiv:physics/0008227.
"""

import numpy as np
import pytest
from mpmath import cos, hyp2f1, mp, mpf, sin, sqrt
from numpy.typing import NDArray

import generated.rolling_disc as disc
from solvers import integrate, linearise

DISC, HOOP = 0.25, 0.5
G, R = 9.81, 0.3
STRICT = {"method": "verner98", "rtol": 1e-13, "atol": 1e-13}


def own(y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angular velocities about the axle and across it, upwards."""
    _, _, _, phi, _, _, _, heading, _, spin = y
    return np.array([spin + heading * np.sin(phi), heading * np.cos(phi)])


def start(phi: float, rates: tuple[float, float, float]) -> list[float]:
    """A state by the lean and the rates of heading, lean and turn; the heading is along x."""
    return [0.0, 0.0, 0.0, phi, 0.0, R * rates[2], 0.0, *rates]


def legendre(k: float, phi: float, since: float, values: NDArray[np.float64]) -> list[float]:
    """n and ψ̇ cos φ at a lean, by series in sin φ from their values at another lean.

    (2 k + 1) dn/dφ = -ψ̇ cos φ, and with u = sin φ, (1 - u²) n'' - 2 u n' = 2 n/(2 k + 1).
    """
    factor = 2 * mpf(k) + 1
    nu = (-1 + sqrt(1 - 8 / factor)) / 2  # nu (nu + 1) = -2/(2 k + 1)
    pair = ((-nu / 2, (1 + nu) / 2, mpf("0.5")), ((1 - nu) / 2, 1 + nu / 2, mpf("1.5")))

    def rows(angle: float) -> mp.matrix:
        u, result = sin(mpf(angle)), mp.matrix(2, 2)
        for column, (a, b, c) in enumerate(pair):
            value, slope = hyp2f1(a, b, c, u**2), a * b / c * hyp2f1(a + 1, b + 1, c + 1, u**2)
            n, change = (value, 2 * u * slope) if column == 0 else (
                u * value, value + 2 * u**2 * slope)  # fmt: skip
            result[0, column], result[1, column] = n.real, -factor * cos(mpf(angle)) * change.real
        return result

    ends = rows(phi) * (rows(since) ** -1) * mp.matrix(values.tolist())
    return [float(one) for one in ends]


@pytest.mark.parametrize("k", [DISC, HOOP])
def test_spins_are_legendre_functions_of_the_lean(k: float) -> None:
    params = disc.params(R=R, k=k, g=G)
    times, y0 = np.linspace(0, 20, 21), start(0.4, (1.5, 0.3, 4.0))
    motion = integrate(disc, (0, 20), y0, params, t_eval=times, **STRICT)
    first, leans = own(motion.y[:, :1])[:, 0], motion.y[3]
    assert np.ptp(leans) > 0.3
    expected = np.transpose([legendre(k, lean, 0.4, first) for lean in leans])
    assert np.abs(own(motion.y) - expected).max() < 2e-11
    other = legendre(k + 1e-7, float(leans[7]), 0.4, first)
    assert abs(other[0] - expected[0, 7]) > 1e-10
    energy = disc.energy_many(times, motion.y, params)
    assert np.abs(energy - energy[0]).max() < 1e-12 * energy[0]
    slips = disc.constraints_many(times, motion.y, params)
    assert np.abs(slips).max() < 1e-14 * R * np.abs(motion.y[9]).max()


@pytest.mark.parametrize("k", [DISC, HOOP])
def test_it_rolls_upright_above_a_speed_and_spins_upright_above_another(k: float) -> None:
    # published: v² > g R/3 and Ω² > 4 g/(5 R) of a disc; v² > g R/4 and Ω² > 2 g/(3 R) of a hoop
    rolling, spinning = (G * R / 3, 4 * G / (5 * R)) if k == DISC else (G * R / 4, 2 * G / (3 * R))
    params = disc.params(R=R, k=k, g=G)
    for square, least, slope in (
        (lambda v: v**2, rolling, 2 * (2 * k + 1) / ((k + 1) * R**2)),
        (lambda rate: rate**2, spinning, 1.0),
    ):
        for fraction in (0.9, 0.999, 1.001, 1.4):
            size = np.sqrt(fraction * least)
            rates = (0, 0, size / R) if least == rolling else (size, 0, 0)
            linear = linearise(disc, start(0.0, rates), params)
            grows = linear.eigenvalues.real.max()
            change = slope * (least - square(size))  # φ̈ = change φ
            assert grows == pytest.approx(np.sqrt(max(change, 0)), abs=1e-7)
            if change < 0:
                assert linear.eigenvalues.imag.max() == pytest.approx(np.sqrt(-change), rel=1e-12)


def test_it_rolls_in_circles_with_a_constant_lean() -> None:
    # k ψ̇² sin φ cos φ - (2 k + 1) ψ̇ n cos φ = g/R sin φ, on a circle whose centre is -R n/ψ̇ away
    lean, rate = 0.5, 1.2
    sine, cosine = np.sin(lean), np.cos(lean)
    n = (DISC * rate**2 * sine * cosine - G / R * sine) / ((2 * DISC + 1) * rate * cosine)
    y0 = start(lean, (rate, 0.0, n - rate * sine))
    turn = 2 * np.pi / rate
    motion = integrate(disc, (0, turn), y0, {}, t_eval=[turn / 2, turn], **STRICT)
    diameter = 2 * R * (n - rate * sine) / rate  # of the circle of the point of contact
    assert motion.y[:2] == pytest.approx(np.array([[0, 0], [diameter, 0]]), abs=1e-10)
    assert motion.y[3] == pytest.approx(lean, abs=1e-10)
