"""Nearly singular mass matrices are reported with their coordinate, singular ones are refused."""

from collections.abc import Callable
from math import cos, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from handwritten import handwritten

import generated.double_pendulum as dp
from solvers.equations.singularities import MassMatrixWarning, check_condition
from solvers.integration.checks.predictability import ignore_predictability
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.prepare import prepare
from solvers.integration.problem.status import Status
from solvers.sweeps.definition.axes import Grid, Random
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution.sweep_run import sweep
from solvers.sweeps.maps.final import Final

#: Rods that are aligned, nearly so, and at right angles: the motion aligns them.
STARTS = [(0.1, 0.1, 0.0, 0.0), (0.1, 0.2, 0.0, 0.0), (0.0, 1.57, 0.0, 0.0)]


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize(("m1", "m2"), [(1e-13, 1.0), (1.0, 1e13), (2e-7, 1e6)])
def test_a_nearly_singular_mass_matrix_is_reported_at_the_start(
    start: tuple[float, ...], m1: float, m2: float
) -> None:
    message = r"mass matrix has condition [1-9]e\+1[34]: theta\d has hardly any inertia of its own"
    with ignore_predictability(), pytest.warns(MassMatrixWarning, match=message) as given:
        integrate(dp, (0, 1e-6), start, {"m1": m1, "m2": m2})
    assert given[0].filename == __file__


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("masses", [{"m1": 1e-16}, {"m2": 1e17}, {"m1": 0.0}])
def test_a_singular_mass_matrix_is_refused(
    start: tuple[float, ...], masses: dict[str, float]
) -> None:
    with pytest.raises(ValueError, match=r"theta\d has hardly any inertia .*; leave that coord"):
        integrate(dp, (0, 1), start, masses)


@pytest.mark.parametrize("masses", [{"m1": 1e-11}, {"m2": 1e-16}, {"m2": 1e11}, {"l2": 1e-16}])
def test_other_ratios_are_permitted_without_a_warning(masses: dict[str, float]) -> None:
    with ignore_predictability():
        assert integrate(dp, (0, 1e-9), STARTS[1], masses).status is Status.FINISHED


MANY = {"theta1": [0.1, 0.2, 0.0], "theta2": [0.1, 0.2, 1.57]}
AXES = Grid({"theta1": [0.1, 0.2], "theta2": [0.2, 0.3]})
REST = {"theta1": 0.1, "theta2": 0.2}
MAPS = {"end": Final(("theta1",))}


def calls(m1: float) -> dict[str, Callable[[], Any]]:
    """Calls with this mass, by the motion that they report."""
    return {
        "motion 0: ": lambda: ensemble(dp, (0, 1e-6), MANY, {"m1": [m1, 1.0, 1.0]}),
        "motion 2: ": lambda: ensemble(dp, (0, 1e-6), MANY, {"m1": [1.0, 1.0, m1]}),
        "": lambda: prepare(dp, {"m1": m1}),
        r"motion 0 \(theta1 = 0.1, theta2 = 0.2\): ": lambda: Sweep(
            dp, AXES, MAPS, 1e-6, {"m1": m1}
        ),
        r"motion 2 \(m1 = .*, m2 = 2\): ": lambda: Sweep(
            dp, Grid({"m1": [1.0, m1], "m2": [2.0, 0.5]}), MAPS, 1e-6, REST
        ),
        r"motion \d \(m1 = .*\): ": lambda: Sweep(
            dp, Random({"m1": (m1, 1.001 * m1)}, 5, 0), MAPS, 1e-6, REST
        ),
    }


@pytest.mark.parametrize("where", calls(1.0))
def test_nearly_singular_mass_matrices_of_many_motions_are_reported(where: str) -> None:
    message = (
        rf"^{where}the mass matrix has condition [1-9]e\+1[34]: theta\d has hardly any inertia"
    )
    with ignore_predictability(), pytest.warns(MassMatrixWarning, match=message) as given:
        calls(1e-13)[where]()
    assert [warning.filename for warning in given] == [__file__]
    with pytest.raises(ValueError, match=rf"^{where}the mass matrix .*; leave that coordinate out"):
        calls(1e-16)[where]()


def test_all_corners_of_a_grid_are_examined() -> None:
    axes = Grid({"m1": [1.0, 1.0, 1e-7], "m2": [1e6, 1.0, 1.0]})  # both are extreme at one corner
    with pytest.warns(MassMatrixWarning, match=r"motion 6 \(m1 = 1e-07, m2 = 1e\+06\)"):
        Sweep(dp, axes, MAPS, 1e-6, REST)


def test_a_condition_of_1e15_is_refused_and_one_of_1e12_is_reported() -> None:
    def check(coupling: float) -> None:
        rows = (1.0, 1 - coupling), (1 - coupling, 1.0)  # of condition 2/coupling - 1
        module = handwritten(
            "coupled",
            ("x", "y", "x_dot", "y_dot"),
            COORDINATES=("x", "y"),
            OPERATIONS={"rhs": (0, 0), "mass_matrix": (0, 0)},
            mass_matrix=lambda t, y, params: rows,
        )
        check_condition(module, [("", (1.0,), (0.0,) * 4)])

    check(4e-12)
    with pytest.warns(MassMatrixWarning, match=r"condition 2e\+12: .*; about 12 digits are lost"):
        check(1e-12)
    with pytest.warns(MassMatrixWarning):
        check(4e-15)
    with pytest.raises(ValueError, match=r"condition 2e\+15"):
        check(1e-15)


def test_chunks_of_a_sweep_do_not_repeat_the_warning(tmp_path: Path) -> None:
    with pytest.warns(MassMatrixWarning) as given:
        results = sweep(Sweep(dp, AXES, MAPS, 1e-6, {"m1": 1e-13}), tmp_path)
    assert len(given) == 1
    assert np.isfinite(results.maps["end"]).all()


def top(t: float, y: Any, params: Any) -> tuple[tuple[float, ...], ...]:
    """The mass matrix of a symmetric top with the angles psi, theta and phi."""
    (_, theta, *_), (A, C) = y, params
    upright = C * cos(theta)
    across = A * sin(theta) ** 2 + C * cos(theta) ** 2
    return (across, 0.0, upright), (0.0, A, 0.0), (upright, 0.0, C)


def test_a_state_that_is_singular_whatever_the_masses_counts_at_the_start_only() -> None:
    module = handwritten(
        "top",
        ("psi", "theta", "phi", "psi_dot", "theta_dot", "phi_dot"),
        ("A", "C"),
        COORDINATES=("psi", "theta", "phi"),
        OPERATIONS={"rhs": (0, 0), "mass_matrix": (0, 0)},
        rhs=lambda t, y, params: (*y[3:], 0.0, 0.0, 0.0),
        mass_matrix=top,
    )
    tilted = (0.0, 0.5, 0.0, 1.0, 0.0, 1.0)  # the pole is where all three angles are 0
    assert integrate(module, (0, 1), tilted, (1.0, 2.0)).status is Status.FINISHED
    with pytest.raises(ValueError, match=r"(psi|phi) has hardly any inertia of its own"):
        check_condition(module, [("", (1.0, 2.0), (0.0,) * 6)])
