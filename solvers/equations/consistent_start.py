"""Initial states: what they may leave out, and those that satisfy the constraints of a system."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solvers.equations.assembly import (
    CLOSED,
    EXACT,
    ROUNDED,
    Array,
    Assembly,
    Flags,
)
from solvers.equations.module import GeneratedModule, function, has_constraints, has_function, part
from solvers.equations.number_checks import Values, quantities, real_number
from solvers.equations.signature_checks import checked
from solvers.io.quantity import with_unit
from solvers.io.suggestion import counted


def default_coordinates(
    module: GeneratedModule, given: Collection[str], params: NDArray[Any]
) -> dict[str, Any]:
    """Values of coordinates that are not given, of a system without constraints.

    Parameters
    ----------
    module : module
        A generated module.
    given : collection of str
        Names of the components that are given.
    params : ndarray of shape (parameters, ...)
        Parameters, of one motion or of many.

    Returns
    -------
    dict of str to float or ndarray
        0 for coordinates on which no acceleration depends, such as cyclic ones; for lengths, which
        are positive, the value at the equilibrium, if the system has one. Other coordinates are
        missing.
    """
    missing = [name for name in module.COORDINATES if name not in given]
    if not missing:
        return {}
    variables = part(module, "rhs").VARIABLES["accelerations"]
    result: dict[str, Any] = {
        name: 0.0 for name in missing if name not in variables and name not in module.POSITIVE
    }
    lengths = [name for name in missing if name in module.POSITIVE]
    if lengths and has_function(module, "equilibrium"):
        rest = function(module, "equilibrium_many")(params)
        result |= {name: rest[module.COORDINATES.index(name)] for name in lengths}
    return result


def default_words(module: GeneratedModule, values: dict[str, Any]) -> str:
    """Default coordinates of one motion as text; empty if there are none."""
    units = module.UNITS
    lengths = [
        f"{name} = {float(value):.6g} {units[name]}"
        for name, value in values.items()
        if name in module.POSITIVE
    ]
    others = [name for name in values if name not in module.POSITIVE]
    parts = [f"at equilibrium: {', '.join(lengths)}"] if lengths else []
    if others:
        parts.append(f"without effect on accelerations: {', '.join(others)} = 0")
    return "; ".join(parts)


#: Guesses of other configurations, and the distance at which two are the same.
OTHERS, CLOSE = 48, 1e-6


@dataclass(frozen=True)
class ConsistentStart:
    """A state that satisfies the constraints.

    Attributes
    ----------
    y : ndarray of shape (state,)
        Coordinates and velocities.
    completed : tuple of str
        The components that were not given.
    others : ndarray of shape (solutions, coordinates)
        Other configurations with the same given coordinates, which other guesses lead to; empty
        where the given coordinates leave degrees of freedom.
    """

    y: Array
    completed: tuple[str, ...]
    given: tuple[str, ...]
    assembly: Assembly

    @property
    def module(self) -> GeneratedModule:
        """The generated module."""
        return self.assembly.module

    @cached_property
    def others(self) -> Array:
        """Other configurations, from random guesses."""
        n, state = self.assembly.n, self.module.STATE
        free = np.array([name not in self.given for name in state[:n]])
        # a positive coordinate is 0 where a mechanism is folded
        positive = np.array([name in self.module.POSITIVE for name in state[:n]])
        least = np.where(positive, CLOSE * self.assembly.scales, -np.inf)
        reach = np.where(self._angles, np.pi, 2 * self.assembly.scales)
        rng = np.random.default_rng(0)
        guesses = self.y[:n] + free * reach * rng.uniform(-1, 1, (OTHERS, n))
        result = [self.y[:n]]
        if free.any() and not self._freedom(free):
            solutions, error = self.assembly.closed(guesses, free)
            for q in solutions[(error <= CLOSED) & (solutions > least).all(axis=1)]:
                turned = q - self._angles * 2 * np.pi * np.round(q / (2 * np.pi))
                if all(self._distance(turned, other) > CLOSE for other in result):
                    result.append(turned)
        return np.array(sorted(result[1:], key=lambda q: self._distance(q, self.y[:n]))).reshape(
            -1, n
        )

    def _freedom(self, free: Flags) -> int:
        """Degrees of freedom of the free coordinates."""
        matrix = self.assembly.jacobian(self.y[np.newaxis])[0][self.assembly.of_positions]
        return int(free.sum() - np.linalg.matrix_rank(matrix * free, tol=1e-7))

    @cached_property
    def _angles(self) -> Flags:
        units = self.module.UNITS
        return np.array([units[name] == "rad" for name in self.module.COORDINATES])

    @cached_property
    def _zeros(self) -> list[str]:
        """Components of the state that are 0 up to rounding errors."""
        n, scales = self.assembly.n, self.assembly.scales
        rate = np.abs(self.y[n:] / scales).max(initial=0.0)
        is_zero = np.abs(self.y) <= EXACT * np.hstack([scales, rate * scales])
        return [name for name, zero in zip(self.module.STATE, is_zero, strict=True) if zero]

    def _distance(self, q: Array, other: Array) -> float:
        change = (q - other) / self.assembly.scales
        change = np.where(self._angles, np.abs(np.sin(change / 2)) * 2, np.abs(change))
        return float(change.max())

    @property
    def words(self) -> str:
        """The completed components, and other solutions, in a sentence each."""
        state = dict(zip(self.module.STATE, self.y.tolist(), strict=True))
        if not self.completed:
            return ""
        zeros = [name for name in self.completed if name in self._zeros]
        others = [name for name in self.completed if name not in self._zeros]
        parts = [_listed(self.module, state, others), f"{', '.join(zeros)} = 0" if zeros else ""]
        text = f"from the constraints: {', '.join(filter(None, parts))}"
        for q in self.others:
            other = dict(zip(self.module.COORDINATES, q.tolist(), strict=True))
            changes = np.abs(q - self.y[: self.assembly.n]) > CLOSE * self.assembly.scales
            names = [name for name, is_other in zip(other, changes, strict=True) if is_other]
            text += f"; another solution, for guesses near it: {_listed(self.module, other, names)}"
        return text

    def __repr__(self) -> str:
        state = dict(zip(self.module.STATE, self.y.tolist(), strict=True))
        lines = [f"ConsistentStart of {self.module.SYSTEM}, t = {self.assembly.t:.6g} s"]
        if self.given:
            lines.append(f"given: {_listed(self.module, state, self.given)}")
        return "\n  ".join([*lines, *self.words.split("; ")])


@checked
def consistent_start(
    module: GeneratedModule,
    y0: Values,
    params: Values,
    t: float = 0.0,
    *,
    guess: Values | None = None,
) -> ConsistentStart:
    """A state that satisfies the constraints, from some of its components.

    Gauss-Newton steps from a guess lead to the coordinates that are not given, and linear equations
    to the velocities that are not given: those of least kinetic energy, and 0, or the guess, where
    no constraint contains them.

    Parameters
    ----------
    module : module
        A generated module of a system with constraints.
    y0 : array_like of shape (state,), or mapping of str to float
        Components that remain as they are, by name, such as ``{"theta1": 0.5}``. If these are more
        than the degrees of freedom, residuals up to 1e-6, relative to the size of the system, are
        removed by small changes.
    params : array_like of shape (parameters,), or mapping of str to float
        As in `solvers.integrate`.
    t : float, optional
        Time in s, if constraints depend on it.
    guess : array_like of shape (state,), or mapping of str to float, optional
        Values near which to find components that are not given, by default 0. They decide which of
        several solutions results.

    Returns
    -------
    solvers.equations.consistent_start.ConsistentStart
        ``y`` is the state; ``others`` are other configurations with the same given coordinates.

    Raises
    ------
    ValueError
        When an argument is invalid, the system has no constraints, or no state that satisfies them
        is found; the message states the least residuals.

    Examples
    --------
    A pendulum in Cartesian coordinates, whose bob can be below or above the pivot:

    >>> from sympy import symbols
    >>> from derive import Coordinate, Parameter, PointMass, System
    >>> from holonomic import build
    >>> x, y = symbols("x y", real=True)
    >>> m, l = symbols("m l", positive=True)
    >>> swing = build(System(
    ...     "swing", "A pendulum", [Coordinate(x, "m", "right"), Coordinate(y, "m", "up")],
    ...     [Parameter(m, "kg", 1.0, "mass"), Parameter(l, "m", 0.5, "length")],
    ...     [PointMass(m, (x, y))], potential=0, constraints=[x**2 + y**2 - l**2],
    ... ))
    >>> start = consistent_start(swing, {"x": 0.3, "x_dot": 1.0}, {}, guess={"y": -1.0})
    >>> start.y.round(12)
    array([ 0.3 , -0.4 ,  1.  ,  0.75])
    >>> start.others
    array([[0.3, 0.4]])
    """
    if not has_constraints(module):
        raise ValueError(f"{module.SYSTEM} has no constraints: every state is consistent")
    defaults = dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True))
    constants = quantities(module, "params", module.PARAMETERS, params, defaults)
    row = quantities(module, "y0", module.STATE, y0, guesses(module, guess))
    for name, array, parts in (("y0", row, module.STATE), ("params", constants, defaults)):
        if array.shape != (len(parts),):
            raise ValueError(
                f"{name} has shape {array.shape}: give {len(parts)} numbers, {', '.join(parts)}"
            )
    names = given_names(module, y0)
    assembly = Assembly(module, constants[np.newaxis], real_number("t", t, "s"))
    y = consistent(assembly, row[np.newaxis], names)[0]
    completed = tuple(name for name in module.STATE if name not in names)
    return ConsistentStart(y, completed, names, assembly)


def guesses(module: GeneratedModule, values: Values | None = None) -> dict[str, Any]:
    """Guesses of all components of the state: the given values, or 0, or a positive size."""
    scales = Assembly(module, np.array([module.DEFAULTS])).scales.tolist()
    default = dict.fromkeys(module.STATE, 0.0)
    sizes = zip(module.COORDINATES, scales, strict=True)
    default |= {name: size for name, size in sizes if name in module.POSITIVE}
    if values is None:
        return default
    row = quantities(module, "guess", module.STATE, values, default)
    if row.shape != (len(default),):
        raise ValueError(
            f"guess has shape {row.shape}: give {len(default)} numbers, or some by name"
        )
    return dict(zip(module.STATE, row.tolist(), strict=True))


def given_names(module: GeneratedModule, values: Values) -> tuple[str, ...]:
    """Names of the components that are given: all of a sequence."""
    if not isinstance(values, Mapping):
        return tuple(module.STATE)
    return tuple(name for name in module.STATE if name in values)


def consistent(assembly: Assembly, rows: Array, names: Sequence[str]) -> Array:
    """States, in rows, that satisfy the constraints, of which components `names` are given.

    States that satisfy them to rounding errors remain as they are. `ValueError` states the
    residuals of the first motion without a solution.
    """
    module = assembly.module
    given = np.array([name in names for name in module.STATE])
    result = rows.copy()
    wrong = np.asarray((assembly.relative(rows) > EXACT).any(axis=1) | ~given.all())
    if wrong.any():
        part = assembly.subset(wrong)
        result[wrong], found = part.assembled(rows[wrong], given)
        if not found.all():
            first = int(np.flatnonzero(wrong)[np.argmin(found)])
            motion = f" of motion {first}" if len(rows) > 1 else ""
            where = np.arange(len(rows)) == first
            raise ValueError(
                _refusal(assembly.subset(where), rows[where], result[where], names, motion)
            )
    _check_redundant(assembly, result)
    return result


def _refusal(
    assembly: Assembly, row: Array, nearest: Array, names: Sequence[str], motion: str
) -> str:
    """Residuals of the constraints, and the remedies."""
    module = assembly.module
    wrong = assembly.relative(nearest)[0] > CLOSED
    is_position = np.arange(len(wrong)) < len(assembly.of_positions)
    wrong &= is_position if (wrong & is_position).any() else True
    values = zip(module.RESIDUALS, assembly.residuals(nearest)[0].tolist(), strict=True)
    residuals = ", ".join(
        f"{name} = {value:.3g}"
        for (name, value), is_wrong in zip(values, wrong, strict=True)
        if is_wrong
    )
    rank = np.linalg.matrix_rank(assembly.jacobian(nearest)[0], tol=1e-7)
    freedom = counted(int(assembly.n - rank), "degree") + " of freedom"
    state = dict(zip(module.STATE, row[0].tolist(), strict=True))
    if len(names) == len(module.STATE):
        return (
            f"the state{motion} does not satisfy the constraints of {module.SYSTEM}, with "
            f"{freedom}: {residuals} instead of 0; give fewer components by name, from which the "
            "others follow, or take solvers.consistent_start(module, {}, params, guess=state).y"
        )
    return (
        f"no state{motion} with {_listed(module, state, names)} satisfies the constraints of "
        f"{module.SYSTEM}, with {freedom}: the nearest has {residuals} instead of 0; give fewer or "
        "other components, or guesses of the others, as in solvers.consistent_start"
    )


def _check_redundant(assembly: Assembly, rows: Array) -> None:
    """Refuse parameters with which a constraint that was left out does not follow from others."""
    module = assembly.module
    if not has_function(module, "redundant_constraints"):
        return
    many = function(module, "redundant_constraints_many")
    residuals = np.abs(many(assembly.t, rows.T, assembly.params.T))
    sizes = np.linalg.norm(assembly.jacobian(rows), axis=2).max(axis=1, initial=0.0)
    if (residuals > ROUNDED * sizes).any():
        raise ValueError(
            f"constraints of {module.SYSTEM} that follow from the others with default parameters "
            f"do not with these: the largest residual is {residuals.max():.3g}; derive the system "
            "with these parameters as default values"
        )


def _listed(module: GeneratedModule, state: Mapping[str, float], names: Sequence[str]) -> str:
    units = module.UNITS
    return ", ".join(f"{name} = {with_unit(state[name], units[name])}" for name in names)
