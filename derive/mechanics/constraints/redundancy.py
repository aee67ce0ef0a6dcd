"""Independence of constraints, decided with numbers at configurations that satisfy them.

Many redundancies exist only where the constraints hold, as that of a third crank in a
parallelogram. There a redundant row of G depends on others; and it still does, and its constraint
still holds, at other configurations that satisfy these. Configurations are found by Gauss-Newton
steps from several guesses (J. Garcia de Jalon, E. Bayo, Kinematic and Dynamic Simulation of
Multibody Systems (1994), chapter 3).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import pi
from typing import Any, TypeAlias

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from derive.mechanics.constraints.differentiated_constraints import Constraints
from derive.system.constraints import Constraint
from derive.system.parts import SystemDefinitionError
from derive.system.symbols import TIME

Array: TypeAlias = NDArray[np.float64]

#: Most guesses of usual size, and configurations that decide together; then other sizes, for
#: constraints whose lengths are numbers, and guesses of each.
GUESSES, ENOUGH = 60, 8
OTHER_SIZES, OTHER_GUESSES = (10.0, 0.1, 100.0, 0.01, 1000.0), 6
#: Most Gauss-Newton steps, their largest change of coordinates of usual size, and most halvings.
STEPS, LARGEST, HALVINGS = 100, 0.5, 10
#: The ratio of residuals after a step and before it above which there is no solution near.
SLOWEST = 0.98
#: A residual that counts as 0, and the distance of a row from others on which it depends.
CLOSED, DEPENDENT = 1e-9, 1e-6
#: The distance to other configurations, at which redundant constraints still hold.
AWAY = 0.2


def independent(equations: Constraints) -> tuple[tuple[Constraint, ...], tuple[Constraint, ...]]:
    """The constraints that determine the motion, in order, and those that follow from them.

    `SystemDefinitionError` where no configuration satisfies the constraints, or where one depends
    on others at these configurations alone.
    """
    closure = Closure(equations)
    groups: dict[int, list[Configuration]] = {}
    for at in closure.configurations():
        groups.setdefault(len(closure.independent_rows([at])), []).append(at)
    problem = ""
    # the branch in which fewest coordinates are locked, and of these the one that most constraints
    # restrict: two cranks that coincide have more freedom, but are not the linkage
    order = sorted(groups, key=lambda count: (closure.locked(groups[count]), -count))
    for group in map(groups.__getitem__, order):
        kept = closure.independent_rows(group)
        rest = [k for k in range(len(closure.conditions)) if k not in kept]
        if not (name := closure.not_implied(kept, rest, group)):
            return tuple(closure.conditions[k] for k in kept), tuple(
                closure.conditions[k] for k in rest
            )
        problem = problem or name
    raise SystemDefinitionError(
        f"constraint {problem} of system {equations.system.name!r} depends on the others wherever "
        "all of them hold, but does not follow from them: they contradict each other, or permit no "
        "motion, as rods that are just long enough, or the gradient of a formula is 0 where the "
        "formula is; change the constraint, or default values of parameters"
    )


@dataclass(frozen=True)
class Configuration:
    """Coordinates, in their units, at a time."""

    q: Array
    t: float


@dataclass(frozen=True)
class Closure:
    """The constraints of a system in numbers, with the default values of its parameters."""

    equations: Constraints

    @property
    def conditions(self) -> tuple[Constraint, ...]:
        """The constraints."""
        return self.equations.system.conditions

    @cached_property
    def of_coordinates(self) -> list[int]:
        """Indices of the constraints of coordinates."""
        holonomic = {*self.equations.holonomic}
        return [k for k, one in enumerate(self.conditions) if one.formula in holonomic]

    @cached_property
    def _function(self) -> Any:
        system, equations = self.equations.system, self.equations
        values = {p.symbol: sp.Float(p.default) for p in system.parameters_and_inputs}
        columns = (equations.constraint_drift, *equations.constraint_jacobian.T.tolist())
        entries = [*equations.holonomic, *(entry for column in columns for entry in column)]
        entries = [entry.xreplace(values) for entry in entries]
        return sp.lambdify([*system.q, TIME], entries, "math", cse=True)  # faster than NumPy

    def values(self, at: Configuration) -> tuple[Array, Array, Array]:
        """Residuals of the constraints of coordinates, drifts b, and G in units of the scales."""
        numbers = self._numbers(at)
        h, m = len(self.of_coordinates), len(self.conditions)
        jacobian = numbers[h + m :].reshape(-1, m).T * self.scales
        return numbers[:h] / self.sizes, numbers[h : h + m], jacobian

    def _numbers(self, at: Configuration) -> Array:
        try:
            return np.array(self._function(*at.q.tolist(), at.t), dtype=float)
        except (ArithmeticError, ValueError):  # as of roots of negative numbers
            count = len(self.of_coordinates) + len(self.conditions) * (len(at.q) + 1)
            return np.full(count, np.nan)

    @cached_property
    def scales(self) -> Array:
        """Sizes of the coordinates: 1, or the constraints' largest parameter of the same unit."""
        system = self.equations.system
        used = set().union(*(one.formula.free_symbols for one in self.conditions))
        sizes: dict[str, float] = {}
        for one in (parameter for parameter in system.parameters if parameter.symbol in used):
            sizes[one.unit] = max(sizes.get(one.unit, 0.0), abs(one.default))
        return np.array(
            [(one.unit != "rad" and sizes.get(one.unit)) or 1.0 for one in system.coordinates]
        )

    @cached_property
    def guesses(self) -> list[Configuration]:
        """The equilibrium, if it is known, and random configurations."""
        system, rng = self.equations.system, np.random.default_rng(1)
        times = (0.0, 1.0) if TIME in sp.Tuple(*self.equations.holonomic).free_symbols else (0.0,)
        values = {p.symbol: sp.Float(p.default) for p in system.parameters_and_inputs}
        given = [sp.sympify(x).xreplace(values) for x in system.equilibrium or ()]
        rows = [np.array(given, float)] if given else []
        is_angle = np.array([one.unit == "rad" for one in system.coordinates])
        others = [size for size in OTHER_SIZES for _ in range(OTHER_GUESSES) if not is_angle.all()]
        for size in (*[1.0] * GUESSES, *others):
            reach = np.where(is_angle, pi, self.scales * size)
            row = reach * rng.uniform(-1, 1, len(reach))
            rows.append(np.where([q.is_positive for q in system.q], np.abs(row), row))
        return [Configuration(row, times[k % len(times)]) for k, row in enumerate(rows)]

    @cached_property
    def sizes(self) -> Array:
        """Sizes of the constraints of coordinates at the guesses of usual size."""
        rows = [self._numbers(at) for at in self.guesses[:GUESSES]]
        h = len(self.of_coordinates)
        values = np.abs(np.array(rows)[:, :h])
        finite = np.where(np.isfinite(values), values, 0.0).max(axis=0, initial=0.0)
        return np.where(finite > 0, finite, 1.0)

    def closed(self, start: Configuration, rows: Sequence[int]) -> tuple[Configuration, Array]:
        """A configuration near `start` that satisfies these rows, and all residuals there."""
        now, (residuals, _, jacobian) = start, self.values(start)
        longest = LARGEST * max(1.0, np.abs(start.q / self.scales).max() / pi)
        chosen = [self.of_coordinates.index(k) for k in rows if k in self.of_coordinates]
        for _ in range(STEPS):
            matrix = jacobian[self.of_coordinates][chosen] / self.sizes[chosen, np.newaxis]
            if not (np.isfinite(matrix).all() and np.isfinite(residuals).all()):
                break
            step = -np.linalg.lstsq(matrix, residuals[chosen], rcond=1e-10)[0]
            step *= longest / max(longest, np.abs(step).max(initial=0.0))
            for _ in range(HALVINGS):
                trial = Configuration(now.q + step * self.scales, now.t)
                values = self.values(trial)
                if np.linalg.norm(values[0][chosen]) < SLOWEST * np.linalg.norm(residuals[chosen]):
                    break
                step /= 2
            else:
                break
            now, (residuals, _, jacobian) = trial, values
        return now, residuals

    def configurations(self) -> list[Configuration]:
        """Some configurations that satisfy the constraints of coordinates."""
        result: list[Configuration] = []
        least, worst = np.inf, 0
        for guess in self.guesses:
            at, residuals = self.closed(guess, self.of_coordinates)
            largest = np.abs(residuals).max(initial=0.0)
            if largest <= CLOSED and np.isfinite(self.values(at)[2]).all():
                result.append(at)
                if len(result) == ENOUGH:
                    break
            elif largest < least:
                least, worst = largest, int(np.argmax(np.abs(residuals)))
        if not result:
            name = self.equations.system.name
            one = self.conditions[self.of_coordinates[worst]].name
            raise SystemDefinitionError(
                f"no configuration satisfies the constraints of system {name!r} with the default "
                f"values of its parameters: from {len(self.guesses)} guesses, the least residual "
                f"is {one} = {least * self.sizes[worst]:.3g}; change a constraint or a default "
                "value, or give a configuration near a solution as the equilibrium"
            )
        return result

    def independent_rows(self, configurations: Sequence[Configuration]) -> list[int]:
        """Rows of G that at one configuration or more do not depend on those before them.

        Norms of quaternions, without which equations are solved, precede other constraints; those
        of velocities, which may follow from those of coordinates, come last.
        """
        matrices = [self._rows(at) for at in configurations]
        bases = [np.empty((0, len(self.scales))) for _ in matrices]
        kept = []
        for k in sorted(range(len(self.conditions)), key=self._precedence):
            is_independent = False
            for c, matrix in enumerate(matrices):
                rest = matrix[k] - bases[c].T @ (bases[c] @ matrix[k])
                rest -= bases[c].T @ (bases[c] @ rest)
                if np.linalg.norm(rest) > DEPENDENT:
                    is_independent = True
                    bases[c] = np.vstack([bases[c], rest / np.linalg.norm(rest)])
            if is_independent:
                kept.append(k)
        return sorted(kept)

    def _precedence(self, k: int) -> tuple[bool, bool]:
        is_norm = self.conditions[k].formula in self.equations.quaternion_norms
        return k not in self.of_coordinates, not is_norm

    def _rows(self, at: Configuration) -> Array:
        """G with rows of the size 1 at a generic configuration."""
        return np.asarray(self.values(at)[2] / self._row_sizes[:, np.newaxis])

    @cached_property
    def _row_sizes(self) -> Array:
        sizes = np.array(
            [np.linalg.norm(self.values(at)[2], axis=1) for at in self.guesses[:GUESSES]]
        )
        finite = np.where(np.isfinite(sizes), sizes, 0.0).max(axis=0)
        return np.where(finite > 0, finite, 1.0)

    def locked(self, configurations: Sequence[Configuration]) -> int:
        """The number of coordinates that can move at none of the configurations."""
        moves = np.zeros(len(self.scales), dtype=bool)
        for at in configurations:
            _, sizes, directions = np.linalg.svd(self._rows(at))
            rank = int((sizes > DEPENDENT * sizes.max(initial=0.0)).sum())
            moves |= np.linalg.norm(directions[rank:], axis=0) > DEPENDENT
        return int(np.sum(~moves))

    def not_implied(
        self, kept: Sequence[int], rest: Sequence[int], configurations: Sequence[Configuration]
    ) -> str:
        """The first of the rest that the kept do not imply at other configurations, or none."""
        for at in self._elsewhere(kept, configurations) if rest else ():
            residuals, drift, jacobian = self.values(at)
            rows = np.column_stack([jacobian, drift]) / self._row_sizes[:, np.newaxis]
            for k in rest:
                factors = np.linalg.lstsq(rows[kept, :-1].T, rows[k, :-1], rcond=1e-10)[0]
                errors = np.abs(rows[k] - factors @ rows[kept])
                errors[-1] /= np.abs([rows[k, -1], *(factors * rows[kept, -1])]).max() or 1.0
                is_position = k in self.of_coordinates
                change = abs(residuals[self.of_coordinates.index(k)]) if is_position else 0.0
                if max(errors.max(), change) > DEPENDENT:
                    return self.conditions[k].name
        return ""

    def _elsewhere(
        self, kept: Sequence[int], configurations: Sequence[Configuration]
    ) -> Iterator[Configuration]:
        """Configurations that satisfy the kept constraints, away from the given ones."""
        rng = np.random.default_rng(2)
        for at in configurations:
            matrix = self.values(at)[2][[k for k in kept if k in self.of_coordinates]]
            _, sizes, directions = np.linalg.svd(matrix)
            rank = int((sizes > 1e-10 * sizes.max(initial=0.0)).sum())
            free = directions[rank:]
            change = free.T @ rng.normal(size=len(free))
            change *= AWAY / (np.abs(change).max(initial=0.0) or 1.0)
            start = Configuration(at.q + change * self.scales, at.t + AWAY * rng.uniform(0.5, 1))
            moved, residuals = self.closed(start, kept)
            chosen = [self.of_coordinates.index(k) for k in kept if k in self.of_coordinates]
            if np.abs(residuals[chosen]).max(initial=0.0) <= CLOSED:
                yield moved
