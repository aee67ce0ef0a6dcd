"""Parameters and states by name, and the order of axes of ensembles."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import generated.double_pendulum as dp
import generated.single_pendulum as sp
from solvers import Scene, ensemble, integrate, prepare
from solvers.integration.problem import validation

Y0 = {"theta1": 0.3, "theta2": 0.2, "theta2_dot": -0.1}
PARAMS = {"g": 1.62, "m2": 3.0}
IN_ORDER = (0.3, 0.2, 0.0, -0.1), (1.0, 3.0, 2.0, 2.0, 1.62)


def test_integrations_by_name_equal_those_in_order() -> None:
    expected = integrate(dp, (0, 2), *IN_ORDER)
    assert_array_equal(integrate(dp, (0, 2), Y0, PARAMS).y, expected.y)
    assert_array_equal(integrate(dp, (0, 2), Y0, IN_ORDER[1]).y, expected.y)
    scene = Scene(dp, PARAMS, Y0, 2.0)
    assert (scene.y0, scene.params) == IN_ORDER


def test_texts_have_units_in_place_of_numbers() -> None:
    numbers = integrate(dp, (0, 6), (np.pi / 2, 1.0, np.pi / 18, 0.0), {"m2": 0.3}, t_eval=[0.5, 3])
    start = {"theta1": "90 deg", "theta2": 1, "theta1_dot": "10 deg/s"}
    texts = integrate(dp, (0, "1/10 min"), start, {"m2": "300 g"}, t_eval=["500 ms", 3])
    assert_allclose(texts.y, numbers.y, rtol=1e-9)
    several = ensemble(dp, (0, "1 s"), {"theta1": ["90 deg", np.pi / 2], "theta2": 0.0}, {})
    assert_allclose(several.y[:, 0], several.y[:, 1], rtol=1e-12)


def test_default_parameters_and_velocities_complete_a_mapping() -> None:
    assert_array_equal(validation.parameters(dp, {}), dp.DEFAULTS)
    assert_array_equal(validation.parameters(sp, {"g": 1, "l": 3.0, "m": 2}), (2.0, 3.0, 1.0))
    assert_array_equal(validation.initial_state(sp, {"theta": 1}), (1.0, 0.0))
    changes = {"delta_theta1": 1.0, "delta_theta2": 2.0}
    state = validation.initial_state(dp, Y0 | changes, "variational")
    assert_array_equal(state, (*IN_ORDER[0], 1.0, 2.0, 0.0, 0.0))


def test_ensembles_by_name_equal_those_in_order() -> None:
    theta1, g = np.linspace(0, 1, 5), np.linspace(1, 9, 5)
    named = ensemble(dp, (0, 2), {"theta1": theta1, "theta2": 0.2}, {"g": g, "m2": 3.0})
    states = np.stack([theta1, np.full(5, 0.2), np.zeros(5), np.zeros(5)])
    params = np.tile(np.reshape(IN_ORDER[1], (5, 1)), 5)
    params[dp.PARAMETERS.index("g")] = g
    assert_array_equal(named.y, ensemble(dp, (0, 2), states, params).y)
    for k in range(5):
        alone = ensemble(dp, (0, 2), states[:, [k]], params[:, k])
        assert_array_equal(named.y[:, k], alone.y[:, 0])


def test_states_of_ensembles_have_the_axes_of_generated_functions() -> None:
    y0 = {"theta1": np.linspace(0, 1, 7), "theta2": 0.1}
    params = {"g": np.linspace(1, 9, 7)}
    times = [0.5, 1.0, 2.0]
    motions = ensemble(dp, (0, 2), y0, params, t_eval=times, rtol=1e-11)
    in_order = validation.parameter_rows(dp, params | {"m1": np.ones(7)}, 7).T
    energies = dp.energy_many(0.0, motions.y, in_order)
    start = dp.energy_many(
        0.0, np.stack([*np.broadcast_arrays(*y0.values()), *np.zeros((2, 7))]), in_order
    )
    assert np.abs(energies - start).max() < 1e-8
    assert motions.samples.shape == (4, 7, 3)
    assert_array_equal(motions.samples[:, :, -1], motions.y)
    one = integrate(
        dp,
        (0, 2),
        {"theta1": 1.0, "theta2": 0.1},
        (*dp.DEFAULTS[:4], 9.0),
        t_eval=times,
        rtol=1e-11,
    )
    assert np.abs(motions.samples[:, -1] - one.y).max() < 1e-8


@pytest.mark.parametrize(("y0", "params", "message"), [
    ({"theta": 1.0, "theta_dott": 0.0}, {}, "y0 has no 'theta_dott' .did you mean 'theta_dot'"),
    ({"theta": 1.0, "phi": 0.0}, {}, "y0 has no 'phi'; known names: theta, theta_dot"),
    ({"theta_dot": 1.0}, {}, "y0 lacks theta, on which the motion depends"),
    ({}, {}, "y0 lacks theta"),
    ({"theta": "1 m"}, {}, "theta: '1 m' has another unit: give rad or a unit of that kind"),
    ({"theta": ["1 deg", "x"]}, {}, r"theta\[1\]: unit 'x' is not known"),
    ({"theta": True}, {}, "theta = True must be a finite real number"),
    ({"theta": float("nan")}, {}, "theta = nan must be a finite real number"),
    ({"theta": [1.0, 2.0]}, {}, r"y0 has shape \(2, 2\): give 2 numbers, theta, theta_dot"),
    ({"theta": 1.0}, {"G": 9.81}, "params has no 'G' .did you mean 'g'"),
    ({"theta": 1.0}, {1: 9.81}, "params has no 1"),
    ({"theta": 1.0}, {"m": [1.0, 2.0]}, "params has shape"),
])  # fmt: skip
def test_unknown_and_missing_names_are_refused(y0: Any, params: Any, message: str) -> None:
    run = prepare(sp, sp.DEFAULTS)
    for function in (
        lambda: integrate(sp, (0, 1), y0, params),
        lambda: run((0, 1), y0, params),
        lambda: Scene(sp, params, y0, 1.0),
    ):
        with pytest.raises(ValueError, match=message):
            function()


def test_arrays_with_the_motions_first_are_refused() -> None:
    states = np.zeros((7, 4))
    with pytest.raises(ValueError, match=r"y0 has shape \(7, 4\): .*; transpose it: y0.T"):
        ensemble(dp, (0, 1), states, dp.DEFAULTS)
    with pytest.raises(ValueError, match=r"params has shape \(7, 5\): .*transpose it: params.T"):
        ensemble(dp, (0, 1), states.T, np.ones((7, 5)))
    with pytest.raises(ValueError, match=r"y0 has shape \(3, 7\): the first axis must hold the 4"):
        ensemble(dp, (0, 1), states.T[:3], dp.DEFAULTS)


def test_a_prepared_run_takes_other_parameters_for_a_call() -> None:
    run = prepare(dp, PARAMS)
    default = run((0, 2), Y0)
    assert default == run((0, 2), IN_ORDER[0]) == prepare(dp, IN_ORDER[1])((0, 2), IN_ORDER[0])
    on_earth = (*IN_ORDER[1][:4], 9.81)
    expected = prepare(dp, on_earth)((0, 2), IN_ORDER[0])
    assert expected != default
    for params in (on_earth, list(on_earth), np.array(on_earth), {"m2": 3.0}):
        assert run((0, 2), Y0, params) == expected
        assert run((0, 2), Y0) == default
    infinite = (1.0, 1.0, 1.0, 1.0, float("inf"))
    for params in ((1.0, 2.0), infinite, {"gravity": 1.0}):
        with pytest.raises(ValueError, match=r"params|g = inf must be"):
            run((0, 2), Y0, params)
        assert run((0, 2), Y0) == default


def test_a_prepared_hamiltonian_run_enters_with_the_parameters_of_the_call() -> None:
    run = prepare(dp, dp.DEFAULTS, form="hamiltonian", rtol=1e-11)
    lagrangian = prepare(dp, PARAMS, form="lagrangian", rtol=1e-11)
    assert np.abs(np.subtract(run((0, 2), Y0, PARAMS), lagrangian((0, 2), Y0))).max() < 1e-8


def test_the_name_of_a_system_is_no_module() -> None:
    name: Any = "double_pendulum"
    calls = (
        lambda: integrate(name, (0, 1), Y0, {}),
        lambda: ensemble(name, (0, 1), Y0, {}),
        lambda: prepare(name, {}),
    )
    for call in calls:
        with pytest.raises(ValueError, match=r"such as solvers\.load\('double_pendulum'\) returns"):
            call()
