"""Parameters and coordinates that are declared positive are positive, wherever they are given."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest

import generated.double_pendulum as dp
import generated.elastic_pendulum as ep
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.prepare import NotFinishedError, prepare
from solvers.integration.problem.status import Status
from solvers.scenes.scene import Scene
from solvers.sweeps.definition.axes import Grid
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.maps.final import Final

NEGATIVE = (1.0, -1.0, 1.0, 1.0, 9.81)
START = (0.1, 0.2, 0.0, 0.0)
#: A bob that is thrown at its pivot, and arrives there after a time near 1/30 s.
TO_THE_PIVOT = (1.0, 0.0, -30.0, 0.0)


def swept(**axes: list[float]) -> Sweep:
    return Sweep(ep, Grid({"theta": [0.1], **axes}), {"end": Final(("r",))}, duration=1.0)


@pytest.mark.parametrize(
    "run",
    [
        partial(integrate, dp, (0, 1), START, NEGATIVE),
        partial(integrate, dp, (0, 1), START, {"m2": -1.0}),
        partial(ensemble, dp, (0, 1), np.transpose([START]), NEGATIVE),
        partial(ensemble, dp, (0, 1), {"theta1": [0.1, 0.2], "theta2": 0}, {"m2": [1.0, -1.0]}),
        partial(prepare, dp, NEGATIVE),
        partial(prepare(dp, dp.DEFAULTS), (0, 1), START, NEGATIVE),
        partial(prepare(dp, dp.DEFAULTS), (0, 1), START, {"m2": -1.0}),
        partial(Scene, dp, NEGATIVE, START, 1.0),
        partial(
            Sweep,
            dp,
            Grid({"theta1": [0.1], "theta2": [0.2], "m2": [1.0, -1.0]}),
            {"end": Final(("theta1",))},
            duration=1.0,
        ),
    ],
)
def test_a_negative_mass_is_refused(run: Callable[[], Any]) -> None:
    with pytest.raises(ValueError, match=r"m2(\[1\])? = -1\.0 must be positive, in kg"):
        run()


def test_an_absent_mass_is_none() -> None:
    absent = integrate(dp, (0, 1), START, {"m2": 0.0}, t_eval=[1.0])
    single = integrate(dp, (0, 1), START, {"m2": 1e-14}, t_eval=[1.0])
    assert absent.y == pytest.approx(single.y, abs=1e-8)


@pytest.mark.parametrize("length", [0.0, -1.0])
def test_a_motion_does_not_start_outside_the_domain_of_a_coordinate(length: float) -> None:
    start = (length, 0.1, 0.0, 0.0)
    for run in (
        partial(integrate, ep, (0, 1), start, ep.DEFAULTS),
        partial(ensemble, ep, (0, 1), np.transpose([start]), ep.DEFAULTS),
        partial(prepare(ep, ep.DEFAULTS), (0, 1), start),
        partial(Scene, ep, ep.DEFAULTS, start, 1.0),
        partial(swept, r=[1.0, length]),
    ):
        with pytest.raises(ValueError, match=rf"r(\[0\])? = {length} must be positive, in m"):
            run()


@pytest.mark.long("more cases of the same kind", keep=4)
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"backend": "python"},
        {"method": "rk4", "h": 1e-3},
        {"method": "gauss2", "h": 1e-3},
        {"method": "RK45"},
        {"form": "hamiltonian"},
        {"t_eval": [0.5, 1.0]},
    ],
)
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_a_motion_ends_where_a_positive_coordinate_falls_to_0(options: dict[str, Any]) -> None:
    inside = integrate(ep, (0, 0.03), TO_THE_PIVOT, ep.DEFAULTS)
    assert inside.status is Status.FINISHED
    solution = integrate(ep, (0, 1), TO_THE_PIVOT, ep.DEFAULTS, **options)
    t, y = solution.end
    assert solution.status is Status.OUTSIDE_DOMAIN
    assert not solution.success
    assert 0.03 < t < 0.04
    assert f"t = {t}, r = " in solution.message
    assert abs(y[0]) < 1e-9
    assert solution.t_events == []
    with pytest.raises(ValueError, match=r"r = .* must be positive"):
        integrate(ep, (t, 1), (min(y[0], 0.0), *y[1:]), ep.DEFAULTS)


@pytest.mark.parametrize("backend", ["python", "compiled"])
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_many_motions_end_there_too(backend: str) -> None:
    starts = np.transpose([TO_THE_PIVOT, (1.0, 0.1, 0.0, 0.0)])
    motions = ensemble(ep, (0, 1), starts, ep.DEFAULTS, backend=backend, t_eval=[0.02, 0.9])
    assert motions.status.tolist() == [Status.OUTSIDE_DOMAIN, Status.FINISHED]
    assert motions.t_events.shape == (2, 0, 1)
    assert np.isfinite(motions.samples[0]).tolist() == [[True, False], [True, True]]
    with pytest.raises(NotFinishedError, match="must be positive fell to 0") as stopped:
        prepare(ep, ep.DEFAULTS)((0, 1), TO_THE_PIVOT)
    assert stopped.value.t == pytest.approx(motions.t[0], abs=1e-9)
