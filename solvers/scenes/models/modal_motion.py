"""Small motion about an equilibrium: normal modes in closed form."""

from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from solvers.equations.linearisation.normal_modes import Modes
from solvers.equations.module import GeneratedModule, function, has_function
from solvers.integration.accuracy.checked_motion import (
    Array,
    Motion,
    OutsideDomainError,
    golden_points,
)
from solvers.scenes.models.model_catalogue import EPS, ROUNDINGS, ClosedForm

#: Fewest times at which the defect is evaluated, their number in a period of the fastest mode, and
#: the most with which errors are propagated.
SAMPLES, PER_PERIOD, MOST = 256, 48, 2**17
#: Most corrections of the modes, and part of the error that their own error may be.
CORRECTIONS, REST = 8, 0.1
#: Safety factor for a mean over these samples.
MARGIN = 1.25
#: Exponents above this are treated as infinite.
LARGEST_EXPONENT = 300.0


@dataclass(frozen=True)
class NormalModes(ClosedForm):
    """Each mode oscillates by itself: x = Σ s (a cos ωt + b sin ωt).

    The error is estimated as the correction of the modes by their defect d, the acceleration of the
    full equations along them minus their own. The corrected motion has another defect, from which
    follows another correction (E. Picard's iteration). In the norm ‖(x, ẋ)‖² = ẋᵀM₀ẋ + xᵀKx small
    motions keep their size, so that the error of the last one is at most ∫‖d‖ dt · exp ∫‖B‖ dt
    (Gronwall), with B the difference of the Jacobians. Both means over time are taken from samples.
    """

    name: ClassVar[str] = "normal modes"
    complexity: ClassVar[int] = 20
    applies_to: ClassVar[str] = "small motion about a stable equilibrium"
    error_source: ClassVar[str] = (
        "nonlinear terms along the motion, their own effect bounded by Gronwall's inequality"
    )

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
        n, omega, duration = motion.n_coordinates, self.modes.frequencies, motion.duration
        # the state (ω x, ẋ) in modal coordinates, and back
        zeros = np.zeros((n, n))
        into = np.block([[omega[:, None] * to_modes, zeros], [zeros, to_modes]])
        back = np.linalg.inv(into)
        states = self.states(duration * golden_points(SAMPLES))
        jacobians = np.asarray(motion.module.jacobian_many(0.0, states.T, motion.params))
        difference = np.moveaxis(jacobians, -1, 0) - self.modes.matrix
        growth = np.linalg.norm(into @ difference @ back, 2, axis=(1, 2)).mean() * duration
        per_push = MARGIN * np.exp(min(growth, LARGEST_EXPONENT)) * np.linalg.norm(back, axis=1)

        def integral(defect: Array) -> float:
            return float(np.linalg.norm(defect, axis=1).mean()) * duration

        count = SAMPLES + int(PER_PERIOD * omega[-1] * duration / (2 * np.pi))
        is_short = count <= MOST
        states = self.states(duration * np.linspace(0, 1, count)) if is_short else states
        defect = self._defect(motion, states, to_modes)
        push = integral(defect)
        error = per_push * push
        for _ in range(CORRECTIONS if is_short else 0):
            correction = self._correction(defect, duration)
            before, defect = defect, self._defect(motion, states + correction, to_modes)
            largest = MARGIN * np.abs(correction).max(axis=0)
            rest = per_push * integral(defect - before)
            error = np.minimum(error, largest + rest)
            if not (rest > REST * largest).any():
                break
        # frequencies are known to rounding times the spread of the modes
        phase = EPS * (ROUNDINGS + omega * duration * (1 + (omega[-1] / omega) ** 2))
        size = np.hypot(self.cosines * omega, self.sines * omega)
        rounding = np.linalg.norm(back, axis=1) * np.linalg.norm(size * phase)
        return error + rounding + ROUNDINGS * EPS * np.abs(states).max(axis=0), push

    def _defect(self, motion: Motion, states: Array, to_modes: Array) -> Array:
        """Accelerations of the full equations minus those of the modes, in modal coordinates."""
        n = motion.n_coordinates
        rates = np.asarray(motion.module.rhs_many(0.0, states.T, motion.params)).T
        displacements = states - np.concatenate([self.equilibrium, np.zeros(n)])
        return np.asarray((rates - displacements @ self.modes.matrix.T)[:, n:] @ to_modes.T)

    def _correction(self, defect: Array, duration: float) -> Array:
        """The motion that a defect at evenly spaced times adds, shape (n, state).

        z = ẋ + iωx of each mode obeys z' = iωz + d: z exp(-iωt) is an integral, by the trapezoid
        rule.
        """
        omega, shapes = self.modes.frequencies, self.modes.shapes.T
        h = duration / (len(defect) - 1)
        turn = np.exp(1j * h * np.multiply.outer(np.arange(len(defect)), omega))
        parts = defect / turn
        z = h * turn * (np.cumsum(parts, axis=0) - (parts + parts[0]) / 2)
        return np.hstack([z.imag / omega @ shapes, z.real @ shapes])
