"""Runge-Kutta methods that a program writes out: their coefficients and order.

A step adds a combination of values of functions, whose arguments are combinations of values
before. The coefficients follow from numbers in place of these values.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from derive.reading.programs.evaluation.numeric_values import combined
from derive.reading.programs.evaluation.sums import inner
from derive.reading.programs.findings.stages import RATES
from derive.reading.programs.findings.updates import names
from derive.reading.programs.syntax.trees import (
    Array,
    Expression,
    FunctionCall,
    Item,
    Name,
    NumberLiteral,
    OperatorExpression,
    Result,
)

FUNCTIONS: Mapping[str, Callable[[float], float]] = {
    name: getattr(math, name) for name in ("sin", "cos", "tan", "exp", "log", "sqrt")
}
#: Coefficients in programs have as many digits as people write: 0.1667.
TOLERANCE = 2e-3
#: Stages of the longest method.
MAX_STAGES = 16


@dataclass(frozen=True)
class Method:
    """The coefficients of an explicit method for a step of size 1."""

    A: tuple[tuple[float, ...], ...]  # the known ones, where the weights are wrong
    b: tuple[float, ...]

    @property
    def stages(self) -> int:
        """The number of evaluations in a step."""
        return len(self.b)

    @property
    def order(self) -> int:
        """The order, up to 4; 0 if the weights do not sum to 1."""
        b, A = self.b, self.A
        if len(A) < len(b):
            return 0
        c = [sum(row) for row in A]
        ac = [sum(a * x for a, x in zip(row, c, strict=True)) for row in A]
        acc = [sum(a * x * x for a, x in zip(row, c, strict=True)) for row in A]
        aac = [sum(a * x for a, x in zip(row, ac, strict=True)) for row in A]
        ones = [1.0] * len(b)
        conditions = [
            [(ones, 1)],
            [(c, 2)],
            [([x * x for x in c], 3), (ac, 6)],
            [([x**3 for x in c], 4), ([x * y for x, y in zip(c, ac, strict=True)], 8)],
        ]
        conditions[3] += [(acc, 12), (aac, 24)]
        for order, ones_of_order in enumerate(conditions):
            for values, inverse in ones_of_order:
                weighted = sum(weight * x for weight, x in zip(b, values, strict=True))
                if abs(weighted - 1 / inverse) > TOLERANCE:
                    return order
        return 4


def method(increment: Expression) -> tuple[Method, Expression] | None:
    """The method whose step adds `increment`, and the value of its first stage.

    None if it is no method of several stages.
    """
    increment = inner(increment)  # that a function returns
    calls = _with_earlier(_calls(increment))
    if not 1 < len(calls) <= MAX_STAGES:
        return None
    weights = _coefficients(increment, calls)
    if weights is None or abs(value_at(increment, {}, calls)) > TOLERANCE:
        return None
    rows = [_row(call, calls) for call in calls]
    doubled = _coefficients(increment, calls, 2.0) or ()
    ratios = {round(y / x, 9) for x, y in zip(weights, doubled, strict=False) if x}
    is_partial = len(ratios) > 1 and 1 in ratios  # the step size is not in all weights
    if not any(any(row) for row in rows if row) or (None in rows and not is_partial):
        return None
    size = sum(weights)
    if ratios != {2} and not is_partial and size:  # the step is a number, or one by a letter
        weights = tuple(x / size for x in weights)
        rows = [tuple(x / size for x in row) if row else row for row in rows]
    order = sorted(range(len(calls)), key=lambda i: sum(map(bool, rows[i] or weights)))
    known = [row for i in order if (row := rows[i]) is not None]
    A = tuple(tuple(row[j] for j in order) for row in known)
    result = Method(A, tuple(weights[i] for i in order))
    return result, _result(increment, calls[order[0]]) or increment


def shifted(increment: Expression) -> set[str]:
    """The names to which the arguments of functions of the program add multiples of stages."""
    calls = _with_earlier(_calls(inner(increment)))
    result: set[str] = set()
    for call in calls:
        if getattr(call.function, "path", RATES) == RATES:
            continue
        for part in (part for argument in call.arguments for part in _parts(argument)):
            row = _coefficients(part, calls)
            if row and any(row) and _is_proportional(part, calls, row):
                start = value_at(part, {}, calls)
                result |= {one for one in names(part) if value_at(part, {one: 2.0}, calls) != start}
    return result


def _result(tree: Expression, call: FunctionCall) -> Expression | None:
    """The value of a call in a combination."""
    if called(tree) == call:
        return inner(tree)
    return next((result for part in tree.parts if (result := _result(part, call))), None)


def value_at(
    tree: Expression, names: Mapping[str, float], calls: Sequence[FunctionCall] = ()
) -> float:
    """A combination at values of names, 1 for others, with 0 for the values of calls."""
    return _number(inner(tree), calls, [0.0] * len(calls), names)


def called(tree: Expression) -> FunctionCall | None:
    """The call of a function of the program whose value, or an entry of it, a value is."""
    match tree:
        case Result(call=call):
            return called(call)
        case Item(base=base):
            return called(base)
        case FunctionCall(function=Name(path=path)) if path in FUNCTIONS:
            return None
        case FunctionCall():
            return tree
    return None


def _calls(tree: Expression) -> list[FunctionCall]:
    """The calls in a combination, in order; those in arguments follow from the calls."""
    if (call := called(tree)) is not None:
        return [call]
    result: list[FunctionCall] = []
    for part in tree.parts:
        result += [one for one in _calls(part) if one not in result]
    return result


def _with_earlier(calls: list[FunctionCall]) -> list[FunctionCall]:
    """Calls, and the calls of the same functions in their arguments."""
    result = [*calls]
    for call in result:  # which grows
        for argument in call.arguments:
            for one in _calls(argument):
                is_stage = any(one.function == other.function for other in calls)
                if is_stage and one not in result and len(result) <= MAX_STAGES:
                    result.append(one)
    return result


def _row(call: FunctionCall, calls: list[FunctionCall]) -> tuple[float, ...] | None:
    """The coefficients of earlier calls in the argument of a call."""
    rows = set()
    for argument in call.arguments:
        for part in _parts(argument):
            row = _coefficients(part, calls)
            if row is None:
                return None
            if any(row) and _is_proportional(part, calls, row):
                rows.add(row)
    if not rows:
        return (0.0,) * len(calls)
    return rows.pop() if len(rows) == 1 else None


def _parts(argument: Expression) -> Sequence[Expression]:
    """The entries of an argument that is an array, else itself."""
    value = inner(argument)
    return value.items if isinstance(value, Array) else (argument,)


def _is_proportional(tree: Expression, calls: list[FunctionCall], row: tuple[float, ...]) -> bool:
    """Whether coefficients grow with the step size, not with its square."""
    doubled = _coefficients(tree, calls, 2.0)
    return doubled is not None and all(
        abs(y) <= 2.5 * abs(x) for x, y in zip(row, doubled, strict=True)
    )


def _coefficients(
    tree: Expression, calls: Sequence[FunctionCall], step: float = 1.0
) -> tuple[float, ...] | None:
    """The coefficients of the values of calls in a combination, with 1 for all names."""
    zeros = [0.0] * len(calls)
    names = {"": step}
    try:
        start = _number(tree, calls, zeros, names)
        result = []
        for index in range(len(calls)):
            values = [*zeros]
            values[index] = 1.0
            once = _number(tree, calls, values, names) - start
            values[index] = 2.0
            twice = _number(tree, calls, values, names) - start
            if abs(twice - 2 * once) > 1e-9 * (1 + abs(once)):
                return None
            result.append(round(once, 12))
    except (ArithmeticError, ValueError, TypeError):
        return None
    return tuple(result)


def _number(
    tree: Expression,
    calls: Sequence[FunctionCall],
    values: Sequence[float],
    names: Mapping[str, float],
) -> float:
    """A combination with `values` of calls, and of names; that of others is names[""] or 1."""
    if (call := called(tree)) is not None and call in calls:
        return values[calls.index(call)]
    match tree:
        case Result(call=FunctionCall(arguments=arguments), value=value) if (
            not calls and value in arguments
        ):
            return _number(value, calls, values, names)  # the rate of a coordinate
        case _ if call is not None:
            return 0.0
        case NumberLiteral(digits=digits):
            return float(digits)
        case Name(path=path):
            return math.pi if path == "pi" else names.get(path, names.get("", 1.0))
        case OperatorExpression(operator="-", operands=(operand,)):
            return -_number(operand, calls, values, names)
        case OperatorExpression(operator=operator, operands=(left, right)):
            a, b = (_number(one, calls, values, names) for one in (left, right))
            return combined(operator, a, b)
        case FunctionCall(function=Name(path=path), arguments=(argument,)) if path in FUNCTIONS:
            return FUNCTIONS[path](_number(argument, calls, values, names))
        case Item():
            return names.get("", 1.0)
    raise ValueError("no number")
