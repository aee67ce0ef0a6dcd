"""Results that reach their end and are meaningless there come with a warning."""

import re
import warnings
from collections.abc import Callable
from functools import partial
from math import pi
from types import ModuleType

import numpy as np
import pytest

import generated.coupled_pendulums as cp
import generated.double_pendulum as dp
import generated.elastic_pendulum as ep
import generated.rotating_hoop as hoop
import generated.single_pendulum as sp
import generated.spherical_pendulum as spherical
import generated.swinging_atwood as atwood
from solvers.integration.checks.accuracy_warnings import DriftWarning, EnergyWarning
from solvers.integration.checks.predictability import PredictabilityWarning, ignore_predictability
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.prepare import prepare
from solvers.integration.problem.status import Status

pytestmark = pytest.mark.usefixtures("predictable_times")

REPORT = (pi / 2, pi, 0.0, 0.0)
COUPLED = (-0.9, 1.0, 0.3, -0.53)
#: Motions of conservative systems, which are not chaotic.
REGULAR: list[tuple[ModuleType, tuple[float, ...]]] = [
    (sp, (2.5, 0.0)),
    (dp, (0.5, -0.4, 0.0, 0.0)),
    (cp, COUPLED),
    (ep, (1.3, 0.4, 0.0, 0.0)),
    (hoop, (1.0, 0.3)),
    (spherical, (1.0, 0.2, 0.0, 1.5)),
    (atwood, (1.0, 1.5, 0.0, 0.0)),
]


@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_an_energy_that_grows_warns_with_its_values() -> None:
    with pytest.warns(
        EnergyWarning, match=r"changed from -9\.891 to 22\.\d+ J: .*h = 0\.2"
    ) as caught:
        solution = integrate(cp, (0, 10), COUPLED, cp.DEFAULTS, method="heun", h=0.2)
    assert solution.status is Status.FINISHED
    assert len(caught) == 1
    assert cp.energy(0.0, COUPLED, cp.DEFAULTS) == pytest.approx(-9.891, abs=1e-3)
    # from there on small deviations at the equilibrium grow, too
    wild = integrate(cp, (0, 10), COUPLED, cp.DEFAULTS, method="heun", h=0.5)
    assert wild.status is Status.UNSTABLE


@pytest.mark.parametrize(
    ("method", "h", "largest", "duration"),
    [("rk4", 1.0, 0.694, 100.0), ("rk1", 0.6, 0.07, 6.0), ("rk1", 0.6, 0.05, 10.0)],
)
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_an_unstable_step_states_the_last_good_time_and_the_longest_step(
    method: str, h: float, largest: float, duration: float
) -> None:
    # the upper rod starts beside an equilibrium without oscillations, whose modes say nothing
    broken = integrate(dp, (0, duration), REPORT, dp.DEFAULTS, method=method, h=h)
    assert broken.status is Status.UNSTABLE
    with np.errstate(all="ignore"):
        energies = dp.energy_many(0.0, broken.y, dp.DEFAULTS)
    times = re.search(r"good up to t = (\S+); .* at most ([\d.]+)", broken.message)
    assert times
    good, longest = map(float, times.groups())
    assert longest == pytest.approx(largest, rel=0.5)
    scale = 4 * 9.81 * 2  # J, from the top to the bottom
    assert np.abs(energies - energies[0])[broken.t <= good].max() < 1.5 * scale
    assert good < broken.end[0]


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-6])
@pytest.mark.parametrize(("module", "start"), REGULAR)
def test_correct_runs_at_loose_tolerances_do_not_warn(
    module: ModuleType, start: tuple[float, ...], tolerance: float
) -> None:
    # the loops agree, and another library for each method and system takes seconds to compile
    run = partial(integrate, module, (0, 5), start, module.DEFAULTS)
    backend = "compiled" if module is dp else "python"
    for method in ("bs32", "dp54", "verner98"):
        solution = run(method=method, rtol=tolerance, atol=tolerance, backend=backend)
        assert solution.status is Status.FINISHED
    assert run(method="rk4", h=0.02, backend=backend).success


@pytest.mark.parametrize("method", ["rk4", "gauss2"])
def test_chaotic_motions_with_fixed_steps_warn(method: str) -> None:
    with pytest.warns(PredictabilityWarning, match=r"beyond t = .*reduce h = 0\.01") as caught:
        coarse = integrate(
            dp, (0, 60), REPORT, dp.DEFAULTS, method=method, h=0.01, t_eval=np.linspace(0, 60, 601)
        )
    limit = float(str(caught[0].message).split("t = ")[1].partition(":")[0])
    with ignore_predictability():
        fine = integrate(dp, (0, 60), REPORT, dp.DEFAULTS, rtol=1e-13, t_eval=coarse.t)
    apart = np.abs(fine.y - coarse.y).max(axis=0)
    assert apart[coarse.t < 0.5 * limit].max() < 0.5
    assert apart[coarse.t < 2 * limit].max() > 1
    integrate(dp, (0, 60), (0.1, 0.1, 0.0, 0.0), dp.DEFAULTS, method=method, h=0.01)  # regular


@pytest.mark.parametrize("begin", [0.0, 100.0, -100.0])
@pytest.mark.parametrize("direction", [1, -1])
def test_the_predictable_part_counts_from_the_start(begin: float, direction: int) -> None:
    # the motion backwards is that forwards, since it begins at rest
    span = (begin, begin + 60 * direction)
    with pytest.warns(PredictabilityWarning, match="beyond t = ") as caught:
        integrate(dp, span, (3.0, 3.0, 0.0, 0.0), {"m2": 0.5}, rtol=1e-6, atol=1e-6)
    limit = float(str(caught[0].message).split("t = ")[1].partition(":")[0])
    assert 5 < (limit - begin) * direction < 55


@pytest.mark.parametrize("tilt", [0.0, 1e-9, 1e-3, 1e-2])
def test_a_swing_through_the_pole_is_predictable(tilt: float) -> None:
    for tolerance in (1e-6, 1e-9):
        start = (1.0, 0.3, 0.0, tilt)
        integrate(spherical, (0, 50), start, spherical.DEFAULTS, rtol=tolerance, atol=tolerance)


def test_ensembles_warn() -> None:
    angles = np.linspace(2.5, 3.0, 9)
    starts = {"theta1": angles, "theta2": angles}
    with pytest.warns(PredictabilityWarning, match="4 of 4 examined motions are not predictable"):
        ensemble(dp, (0, 60), starts, dp.DEFAULTS, rtol=1e-6)
    with pytest.warns(EnergyWarning, match=r"of 2 of 3 motions.*from -9\.891 to"):
        ensemble(
            cp,
            (0, 10),
            np.transpose([(0.01, 0.01, 0.0, 0.0), COUPLED, COUPLED]),
            cp.DEFAULTS,
            method="heun",
            h=0.2,
        )
    ensemble(dp, (0, 60), {"theta1": 0.1 * angles, "theta2": 0.0}, dp.DEFAULTS)


def test_a_prepared_run_has_the_warnings_of_its_last_motion() -> None:
    run = prepare(dp, {"m2": 0.5}, rtol=1e-6, atol=1e-6)
    assert run.warnings == []
    run((0, 60), (3.0, 3.0, 0.0, 0.0))
    with pytest.warns(PredictabilityWarning) as caught:
        integrate(dp, (0, 60), (3.0, 3.0, 0.0, 0.0), {"m2": 0.5}, rtol=1e-6, atol=1e-6)
    assert run.warnings == [str(caught[0].message)]
    run((0, 5), (0.1, 0.1, 0.0, 0.0))
    assert run.warnings == []
    wild = prepare(cp, cp.DEFAULTS, method="heun", h=0.2)
    wild((0, 10), COUPLED)
    assert len(wild.warnings) == 1
    assert "the energy" in wild.warnings[0]


def test_ignored_warnings_are_not_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*arguments: object) -> float:
        raise AssertionError

    monkeypatch.setattr("solvers.integration.checks.accuracy_warnings.predictable_until", fail)
    with warnings.catch_warnings(), ignore_predictability():
        warnings.simplefilter("error")
        integrate(dp, (0, 60), REPORT, dp.DEFAULTS, rtol=1e-6)
    with pytest.raises(AssertionError):
        integrate(dp, (0, 60), REPORT, dp.DEFAULTS, rtol=1e-6)


@pytest.mark.long("more cases of the same kind", keep=4)
@pytest.mark.parametrize(
    ("module", "start", "method", "h", "steps", "named"),
    [
        (sp, (1.0, 0.0), "rk4", 0.1, 1500, "method = 'leapfrog4' with"),
        (dp, (0.5, -0.4, 0.0, 0.0), "rk4", 0.12, 4000, "'gauss4', form = 'hamiltonian' with"),
        (sp, (1.0, 0.0), "rk4", 0.1, 900, None),  # a shorter step costs little
        (sp, (1.0, 0.0), "rk4", 0.02, 5000, None),  # the energy changes by less than a thousandth
        (sp, (1.0, 0.0), "leapfrog", 0.1, 5000, None),  # its change, of a hundredth, stays bounded
        (sp, (1.0, 0.0), "gauss1", 0.1, 5000, None),
    ],
)
def test_a_drift_over_many_fixed_steps_warns_with_a_symplectic_method(
    module: ModuleType,
    start: tuple[float, ...],
    method: str,
    h: float,
    steps: int,
    named: str | None,
) -> None:
    span, params = (2000 * h, (2000 + steps) * h), module.DEFAULTS  # from any time on
    starts = np.tile(start, (3, 1)).T

    def texts(run: Callable[[], object]) -> list[str]:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            run()
        return [str(one.message) for one in caught if one.category is DriftWarning]

    found = texts(lambda: integrate(module, span, start, params, method=method, h=h))
    of_many = texts(lambda: ensemble(module, span, starts, params, method=method, h=h))
    prepared = prepare(module, params, method=method, h=h)
    prepared(span, start)
    if named is None:
        assert not found
        assert not of_many
        assert not prepared.warnings
    else:
        for (text,) in (found, of_many, prepared.warnings):
            assert named in text
            assert "'rk4' is not symplectic" in text
    assert ("3 of 3 motions" in str(of_many)) == (named is not None)


@pytest.mark.parametrize(
    ("module", "start", "h", "options"),
    [
        (sp, (1.0, 0.0), 0.1, {"method": "leapfrog4"}),
        (dp, (0.5, -0.4, 0.0, 0.0), 0.12, {"method": "gauss4", "form": "hamiltonian"}),
    ],
)
def test_the_suggested_method_keeps_the_energy_with_the_same_step(
    module: ModuleType, start: tuple[float, ...], h: float, options: dict[str, str]
) -> None:
    def errors(**options: object) -> list[float]:
        """Largest errors of the energy in each quarter of the run, relative to the motion's."""
        span = (0, 4000 * h)
        run = integrate(module, span, start, module.DEFAULTS, h=h, energy=True, **options)
        depth = module.energy(0.0, np.zeros(len(start)), module.DEFAULTS)
        error = np.abs(run.energy - run.energy[0]) / (run.energy[0] - depth)
        return [float(part.max()) for part in np.array_split(error, 4)]

    first, *_, last = errors(**options)
    assert last == pytest.approx(first, rel=0.05)
    assert last < 2e-5
    with pytest.warns(DriftWarning):
        first, *_, last = errors(method="rk4")
    assert last > 2 * first > 1e-3
