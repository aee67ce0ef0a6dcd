"""States that satisfy constraints, and their perturbations.

Positions are assembled by Gauss-Newton steps, then velocities. Components that are given remain as
they are, as far as the degrees of freedom permit. The others start from guesses (J. García de
Jalón, E. Bayo, Kinematic and Dynamic Simulation of Multibody Systems (1994), chapter 3). Motions
are rows, which are assembled independently of each other.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import hypot, inf
from operator import mul

import numpy as np
from numpy.typing import NDArray

from solvers.equations.forms import Form
from solvers.equations.module import GeneratedModule, function, position_constraints
from solvers.equations.projection import tangent_change

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

#: Residuals, relative to the size of the system, that are removed: rounded decimals.
ROUNDED = 1e-6
#: Those that are rounding errors, and those of a configuration that was assembled.
EXACT, CLOSED = 1e-14, 1e-10
#: Rates of change in 1/s; residuals of slower velocities are relative to it.
SLOW = 1e-3
#: Most Gauss-Newton steps, the largest change in one, and most halvings of a step.
STEPS, LARGEST, HALVINGS = 60, 0.5, 12
#: Other guesses where the first one leads to no configuration.
GUESSES = 24
#: States at which matrices are examined for elements that are always 0.
GENERIC = 3
#: Singular values, relative to the largest, that count as 0.
SINGULAR = 1e-10


@dataclass(frozen=True)
class Assembly:
    """Assembly of states in rows, with parameters in rows: one for all motions, or one for each."""

    module: GeneratedModule
    params: Array
    t: float = 0.0

    @cached_property
    def n(self) -> int:
        """Number of coordinates."""
        return len(self.module.COORDINATES)

    @cached_property
    def of_positions(self) -> list[int]:
        """Rows of the Jacobian of constraints of coordinates, in the order of their residuals."""
        names = self.module.RESIDUALS[: position_constraints(self.module)]
        return [self.names.index(name) for name in names]

    @cached_property
    def names(self) -> list[str]:
        """Names of the constraints, one for each row of G."""
        count = position_constraints(self.module)
        positions, rates = self.module.RESIDUALS[:count], self.module.RESIDUALS[count:]
        of_rate = {f"{name}_dot": name for name in positions}
        return [of_rate.get(name, name) for name in rates]

    @cached_property
    def scales(self) -> Array:
        """Sizes of the coordinates: 1 rad, or the largest parameter of the same unit."""
        units, sizes = self.module.UNITS, dict[str, float]()
        for name, values in zip(self.module.PARAMETERS, self.params.T, strict=True):
            size = float(np.abs(values).max(initial=0.0))
            sizes[units[name]] = max(sizes.get(units[name], 0.0), size)
        of = (units[name] for name in self.module.COORDINATES)
        return np.array([(unit != "rad" and sizes.get(unit)) or 1.0 for unit in of])

    def subset(self, rows: Flags) -> "Assembly":
        """The assembly of some of the motions."""
        return self if len(self.params) == 1 else replace(self, params=self.params[rows])

    def _many(self, name: str, y: Array) -> Array:
        with np.errstate(all="ignore"):
            values = function(self.module, f"{name}_many")(self.t, y.T, self.params.T)
        return np.moveaxis(np.asarray(values), -1, 0)

    def residuals(self, y: Array) -> Array:
        """Residuals of constraints, in the order of ``module.RESIDUALS``, one row a motion."""
        return self._many("constraints", y)

    def jacobian(self, y: Array) -> Array:
        """G, per scale of the coordinates, one matrix a motion."""
        matrices = self._many("constraints_jacobian", y)
        return matrices[:, len(self.of_positions) :, self.n :] * self.scales

    def relative(self, y: Array) -> Array:
        """Absolute residuals relative to their changes by the scales of coordinates and rates."""
        residuals = np.abs(self.residuals(y))
        sizes = np.linalg.norm(self.jacobian(y), axis=2)
        rates = np.abs(y[:, self.n :] / self.scales).max(axis=1, initial=0.0)
        moving = sizes * np.maximum(rates, SLOW)[:, np.newaxis]
        scales = np.hstack([sizes[:, self.of_positions], moving])
        ratios = residuals / np.where(scales > 0, scales, 1.0)
        return np.where(np.isfinite(ratios) & np.isfinite(scales), ratios, np.inf)

    def is_exact(self, y: Sequence[float]) -> bool:
        """Whether one state satisfies the constraints to rounding errors.

        By numbers, which takes a hundredth of the time of `relative`, of arrays.
        """
        names, (params, scales), n = ("constraints", "constraints_jacobian"), self._numbers, self.n
        try:
            residuals, rows = (function(self.module, name)(self.t, y, params) for name in names)
        except (ArithmeticError, ValueError):  # where a formula has no value
            return False
        rate = max(SLOW, *(abs(v) / scale for v, scale in zip(y[n:], scales, strict=True)))
        sizes = [hypot(*map(mul, row[n:], scales)) for row in rows[len(self.of_positions) :]]
        limits = [sizes[k] for k in self.of_positions] + [rate * size for size in sizes]
        pairs = zip(residuals, limits, strict=True)
        return all(abs(value) <= EXACT * (limit or 1.0) < inf for value, limit in pairs)

    @cached_property
    def _numbers(self) -> tuple[list[float], list[float]]:
        """Parameters of the first motion, and scales."""
        return self.params[0].tolist(), self.scales.tolist()

    def assembled(self, y: Array, given: Flags) -> tuple[Array, Flags]:
        """States near `y` of which the given components are kept, and whether they were found."""
        n, y = self.n, y.copy()
        y[:, :n], result = self._positions(y[:, :n], ~given[:n])
        if result.any():
            part = self.subset(result)
            y[result, n:], result[result] = part.velocities(y[result], ~given[n:])
        return y, result

    def _positions(self, q: Array, free: Flags) -> tuple[Array, Flags]:
        """Coordinates that satisfy the constraints, from the guess or others near it."""
        best, error = self.closed(q, free)
        rng = np.random.default_rng(0)
        for _ in range(GUESSES if free.any() else 0):
            # where the first guess is singular, as aligned rods are, the nearest solution counts
            rows = error > CLOSED
            if not rows.any():
                break
            change = self.scales * free * rng.uniform(-1.5, 1.5, self.n)
            trial, smaller = self.subset(rows).closed(q[rows] + change, free)
            better = smaller < error[rows]
            best[rows] = np.where(better[:, np.newaxis], trial, best[rows])
            error[rows] = np.minimum(smaller, error[rows])
        rounded = (error > CLOSED) & (error <= ROUNDED)
        if rounded.any():
            every = np.ones_like(free)
            best[rounded], error[rounded] = self.subset(rounded).closed(best[rounded], every)
        return best, error <= CLOSED

    def closed(self, q: Array, free: Flags) -> tuple[Array, Array]:
        """Coordinates after Gauss-Newton steps of the free ones, and relative residuals."""
        now, error = q.copy(), self._position_errors(q)
        active = (np.linalg.norm(error, axis=1) > 0) & free.any()
        for _ in range(STEPS):
            if not active.any():
                break
            part = self.subset(active)
            step = part._step(now[active], free)
            before, trial = np.linalg.norm(error[active], axis=1), now[active]
            accepted = np.zeros(len(step), bool)
            for _ in range(HALVINGS):
                open_rows = np.flatnonzero(~accepted)
                candidates = now[active][open_rows] + step[open_rows]
                errors = part.subset(~accepted)._position_errors(candidates)
                fine = np.linalg.norm(errors, axis=1) < before[open_rows]
                trial[open_rows[fine]] = candidates[fine]
                accepted[open_rows[fine]] = True
                step /= 2
                if accepted.all():
                    break
            now[active] = trial
            error[active] = part._position_errors(trial)
            active[active] = accepted
        return now, np.abs(error).max(axis=1, initial=0.0)

    def _at_rest(self, q: Array) -> Array:
        return np.hstack([q, np.zeros_like(q)])

    def _position_errors(self, q: Array) -> Array:
        return self.relative(self._at_rest(q))[:, : len(self.of_positions)]

    def _step(self, q: Array, free: Flags) -> Array:
        """The smallest changes that remove linearised residuals, of limited size."""
        y = self._at_rest(q)
        matrix = self.jacobian(y)[:, self.of_positions] * free
        residuals = self.residuals(y)[:, : len(self.of_positions), np.newaxis]
        usable = np.isfinite(matrix).all(axis=(1, 2)) & np.isfinite(residuals).all(axis=(1, 2))
        matrix[~usable], residuals[~usable] = 0.0, 0.0
        sizes = np.linalg.norm(matrix, axis=2, keepdims=True)
        sizes[sizes == 0] = 1.0
        step = -(np.linalg.pinv(matrix / sizes, rcond=SINGULAR) @ (residuals / sizes))[:, :, 0]
        largest = np.abs(step).max(axis=1, initial=0.0, keepdims=True)
        return np.asarray(step * LARGEST / np.maximum(largest, LARGEST) * self.scales * free)

    def velocities(self, y: Array, free: Flags) -> tuple[Array, Flags]:
        """Velocities that satisfy the constraints, and whether they exist.

        Free ones that a constraint contains are, by kinetic energy, as near as possible to those of
        `y`; the others are those of `y`.
        """
        states = y.copy()
        states[:, self.n :] += self._velocity_changes(states, free & self.in_constraints)
        error = self._velocity_errors(states)
        rounded = (error > CLOSED) & (error <= ROUNDED)
        if rounded.any():
            part, every = self.subset(rounded), np.ones_like(free)
            states[rounded, self.n :] += part._velocity_changes(states[rounded], every)
            error[rounded] = part._velocity_errors(states[rounded])
        return states[:, self.n :], error <= CLOSED

    @cached_property
    def in_constraints(self) -> Flags:
        """Coordinates whose velocities a constraint contains, by G at generic states."""
        rng = np.random.default_rng(0)
        states = rng.uniform(0.1, 1.0, (GENERIC, 2 * self.n)) * np.tile(self.scales, 2)
        first = replace(self, params=self.params[:1])
        return np.asarray((np.nan_to_num(first.jacobian(states), nan=1.0) != 0).any(axis=(0, 1)))

    def _velocity_errors(self, y: Array) -> Array:
        return self.relative(y)[:, len(self.of_positions) :].max(axis=1, initial=0.0)

    def _velocity_changes(self, y: Array, free: Flags) -> Array:
        """Changes of free velocities that remove the residuals of rates."""
        rates = self.residuals(y)[:, len(self.of_positions) :]
        return self.smallest_change(y, rates, free, [*range(len(self.names))])

    def smallest_change(self, y: Array, residuals: Array, free: Flags, rows: list[int]) -> Array:
        """The changes δ of free components that remove residuals: M δ = Gᵀ μ, G δ = -residuals.

        The constraints are those of these rows of G.
        """
        n, m = self.n, len(rows)
        jacobian = self.jacobian(y)[:, rows]
        sizes = np.linalg.norm(jacobian, axis=2, keepdims=True)
        sizes[sizes == 0] = 1.0
        G = jacobian / sizes
        M = self._many("mass_matrix", y) * self.scales * self.scales[:, np.newaxis]
        largest = np.abs(M).max(axis=(1, 2), keepdims=True)
        M = M / np.where(largest > 0, largest, 1.0)
        # the given components do not change; their equations are replaced by δ = 0
        kept = np.flatnonzero(~free)
        matrix = np.zeros((len(y), n + m, n + m))
        matrix[:, :n, :n], matrix[:, :n, n:], matrix[:, n:, :n] = M, -G.transpose(0, 2, 1), G
        matrix[:, kept], matrix[:, :, kept] = 0.0, 0.0
        matrix[:, kept, kept] = 1.0
        side = np.zeros((len(y), n + m, 1))
        side[:, n:] = -residuals[:, :, np.newaxis] / sizes
        matrix, side = np.nan_to_num(matrix), np.nan_to_num(side)
        changes = (np.linalg.pinv(matrix, rcond=1e-13) @ side)[:, :n, 0]
        return np.asarray(changes * self.scales * free)


def tangent_start(form: Form, t: float, rows: Array, given: Flags) -> Array:
    """States in rows whose perturbations are tangent to the constraints.

    Perturbations of `given` components remain as they are, as far as the others can follow by
    linear equations: by the smallest change, in the metric of the mass matrix. What still violates
    the linearised constraints is removed by a change of all components.

    Parameters
    ----------
    form : Form
        A form with perturbations of a system with constraints.
    t : float
        Time in s.
    rows : ndarray of shape (motions, 2 state)
        States that satisfy the constraints, each with a perturbation.
    given : ndarray of bool, shape (state,)
        Which perturbations are given.

    Returns
    -------
    ndarray of shape (motions, 2 state)
    """
    size, result = len(form.module.STATE), rows.copy()
    y, changes = result[:, :size], result[:, size:]
    params = np.column_stack([np.broadcast_to(p, len(rows)) for p in form.constants])
    assembly = Assembly(form.module, params.reshape(len(rows), -1), t)
    if not given.all():
        every = [*range(len(assembly.names))]
        first, last = slice(0, assembly.n), slice(assembly.n, size)
        moving = assembly.in_constraints
        for part, of, free in ((first, assembly.of_positions, True), (last, every, moving)):
            # the residual of a perturbation is that which the change of all components removes
            removing = tangent_change(form, t, result)[:, part] / assembly.scales
            residuals = -np.einsum("kij,kj->ki", assembly.jacobian(y)[:, of], removing)
            changes[:, part] += assembly.smallest_change(y, residuals, ~given[part] & free, of)
    changes += tangent_change(form, t, result)
    return result
