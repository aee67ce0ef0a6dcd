"""Sums of two doubles have twice the digits of doubles, as fractions confirm."""

import ctypes
import re
import shutil
from fractions import Fraction

import numpy as np
import pytest

import generated.cart_3 as cart
import generated.coupled_pendulums as coupled
from solvers.integration.compiled import compiler
from solvers.integration.compiled.compiler import build
from solvers.integration.compiled.double_double import DoubleDouble, in_calls
from solvers.integration.compiled.equations_source import EquationsSource
from solvers.integration.compiled.extended_source import NotArithmeticError
from solvers.integration.compiled.memory_layout import SOURCES
from solvers.integration.compiled.native import equations

OPERATIONS = {
    "add": Fraction.__add__,
    "subtract": Fraction.__sub__,
    "multiply": Fraction.__mul__,
    "divide": Fraction.__truediv__,
    "product_added": lambda a, b: a + b * Fraction(float(a)),
    "lanes_added": lambda a, b: DoubleDouble.stages * a + b,
}
#: Those whose errors are in proportion to their larger term.
SUMS = ("add", "subtract", "product_added", "lanes_added")
PROGRAM = """
#include <float.h>
#include <math.h>
enum {{ STAGES = {stages} }};
{source}
static double_double product_added(double_double a, double_double b)
{{
    return add(add_product(a, b, a.high), constant(0, 0));
}}
static double_double lanes_added(double_double a, double_double b)
{{
    double high = b.high[0], low = b.low[0];
    add_lanes(a, &high, &low);
    return constant(high, low);
}}
void compute(double (*x)[2], double (*result)[2]);
void compute(double (*x)[2], double (*result)[2])
{{
    const double_double a = constant(x[0][0], x[0][1]), b = constant(x[1][0], x[1][1]);
    const double_double values[] = {{ {calls} }};
    for (int k = 0; k < {count}; k++) {{
        result[k][0] = values[k].high[k];
        result[k][1] = values[k].low[k];
    }}
}}
"""


def number(pair: np.ndarray) -> Fraction:
    return Fraction(float(pair[0])) + Fraction(float(pair[1]))


@pytest.mark.parametrize("command", ["cc", "clang"])
def test_operations_have_twice_the_digits(command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    path = shutil.which(command)
    if path is None:
        pytest.skip(f"{command} is not installed")
    monkeypatch.setattr(compiler, "compilers", lambda: iter([(path,)]))
    calls = ", ".join(f"{name}(a, b)" for name in OPERATIONS)
    count = len(OPERATIONS)
    source = (SOURCES / "double_double.h").read_text(encoding="utf-8")
    text = PROGRAM.format(source=source, stages=DoubleDouble.stages, calls=calls, count=count)
    library, rng = build(text, reproducible=True).functions, np.random.default_rng(1)
    result = np.empty((count, 2))
    for _ in range(200):
        high = rng.uniform(-1, 1, 2) * 10.0 ** rng.integers(-3, 3, 2)
        x = np.stack([high, rng.uniform(-0.5, 0.5, 2) * np.spacing(high)], axis=1)
        library.compute(*(ctypes.c_void_p(array.ctypes.data) for array in (x, result)))
        a, b = map(number, x)
        for (name, operation), pair in zip(OPERATIONS.items(), result, strict=True):
            exact = operation(a, b)
            size = max(abs(exact), abs(a), abs(b)) if name in SUMS else abs(exact)
            terms = DoubleDouble.stages if name == "lanes_added" else 1
            assert abs(number(pair) - exact) <= size * Fraction(8 * terms, 2**106), name
            assert abs(pair[1]) <= np.spacing(abs(pair[0]))


def test_right_hand_sides_become_calls() -> None:
    header = """
static inline void hand_rhs(HOLONOMIC_REAL t, const HOLONOMIC_REAL *state,
    const HOLONOMIC_REAL *params, HOLONOMIC_REAL *result)
{
    /* a comment; with a semicolon */
    const HOLONOMIC_REAL add = -params[0]*HAND_NUMBER(0.1);
    result[0] =
        (add + state[0])/t - 2*state[0];
    (void)t;
}"""
    source = EquationsSource(header, "hand_rhs", "", 1, 1, 1, (), (), (), True)
    body = re.findall(r"v_(?:add|result\[0\]) = (.*);", in_calls(source, "RHS", source.rhs))
    tenth = f"constant(0.1, {float(Fraction(1, 10) - Fraction(0.1))!r})"
    assert body == [
        f"multiply(negative(v_params[0]), {tenth})",
        "subtract(divide(add(v_add, v_state[0]), v_t), multiply(constant(2.0, 0.0), v_state[0]))",
    ]
    assert "(void)v_t;" in in_calls(source, "RHS", source.rhs)


def test_functions_and_statements_that_are_no_definitions_are_refused() -> None:
    carts, pair = equations(cart, "rational"), equations(coupled, "rational")
    assert "v_result[10]" in in_calls(carts, "RHS", carts.rhs)
    with pytest.raises(NotArithmeticError, match="coupled_pendulums_sqrt is a function"):
        in_calls(pair, "RHS", pair.rhs)
    start = "static inline void f(int t) {"
    for body, message in (
        ("int i = 0;", "'int i = 0' is no definition"),
        ("result[0] = t ? 1 : 0;", "is no arithmetic"),
        ("result[0] = t % 2;", "is no arithmetic"),
    ):
        source = EquationsSource(f"{start} {body} }}", "f", "", 1, 1, 1, (), (), (), True)
        with pytest.raises(NotArithmeticError, match=re.escape(message)):
            in_calls(source, "RHS", source.rhs)
    with pytest.raises(NotArithmeticError, match="g is missing"):
        in_calls(EquationsSource("", "g", "", 1, 1, 1, (), (), (), True), "RHS", "g")
