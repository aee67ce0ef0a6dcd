"""Joints as shorthand: constraints of points, with the forces of the joint as multipliers.

Every joint is a list of constraints for ``System(constraints=[*pin("A", p, q), ...])``. Points are
sequences of components in m, functions of coordinates, parameters and ``derive.TIME``. Constraints
that hold identically, such as that of a point on a rail whose height is 0, are left out.
"""

from collections.abc import Iterable, Iterator, Sequence

import sympy as sp

from derive.formulas.expansion import is_expandable
from derive.system.constraints import AXES, Constraint, Point
from derive.system.orientation import Orientation
from derive.system.parts import SystemDefinitionError, formula, formulas
from derive.system.symbols import TIME, velocity
from solvers.io.suggestion import shortened

#: Terms of the largest expression that is expanded.
MOST_TERMS = 1000
#: Rows of formulas and meanings, by the ends of the names of their multipliers.
Rows = Iterable[tuple[str, sp.Expr, str]]


def pin(name: str, p: Point, q: Point) -> list[Constraint]:
    """A pin in the plane: two points remain together.

    Parameters
    ----------
    name : str
        Name of the pin.
    p, q : sequence of sympy.Expr
        The points, of two components each.

    Returns
    -------
    list of Constraint
        Their multipliers ``name_x`` and ``name_y`` are the force on p.

    Raises
    ------
    SystemDefinitionError
        When a point does not have two components.

    Examples
    --------
    >>> from sympy import cos, sin, symbols
    >>> x, y, theta = symbols("x y theta", real=True)
    >>> l = symbols("l", positive=True)
    >>> [one.name for one in pin("A", (x, y), (l * sin(theta), -l * cos(theta)))]
    ['A_x', 'A_y']
    """
    return _coincidence(name, p, q, 2)


def ball(name: str, p: Point, q: Point) -> list[Constraint]:
    """A ball-and-socket joint in space: two points remain together.

    Parameters
    ----------
    name : str
        Name of the joint.
    p, q : sequence of sympy.Expr
        The points, of three components each.

    Returns
    -------
    list of Constraint
        Their multipliers ``name_x``, ``name_y`` and ``name_z`` are the force on p.

    Raises
    ------
    SystemDefinitionError
        When a point does not have three components.

    Examples
    --------
    >>> from sympy import symbols
    >>> x, y, z = symbols("x y z", real=True)
    >>> ball("socket", (x, y, z), (0, 0, 1))[2].formula
    z - 1
    """
    return _coincidence(name, p, q, 3)


def slider(name: str, p: Point, through: Point, direction: Point) -> list[Constraint]:
    """A slider: a point remains on a straight line, which may move.

    Parameters
    ----------
    name : str
        Name of the slider.
    p : sequence of sympy.Expr
        The point, of two components.
    through, direction : sequence of sympy.Expr
        A point of the line, and the line's direction, of any length.

    Returns
    -------
    list of Constraint
        Its multiplier is the force on p across the line, to the left of the direction.

    Raises
    ------
    SystemDefinitionError
        When a point does not have two components, or the direction is 0.

    Examples
    --------
    >>> from sympy import symbols
    >>> x, y = symbols("x y", real=True)
    >>> [one.formula for one in slider("rail", (x, y), (0, 1), (2, 0))]
    [y - 1]
    """
    (px, py), (cx, cy) = _point(name, p, 2), _point(name, through, 2)
    dx, dy = _unit(name, direction)
    across = dx * (py - cy) - dy * (px - cx)
    meaning = "force across the line, positive to the left of its direction"
    return [*_constraints(name, [("", across, meaning)])]


def fixed_distance(name: str, p: Point, q: Point, length: sp.Expr) -> list[Constraint]:
    """A rod without mass: two points remain at a distance.

    Parameters
    ----------
    name : str
        Name of the rod.
    p, q : sequence of sympy.Expr
        Its ends, of two or three components each.
    length : sympy.Expr
        Their distance, such as a positive parameter.

    Returns
    -------
    list of Constraint
        Its multiplier is the tension of the rod, positive where it pulls.

    Raises
    ------
    SystemDefinitionError
        When the points do not have two or three components each, or the length can be negative
        or 0.

    Examples
    --------
    >>> from sympy import symbols
    >>> x, y = symbols("x y", real=True)
    >>> l = symbols("l", positive=True)
    >>> fixed_distance("rod", (x, y), (0, 0), l)[0].formula
    (l**2 - x**2 - y**2)/(2*l)
    """
    size, length = len(tuple(p)), formula(length)
    pairs = zip(_point(name, p, size), _point(name, q, size), strict=True)
    if length.is_positive is False:
        raise SystemDefinitionError(f"the length of {name} is {length}: give a positive one")
    square = sp.Add(*((a - b) ** 2 for a, b in pairs))
    meaning = "tension, positive where the rod pulls"
    return [*_constraints(name, [("", (length**2 - square) / (2 * length), meaning)])]


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
    (px, py), (cx, cy) = _point(name, centre, 2), _point(name, through, 2)
    dx, dy = _unit(name, direction)
    along = dx * (px - cx) + dy * (py - cy) + formula(radius) * formula(angle)
    across = dx * (py - cy) - dy * (px - cx) - formula(radius)
    rows = (("along", along, "friction on the wheel, along the line"),
        ("across", across, "normal force on the wheel"))  # fmt: skip
    return [*_constraints(name, rows)]


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
    place, lever = _point(name, centre, 3), sp.Matrix(_point(name, arm, 3))
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
    slips = [rate(r) + _shortened(turn) for r, turn in zip(place, turned, strict=True)]
    rows = [(axis, slips[k], f"friction on the body along {axis}") for k, axis in enumerate("xy")]
    height = ("z", _shortened(place[2] + lever[2]), "normal force on the body")
    return [*_constraints(name, [*rows, height])]


def _coincidence(name: str, p: Point, q: Point, size: int) -> list[Constraint]:
    first, second = _point(name, p, size), _point(name, q, size)
    rows = zip(AXES[size], first, second, strict=True)
    meaning = f"force of {name} on the first point, along"
    return [*_constraints(name, ((axis, a - b, f"{meaning} {axis}") for axis, a, b in rows))]


def _constraints(name: str, rows: Rows) -> Iterator[Constraint]:
    """Constraints with forces in N as multipliers, without those that hold identically."""
    for end, value, meaning in rows:
        if value != 0:
            yield Constraint(value, f"{name}_{end}" if end else name, "N", meaning)


def _point(name: str, point: Point, size: int) -> tuple[sp.Expr, ...]:
    values = formulas(name, point, f"points of {size} components")
    if len(values) != size or size not in AXES:
        raise SystemDefinitionError(
            f"joint {name} has a point of {len(values)} components: give {size} for each; a pin is "
            "in the plane, a ball in space"
        )
    return values


def _unit(name: str, direction: Point) -> tuple[sp.Expr, sp.Expr]:
    x, y = _point(name, direction, 2)
    length = sp.sqrt(_shortened(x**2 + y**2))
    if length == 0:
        raise SystemDefinitionError(f"the direction of {name} is 0: give the direction of a line")
    return x / length, y / length


def _shortened(expression: sp.Expr) -> sp.Expr:
    """A polynomial in sines and cosines without squares of cosines, in which terms cancel.

    A long expression, such as that of a wheel that is steered and leans, remains as it is.
    """
    if not is_expandable(expression, largest=MOST_TERMS):
        return expression
    expression = sp.expand(expression)
    for wave in sorted(expression.atoms(sp.cos), key=sp.default_sort_key):
        square = 1 - sp.sin(wave.args[0]) ** 2
        powers = [one for one in expression.atoms(sp.Pow) if one.base == wave and _is_square(one)]
        values = {power: wave ** (power.exp % 2) * square ** (power.exp // 2) for power in powers}
        expression = sp.expand(expression.xreplace(values))
    return expression


def _is_square(power: sp.Pow) -> bool:
    return bool(power.exp.is_Integer and power.exp > 1)
