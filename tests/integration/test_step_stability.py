"""Fixed steps that are too long are named by every function, with the last good time."""

import re
from functools import partial
from math import inf, pi
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from handwritten import handwritten

import generated.double_pendulum as dp
import generated.driven_pendulum as driven
import generated.elastic_pendulum as ep
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.checks.step_stability import StepWarning
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.prepare import NotFinishedError, prepare
from solvers.integration.problem.status import Status

REPORT = (pi / 2, pi, 0.0, 0.0)
TEXT = re.compile(r"good up to t = ([-.e\d]+)(?:; .*at most ([.e\d]+))?(?:; .*with h = ([.e\d]+))?")


def numbers(text: str) -> tuple[float, float, float]:
    """The last good time, and the longest step sizes, by growth and by trial."""
    found = TEXT.search(text)
    assert found, text
    good, stable, sufficient = (float(part) if part else inf for part in found.groups())
    return good, stable, sufficient


@pytest.mark.parametrize("span", [(0.0, 5.0), (0.0, 100.0), (20.0, 0.0)])
@pytest.mark.parametrize("form", [None, "lagrangian", "hamiltonian"])
@pytest.mark.parametrize(("method", "h"), [("rk4", 1.0), ("dp54", 0.6), ("verner853", 1.0)])
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_motions_that_overflow_are_unstable(
    method: str, h: float, form: str | None, span: tuple[float, float]
) -> None:
    options: dict[str, Any] = {"method": method, "form": form}
    broken = integrate(dp, span, REPORT, dp.DEFAULTS, h=h, **options)
    assert broken.status is Status.UNSTABLE
    good, stable, sufficient = numbers(broken.message)
    assert 0 <= abs(good - span[0]) < abs(broken.end[0] - span[0]) + 1e-9
    assert 0 < sufficient < min(h, stable)
    with ignore_predictability():
        whole = integrate(dp, span, REPORT, dp.DEFAULTS, h=sufficient, **options)
    assert whole.status is Status.FINISHED
    energies = dp.energy_many(0.0, whole.y, dp.DEFAULTS)
    assert np.abs(energies - energies[0]).max() < 4 * 9.81 * 2  # J, from the top to the bottom


@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_the_limit_of_the_stability_function_is_given_where_modes_exceed_it() -> None:
    _, stable, _ = numbers(integrate(dp, (0, 100), REPORT, {}, method="rk4", h=1.0).message)
    assert stable == pytest.approx(0.69, abs=0.01)
    # below it the motion itself, faster than small oscillations, needs shorter steps
    short = integrate(dp, (0, 100), REPORT, {}, method="rk4", h=0.6)
    assert short.status is Status.UNSTABLE
    assert numbers(short.message)[1] == inf


@pytest.mark.parametrize("method", ["rk4", "dp54"])
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_a_prepared_function_reports_it(method: str) -> None:
    run = prepare(dp, dp.DEFAULTS, method=method, h=0.8)
    message = integrate(dp, (0, 20), REPORT, dp.DEFAULTS, method=method, h=0.8).message
    with pytest.raises(NotFinishedError, match="the fixed step size is too large") as stopped:
        run((0, 20), REPORT)
    assert stopped.value.status is Status.UNSTABLE
    assert numbers(str(stopped.value))[1:] == numbers(message)[1:]
    assert run((0, 0.8), (0.1, 0.1, 0.0, 0.0))  # the next motion


@pytest.mark.parametrize("backend", ["compiled", "python"])
def test_an_ensemble_reports_its_own_unstable_motions(backend: str) -> None:
    starts = np.transpose([(0.1, 0.1, 0, 0), REPORT, (0.2, 0.2, 0, 0), REPORT])
    options: dict[str, Any] = {"form": "rational", "backend": backend}
    message = r"2 of 4 motions are unstable; of motion 1, h = 0\.6 "
    with pytest.warns(StepWarning, match=message) as given:
        motions = ensemble(dp, (0, 30), starts, {}, method="rk4", h=0.6, **options)
    good, _, sufficient = numbers(str(given[0].message))
    assert 0 <= good < 30
    assert 0 < sufficient < 0.6
    stable, unstable = [Status.FINISHED] * 2, [Status.UNSTABLE] * 2
    assert motions.status[[0, 2]].tolist() == stable
    assert motions.status[[1, 3]].tolist() == unstable
    assert motions.success.tolist() == [True, False, True, False]


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.usefixtures("fused")  # roundings decide when the unstable motion is noticed
@pytest.mark.parametrize("masses", [{}, {"m": [0.5, 1.0]}])
def test_motions_with_own_parameters_and_without_a_constant_energy_are_reported(
    masses: dict[str, list[float]],
) -> None:
    starts = {driven.COORDINATES[0]: [0.5, 0.6]}
    params = {**masses, "g": [9.81, 9.81e9]}
    with pytest.warns(StepWarning, match="1 of 2 motions are unstable; of motion 1, h = 0.05 mult"):
        motions = ensemble(driven, (0, 9), starts, params, method="rk4", h=0.05)
    assert motions.status.tolist() == [Status.FINISHED, Status.UNSTABLE]


@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_other_failures_keep_their_status() -> None:
    def hole(t: float, y: Any, params: Any) -> tuple[float, float]:
        return 1.0, np.nan if t > 0.5 else 0.0

    module: ModuleType = handwritten("hand", ("x", "v"), COORDINATES=("x",), rhs=hole)
    solution = integrate(module, (0, 1), (0.0, 0.0), (1.0,), method="rk4", h=0.1)
    assert solution.status is Status.NOT_FINITE
    blow_up = handwritten(
        "hand", ("x", "v"), COORDINATES=("x",), rhs=lambda t, y, p: (y[0] ** 2, 0)
    )
    with np.errstate(over="ignore"):
        solution = integrate(blow_up, (0, 9), (1.0, 0.0), (1.0,), method="rk4", h=0.1)
    assert solution.status is Status.NOT_FINITE
    pivot = integrate(ep, (0, 1), (1.0, 0.0, -30.0, 0.0), ep.DEFAULTS, method="rk4", h=1e-3)
    assert pivot.status is Status.OUTSIDE_DOMAIN


@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_a_sufficient_step_is_found_where_no_energy_is_constant() -> None:
    run = partial(integrate, driven, (0, 10), (0.6, 0.0), {"g": 9.81e4}, method="rk4")
    broken = run(h=0.1)
    assert broken.status is Status.UNSTABLE
    _, stable, sufficient = numbers(broken.message)
    assert stable / 4 < sufficient < stable
    assert run(h=sufficient).status is Status.FINISHED
