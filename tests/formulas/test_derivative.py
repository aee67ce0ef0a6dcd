"""Derivatives are those of SymPy, in the same form; numbers decide between branches in order."""

import pytest
import sympy as sp

from derive import load
from derive.formulas.functions import decisive_numbers, derivative
from derive.system.symbols import TIME

x, y = sp.symbols("x y", real=True)
a = sp.Symbol("a", positive=True)
FORMULAS = (
    sp.S.Zero, sp.pi, x, y, a * x, 3 * (x + y) ** 2, 1 / (x + a), sp.sqrt(a**2 - x**2), 2**x, x**y,
    (x + 1) ** (x * y), sp.sin(x * y) * sp.cos(x) ** 3 / x, -2 * (x + y) * (x - a) * sp.sin(x + y),
    sp.exp(-x / a), sp.tan(x), sp.atan2(x, y), sp.log(x**2 + y**2), abs(x), sp.Max(x, y),
    sp.Piecewise((x**2, x > 0), (-x, True)), sp.sin(x) + sp.Abs(sp.cos(x) * y),
)  # fmt: skip


@pytest.mark.parametrize("formula", FORMULAS, ids=str)
def test_derivatives_of_formulas(formula: sp.Expr) -> None:
    for symbol in (x, y, a):
        assert derivative(formula, symbol) == formula.diff(symbol)


@pytest.mark.parametrize("name", ["foucault_pendulum", "rolling_disc", "slider_crank", "free_body"])
def test_derivatives_of_systems(name: str) -> None:
    system = load(name)
    formulas = [r for mass in system.masses for r in mass.placement]
    formulas += [one.formula for one in system.conditions]
    variables = (*system.q, *system.qdot, *system.params, TIME)
    for formula in formulas:
        for symbol in variables:
            assert derivative(formula, symbol) == formula.diff(symbol), (formula, symbol)


def test_decisive_numbers_come_after_those_in_their_own_formula() -> None:
    a, x = sp.symbols("a x", real=True)
    assert decisive_numbers([sp.Abs(a + sp.sign(x))], {a, x}) == (x, a + sp.sign(x))
