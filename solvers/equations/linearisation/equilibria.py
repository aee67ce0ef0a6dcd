"""All equilibria in a box: boxes without one are excluded by intervals, then Newton's method."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solvers.equations.linearisation.intervals import FUNCTIONS, Interval, bounds_of, select
from solvers.equations.linearisation.linear_system import LinearSystem, linearise, with_inputs
from solvers.equations.module import (
    GeneratedModule,
    depends_on_time,
    function,
    has_constraints,
    with_functions,
)
from solvers.equations.number_checks import Values, real_numbers
from solvers.equations.signature_checks import checked
from solvers.io.suggestion import did_you_mean, shortened

Array = NDArray[np.float64]

#: How often a box is halved in each direction, and most boxes.
HALVINGS, MOST_BOXES = 18, 50_000
#: Most steps of Newton's method; its last step, and accelerations, relative to the box.
MOST_STEPS, CONVERGED = 60, 1e-9
#: Accelerations that count as small, relative to their derivatives times the width of the box.
SMALL = 1e-6
#: Equilibria that are closer, relative to the box, count as one.
CLOSE = 1e-4


@checked
def equilibria(
    module: GeneratedModule,
    params: Values,
    box: Mapping[str, object] | None = None,
    *,
    inputs: Values | None = None,
    velocities: Mapping[str, object] | None = None,
) -> list[LinearSystem]:
    """All equilibria in a box, or steady motions with constant velocities, linearised.

    Boxes in which intervals of the accelerations do not contain 0 have no equilibrium. The others
    are halved until they are small, and Newton's method starts in each, so that no equilibrium is
    missed, also where several are about to merge.

    Parameters
    ----------
    module : module
        A generated module, whose equations do not depend on time.
    params : array_like of shape (parameters,), or mapping of str to float
        In the order of ``module.PARAMETERS``, or by name.
    box : mapping of str to (float, float) or float, optional
        The range of each coordinate, or its value where it is fixed. An angle that is left out can
        have all values from -π to π; other coordinates are necessary.
    inputs : array_like of shape (inputs,), or mapping of str to float, optional
        Constant inputs, in place of those in `params`.
    velocities : mapping of str to float or (float, float), optional
        Velocities of a steady motion, such as ``{"phi_dot": 2.0}``, or their ranges. No force may
        depend on the coordinates that move, which are 0 unless `box` has their values; all other
        velocities are 0.

    Returns
    -------
    list of LinearSystem
        In the order of coordinates. Their ``stability`` and ``modes`` follow from their matrices.
        Equilibria with a distance below 1e-4 of the box count as one. A point at which the
        equations are singular, such as the pole of spherical coordinates, is none.

    Raises
    ------
    ValueError
        When an argument is invalid, the equations depend on time or contain other functions than
        intervals are known of; when equilibria are not isolated, or a force depends on a coordinate
        that moves.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> from solvers import equilibria
    >>> for equilibrium in equilibria(dp, dp.DEFAULTS):
    ...     print(equilibrium.y[:2].round(4) + 0.0, equilibrium.stability)
    [0. 0.] neutral
    [0.     3.1416] unstable
    [3.1416 0.    ] unstable
    [3.1416 3.1416] unstable

    A conical pendulum turns 2 times a second:

    >>> import generated.spherical_pendulum as spherical
    >>> turning = {"phi_dot": 4 * 3.141592653589793}
    >>> cone = equilibria(spherical, {"l": 1.0}, {"theta": (0.1, 3)}, velocities=turning)
    >>> cone[0].y.round(4)
    array([ 1.5086,  0.    ,  0.    , 12.5664])
    """
    if depends_on_time(module):
        raise ValueError(f"the equations of {module.SYSTEM} depend on time: it has no equilibria")
    low, high = _ranges(module, {} if box is None else box, velocities or {})
    constants = with_inputs(module, params, inputs)
    search = _Search(module, constants, low, high)
    search.check_moving(velocities or {})
    roots: list[Array] = []
    for start in search.candidates():
        root = search.newton(start)
        if root is not None and all(not search.are_close(root, other) for other in roots):
            roots.append(root)
    roots.sort(key=lambda root: np.round(root, 6).tolist())
    return [linearise(module, root, constants) for root in roots]


@dataclass(frozen=True)
class _Search:
    """A search for states in a box at which accelerations are 0."""

    module: GeneratedModule
    params: Sequence[float]
    low: Array
    high: Array

    @cached_property
    def free(self) -> NDArray[np.bool_]:
        """The components of the state that are not fixed."""
        return self.high > self.low

    @cached_property
    def width(self) -> Array:
        return np.where(self.free, self.high - self.low, 1.0)

    @cached_property
    def scale(self) -> Array:
        """The size of accelerations in the box, and of each residual of constraints."""
        arguments = 0.0, self._some_states, self.params
        with np.errstate(all="ignore"):
            accelerations = np.abs(self.module.rhs_many(*arguments)[self.n :])
            # those that vanish in the whole box, but for rounding errors
            derivatives = np.abs(self.module.jacobian_many(*arguments)[self.n :, : self.n])
            small = SMALL * np.nanmax(derivatives * self._lengths[:, np.newaxis], initial=1e-300)
            sizes = [np.full(self.n, np.nanmax(accelerations, initial=small))]
            if has_constraints(self.module):
                residuals = function(self.module, "constraints_many")(*arguments)
                sizes.append(np.nanmax(np.abs(residuals), axis=1, initial=1e-300))
        return np.concatenate(sizes)

    @property
    def _lengths(self) -> Array:
        """The width of the box in each coordinate; where it is fixed, in those of its unit."""
        units = np.array([self.module.UNITS[name] for name in self.module.COORDINATES])
        widths = np.where(self.free, self.high - self.low, 0.0)[: self.n]
        return np.array([widths[units == one].max() for one in units])

    def residuals(self, state: list[float]) -> tuple[Array, Array]:
        """Accelerations and residuals of constraints, and their derivatives by the state."""
        arguments = 0.0, state, self.params
        values = [self.module.rhs(*arguments)[self.n :]]
        rows = [self.module.jacobian(*arguments)[self.n :]]
        if has_constraints(self.module):
            values.append(function(self.module, "constraints")(*arguments))
            rows.append(function(self.module, "constraints_jacobian")(*arguments))
        return np.concatenate(values), np.concatenate(rows)

    @property
    def n(self) -> int:
        """Number of coordinates."""
        return len(self.low) // 2

    @property
    def _some_states(self) -> Array:
        """States in the box, in columns."""
        parts = np.random.default_rng(0).random((64, len(self.low)))
        return np.asarray((self.low + parts * np.where(self.free, self.width, 0.0)).T)

    def check_moving(self, velocities: Iterable[str]) -> None:
        """Refuse velocities of coordinates on which accelerations depend."""
        if not velocities:
            return
        with np.errstate(all="ignore"):
            jacobian = np.abs(self.module.jacobian_many(0.0, self._some_states, self.params))
        for name in velocities:
            k = self.module.STATE.index(name) - self.n
            if np.nanmax(jacobian[self.n :, k], initial=0.0) > 0:
                coordinate = self.module.COORDINATES[k]
                raise ValueError(
                    f"velocities has {name!r}, but forces depend on {coordinate}: a motion with "
                    "this velocity is not steady"
                )

    def candidates(self) -> Array:
        """Points near which there may be an equilibrium, in rows."""
        low, high = self.low[np.newaxis], self.high[np.newaxis]
        names = ["rhs", *(["constraints"] if has_constraints(self.module) else [])]
        functions = [
            with_functions(function(self.module, name), {**FUNCTIONS, "select": select})
            for name in names
        ]
        for _, k in product(range(HALVINGS), np.flatnonzero(self.free)):
            middle = (low[:, k] + high[:, k]) / 2
            low, high = np.repeat(low, 2, axis=0), np.repeat(high, 2, axis=0)
            high[::2, k] = low[1::2, k] = middle
            possible = self._may_vanish(functions, low, high)
            low, high = low[possible], high[possible]
            if len(low) > MOST_BOXES:
                name = self.module.STATE[int(np.flatnonzero(self.free)[0])]
                raise ValueError(
                    f"equilibria of {self.module.SYSTEM} are not isolated in this box, or it is "
                    "too large: give a number in box for coordinates on which no force depends, "
                    f"such as box={{{name!r}: 0.0}}, or smaller ranges"
                )
        centres = (low + high) / 2
        cells = np.round((centres - self.low) / self.width / CLOSE)
        return np.asarray(centres[np.unique(cells, axis=0, return_index=True)[1]])

    def _may_vanish(
        self, functions: Sequence[Callable[..., Sequence[Any]]], low: Array, high: Array
    ) -> NDArray[np.bool_]:
        """Boxes, in rows, in which the range of every acceleration and constraint contains 0."""
        state = [
            Interval(*bounds) if is_free else value
            for is_free, value, *bounds in zip(
                self.free, self.low.tolist(), low.T, high.T, strict=True
            )
        ]
        try:
            with np.errstate(all="ignore"):
                rates, *residuals = (f(0.0, state, self.params) for f in functions)
        except (TypeError, AttributeError) as error:
            known = ", ".join(FUNCTIONS)
            raise ValueError(
                f"the range of the equations of {self.module.SYSTEM} is not known: their functions "
                f"must be among {known}"
            ) from error
        possible = np.ones(len(low), bool)
        for value in chain(rates[self.n :], *residuals):
            least, largest = bounds_of(value)
            possible &= ~(least > 0) & ~(largest < 0)
        return possible

    def newton(self, start: Array) -> Array | None:
        """The equilibrium that Newton's method reaches; None if it leaves the box."""
        n, q = self.n, start.copy()
        for _ in range(MOST_STEPS):
            state = q.tolist()
            try:
                residuals, jacobian = self.residuals(state)
            except (ArithmeticError, ValueError):
                return None
            by_free = jacobian[:, self.free] / self.scale[:, np.newaxis]
            parts = residuals / self.scale
            if not (np.isfinite(parts).all() and np.isfinite(by_free).all()):
                return None
            step = np.zeros(2 * n)
            step[self.free] = np.linalg.lstsq(by_free, -parts, rcond=1e-14)[0]
            is_root = np.abs(parts).max(initial=0.0) <= CONVERGED
            q = q + np.clip(step, -self.width, self.width)
            if is_root and (np.abs(step) <= CONVERGED * self.width).all():
                break
        if not is_root:
            return None
        margin = CLOSE * self.width
        if (q < self.low - margin).any() or (q > self.high + margin).any():
            return None
        return self._in_one_turn(q)

    def _in_one_turn(self, q: Array) -> Array:
        """An angle at the start of a range that includes a whole turn is that at its end."""
        turn = np.where([*_angles(self.module), *[False] * self.n], 2 * np.pi, np.inf)
        margin = CLOSE * self.width
        return q + np.where((q < self.low + margin) & (q + turn < self.high + margin), turn, 0.0)

    def are_close(self, a: Array, b: Array) -> bool:
        return bool((np.abs(a - b) <= CLOSE * self.width).all())


def _angles(module: GeneratedModule) -> list[bool]:
    """Whether forces depend on a coordinate by its sine and cosine."""
    rational = module.STATES.get("rational", ())
    return [f"sin_{name}" in rational for name in module.COORDINATES]


def _ranges(
    module: GeneratedModule, box: Mapping[str, object], velocities: Mapping[str, object]
) -> tuple[Array, Array]:
    """Lower and upper ends of all components of the state."""
    names = module.COORDINATES
    rates = module.STATE[len(names) :]
    for name in box:
        if name not in names:
            hint = did_you_mean(str(name), names)
            raise ValueError(f"box has {name!r}{hint}; coordinates are {', '.join(names)}")
    for name in velocities:
        if name not in rates:
            hint = did_you_mean(str(name), rates)
            raise ValueError(f"velocities has {name!r}{hint}; velocities are {', '.join(rates)}")
    moving = {q: 0.0 for q, rate in zip(names, rates, strict=True) if rate in velocities}
    ranges, box = [], moving | dict(box)
    for name in names:
        unit = module.UNITS[name]
        if name not in box and unit != "rad":
            raise ValueError(
                f"box lacks {name}: give its range, {name!r}: (low, high) in {unit}, or a number "
                "where it is fixed"
            )
        ranges.append(_range(f"box[{name!r}]", box.get(name, (-np.pi, np.pi)), unit))
    for name in rates:
        given = velocities.get(name, 0.0)
        ranges.append(_range(f"velocities[{name!r}]", given, module.UNITS[name]))
    low, high = np.array(ranges).T
    return low.copy(), high.copy()


def _range(what: str, values: object, unit: str) -> Array:
    """Lower and upper end."""
    ends = real_numbers(what, values, unit)
    if ends.shape not in ((), (2,)) or (ends.ndim and not ends[0] < ends[1]):
        raise ValueError(f"{what} = {shortened(values)} must be a pair (low, high) or a number")
    return np.asarray(np.broadcast_to(ends, 2))
