"""Small motion about rest: normal modes in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solvers.equations.module import function
from solvers.equations.normal_modes import Modes
from solvers.scenes.models.model import EPS, ROUNDINGS, Array, Motion, OutsideDomainError, scattered

#: The defect is looked at at so many times, scattered evenly over the duration.
SAMPLES = 256
#: What the mean of so many samples may miss.
MARGIN = 1.25
#: Exponents beyond this are infinite for all purposes.
MOST = 300.0


@dataclass(frozen=True)
class Small:
    """Each mode oscillates by itself: x = Σ s (a cos ωt + b sin ωt)."""

    rest: Array
    modes: Modes
    cosines: Array
    sines: Array
    error_estimate: float
    why: str
    name: str = "normal modes"

    def states(self, t: Array) -> Array:
        """Rest and the sum of all modes."""
        omega = self.modes.frequencies
        phase = np.multiply.outer(t, omega)
        cosine, sine = np.cos(phase), np.sin(phase)
        place = (cosine * self.cosines + sine * self.sines) @ self.modes.shapes.T
        speed = (cosine * self.sines - sine * self.cosines) * omega @ self.modes.shapes.T
        return np.hstack([self.rest + place, speed])


def small(asked: Motion) -> Small:
    """Normal modes, with the error that the nonlinear terms bring about.

    In the norm ‖(x, ẋ)‖² = ẋᵀM₀ẋ + xᵀKx small motions keep their size, so that the error
    is at most ∫‖d‖ dt · exp ∫‖B‖ dt (Gronwall), with the defect d, the acceleration of the
    full equations along the modes minus their own, and B the difference of their Jacobians.
    Both means over time are taken from samples.

    Parameters
    ----------
    asked : Motion
        The motion.

    Returns
    -------
    Small

    Raises
    ------
    OutsideDomainError
        When the module has no stable equilibrium, or a coordinate moves no mass.
    """
    asked.require_mass()
    try:
        modes = Modes.at_rest(asked.module, asked.params)
    except ValueError as reason:
        raise OutsideDomainError(str(reason)) from reason
    n = asked.coordinates
    rest = np.array(function(asked.module, "equilibrium")(asked.params))
    place, speed = np.split(np.array(asked.y0), 2)
    to_modes = modes.shapes.T @ modes.mass_matrix
    omega = modes.frequencies
    motion = Small(rest, modes, to_modes @ (place - rest), to_modes @ speed / omega, 0.0, "")
    t = asked.duration * scattered(SAMPLES)
    states = motion.states(t)
    full, jacobians = (
        np.asarray(of_state(0.0, states.T, asked.params))
        for of_state in (asked.module.rhs_many, asked.module.jacobian_many)
    )
    shifted = states - np.concatenate([rest, np.zeros(n)])
    defect = (full.T - shifted @ modes.matrix.T)[:, n:] @ to_modes.T  # in parts of the modes
    difference = np.moveaxis(jacobians, -1, 0) - modes.matrix
    # (ω x, ẋ) in parts of the modes, and back
    into = np.block([[omega[:, None] * to_modes, np.zeros((n, n))], [np.zeros((n, n)), to_modes]])
    back = np.linalg.inv(into)
    growth = np.linalg.norm(into @ difference @ back, 2, axis=(1, 2)).mean() * asked.duration
    pushed = np.linalg.norm(defect, axis=1).mean() * asked.duration
    size = np.hypot(motion.cosines * omega, motion.sines * omega)
    # frequencies are known to rounding times the spread of the modes
    phase = EPS * (ROUNDINGS + omega * asked.duration * (1 + (omega[-1] / omega) ** 2))
    error = MARGIN * np.exp(min(growth, MOST)) * pushed + np.linalg.norm(size * phase)
    worst = np.linalg.norm(back, axis=1) * error + ROUNDINGS * EPS * np.abs(states).max(axis=0)
    return Small(
        rest, modes, motion.cosines, motion.sines, float(worst[list(asked.wanted)].max()),
        f"nonlinear terms push by at most {pushed / asked.duration:.1g} of unit mass",
    )  # fmt: skip
