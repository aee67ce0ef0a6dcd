"""Formulas are parsed from text and never executed."""

import keyword

import pytest
import sympy as sp

from derive.formulas.expression import FUNCTIONS, parse
from derive.formulas.syntax import ExpressionError

x, y = sp.symbols("x y")
SCOPE = {"x": x, "y": y, "sin": sp.sin}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1/2", sp.Rational(1, 2)),
        ("9.81", sp.Rational(981, 100)),
        ("1.00000000000000000001", 1 + sp.Rational(1, 10**20)),
        ("-x**2 + 2*sin(x - y)", -(x**2) + 2 * sp.sin(x - y)),
        ("(x, y)", sp.Matrix([x, y])),
        ("[[1, x], [y, 2]]*(x, y)", sp.Matrix([x + x * y, x * y + 2 * y])),
        ("(x, y)*(y, 2)", x * y + 2 * y),
        ("2*(x, y)**2", 2 * x**2 + 2 * y**2),
    ],
)
def test_formulas_are_parsed_exactly(text: str, value: sp.Expr) -> None:
    assert parse(text, SCOPE) == value


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("__import__('os').system('touch owned')", "not allowed"),
        ("x.__class__", "not allowed"),
        ("(lambda: 1)()", "cannot parse"),
        ("[x for x in y]", "cannot parse"),
        ("'text'", "not allowed"),
        ("True", "unknown name 'True'"),
        ("2j", "not allowed"),
        ("x if y else x", "cannot parse"),
        ("x := 1", "cannot parse"),
        ("f'{x}'", "not allowed"),
        ("sin(*x)", "not allowed"),
        ("sin(x=1)", "not allowed"),
        ("x(2)", "'x' is not a function"),
        ("m^2", "write powers with"),
        ("9**9**9", "exponent 387420489"),
        ("x**1000", "exponent 1000"),
        ("x**(99*pi)", "only numbers up to 100"),
        ("pi**pi**pi**pi", "only numbers up to 100"),
        ("x**(2, y)", "powers of matrices"),
        ("max()", "no finite value"),
        ("max(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13)", "more than 12 arguments"),
        ("Piecewise()", "cannot be computed"),
        ("Piecewise(x)", "pairs of a value and its condition"),
        ("Piecewise((x, x > 0))", "the last one is True"),
        ("Piecewise((x, x == 0), (y, True))", "is not a condition"),
        ("Piecewise((x, 0 < x < 1), (y, True))", "is not a condition"),
        ("Piecewise((x, print(x)), (y, True))", "is not a condition"),
        ("Piecewise(((x, y), x > 0), (y, True))", "entries are numbers"),
        ("x > 0", "not allowed"),
        ("z + 1", "unknown name 'z'"),
        ("sim(x)", "did you mean 'sin'"),
        ("x +", "cannot parse"),
        ("x # + y", "has no meaning"),
        ("[5]", "not allowed"),
        ("()", "not allowed"),
        ("[[x, y], [x]]", "not allowed"),
        ("[[x, (x, y)]]", "entries are numbers"),
        ("[[x, y], [y, x]]**100", "powers of matrices"),
        ("sin", "needs arguments"),
        ("sin()", "cannot be computed"),
        ("sin(x, y)", "cannot be computed"),
        ("1/0", "no finite value"),
        ("x*(y - y)/(y - y)", "no finite value"),
        ("x*(sin(x)**2 - sin(x)**2)/y/(x - x)", "no finite value"),
        ("x/(x*(y + 1) - x*y - x)*(x*(y + 1) - x*y - x)", "divides by zero"),
        ("(x*(y + 1) - x*y - x)**-1*(x*(y + 1) - x*y - x)", "divides by zero"),
        ("1e400", "out of range"),
        ("1e999999999999", "out of range"),
        ("1e-999999999999", "out of range"),
        ("0x10", "cannot be computed"),
        ("(((9**100)**100)**100)**100", "bits"),
        ("9**100*9**100", "bits"),
        ("1/(x, y)", "cannot be computed"),
        ("(" * 100_000 + "x" + ")" * 100_000, "at most 20000"),
        ("(" * 5_000 + "x" + ")" * 5_000, "cannot parse|nested too deeply"),
        ("+".join("x" * 9_000), "nested too deeply|cannot parse"),
        ("x\0", "cannot parse"),
        ("", "a formula is empty"),
    ],
)
def test_invalid_formulas_are_rejected(text: str, message: str) -> None:
    with pytest.raises(ExpressionError, match=message):
        parse(text, FUNCTIONS | SCOPE)


@pytest.mark.parametrize("name", keyword.kwlist)
def test_words_of_python_s_grammar_are_names(name: str) -> None:
    value = sp.Symbol("value")
    assert parse(f"{name}*1.5 + {name}_dot", {name: value, f"{name}_dot": y}) == value * 3 / 2 + y
    with pytest.raises(ExpressionError, match=f"unknown name '{name}'"):
        parse(name, SCOPE)


@pytest.mark.parametrize("function", sorted({*FUNCTIONS} - {"pi", "Piecewise"}))
@pytest.mark.parametrize("column", ["(x, y)", "(x,)", "[[x, y], [y, x]]"])
def test_functions_of_columns_are_rejected(function: str, column: str) -> None:
    with pytest.raises(ExpressionError, match=f"{function} of a column or matrix"):
        parse(f"{function}({column})", FUNCTIONS | SCOPE)
