"""Andrews' squeezer, from positions and points that coincide, against published numbers.

Data and equations:
E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, Springer 1996, VII.7; initial
values and solution: F. Mazzia, C. Magherini, Test Set for Initial Value Problem Solvers, II.10.
"""

from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest

from holonomic import integrate
from solvers.references.taylor import taylor

#: Published angles at the start, where the mechanism is at rest.
START = (
    *(-0.0617138900142764496358948458001, 0.0, 0.455279819163070380255912382449),
    *(0.222668390165885884674473185609, 0.487364979543842550225598953530),
    *(-0.222668390165885884674473185609, 1.23054744454982119249735015568, *[0.0] * 7),
)
#: Published angles at 0.03 s, by PSIDE in double precision with the tolerance 1e-14.
END = (
    *(15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948),
    *(0.5244099658805304, 0.5347301163226948, 1.048080741042263),
)


@pytest.fixture(scope="module")
def module(large_module: Callable[[str], ModuleType]) -> ModuleType:
    return large_module("andrews_squeezer")


def test_the_mass_matrix_is_the_published_one(module: ModuleType) -> None:
    m2, m4, m6, e, f = 0.00365, 0.00706, 0.00706, 0.02 - 0.01421, 0.02 - 0.01421
    i2, i4, i6, rr, da, zt, u = 4.41e-7, 5.667e-7, 5.667e-7, 0.007, 0.0115, 0.04, 0.04
    for angles in np.random.default_rng(1).uniform(-3, 3, (3, 7)):
        _, theta, _, phi, _, omega, _ = angles
        expected = np.zeros((7, 7))
        expected[0, 0] = 0.04325 * 0.00092**2 + 2.194e-6 + i2
        expected[0, 0] += m2 * (rr**2 - 2 * da * rr * np.cos(theta) + da**2)
        expected[0, 1] = m2 * (da**2 - da * rr * np.cos(theta)) + i2
        expected[1, 1] = m2 * da**2 + i2
        expected[2, 2] = 0.02373 * (0.01874**2 + 0.01043**2) + 5.255e-6
        expected[3, 3] = m4 * e**2 + i4
        expected[3, 4] = m4 * (e**2 + zt * e * np.sin(phi)) + i4
        expected[4, 4] = m4 * (zt**2 + 2 * zt * e * np.sin(phi) + e**2) + i4
        expected[4, 4] += 0.0705 * (0.02308**2 + 0.00916**2) + 1.169e-5
        expected[5, 5] = m6 * f**2 + i6
        expected[5, 6] = m6 * (f**2 - u * f * np.sin(omega)) + i6
        expected[6, 6] = m6 * (f**2 - 2 * u * f * np.sin(omega) + u**2) + i6
        expected[6, 6] += 0.05498 * (0.01228**2 + 0.00449**2) + 1.912e-5
        upper = np.triu(module.mass_matrix(0.0, [*angles, *[0.0] * 7], module.DEFAULTS))
        np.testing.assert_allclose(upper, expected, rtol=1e-13, atol=1e-20)


def test_accelerations_and_multipliers_have_all_published_digits(module: ModuleType) -> None:
    rates = np.array(module.rhs(0.0, START, module.DEFAULTS))[7:]
    expected = [14222.4439199541138705911625887, -10666.8329399655854029433719415, 0, 0, 0, 0, 0]
    np.testing.assert_allclose(rates, expected, rtol=1e-13, atol=1e-10)
    # the source has the opposite sign, and points in another order
    forces = module.multipliers(0.0, START, module.DEFAULTS)
    expected = [-98.5668703962410896057654982170, 6.12268834425566265503114393122, 0, 0, 0, 0]
    np.testing.assert_allclose(forces, expected, rtol=1e-13, atol=1e-12)


@pytest.mark.long("a decimal series of a large mechanism")
def test_the_motion_is_that_of_taylor_series_and_keeps_the_constraints(module: ModuleType) -> None:
    exact = taylor(module, module.DEFAULTS, START, [0.0, 0.03], 20)[-1]
    # the published angles are those of the series 1.0e-12 s later
    np.testing.assert_allclose(exact[:7] + 1.0049e-12 * exact[7:], END, rtol=0, atol=2e-12)
    for method in ("verner853", "gauss8"):
        motion = integrate(
            module, (0, 0.03), START, module.DEFAULTS, method=method, rtol=1e-13, atol=1e-13
        )
        np.testing.assert_allclose(motion.y[:7, -1], exact[:7], rtol=0, atol=2e-12)
        residuals = module.constraints_many(motion.t, motion.y, module.DEFAULTS)
        assert np.abs(residuals[:6]).max() < 1e-15  # of 0.1 m
        assert np.abs(residuals[6:]).max() < 1e-12  # of 10 m/s
