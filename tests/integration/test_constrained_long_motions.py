"""Constraints and energy after a million steps of the compiled loop."""

from collections.abc import Callable

import numpy as np
import pytest
from constrained_systems import swing
from linkages import four_bar

from derive import System
from holonomic import build, integrate
from solvers.equations.consistent_start import consistent_start

STEPS, H = 1_000_000, 0.01
#: Of each system: what is given at the start, what is guessed, and the largest change of energy, J.
#: No angle turns round: one that does has rounding errors that grow with its value.
MOTIONS: list[tuple[Callable[[], System], dict, dict, float]] = [
    (swing, {"x": 0.48, "x_dot": 1.0}, {"y": -0.64}, 4e-12),
    (four_bar, {"phi": -1.0, "phi_dot": 1.0}, {"theta": -0.5, "psi": -1.0}, 1e-12),
]


@pytest.mark.long("other tests reach its code")
@pytest.mark.usefixtures("fused")  # the motion takes longer than the compiler
@pytest.mark.parametrize(("make", "start", "guess", "change"), MOTIONS)
def test_a_million_steps_leave_no_residual(
    make: Callable[[], System], start: dict, guess: dict, change: float
) -> None:
    module = build(make())
    y0 = consistent_start(module, start, {}, guess=guess).y
    motion = integrate(module, (0, STEPS * H), y0, module.DEFAULTS, method="gauss4", h=H,
        backend="compiled", t_eval=np.linspace(0, STEPS * H, 101))  # fmt: skip
    assert motion.steps == STEPS
    residuals = np.abs(module.constraints_many(motion.t, motion.y, module.DEFAULTS))
    positions, rates = np.split(residuals, 2)
    energy = module.energy_many(motion.t, motion.y, module.DEFAULTS)
    assert positions.max() < 1e-15  # of lengths of 0.25 m to 0.8 m
    assert rates.max() < 4e-15
    assert np.abs(energy - energy[0]).max() < change
