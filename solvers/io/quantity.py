"""Numbers with units from text: ``90 deg``, ``pi/2``, ``-1.5 m/s``, ``3 J s/(m^2)``.

Text is parsed by rule and never executed: an expression is numbers, ``pi``, ``+ - * / **`` and
brackets, and a unit is a product of names and powers.
"""

import ast
import operator
import re
from collections.abc import Callable, Mapping
from math import pi
from types import MappingProxyType
from typing import Any

from solvers.io.suggestion import did_you_mean, shortened

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
        return _unit_value(ast.parse(BLANK.sub("*", unit.replace("^", "**")), mode="eval").body)
    except (SyntaxError, ValueError) as error:
        raise UnitError(f"unit {unit!r} is not known: use {KNOWN}") from error


def with_unit(value: float, unit: str, digits: int = 6) -> str:
    """A number to `digits` significant digits and its unit, which is left out if it is 1."""
    return f"{value:.{digits}g} {unit if unit != '1' else ''}".rstrip()


def _unit_value(node: ast.AST) -> tuple[float, Dimension]:
    match node:
        case ast.Constant(value=1):
            return UNITS["1"]
        case ast.Name(id=name) if name in UNITS:
            return UNITS[name]
        case ast.BinOp(left=left, op=ast.Pow(), right=exponent):
            scale, powers = _unit_value(left)
            count = ast.literal_eval(exponent)
            return scale**count, tuple(count * power for power in powers)
        case ast.BinOp(left=left, op=ast.Mult() | ast.Div() as op, right=right):
            sign = 1 if isinstance(op, ast.Mult) else -1
            (scale, powers), (other, others) = _unit_value(left), _unit_value(right)
            result = tuple(a + sign * b for a, b in zip(powers, others, strict=True))
            return scale * other**sign, result
    raise ValueError


#: Characters of the longest number or formula, and a name in a formula.
MAX_LENGTH = 100
WORD = re.compile(r"[A-Za-z_]\w*")
OPERATORS: dict[type[ast.AST], Callable[[Any, Any], Any]] = {
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


def formula(text: str, names: Mapping[str, Any]) -> Any:
    """The value of an expression in which names stand for numbers or arrays."""
    if len(text) > MAX_LENGTH:
        raise QuantityError(f"{text[:20]!r}... is longer than a formula: {len(text)} characters")
    try:
        return _value(ast.parse(text.strip(), mode="eval").body, names)
    except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
        known = ", ".join(names)
        words = [node for node in WORD.findall(text) if node not in (*names, "pi")]
        hint = f": unknown name {words[0]!r}{did_you_mean(words[0], [*names])}" if words else ""
        raise QuantityError(
            f"{text!r} is no formula{hint}; use digits, pi, + - * / **, brackets and {known}"
        ) from error
    except ArithmeticError as error:
        raise QuantityError(f"{text!r} has no value: {_reason(error)}") from error


def _reason(error: ArithmeticError) -> str:
    """The text of an error; that of an overflow is one of the system, with its number."""
    return "it is out of range" if isinstance(error, OverflowError) else str(error)


def _parsed(text: str, unit: str) -> float:
    if len(text) > MAX_LENGTH:
        raise QuantityError(f"{text[:20]!r}... is longer than a number: {len(text)} characters")
    text = text.strip().replace("°", " deg")
    factor, number = 1.0, text.removesuffix(f" {unit}")
    if not UNIT.search(number):  # a number, perhaps in the expected unit, which may be any text
        text = number
    elif match := UNIT.search(text):
        factor, text = _factor(text, match[1], unit), text[: match.start()].strip()
    try:
        return factor * _value(ast.parse(text, mode="eval").body)
    except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
        hint = " (a power is written **)" if "^" in text else ""
        hint += " (a decimal point is a point)" if "," in text else ""
        raise QuantityError(
            f"{text!r} is no number{hint}: use digits, pi, + - * / ** and brackets, and then one "
            f"of the units {KNOWN}, or their products such as m/s^2 or N s/m"
        ) from error
    except ArithmeticError as error:
        raise QuantityError(f"{text!r} has no value: {_reason(error)}") from error


def _factor(text: str, given: str, unit: str) -> float:
    """The size of the given unit in the expected one."""
    try:
        (scale, own), (expected, required) = dimension(given), dimension(unit)
    except UnitError as error:
        raise QuantityError(str(error)) from error
    if own != required:
        kind = "a number without a unit" if unit == "1" else f"{unit} or a unit of that kind"
        raise QuantityError(f"{text!r} has another unit: give {kind}")
    return scale / expected


def _value(node: ast.AST, names: Mapping[str, Any] = MappingProxyType({})) -> Any:
    match node:
        case ast.Name(id=name) if name in names:
            return names[name]
        case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
            return float(number)
        case ast.Name(id="pi"):
            return pi
        case ast.UnaryOp(op=ast.USub() | ast.UAdd() as op, operand=operand):
            value = _value(operand, names)
            return -value if isinstance(op, ast.USub) else value
        case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
            result = OPERATORS[type(op)](_value(left, names), _value(right, names))
            if isinstance(result, complex):
                raise ValueError("a root of a negative number")
            return result
    raise ValueError(f"{type(node).__name__} is not allowed")
