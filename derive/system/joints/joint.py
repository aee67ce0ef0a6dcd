"""Rows of joints: constraints whose multipliers are forces, and points and directions."""

from collections.abc import Iterable, Iterator

import sympy as sp

from derive.formulas.budget import is_expandable
from derive.system.constraints import AXES, Constraint, Point
from derive.system.parts import SystemDefinitionError, formulas

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
