"""Systems reduce to simpler ones where they should, and have the frequencies that are published."""

from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from numpy.testing import assert_allclose

import generated.coupled_pendulums as cp
import generated.double_bar_pendulum as bars
import generated.double_pendulum as dp
import generated.driven_pendulum as driven
import generated.elastic_pendulum as ep
import generated.foucault_pendulum as foucault
import generated.henon_heiles as hh
import generated.rotating_hoop as hoop
import generated.single_pendulum as sp
import generated.spherical_pendulum as spherical
import generated.swinging_atwood as atwood
from derive import Derivation, load
from derive.codegen.module_files import texts
from solvers.integration.integrate import integrate

G = 9.81


def made(name: str) -> dict[str, object]:
    """A module that does not ship."""
    namespace: dict[str, object] = {"__name__": name}
    exec(compile(texts(Derivation(load(name)))[f"{name}.py"], name, "exec"), namespace)
    return namespace


def test_a_chain_of_two_is_the_double_pendulum() -> None:
    y, (m1, m2, l1, l2, g) = (0.3, -1.2, 0.7, 1.9), (1.3, 0.7, 1.1, 0.9, G)
    found = made("chain_2")["rhs"](0.0, y, (m1, m2, l1, l2, g))  # type: ignore[operator]
    assert_allclose(found, dp.rhs(0.0, y, (m1, m2, l1, l2, g)), rtol=1e-13)


def test_a_cart_too_heavy_to_move_carries_a_chain() -> None:
    cart = made("cart_2")["rhs"]
    y, (m1, m2, l1, l2, g) = (0.3, -1.2, 0.7, 1.9), (1.3, 0.7, 1.1, 0.9, G)
    state, params = (0.5, *y[:2], 0.0, *y[2:]), (1e12, m1, m2, l1, l2, g)
    rates = cart(0.0, state, params)  # type: ignore[operator]
    assert_allclose([*rates[1:3], *rates[4:]], dp.rhs(0.0, y, (m1, m2, l1, l2, g)), rtol=1e-9)
    free = cart(0.0, state, (1.0, *params[1:]))  # type: ignore[operator]
    assert np.abs(np.array(free) - rates).max() > 0.1


def test_a_spherical_pendulum_in_a_plane_is_the_single_one() -> None:
    theta, rate, params = 0.8, 1.3, (1.2, 0.7, G)
    flat = spherical.rhs(0.0, (theta, 0.4, rate, 0.0), params)
    assert (flat[0], flat[2]) == pytest.approx(sp.rhs(0.0, (theta, rate), params), rel=1e-14)
    assert (flat[1], flat[3]) == (0.0, 0.0)


def test_a_stiff_spring_becomes_a_rod() -> None:
    start, length = (0.9, 0.0), 1.5
    rod = integrate(sp, (0, 3), start, (1.0, length, G), rtol=1e-11, t_eval=[3.0]).y[:, -1]
    apart = []
    for k in (1e4, 1e5, 1e6):
        spring = integrate(
            ep,
            (0, 3),
            (length + G * cos(0.9) / k, 0.9, 0, 0),
            (1.0, k, length, G),
            rtol=1e-10,
            t_eval=[3.0],
        ).y[:, -1]
        apart.append(abs(spring[1] - rod[0]))
    assert apart[0] > 5 * apart[1] > 25 * apart[2]


def test_a_hoop_at_rest_is_the_single_pendulum_and_a_quick_one_lifts_the_bead() -> None:
    y, (m, R) = (0.8, 1.3), (1.2, 0.7)
    still = hoop.rhs(0.0, y, (m, R, 0.0, G))
    assert still == pytest.approx(sp.rhs(0.0, y, (m, R, G)), rel=1e-14)
    # J. R. Taylor, Classical Mechanics, example 7.6: cos θ₀ = g/(ω²R), frequency ω sin θ₀
    omega = 6.0
    place = np.arccos(G / (omega**2 * R))
    rates = hoop.rhs(0.0, (place, 0.0), (m, R, omega, G))
    assert abs(rates[1]) < 1e-12
    slope = hoop.jacobian(0.0, (place, 0.0), (m, R, omega, G))[1][0]
    assert sqrt(-slope) == pytest.approx(omega * sin(place), rel=1e-12)
    # below the critical rate the bottom is stable, above it is not: ω² = g/R
    for rate, sign in ((0.99, -1), (1.01, 1)):
        slope = hoop.jacobian(0.0, (0.0, 0.0), (m, R, rate * sqrt(G / R), G))[1][0]
        assert np.sign(slope) == sign


def frequencies(module: object, params: tuple[float, ...]) -> list[float]:
    M, K = np.array(module.linear(params))  # type: ignore[attr-defined]
    return sorted(np.sqrt(np.linalg.eigvals(np.linalg.solve(M, K)).real).tolist())


def test_small_motions_have_the_published_frequencies() -> None:
    m, length, k = 1.3, 0.8, 2.1
    single = sqrt(G / length)
    assert frequencies(sp, (m, length, G)) == pytest.approx([single])
    # A. P. French, Vibrations and Waves, chapter 5: together as without, apart with the spring
    both = frequencies(cp, (m, length, k, 1.0, G))
    assert both == pytest.approx([single, sqrt(G / length + 2 * k / m)])
    # equal bars: ω² = (3 ± 6/√7) g/l, the roots of 7x² - 42x + 27 = 0 with x = ω² l/g
    x = [w**2 * length / G for w in frequencies(bars, (m, m, length, length, G))]
    assert x == pytest.approx([3 - 6 / sqrt(7), 3 + 6 / sqrt(7)])
    assert frequencies(hh, ()) == pytest.approx([1, 1])
    spring = frequencies(ep, (m, k, length, G))
    assert sorted(spring) == pytest.approx(sorted([sqrt(k / m), sqrt(G / (length + m * G / k))]))


def test_the_shaken_pendulum_stands_upright_from_kapitza_s_amplitude_on() -> None:
    # L. D. Landau, E. M. Lifshitz, Mechanics, § 30: upright is stable if a²Ω² > 2 g l
    length, omega = 1.0, 400.0
    for factor, stands in ((1.15, True), (0.85, False)):
        a = factor * sqrt(2 * G * length) / omega
        params = (1.0, length, a, omega, 0.0, G)
        motion = integrate(driven, (0, 10), (pi - 0.01, 0.0), params, rtol=1e-9)
        assert (np.abs(motion.y[0] - pi).max() < 0.2) == stands


def test_foucault_s_pendulum_turns_with_the_sine_of_the_latitude() -> None:
    # L. D. Landau, E. M. Lifshitz, Mechanics, § 39, problem 3: the plane turns at -Ω sin φ
    m, length, turning, latitude = 28.0, 67.0, 2e-3, 0.8527
    params, end = (m, length, G, turning, latitude), 600.0
    times = np.linspace(0, end, 6001)
    motion = integrate(foucault, (0, end), (0.1, 0, 0, 0), params, rtol=1e-11, t_eval=times)
    far = [
        k
        for k in range(1, 6000)
        if abs(motion.y[0, k] + 1j * motion.y[1, k])
        >= max(abs(motion.y[0, k + d] + 1j * motion.y[1, k + d]) for d in (-1, 1))
    ]
    angles = np.unwrap(2 * np.arctan2(motion.y[1, far], motion.y[0, far])) / 2
    rate = np.polyfit(times[far], angles, 1)[0]
    assert rate == pytest.approx(-turning * sin(latitude), rel=2e-3)
    # on the equator it does not turn at all
    still = integrate(foucault, (0, end), (0.1, 0, 0, 0), (m, length, G, turning, 0.0), rtol=1e-11)
    assert np.abs(still.y[1]).max() < 1e-12


def test_swinging_atwood_is_integrable_where_the_masses_are_three_to_one() -> None:
    # N. B. Tufillaro, J. Physique 47 (1986) 1495: a second invariant for M = 3 m, otherwise none
    def drift(mu: float) -> float:
        m, start = 1.0, (1.0, 0.9, 0.0, 0.0)
        motion = integrate(atwood, (0, 8), start, (mu * m, m, G), rtol=1e-11)
        r, theta, r_dot, theta_dot = motion.y
        invariant = (
            r**2 * theta_dot * (r_dot * np.cos(theta / 2) - r * theta_dot / 2 * np.sin(theta / 2))
            + G * r**2 * np.sin(theta / 2) * np.cos(theta / 2) ** 2
        )
        return float(np.ptp(invariant))

    assert drift(3.0) < 1e-8
    assert drift(3.5) > 1e-2


def test_hénon_and_heiles_escape_above_a_sixth_only() -> None:
    # the saddle of the potential is at (0, 1) with the energy 1/6
    assert hh.energy(0.0, (0, 1, 0, 0), ()) == pytest.approx(1 / 6)
    assert np.abs(hh.rhs(0, (0, 1, 0, 0), ())).max() < 1e-15
    inside = integrate(hh, (0, 300), (0, 0, sqrt(2 * 0.16), 0), (), rtol=1e-9)
    assert np.abs(inside.y[:2]).max() < 1
