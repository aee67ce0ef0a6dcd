"""Tableaus: orders proved and observed, and what is derived from the numbers alone."""

import re
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from importlib import import_module
from math import isclose, sqrt

import numpy as np
import pytest
from mpmath import cos as mpcos
from mpmath import exp as mpexp
from mpmath import fdot, mpf, workdps
from mpmath import log as mplog
from mpmath import sin as mpsin

from solvers.runge_kutta import methods
from solvers.runge_kutta.method_catalogue import UnknownMethodError, load, names
from solvers.runge_kutta.order_conditions import density, order, trees
from solvers.runge_kutta.stepper import Rhs, Stepper, evaluated
from solvers.runge_kutta.surd import Surd
from solvers.runge_kutta.tableau import Tableau

RUNGE_KUTTA = [name for name in names() if not load(name).is_splitting]
EXPLICIT = [name for name in RUNGE_KUTTA if load(name).is_explicit]

#: Properties that the docstring of a method states, as published.
STATEMENT = re.compile(
    r".*orders? (?P<order>\d+)(?: and (?P<embedded>\d+))?, (?P<stages>\d+) stages?"
    r"(?:, with error estimates of orders (?P<first>\d+) and (?P<second>\d+))?"
    r"(?P<fsal>; the last is the next step's first)?"
)


def stated(name: str) -> dict[str, int]:
    """What the first line of a method's docstring states; 0 for what it does not mention."""
    match = STATEMENT.match(documentation(name).replace("\n", " "))
    assert match, f"{name}.py does not state its order and stages"
    numbers = {key: int(value or 0) for key, value in match.groupdict().items() if key != "fsal"}
    return numbers | {"fsal": bool(match["fsal"])}


def documentation(name: str) -> str:
    return str(import_module(f"{methods.__name__}.{name}").__doc__)


def test_there_are_as_many_rooted_trees_as_published() -> None:
    # OEIS A000081
    assert [len(trees(n)) for n in range(1, 11)] == [1, 1, 2, 4, 9, 20, 48, 115, 286, 719]


def test_densities_are_those_of_the_textbook() -> None:
    # Hairer, Nørsett and Wanner, table II.2.2, up to order 4
    assert sorted(density(tree) for n in range(1, 5) for tree in trees(n)) == [
        1,
        2,
        3,
        4,
        6,
        8,
        12,
        24,
    ]


@pytest.mark.parametrize("name", names())
def test_each_method_has_its_published_properties_by_proof(name: str) -> None:
    method = load(name)
    published = stated(name)
    assert method.order == published["order"]
    assert method.embedded_order == published["embedded"] + published["first"]
    assert method.stages == published["stages"]
    assert method.is_fsal == published["fsal"]


@pytest.mark.parametrize("name", names())
def test_each_method_names_its_source(name: str) -> None:
    assert re.search(r"\(\d{4}\)|\bsection\b|\btable\b", documentation(name))


@pytest.mark.parametrize("name", names())
def test_coefficients_that_can_be_exact_are(name: str) -> None:
    method = load(name)
    kinds = {type(x) for row in (*method.A, method.b, method.b_hat, method.b_low) for x in row}
    has_decimals = "decimals" in documentation(name)
    assert kinds <= ({Decimal} if has_decimals else {Fraction, Surd})


@pytest.mark.long("more cases of the same kind", keep=12)
@pytest.mark.parametrize("name", RUNGE_KUTTA)
def test_a_mistake_in_any_coefficient_loses_the_order(name: str) -> None:
    method = load(name)
    # in rounded decimals the fifteenth significant digit: beyond what a float would show
    for i, row in enumerate(method.A):
        for j, a in enumerate(row):
            if a != 0:
                wrong = [list(r) for r in method.A]
                wrong[i][j] = a + abs(a) / 10**15
                assert order(wrong, method.b) < method.order or (
                    method.b_hat and order(wrong, method.b_hat) < method.embedded_order
                )
    low = order(method.A, method.b_low) if method.b_low else 0
    assert low == stated(name)["second"]
    for weights, expected in (
        (method.b, method.order),
        (method.b_hat, method.embedded_order),
        (method.b_low, low),
    ):
        for j, b in enumerate(weights):
            if b != 0:
                changed = [*weights[:j], b + abs(b) / 10**15, *weights[j + 1 :]]
                assert order(method.A, changed) < expected


@pytest.mark.long("more cases of the same kind", keep=4)
@pytest.mark.parametrize("name", EXPLICIT)
def test_the_proved_order_is_observed(name: str) -> None:
    # y' = y cos t has y = exp(sin t) and depends on time; 50 digits leave room to converge
    method = load(name)

    def error(steps: int) -> mpf:
        y, h = mpf(1), mpf(2) / steps
        A, b, c = [[exact(x) for x in row] for row in method.A], method.b, method.c
        for n in range(steps):
            k: list[mpf] = []
            for row, node in zip(A, map(exact, c), strict=True):
                moved = y + h * fdot(row[: len(k)], k)
                k.append(moved * mpcos((n + node) * h))
            y += h * fdot(map(exact, b), k)
        return abs(y - mpexp(mpsin(2)))

    with workdps(50):
        steps = 1000 if method.order <= 5 else 200
        observed = mplog(error(steps) / error(2 * steps), 2)
        assert float(observed) == pytest.approx(method.order, abs=0.1)


def exact(number: Fraction | Decimal) -> mpf:
    numerator, denominator = number.as_integer_ratio()
    return mpf(numerator) / denominator


def one_step(name: str, rhs: Rhs, y: list[float], jacobian: Rhs | None = None) -> np.ndarray:
    """A step of length 1 from t = 0, by the running stepper."""
    stepper, start = Stepper(load(name), rhs, jacobian), np.array(y)
    return stepper.step(0.0, start, 1.0, stepper.derivative(0.0, start))[0]


@pytest.mark.parametrize("name", RUNGE_KUTTA)
def test_one_step_multiplies_by_the_stability_function(name: str) -> None:
    # as a black box: y' = λy for complex λ, written as two real equations
    numerator, denominator = (
        [float(a) for a in coefficients[::-1]] for coefficients in load(name).stability_function
    )
    for z in (0.3 + 0.2j, -1.0 + 0.5j, -0.2 - 2.0j):
        matrix = np.array([[z.real, -z.imag], [z.imag, z.real]])
        end = one_step(name, lambda t, y, m=matrix: m @ y, [1.0, 0.0], lambda t, y, m=matrix: m)
        assert complex(*end) == pytest.approx(
            np.polyval(numerator, z) / np.polyval(denominator, z), rel=1e-11
        )


@pytest.mark.parametrize("name", EXPLICIT)
def test_coefficients_are_read_back_from_the_running_stepper(name: str) -> None:
    # a right-hand side that is 1 in one stage only reveals the coefficients that multiply it
    method = load(name)
    arguments: list[tuple[float, float]] = []
    for j in range(method.stages):
        arguments.clear()

        def rhs(t: float, y: np.ndarray, j: int = j) -> np.ndarray:
            arguments.append((t, float(y[0])))
            return np.array([float(len(arguments) == j + 1)])

        end = one_step(name, rhs, [0.0])
        assert end[0] == float(method.b[j])
        assert [y for _, y in arguments] == [float(row[j]) for row in method.A]
        assert [t for t, _ in arguments] == [float(c) for c in method.c]


@pytest.mark.parametrize(
    ("name", "numerator", "denominator"),
    [
        ("rk4", [1, 1, "1/2", "1/6", "1/24"], [1]),
        ("gauss1", [1, "1/2"], [1, "-1/2"]),
        ("gauss2", [1, "1/2", "1/12"], [1, "-1/2", "1/12"]),
        ("gauss3", [1, "1/2", "1/10", "1/120"], [1, "-1/2", "1/10", "-1/120"]),
        ("radau2", [1, "1/3"], [1, "-2/3", "1/6"]),
        ("radau3", [1, "2/5", "1/20"], [1, "-3/5", "3/20", "-1/60"]),
    ],
)
def test_stability_functions_are_the_published_ones(
    name: str, numerator: list[str], denominator: list[str]
) -> None:
    # Taylor sections and Padé approximants of the exponential, exactly
    found = load(name).stability_function
    assert found == (tuple(map(Fraction, numerator)), tuple(map(Fraction, denominator)))


@pytest.mark.parametrize("text", [
    "0 0; 1/2 1/2",  # the trapezoidal rule
    "0 0 0; 5/24 1/3 -1/24; 1/6 2/3 1/6",  # Lobatto IIIA: the first stage is explicit
    "1/6 -1/6 0; 1/6 1/3 0; 1/6 5/6 0",  # Lobatto IIIB: no stage needs the last one
    "1/2 0; 0 1/2",  # stages that need themselves only
])  # fmt: skip
def test_an_implicit_method_may_have_zeros(text: str) -> None:
    A = tuple(tuple(map(Fraction, row.split())) for row in text.split(";"))
    assert not Tableau("", A, A[-1]).is_explicit
    assert not Tableau("", A, A[-1]).is_fsal


@pytest.mark.parametrize("name", ["gauss1", "gauss2", "gauss3"])
def test_gauss_methods_are_symplectic_and_others_are_not(name: str) -> None:
    # b_i a_ij + b_j a_ji = b_i b_j (Hairer, Lubich and Wanner, theorem VI.4.3)
    def is_symplectic(method: Tableau) -> bool:
        stages = range(method.stages)
        A, b = method.A, method.b
        return all(b[i] * A[i][j] + b[j] * A[j][i] == b[i] * b[j] for i in stages for j in stages)

    assert is_symplectic(load(name))
    assert not is_symplectic(load("radau3"))
    assert not is_symplectic(load("rk4"))


def test_nodes_of_gauss_are_roots_of_the_legendre_polynomial() -> None:
    roots = (np.polynomial.legendre.leggauss(3)[0] + 1) / 2
    assert np.allclose([float(c) for c in load("gauss3").c], roots, rtol=0, atol=1e-16)


def test_error_weights_estimate_nothing_where_the_solution_is_constant() -> None:
    for name in names():
        method = load(name)
        if method.b_hat:
            for weights in method.error_weights:
                assert abs(float(sum(weights))) < 1e-25
                assert any(w != 0 for w in weights)


def test_an_unknown_method_is_refused_with_those_that_exist() -> None:
    with pytest.raises(UnknownMethodError, match=r"did you mean 'rk4'\?.*verner98"):
        load("rk5")


def test_a_method_without_its_embedded_weights_estimates_no_error() -> None:
    bare = replace(load("dp54"), b_hat=())
    assert bare.embedded_order == 0
    assert bare.error_weights == ()


def test_surds_compute_exactly() -> None:
    r = Surd.root(3)
    assert r * r == 3
    assert (1 + r) * (1 - r) == -2
    assert (r / 6 - Fraction(1, 2)) + Fraction(1, 2) == r / 6
    assert r != Fraction(7, 4)
    assert hash(0 * r + 2) == hash(Fraction(2))
    assert isclose(float(r), sqrt(3), rel_tol=2e-16)
    # 26² = 676 and 15² · 3 = 675: the parts cancel to three digits, the value keeps all
    assert isclose(float(26 - 15 * r), 1 / (26 + 15 * sqrt(3)), rel_tol=1e-13)
    assert abs(1 - r) == r - 1


@pytest.mark.parametrize("value", [[1.0, [2.0]], [[1.0], [2.0, 3.0]]])
def test_a_derivative_with_parts_of_different_lengths_is_refused(value: list[object]) -> None:
    with pytest.raises(ValueError, match=r"right-hand side at t = 0.5, .* of shape \(1,\)"):
        evaluated("right-hand side", lambda t, y: value, 0.5, np.zeros(1), (1,))  # type: ignore
