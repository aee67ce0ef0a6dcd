"""Units of quantities: products of names such as ``N s/m``, ``kg*m/s^2`` or ``J s/(m^2)``."""

import ast
import re
from math import pi

Dimension = tuple[int, ...]  # powers of m, kg, s, rad


class UnitError(ValueError):
    """A unit has an unknown name, or its brackets are missing."""


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
    "us": (1e-6, (0, 0, 1, 0)),
    "μs": (1e-6, (0, 0, 1, 0)),  # Greek mu, to which Python's parser maps the micro sign
    "min": (60.0, (0, 0, 1, 0)),
    "h": (3600.0, (0, 0, 1, 0)),
    "rad": (1.0, (0, 0, 0, 1)),
    "deg": (pi / 180, (0, 0, 0, 1)),
    "turn": (2 * pi, (0, 0, 0, 1)),
    "rpm": (2 * pi / 60, (0, 0, -1, 1)),
    "N": (1.0, (1, 1, -2, 0)),
    "kN": (1000.0, (1, 1, -2, 0)),
    "J": (1.0, (2, 1, -2, 0)),
    "kJ": (1000.0, (2, 1, -2, 0)),
    "W": (1.0, (2, 1, -3, 0)),
    "kW": (1000.0, (2, 1, -3, 0)),
}
KNOWN = ", ".join(name for name in UNITS if name not in ("1", "μs"))

NAME = r"(?!pi\b)[A-Za-z\u00b5\u03bc]+"
POWER = r"(?:(?:\^|\*\*)-?\d)?"
TIMES = r"(?:\s*[*/]\s*|\s+)"
INNER = rf"\((?:{NAME}|1){POWER}(?:{TIMES}{NAME}{POWER})*\)"
#: A unit at the end of a text.
UNIT = re.compile(rf"(?<![\w.])((?:1/)?{NAME}{POWER}(?:{TIMES}(?:{NAME}|{INNER}){POWER})*)\Z")
#: A blank between factors, and one behind a quotient without brackets.
BLANK = re.compile(r"(?<=[\w)])\s+(?=[\w(])")
AMBIGUOUS = re.compile(r"/\s*[^\s()*/]+\s+[\w(]")


def dimension(unit: str) -> tuple[float, Dimension]:
    """The factor to SI units, and the powers of m, kg, s and rad."""
    if AMBIGUOUS.search(unit):
        raise UnitError(
            f"unit {unit!r} is ambiguous: write a product behind / in brackets, as in N/(m s)"
        )
    try:
        return _value(ast.parse(BLANK.sub("*", unit.replace("^", "**")), mode="eval").body)
    except (SyntaxError, ValueError) as error:
        raise UnitError(f"unit {unit!r} is not known: use {KNOWN}") from error


def with_unit(value: float, unit: str, digits: int = 6) -> str:
    """A number to `digits` significant digits and its unit, which is left out if it is 1."""
    return f"{value:.{digits}g} {unit if unit != '1' else ''}".rstrip()


def _value(node: ast.AST) -> tuple[float, Dimension]:
    match node:
        case ast.Constant(value=1):
            return UNITS["1"]
        case ast.Name(id=name) if name in UNITS:
            return UNITS[name]
        case ast.BinOp(left=left, op=ast.Pow(), right=exponent):
            scale, powers = _value(left)
            count = ast.literal_eval(exponent)
            return scale**count, tuple(count * power for power in powers)
        case ast.BinOp(left=left, op=ast.Mult() | ast.Div() as op, right=right):
            sign = 1 if isinstance(op, ast.Mult) else -1
            (scale, powers), (other, others) = _value(left), _value(right)
            result = tuple(a + sign * b for a, b in zip(powers, others, strict=True))
            return scale * other**sign, result
    raise ValueError
