"""Radau methods with variable order: orders chosen, beside those of the reference in Python."""

from types import ModuleType

import numpy as np
import pytest
from case_choice import planted

import generated.double_pendulum as dp
from solvers.app.modules import load as load_module
from solvers.integration.compiled import method_source
from solvers.integration.compiled.kernel import Batch, Kernel
from solvers.integration.compiled.memory_layout import STATUSES
from solvers.integration.compiled.method_source import IMPLICIT_FILES
from solvers.integration.integrate import integrate
from solvers.integration.loops import python_loop
from solvers.integration.problem.problem import Options, Problem
from solvers.integration.problem.status import Status
from solvers.integration.problem.validation import problem
from solvers.integration.results.recorder import Outcome
from solvers.runge_kutta.method_catalogue import load, names
from solvers.runge_kutta.newton_stages import Newton, NewtonStages, Start
from solvers.runge_kutta.step_control import FAST, SLOW, OrderChoice
from solvers.scenes.scene_reading import find
from solvers.studies import stability

ORDERS = tuple(method.order for method in load("radau").members)
FIXED = ("radau3", "radau5", "radau7")
START = (1.0, 2.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def van_der_pol(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    file = tmp_path_factory.mktemp("systems") / "van_der_pol.toml"
    file.write_text(
        """
title = "A van der Pol oscillator: friction that drives small motions"
potential = "k*x**2/2"
forces = { x = "mu*(1 - x**2)*x_dot" }
[coordinates]
x = { unit = "m" }
[parameters]
m = { value = 1, unit = "kg" }
k = { value = 1, unit = "N/m" }
mu = { value = 1000, unit = "N s/m" }
[[masses]]
mass = "m"
position = ["x", "0"]
"""
    )
    return load_module(str(file))


def relaxation(module: ModuleType, mu: float, end: float, tolerance: float) -> Problem:
    options = Options("radau", None, tolerance, tolerance)
    return problem(module, (0.0, end), (2.0, 0.0), (1.0, 1.0, mu), options)


def orders_in_c(run: Problem) -> tuple[list[int], Batch]:
    """The order of every step of the compiled loop, which pauses after each, and the end."""
    built = Kernel(run.form.module, "lagrangian", "radau")
    batch, orders = Batch(built, run, capacity=1, pauses=True), []
    while STATUSES[batch.motions["status"][0]] is None:
        batch.restart()
        batch.run()
        batch.motions["rows"] = 0
        if batch.motions["steps"][0] > len(orders):
            orders.append(ORDERS[int(batch.motions["last_order"][0, 0])])
    return orders, batch


def orders_in_python(run: Problem) -> tuple[list[int], Outcome]:
    """The order of every step of the reference, and its outcome."""
    orders: list[int] = []

    class Recorded(OrderChoice):
        def advance(self, contraction: float, factor: float) -> None:
            orders.append(ORDERS[self.index])
            super().advance(contraction, factor)

    outcome = Outcome.at_start(run)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(python_loop, "OrderChoice", Recorded)
        python_loop.run(run, outcome)
    return orders, outcome


#: Mistakes in the C of the choice of the order and of the predictor.
MISTAKES = {
    "none": ("", ""),
    "the order never falls": ("start->order[0] + 1,", "start->order[0],"),
    "the order never rises": ("end->order[0] = lane_fmax(end->order[0] - 1, 0);", ""),
    "thresholds exchanged": ("FAST = 0.002, SLOW = 0.8", "FAST = 0.8, SLOW = 0.002"),
    "slow steps are forgotten": ("start->contraction[0]/2", "0"),
    "nodes of another order": ("extrapolate(method_of_last_step(start)", "extrapolate(method"),
    "the trend of another order": ("method == method_of_last_step(start)", "1"),
    "matrices of another order": (" && now->method == method", ""),
}


@pytest.fixture(scope="module")
def references(van_der_pol: ModuleType) -> list[tuple[Problem, list[int], Outcome]]:
    """Runs in Python with steps of all orders."""
    runs = relaxation(van_der_pol, 10.0, 20.0, 1e-5), relaxation(van_der_pol, 5.0, 10.0, 1e-7)
    return [(run, *orders_in_python(run)) for run in runs]


@pytest.mark.parametrize("mistake", planted(MISTAKES, keep=1))
def test_python_and_c_choose_the_same_orders(
    mistake: str,
    references: list[tuple[Problem, list[int], Outcome]],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    source, (right, wrong) = method_source.source, MISTAKES[mistake]
    if right:
        assert any(right in source(f"{name}.h") for name in IMPLICIT_FILES)
        monkeypatch.setattr(method_source, "source", lambda f: source(f).replace(right, wrong))
    same = []
    for run, expected, reference in references:
        orders, batch = orders_in_c(run)
        same += [orders == expected, batch.motions["rejected"][0] == reference.rejected]
        # C evaluates the derivative anew after a rejection, and all stages of a step that fails
        same.append(0 <= batch.nfev[0] - reference.nfev - reference.rejected < 12)
    assert all(same) == (mistake == "none")


def test_all_orders_are_chosen(references: list[tuple[Problem, list[int], Outcome]]) -> None:
    assert {*references[0][1]} == {*ORDERS}


def test_orders_rise_as_the_tolerance_decreases(van_der_pol: ModuleType) -> None:
    means = []
    for tolerance in (1e-3, 1e-7, 1e-11):
        orders, _ = orders_in_c(relaxation(van_der_pol, 1000.0, 2000.0, tolerance))
        means.append(np.mean(orders))
        if tolerance == 1e-3:
            assert orders.count(5) > 0.6 * len(orders)
        if tolerance == 1e-11:
            assert orders.count(13) > 0.3 * len(orders)
            assert orders.count(5) < 0.1 * len(orders)
    assert sorted(means) == means


@pytest.mark.long("other tests reach its code")
def test_it_needs_about_as_many_evaluations_as_the_best_order(van_der_pol: ModuleType) -> None:
    run, gains = ((0, 2000), (2.0, 0.0), (1.0, 1.0, 1000.0)), []
    for tolerance in 10.0 ** -np.arange(3, 12):
        options = {"rtol": tolerance, "atol": tolerance, "t_eval": [2000.0]}
        least = min(integrate(van_der_pol, *run, method=name, **options).nfev for name in FIXED)
        gains.append(least / integrate(van_der_pol, *run, method="radau", **options).nfev)
    assert min(gains) > 0.6  # radau3 and radau7 need over three times the least at some
    assert max(gains) > 1.15


def test_the_polynomial_of_another_order_predicts_the_stages() -> None:
    # derivatives t² of a step from 0 to 1, extrapolated to one from 1 to 3
    def rhs(t: float, y: np.ndarray) -> np.ndarray:
        return np.array([t**2])

    members = load("radau").members
    for last in members:
        for method in members:
            newton = Newton(method, rhs, lambda t, y: np.zeros((1, 1)), 1e-12, 1e-12)
            c = np.array(last.c, float)
            stages = NewtonStages(1.0, c, c[:, np.newaxis] ** 2, 0.0, np.zeros(1), 0.0)
            calls = []
            newton._derivative = lambda t, y, calls=calls: calls.append(t) or rhs(t, y)
            newton.solve(Start(1.0, np.array([1 / 3]), 2.0), rhs(1.0, np.zeros(1)), stages)
            assert len(calls) == method.stages  # one iteration


def test_the_order_rises_only_where_the_iteration_contracts_fast() -> None:
    choice = OrderChoice(2, index=1)
    choice.advance(0.01, 1.0)
    assert choice.index == 1
    choice.advance(0.0, 1.0)
    assert choice.index == 1  # the last contraction counts by half
    choice.advance(0.0, 1.0)
    choice.advance(0.0, 1.0)
    assert choice.index == 0


def test_the_rule_of_the_order() -> None:
    choice = OrderChoice(3)
    for _ in range(3):
        choice.lower()
    assert choice.index == 2
    choice.advance(FAST / 2, 1.0)
    assert (choice.index, choice.last) == (1, 2)
    choice.advance(FAST / 2, 3.0)  # the step size grows
    choice.advance(2 * FAST, 1.0)  # the contraction is too slow
    assert choice.index == 1
    choice.advance(SLOW, 1.0)
    assert choice.index == 2
    for _ in range(9):
        assert choice.index == 2
        choice.advance(FAST / 2, 1.0)
    assert choice.index == 1


def test_fixed_steps_have_the_highest_order() -> None:
    ends = [
        integrate(dp, (0, 1), START, dp.DEFAULTS, method=name, h=0.1, backend=backend).y[:, -1]
        for name, backend in (("radau", "compiled"), ("radau7", "compiled"), ("radau", "python"))
    ]
    assert np.array_equal(ends[0], ends[1])
    assert np.abs(ends[0] - ends[2]).max() < 1e-12


def test_steps_within_a_step_have_its_order(van_der_pol: ModuleType) -> None:
    # samples are the ends of shorter steps; with them no other steps are taken
    run = van_der_pol, (0, 20), (2.0, 0.0), (1.0, 1.0, 10.0)
    options = {"method": "radau", "rtol": 1e-6, "atol": 1e-6}
    times = np.linspace(0.05, 20, 400)
    exact = integrate(*run, method="verner98", rtol=1e-12, atol=1e-12, t_eval=times)
    plain = integrate(*run, **options)
    for backend in ("compiled", "python"):
        sampled = integrate(*run, **options, t_eval=times, backend=backend)
        assert sampled.steps == plain.steps
        assert sampled.status is Status.FINISHED
        assert np.abs(sampled.y - exact.y).max() < 1e-4


def test_the_stability_study_has_fixed_steps_of_each_method_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    methods: list[str] = []
    monkeypatch.setattr(stability, "critical_step", lambda name, *_: methods.append(name))
    stability.SceneStability.of(find("report", load_module))
    left_out = {name for name in {*names()} - {*methods} if not load(name).is_splitting}
    assert left_out == {"radau"}
