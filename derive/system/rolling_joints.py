"""Joints of wheels and other bodies that roll without slip on a line or on a plane."""

from collections.abc import Sequence

import sympy as sp

from derive.system.constraints import Constraint, Point
from derive.system.joint import canonical, components, constraint_rows, unit_vector
from derive.system.orientation import Orientation
from derive.system.parts import SystemDefinitionError, formula
from derive.system.symbols import TIME, velocity
from solvers.io.suggestion import shortened


def rolling_on_line(
    name: str,
    centre: Point,
    radius: sp.Expr,
    angle: sp.Expr,
    through: Point = (sp.S.Zero, sp.S.Zero),
    direction: Point = (sp.S.One, sp.S.Zero),
) -> list[Constraint]:
    """A wheel that rolls on a straight line, on the left of its direction, without slip.

    Parameters
    ----------
    name : str
        Name of the contact.
    centre : sequence of sympy.Expr
        The centre of the wheel, of two components.
    radius, angle : sympy.Expr
        Its radius in m, and its orientation in rad, counterclockwise as that of a `RigidBody`; the
        angle is 0 where the wheel is above `through`.
    through, direction : sequence of sympy.Expr, optional
        A point of the line, and the line's direction, by default those of the horizontal axis.

    Returns
    -------
    list of Constraint
        Their multipliers ``name_along`` and ``name_across`` are friction and normal force.

    Raises
    ------
    SystemDefinitionError
        When a point does not have two components, or the direction is 0.

    Examples
    --------
    >>> from sympy import symbols
    >>> x, y, phi = symbols("x y phi", real=True)
    >>> R = symbols("R", positive=True)
    >>> [one.formula for one in rolling_on_line("ground", (x, y), R, phi)]
    [R*phi + x, -R + y]
    """
    (px, py), (cx, cy) = components(name, centre, 2), components(name, through, 2)
    dx, dy = unit_vector(name, direction)
    along = dx * (px - cx) + dy * (py - cy) + formula(radius) * formula(angle)
    across = dx * (py - cy) - dy * (px - cx) - formula(radius)
    rows = (("along", along, "friction on the wheel, along the line"),
        ("across", across, "normal force on the wheel"))  # fmt: skip
    return [*constraint_rows(name, rows)]


def rolling_on_plane(
    name: str,
    coordinates: Sequence[sp.Symbol],
    centre: Point,
    arm: Point,
    orientation: Orientation,
) -> list[Constraint]:
    """A body that rolls on the horizontal plane through the origin without slip.

    Parameters
    ----------
    name : str
        Name of the contact.
    coordinates : sequence of sympy.Symbol
        The coordinates on which the motion of the body depends.
    centre, arm : sequence of sympy.Expr
        A point of the body, and the vector from it to the point of contact, of three components
        each: (0, 0, -R) from the centre of a sphere.
    orientation : Orientation
        The orientation of the body, such as that of `rotations`.

    Returns
    -------
    list of Constraint
        Two constraints of velocities, whose multipliers ``name_x`` and ``name_y`` are the friction
        on the body, and one of position, whose multiplier ``name_z`` is the normal force.

    Raises
    ------
    SystemDefinitionError
        When a point does not have three components, or `orientation` is not one in space.

    Examples
    --------
    >>> from sympy import symbols
    >>> from derive import rotations
    >>> x, y, psi, phi = symbols("x y psi phi", real=True)
    >>> R = symbols("R", positive=True)
    >>> axes = rotations("zy", (psi, phi))  # of an upright wheel: heading and spin
    >>> wheel = rolling_on_plane("ground", (x, y, psi, phi), (x, y, R), (0, 0, -R), axes)
    >>> [one.formula for one in wheel]
    [-R*phi_dot*cos(psi) + x_dot, -R*phi_dot*sin(psi) + y_dot]
    """
    place, lever = components(name, centre, 3), sp.Matrix(components(name, arm, 3))
    if not isinstance(orientation, Orientation):
        raise SystemDefinitionError(
            f"the orientation of {name} is {shortened(orientation)}: give that of rotations, "
            "rotation_matrix or quaternion"
        )

    def rate(expression: sp.Expr) -> sp.Expr:
        terms = (expression.diff(q) * velocity(q) for q in coordinates)
        return sp.Add(*terms, expression.diff(TIME))

    # the turn of the body moves the point of contact by ω × arm = Ṙ Rᵀ arm
    matrix = orientation.matrix
    turned = matrix.applyfunc(rate) * matrix.T * lever
    slips = [rate(r) + canonical(turn) for r, turn in zip(place, turned, strict=True)]
    rows = [(axis, slips[k], f"friction on the body along {axis}") for k, axis in enumerate("xy")]
    height = ("z", canonical(place[2] + lever[2]), "normal force on the body")
    return [*constraint_rows(name, [*rows, height])]
