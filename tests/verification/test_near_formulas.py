"""Formulas that hold but for one term, and corrections in the text of formulas."""

import numpy as np
import pytest

from derive.verification.documents.jets import Jet, evaluated
from derive.verification.documents.numbers.single_mistakes import is_near
from derive.verification.documents.rules.corrections import in_brackets, inserted
from derive.verification.verdict import Correction

SPEED = np.linspace(0.3, 1.7, 8)[None]
NAMES = {
    "a": Jet.of(np.array([[1.3]])),
    "b": Jet.of(np.array([[0.7]])),
    "x": Jet.of(np.linspace(0.4, 1.1, 8)[None] ** 2),
    "v": Jet.of(SPEED),
}


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
