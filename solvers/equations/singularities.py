"""Singularities: of the mass matrix, and of constraints, as at toggle points of linkages."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar

import numpy as np
from numpy.typing import NDArray

from solvers.equations.assembly import Assembly
from solvers.equations.module import (
    GeneratedModule,
    function,
    has_constraints,
    has_function,
    position_constraints,
)
from solvers.io.suggestion import warn_caller

Array = NDArray[np.float64]
#: A motion in a report, its parameters, and its initial state; None examines no initial state.
Motion = tuple[str, Sequence[float], Sequence[float] | None]
#: Conditions of G M⁻¹ Gᵀ and of the mass matrix: above the first digits are lost, above the second
#: all of them.
DOUBTFUL, SINGULAR = 1e12, 1e15
#: A smallest singular value of constraints, usually of the size 1, that is near a singularity.
NEAR = 0.02
#: States that give the sizes of the rows of G.
STATES = 16


class SingularConfigurationWarning(UserWarning):
    """Constraints nearly depend on each other: digits are lost."""


def check_constraints(module: GeneratedModule, motions: Iterable[Motion], t: float) -> None:
    """Refuse motions that start where constraints depend on each other, or warn near it."""
    for name, params, y0 in motions:
        if y0 is None:
            continue
        condition, weakest = condition_of_constraints(module, params, y0, t)
        text = (
            f"{name}the constraints of {module.SYSTEM} have condition {condition:.0e} (of G M⁻¹ "
            f"Gᵀ) at the start: {weakest} nearly depends on the others, as at a toggle point"
        )
        if condition >= SINGULAR:
            raise ValueError(
                f"{text}, from which there is no unique motion; start elsewhere, or change lengths"
            )
        if condition >= DOUBTFUL:
            lost = f"about {np.log10(condition):.0f} digits are lost"
            warn_caller(f"{text}; {lost}", SingularConfigurationWarning)


def condition_of_constraints(
    module: GeneratedModule, params: Sequence[float], y0: Sequence[float], t: float
) -> tuple[float, str]:
    """The condition with rows of G of the size 1 at generic states, and the weakest constraint."""
    y = np.array([y0[: len(module.STATE)]])
    assembly = Assembly(module, np.array([params]), t)
    rng, scales = np.random.default_rng(0), assembly.scales
    others = np.repeat(y, STATES, axis=0)
    others[:, : assembly.n] += _spread(assembly, y[0]) * rng.uniform(-1, 1, (STATES, assembly.n))
    G, typical = assembly.jacobian(y)[0], assembly.jacobian(others)
    M = np.array(module.mass_matrix(t, y[0].tolist(), params)) * np.outer(scales, scales)
    if not (np.isfinite(G).all() and np.isfinite(M).all()):
        return 0.0, ""
    M /= np.abs(M).max() or 1.0
    values = np.linalg.eigvalsh(M)
    if values[0] < values[-1] / DOUBTFUL:  # as of a unit quaternion, or without inertia
        M = M + G.T @ G
    root = np.linalg.cholesky(M + np.finfo(float).eps * np.eye(len(M)))
    sizes = np.linalg.norm(np.linalg.solve(root, typical.transpose(0, 2, 1)), axis=1)
    sizes = np.where(np.isfinite(sizes), sizes, 0.0).max(axis=0)
    rows = np.linalg.solve(root, G.T).T / np.where(sizes > 0, sizes, 1.0)[:, np.newaxis]
    left, singular, _ = np.linalg.svd(rows)
    least = singular[-1] if len(singular) == len(rows) else 0.0
    largest = max(singular[0], 1.0)  # of a single constraint the least is the largest one here
    condition = float((largest / least) ** 2) if least > 0 else float("inf")
    return condition, assembly.names[int(np.argmax(np.abs(left[:, -1])))]


def distance_from_singularity(
    module: GeneratedModule, params: Sequence[float], y: Sequence[float], t: float
) -> float:
    """The smallest singular value of constraints of the size 1: in proportion to the distance."""
    condition, _ = condition_of_constraints(module, params, y, t)
    return condition**-0.5 if condition else float("inf")


def _spread(assembly: Assembly, y: Array) -> Array:
    """How far generic states are from a state: an angle, or as far as the largest coordinate.

    A parameter may be longer than all parts, so that gradients of squares are larger there.
    """
    units = [assembly.module.UNITS[name] for name in assembly.module.COORDINATES]
    largest: dict[str, float] = {}
    for unit, value in zip(units, np.abs(y).tolist(), strict=False):
        largest[unit] = max(largest.get(unit, 0.0), value)
    of = [1.0 if unit == "rad" else largest[unit] or np.inf for unit in units]
    return np.minimum(assembly.scales, of)


class MassMatrixWarning(UserWarning):
    """The mass matrix is nearly singular: digits are lost."""


#: Motions of many whose mass matrices are examined.
EXAMINED = 4

_IS_CHECKED = ContextVar("mass matrices are checked", default=False)


@contextmanager
def checked_before() -> Iterator[None]:
    """Examine no mass matrix in a ``with`` block, in this thread: the caller has done so.

    Yields
    ------
    None
    """
    token = _IS_CHECKED.set(True)
    try:
        yield
    finally:
        _IS_CHECKED.reset(token)


def examined(motions: int) -> list[int]:
    """The motions to examine of so many: evenly distributed, with the first and the last."""
    indices = np.linspace(0, motions - 1, EXAMINED).astype(int)
    return np.unique(indices).tolist() if motions else []


def check_condition(module: GeneratedModule, motions: Iterable[Motion], t: float = 0.0) -> None:
    """Refuse a nearly singular mass matrix, or warn; coordinates without inertia are permitted.

    Besides the initial state, all coordinates are equal, as in aligned rods, unless the matrix is
    singular there whatever the masses, as at the pole of a sphere.
    """
    if _IS_CHECKED.get() or not has_function(module, "mass_matrix"):
        return
    size = len(module.STATE)  # without perturbations
    motions = [(name, params, y0 and y0[:size]) for name, params, y0 in motions]
    if has_constraints(module):
        check_constraints(module, motions, t)
    motion, worst, weakest = max(
        ((name, *_worst(module, t, y0, params)) for name, params, y0 in motions),
        key=lambda row: row[1],
        default=("", 0.0, ""),  # without motions
    )
    text = (
        f"{motion}the mass matrix has condition {worst:.0e}: {weakest} has hardly any inertia of "
        "its own"
    )
    if worst >= SINGULAR:
        way_out = "leave that coordinate out, or make masses more similar"
        if has_function(module, "angular_momentum"):  # of bodies in space
            way_out = (
                "if axes of rotation coincide there (gimbal lock), give the orientation by a "
                f"quaternion or by another sequence of rotations; otherwise {way_out}"
            )
        raise ValueError(f"{text}; {way_out}")
    if worst >= DOUBTFUL:
        lost = f"about {np.log10(worst):.0f} digits are lost"
        warn_caller(f"{text}; {lost}", MassMatrixWarning)


def _worst(
    module: GeneratedModule, t: float, y0: Sequence[float] | None, params: Sequence[float]
) -> tuple[float, str]:
    """The largest condition of a motion, and the coordinate of least inertia there."""
    n = len(module.COORDINATES)
    aligned = [0.0 if y0 is None else y0[0]] * n + [0.0] * n
    worst, weakest = (0.0, "") if y0 is None else _condition(module, t, y0, params)
    condition, coordinate = _condition(module, t, aligned, params)
    is_worse = condition > max(worst, DOUBTFUL)
    if is_worse and _condition(module, t, aligned, module.DEFAULTS)[0] < DOUBTFUL:
        return condition, coordinate
    return worst, weakest


def inertia(
    module: GeneratedModule, t: float, y: Sequence[float], params: Sequence[float]
) -> NDArray[np.float64]:
    """The mass matrix, with the inertia that constraints add where it is singular by design."""
    matrix = function(module, "mass_matrix")
    M = np.array(matrix(t, y, params))
    if has_function(module, "constraints_jacobian"):
        usual = np.array(matrix(t, y, module.DEFAULTS))
        derivatives = np.array(function(module, "constraints_jacobian")(t, y, params))
        G = derivatives[position_constraints(module) :, len(module.COORDINATES) :]
        if np.linalg.matrix_rank(usual) < len(usual) and G.any():
            # constraints prevent motions that move no mass, such as of a quaternion's norm
            M = M + G.T @ G * (np.trace(M) / np.sum(G**2))
    return M


def _condition(
    module: GeneratedModule, t: float, y: Sequence[float], params: Sequence[float]
) -> tuple[float, str]:
    """The condition, whatever the units of coordinates, and the coordinate of least inertia."""
    try:
        M = inertia(module, t, y, params)
    except (ArithmeticError, ValueError):  # where a formula has no value
        return 0.0, ""
    inertial = np.flatnonzero(np.diag(M))
    if not inertial.size or not np.isfinite(M).all():
        return 0.0, ""
    size = np.sqrt(np.abs(np.diag(M)[inertial]))
    values, vectors = np.linalg.eigh(M[np.ix_(inertial, inertial)] / np.outer(size, size))
    condition = float(values[-1] / values[0]) if values[0] > 0 else float("inf")
    return condition, module.COORDINATES[inertial[np.argmax(np.abs(vectors[:, 0]))]]
