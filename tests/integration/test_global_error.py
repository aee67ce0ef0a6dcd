"""The estimate of the global error is within a factor of 3 of the true one."""

import pickle
import re
from math import pi
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from handwritten import handwritten

import generated.coupled_pendulums as cp
import generated.double_pendulum as dp
import generated.elastic_pendulum as ep
import generated.henon_heiles as hh
import generated.single_pendulum as sp
import generated.swinging_atwood as atwood
from solvers.integration.checks import global_error
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.references.taylor import taylor

REPORT = (pi / 2, pi, 0.0, 0.0)
MOTIONS: list[tuple[ModuleType, tuple[float, ...], float]] = [
    (dp, REPORT, 5.0),
    (sp, (2.5, 0.0), 20.0),
    (ep, (1.3, 0.4, 0.0, 0.0), 5.0),
    (hh, (0.1, 0.1, 0.3, 0.0), 20.0),
    (cp, (-0.9, 1.0, 0.3, -0.53), 10.0),
    (atwood, (1.0, 1.5, 0.0, 0.0), 10.0),
]
RUNS: list[dict[str, Any]] = [
    {"rtol": 1e-5, "atol": 1e-5},
    {"rtol": 1e-8, "atol": 1e-8},
    {"rtol": 1e-13, "atol": 1e-13},
    {"method": "verner98", "rtol": 1e-9},
    {"method": "dop853", "rtol": 1e-9, "form": "hamiltonian"},
    {"method": "rk4", "h": 0.01},
    {"method": "gauss2", "h": 0.02},
]


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize(("module", "start", "duration"), MOTIONS)
def test_the_estimate_is_within_a_factor_of_3(
    module: ModuleType, start: tuple[float, ...], duration: float
) -> None:
    times = np.linspace(0, duration, 6)
    truth = taylor(module, module.DEFAULTS, start, times, 28).T
    for options in RUNS:
        run = integrate(module, (0, duration), start, module.DEFAULTS, t_eval=times, **options)
        error = np.abs(run.y - truth).max(axis=0)[1:]
        estimate = run.global_error_estimate
        assert estimate.shape == run.y.shape
        ratio = estimate.max(axis=0)[1:] / error
        assert ratio.min() > 1 / 3, options
        assert ratio.max() < 3, options


@pytest.mark.long("decimal references of a chaotic motion")
def test_tight_tolerances_in_chaos_have_the_estimate_of_their_rounding() -> None:
    times = [0.0, 10.0, 20.0, 30.0]
    truth = taylor(dp, dp.DEFAULTS, REPORT, times, 36).T
    run = integrate(dp, (0, 30), REPORT, dp.DEFAULTS, rtol=1e-13, atol=1e-13, t_eval=times)
    error = np.abs(run.y - truth).max(axis=0)[1:]
    ratio = run.global_error_estimate.max(axis=0)[1:] / error
    assert error[-1] > 1e-4  # ten decimals more than the tolerances
    assert ratio.min() > 0.1
    assert ratio.max() < 10


@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_the_estimate_exists_without_a_compiler_and_for_partial_results() -> None:
    decay = handwritten(
        "hand", ("x", "v"), COORDINATES=("x",), rhs=lambda t, y, params: (y[1], -y[0])
    )
    run = integrate(decay, (0, 3), (1.0, 0.0), (1.0,), method="rk4", h=0.1, t_eval=[1.0, 3.0])
    exact = np.array([np.cos(run.t), -np.sin(run.t)])
    assert run.global_error_estimate == pytest.approx(np.abs(run.y - exact), rel=1e-3)
    stopped = integrate(dp, (0, 5), REPORT, dp.DEFAULTS, rtol=1e-9, max_steps=20)
    assert np.isfinite(stopped.global_error_estimate).all()
    assert stopped.global_error_estimate.max() < 1e-6


@pytest.mark.parametrize(
    ("form", "other"), [("lagrangian", "rational"), ("rational", "lagrangian")]
)
def test_the_comparison_is_in_another_form(
    form: str, other: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    forms: list[str] = []
    original = global_error.singular_passage.run

    def observed(problem: Any, *others: Any) -> Any:
        forms.append(problem.form.name)
        return original(problem, *others)

    run = integrate(sp, (0, 1), (1.0, 0.0), sp.DEFAULTS, form=form)
    monkeypatch.setattr(global_error.singular_passage, "run", observed)
    assert run.global_error_estimate.max() < 1e-6
    assert forms == [other]


def test_a_copied_solution_states_that_it_has_no_estimate() -> None:
    run = integrate(sp, (0, 1), (1.0, 0.0), sp.DEFAULTS)
    copy = pickle.loads(pickle.dumps(run))
    assert copy.y.tolist() == run.y.tolist()
    with pytest.raises(ValueError, match=re.escape("integrate again")):
        _ = copy.global_error_estimate


def test_a_copied_ensemble_has_its_states_but_no_equations() -> None:
    motions = ensemble(sp, (0, 1), {"theta": [0.5, 1.0]}, {})
    assert motions.motion(1).y[:, -1] == pytest.approx(motions.y[:, 1], abs=1e-8)
    copy = pickle.loads(pickle.dumps(motions))
    assert copy.y.tolist() == motions.y.tolist()
    with pytest.raises(ValueError, match="a copied ensemble has no equations"):
        copy.motion(1)
