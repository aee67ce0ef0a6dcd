"""Joints of wheels and spheres that roll without slip on a line or on a plane."""

from collections.abc import Sequence

import sympy as sp

from derive.formulas.functions import derivative
from derive.system.constraints import Constraint, Point
from derive.system.joints.point_joints import canonical, components, constraint_rows, unit_vector
from derive.system.orientation import AXES, Orientation
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
    radius: sp.Expr,
    orientation: Orientation,
    axle: str = "",
) -> list[Constraint]:
    """A wheel or a sphere that rolls on the horizontal plane through the origin without slip.

    The point of contact is the lowest one of the wheel, which may lean and be steered.

    Parameters
    ----------
    name : str
        Name of the contact.
    coordinates : sequence of sympy.Symbol
        The coordinates on which the motion of the body depends.
    centre : sequence of sympy.Expr
        The centre, of three components.
    radius : sympy.Expr
        The radius in m.
    orientation : Orientation
        The orientation of the body, such as that of `rotations`.
    axle : str, optional
        The axis of the body that is a wheel's axle, ``"x"``, ``"y"`` or ``"z"``; without it the
        body is a sphere.

    Returns
    -------
    list of Constraint
        Two constraints of velocities, whose multipliers ``name_along`` and ``name_across`` are the
        friction on the body, and one of position, whose multiplier ``name_normal`` is the normal
        force. With the axle to the left, a wheel rolls forward along its path. Of a sphere the
        directions are those of the first and second axis of space.

    Raises
    ------
    SystemDefinitionError
        When the centre does not have three components, `orientation` is not one in space, or the
        axle is no axis of the body, or vertical.

    Examples
    --------
    >>> from sympy import symbols
    >>> from derive import rotations
    >>> x, y, psi, phi = symbols("x y psi phi", real=True)
    >>> R = symbols("R", positive=True)
    >>> upright = rotations("zy", (psi, phi))  # heading and spin
    >>> wheel = rolling_on_plane("ground", (x, y, psi, phi), (x, y, R), R, upright, "y")
    >>> [one.formula for one in wheel]
    [-R*phi_dot + x_dot*cos(psi) + y_dot*sin(psi), -x_dot*sin(psi) + y_dot*cos(psi)]
    """
    x, y, z = components(name, centre, 3)
    radius = formula(radius)
    if not isinstance(orientation, Orientation):
        raise SystemDefinitionError(
            f"the orientation of {name} is {shortened(orientation)}: give that of rotations, "
            "rotation_matrix or quaternion"
        )
    if axle not in ("", *AXES):
        raise SystemDefinitionError(
            f"the axle of {name} is {shortened(axle)}: give the letter x, y or z of an axis of the "
            "body, or none of a sphere"
        )
    rates = {TIME: sp.S.One} | {q: velocity(q) for q in coordinates}

    def rate(expression: sp.Expr) -> sp.Expr:
        return sp.Add(*(derivative(expression, s) * rate for s, rate in rates.items()))

    turning = sp.zeros(3, 1)  # the angular velocity in axes of the body
    for s, speed in rates.items():
        turning += sp.Matrix(orientation.turn(s)) * speed
    if axle:  # the unit vector a along it moves by ω × a
        a, spin = orientation.matrix.col(AXES.index(axle)), turning[AXES.index(axle)]
        tilting = rate(a[2])
    else:
        a, (tilting, spin, _) = sp.Matrix([0, 1, 0]), orientation.matrix * turning
    level = _complement(a[2])
    if level == 0:
        raise SystemDefinitionError(f"the axle of {name} is vertical: give one that is not")
    # the arm from centre to contact is across a: ω × arm is radius (-spin, tilting) along, across
    along, across = ((p / level, r / level) for p, r in ((a[1], -a[0]), (a[0], a[1])))
    rows = (
        ("along", (*along, -radius * spin), "friction on the body, along its path"),
        ("across", (*across, radius * tilting), "friction on the body, to the left of its path"),
    )
    slips = [(end, canonical(rate(x) * p + rate(y) * r + turned), meaning)
             for end, (p, r, turned), meaning in rows]  # fmt: skip
    height = ("normal", canonical(z - radius * level), "normal force on the body")
    return [*constraint_rows(name, [*slips, height])]


def _complement(sine: sp.Expr) -> sp.Expr:
    """The cosine of a lean with this sine, positive unless the lean is a coordinate itself."""
    for wave in (sine, -sine):
        if isinstance(wave, sp.sin):
            return sp.cos(wave.args[0])
    return sp.sqrt(1 - sine**2)
