"""Angles in degrees that are passed to functions of radians."""

import math
import re
from collections.abc import Iterator, Mapping

from derive.reading.programs.evaluation.context import static_path
from derive.reading.programs.evaluation.mathematics import TO_RADIANS, split
from derive.reading.programs.evaluation.numeric_values import number
from derive.reading.programs.program import Finding
from derive.reading.programs.syntax.trees import Expression, FunctionCall, Name

IN_DEGREES = re.compile(r"(_|\b)deg(ree)?s?$|[a-z\d](Deg|Degrees)$|_deg_", re.IGNORECASE)
CIRCULAR = ("sin", "cos", "tan")


def named_in_degrees(value: Expression, function: str) -> Iterator[Finding]:
    """Names such as angle_deg in the arguments of sines, without a conversion."""
    for line, argument in arguments(value):
        result = [*_names(argument)]
        for path in result:
            if IN_DEGREES.search(path) and "pi" not in result:
                text = f"{path} is passed to a function of radians, without a conversion"
                yield Finding(line, "degrees", function, text, True)


def starts_in_degrees(
    path: str,
    start: Expression,
    values: Mapping[str, Expression],
    function: str,
    is_fault: bool = True,
) -> Iterator[Finding]:
    """An initial angle of more than a turn, such as 120, that is written without pi."""
    while isinstance(start, Name) and start.path in values:
        start = values[start.path]
    value = number(start)
    if value is not None and abs(value) > 2 * math.pi and "pi" not in _names(start):
        text = f"{path} starts at {value:g}, and its sine is taken: degrees instead of radians"
        yield Finding(start.line, "degrees", function, text, is_fault)


def takes_degrees(call: FunctionCall) -> bool:
    """Whether a call makes sines those of degrees."""
    match call:
        case FunctionCall(function=Name(path="angleMode"), arguments=(Name(path="DEGREES"),)):
            return True
    return False


def is_converted(tree: Expression) -> bool:
    """Whether an angle in degrees is converted to radians."""
    match tree:
        case FunctionCall(function=function) if split(static_path(function))[1] in TO_RADIANS:
            return True
    return any(map(is_converted, tree.parts))


def angles(values: list[Expression]) -> set[str]:
    """The variables in the arguments of sines and cosines that are not converted there."""
    names = ({*_names(argument)} for one in values for _, argument in arguments(one))
    return set[str]().union(*(one for one in names if "pi" not in one))


def arguments(tree: Expression) -> Iterator[tuple[int, Expression]]:
    """The arguments of sines and cosines, with their lines."""
    match tree:
        case FunctionCall(function=Name(path=path), arguments=(argument,)) if path in CIRCULAR:
            yield tree.line, argument
    for part in tree.parts:
        yield from arguments(part)


def _names(tree: Expression) -> Iterator[str]:
    if isinstance(tree, Name):
        yield tree.path
    for part in tree.parts:
        yield from _names(part)
