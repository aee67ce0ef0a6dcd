"""Zero and positive expressions are recognised by proof."""

import pytest
import sympy as sp

from derive.formulas.zero import is_positive, vanishes

a, b = sp.symbols("a b", real=True)
m, n = sp.symbols("m n", positive=True)


@pytest.mark.parametrize(
    "expression",
    [
        sp.sin(a) ** 2 + sp.cos(a) ** 2 - 1,
        sp.cos(a - b) - sp.cos(a) * sp.cos(b) - sp.sin(a) * sp.sin(b),
        sp.sin(2 * (a - b)) - 2 * sp.sin(a - b) * sp.cos(a - b),
        sp.cos(3 * a) - 4 * sp.cos(a) ** 3 + 3 * sp.cos(a),
        1 / (m + n * sp.sin(a) ** 2) - 1 / (m + n - n * sp.cos(a) ** 2),
        m / (m * n + m**2) - 1 / (m + n),
        (m + n) ** 3 / (m + n) - (m + n) ** 2,
        sp.sin(a) - 2 * sp.sin(a / 2) * sp.cos(a / 2),
        sp.sin(a * (b + 1)) - sp.sin(a * b + a),
        a * sp.cos(b / 3) - a * (4 * sp.cos(b / 9) ** 3 - 3 * sp.cos(b / 9)),
        sp.S.Zero,
    ],
)
def test_identities_vanish_and_perturbed_identities_do_not(expression: sp.Expr) -> None:
    assert vanishes(expression)
    assert not vanishes(expression + m * sp.sin(a) ** 8 / 10**9)


@pytest.mark.parametrize(
    "expression",
    [
        sp.sqrt(a) - sp.exp(b),
        sp.Max(0, a - 100),
        sp.sign(a) - sp.tanh(300 * a),
        sp.Abs(a) ** (b + 1) - sp.Abs(a) ** b,
        sp.sqrt(a**2 + 1) - sp.sqrt(a**2 + 2),
        a**1000 - b,
        sp.sin(100001 * a),
        (sp.Add(*sp.symbols("x:9")) + 1) ** 60 - 1,  # too much work
        sp.sin(sp.Add(*sp.symbols("x:9")) ** 60),
    ],
)
def test_irrational_or_too_large_expressions_are_undecided(expression: sp.Expr) -> None:
    with pytest.raises(NotImplementedError, match="cannot"):
        vanishes(expression)


@pytest.mark.parametrize(
    "expression",
    [
        (sp.sqrt(2) + 1) ** 2 - 3 - 2 * sp.sqrt(2),
        (sp.sqrt(a**2 + b**2) + 1) ** 2 - a**2 - b**2 - 1 - 2 * sp.sqrt(a**2 + b**2),
        sp.sqrt((m - n * sp.cos(a)) ** 2 + n**2 * sp.sin(a) ** 2)
        - sp.sqrt(m**2 + n**2 - 2 * m * n * sp.cos(a)),
        sp.sqrt(4 * a**2 + 4 * b**2) - 2 * sp.sqrt(a**2 + b**2),
        m * a / sp.Abs(a) - m * sp.sign(2 * a),
        sp.Max(0, a) - (a + sp.Abs(a)) / 2,
        sp.Piecewise((a, a < b), (b, True)) - sp.Min(a, b),
        sp.tanh(a) - (sp.exp(2 * a) - 1) / (sp.exp(2 * a) + 1),
        sp.cosh(a / 2) ** 2 - sp.sinh(a / 2) ** 2 - 1,
        sp.tan(a) * sp.cos(a) - sp.sin(a),
        m * sp.log(a * (b + 1)) / n - sp.log(a + a * b) * m / n,
        sp.Abs(a) ** (b - 1) * sp.sign(a) - sp.Abs(a) ** b / a,
        sp.Heaviside(a) * sp.Max(0, a) - sp.Max(0, a),
        sp.sign((a + b) ** 2 - a**2 - 2 * a * b - b**2 - 1) + 1,
    ],
)
def test_identities_of_roots_signs_and_other_functions_vanish(expression: sp.Expr) -> None:
    assert vanishes(expression)


def test_a_vanishing_denominator_is_rejected() -> None:
    with pytest.raises(ZeroDivisionError):
        vanishes(a / (sp.sin(b) ** 2 + sp.cos(b) ** 2 - 1))


@pytest.mark.parametrize(
    ("expression", "strictly"),
    [
        (1 - m / (m + n), True),
        (1 - sp.cos(a) ** 2, False),
        (1 - m / (m + n) * sp.cos(a - b) ** 2, True),
        (m * n + n**2 * sp.sin(a) ** 2, True),
    ],
)
def test_sums_of_positive_terms_are_positive(expression: sp.Expr, strictly: bool) -> None:
    assert is_positive(expression, strictly=strictly)
    assert not is_positive(-expression, strictly=strictly)
    assert not is_positive(expression - 2 * m - 2, strictly=strictly)
