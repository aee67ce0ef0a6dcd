"""Failure modes: each study's numbers, and that it would notice if nothing failed."""

import re
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from math import inf, log, pi, sqrt
from types import SimpleNamespace

import numpy as np
import pytest
from figure_descriptions import described
from recording import Record
from scipy.integrate import solve_ivp

import generated.double_pendulum as dp
import generated.single_pendulum as sp
from solvers.app.modules import load
from solvers.equations.linearisation.normal_modes import Modes
from solvers.integration.compiled.compiler import NoCompilerError
from solvers.io.terminal import text_table
from solvers.runge_kutta.stability_function import StabilityFunction
from solvers.studies.failure_modes import (
    chaos,
    oscillation,
    separatrix,
    singular,
    stiffness,
    tolerances,
)
from solvers.studies.failure_modes.chaos import (
    CHAOTIC,
    INDEPENDENT,
    LONG_RUNS,
    OFFSET,
    Chaos,
    ChaosResults,
    Horizon,
    Mean,
    Separation,
    Statistics,
    horizon,
    lyapunov,
    reference_motion,
    separation,
    statistics,
)
from solvers.studies.failure_modes.conservation import Conservation, cost
from solvers.studies.failure_modes.drift import CASES, Drift, EnergyDrift, drift
from solvers.studies.failure_modes.study import studies


def test_each_file_that_defines_a_study_is_found() -> None:
    names = [study.name for study in studies()]
    assert names == [
        "chaos",
        "conservation",
        "drift",
        "oscillation",
        "separatrix",
        "singular",
        "stiffness",
        "tolerances",
    ]
    full, small = studies(), studies(small=True)
    assert sum(a != b for a, b in zip(full, small, strict=True)) == 6


def test_tables_are_as_wide_as_their_cells() -> None:
    rows = [("rk4", 0.5, "a"), ("verner98", float("nan"), None)]
    assert list(text_table({"method": "", "h / s": ".3f", "x": ">"}, rows)) == [
        "method    h / s  x",
        "rk4       0.500  a",
        "verner98      -  -",
    ]


@pytest.mark.parametrize(("method", "order"), [("rk1", 1), ("midpoint", 2)])
def test_euler_and_rk2_let_oscillations_grow_with_any_step(method: str, order: int) -> None:
    growths = [oscillation.growth(sp, method, float(steps)) for steps in (20, 40, 400)]
    for found in growths:
        assert found.measured > 0
        assert found.measured == pytest.approx(found.predicted, rel=1e-4)
    # halving the step reduces the growth by a power of two, but never to zero
    ratio = growths[0].measured / growths[1].measured
    assert ratio == pytest.approx(2 if order == 1 else 8, rel=0.2)


@pytest.mark.parametrize("method", ["rk3", "rk4"])
def test_rk3_and_rk4_grow_beyond_their_interval_and_not_within(method: str) -> None:
    limit = 2 * pi / {"rk3": sqrt(3), "rk4": 2 * sqrt(2)}[method]
    beyond, within = (oscillation.growth(sp, method, limit * f) for f in (0.98, 1.02))
    assert within.measured < 0 < beyond.measured
    for found in (beyond, within):
        assert found.measured == pytest.approx(found.predicted, rel=1e-4)


@pytest.mark.parametrize("ratio", [30.0, 300.0])
def test_the_frequencies_of_stiff_scenes_are_those_of_textbooks(ratio: float) -> None:
    def frequencies(family: str) -> np.ndarray:
        system, motion, _ = stiffness.FAMILIES[family]
        return Modes.at_rest(load(system), motion(ratio)[0]).frequencies

    # a rod under the mass of both, a bead amid a string, and a mass on a spring
    for family, length in (("short second rod", 1), ("light first mass", 2), ("stiff spring", 1)):
        slow, fast = frequencies(family)
        assert slow == pytest.approx(sqrt(9.81 / length), rel=3 / ratio**2)
        assert fast == pytest.approx(sqrt(9.81) * ratio, rel=3 / ratio**2)
    # of equal rods: omega^2 = g/l (1 + s)/(1 - s^2) with both signs of s^2 = m2/(m1 + m2)
    slow, fast = frequencies("light second mass")
    s = 1 / sqrt(ratio**2 + 1)
    assert (fast / slow) ** 2 == pytest.approx((1 + s) / (1 - s), rel=1e-12)


@pytest.mark.parametrize("family", ["short second rod", "stiff spring"])
def test_the_slow_angle_hardly_moves_in_the_fast_mode(family: str) -> None:
    system, motion, slow = stiffness.FAMILIES[family]
    fast = np.abs(Modes.at_rest(load(system), motion(300.0)[0]).shapes[:, -1])
    assert fast[slow] < fast.max() / 100


@pytest.mark.long("a whole study")
def test_stiff_scenes_shorten_the_steps_of_explicit_methods_only() -> None:
    methods = ("rk4", "verner853", "gauss2", "radau3")
    costs = stiffness.Stiffness((30.0, 300.0), methods).run(load)
    for family in ("short second rod", "light first mass", "stiff spring"):
        steps = {
            (c.method, k): c.steps
            for c in costs
            if c.family == family
            for k in (0, 1)
            if (c.ratio > 150) == bool(k)
        }
        for method in ("rk4", "verner853"):  # ten times as fast, ten times the steps, about
            assert 6 < steps[method, 1] / steps[method, 0] < 16, (family, method)
        for method in ("gauss2", "radau3"):
            assert steps[method, 1] <= 1.5 * steps[method, 0], (family, method)
    # without a fast mode the number of steps stays small
    light = {(c.method, k): c.steps for k, c in enumerate(costs) if c.family == "light second mass"}
    assert max(n for (m, _), n in light.items() if m == "rk4") < 100
    assert 30 < stiffness.crossover(costs, "short second rod", "work_rhs") < 100
    assert np.isnan(stiffness.crossover(costs, "light second mass", "work_rhs"))


def test_the_cheapest_run_is_the_first_of_sufficient_accuracy(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Against a program of known errors: the tolerance, or h² of a method with fixed steps."""
    exact, gap, timed = 0.25, 0.0, []

    class Run:
        def __init__(self, method: str, rtol: float, h: float | None) -> None:
            error = h**2 if h else rtol
            # references differ by their errors, too: 1e-9, and (6 / 3000)^2
            self.error = {"verner98": rtol - 1e-9, "gauss3": gap + error - 4e-6}.get(method, -error)
            self.steps = round(stiffness.DURATION / h) if h else round(1 / rtol)
            self.nfev = 4 * self.steps

        def __call__(self, span: tuple[float, float], y0: tuple[float, ...]) -> list[float]:
            assert span == (0.0, 6.0)
            return [y0[0], exact + self.error]

    def median(run: Callable[[], object]) -> float:
        timed.append(run())
        return 7e-6

    def prepared(_: object, method: str, rtol: float = 0.0, h: float | None = None) -> Run:
        return Run(method, rtol, h)

    monkeypatch.setattr(stiffness.StiffScene, "prepared", prepared)
    monkeypatch.setattr(stiffness, "median_seconds", median)
    spring = stiffness.FAMILIES["stiff spring"]
    monkeypatch.setattr(stiffness, "FAMILIES", {"stiff spring": spring})
    study = stiffness.Stiffness((30.0,), ("rk4", "dp54", "radau3", "gauss2"))
    costs = {row.method: row for row in study.run(load)}
    assert [*costs] == ["rk4", "dp54", "radau3", "gauss2"]
    # tolerances are 1e-1, 1e-1.5, ..., and steps 10, 10 √2, 20, ...: an error just below 1e-3
    fewest = next(n for n in np.ceil(10 * 2 ** np.arange(0, 9, 0.5)) if (6 / n) ** 2 < 1e-3)
    for method in ("rk4", "radau3", "gauss2"):
        assert (costs[method].steps, costs[method].work_rhs) == (fewest, 4 * fewest)
        assert costs[method].global_error == pytest.approx((6 / fewest) ** 2)
    assert costs["dp54"].global_error == pytest.approx(10**-3.5)
    for row in costs.values():
        assert (row.family, row.work_seconds) == ("stiff spring", 7e-6)
        assert row.ratio == pytest.approx(30.0, rel=3 / 30**2)
    assert [end[1] for end in timed] == [exact - row.global_error for row in costs.values()]
    # no number of steps is sufficient, and references that differ
    monkeypatch.setattr(stiffness, "STEPS", np.array([2.0]))
    assert [row.method for row in study.run(load)] == ["dp54"]
    for gap in (0.9e-5, 1.1e-5):  # a hundredth of the accuracy
        with nullcontext() if gap < 1e-5 else pytest.raises(ArithmeticError, match="references"):
            study.run(load)


def test_the_crossover_is_where_costs_are_equal() -> None:
    base = stiffness.Cost("family", "rk4", 1.0, 1, 1, 1.0, 0.0)
    costs = [
        cost
        for ratio in (1.0, 10.0, 100.0, 1000.0)
        for cost in (
            replace(base, ratio=ratio, work_seconds=ratio),
            replace(base, method="radau3", ratio=ratio, work_seconds=30.0),
        )
    ]
    assert stiffness.crossover(costs, "family", "work_seconds") == pytest.approx(30.0)
    assert stiffness.crossover(
        [
            replace(cost, ratio=60.0, work_seconds=60.0 if cost.method == "rk4" else 30.0)
            if cost.ratio == 100
            else cost
            for cost in costs[:6]
        ],
        "family",
        "work_seconds",
    ) == pytest.approx(30.0)
    assert np.isnan(stiffness.crossover(costs[:4], "family", "work_seconds"))


@pytest.mark.long("a whole study")
def test_energy_drifts_steadily_with_rk_and_stays_bounded_with_gauss() -> None:
    cases = [case for case in CASES if case[0] in ("rk4", "verner853", "gauss1", "gauss2")]
    for found in EnergyDrift(2000, tuple(cases)).run(load):
        if found.method.startswith("gauss"):
            assert abs(found.exponent) < 0.01
            assert found.largest_error == pytest.approx(found.early_error, rel=0.05)
            assert abs(found.rate) * 2000 < 0.1 * found.largest_error
        else:
            assert found.exponent == pytest.approx(1.0, abs=0.1)
            assert abs(found.rate) * 2000 == pytest.approx(found.largest_error, rel=0.2)


def test_the_energy_drift_of_rk4_is_that_of_a_loop_by_hand(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    start, steps, periods = np.array([0.5, 0.6, 0.0, 0.0]), 15, 300
    period = 2 * pi / sqrt((2 - sqrt(2)) * 9.81 / 2)  # the slow mode of two rods of 2 m

    def rate(y: np.ndarray) -> np.ndarray:
        return np.array(dp.rhs(0.0, y.tolist(), dp.DEFAULTS))

    h, states = period / steps, [start]
    for _ in range(steps * periods):
        y = states[-1]
        a = rate(y)
        b = rate(y + h / 2 * a)
        c = rate(y + h / 2 * b)
        states.append(y + h / 6 * (a + 2 * b + 2 * c + rate(y + h * c)))
    clock = iter([5.0, 5.003])
    name = "solvers.studies.failure_modes.drift.perf_counter"
    monkeypatch.setattr(name, lambda: next(clock))
    found = drift(dp, start.tolist(), periods, ("rk4", "lagrangian", steps))
    assert found.microseconds == pytest.approx(10.0)  # 3 ms of 300 periods
    places = np.round(found.periods * steps).astype(int)
    assert found.periods == pytest.approx(places / steps, abs=1e-9)
    assert (places[0], places[1]) == (0, steps)
    assert steps * periods - 2 <= places[-1] <= steps * periods
    whole = np.isin(places + steps - 1, places) | np.isin(places - steps + 1, places)
    assert whole[1:].all()  # blocks of whole periods
    assert len(places) > 10 * 3 * steps
    energy = dp.energy_many(0.0, np.array(states)[places].T, dp.DEFAULTS)
    rest = dp.energy(0.0, (0.0,) * 4, dp.DEFAULTS)
    expected = (energy - energy[0]) / (energy[0] - rest)
    assert found.energy_error == pytest.approx(expected, rel=1e-8, abs=1e-13)
    largest = np.maximum.accumulate(np.abs(expected))
    is_early = found.periods < periods / 100
    ends = largest[is_early][-1], largest[-1]
    assert (found.early_error, found.largest_error) == pytest.approx(ends, rel=1e-8)
    line = np.polyfit(found.periods, expected, 1)[0]
    power = np.polyfit(np.log(found.periods[~is_early]), np.log(largest[~is_early]), 1)[0]
    assert (found.rate, found.exponent) == pytest.approx((line, power), rel=1e-8)
    assert found.calls == pytest.approx(4 * steps, abs=1 / periods)  # and one at the start


def test_splittings_conserve_energy_at_the_least_cost() -> None:
    wanted = ("rk4", 60), ("leapfrog", 60), ("leapfrog4", 8), ("leapfrog6", 8), ("gauss4", 8)
    study = Conservation(2000, tuple((method, "lagrangian", steps) for method, steps in wanted))
    rk4, *kept = results = study.run(load)
    assert rk4.exponent == pytest.approx(1, abs=0.1)
    assert rk4.largest_error > 50 * rk4.early_error
    for found in kept:
        assert found.largest_error == pytest.approx(found.early_error, rel=0.2)
    # in calls, which unlike times repeat: of orders 4 and 6 less than a third of rk4's and gauss4's
    calls = {row.method: row.calls for row in results}
    assert max(calls["leapfrog4"], calls["leapfrog6"]) < min(calls["rk4"], calls["gauss4"]) / 2.5
    assert [row.method for row in results if row.largest_error < 1e-5] == ["leapfrog6", "gauss4"]
    figure = study.plot(results)
    for axes, name in zip(figure.axes, ("calls", "microseconds"), strict=True):
        drawn = {line.get_label(): line.get_xydata() for line in axes.lines}
        dashed = {line.get_label() for line in axes.lines if line.get_linestyle() == "--"}
        assert dashed == {"rk4"}  # which loses energy all the time
        for row in results:
            assert drawn[row.method].tolist() == [[getattr(row, name), row.largest_error]]
        low, high = axes.get_xlim()
        assert low < min(getattr(row, name) for row in results)
        assert high > max(getattr(row, name) for row in results)
    # between two runs, costs are interpolated on logarithmic axes; outside they are unknown
    coarse = replace(kept[0], microseconds=2.0, largest_error=1e-2)
    fine = replace(kept[0], microseconds=8.0, largest_error=1e-6)
    assert cost([coarse, fine], 1e-4) == pytest.approx(4.0)
    assert np.isnan(cost([coarse, fine], 1e-7))


def test_both_forms_lose_accuracy_as_the_mass_matrix_becomes_singular() -> None:
    light, lighter = singular.SingularMassMatrix((1e-4, 1e-8)).run(load)
    eps = np.finfo(float).eps
    for found in (light, lighter):
        assert found.condition == pytest.approx(4 / found.m1, rel=0.01)
        for error in (found.acceleration, found.velocity):
            assert 0.01 * eps * found.condition < error < eps * found.condition
    # over a motion, Hamilton's momenta lose more than Lagrange's velocities
    assert light.hamiltonian > 3 * light.lagrangian > 0
    assert np.isnan(lighter.lagrangian)


def test_the_reference_for_accelerations_is_exact() -> None:
    y, params = np.array([0.3, -1.0, 0.5, 2.0]), (1.0, 2.0, 1.5, 0.5, 9.81)
    exact = singular.exact_accelerations(dp, y, params)
    assert exact == pytest.approx(np.array(dp.rhs(0.0, y, params))[2:], rel=1e-14)


@pytest.mark.long("other tests reach its code")
def test_the_lyapunov_exponent_of_a_linear_saddle_is_its_rate() -> None:
    # about upright at rest the single pendulum grows by e^(omega t), exactly
    found = lyapunov(sp, (1.0, 9.81, -9.81), (0.0, 0.0), 50)
    assert found.value == pytest.approx(1.0, rel=1e-7)
    assert found.error < 1e-7
    # and regular motion has none
    regular = lyapunov(sp, sp.DEFAULTS, (1.0, 0.0), 20_000)
    assert 0 <= regular.value < 1e-3


def test_a_lyapunov_exponent_is_found_without_a_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(*_: object, **__: object) -> None:
        raise NoCompilerError("no cc")

    monkeypatch.setattr(chaos, "prepare", missing)
    monkeypatch.setattr(chaos, "TRANSIENT", 1)
    # about upright at rest perturbations (1, 1) grow by e^t, exactly
    assert lyapunov(sp, (1.0, 9.81, -9.81), (0.0, 0.0), 8).value == pytest.approx(1.0, rel=1e-7)


def test_the_standard_error_of_a_mean_is_that_of_repeated_means() -> None:
    generator = np.random.default_rng(1)
    walk = generator.normal(size=(200, 4000))
    for k in range(1, 4000):  # neighbours depend on each other
        walk[:, k] += 0.8 * walk[:, k - 1]
    means = [Mean.of(row, 40 * INDEPENDENT) for row in walk]
    spread = np.std([m.value for m in means])
    assert np.mean([m.error for m in means]) == pytest.approx(spread, rel=0.15)


def test_means_of_a_motion_are_those_by_another_program() -> None:
    def rates(t: float, y: np.ndarray) -> list[float]:
        mass, v = dp.mass_matrix(t, y[:4], dp.DEFAULTS), y[2:4]
        return [*dp.rhs(t, y[:4], dp.DEFAULTS), v @ mass @ v / 2, float(np.cos(y[1]) < 0)]

    found = statistics(dp, 8.0, {"method": "verner98", "rtol": 1e-11, "atol": 1e-11})
    start = (*CHAOTIC, 0.0, 0.0)
    mean = solve_ivp(rates, (0, 8), start, "DOP853", rtol=1e-9, max_step=0.01).y[4:, -1] / 8
    assert found.run == "Verner 9(8), rational form, rtol = 1e-11"
    # one sample in half a second
    assert (found.kinetic.value, found.upright.value) == pytest.approx(mean, rel=0.1)


@pytest.mark.long("a study of chaos")
def test_a_small_difference_grows_as_variational_equations_predict(
    chaotic: ChaosResults,
) -> None:
    exponent, apart = chaotic.exponent, chaotic.separation
    assert exponent.value == pytest.approx(0.883, abs=4 * exponent.error)
    small = apart.distance < 1e-5
    assert apart.distance[small] == pytest.approx(apart.predicted[small], rel=1e-3)
    assert apart.distance[-1] > 1e5 * apart.distance[0]
    assert apart.rate == pytest.approx(exponent.value, rel=0.3)


@pytest.mark.long("a study of chaos")
def test_trajectories_are_lost_at_the_predicted_horizon_and_energy_is_not(
    chaotic: ChaosResults,
) -> None:
    reached = [h for h in chaotic.horizons if h.measured < np.inf]
    assert len(reached) >= 4
    for found in reached:
        assert found.predicted == log(1 / found.tolerance) / chaotic.exponent.value
        assert 0.6 < found.measured / found.predicted < 1.4
        assert found.energy_error < 1000 * found.tolerance


@pytest.mark.long("a study of chaos")
def test_beyond_the_horizon_means_agree_unless_energy_drifts(chaotic: ChaosResults) -> None:
    *accurate, drifting = chaotic.statistics
    assert len(accurate) == len(LONG_RUNS) - 1
    for first in accurate:
        for second in accurate:
            for name in ("kinetic", "upright"):
                a, b = getattr(first, name), getattr(second, name)
                assert abs(a.value - b.value) < 4 * np.hypot(a.error, b.error)
    assert abs(drifting.energy_error) > 0.05
    assert max(abs(run.energy_error) for run in accurate) < 0.01
    # the mean of the accurate runs has a smaller error than each of them
    kinetic = [run.kinetic for run in accurate]
    error = np.hypot(
        drifting.kinetic.error, np.hypot.reduce([k.error for k in kinetic]) / len(kinetic)
    )
    assert abs(drifting.kinetic.value - np.mean([k.value for k in kinetic])) > 2 * error


def test_errors_near_upright_grow_as_the_motion_amplifies_them() -> None:
    found = separatrix.sensitivity(sp)
    far, near = found[0], found[-1]
    assert near.amplification / far.amplification > 1e5
    for row in found:
        # ten seconds hold one fall from a small distance, several from a large one
        assert 0.99 < row.amplification / row.predicted < (1.01 if row.distance < 2e-3 else 6)
        assert row.error < 10 * separatrix.TOLERANCE * row.amplification


@pytest.mark.long("a whole study", keep=1)
@pytest.mark.parametrize(("methods", "least"), [(("dp54",), 2), (separatrix.METHODS, 8)])
def test_on_the_separatrix_runs_depart_when_their_energy_predicts(
    methods: tuple[str, ...], least: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(separatrix, "METHODS", methods)
    found = [row for row in separatrix.departures(sp) if abs(row.defect) > 1e-13]
    assert len(found) > least
    for row in found:
        assert row.measured == pytest.approx(row.predicted, rel=1e-3)
    if least > 2:
        assert {np.sign(row.defect) for row in found} == {-1.0, 1.0}


def test_a_pendulum_at_the_number_nearest_to_pi_falls() -> None:
    found = separatrix.upright(sp)
    assert found.measured == pytest.approx(found.predicted, rel=1e-9)
    assert 15 < found.measured < 20


def test_a_difference_at_the_upright_equilibrium_grows_as_a_saddle() -> None:
    omega, t = sqrt(9.81 / 2), np.linspace(0, 4, 41)
    apart = separation(sp, t, np.tile([pi, 0.0], (41, 1)))
    exact = (pi + OFFSET - pi) * np.hypot(np.cosh(omega * t), omega * np.sinh(omega * t))
    assert apart.predicted == pytest.approx(exact, rel=1e-6)
    # the first reference, released at rest at the number nearest to pi, stays there
    assert apart.distance == pytest.approx(exact, rel=1e-3)
    assert apart.rate == pytest.approx(np.polyfit(t[1:], np.log(exact[1:]), 1)[0], rel=1e-3)


def test_achieved_errors_are_relative_to_tolerances_and_to_the_growth_of_errors(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Against programs with known errors: tolerance times 1, 2, 4 and 8, and growth by 3."""

    def taylor(_: object, params: object, y0: list[float], *_more: object, **_k: object) -> object:
        return np.array([y0, y0])

    def ensemble(
        _: object, span: object, y0: np.ndarray, params: np.ndarray, form: str = "", **given: float
    ) -> SimpleNamespace:
        y = np.array(y0)
        if form == "variational":
            y[4:] *= np.array([[3.0, 1.0, -2.0, 0.5]]) if y[6, 0] else 0.1
        else:
            y[2] += given["rtol"] * np.array([1.0, 4.0, -8.0, 2.0])
        return SimpleNamespace(y=y)

    monkeypatch.setattr(tolerances, "taylor", taylor)
    monkeypatch.setattr(tolerances, "ensemble", ensemble)
    for row in tolerances.Tolerances(("one",), 4).run(load):
        assert (row.median, row.worst) == pytest.approx((3.0, 8.0), rel=1e-3)
        # 1/3, 4, 4 and 4
        assert row.relative_to_growth == pytest.approx(4.0, rel=1e-3)


@pytest.mark.long("a study of chaos")
def test_errors_exceed_tolerances_as_the_motion_grows(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(tolerances, "TOLERANCES", (1e-5, 1e-8))
    found = {
        (h.method, h.tolerance): h
        for h in tolerances.Tolerances(("bs32", "dop853", "verner98", "LSODA"), 8).run(load)
    }
    # the motion itself amplifies errors by orders of magnitude
    for row in found.values():
        assert row.worst >= row.median > row.relative_to_growth
    assert found["LSODA", 1e-8].median > 5 * found["verner98", 1e-8].median
    assert found["bs32", 1e-8].median > 3
    # an error twice as large relative to the tolerance would fail
    assert found["verner98", 1e-8].relative_to_growth < 0.5


def test_the_predicted_growth_is_that_of_the_stability_function() -> None:
    function = StabilityFunction.of(oscillation.load_method("rk4"))
    found = oscillation.growth(sp, "rk4", 10.0)
    assert found.predicted == pytest.approx(10 * log(abs(complex(function(0.2j * pi)))))


def test_a_trajectory_is_lost_from_the_first_sample_with_a_large_error() -> None:
    t, reference = reference_motion(sp, (1.0, 0.0), 1.0)
    kept, lost = (
        horizon(sp, t, reference + 1.1 * (t >= time)[:, np.newaxis], 0.5, "verner98", 1e-10)
        for time in (2.0, 0.6)
    )
    assert (kept.measured, lost.measured) == (np.inf, t[6])
    assert kept.predicted == lost.predicted == pytest.approx(20 * log(10), rel=1e-15)
    assert kept.energy_error == lost.energy_error < 1e-10


#: Results of studies, and the points (x, y) that their plots must have.
SENSITIVITIES = [separatrix.Sensitivity(10.0**-k, 2e3 * k, 3e3 * k, 1e-9) for k in (1, 2)]
LOSSES = [singular.AccuracyLoss(10.0**-k, 3e5 * k, *(n * 1e-9 * k for n in (2, 3, 5, 7)))
          for k in (1, 2)]  # fmt: skip
GROWTHS = [oscillation.Growth(method, 10.0 * k, 0.2 * k, 0.3 * k)
           for k, method in enumerate(("rk1", "midpoint", "rk1"), 1)]  # fmt: skip
COSTS = [stiffness.Cost("one", method, ratio, 7, 9, ratio * seconds, 1e-4)
         for ratio in (10.0, 1000.0)
         for method, seconds in (("rk4", 2e-6), ("gauss2", 3e-6))]  # fmt: skip
DRIFT = Drift("rk4", "lagrangian", 60, np.array([0.0, 1.0, 2.0, 3.0]),
    np.array([0.0, 2e-6, -5e-6, 3e-6]), *(0.5,) * 6)  # fmt: skip
ACHIEVED = [tolerances.ToleranceAccuracy(method, 10.0**-k, k, 10.0 * k + n, 1.0)
            for n, method in enumerate(("dp54", "rk4")) for k in (4, 7, 10)]  # fmt: skip
APART = Separation(np.array([0.0, 2.0, 4.0]), np.array([1e-12, 3e-11, 0.5]),
    np.array([1e-12, 4e-11, 6.0]), 0.85)  # fmt: skip
CHAOS = ChaosResults(
    Mean(0.5, 0.01), APART,
    [Horizon("dp54", 1e-4, 20.0, 19.0, 0.1), Horizon("dp54", 1e-8, 40.0, inf, 1e-3)],
    [Statistics("rk4", -0.07, Mean(30.0, 0.5), Mean(0.25, 0.01))],
)  # fmt: skip
PLOTS = {
    "tolerances": (
        tolerances.Tolerances(),
        ACHIEVED,
        {(n + 0.15 * k, m) for n in (0, 1) for k, m in ((-1, 4.0), (0, 7.0), (1, 10.0))}
        | {(0.0, 1.0), (1.0, 1.0)},  # the requested error, over the whole width
    ),
    "chaos": (
        Chaos(),
        CHAOS,
        {*zip(APART.t, APART.distance, strict=True), *zip(APART.t, APART.predicted, strict=True)}
        | {(t, OFFSET * np.exp(0.5 * t)) for t in APART.t}
        | {(1e-4, 19.0), (1e-4, 20.0), (1e-8, 40.0)},
    ),
    "separatrix": (
        separatrix.Separatrix(),
        separatrix.SeparatrixResults(SENSITIVITIES, [], separatrix.Upright(1e-16, 17.0, 17.0)),
        {(0.1, 2e3), (0.01, 4e3), (0.1, 3e3), (0.01, 6e3)},
    ),
    "singular": (
        singular.SingularMassMatrix(),
        LOSSES,
        {(row.m1, n * 1e-9 * k) for k, row in enumerate(LOSSES, 1) for n in (2, 3, 5, 7)}
        | {(row.m1, 2.0**-52 * row.condition) for row in LOSSES},
    ),
    "oscillation": (
        oscillation.Oscillation(),
        GROWTHS,
        {(10.0 * k, factor * k) for k in (1, 2, 3) for factor in (0.2, 0.3)},
    ),
    "stiffness": (
        stiffness.Stiffness(),
        COSTS,
        {(10.0, 0.02), (1000.0, 2.0), (10.0, 0.03), (1000.0, 3.0)},
    ),
    "drift": (EnergyDrift(), [DRIFT], {(1.0, 2e-6), (2.0, 5e-6), (3.0, 5e-6)}),
}


@pytest.mark.parametrize("name", PLOTS)
def test_plots_of_studies_have_the_points_of_their_results(name: str) -> None:
    study, results, expected = PLOTS[name]
    lines = [line for axes in study.plot(results).axes for line in axes.lines]
    drawn = np.unique(np.concatenate([line.get_xydata() for line in lines]), axis=0)
    assert drawn == pytest.approx(np.array(sorted(expected)), rel=1e-12)


@pytest.mark.parametrize("study", [EnergyDrift(), Conservation()])
def test_summaries_of_long_runs_state_the_longest(study: EnergyDrift | Conservation) -> None:
    shorter = replace(DRIFT, periods=DRIFT.periods[:-1], energy_error=DRIFT.energy_error[:-1])
    assert next(iter(study.summary([shorter, DRIFT]))).endswith(" over 3 periods")


def test_panels_of_stiff_scenes_have_the_same_scale_of_costs() -> None:
    costs = [replace(one, family=family, work_seconds=scale * one.work_seconds)
             for family, scale in (("one", 1.0), ("two", 100.0), ("three", 0.01))
             for one in COSTS]  # fmt: skip
    limits = {panel.get_ylim() for panel in stiffness.Stiffness().plot(costs).axes}
    ((low, high),) = limits
    assert low < 0.02 * 0.01 < 3.0 * 100.0 < high


def test_costs_of_stiff_scenes_are_those_of_their_methods() -> None:
    (panel,) = stiffness.Stiffness().plot(COSTS).axes
    milliseconds = {line.get_label(): line.get_ydata() for line in panel.lines}
    assert milliseconds["rk4"] == pytest.approx([0.02, 2.0])
    assert milliseconds["gauss2"] == pytest.approx([0.03, 3.0])


def test_the_summary_of_stiff_scenes_names_the_cheapest_of_each_kind() -> None:
    slower = [replace(one, method="verner853", work_seconds=2 * one.work_seconds) for one in COSTS]
    lines = "\n".join(stiffness.Stiffness().summary([*slower[::2], *COSTS]))
    assert re.search(r"one +10 +7 steps, 20 µs, rk4 +7 steps, 30 µs, gauss2\n", lines)
    assert re.search(r"one +1000 +7 steps, 2000 µs, rk4 +7 steps, 3000 µs, gauss2\n", lines)
    assert lines.endswith("one: implicit methods do not become cheaper")


def test_bars_reach_from_the_median_to_the_worst_error() -> None:
    (axes,) = tolerances.Tolerances().plot(ACHIEVED).axes
    bars = [path.vertices.tolist() for one in axes.collections for path in one.get_paths()]
    places = [n + 0.15 * k for k in (-1, 0, 1) for n in (0, 1)]
    ends = [(k, 10.0 * k + n) for k in (4, 7, 10) for n in (0, 1)]
    assert bars == [[[x, low], [x, high]] for x, (low, high) in zip(places, ends, strict=True)]
    assert [label.get_text() for label in axes.get_xticklabels()] == ["dp54", "rk4"]


def test_chaos_is_summarised_while_differences_are_small() -> None:
    text = "\n".join(Chaos().summary(CHAOS))
    assert "a difference of 1e-12 grows as e^(0.850 t) while it is small, for 2.0 s;" in text
    assert text.count("relative error of the variational equations 0.2") == 1  # 3e-11 of 4e-11
    assert re.search(r"\n +1e-04 +20\.0 +19\.0\n +1e-08 +40\.0 +later\n", text)


def test_rk3_and_rk4_are_studied_on_both_sides_of_their_limits(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(oscillation, "growth", lambda _, *case: case)
    *growing, above3, below3, above4, below4 = oscillation.Oscillation().run(load)
    assert {method for method, _ in growing} == {"rk1", "midpoint"}
    for (name, above), (_, below), limit in (
        (above3, below3, 2 * pi / sqrt(3)), (above4, below4, 2 * pi / sqrt(8)),
    ):  # fmt: skip
        assert (above, below) == pytest.approx((1.02 * limit, 0.98 * limit)), name


def test_parts_of_the_study_of_chaos_have_its_durations_and_methods(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def recorder(name: str) -> Callable[..., object]:
        return lambda _, *arguments: (name, *arguments)

    for name in ("statistics", "separation", "horizon"):
        monkeypatch.setattr(chaos, name, recorder(name))
    monkeypatch.setattr(chaos, "lyapunov", lambda _, *arguments: Mean(0.5, arguments[2]))
    monkeypatch.setattr(chaos, "reference_motion", lambda _, *arguments: arguments)
    found = Chaos(100.0, 20.0, 300.0, ("dp54", "bs32")).run(load)
    assert found.exponent == Mean(0.5, 100.0)
    assert found.separation == ("separation", CHAOTIC, 20.0)
    assert found.horizons == [
        ("horizon", CHAOTIC, 20.0, 0.5, method, tolerance)
        for method in ("dp54", "bs32")
        for tolerance in (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
    ]
    assert found.statistics == [("statistics", 300.0, run) for run in LONG_RUNS]
    assert len(LONG_RUNS) == 4


def test_plots_and_summaries_of_studies_are_as_recorded(record: Record) -> None:
    record.check_digests({
        name: "\n\n".join([*study.summary(results), described(study.plot(results))])
        for name, (study, results, _) in PLOTS.items()
    })  # fmt: skip


@pytest.mark.parametrize("name", PLOTS)
def test_labelled_curves_of_a_study_differ_in_their_looks(name: str) -> None:
    study, results, _ = PLOTS[name]
    for axes in study.plot(results).axes:
        lines = [line for line in axes.lines if not str(line.get_label()).startswith("_")]
        looks = {(one.get_color(), one.get_linestyle(), one.get_marker()) for one in lines}
        assert len(looks) == len({one.get_label() for one in lines})
        if legend := axes.get_legend():
            assert not legend.get_frame_on()
