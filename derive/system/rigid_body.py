"""Rigid bodies in the plane and in space."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Self

import sympy as sp

from derive.system.orientation import Orientation
from derive.system.parts import PointMass, SystemDefinitionError, formula, formulas, items
from solvers.io.suggestion import shortened

Moments = tuple[sp.Expr, ...]
Tensor = tuple[Moments, ...]
AXES = range(3)
#: Of tensors in decimal numbers, relative.
ROUNDING = sp.Float("1e-12")


@dataclass(frozen=True)
class RigidBody(PointMass):
    """A rigid body: mass, centre of mass, inertia about it, and orientation.

    Parameters
    ----------
    mass : sympy.Expr or number
        In kg, a function of parameters.
    position : sequence of sympy.Expr or numbers
        The centre of mass, (x, up) or (x, y, up) in m.
    inertia : sympy.Expr, number, or sequence of these
        About the centre of mass, in kg m². In the plane the moment of inertia: m l²/12 for a
        uniform bar. In space the three principal moments, or the rows of the tensor, in the axes
        that the orientation turns.
    orientation : sympy.Expr, number or Orientation
        In the plane an angle in rad, up to a constant; in space that of `rotations`,
        `rotation_matrix` or `quaternion`.

    Raises
    ------
    SystemDefinitionError
        When the mass is not positive; when a moment of inertia is negative, or larger than the sum
        of both others; when a tensor is not symmetric; when position, inertia and orientation do
        not belong to the same number of dimensions, or a value is neither a real expression nor a
        finite number.

    Examples
    --------
    >>> from sympy import cos, sin, symbols
    >>> from derive import RigidBody, rotations
    >>> m, length, A, C = symbols("m l A C", positive=True)
    >>> theta, phi, psi = symbols("theta phi psi", real=True)
    >>> centre = (length * sin(theta) / 2, -length * cos(theta) / 2)
    >>> RigidBody(m, centre, m * length**2 / 12, theta).inertia  # a bar in the plane
    l**2*m/12
    >>> axes = rotations("zxz", (phi, theta, psi))
    >>> RigidBody(m, axes.turned((0, 0, length)), (A, A, C), axes).inertia  # a top in space
    (A, A, C)
    """

    inertia: sp.Expr | Moments | Tensor
    orientation: sp.Expr | Orientation

    def __post_init__(self) -> None:
        super().__post_init__()
        is_spatial = isinstance(self.orientation, Orientation)
        if len(self.position) != 2 + is_spatial:
            way_out = (
                "give three (x, y, up)" if is_spatial
                else "give two (x, up), or the orientation of a body in space, such as "
                "rotations('zxz', (phi, theta, psi))"
            )  # fmt: skip
            raise SystemDefinitionError(
                f"the position of body {self.mass} has {len(self.position)} components, but its "
                f"orientation is one in {'space' if is_spatial else 'the plane'}: {way_out}"
            )
        if is_spatial:
            object.__setattr__(self, "inertia", _spatial(self.inertia))
        else:
            object.__setattr__(self, "inertia", formula(self.inertia))
            object.__setattr__(self, "orientation", formula(self.orientation))
        moments = (self.inertia,) if not is_spatial else self._diagonal
        for moment in moments:
            if moment.is_negative:
                raise SystemDefinitionError(
                    f"moment of inertia {moment} is negative: give a positive one, or 0"
                )
        if is_spatial:
            _check_triangle(moments)
            _check_tensor(self.tensor)

    @property
    def axes(self) -> Orientation | None:
        """The orientation in space; None in the plane."""
        return self.orientation if isinstance(self.orientation, Orientation) else None

    @property
    def _diagonal(self) -> Moments:
        """The moments of inertia about the body's axes."""
        return tuple(row if isinstance(row, sp.Expr) else row[k]
                     for k, row in enumerate(self.inertia))  # fmt: skip

    @property
    def _products(self) -> dict[tuple[int, int], sp.Expr]:
        """Entries of the tensor off the diagonal that are not 0."""
        rows = self.inertia if isinstance(self.inertia[0], tuple) else ()
        return {(i, j): rows[i][j] for i, j in combinations(AXES, 2) if rows and rows[i][j] != 0}

    @property
    def tensor(self) -> sp.ImmutableDenseMatrix:
        """The tensor of inertia in space, about the centre of mass in body axes."""
        tensor = sp.diag(*self._diagonal)
        for (i, j), value in self._products.items():
            tensor[i, j] = tensor[j, i] = value
        return sp.ImmutableDenseMatrix(tensor)

    @property
    def motions(self) -> tuple[tuple[sp.Expr, tuple[sp.Expr, ...]], ...]:
        """The centre of mass; in the plane also the angle, and in space points on the axes.

        With P = tr(J)/2 - J, the energy of rotation is that of masses P_kk at the ends of unit
        vectors along the axes: the body and these points are equimomental.
        """
        if self.axes is None:
            return (*super().motions, (self.inertia, (self.orientation,)))
        if not self.axes.has_points:
            return super().motions
        half = self.tensor.trace() / 2
        points = _squares([half - J for J in self._diagonal], _negative(self._products))
        return (
            *super().motions,
            *(
                (inertia, self.axes.turned(axis))
                for inertia, axes in points.items()
                for axis in axes
            ),
        )

    @property
    def turns(self) -> tuple[tuple[sp.Expr, tuple[tuple[int, ...], ...]], ...]:
        """In space, moments of inertia; axes with equal moments belong together."""
        if self.axes is None or self.axes.has_points:
            return ()
        squares = _squares(self._diagonal, self._products)
        return tuple((moment, tuple(axes)) for moment, axes in squares.items())

    @property
    def placement(self) -> tuple[sp.Expr, ...]:
        """Position, and the angle or the entries of the rotation matrix."""
        if self.axes is None:
            return super().placement
        return (*self.position, *self.axes.matrix)

    @property
    def conditions(self) -> tuple[sp.Expr, ...]:
        """Those of the orientation, such as a quaternion's norm."""
        return self.axes.conditions if self.axes else ()

    @property
    def quaternion(self) -> tuple[sp.Symbol, ...]:
        """The coordinates of a unit quaternion, if they are the orientation; else empty."""
        return self.axes.quaternion if self.axes else ()

    @property
    def moments(self) -> str:
        """The inertia in words."""
        if self.axes is None:
            return f"moment of inertia {self.inertia}"
        if self._products:
            return f"tensor of inertia {self.tensor.tolist()}"
        return f"principal moments {', '.join(map(str, self._diagonal))}"

    @property
    def words(self) -> str:
        """Mass, position, inertia and orientation."""
        orientation = f": {self.axes.words}" if self.axes else f" {self.orientation}"
        return f"{super().words}, {self.moments}, orientation{orientation}"

    def mapped(self, function: Callable[[sp.Expr], sp.Expr]) -> Self:
        """A copy with `function` applied to every expression."""
        if self.axes is None:
            return super().mapped(function)
        tensor = [[function(entry) for entry in row] for row in self.tensor.tolist()]
        return replace(
            self,
            mass=function(self.mass),
            position=tuple(map(function, self.position)),
            inertia=tensor if self._products else [row[k] for k, row in enumerate(tensor)],
            orientation=self.axes.mapped(function),
        )


def _squares(
    diagonal: Sequence[sp.Expr], products: dict[tuple[int, int], sp.Expr]
) -> dict[sp.Expr, list[tuple[int, ...]]]:
    """A quadratic form as a sum of squares: factors, and the combinations that are squared."""
    squares: dict[sp.Expr, list[tuple[int, ...]]] = {}
    for k, factor in enumerate(diagonal):
        others = (-value for pair, value in products.items() if k in pair)
        squares.setdefault(sp.Add(factor, *others), []).append(_unit(k))
    for pair, value in products.items():  # 2 a b = (a + b)² - a² - b²
        squares.setdefault(value, []).append(_unit(*pair))
    squares.pop(sp.S.Zero, None)
    return squares


def _negative(products: dict[tuple[int, int], sp.Expr]) -> dict[tuple[int, int], sp.Expr]:
    return {pair: -value for pair, value in products.items()}


def _spatial(inertia: object) -> Moments | Tensor:
    """Three principal moments, or the rows of a symmetric tensor."""
    contents = "three principal moments, or the three rows of the tensor"
    if isinstance(inertia, sp.MatrixBase):
        inertia = inertia.tolist()
    rows = items("inertia", inertia, contents)
    if all(isinstance(row, Sequence) and not isinstance(row, str) for row in rows):
        tensor = tuple(formulas("inertia", row, contents) for row in rows)
        if [len(row) for row in tensor] != [3, 3, 3]:
            raise SystemDefinitionError(
                f"inertia {shortened(inertia)} is no tensor: give {contents}"
            )
        for i, j in combinations(AXES, 2):
            if tensor[i][j] != tensor[j][i]:
                raise SystemDefinitionError(
                    f"the tensor of inertia is not symmetric: {tensor[i][j]} is not {tensor[j][i]}"
                )
        return tensor
    moments = formulas("inertia", rows, contents)
    if len(moments) != 3:
        raise SystemDefinitionError(
            f"inertia {shortened(inertia)} has {len(moments)}: give {contents}"
        )
    return moments


def _check_triangle(moments: Moments) -> None:
    total = sp.Add(*moments)
    for moment in moments:
        if (total - 2 * moment).is_negative:
            raise SystemDefinitionError(
                f"moment of inertia {moment} is larger than the sum of both others, of "
                f"{', '.join(map(str, moments))}: no body has such moments about its centre of mass"
            )


def _check_tensor(tensor: sp.ImmutableDenseMatrix) -> None:
    """The same for a tensor in numbers: of P = tr(J)/2 - J no eigenvalue is negative."""
    P = tensor.trace() / 2 * sp.eye(3) - tensor
    pairs = (P.extract(pair, pair).det() for pair in map(list, combinations(AXES, 2)))
    for power, value in enumerate((P.trace(), sp.Add(*pairs), P.det()), start=1):
        if value.is_number and value < -ROUNDING * tensor.trace() ** power:
            rows = [[float(f"{float(entry):.6g}") for entry in row] for row in tensor.tolist()]
            raise SystemDefinitionError(
                f"the tensor of inertia {rows} has a principal moment that is negative or larger "
                "than the sum of both others: no body has it about its centre of mass"
            )


def _unit(*axes: int) -> tuple[int, ...]:
    return tuple(int(k in axes) for k in AXES)
