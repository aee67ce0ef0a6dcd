"""Joints of points: constraints of points, with the forces of the joint as multipliers.

Every joint is a list of constraints for ``System(constraints=[*pin("A", p, q), ...])``. Points are
sequences of components in m, functions of coordinates, parameters and ``derive.TIME``. Constraints
that hold identically, such as that of a point on a rail whose height is 0, are left out.
"""

from collections.abc import Iterable, Iterator

import sympy as sp

from derive.formulas.budget import is_expandable
from derive.system.constraints import AXES, Constraint, Point
from derive.system.parts import SystemDefinitionError, formula, formulas

#: Terms of the largest expression that is expanded.
MOST_TERMS = 1000
#: Rows of formulas and meanings, by the ends of the names of their multipliers.
Rows = Iterable[tuple[str, sp.Expr, str]]


def constraint_rows(name: str, rows: Rows, unit: str = "N") -> Iterator[Constraint]:
    """Constraints with multipliers of a unit, without those that hold identically."""
    for end, value, meaning in rows:
        if value != 0:
            yield Constraint(value, f"{name}_{end}" if end else name, unit, meaning)


def coincidence(name: str, p: Point, q: Point, size: int) -> Iterator[Constraint]:
    """Two points of as many components as `size` remain together."""
    first, second = components(name, p, size), components(name, q, size)
    rows = zip(AXES[size], first, second, strict=True)
    meaning = f"force of {name} on the first point, along"
    return constraint_rows(name, ((axis, a - b, f"{meaning} {axis}") for axis, a, b in rows))


def components(name: str, point: Point, size: int) -> tuple[sp.Expr, ...]:
    """The components of a point, refused unless there are as many as `size`."""
    values = formulas(name, point, f"points of {size} components")
    if len(values) != size or size not in AXES:
        raise SystemDefinitionError(
            f"joint {name} has a point of {len(values)} components: give {size} for each; a pin is "
            "in the plane, a ball in space"
        )
    return values


def unit_vector(name: str, direction: Point) -> tuple[sp.Expr, sp.Expr]:
    """The unit vector of a direction in the plane."""
    x, y = components(name, direction, 2)
    length = sp.sqrt(canonical(x**2 + y**2))
    if length == 0:
        raise SystemDefinitionError(f"the direction of {name} is 0: give the direction of a line")
    return x / length, y / length


def canonical(expression: sp.Expr) -> sp.Expr:
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
