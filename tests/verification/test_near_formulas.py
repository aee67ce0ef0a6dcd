"""Formulas that hold but for one term, and corrections in the text of formulas."""

from functools import partial
from itertools import product

import numpy as np
import pytest
from mpmath import mp
from numpy.testing import assert_allclose

from derive.verification.documents.jets import Jet, evaluated
from derive.verification.documents.numbers.single_mistakes import is_near
from derive.verification.documents.rules.corrected_formulas import in_brackets, inserted
from derive.verification.judging.verdict import Correction

SPEED = np.linspace(0.3, 1.7, 8)[None]
NAMES = {
    "a": Jet.of(np.array([[1.3]])),
    "b": Jet.of(np.array([[0.7]])),
    "x": Jet.of(np.linspace(0.4, 1.1, 8)[None] ** 2),
    "v": Jet.of(SPEED),
}


@pytest.mark.parametrize("text", [
    "x + a*y - 3", "-x*y*a", "y/x", "x**3", "x**-2", "(x*x)**1.5", "x**0*y", "x**1", "(x*x)**y",
    "sin(x)", "cos(x)", "tan(x)", "exp(x)", "log(x*x)", "sqrt(x*x + y*y)", "sinh(x)", "cosh(x)",
    "tanh(x)", "atan(x)", "atan2(y, x)", "sign(x)*y", "Heaviside(x)*y", "Heaviside(x, 1)*y",
    "Abs(x)", "abs(x*y)", "norm(x)", "DiracDelta(x) + y", "max(x, y)", "Max(x, y, a)", "min(x, y)",
    "Min(x, y, a)", "Piecewise((x*x, x < y), (y, True))", "Piecewise((x, x >= y), (y*y, True))",
    "Piecewise((x, x < -y), (y, x <= y), (x*y, True))", "Piecewise((x, x > -y), (y*y, True))",
    "x**2",
])  # fmt: skip
def test_formulas_of_jets_have_two_derivatives_in_time(text: str) -> None:
    """Against divided differences of 40 digits, with both signs of the quantities."""

    def piecewise(*pieces: tuple[mp.mpf, bool]) -> mp.mpf:
        return next(value for value, holds in pieces if holds)

    names = {name: getattr(mp, name) for name in (
        "sin", "cos", "tan", "exp", "log", "sqrt", "sinh", "cosh", "tanh", "atan", "atan2", "sign",
    )} | {"Heaviside": lambda u, _=0: int(u > 0), "Abs": abs, "norm": abs, "Max": max, "Min": min,
          "DiracDelta": lambda _: 0, "Piecewise": piecewise}  # fmt: skip
    at = [*product(((0.6, 0.3, -0.4), (-1.3, 0.7, 1.9)), ((0.8, 1.1, 0.5), (-0.9, -2, 3)))]

    def value(place: tuple, t: mp.mpf) -> mp.mpf:
        x, y = (c[0] + c[1] * t + c[2] * t**2 / 2 for c in place)
        return mp.mpf(eval(text, {**names, "x": x, "y": y, "a": 0.7}))

    jets = {name: Jet.of(*np.array([one[k] for one in at]).T) for k, name in enumerate("xy")}
    found = evaluated(text, {**jets, "a": Jet.of(np.array([0.7]))}).coefficients[:, 0]
    with mp.workdps(40):
        expected = np.array([mp.taylor(partial(value, one), 0, 2) for one in at], float).T
    assert_allclose(found, expected, atol=1e-12)


@pytest.mark.parametrize(
    ("left", "right", "near"),
    [
        ("a*x + b*v", "a*x - b*v", True),  # a sign
        ("a*x", "2*b*x", True),  # a factor
        ("a*sin(x) + v", "a*cos(x) + v", True),
        ("a*v**2 + x", "a*v + x", True),
        ("a*v + x", "a*v**2 + x", True),
        ("a*(x + b*v)", "a*x - a*b*v", True),  # in brackets
        ("(x + b*v)/a", "x/a - b*v/a", True),
        ("x + v", "x - 2*v", True),
        ("a*x + b*v", "2*a*x + 3*b*v", False),
        ("a*sin(x) + v", "a*cos(x) + 2*v", False),
        ("a*sin(x)", "x", False),
    ],
)
def test_one_changed_term_is_recognised(left: str, right: str, near: bool) -> None:
    found = is_near((left, right), lambda text: evaluated(text, NAMES), [SPEED])
    assert found is not None
    assert found.tolist() == [near]


@pytest.mark.parametrize(
    ("before", "old", "new", "after", "result"),
    [
        ("x = a + ", "b", "-c", " + d", "x = a - c + d"),
        ("x = a - ", "b", "-c", " + d", "x = a + c + d"),
        ("x = a ", "- b", "c", " + d", "x = a + c + d"),
        ("x = a ", "-b", "-c", "", "x = a - c"),
        ("x = ", "- b", "c", "", "x = c"),
        ("x = (", "a", "-c", ")", "x = (-c)"),
        ("x = a", "", "-c", "", "x = a - c"),
        ("x = a", "", "c", "", "x = a + c"),
    ],
)
def test_a_term_is_put_in_with_its_sign(
    before: str, old: str, new: str, after: str, result: str
) -> None:
    assert inserted(before, old, new, after) == result


@pytest.mark.parametrize(
    ("correct", "before", "after", "result"),
    [
        ("b + c", "x = ", " d", r"\left(b + c\right)"),
        ("b + c", "x = 2 ", "", r"\left(b + c\right)"),
        ("b + c", "x = ", " + d", "b + c"),
        ("b + c", r"x = \frac{", "}{2}", "b + c"),
        ("b*c", "x = 2 ", " d", "b*c"),
    ],
)
def test_a_sum_stands_in_brackets_where_it_is_a_factor(
    correct: str, before: str, after: str, result: str
) -> None:
    assert in_brackets(Correction("a", correct), correct, before, after) == result
