"""Numbers with units from text: ``90 deg``, ``pi/2``, ``-1.5 m/s``.

Text is parsed by rule and never executed: an expression is numbers, ``pi``, ``+ - * / **`` and
brackets, and a unit is a product of names from a table.
"""

import ast
import operator
import re
from collections.abc import Callable
from math import pi

from solvers.io.suggestion import shortened

Dimension = tuple[int, ...]  # powers of m, kg, s, rad

#: Characters of the longest number.
MAX_LENGTH = 100
#: Units by name: the factor to SI units, and powers of m, kg, s, rad.
UNITS: dict[str, tuple[float, Dimension]] = {
    "1": (1.0, (0, 0, 0, 0)),
    "m": (1.0, (1, 0, 0, 0)),
    "cm": (0.01, (1, 0, 0, 0)),
    "mm": (0.001, (1, 0, 0, 0)),
    "km": (1000.0, (1, 0, 0, 0)),
    "kg": (1.0, (0, 1, 0, 0)),
    "g": (0.001, (0, 1, 0, 0)),
    "s": (1.0, (0, 0, 1, 0)),
    "ms": (0.001, (0, 0, 1, 0)),
    "min": (60.0, (0, 0, 1, 0)),
    "rad": (1.0, (0, 0, 0, 1)),
    "deg": (pi / 180, (0, 0, 0, 1)),
    "turn": (2 * pi, (0, 0, 0, 1)),
    "rpm": (2 * pi / 60, (0, 0, -1, 1)),
    "N": (1.0, (1, 1, -2, 0)),
    "J": (1.0, (2, 1, -2, 0)),
}
KNOWN = ", ".join(name for name in UNITS if name != "1")
#: A unit at the end of a text: names with whole powers, joined by * and /.
NAME = r"[A-Za-z]+(?:(?:\^|\*\*)-?\d)?"
UNIT = re.compile(rf"(?<![\w.])((?:1/)?{NAME}(?:[*/]{NAME})*)\Z")
PART = re.compile(r"([*/]?)([A-Za-z]+|1)(?:(?:\^|\*\*)(-?\d))?")
OPERATORS: dict[type[ast.AST], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}


class QuantityError(ValueError):
    """A text is not a number, or its unit has another dimension."""


def quantity(value: object, unit: str) -> float:
    """A finite number in `unit`; a text may end in another unit of the same dimension."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        hint = f'write a number in {unit}, or a text such as "1/2 {unit}"'
        raise QuantityError(f"{shortened(value)} is no number: {hint}")
    number = _parsed(value, unit) if isinstance(value, str) else value
    if not abs(number) < 1e308:  # NaN, infinity, or a whole number that is no float
        raise QuantityError(f"{shortened(value)} is not finite")
    return float(number)


def _parsed(text: str, unit: str) -> float:
    if len(text) > MAX_LENGTH:
        raise QuantityError(f"{text[:20]!r}... is longer than a number: {len(text)} characters")
    text = text.strip().replace("°", " deg")
    match = UNIT.search(text)
    factor = 1.0
    if match and match[1] != "pi":
        scale, dimension = _unit(match[1])
        own, expected = _unit(unit)
        if dimension != expected:
            kind = "a number without a unit" if unit == "1" else f"{unit} or a unit of that kind"
            raise QuantityError(f"{text!r} has another unit: give {kind}")
        factor, text = scale / own, text[: match.start()].strip()
    try:
        return factor * _value(ast.parse(text, mode="eval").body)
    except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
        hint = " (a power is written **)" if "^" in text else ""
        hint += " (a decimal point is a point)" if "," in text else ""
        raise QuantityError(
            f"{text!r} is no number{hint}: use digits, pi, + - * / ** and brackets, and then one "
            f"of the units {KNOWN}, or their products such as m/s^2"
        ) from error
    except ArithmeticError as error:
        raise QuantityError(f"{text!r} has no value: {error}") from error


def _value(node: ast.AST) -> float:
    match node:
        case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
            return float(number)
        case ast.Name(id="pi"):
            return pi
        case ast.UnaryOp(op=ast.USub() | ast.UAdd() as op, operand=operand):
            return -_value(operand) if isinstance(op, ast.USub) else _value(operand)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
            result = OPERATORS[type(op)](_value(left), _value(right))
            if isinstance(result, complex):
                raise ValueError("a root of a negative number")
            return result
    raise ValueError(f"{type(node).__name__} is not allowed")


def _unit(text: str) -> tuple[float, Dimension]:
    """The factor to SI units, and the dimension."""
    scale = 1.0
    dimension: Dimension = (0, 0, 0, 0)
    for sign, name, power in PART.findall(text):
        if name not in UNITS:
            raise QuantityError(f"unit {name!r} is not known: use {KNOWN}")
        size, powers = UNITS[name]
        count = int(power or 1) * (-1 if sign == "/" else 1)
        scale *= size**count
        dimension = tuple(a + count * b for a, b in zip(dimension, powers, strict=True))
    return scale, dimension
