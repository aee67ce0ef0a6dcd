"""Perturbations of motions with constraints: tangent to these, and those of fewest coordinates."""

from collections.abc import Callable

import numpy as np
import pytest
import sympy as sp
from constrained_systems import START, lifted, pinned, swing, two_rods

import generated.double_pendulum as dp
import generated.four_bar as four_bar
import generated.rolling_disc as rolling_disc
import generated.single_pendulum as pendulum
from derive import Coordinate, Parameter, RigidBody, System, quaternion
from holonomic import build, integrate, prepare
from solvers import Event, lyapunov_spectrum, sensitivities, transition_matrix
from solvers.equations.forms import Form
from solvers.equations.module import GeneratedModule
from solvers.equations.projection import projected, tangent_change

SAME = {"l": 0.8, "g": 9.81}
#: Largest residual of a perturbation of size 1 on the constraints.
TANGENT = 1e-14


def hinged() -> System:
    """A body with a quaternion that slides and turns together."""
    w, i, j, k, x, g = sp.symbols("w i j k x g", real=True)
    m, A, B, C, r = sp.symbols("m A B C r", positive=True)
    axes = quaternion(w, i, j, k)
    return System(
        "hinged",
        "Body that slides and turns",
        [Coordinate(q, "1", "of the quaternion") for q in (w, i, j, k)]
        + [Coordinate(x, "m", "of the slider")],
        [Parameter(s, "kg", 0.5 + 0.2 * n, "inertia") for n, s in enumerate((m, A, B, C))]
        + [Parameter(r, "m", 0.4, "lever"), Parameter(g, "m/s^2", 9.81, "gravity")],
        [RigidBody(m, (x, 0, 0), (A, B, C), axes)],
        constraints=[axes.turned((x, 0, r))[1] - r * sp.sin(x) / 3],
    )


@pytest.fixture(scope="module")
def rod() -> GeneratedModule:
    return build(swing())


@pytest.fixture(scope="module")
def rods() -> GeneratedModule:
    return build(two_rods())


def on_constraints(module: GeneratedModule, t: float, seed: int) -> np.ndarray:
    """A state of an arbitrary motion."""
    form = Form(module, "lagrangian", module.DEFAULTS)
    y = np.random.default_rng(seed).uniform(0.3, 0.9, len(module.STATE))
    for _ in range(8):
        y = projected(form, t, y)
    return y


SYSTEMS: list[Callable[[], System]] = [swing, pinned, lifted, two_rods, hinged]


@pytest.mark.parametrize("make", SYSTEMS)
def test_a_step_onto_constraints_squares_residuals(make: Callable[[], System]) -> None:
    module, t = build(make()), 0.4
    y, rng = on_constraints(module, t, 1), np.random.default_rng(2)
    change, after = rng.normal(size=len(y)), []
    for size in (1e-3, 1e-4):
        z = y + size * change
        z = z + module.correction(t, z, module.DEFAULTS)
        after.append(np.abs(module.constraints(t, z, module.DEFAULTS)))
    count = len(module.RESIDUALS) // 2
    for part in (slice(0, count), slice(count, None)):  # of coordinates and of velocities
        assert after[0][part].max() < 3e-4
        assert after[1][part].max() < 2e-2 * after[0][part].max()


@pytest.mark.parametrize("module", [four_bar, rolling_disc])
def test_sines_and_cosines_are_moved_onto_constraints_as_angles_are(
    module: GeneratedModule,
) -> None:
    y = on_constraints(module, 0.0, 3)
    changes = 1e-6 * np.random.default_rng(4).normal(size=(3, len(y)))
    angles, sines = (Form(module, name, module.DEFAULTS) for name in ("lagrangian", "rational"))
    for one in changes:
        moved = projected(angles, 0.0, y + one)
        expected = sines.from_ordinary(0.0, moved)
        assert np.abs(moved - y - one).max() > 1e-8
        # of steps of 1e-6 both agree to their squares
        found = projected(sines, 0.0, sines.from_ordinary(0.0, y + one))
        assert np.abs(found - expected).max() < 1e-11


@pytest.mark.parametrize("name", ["variational", "sensitivity"])
@pytest.mark.parametrize("make", SYSTEMS)
def test_perturbations_are_projected_by_the_derivative(
    make: Callable[[], System], name: str
) -> None:
    # oracle: differences of projections of states, from which residuals are removed to rounding
    module, t, h = build(make()), 0.4, 1e-5
    y, rng = on_constraints(module, t, 3), np.random.default_rng(4)
    params, change = np.array(module.DEFAULTS), rng.normal(size=len(y))
    moved = rng.normal(size=len(params)) * (name == "sensitivity")
    ends = []
    for sign in (h, -h):
        form, z = Form(module, "lagrangian", (params + sign * moved).tolist()), y + sign * change
        ends.append(projected(form, t, z))
    form = Form(module, name, (*moved[: len(params) * (name == "sensitivity")], *params))
    rows = np.array([[*y, *change]])
    tangent = change + tangent_change(form, t, rows)[0]
    assert np.allclose(tangent, (ends[0] - ends[1]) / (2 * h), rtol=1e-6, atol=2e-8)


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("backend", ["python", "compiled"])
@pytest.mark.parametrize("method", ["verner853", "gauss4"])
def test_perturbations_stay_tangent(method: str, backend: str, rods: GeneratedModule) -> None:
    start = on_constraints(rods, 0.0, 5)
    y0 = dict(zip(rods.STATE, start.tolist(), strict=True)) | {"delta_x1": 1.0}
    motion = integrate(rods, (0, 3), y0, {}, method=method, form="variational", rtol=1e-6,
        atol=1e-6, backend=backend, t_eval=np.linspace(0, 3, 7))  # fmt: skip
    for t, column in zip(motion.t, motion.y.T, strict=True):
        y, change = np.split(column, 2)
        slopes = np.array(rods.constraints_jacobian(t, y, rods.DEFAULTS))
        assert np.abs(slopes @ change).max() < TANGENT * (1 + np.abs(change).max()) * 20
        assert np.abs(rods.constraints(t, y, rods.DEFAULTS)).max() < TANGENT


@pytest.mark.long("other tests reach its code")
def test_sensitivities_are_those_by_the_angle(rod: GeneratedModule) -> None:
    times, lowest = np.linspace(0, 50, 6)[1:], Event(pendulum, "theta", 0.0)
    by_angle = sensitivities(pendulum, (0, 50), (1.0, 0.0), SAME, ["l", "g", "theta"],
        t_eval=times, events=lowest)  # fmt: skip
    found = sensitivities(rod, (0, 50), START, rod.DEFAULTS, ["l", "g"], t_eval=times,
        events=Event(rod, "x", 0.0))  # fmt: skip
    theta, by = by_angle.samples[0], by_angle.sample_derivatives[0]
    radial, tangential = np.array([[np.sin(theta), -np.cos(theta)], [np.cos(theta), np.sin(theta)]])
    for k, stretch in enumerate((1.0, 0.0)):  # of the rod, and of gravity
        expected = stretch * radial + 0.8 * tangential * by[k]
        assert np.abs(expected).max() > 3
        assert np.allclose(found.sample_derivatives[:2, k], expected, rtol=1e-9, atol=1e-9)
    of_events = by_angle.t_event_derivatives[0][:2]
    assert np.allclose(found.t_event_derivatives[0], of_events, rtol=1e-9, atol=1e-10)


def test_components_that_follow_change_with_those_that_are_given(rod: GeneratedModule) -> None:
    # oracle: differences of starts that are completed
    start = {"x": 0.4, "y_dot": 0.3}
    end = sensitivities(rod, (0, 1), start, {"l": 0.8})
    assert end.by == ("x", "y_dot", "m", "l", "g")
    for k, name in enumerate(end.by):
        ends, h = [], 1e-4
        for sign in (h, -h):
            y0 = start | {name: start[name] + sign} if name in start else start
            value = dict(zip(rod.PARAMETERS, rod.DEFAULTS, strict=True)).get(name, 0.0)
            params = {"l": 0.8} if name in start else {"l": 0.8, name: value + sign}
            motion = integrate(rod, (0, 1), y0, params, rtol=1e-13, atol=1e-13)
            ends.append(motion.y[:, -1])
        assert np.allclose(end.derivatives[:, k], (ends[0] - ends[1]) / (2 * h), atol=1e-6)
    with pytest.raises(ValueError, match="by has 'y', which follows from the constraints and x"):
        sensitivities(rod, (0, 1), start, {}, ["y"])


def cartesian(y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The state of two rods by that of the double pendulum, and its derivatives."""
    q = sp.symbols("q:4", real=True)
    l1, l2 = dp.DEFAULTS[2:4]
    places = [l1 * sp.sin(q[0]), -l1 * sp.cos(q[0])]
    places += [places[0] + l2 * sp.sin(q[1]), places[1] - l2 * sp.cos(q[1])]
    rates = [sum(sp.diff(p, q[k]) * q[2 + k] for k in range(2)) for p in places]
    state = sp.Matrix([*places, *rates])
    value, slopes = (sp.lambdify([q], part, "numpy") for part in (state, state.jacobian(q)))
    return value(y).ravel(), slopes(y)


@pytest.mark.long("other tests reach its code")
def test_transition_matrices_are_those_of_the_angles(rods: GeneratedModule) -> None:
    angles = np.array([2.0, 2.5, 0.0, 0.0])
    start, before = cartesian(angles)
    by_angle = transition_matrix(dp, (0, 6), angles, {})
    end, after = cartesian(by_angle.y)
    found = transition_matrix(rods, (0, 6), start, {})
    expected = after @ by_angle.matrix
    assert np.linalg.norm(expected, 2) > 1e3
    assert np.abs(found.y - end).max() < 1e-9
    assert np.abs(found.matrix @ before - expected).max() < 1e-8 * np.abs(expected).max()


def test_exponents_are_those_of_the_angles(rods: GeneratedModule) -> None:
    angles = np.array([2.0, 2.5, 0.0, 0.0])
    expected = lyapunov_spectrum(dp, angles, {}, duration=400)
    found = lyapunov_spectrum(rods, cartesian(angles)[0], {}, duration=400)
    assert found.exponents.shape == (4,)
    assert abs(found.exponents.sum()) < 1e-6  # no friction
    allowed = 3 * (expected.errors + found.errors)
    assert (np.abs(found.exponents - expected.exponents) < allowed).all()


@pytest.mark.parametrize(
    ("given", "change"),
    [
        ({"delta_x": 1.0}, (1.0, np.tan(1.0))),
        ({"delta_y": 1.0}, (1 / np.tan(1.0), 1.0)),
        ({"delta_x": 1.0, "delta_y": 0.0}, (np.cos(1.0) ** 2, np.sin(1.0) * np.cos(1.0))),
    ],
)
def test_perturbations_that_are_not_given_follow_from_the_others(
    given: dict[str, float], change: tuple[float, float], rod: GeneratedModule
) -> None:
    # at an angle of 1 rad the mass moves along (cos 1, sin 1)
    start = dict(zip(rod.STATE, START, strict=True))
    motion = integrate(rod, (0, 0), start | given, rod.DEFAULTS, form="variational")
    assert motion.y[4:6, 0] == pytest.approx(change, abs=1e-12)


def test_a_prepared_function_makes_perturbations_tangent(rod: GeneratedModule) -> None:
    run = prepare(rod, rod.DEFAULTS, form="variational")
    tangent = (np.cos(1.0) ** 2, np.sin(1.0) * np.cos(1.0))
    ends = [run((0, 0.1), (*START, *change, 0.0, 0.0)) for change in ((1.0, 0.0), tangent)]
    assert ends[0] == pytest.approx(ends[1], abs=1e-12)
