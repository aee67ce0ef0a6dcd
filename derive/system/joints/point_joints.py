"""Joints of points: constraints of points, with the forces of the joint as multipliers.

Every joint is a list of constraints for ``System(constraints=[*pin("A", p, q), ...])``. Points are
sequences of components in m, functions of coordinates, parameters and ``derive.TIME``. Constraints
that hold identically, such as that of a point on a rail whose height is 0, are left out.
"""

import sympy as sp

from derive.system.constraints import Constraint, Point
from derive.system.joints.joint import coincidence, components, constraint_rows, unit_vector
from derive.system.parts import SystemDefinitionError, formula


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
    return [*coincidence(name, p, q, 2)]


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
    return [*coincidence(name, p, q, 3)]


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
    (px, py), (cx, cy) = components(name, p, 2), components(name, through, 2)
    dx, dy = unit_vector(name, direction)
    across = dx * (py - cy) - dy * (px - cx)
    meaning = "force across the line, positive to the left of its direction"
    return [*constraint_rows(name, [("", across, meaning)])]


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
    pairs = zip(components(name, p, size), components(name, q, size), strict=True)
    if length.is_positive is False:
        raise SystemDefinitionError(f"the length of {name} is {length}: give a positive one")
    square = sp.Add(*((a - b) ** 2 for a, b in pairs))
    meaning = "tension, positive where the rod pulls"
    return [*constraint_rows(name, [("", (length**2 - square) / (2 * length), meaning)])]
