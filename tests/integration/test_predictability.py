"""Unstable fixed steps, and how long chaotic motions are predictable."""

import re
from functools import partial
from math import pi, sqrt
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import generated.double_pendulum as dp
import generated.elastic_pendulum as ep
import generated.henon_heiles as hh
import generated.single_pendulum as sp
from solvers.integration.checks import predictability
from solvers.integration.checks.predictability import PredictabilityWarning, ignore_predictability
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.problem import validation
from solvers.integration.problem.events import Event
from solvers.integration.problem.problem import Options
from solvers.integration.problem.status import Status
from solvers.references.taylor import taylor

pytestmark = pytest.mark.usefixtures("predictable_times")

REPORT = (pi / 2, pi, 0.0, 0.0)

TIMES = np.linspace(0, 60, 601)


def reported_time(message: object) -> float:
    """The time in the text of a `PredictabilityWarning`."""
    time = re.search(r"not predictable beyond t = (\S+):", str(message))
    assert time
    return float(time.group(1))


@pytest.mark.parametrize("backend", ["python", "compiled"])
@pytest.mark.parametrize(("method", "interval"), [("rk3", sqrt(3)), ("rk4", 2 * sqrt(2))])
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_a_step_beyond_the_stability_limit_is_unstable(
    method: str, interval: float, backend: str
) -> None:
    # the imaginary stability interval of the textbook, and a pendulum's small motion
    _, length, g = sp.DEFAULTS
    limit = interval / sqrt(g / length)
    run = partial(integrate, sp, (0, 100), (0.01, 0.0), sp.DEFAULTS, method=method, backend=backend)
    stable, broken = run(h=0.9 * limit), run(h=1.1 * limit)
    assert stable.status is Status.FINISHED
    assert np.abs(stable.y).max() < 0.03
    assert broken.status is Status.UNSTABLE
    assert broken.message in repr(broken)
    assert np.abs(broken.y).max() > 0.1
    assert not broken.success
    times = re.search(r"good up to t = (\S+);.* at most ([-.e\d]+)", broken.message)
    assert times
    good, largest = map(float, times.groups())
    assert largest == pytest.approx(limit, rel=0.05)
    grown = np.abs(broken.y[0][broken.t <= good]).max()
    assert 0.02 < grown < 0.5


@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_methods_without_a_stability_interval_are_judged_by_growth_over_the_run() -> None:
    # Euler multiplies an oscillation by about exp(h w^2 t/2)
    short = integrate(sp, (0, 10), (0.01, 0.0), sp.DEFAULTS, method="rk1", h=0.05)
    long = integrate(sp, (0, 1000), (0.01, 0.0), sp.DEFAULTS, method="rk1", h=0.05)
    assert (short.status, long.status) == (Status.FINISHED, Status.UNSTABLE)
    assert "at most 0.000939" in long.message  # 2 ln 10 / (w^2 t)


def test_a_chaotic_run_beyond_its_predictable_time_warns() -> None:
    start = (3.0, 3.0, 0.0, 0.0)
    with pytest.warns(PredictabilityWarning) as caught:
        rough = integrate(dp, (0, 60), start, dp.DEFAULTS, rtol=1e-6, atol=1e-6, t_eval=TIMES)
    limit = reported_time(caught[0].message)
    with pytest.warns(PredictabilityWarning) as again:
        fine = integrate(
            dp, (0, 60), start, dp.DEFAULTS, rtol=1e-13, atol=1e-13, t_eval=TIMES, method="verner98"
        )
    # errors grow at about one rate
    later = reported_time(again[0].message)
    assert later == pytest.approx(limit * 13 / 6, rel=0.5)
    apart = np.abs(rough.y - fine.y).max(axis=0)
    # before half of it the motion is right, after twice it is not
    assert apart[0.5 * limit > TIMES].max() < 0.1
    assert apart[2 * limit < TIMES].max() > 1.0
    assert 2 * limit < 50


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize("tolerance", [1e-5, 1e-7, 1e-9])
def test_the_predictable_time_does_not_depend_on_the_duration_of_the_run(tolerance: float) -> None:
    limits = []
    for duration in (50.0, 500.0, 5000.0):
        with pytest.warns(PredictabilityWarning) as caught:
            integrate(
                dp,
                (0, duration),
                REPORT,
                dp.DEFAULTS,
                rtol=tolerance,
                atol=tolerance,
                t_eval=[duration],
                max_steps=10**8,
            )
        limits.append(reported_time(caught[0].message))
    assert max(limits) == pytest.approx(min(limits), rel=0.01)
    truth = taylor(dp, dp.DEFAULTS, REPORT, TIMES[TIMES < 40], digits=24)
    options = {"rtol": tolerance, "atol": tolerance, "t_eval": TIMES[TIMES < 40]}
    with pytest.warns(PredictabilityWarning, match="1 of 1 examined motions"):
        run = ensemble(dp, (0, 40), np.transpose([REPORT]), dp.DEFAULTS, **options)
    apart = np.abs(run.samples[:, 0].T - truth).max(axis=1)
    observed = TIMES[np.argmax(apart > 1)]
    assert limits[0] == pytest.approx(observed, rel=0.3)


@pytest.mark.long("more cases of the same kind", keep=3)
@pytest.mark.parametrize(
    "options",
    [
        {"method": "verner98", "rtol": 1e-7, "atol": 1e-7},
        {"method": "dp54", "rtol": 1e-5, "atol": 1e-5},
        {"method": "RK45", "rtol": 1e-7, "atol": 1e-7},
        {"method": "rk4", "h": 0.01},
        {"method": "gauss2", "h": 0.01, "form": "hamiltonian"},
    ],
)
def test_the_predictable_time_is_the_observed_one_for_every_method(options: dict[str, Any]) -> None:
    fine = {"method": "verner98", "rtol": 1e-13, "atol": 1e-13, "t_eval": TIMES[TIMES < 30]}
    with ignore_predictability():
        reference = integrate(dp, (0, 30), REPORT, dp.DEFAULTS, **fine).y
    with pytest.warns(PredictabilityWarning) as caught:
        run = integrate(dp, (0, 30), REPORT, dp.DEFAULTS, t_eval=TIMES[TIMES < 30], **options)
    apart = np.abs(run.y - reference).max(axis=0)
    observed = TIMES[np.argmax(apart > 1)]
    assert reported_time(caught[0].message) == pytest.approx(observed, rel=0.25)


def test_the_predictable_time_is_known_backwards_and_up_to_an_event() -> None:
    with pytest.warns(PredictabilityWarning, match="not predictable beyond t = -"):
        integrate(dp, (0, -60), REPORT, dp.DEFAULTS, rtol=1e-6)
    late = Event(dp, "theta1", 0.0, terminal=True)
    early = integrate(dp, (0, 1e6), REPORT, dp.DEFAULTS, rtol=1e-6, events=late, max_steps=10**8)
    assert early.status is Status.EVENT
    assert 0 < early.end[0] < 5


def test_a_regular_run_does_not_warn_however_long() -> None:
    integrate(dp, (0, 500), (0.1, 0.1, 0.0, 0.0), dp.DEFAULTS, rtol=1e-8)
    integrate(sp, (0, 2000), (1.0, 0.0), sp.DEFAULTS, rtol=1e-8)
    # exactly at rest on a saddle there is no error that could grow
    integrate(hh, (0, 100), {"x": 0.0, "y": 1.0}, (), rtol=1e-8)
    # changes grow in proportion to time, a thousandfold here
    integrate(sp, (0, 2000), (1.0, 0.0), sp.DEFAULTS, rtol=3e-3, atol=3e-3)
    # and at once where a mode is fast, here ten-thousandfold; it gains energy at larger tolerances
    stiff = (1.0, 1e8, 1.0, 9.81)
    integrate(ep, (0, 6), (*ep.equilibrium(stiff), 0.0, 0.5), stiff, rtol=1e-5, atol=1e-5)


def test_the_growth_of_the_examined_steps_is_continued_to_the_predictable_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    limits, run = [], partial(integrate, dp, (0, 500), REPORT, {}, rtol=1e-9, t_eval=[500.0])
    for most in (predictability.MOST_STEPS, 150):
        monkeypatch.setattr(predictability, "MOST_STEPS", most)
        with pytest.warns(PredictabilityWarning) as caught:
            run()
        limits.append(reported_time(caught[0].message))
    assert limits[0] == pytest.approx(limits[1], rel=0.3)
    assert limits[0] != limits[1]


def test_an_error_that_cannot_be_measured_counts_as_that_of_a_wrong_run(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # the error of Euler's method is that of a wrong run, too: the size of the motion
    euler = validation.problem(dp, (0, 60), REPORT, {}, Options("rk1", h=0.05))
    measured = predictability.predictable_until(euler, 60.0)
    failed = SimpleNamespace(status=Status.STEP_LIMIT)
    monkeypatch.setattr(predictability, "rerun", lambda _: failed)
    assert predictability.predictable_until(euler, 60.0) == measured < 10
