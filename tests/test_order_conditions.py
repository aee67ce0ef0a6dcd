"""Orders of Runge–Kutta methods by rooted trees, beside those that are observed."""

from fractions import Fraction
from math import cos, log2, sin

import pytest

from solvers.order_conditions import order, trees
from solvers.runge_kutta import METHODS, Tableau, fixed_step


def proved(method: Tableau) -> int:
    stages = len(method.b)
    A = [[*row, *[Fraction(0)] * (stages - len(row))] for row in method.A]
    return order(A, method.b, method.c)


def test_there_are_as_many_rooted_trees_as_published() -> None:
    # OEIS A000081
    assert [len(trees(n)) for n in range(1, 11)] == [1, 1, 2, 4, 9, 20, 48, 115, 286, 719]


@pytest.mark.parametrize(("name", "expected"), [("RK1", 1), ("RK2", 2), ("RK3", 3), ("RK4", 4)])
def test_methods_have_the_order_of_their_name(name: str, expected: int) -> None:
    assert proved(METHODS[name]) == expected


@pytest.mark.parametrize(("name", "expected"), [("RK1", 1), ("RK2", 2), ("RK3", 3), ("RK4", 4)])
def test_the_proved_order_is_observed(name: str, expected: int) -> None:
    # y' = y cos t has y = exp(sin t), and depends on time
    def error(steps: int) -> float:
        def rhs(t: float, y: list[float]) -> list[float]:
            return [y[0] * cos(t)]

        end = fixed_step(rhs, [1.0], 2.0 / steps, steps, METHODS[name])[0, -1]
        return abs(end - 2.718281828459045 ** sin(2.0))

    steps = 2000 if name == "RK1" else 200
    assert log2(error(steps) / error(2 * steps)) == pytest.approx(expected, abs=0.1)


def test_a_wrong_weight_or_node_loses_the_order() -> None:
    rk4 = METHODS["RK4"]
    weights = (rk4.b[0] + Fraction(1, 100), *rk4.b[1:])
    assert proved(Tableau(rk4.A, weights)) == 0
    A = [[Fraction(0)] * 4 for _ in range(4)]
    assert order(A, rk4.b, rk4.c) == 0
