"""Orientations of a rigid body in space: sequences of rotations, matrices, unit quaternions.

The columns of a rotation matrix R are the body's axes in space: R s has the components in space
of a vector with the components s in body axes. The body's angular velocity is linear in rates of
change: ω = Σ c_k ḟ_k, in body axes, with functions f_k of the coordinates (E. T. Whittaker, A
Treatise on the Analytical Dynamics of Particles and Rigid Bodies, chapter I).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Self, TypeAlias

import sympy as sp

from derive.formulas.functions import derivative
from derive.formulas.zero import vanishes
from derive.system.parts import SystemDefinitionError, formula, formulas, items
from solvers.io.suggestion import shortened

Vector: TypeAlias = tuple[sp.Expr, ...]
AXES = "xyz"


@dataclass(frozen=True)
class Orientation:
    """The orientation of a body in space; `rotations`, `rotation_matrix` or `quaternion` give one.

    Parameters
    ----------
    rows : tuple of tuples of sympy.Expr
        The rotation matrix R, whose columns are the body's axes in space.
    turning : tuple of pairs of sympy.Expr and tuple of sympy.Expr
        Functions f and vectors c of the angular velocity Σ c ḟ in body axes.
    conditions : tuple of sympy.Expr
        Functions that remain 0, such as that of a quaternion's norm.
    words : str
        A description of one line.
    quaternion : tuple of sympy.Symbol, optional
        The four coordinates of a unit quaternion.
    has_points : bool, optional
        Whether a body's energy is that of points on its axes, not that of its angular velocity:
        it is the shorter one if entries of the matrix are coordinates.

    Examples
    --------
    >>> from sympy import Symbol
    >>> from derive import rotations
    >>> theta = Symbol("theta", real=True)
    >>> rotations("x", [theta]).turned((0, 0, 1))
    (0, -sin(theta), cos(theta))
    """

    rows: tuple[Vector, ...]
    turning: tuple[tuple[sp.Expr, Vector], ...]
    conditions: tuple[sp.Expr, ...]
    words: str
    quaternion: tuple[sp.Symbol, ...] = ()
    has_points: bool = False

    @property
    def matrix(self) -> sp.ImmutableDenseMatrix:
        """The rotation matrix R."""
        return sp.ImmutableDenseMatrix(self.rows)

    def turned(self, vector: Sequence[sp.Expr | float]) -> Vector:
        """Components in space of a vector with these components in body axes."""
        components = formulas("vector", vector, "three components in body axes")
        if len(components) != len(AXES):
            raise SystemDefinitionError(
                f"vector {shortened(vector)} has {len(components)} components: give three in body "
                "axes"
            )
        return tuple(dot(row, components) for row in self.rows)

    def turn(self, variable: sp.Symbol) -> Vector:
        """The angular velocity in body axes for each unit of the variable's rate."""
        slopes = [(derivative(f, variable), vector) for f, vector in self.turning]
        used = [(slope, vector) for slope, vector in slopes if slope != 0]
        return tuple(sp.Add(*(slope * vector[k] for slope, vector in used)) for k in range(3))

    def mapped(self, function: Callable[[sp.Expr], sp.Expr]) -> Self:
        """A copy with `function` applied to every expression."""

        def each(vector: Vector) -> Vector:
            return tuple(map(function, vector))

        turning = tuple((function(f), each(vector)) for f, vector in self.turning)
        conditions = tuple(value for value in each(self.conditions) if not _is_zero(value))
        is_same = each(self.quaternion) == self.quaternion
        return replace(
            self,
            rows=tuple(map(each, self.rows)),
            turning=turning,
            conditions=conditions,
            quaternion=self.quaternion if is_same else (),  # now functions of other coordinates
        )


def rotations(axes: str, angles: Sequence[sp.Expr | float]) -> Orientation:
    """The orientation after rotations about the body's own axes, one after the other.

    Parameters
    ----------
    axes : str
        The axis of each rotation, such as ``"zxz"`` for Euler's angles: precession, nutation and
        spin. Each axis has been turned by the rotations before it; SciPy's ``Rotation`` writes
        such intrinsic sequences in capitals.
    angles : sequence of sympy.Expr or numbers
        The angle of each rotation in rad.

    Returns
    -------
    Orientation

    Raises
    ------
    SystemDefinitionError
        When an axis is not x, y or z, or there is not one angle for each.

    Examples
    --------
    >>> from sympy import symbols
    >>> from derive import rotations
    >>> phi, theta, psi = symbols("phi theta psi", real=True)
    >>> rotations("zxz", (phi, theta, psi)).turn(phi)  # angular velocity for each unit of phi_dot
    (sin(psi)*sin(theta), sin(theta)*cos(psi), cos(theta))
    """
    if not isinstance(axes, str) or not axes or {*axes} - {*AXES}:
        raise SystemDefinitionError(
            f"axes = {shortened(axes)} is no sequence of rotations: give the letters x, y and z of "
            "the body's own axes, such as 'zxz' for Euler's angles"
        )
    values = formulas("angles", angles, "one angle for each axis")
    if len(values) != len(axes):
        raise SystemDefinitionError(
            f"angles {shortened(angles)} are {len(values)}, but the sequence {axes!r} has "
            f"{len(axes)} axes: give one angle for each"
        )
    matrix, turning = sp.eye(3), list[tuple[sp.Expr, Vector]]()
    for axis, angle in reversed([*zip(axes, values, strict=True)]):
        row = AXES.index(axis)
        turning.append((angle, tuple(matrix[row, :])))  # the axis after the later rotations
        matrix = _rotation(row, angle) * matrix
    words = f"rotations {axes} by {', '.join(map(str, values))}"
    return Orientation(_rows(matrix), tuple(turning), (), words)


def rotation_matrix(rows: Sequence[Sequence[sp.Expr | float]]) -> Orientation:
    """The orientation with a rotation matrix, whose columns are the body's axes in space.

    Parameters
    ----------
    rows : sequence of sequences of sympy.Expr or numbers
        Three rows of three functions of the coordinates. They may be nine coordinates: the
        conditions RᵀR = 1 that do not hold by themselves become constraints.

    Returns
    -------
    Orientation

    Raises
    ------
    SystemDefinitionError
        When there are not three rows of three formulas.

    Examples
    --------
    >>> from sympy import Matrix, cos, sin, symbols
    >>> from derive import rotation_matrix
    >>> theta = symbols("theta", real=True)
    >>> turned = rotation_matrix([(1, 0, 0), (0, cos(theta), -sin(theta)),
    ...                           (0, sin(theta), cos(theta))])
    >>> turned.conditions
    ()
    >>> len(rotation_matrix(Matrix(3, 3, symbols("a:i", real=True)).tolist()).conditions)
    6
    """
    given = [formulas("a row of the matrix", row, "three formulas")
             for row in items("rotation_matrix", rows, "three rows of three formulas")]  # fmt: skip
    if [len(row) for row in given] != [3, 3, 3]:
        raise SystemDefinitionError(
            f"rotation matrix {shortened(rows)} has not three rows of three formulas"
        )
    columns = [*zip(*given, strict=True)]
    products = {
        (i, j): dot(columns[i], columns[j]) - int(i == j) for i in range(3) for j in range(i, 3)
    }
    conditions = tuple(
        sp.Rational(1, 1 + (i == j)) * value
        for (i, j), value in products.items()
        if not _is_zero(value)
    )
    turning: list[tuple[sp.Expr, Vector]] = []
    for row in given:  # ω_a is half of Σ R_ic dR_ib - R_ib dR_ic, with (a, b, c) in order
        for b, entry in enumerate(row):
            vector = [sp.S.Zero] * 3
            vector[(b + 2) % 3], vector[(b + 1) % 3] = row[(b + 1) % 3] / 2, -row[(b + 2) % 3] / 2
            turning.append((entry, tuple(vector)))
    words = f"axes in columns of {[list(row) for row in given]}"
    return Orientation(tuple(given), tuple(turning), conditions, words, has_points=True)


def quaternion(w: sp.Symbol, x: sp.Symbol, y: sp.Symbol, z: sp.Symbol) -> Orientation:
    """The orientation by a unit quaternion of four coordinates.

    The norm is a constraint of the system: no orientation is singular, and the equations are
    polynomials. A turn by an angle a about a unit vector e is (cos a/2, sin a/2 e).

    Parameters
    ----------
    w, x, y, z : sympy.Symbol
        Coordinates: the real part, and the imaginary parts.

    Returns
    -------
    Orientation

    Raises
    ------
    SystemDefinitionError
        When these are not four symbols.

    Examples
    --------
    >>> from sympy import symbols
    >>> from derive import quaternion
    >>> w, x, y, z = symbols("w x y z", real=True)
    >>> quaternion(w, x, y, z).turn(w)
    (-2*x, -2*y, -2*z)
    """
    parts = (w, x, y, z)
    if len({*parts}) != 4 or not all(isinstance(part, sp.Symbol) for part in parts):
        raise SystemDefinitionError(
            f"quaternion {shortened(parts)} is not four coordinates: give four symbols"
        )
    rows = (
        (w**2 + x**2 - y**2 - z**2, 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), w**2 - x**2 + y**2 - z**2, 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), w**2 - x**2 - y**2 + z**2),
    )
    turning = (
        (w, (-2 * x, -2 * y, -2 * z)),
        (x, (2 * w, -2 * z, 2 * y)),
        (y, (2 * z, 2 * w, -2 * x)),
        (z, (-2 * y, 2 * x, 2 * w)),
    )
    norm = (sp.Add(*(part**2 for part in parts)) - 1) / 2
    words = f"unit quaternion {', '.join(map(str, parts))}"
    return Orientation(rows, turning, (norm,), words, parts)


def _rotation(axis: int, angle: sp.Expr) -> sp.Matrix:
    """The matrix of a rotation by an angle about an axis."""
    matrix = sp.eye(3)
    j, k = (axis + 1) % 3, (axis + 2) % 3
    matrix[j, j] = matrix[k, k] = sp.cos(angle)
    matrix[k, j] = sp.sin(angle)
    matrix[j, k] = -matrix[k, j]
    return matrix


def _rows(matrix: sp.Matrix) -> tuple[Vector, ...]:
    return tuple(tuple(matrix[i, :]) for i in range(matrix.rows))


def dot(a: Sequence[sp.Expr | int], b: Sequence[sp.Expr]) -> sp.Expr:
    """The product of two vectors."""
    return sp.Add(*(x * y for x, y in zip(a, b, strict=True)))


def _is_zero(value: sp.Expr) -> bool:
    try:
        return vanishes(formula(value))
    except NotImplementedError:
        return False
