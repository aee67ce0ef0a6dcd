"""Motions in sums of two doubles, whose right-hand side is C without operators."""

import ast
import re
from collections.abc import Iterable, Iterator, Sequence
from decimal import Decimal, localcontext
from functools import singledispatchmethod

from solvers.integration.compiled.equations_source import EquationsSource
from solvers.integration.compiled.extended_source import (
    NotArithmeticError,
    Precision,
    coefficients_of,
)
from solvers.integration.compiled.memory_layout import source
from solvers.runge_kutta.order_conditions import WORKING_DIGITS

FUNCTION = """\
static inline void {name}(
    double_double v_t, const double_double *v_state, const double_double *v_params,
    double_double *v_result)
{{
{body}
}}"""

OPERATIONS = {ast.Add: "add", ast.Sub: "subtract", ast.Mult: "multiply", ast.Div: "divide"}
COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
DEFINITION = re.compile(r"const \w+ (\w+) =\s+(.*)", re.DOTALL)
RESULT = re.compile(r"(result\[\d+\]) =\s+(.*)", re.DOTALL)


class DoubleDouble(Precision):
    """Sums of two doubles, with all stages at once in the lanes of a vector.

    For right-hand sides of sums, products and quotients only.
    """

    stages, epsilon, may_fuse = 8, "0x1p-104", False
    files = "double_double_stages.h", "double_double_refinement.h"
    correction = "double_double_correction.h"

    def numbers(self, equations: EquationsSource) -> str:
        """The operations, and the right-hand side in calls of them and in lanes of doubles."""
        functions = {"RHS": equations.rhs, "CORRECTION": equations.correction}
        functions["EVALUATE"] = equations.integrals
        return "\n".join(
            [
                source("double_double.h"),
                "typedef double real, lower;",
                *(in_calls(equations, *names) for names in functions.items() if names[1]),
                "#define HOLONOMIC_REAL lanes",
                "#define HOLONOMIC_VECTOR",
                equations.header,
                f"#define LOWER_RHS {equations.rhs}",
            ]
        )

    def coefficients(self) -> str:
        """Matrices by their columns."""
        arrays = coefficients_of(self.stages)
        (b,), (c,) = arrays["B"], arrays["C"]
        rest = [w * (1 - x) for w, x in zip(b, c, strict=True)]
        columns = {name: list(zip(*arrays[name], strict=True)) for name in ("A", "LEGENDRE")}
        vectors = {"B": b, "C": c, "B_REST": rest}
        return "\n".join(
            [
                f"static const double_double A[STAGES] = {_list(map(_pairs, columns['A']))};",
                *(f"static const double_double {n} = {_pairs(v)};" for n, v in vectors.items()),
                f"static const lanes LOWER_C = {_doubles(c)};",
                *(
                    f"static const lanes LOWER_{name}[STAGES] = {_list(map(_doubles, rows))};"
                    for name, rows in columns.items()
                ),
            ]
        )


def _list(items: Iterable[str]) -> str:
    return f"{{{', '.join(items)}}}"


def _doubles(values: Sequence[Decimal]) -> str:
    return _list(repr(float(value)) for value in values)


def _pairs(values: Sequence[Decimal]) -> str:
    """Sums of two doubles."""
    with localcontext(prec=WORKING_DIGITS):
        rest = [value - Decimal(float(value)) for value in values]
    return _list([_doubles(values), _doubles(rest)])


def in_calls(equations: EquationsSource, name: str, function: str) -> str:
    """A function of the header in C under a new name, as calls of functions for sums and products.

    Names in it have the prefix ``v_``, so that they hide none of these functions.
    """
    start = rf"static inline void {function}\([^)]*\)\s*\{{"
    match = re.search(rf"{start}(.*?)\}}", COMMENT.sub("", equations.header), re.DOTALL)
    if match is None:
        raise NotArithmeticError(f"{function} is missing")
    return FUNCTION.format(name=name, body="\n".join(_statements(match[1])))


def _statements(body: str) -> Iterator[str]:
    for text in map(str.strip, body.split(";")):
        if definition := DEFINITION.fullmatch(text):
            yield f"    const double_double v_{definition[1]} = {_Expression(definition[2])};"
        elif result := RESULT.fullmatch(text):
            yield f"    v_{result[1]} = {_Expression(result[2])};"
        elif name := re.fullmatch(r"\(void\)(\w+)", text):
            yield f"    (void)v_{name[1]};"
        elif text:
            raise NotArithmeticError(f"{text[:50]!r} is no definition")


class _Expression:
    """An expression of C whose text is one of Python, too."""

    def __init__(self, text: str) -> None:
        self._text = f"({text})"

    def __str__(self) -> str:
        try:
            return self._call(ast.parse(self._text, mode="eval").body)
        except SyntaxError as error:
            raise NotArithmeticError(f"{self._text[:50]!r} is no arithmetic") from error

    @singledispatchmethod
    def _call(self, node: ast.expr) -> str:
        raise NotArithmeticError(f"{ast.unparse(node)[:50]!r} is no arithmetic")

    @_call.register
    def _(self, node: ast.BinOp) -> str:
        if type(node.op) not in OPERATIONS:
            raise NotArithmeticError(f"{ast.unparse(node)[:50]!r} is no arithmetic")
        return f"{OPERATIONS[type(node.op)]}({self._call(node.left)}, {self._call(node.right)})"

    @_call.register
    def _(self, node: ast.UnaryOp) -> str:
        return f"negative({self._call(node.operand)})"

    @_call.register
    def _(self, node: ast.Name) -> str:
        return f"v_{node.id}"

    @_call.register
    def _(self, node: ast.Subscript) -> str:
        return f"v_{ast.unparse(node)}"

    @_call.register
    def _(self, node: ast.Constant) -> str:
        value = Decimal(ast.get_source_segment(self._text, node) or "")
        high = float(value)
        return f"constant({high!r}, {float(value - Decimal(high))!r})"

    @_call.register
    def _(self, node: ast.Call) -> str:
        name = ast.unparse(node.func)
        if not name.endswith("_NUMBER"):
            raise NotArithmeticError(f"{name} is a function")
        return self._call(node.args[0])
