"""Samples within steps: by a continuous extension where many lie in a step, else shorter steps."""

from functools import cache
from types import ModuleType

import numpy as np
import pytest

import generated.double_pendulum as dp
import generated.elastic_pendulum as elastic
import generated.henon_heiles as henon_heiles
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.problem.events import Event
from solvers.integration.problem.status import Status
from solvers.integration.results.solution import Solution
from solvers.references.taylor import taylor
from solvers.runge_kutta.continuous_extension import ContinuousExtension
from solvers.runge_kutta.method_catalogue import load

METHODS = ["dp54", "verner853", "verner98"]
STARTS = {
    dp: (2.0, 1.0, 0.0, 0.5),
    elastic: (1.1, 0.8, 0.0, 0.3),
    henon_heiles: (0.1, 0.2, 0.3, 0.1),
}
END, TIMES = 2.0, np.linspace(0, 2.0, 201)


@cache
def exact(module: ModuleType) -> np.ndarray:
    """States at every tenth time, by Taylor series of 28 digits."""
    states = taylor(module, module.DEFAULTS, STARTS[module], TIMES[::10].tolist(), 28)
    return np.array(states, float).T


def sampled(module: ModuleType, times: np.ndarray, method: str, **options: object) -> Solution:
    return integrate(
        module, (0, END), STARTS[module], module.DEFAULTS, method=method, t_eval=times, **options
    )


@pytest.mark.long("more cases of the same kind", keep=9)
@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("module", STARTS, ids=lambda module: module.SYSTEM)
@ignore_predictability()
def test_many_samples_in_a_step_are_as_accurate_as_shorter_steps(
    module: ModuleType, method: str, tolerance: float
) -> None:
    options = {"rtol": tolerance, "atol": tolerance}
    many = sampled(module, TIMES, method, **options)
    few = sampled(module, TIMES[::10], method, **options)
    errors = [np.abs(y - exact(module)).max() for y in (many.y[:, ::10], few.y)]
    assert errors[0] <= 1.1 * errors[1] + 1e-15


@pytest.mark.parametrize("backend", ["compiled", "python"])
@pytest.mark.parametrize("module", [dp, elastic], ids=lambda module: module.SYSTEM)
@ignore_predictability()
def test_samples_of_gauss_steps_are_as_accurate_as_their_ends(
    module: ModuleType, backend: str
) -> None:
    options = {"rtol": 1e-13, "atol": 1e-13, "backend": backend}
    start, params = STARTS[module], module.DEFAULTS
    ends = integrate(module, (0, END), start, params, method="gauss8", **options)
    within = np.sort([ends.t[:-1] + part * np.diff(ends.t) for part in (0.1, 0.3, 0.5, 0.9)], None)
    samples = sampled(module, within, "gauss8", **options)
    times = np.sort([*ends.t, *within])
    states = np.array(taylor(module, params, start, times.tolist(), 28), float).T
    errors = [
        np.abs(run.y - states[:, np.searchsorted(times, run.t)]).max() for run in (samples, ends)
    ]
    assert errors[0] < 5 * errors[1]


@pytest.mark.parametrize("backend", ["compiled", "python"])
@ignore_predictability()
def test_samples_change_neither_the_steps_nor_the_end(backend: str) -> None:
    """Close to equilibrium: changes far below the tolerance grow in the iteration of a sample."""
    params = elastic.params(m=0.656818395497523, k=149.5192837479851, l=0.575, g=6.788731362682799)
    start, options = (
        (0.6046667109439209, 0.00237337136018224, 0.0, 0.0),
        {"rtol": 8e-7, "atol": 8e-10},
    )
    few, many = (
        integrate(
            elastic, (0, END), start, params, method="gauss8", t_eval=np.linspace(0, END, count),
            backend=backend, **options,
        )
        for count in (2, 129)
    )  # fmt: skip
    assert many.steps == few.steps
    assert np.array_equal(many.y[:, -1], few.y[:, -1])


@pytest.mark.parametrize("method", ["verner853", "verner98"])
def test_the_extension_of_a_lower_order_would_not_be(method: str) -> None:
    tableau = load(method)
    extension = ContinuousExtension.of(tableau)
    assert extension.natural_order + extension.rounds == tableau.order
    options = {"rtol": 1e-9, "atol": 1e-9, "backend": "python", "form": "lagrangian"}
    full = sampled(dp, TIMES, method, **options)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            ContinuousExtension,
            "extend",
            lambda self, rhs, t, y, h, k: extension.change(k),
        )
        natural = sampled(dp, TIMES, method, **options)
    errors = [np.abs(run.y[:, ::10] - exact(dp)).max() for run in (full, natural)]
    assert errors[1] > 10 * errors[0]


@pytest.mark.parametrize("backend", ["compiled", "lanes"])
@pytest.mark.parametrize("method", METHODS)
@ignore_predictability()
def test_compiled_samples_of_a_long_step_are_those_in_python(method: str, backend: str) -> None:
    # the order of the extension in Python is tested beside its order conditions; each of its rounds
    # changes these samples by 1e-8 or more
    h, start = 0.3, STARTS[dp]
    times = np.linspace(0, h, 9)[1:-1]
    options = {"method": method, "h": h, "t_eval": times, "form": "lagrangian"}
    expected = integrate(dp, (0, h), start, dp.DEFAULTS, backend="python", **options).y
    if backend == "lanes":
        starts = np.array([start, start]).T
        found = ensemble(dp, (0, h), starts, dp.DEFAULTS, **options).samples[:, 0]
    else:
        found = integrate(dp, (0, h), start, dp.DEFAULTS, backend=backend, **options).y
    assert found == pytest.approx(expected, abs=1e-13)


@pytest.mark.parametrize("backend", ["python", "compiled", "lanes"])
@pytest.mark.parametrize("method", METHODS)
@ignore_predictability()
def test_samples_take_no_more_evaluations_than_extensions(method: str, backend: str) -> None:
    tableau, times = load(method), np.linspace(0, END, 801)
    extension = ContinuousExtension.of(tableau)
    options = {"rtol": 1e-9, "atol": 1e-9}
    if backend == "lanes":
        starts = np.array([STARTS[dp], (1.0, 0.5, 0.2, 0.0)]).T
        runs = [
            ensemble(dp, (0, END), starts, dp.DEFAULTS, method=method, t_eval=t, **options)
            for t in (times, [END])
        ]
        more, steps, y = runs[0].nfev - runs[1].nfev, runs[0].steps, runs[0].samples[:, 0]
    else:
        many, ends = (sampled(dp, t, method, backend=backend, **options) for t in (times, [END]))
        more, steps, y = many.nfev - ends.nfev, many.steps, many.y
    per_step = extension.rounds * len(extension.nodes)
    assert np.all(more <= steps * max(per_step, extension.least_samples * tableau.stages))
    assert np.abs(y[:, ::40] - exact(dp)).max() < 1e-8


@pytest.mark.parametrize("backend", ["python", "compiled"])
def test_few_samples_in_a_step_take_shorter_steps(backend: str) -> None:
    options = {"rtol": 1e-9, "atol": 1e-9, "backend": backend}
    few, ends = (sampled(dp, t, "verner853", **options) for t in ([0.501, 1.001, END], [END]))
    assert few.nfev - ends.nfev in (2 * 11, 2 * 12)


@pytest.mark.parametrize("backend", ["python", "compiled"])
@pytest.mark.parametrize("direction", [1, -1])
def test_samples_end_at_a_terminal_event(direction: int, backend: str) -> None:
    times = direction * np.linspace(0, END, 2001)
    event = Event(dp, "theta1", 0.0, terminal=True)
    run = integrate(
        dp, (0, direction * END), STARTS[dp], dp.DEFAULTS, method="verner98", t_eval=times,
        events=event, backend=backend,
    )  # fmt: skip
    whole = integrate(
        dp, (0, direction * END), STARTS[dp], dp.DEFAULTS, method="verner98", t_eval=times
    )
    assert run.status is Status.EVENT
    count = int((direction * times <= direction * run.t_events[0][0]).sum())
    assert len(run.t) == count
    assert run.y == pytest.approx(whole.y[:, :count], abs=1e-9)


@pytest.mark.parametrize("compensated", [False, True])
def test_fixed_steps_and_compensated_sums_have_samples_by_the_extension(compensated: bool) -> None:
    options = {"h": 0.02, "compensated": compensated, "backend": "compiled"}
    run = sampled(dp, TIMES, "verner853", **options)
    assert np.abs(run.y[:, ::10] - exact(dp)).max() < 1e-11
