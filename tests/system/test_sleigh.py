"""Chaplygin's sleigh: its closed form, which no equation of this project enters."""

import numpy as np
import pytest

import generated.chaplygin_sleigh as sleigh
from holonomic import integrate

MASS, INERTIA, ARM = sleigh.DEFAULTS
#: v' = a ω² and (J + m a²) ω' = -m a v ω (Bloch, Nonholonomic Mechanics and Control, 1.7)
RATIO = np.sqrt(MASS / (INERTIA + MASS * ARM**2))


def closed_form(t: np.ndarray, v: float, omega: float) -> tuple[np.ndarray, ...]:
    """v = V tanh τ and ω = k V / cosh τ with τ = a k² V (t - t0), and the angle turned."""
    speed = np.hypot(v, omega / RATIO)
    rate = ARM * RATIO**2 * speed
    start = np.arctanh(v / speed)
    tau = rate * t + start
    turned = (
        2 * RATIO * speed / rate * (np.arctan(np.tanh(tau / 2)) - np.arctan(np.tanh(start / 2)))
    )
    return speed * np.tanh(tau), RATIO * speed / np.cosh(tau), turned


@pytest.mark.parametrize("backend", ["python", "compiled"])
def test_a_motion_is_that_of_the_closed_form(backend: str) -> None:
    times, (v, omega, heading) = np.linspace(0, 5, 21), (-0.5, 2.0, 0.3)
    start = (0.0, 0.0, heading, v * np.cos(heading), v * np.sin(heading), omega)
    motion = integrate(sleigh, (0, 5), start, sleigh.DEFAULTS, rtol=1e-12, atol=1e-12,
        t_eval=times, backend=backend, energy=True)  # fmt: skip
    _, _, theta, x_dot, y_dot, theta_dot = motion.y
    speed, rate, turned = closed_form(times, v, omega)
    assert np.abs(x_dot * np.cos(theta) + y_dot * np.sin(theta) - speed).max() < 1e-11
    assert np.abs(theta_dot - rate).max() < 1e-11
    assert np.abs(theta - heading - turned).max() < 1e-11
    assert np.ptp(motion.energy) < 1e-11
    residuals = sleigh.constraints_many(times, motion.y, sleigh.DEFAULTS)
    assert np.abs(residuals).max() < 1e-15
    # the momentum is m (v, a ω) along and across the skate, which turns with ω
    force = sleigh.multipliers_many(times, motion.y, sleigh.DEFAULTS)[0]
    across = MASS * INERTIA / (INERTIA + MASS * ARM**2) * speed * rate
    assert np.abs(force - across).max() < 1e-11


def test_the_sleigh_ends_with_the_mass_ahead() -> None:
    # a motion that attracts others, which no Hamiltonian system has
    start = (0.0, 0.0, 0.0, -1.0, 0.0, 1e-3)
    end = integrate(sleigh, (0, 20), start, sleigh.DEFAULTS, rtol=1e-11, atol=1e-11).y[:, -1]
    forwards = end[3] * np.cos(end[2]) + end[4] * np.sin(end[2])
    assert forwards == pytest.approx(1.0, abs=1e-5)
    assert abs(end[5]) < 1e-3
