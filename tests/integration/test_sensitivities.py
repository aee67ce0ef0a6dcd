"""Derivatives of motions by starts, parameters and inputs, beside series and closed forms."""

import mpmath as mp
import numpy as np
import pytest
from numpy.testing import assert_allclose
from sympy import symbols

import generated.double_pendulum as dp
import generated.elastic_pendulum as ep
import generated.single_pendulum as sp
from derive import Coordinate, Input, Parameter, PointMass, System
from solvers import Event, Held, integrate, sensitivities
from solvers.app.modules import build
from solvers.equations.module import GeneratedModule, function
from solvers.integration.prepare import NotFinishedError
from solvers.references.taylor import taylor

#: Weights of a difference of order 8, for steps from -4 to 4.
WEIGHTS = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])


def by_series(
    module: GeneratedModule, times: list[float], y0: list[float], params: list[float], k: int
) -> np.ndarray:
    """Derivatives of the states at `times` by quantity `k`, start first, from Taylor series."""
    step, motions = 0.01, []
    for count in range(-4, 5):
        values = np.array([*y0, *params]) + step * count * (np.arange(len(y0) + len(params)) == k)
        start, constants = values[: len(y0)].tolist(), values[len(y0) :].tolist()
        motions.append(taylor(module, constants, start, [0.0, *times], 20)[1:])
    return np.asarray(np.tensordot(WEIGHTS, motions, 1) / step)


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(
    ("module", "y0", "changed", "quantities"),
    [
        (dp, [1.0, 1.5, 0.2, -0.3], {"m2": 0.5}, ["theta2", "theta1_dot", "m2", "l1", "g"]),
        (ep, [1.2, 0.3, 0.0, 0.5], {"k": 40.0}, ["r", "theta_dot", "m", "k", "l"]),
    ],
)
def test_derivatives_agree_with_differences_of_series(
    module: GeneratedModule, y0: list[float], changed: dict[str, float], quantities: list[str]
) -> None:
    names, times = (*module.STATE, *module.PARAMETERS), [0.4, 1.5]
    params = [changed.get(p, d) for p, d in zip(module.PARAMETERS, module.DEFAULTS, strict=True)]
    motion = sensitivities(module, (0, 1.5), y0, params, quantities, t_eval=times)
    assert motion.by == tuple(quantities)
    for k, name in enumerate(quantities):
        exact = by_series(module, times, y0, params, names.index(name)).T
        assert_allclose(motion.sample_derivatives[:, k], exact, atol=1e-10 * abs(exact).max())
        assert_allclose(motion.derivatives[:, k], exact[:, -1], atol=1e-10 * abs(exact).max())
    coarse = sensitivities(module, (0, 1.5), y0, params, quantities, rtol=1e-6, atol=1e-6)
    assert not np.allclose(coarse.derivatives, motion.derivatives, rtol=0, atol=1e-9)


def test_the_time_of_a_passage_is_a_quarter_of_the_period() -> None:
    start, end = 1.2, {"l": 0.7, "g": 9.81}
    lowest = Event(sp, "theta", 0.0, terminal=True)
    quantities = ["theta", "l", "g", "m"]
    motion = sensitivities(sp, (0, 5), {"theta": start}, end, quantities, events=lowest)

    def quarter(theta: mp.mpf, length: mp.mpf, g: mp.mpf) -> mp.mpf:
        return mp.sqrt(length / g) * mp.ellipk(mp.sin(theta / 2) ** 2)

    def speed(theta: mp.mpf, length: mp.mpf, g: mp.mpf) -> mp.mpf:
        return -mp.sqrt(2 * g / length * (1 - mp.cos(theta)))

    with mp.workdps(30):
        point = [mp.mpf(x) for x in (start, end["l"], end["g"])]
        orders = [tuple(int(i == k) for i in range(3)) for k in range(3)]
        of_time, of_speed = (
            [float(mp.diff(law, point, order)) for order in orders] for law in (quarter, speed)
        )
        assert motion.t == pytest.approx(float(quarter(*point)), rel=1e-12)
    assert_allclose(motion.t_event_derivatives[0][:, 0], [*of_time, 0.0], atol=1e-11)
    assert_allclose(motion.y_event_derivatives[0][:, :, 0], [[0] * 4, [*of_speed, 0]], atol=1e-10)
    assert np.array_equal(motion.derivatives, motion.y_event_derivatives[0][:, :, 0])


def test_all_crossings_have_derivatives_however_many() -> None:
    event = Event(sp, "theta", 0.1)
    motion = sensitivities(sp, (0, 40), {"theta": 0.5}, {}, ["g"], events=[event])
    times = integrate(sp, (0, 40), {"theta": 0.5}, {}, events=event, rtol=1e-12).t_events[0]
    assert len(times) > 16
    assert_allclose(motion.t_events[0], times, rtol=1e-9)
    # all times of a pendulum are proportional to 1/sqrt(g)
    assert_allclose(motion.t_event_derivatives[0][0], -times / (2 * 9.81), rtol=1e-8)


@pytest.fixture(scope="module")
def cart() -> GeneratedModule:
    x, F = symbols("x F", real=True)
    m = symbols("m", positive=True)
    return build(
        System(
            name="pushed_cart",
            title="A cart with a force",
            coordinates=[Coordinate(x, "m", "position")],
            parameters=[Parameter(m, "kg", 2.0, "mass")],
            masses=[PointMass(m, (x, 0))],
            potential=0,
            forces=[F],
            inputs=[Input(F, "N", "force on the cart")],
        )
    )


def test_held_inputs_and_their_offsets_have_exact_derivatives(cart: GeneratedModule) -> None:
    pulses = Held([0.0, 1.0], [[4.0, -2.0]])  # x = t² to 1 s, then 1 + 2 s - s²/2, s = t - 1
    events = [Event(cart, "x", 2.5, direction=1), Event(cart, "x_dot", 1.5, direction=-1)]
    motion = sensitivities(cart, (0, 3), {"x": 0.0}, {}, ["m", "F"], inputs=pulses, events=events)
    assert_allclose(motion.y, [3.0, 0.0], atol=1e-12)
    assert_allclose(motion.derivatives, [[-1.5, 9 / 4], [0.0, 1.5]], atol=1e-12)
    s = 1.0  # 1 + 2 s - s²/2 = 2.5, where the speed is 1 m/s
    assert_allclose(motion.t_events[0], [1 + s], atol=1e-12)
    assert_allclose(motion.t_event_derivatives[0][:, 0], [1.25, -1.0], atol=1e-12)
    assert_allclose(motion.t_events[1], [1.5], atol=1e-12)
    assert_allclose(motion.t_event_derivatives[1][:, 0], [-0.75, 0.75], atol=1e-12)
    constant = sensitivities(cart, (0, 3), {"x": 0.0}, {}, ["F"], inputs={"F": 2.0})
    assert_allclose(constant.derivatives[:, 0], [9 / 4, 1.5], atol=1e-12)


def test_invalid_arguments_are_refused(cart: GeneratedModule) -> None:
    with pytest.raises(ValueError, match=r"by has 'l11' \(did you mean 'l1'\?\)"):
        sensitivities(dp, (0, 1), {"theta1": 1.0, "theta2": 0.0}, {}, ["l11"])
    with pytest.raises(ValueError, match="by = 'theta' must be a sequence of texts"):
        sensitivities(sp, (0, 1), {"theta": 1.0}, {}, "theta")
    with pytest.raises(ValueError, match="inputs is a function, whose derivatives are not known"):
        sensitivities(cart, (0, 1), {"x": 1.0}, {}, inputs=Held(0.1, lambda t, y: -y[0]))  # type: ignore[arg-type]
    with pytest.raises(NotFinishedError, match="fell to 0"):
        sensitivities(ep, (0, 9), {"r": 1.0, "theta": 0.0, "r_dot": -90.0}, {})


def test_the_form_takes_perturbations_by_name() -> None:
    start = {"theta": 1.0}
    motion = integrate(sp, (0, 2), start, {"delta_g": 1.0}, form="sensitivity", rtol=1e-12)
    exact = sensitivities(sp, (0, 2), start, {}, ["g"]).derivatives[:, 0]
    assert_allclose(motion.y[2:, -1], exact, atol=1e-9)
    assert "delta_theta" in motion.to_table()
    assert function(sp, "rhs_sensitivity")(0.0, [0.0, 1.0, 0, 1, 0], [0, 0, 1, 1, 1, 9.81])
