"""Motions stay on zeros of switching functions as long as forces hold them there."""

from itertools import product
from math import acos, cos, exp, pi, sin, sqrt

import numpy as np
import pytest
import sympy as sp
from cart_pole import cart_pole
from friction import BELT, X, Y, block, slider_crank, stacked, v, w, x, y
from scipy.linalg import solve_continuous_are
from scipy.optimize import brentq

from derive import PointMass, System
from solvers.app.modules import build
from solvers.equations.linearisation.linear_system import linearise
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.prepare import prepare
from solvers.integration.problem.inputs import Held
from solvers.integration.problem.status import Status

BACKENDS = ("python", "compiled")


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("mu", [0.5, 0.2])
def test_a_block_on_a_slope_stops_and_stays_or_slides_back(mu: float, backend: str) -> None:
    up, down = (9.81 * (sin(0.3) + sign * mu * cos(0.3)) for sign in (1, -1))
    stop, height = 2 / up, -2 * 2 / (2 * up)
    left = 3 - stop
    given = {"W": 9.81 * sin(0.3), "F": 9.81 * mu * cos(0.3)}
    motion = integrate(block(), (0, 3), (0.0, -2.0), given, backend=backend, rtol=1e-12)
    expected = (height, 0.0) if down < 0 else (height + down * left**2 / 2, down * left)
    assert motion.status is Status.FINISHED
    assert motion.y[:, -1] == pytest.approx(expected, rel=1e-12, abs=1e-13)


def driven(t: float) -> tuple[float, float]:
    """The motion of a block from rest, with the force cos t and friction 4/5, phase by phase."""
    place, first = 0.0, acos(-0.8)
    for k in range(20):
        sign = 1 - 2 * (k % 2)  # the half period k starts where cos t = ±4/5, the first one at 0
        begin = 0.0 if k == 0 else first + (k - 1) * pi

        def rate(s: float, begin=begin, sign=sign) -> float:
            return sin(s) - sin(begin) - 0.8 * sign * (s - begin)

        end = brentq(rate, begin + 0.5, begin + 2.5, xtol=1e-15)

        def moved(s: float, begin=begin, sign=sign) -> float:
            return -cos(s) + cos(begin) - sin(begin) * (s - begin) - 0.4 * sign * (s - begin) ** 2

        if t < end:
            return place + moved(t), rate(t)
        place += moved(end)
        if t < first + k * pi:
            return place, 0.0
    raise AssertionError


DRIVEN = {"P": 1.0, "F": 0.8}


@pytest.mark.long("more cases of the same kind", keep=3)
@pytest.mark.parametrize(
    ("method", "backend"),
    [*product(("verner853", "radau"), BACKENDS), ("DOP853", None), ("gauss8", None)],
)
def test_a_driven_block_sticks_and_slips(method: str, backend: str | None) -> None:
    times = [1.0, 2.0, 3.0, 5.1, 9.0, 20.0]  # the block rests at 2.0 and 5.1
    motion = integrate(
        *(block(), (0, 20), (0.0, 0.0), DRIVEN),
        method=method,
        backend=backend,
        rtol=1e-11,
        t_eval=times,
    )
    expected = np.transpose([driven(t) for t in times])
    assert np.count_nonzero(expected[1] == 0) == 2
    assert abs(motion.y - expected).max() < 1e-9


@pytest.mark.long("other tests reach its code")
def test_prepared_functions_and_ensembles_do_the_same() -> None:
    module = block()
    run = prepare(module, DRIVEN, rtol=1e-11)
    assert run((0, 20), (0.0, 0.0)) == pytest.approx(driven(20.0), abs=1e-9)
    place, rate = run((0, 2), (0.0, 0.0))
    assert place == pytest.approx(driven(2.0)[0], abs=1e-9)
    assert abs(rate) < 2e-15  # the block rests up to rounding errors
    assert run((0, 20), (0.0, 0.0)) == pytest.approx(driven(20.0), abs=1e-9)
    assert run((0, 20), (0.7, 0.0), {"P": 0.7, "F": 0.8}) == pytest.approx((0.7, 0.0), abs=1e-12)
    forces = np.linspace(0.4, 3.0, 37)
    params = {"P": forces, "F": 0.8}
    motions = ensemble(module, (0, 20), np.zeros((2, 37)), params, rtol=1e-11)
    assert motions.success.all()
    for k in range(0, 37, 6):
        own = {"P": forces[k], "F": 0.8}
        single = integrate(module, (0, 20), (0.0, 0.0), own, rtol=1e-11, backend="python")
        assert motions.y[:, k] == pytest.approx(single.y[:, -1], abs=1e-8)


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_period_of_stick_and_slip_on_a_belt(backend: str) -> None:
    # slip: x'' = -x + F (1 - c V) + F c x', from x = F with the belt's velocity
    growth, centre = 0.1, 1 - 0.2 * 0.4
    rate = sqrt(1 - growth**2)
    a, b = 1 - centre, (0.4 - growth * (1 - centre)) / rate

    def place(t: float) -> float:
        return centre + exp(growth * t) * (a * cos(rate * t) + b * sin(rate * t))

    def speed(t: float) -> float:
        wave = (growth * a + rate * b) * cos(rate * t) + (growth * b - rate * a) * sin(rate * t)
        return exp(growth * t) * wave

    slip = brentq(lambda t: speed(t) - 0.4, 3.0, 6.2, xtol=1e-15)
    period = slip + (1 - place(slip)) / 0.4
    motion = integrate(
        *(block(), (0, 4 * period), (1.0, 0.4), BELT),
        backend=backend,
        rtol=1e-12,
        t_eval=[3.0, period, 2 * period + 3.0, 4 * period],
    )
    assert motion.y[:, 0] == pytest.approx((place(3.0), speed(3.0)), abs=1e-10)
    assert motion.y[:, 2] == pytest.approx((place(3.0), speed(3.0)), abs=1e-9)
    assert motion.y[:, 1] == pytest.approx((1.0, 0.4), abs=1e-9)
    assert motion.y[:, 3] == pytest.approx((1.0, 0.4), abs=1e-9)


@pytest.mark.long("more cases of the same kind", keep=4, daily=10)
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("keep_coordinates", [False, True])
@pytest.mark.parametrize(
    ("phi", "rate"), [(0.0, 0.0), (0.0, -5.0), (pi, 0.0), (pi, -7.0), (1e-9, 0.0)]
)
def test_friction_has_no_lever_arm_at_dead_centres(
    phi: float, rate: float, keep_coordinates: bool, backend: str
) -> None:
    module, torque = slider_crank(keep_coordinates=keep_coordinates), 0.5 if rate == 0 else -0.5
    rates = (rate, -rate * cos(phi) / 3, 0.0)  # rates and places of the crank, rod and slider
    start = dict(zip(("phi_dot", "psi_dot", "x_dot"), rates, strict=True))
    start |= {"phi": phi, "psi": -sin(phi) / 3, "x": 0.1 * cos(phi) + 0.3}
    y = [start[name] for name in module.STATE]
    motion = integrate(module, (0, 1), y, {"P": torque}, rtol=1e-11, atol=1e-11, backend=backend)
    assert motion.status is Status.FINISHED
    end, turned = motion.y[0, -1], abs(motion.y[0, -1] - round(phi / pi) * pi)
    assert turned > pi  # on and on, past the next dead centre
    halves = turned // pi
    places = [
        0.1 * cos(q) + sqrt(0.09 - (0.1 * sin(q)) ** 2) for q in (turned + phi, halves * pi + phi)
    ]
    path = 0.2 * halves + abs(places[0] - places[1])
    work = torque * (end - phi) - path  # friction is 1 N
    energies = module.energy_many(motion.t[[0, -1]], motion.y[:, [0, -1]], module.params(P=torque))
    assert energies[1] - energies[0] == pytest.approx(work, abs=1e-8)


@pytest.mark.parametrize("backend", BACKENDS)
def test_two_functions_stay_0_at_once(backend: str) -> None:
    # together from t = G on, with (t - G)/3; apart from 3 F - G = 2 t on
    F, G, t = 2.0, 1.0, 4.0
    start, apart = G, (3 * F - G) / 2
    speed, place = (apart - start) ** 2 / 6, (apart - start) ** 3 / 18
    left = t - apart
    block = (t**2 - apart**2) / 2 - F * left + speed
    cart = (F - G) / 2 * left + speed
    block_at = place + speed * left - F * left**2 / 2
    block_at += (t**3 - apart**3) / 6 - apart**2 / 2 * left
    expected = (block_at, place + speed * left + (F - G) / 4 * left**2, block, cart)
    motion = integrate(stacked(), (0, t), (0.0,) * 4, (F, G, 1.0), backend=backend, rtol=1e-12)
    assert motion.y[:, -1] == pytest.approx(expected, abs=1e-11)
    # the weaker friction slips alone, the other one holds
    weak = integrate(stacked(), (0, 3), (0.0,) * 4, (1.0, 2.0, 1.0), backend=backend, rtol=1e-12)
    assert weak.y[:, -1] == pytest.approx((8 / 6, 0.0, 2.0, 0.0), abs=1e-11)


@pytest.mark.parametrize("backend", BACKENDS)
def test_functions_that_switch_each_other_ever_faster_come_to_rest(backend: str) -> None:
    # velocities turn about 0, and reach it in finite time
    forces = (sp.sign(w) - sp.sign(v) / 2, -sp.sign(v) - sp.sign(w) / 2)
    turns = build(System("turns", "", [X, Y], [], [PointMass(1, (x, y))], sp.S.Zero, forces=forces))
    motion = integrate(turns, (0, 100), (0.0, 0.0, 0.1, 0.2), (), backend=backend)
    assert motion.status is Status.FINISHED
    assert abs(motion.y[2:, -1]).max() < 1e-12
    assert motion.steps < 1000


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_products_of_signs_determine_no_motion(backend: str) -> None:
    forces = (-sp.sign(v) * (2 + sp.sign(w)), -sp.sign(w) * (2 + sp.sign(v)))
    system = System("products", "", [X, Y], [], [PointMass(1, (x, y))], sp.S.Zero, forces=forces)
    motion = integrate(build(system), (0, 1), (0.0,) * 4, (), backend=backend)
    assert motion.status is Status.UNDETERMINED
    assert motion.t[-1] == 0.0


@pytest.mark.long("other tests reach its code")
def test_a_regulator_with_saturation_and_dry_friction() -> None:
    force = sp.Symbol("F", real=True)
    limited = sp.Min(sp.Max(force, -8), 8) - 0.5 * sp.sign(v)
    forces = (limited, cart_pole.forces[1])
    module = build(
        System(
            *("regulated", "", cart_pole.coordinates, cart_pole.parameters, cart_pole.masses),
            forces=forces,
            inputs=cart_pole.inputs,
        )
    )
    smooth = build(cart_pole)

    plant = linearise(smooth, {"theta": 0.0}, {})
    B = plant.B[:, :1]
    K = (B.T @ solve_continuous_are(plant.A, B, np.diag([10.0, 1, 1, 1]), [[1.0]]))[0]
    held = Held(0.01, lambda t, state: (float(-K @ state), 0.0))
    options = {"inputs": held, "t_eval": np.linspace(0, 10, 1001)}
    runs = [
        integrate(module, (0, 10), {"x": 0.0, "theta": 0.4}, {}, backend=backend, **options)
        for backend in BACKENDS
    ]
    assert all(run.status is Status.FINISHED for run in runs)
    assert abs(runs[0].y - runs[1].y).max() < 1e-6
    rates = runs[0].y[2]
    assert np.count_nonzero(abs(rates) < 1e-12) > 50  # the cart sticks now and then
    assert abs(runs[0].inputs[0]).max() > 8
    assert abs(runs[0].y[1, -1]) < 0.2


@pytest.mark.parametrize("backend", BACKENDS)
def test_stiff_forces_take_long_steps_while_a_function_stays_0(backend: str) -> None:
    forces = (-sp.sign(v), -1000 * (1000 * (y - 1) + 10 * w))  # rates of 101/s and 9899/s
    held = build(System("held", "", [X, Y], [], [PointMass(1, (x, y))], sp.S.Zero, forces=forces))
    motion = integrate(held, (0, 1), (0.0,) * 4, (), method="radau", backend=backend)
    assert motion.y[:, -1] == pytest.approx((0.0, 1.0, 0.0, 0.0), abs=1e-6)
    assert motion.steps < 200  # an explicit method needs thousands
