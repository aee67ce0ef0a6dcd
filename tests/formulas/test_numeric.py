"""Numeric values have many digits, and bounds of their errors decide what is zero."""

from itertools import combinations

import pytest
import sympy as sp

from derive.formulas.generic_values import STATES, is_small, sample
from derive.formulas.numeric import Evaluator, NoValueError, independent, solved

x, y = sp.symbols("x y", real=True)
m = sp.Symbol("m", positive=True)
EVALUATOR = Evaluator({x: sp.Rational(-3, 7), y: sp.Rational(5, 4), m: sp.Integer(2)})


@pytest.mark.parametrize(
    "identity",
    [
        sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1,
        sp.tan(x) - sp.sin(x) / sp.cos(x),
        sp.exp(2 * x) - sp.exp(x) ** 2,
        sp.log(3 * m) - sp.log(m) - sp.log(3),
        sp.sqrt(x**2) + x,  # x is negative
        sp.sqrt(x) ** 2 - x,
        (x + y) ** 60 - x * (x + y) ** 59 - y * (x + y) ** 59,
        (10**40 + x) ** 2 - 10**80 - 2 * 10**40 * x - x**2,
        sp.Abs(x).diff(x) + 1,
        sp.pi - 2 * sp.pi / 2,
        sp.sinh(x) - (sp.exp(x) - sp.exp(-x)) / 2,
        sp.Piecewise((-x, x < 0), (y, True)) - sp.Abs(x),
        # both sides of these conditions are equal
        sp.Piecewise((0, sp.sin(y) ** 2 + sp.cos(y) ** 2 <= 1), (y, True)),
        sp.Piecewise((y, sp.sin(y) ** 2 + sp.cos(y) ** 2 < 1), (0, True)),
        sp.Piecewise((y, sp.sin(y) ** 2 + sp.cos(y) ** 2 > 1), (0, True)),
        sp.Piecewise((y, sp.Ne((x + y) ** 2, x**2 + 2 * x * y + y**2)), (0, True)),
    ],
)
def test_identities_are_zero_and_small_terms_are_not(identity: sp.Expr) -> None:
    assert EVALUATOR(identity).is_zero
    assert not EVALUATOR(identity + y / 10**25).is_zero


@pytest.mark.parametrize("value", [sp.Rational(-3, 7), sp.Float("-0.1", 50)])
def test_bounds_of_errors_do_not_depend_on_the_sign(value: sp.Expr) -> None:
    assert EVALUATOR(value).error == EVALUATOR(-value).error > 0


def test_values_agree_with_those_of_sympy() -> None:
    expression = sp.sqrt(x) * sp.tan(y) ** 3 / (x - sp.exp(m)) + sp.log(x) + sp.cos(x / y)
    expected = expression.subs({x: sp.Rational(-3, 7), y: sp.Rational(5, 4), m: 2}).evalf(80)
    assert abs(EVALUATOR(expression).rounded() - expected) < sp.Float("1e-78")


def test_inverse_functions_may_have_complex_values() -> None:
    expected = sp.pi - sp.acos(sp.Rational(3, 7))  # of cosh(i a) = cos(a)
    value = EVALUATOR(sp.acosh(x)).rounded()
    assert abs(value - sp.I * expected.evalf(80)) < sp.Float("1e-78")


@pytest.mark.parametrize(
    "expression",
    [
        1 / (x * (y + 1) - x * y - x),
        sp.log(sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1),
        sp.exp(sp.exp(sp.exp(m * 100))),
        sp.sin(sp.exp(100000 * y)),
        sp.tan(sp.pi / 2 * (sp.sin(x) ** 2 + sp.cos(x) ** 2)),
    ],
)
def test_expressions_without_a_value_are_reported(expression: sp.Expr) -> None:
    with pytest.raises(NoValueError):
        EVALUATOR(expression)


def test_an_expression_is_small_only_where_it_has_values() -> None:
    assert is_small(sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1)
    assert not is_small(x)
    assert not is_small(sp.log(sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1))


def test_linear_equations_are_solved_and_dependent_rows_are_recognised() -> None:
    solution = solved(sp.Matrix([[x, 1], [1, y]]), sp.Matrix([x + 1, 1 + y]), EVALUATOR)
    assert all(abs(entry - 1) < sp.Float("1e-80") for entry in solution)
    third = sp.Rational(1, 3)
    rows = sp.Matrix([(1, 2, third), (3, 6, 1), (1, 2, 3 * third / 2), (0, 0, 1)])
    assert independent(rows.tolist()) == [0, 2]


def test_every_two_symbols_have_all_pairs_of_signs() -> None:
    symbols = sp.symbols("x:40", real=True)
    states = [sample((m, *symbols), index) for index in range(STATES)]
    assert all(state[m] > 0 for state in states)
    for a, b in combinations(symbols, 2):
        assert len({(state[a] > 0, state[b] > 0) for state in states}) == 4
