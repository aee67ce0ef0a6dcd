"""Small motion about an equilibrium: normal modes in closed form."""

from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from solvers.equations.module import GeneratedModule, function, has_function
from solvers.equations.normal_modes import Modes
from solvers.scenes.models.model import EPS, ROUNDINGS, ClosedForm
from solvers.scenes.models.motion import Array, Motion, OutsideDomainError, golden_points

#: Number of times at which the defect is evaluated.
SAMPLES = 256
#: Safety factor for a mean over these samples.
MARGIN = 1.25
#: Exponents above this are treated as infinite.
LARGEST_EXPONENT = 300.0


@dataclass(frozen=True)
class NormalModes(ClosedForm):
    """Each mode oscillates by itself: x = Σ s (a cos ωt + b sin ωt).

    In the norm ‖(x, ẋ)‖² = ẋᵀM₀ẋ + xᵀKx small motions keep their size, so that the error is at most
    ∫‖d‖ dt · exp ∫‖B‖ dt (Gronwall), with the defect d, the acceleration of the full equations
    along the modes minus their own, and B the difference of their Jacobians. Both means over time
    are taken from samples.
    """

    name: ClassVar[str] = "normal modes"
    complexity: ClassVar[int] = 20
    applies_to: ClassVar[str] = "small motion about a stable equilibrium"
    error_source: ClassVar[str] = "nonlinear terms, bounded by Gronwall's inequality"

    equilibrium: Array
    modes: Modes
    cosines: Array
    sines: Array

    @classmethod
    def not_applicable(cls, module: GeneratedModule) -> str:
        if reason := super().not_applicable(module):
            return reason
        if not has_function(module, "equilibrium"):
            return "no equilibrium is known"
        return "" if has_function(module, "linear") else "gyroscopic forces act on small motions"

    @classmethod
    def of(cls, motion: Motion) -> Self:
        """The normal modes, with the error caused by the nonlinear terms."""
        motion.require_inertia()
        try:
            modes = Modes.at_rest(motion.module, motion.params)
        except ValueError as error:
            raise OutsideDomainError(str(error)) from error
        equilibrium = np.array(function(motion.module, "equilibrium")(motion.params))
        q, qdot = np.split(np.array(motion.y0), 2)
        to_modes = modes.shapes.T @ modes.mass_matrix
        cosines, sines = to_modes @ (q - equilibrium), to_modes @ qdot / modes.frequencies
        model = cls(equilibrium, modes, cosines, sines, error_estimate=0.0, why="")
        errors, push = model._error(motion, to_modes)
        estimate = float(errors[list(motion.requested)].max())
        why = f"nonlinear terms accelerate unit mass by at most {push / motion.duration:.1g}"
        return replace(model, error_estimate=estimate, why=why)

    def states(self, t: Array) -> Array:
        omega = self.modes.frequencies
        phase = np.multiply.outer(t, omega)
        cosine, sine = np.cos(phase), np.sin(phase)
        x = (cosine * self.cosines + sine * self.sines) @ self.modes.shapes.T
        x_dot = (cosine * self.sines - sine * self.cosines) * omega @ self.modes.shapes.T
        return np.hstack([self.equilibrium + x, x_dot])

    def _error(self, motion: Motion, to_modes: Array) -> tuple[Array, float]:
        """The error of each component of the state, and the integral of the defect."""
        n, omega, matrix = motion.n_coordinates, self.modes.frequencies, self.modes.matrix
        states = self.states(motion.duration * golden_points(SAMPLES))
        rates = np.asarray(motion.module.rhs_many(0.0, states.T, motion.params))
        jacobians = np.asarray(motion.module.jacobian_many(0.0, states.T, motion.params))
        displacements = states - np.concatenate([self.equilibrium, np.zeros(n)])
        defect = (rates.T - displacements @ matrix.T)[:, n:] @ to_modes.T  # in modal coordinates
        difference = np.moveaxis(jacobians, -1, 0) - matrix
        # the state (ω x, ẋ) in modal coordinates, and back
        zeros = np.zeros((n, n))
        into = np.block([[omega[:, None] * to_modes, zeros], [zeros, to_modes]])
        back = np.linalg.inv(into)
        growth = np.linalg.norm(into @ difference @ back, 2, axis=(1, 2)).mean() * motion.duration
        push = np.linalg.norm(defect, axis=1).mean() * motion.duration
        size = np.hypot(self.cosines * omega, self.sines * omega)
        # frequencies are known to rounding times the spread of the modes
        phase = EPS * (ROUNDINGS + omega * motion.duration * (1 + (omega[-1] / omega) ** 2))
        error = MARGIN * np.exp(min(growth, LARGEST_EXPONENT)) * push
        error = error + np.linalg.norm(size * phase)
        rounding = ROUNDINGS * EPS * np.abs(states).max(axis=0)
        return np.linalg.norm(back, axis=1) * error + rounding, float(push)
