"""Splittings: orders proved and observed, symplectic and symmetric steps, stability."""

from collections import Counter
from math import comb, prod

import numpy as np
import pytest
from mpmath import exp as mpexp
from mpmath import log as mplog
from mpmath import mpf, workdps

from solvers.runge_kutta.method_catalogue import load, names
from solvers.runge_kutta.order_conditions import alternating_trees, nystrom_order
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.runge_kutta.stepper import Rhs, Stepper
from solvers.runge_kutta.tableau import Splitting

SPLITTINGS = [name for name in names() if load(name).is_splitting]
Array = np.ndarray


def splitting(name: str) -> Splitting:
    method = load(name)
    assert isinstance(method, Splitting)
    return method


def changed(name: str, kick: int | None = None, drift: int | None = None) -> int:
    """The order of the method with another fifteenth digit of one coefficient."""
    method = splitting(name)
    b, d = [*method.b], [*method.drifts]
    for numbers, index in ((b, kick), (d, drift)):
        if index is not None:
            numbers[index] += abs(numbers[index]) / 10**15
    stages = range(method.stages)
    zero = b[0] - b[0]
    A = [[b[j] if j < i else zero for j in stages] for i in stages]
    A_hat = [[d[j] if j <= i else zero for j in stages] for i in stages]
    return nystrom_order(A, b, A_hat, d)


def test_splittings_have_orders_two_to_eight() -> None:
    assert {name: load(name).order for name in SPLITTINGS} == {
        "leapfrog": 2, "leapfrog4": 4, "leapfrog6": 6, "leapfrog8": 8
    }  # fmt: skip


def test_there_are_as_many_alternating_trees_as_multisets_of_branches() -> None:
    # a branch of an acceleration is a velocity, alone or with a tree of an acceleration
    counts = [0, 1]
    for n in range(2, 10):
        branches = {k: (k == 1) + (counts[k - 1] if k > 1 else 0) for k in range(1, n)}
        forests = 0
        for partition in partitions(n - 1, n - 1):
            forests += prod(
                comb(branches[size] + number - 1, number)
                for size, number in Counter(partition).items()
            )
        counts.append(forests)
    assert [len(alternating_trees(n, 1)) for n in range(1, 10)] == counts[1:]
    # below a velocity there is at most one tree of an acceleration
    assert [len(alternating_trees(n, 0)) for n in range(2, 10)] == counts[1:-1]


def partitions(total: int, largest: int) -> list[list[int]]:
    if total == 0:
        return [[]]
    sizes = range(min(total, largest), 0, -1)
    return [[size, *rest] for size in sizes for rest in partitions(total - size, size)]


@pytest.mark.parametrize("name", SPLITTINGS)
def test_a_mistake_in_any_kick_or_drift_loses_the_order(name: str) -> None:
    method = splitting(name)
    assert changed(name) == method.order
    for k in range(method.stages):
        assert changed(name, kick=k) < method.order
        assert k == 0 or changed(name, drift=k) < method.order


@pytest.mark.parametrize("name", SPLITTINGS)
def test_the_proved_order_is_observed(name: str) -> None:
    # q'' = log(1 + t) - q - exp(-2 q) depends on time, and q = log(1 + t) solves it
    method = splitting(name)

    def error(steps: int) -> mpf:
        q, v, h = mpf(0), mpf(1), mpf(2) / steps
        kicks, drifts = ([*map(digits, numbers)] for numbers in (method.b, method.drifts))
        for n in range(steps):
            t = n * h
            for kick, drift in zip(kicks, drifts, strict=True):
                t, q = t + drift * h, q + drift * h * v
                v += kick * h * (mplog(1 + t) - q - mpexp(-2 * q))
        return abs(q - mplog(3)) + abs(v - mpf(1) / 3)

    with workdps(40):
        observed = mplog(error(40) / error(80), 2)
        assert float(observed) == pytest.approx(method.order, abs=0.1)


def digits(number: object) -> mpf:
    numerator, denominator = number.as_integer_ratio()  # type: ignore[attr-defined]
    return mpf(numerator) / denominator


def with_tangents(t: float, y: Array) -> Array:
    """Hénon and Heiles' equations of a position and of four small changes of it, in columns."""
    q, velocities = np.split(y, 2)
    (x, y1), changes = q[:2], q[2:].reshape(2, 4)
    accelerations = [-x - 2 * x * y1, -y1 - x * x + y1 * y1]
    gradient = -np.array([[1 + 2 * y1, 2 * x], [2 * x, 1 - 2 * y1]])
    return np.concatenate([velocities, accelerations, (gradient @ changes).ravel()])


def defect_of_symplecticity(name: str) -> float:
    """The largest entry of Jᵀ Ω J - Ω for the Jacobian J of a step."""
    stepper, identity = Stepper(load(name), with_tangents), np.eye(4)
    start = np.array([0.3, 0.2, *identity[:2].ravel(), 0.4, -0.3, *identity[2:].ravel()])
    end = stepper.step(0.0, start, 0.5, stepper.derivative(0.0, start)).y
    J = np.vstack([end[2:10].reshape(2, 4), end[12:].reshape(2, 4)])
    omega = np.kron([[0, 1], [-1, 0]], np.eye(2))
    return float(np.abs(J.T @ omega @ J - omega).max())


@pytest.mark.parametrize("name", SPLITTINGS)
def test_steps_are_symplectic_to_rounding(name: str) -> None:
    assert defect_of_symplecticity(name) < 20 * 2.2e-16
    assert defect_of_symplecticity("rk4") > 1e-6
    assert defect_of_symplecticity("verner98") > 1e-11


@pytest.mark.parametrize("name", SPLITTINGS)
def test_steps_lead_back_to_rounding(name: str) -> None:
    def rhs(t: float, y: Array) -> Array:
        return np.array([y[1], -np.sin(y[0]) + np.cos(t)])

    def back(name: str) -> float:
        start = np.array([1.2, 0.7])
        end = one_step(name, rhs, 0.0, start, 0.5)
        return float(np.abs(one_step(name, rhs, 0.5, end, -0.5) - start).max())

    assert back(name) < 10 * 2.2e-16
    assert back("rk4") > 1e-6


def one_step(name: str, rhs: Rhs, t: float, y: Array, h: float) -> Array:
    stepper = Stepper(load(name), rhs)
    return stepper.step(t, y, h, stepper.derivative(t, y)).y


@pytest.mark.parametrize("name", SPLITTINGS)
def test_the_derivative_of_the_next_step_is_known(name: str) -> None:
    stepper = Stepper(load(name), with_tangents)
    start = np.linspace(0.1, 0.9, 20)
    step = stepper.step(0.0, start, 0.1, stepper.derivative(0.0, start))
    assert stepper.nfev == load(name).stages
    assert step.derivative == pytest.approx(with_tangents(0.1, step.y), rel=1e-14)


@pytest.mark.parametrize("name", SPLITTINGS)
def test_kicks_and_drifts_are_read_back_from_the_running_stepper(name: str) -> None:
    # an acceleration that is 1 at one stage only reveals the kick there, and drifts that follow
    method, positions = splitting(name), list[float]()
    b, c = [*map(float, method.b)], [*map(float, method.c)]
    for j in range(method.stages):
        positions.clear()

        def rhs(t: float, y: Array, j: int = j) -> Array:
            positions.append(float(y[0]))
            return np.array([y[1], float(len(positions) == j + 1)])

        end = one_step(name, rhs, 0.0, np.zeros(2), 1.0)
        assert end[1] == b[j]
        drifted = [b[j] * (node - c[j]) * (i > j) for i, node in enumerate(c)]
        assert positions == pytest.approx(drifted, abs=1e-15)
        assert end[0] == pytest.approx(b[j] * (1 - c[j]), abs=1e-15)


@pytest.mark.parametrize("name", SPLITTINGS)
def test_a_step_of_an_oscillator_multiplies_its_modes_by_the_stability_function(name: str) -> None:
    function = StabilityFunction.of(load(name))
    for z in (0.7j, 2.5j, 4.0j, -0.8, 1.1):
        square = (z * z).real  # q'' = λ² q
        columns = [
            one_step(name, lambda _, y, s=square: np.array([y[1], s * y[0]]), 0.0, start, 1.0)
            for start in np.eye(2)
        ]
        eigenvalues = np.linalg.eigvals(np.stack(columns, axis=1))
        assert np.abs(eigenvalues - function(z)).min() < 1e-12 * np.abs(eigenvalues).max()
        if isinstance(z, complex):
            assert abs(function(z)) == pytest.approx(np.abs(eigenvalues).max(), rel=1e-12)
        else:
            assert float(function(z).real) == pytest.approx(np.exp(z), rel=0.2)


@pytest.mark.parametrize("name", SPLITTINGS)
def test_oscillations_grow_beyond_the_stability_interval_only(name: str) -> None:
    function = StabilityFunction.of(load(name))
    interval = function.imaginary_stability_interval
    assert np.abs(function(1j * np.linspace(0, interval, 2001))).max() <= 1 + 1e-7
    assert abs(function(1.0001j * interval)) > 1 + 1e-6
    assert function.real_stability_interval == 0


def test_the_interval_of_leapfrog_is_two() -> None:
    # E. Hairer, Ch. Lubich, G. Wanner, Geometric Numerical Integration, section I.5.2
    assert StabilityFunction.of(load("leapfrog")).imaginary_stability_interval == pytest.approx(2)
