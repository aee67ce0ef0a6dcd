"""The equations of a periodic orbit by shooting, and their derivatives."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from solvers.equations.assembly import Assembly
from solvers.equations.module import GeneratedModule, function, has_constraints
from solvers.equations.number_checks import positive
from solvers.integration.orbits.symmetry import Nature, Reversal, angles, states_near
from solvers.integration.variations.transition_matrix import Tangents
from solvers.runge_kutta.stepper import Array

#: Relative step of differences of the energy and of the period, of which a few digits suffice.
STEP = 1e-5
#: Largest relative change of the equations after a period.
SMALL = 1e-6
TINY = float(np.finfo(float).tiny)
#: Most steps of a motion: iterations near singular coordinates would take minutes.
MOST_STEPS = 10_000
PeriodOf = Callable[[Mapping[str, float]], float]


@dataclass(frozen=True)
class OrbitStart:
    """The start of a motion, its duration in s, and all parameters."""

    y: Array
    period: float
    params: Array


@dataclass(frozen=True)
class Shot:
    """The conditions of a periodic orbit at a point, and their derivatives.

    Columns of derivatives are those by the start, the period, and the parameter that varies.

    Attributes
    ----------
    residual : ndarray of shape (state,)
        0 for a periodic orbit.
    rows : ndarray of shape (state, state + 2)
        Derivatives of `residual`.
    change : ndarray of shape (state, state + 2)
        Derivatives of the change of the state in a period; they are `rows`, unless half a period
        suffices.
    advance : ndarray of shape (state,)
        Whole turns of angles in a period, in rad.
    """

    residual: Array
    rows: Array
    change: Array
    advance: Array

    @property
    def monodromy(self) -> Array:
        """The transition matrix over a period."""
        n = len(self.residual)
        return np.asarray(self.change[:, :n] + np.eye(n))


@dataclass(frozen=True)
class OrbitConditions:
    """The conditions of periodic orbits of a system.

    Attributes
    ----------
    nature : Nature
        Of the equations, for all values of the parameter that varies.
    reversal : Reversal, optional
        The symmetry of orbits that are integrated over half a period.
    parameter : int, optional
        Index of the parameter that varies.
    period_of : callable, optional
        The period as a function of all parameters by name, if the system depends on time and the
        period on the parameter.
    advance : ndarray of shape (state,), optional
        Whole turns of angles in a period, in rad; by default those of each motion.
    energy_held : float, optional
        The energy in J of the orbit.
    integrals_held : ndarray, optional
        Values of the functions that constraints of velocities keep.
    """

    module: GeneratedModule
    nature: Nature
    rtol: float
    atol: float
    reversal: Reversal | None = None
    parameter: int | None = None
    period_of: PeriodOf | None = None
    advance: Array | None = None
    energy_held: float | None = None
    integrals_held: Array | None = None

    def unknowns(self, point: OrbitStart) -> Array:
        """Which columns are unknown."""
        varies = self.parameter is not None
        keeps_period = varies and self.nature.is_conservative
        has_free_period = self.nature.is_autonomous and not keeps_period
        return np.array([True] * len(point.y) + [has_free_period, varies])

    def moved(self, point: OrbitStart, change: Array) -> OrbitStart:
        """The point after a change of all columns."""
        n, params = len(point.y), point.params.copy()
        if self.parameter is not None:
            params[self.parameter] += change[n + 1]
        y, period = point.y + change[:n], self._period(params, point.period + change[n])
        if self.reversal is not None:  # without rounding errors
            y[self.reversal.changed] = self.reversal.nearest(point.y)
        if has_constraints(self.module):
            assembly = Assembly(self.module, params[np.newaxis])
            (y,), result = assembly.assembled(y[np.newaxis], np.zeros(n, bool))
            if not result.all():
                raise ArithmeticError(f"no state that satisfies the constraints is near {y}")
        return OrbitStart(y, period, params)

    def _period(self, params: Array, period: float) -> float:
        if self.period_of is None:
            return float(period)
        by_name = dict(zip(self.module.PARAMETERS, params.tolist(), strict=True))
        return positive("period", self.period_of(by_name))

    def check_period(self, point: OrbitStart) -> None:
        """`ValueError` if equations that depend on time differ after the period."""
        for t, y in states_near(point.y):
            begin, end = (self.rate(point, time, y) for time in (t, t + point.period))
            if np.abs(end - begin).max() > SMALL * np.abs(begin).max():
                raise ValueError(
                    f"period = {point.period} s is not one of {self.module.SYSTEM}: its equations "
                    "differ after it"
                )

    def rate(self, point: OrbitStart, t: float = 0.0, y: Array | None = None) -> Array:
        """The rate of change of a state, by default the start."""
        state = point.y if y is None else y
        return np.array(self.module.rhs(t, state.tolist(), point.params.tolist()))

    def __call__(self, point: OrbitStart) -> Shot:
        """Integrate from a point, and state the conditions."""
        share = 1.0 if self.reversal is None else 0.5
        duration = share * point.period
        end, by_start, by_parameter = self._motion(point, duration)
        rate, n, reversal = self.rate(point, duration, end), len(end), self.reversal
        by_parameter += share * rate * self._period_derivative(point)
        by_end = np.column_stack([by_start, share * rate, by_parameter])
        identity = np.eye(n, n + 2)
        if reversal is None:
            difference = end - point.y
            whole = angles(self.module) * 2 * np.pi * np.round(difference / (2 * np.pi))
            advance = whole if self.advance is None else self.advance
            return Shot(difference - advance, by_end - identity, by_end - identity, advance)
        changed = reversal.changed
        start, whole = reversal.nearest(point.y), np.zeros(n)
        whole[changed] = 2 * (reversal.nearest(end) - start)
        advance = whole if self.advance is None else self.advance
        residual = [end[changed] - start - advance[changed] / 2, point.y[changed] - start]
        rows = np.concatenate([by_end[changed], identity[changed]])
        monodromy = reversal.monodromy(by_start)
        by_parameter = reversal.by_parameter(by_start, by_parameter)
        change = np.column_stack([monodromy, self.rate(point), by_parameter]) - identity
        return Shot(np.concatenate(residual), rows, change, advance)

    def _motion(self, point: OrbitStart, duration: float) -> tuple[Array, Array, Array]:
        """The end of a motion, and its derivatives by the start and by the parameter."""
        n, perturbed = len(point.y), None
        if self.parameter is not None:
            perturbed = np.zeros((len(point.params), n + 1))
            perturbed[self.parameter, n] = 1.0
        changes = np.eye(n, n if perturbed is None else n + 1)
        motion = Tangents(
            self.module,
            (0.0, duration),
            point.y,
            point.params,
            changes,
            rtol=self.rtol,
            atol=self.atol,
            parameter_changes=perturbed,
            max_steps=MOST_STEPS,
        )
        motion.advance(duration)
        by_parameter = np.zeros(n) if perturbed is None else motion.changes[:, n]
        return motion.y, motion.changes[:, :n], by_parameter

    def _period_derivative(self, point: OrbitStart) -> float:
        """The derivative of a given period by the parameter that varies."""
        if self.parameter is None or self.period_of is None:
            return 0.0
        change = np.zeros(len(point.params))
        change[self.parameter] = STEP * max(1.0, abs(point.params[self.parameter]))
        ahead, behind = (self._period(point.params + s * change, 0.0) for s in (1, -1))
        return (ahead - behind) / (2 * change[self.parameter])

    def energy(self, point: OrbitStart) -> float:
        """The energy in J at the start."""
        return float(function(self.module, "energy")(0.0, point.y.tolist(), point.params.tolist()))

    def energy_gradient(self, point: OrbitStart) -> Array:
        """Derivatives of the energy by the start."""
        return self._gradient(point, "energy_many")

    def _gradient(self, point: OrbitStart, name: str) -> Array:
        """Derivatives of a function of the module by the start, in the last axis."""
        steps = STEP * np.maximum(np.abs(point.y), 1.0)
        shifts, values = np.diag(steps), function(self.module, name)
        states = [(point.y + sign * shifts).T for sign in (1, -1)]
        ahead, behind = (np.asarray(values(0.0, state, point.params)) for state in states)
        return np.asarray((ahead - behind) / (2 * steps))

    def held(self, point: OrbitStart) -> tuple[Array, Array]:
        """Distances of the start from the values of functions that are held, and derivatives."""
        n = len(point.y)
        values, gradients = np.empty(0), np.empty((0, n))
        if self.energy_held is not None:
            values = np.array([self.energy(point) - self.energy_held])
            gradients = self.energy_gradient(point)[np.newaxis]
        if self.integrals_held is not None:
            now = function(self.module, "integrals")(0.0, point.y.tolist(), point.params.tolist())
            values = np.concatenate([values, np.array(now) - self.integrals_held])
            gradients = np.concatenate([gradients, self._gradient(point, "integrals_many")])
        sizes = np.maximum(np.linalg.norm(gradients, axis=1), TINY)
        rows = np.column_stack([gradients / sizes[:, np.newaxis], np.zeros((len(values), 2))])
        return values / sizes, rows

    def unfolding(self, point: OrbitStart) -> Array:
        """A unit vector along the gradient of the energy.

        The equations of an orbit of a family are consistent in the limit only: a part along the
        gradient stays free, and vanishes (F. J. Muñoz-Almaraz et al., Physica D 181 (2003) 1-38).
        """
        gradient = self.energy_gradient(point)
        return np.asarray(gradient / max(float(np.linalg.norm(gradient)), TINY))
