"""Collocation methods: nodes, coefficients and order."""

from decimal import Decimal, localcontext
from fractions import Fraction

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss

from solvers.runge_kutta.collocation import (
    collocation,
    gauss_nodes,
    is_collocation,
    quadrature_order,
    radau_nodes,
)
from solvers.runge_kutta.method_catalogue import load
from solvers.runge_kutta.order_conditions import WORKING_DIGITS, order
from solvers.runge_kutta.tableau import Tableau


@pytest.mark.parametrize("stages", [1, 2, 4, 8])
def test_gauss_nodes_are_those_of_numpy(stages: int) -> None:
    nodes, weights = leggauss(stages)
    c = gauss_nodes(stages)
    assert list(map(float, c)) == pytest.approx((nodes + 1) / 2, abs=1e-15)
    assert list(map(float, collocation(c)[1])) == pytest.approx(weights / 2, abs=1e-15)


@pytest.mark.parametrize(("name", "nodes"), [("gauss3", gauss_nodes), ("radau3", radau_nodes)])
def test_coefficients_are_those_in_surds(name: str, nodes: object) -> None:
    method = load(name)
    A, b = collocation(nodes(3))  # type: ignore[operator]
    for ours, exact in zip((*A, b), (*method.A, method.b), strict=True):
        assert list(map(float, ours)) == pytest.approx(list(map(float, exact)), abs=1e-16)


@pytest.mark.parametrize(
    ("nodes", "expected"),
    [(gauss_nodes(2), 4), (gauss_nodes(3), 6), (radau_nodes(3), 5), (gauss_nodes(4), 8)],
)
def test_order_is_that_by_rooted_trees(nodes: tuple[Decimal, ...], expected: int) -> None:
    A, b = collocation(nodes)
    assert quadrature_order(b, nodes) == expected
    with localcontext(prec=WORKING_DIGITS):  # as decimals of 60 digits, which have a last digit
        rounded = [[x.quantize(Decimal(10) ** -60) for x in row] for row in (*A, b)]
    assert order(rounded[:-1], rounded[-1]) == expected


@pytest.mark.parametrize(
    ("nodes", "expected"), [(gauss_nodes(8), 16), (radau_nodes(5), 9), (radau_nodes(7), 13)]
)
def test_order_of_many_stages_is_that_of_the_quadrature(
    nodes: tuple[Decimal, ...], expected: int
) -> None:
    assert Tableau("test", *collocation(nodes)).order == expected


def test_another_matrix_is_no_collocation_method() -> None:
    nodes = gauss_nodes(3)
    A, _ = collocation(nodes)
    assert is_collocation(A, nodes)
    changed = [list(row) for row in A]
    changed[0][1] += Decimal("1e-30")
    changed[0][2] -= Decimal("1e-30")  # the row sums stay
    assert not is_collocation(changed, nodes)


@pytest.mark.parametrize("stages", [4, 8])
def test_stability_functions_of_gauss_methods_are_symmetric_fractions(stages: int) -> None:
    from solvers.runge_kutta.stability_function import StabilityFunction

    function = StabilityFunction.of(Tableau("test", *collocation(gauss_nodes(stages))))
    expected = Fraction(1)
    for k in range(1, stages + 1):  # of the diagonal Padé approximation of exp
        expected *= Fraction(stages - k + 1, (2 * stages - k + 1) * k)
        assert function.numerator[k] == expected
        assert function.denominator[k] == (-1) ** k * expected


def test_the_matrix_of_the_adjoint_conditions_is_no_radau_method() -> None:
    """Radau's nodes and weights with the matrix that Butcher's conditions D(3) determine.

    The sum of b_i c_i^(k - 1) a_ij over i is b_j (1 - c_j^k)/k for k from 1 to 3. The order is 5,
    too, but stages are no values of a polynomial (E. Hairer, G. Wanner, section IV.5).
    """
    c = radau_nodes(3)
    _, b = collocation(c)
    nodes, weights = np.array(c, float), np.array(b, float)
    k = np.arange(1, 4)[:, np.newaxis]
    matrix = np.linalg.solve(weights * nodes ** (k - 1), weights * (1 - nodes**k) / k)
    assert np.allclose(matrix.sum(axis=1), nodes)
    *rows, (last, *_) = ([Decimal(repr(a)) for a in row] for row in matrix.tolist())
    rows.append([last, 1 - last, Decimal(0)])
    method = Tableau("test", tuple(map(tuple, rows)), tuple(b))
    vars(method)["order"] = 5  # to the digits of these doubles
    assert not method.is_radau
    same = Tableau("test", *collocation(c))
    assert (same.order, same.is_radau) == (5, True)
