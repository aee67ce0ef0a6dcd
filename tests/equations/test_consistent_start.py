"""Consistent starts: closed forms of linkages, both branches, velocities, refusals."""

from math import asin, atan2, cos, pi, sin, sqrt

import numpy as np
import pytest
import sympy as sp

import generated.four_bar as four_bars
import generated.rolling_disc as disc
from derive import TIME, Coordinate, Parameter, PointMass, RigidBody, System
from holonomic import build, consistent_start, ensemble, integrate, prepare
from solvers.equations.assembly import EXACT, Assembly, tangent_start
from solvers.equations.forms import Form
from solvers.equations.module import GeneratedModule
from solvers.equations.singularities import SingularConfigurationWarning
from solvers.sweeps.definition.axes import Grid
from solvers.sweeps.definition.sweep import Sweep
from solvers.sweeps.execution.initial_states import initial_states
from solvers.sweeps.maps.final import Final

q1, q2, q3, x, y = sp.symbols("q1 q2 q3 x y", real=True)
a, b, c, d, m, length = sp.symbols("a b c d m l", positive=True)
MASS = Parameter(m, "kg", 1.0, "mass")
A, B, C, D = 0.3, 0.8, 0.6, 0.9


def at(size: sp.Expr, angle: sp.Expr) -> sp.Matrix:
    return size * sp.Matrix([sp.cos(angle), sp.sin(angle)])


@pytest.fixture(scope="module")
def four_bar() -> GeneratedModule:
    lengths = [Parameter(s, "m", v, str(s)) for s, v in ((a, A), (b, B), (c, C), (d, D))]
    coupler, rocker = at(a, q1) + at(b, q2), sp.Matrix([d, 0]) + at(c, q3)
    rod = RigidBody(m, tuple(at(a, q1) + at(b, q2) / 2), m * b**2 / 12, q2)
    masses = [rod, PointMass(m, tuple(rocker))]
    q = [Coordinate(s, "rad", str(s)) for s in (q1, q2, q3)]
    return build(System("four_bar", "Four-bar linkage", q, [*lengths, MASS], masses, potential=0,
        coincide=[(tuple(coupler), tuple(rocker))]))  # fmt: skip


@pytest.fixture(scope="module")
def crank() -> GeneratedModule:
    lengths = [Parameter(s, "m", v, str(s)) for s, v in ((a, 0.1), (b, 0.3))]
    pin = at(a, q1) + at(b, q2)
    q = [Coordinate(s, "m" if s == x else "rad", str(s)) for s in (q1, q2, x)]
    return build(System("crank", "Slider-crank", q,
        [*lengths, MASS], [PointMass(m, (x, 0)), PointMass(m, tuple(at(a, q1)))], potential=0,
        coincide=[(tuple(pin), (x, 0))], keep_coordinates=True))  # fmt: skip


@pytest.fixture(scope="module")
def lifted() -> GeneratedModule:
    plane = [Coordinate(x, "m", "x"), Coordinate(y, "m", "y")]
    return build(System("lifted", "A thread that becomes longer", plane,
        [MASS, Parameter(length, "m", 0.8, "length")], [PointMass(m, (x, y))], potential=0,
        constraints=[x**2 + y**2 - (length + TIME / 10) ** 2]))  # fmt: skip


def freudenstein(angle: float, sign: int) -> tuple[float, float]:
    """Angles of coupler and rocker; J. J. Uicker et al., Theory of Machines and Mechanisms."""
    k1, k2, k3 = D / A, D / C, (A**2 - B**2 + C**2 + D**2) / (2 * A * C)
    p = cos(angle) - k1 - k2 * cos(angle) + k3
    q, r = -2 * sin(angle), k1 - (k2 + 1) * cos(angle) + k3
    rocker = 2 * atan2(-q + sign * sqrt(q * q - 4 * p * r), 2 * p)
    end = D + C * cos(rocker) - A * cos(angle), C * sin(rocker) - A * sin(angle)
    return atan2(end[1], end[0]), rocker


def angle_error(found: float, expected: float) -> float:
    return abs(2 * sin((found - expected) / 2))


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("angle", [0.3, 1.0, 2.5, -2.0])
def test_four_bar_linkages_have_freudenstein_s_angles_in_both_branches(
    angle: float, sign: int, four_bar: GeneratedModule
) -> None:
    coupler, rocker = freudenstein(angle, sign)
    guess = {"q2": coupler + 0.2, "q3": rocker - 0.3}
    start = consistent_start(four_bar, {"q1": angle, "q1_dot": 2.0}, {}, guess=guess)
    assert (start.y[0], start.y[3]) == (angle, 2.0)
    assert angle_error(start.y[1], coupler) < 1e-13
    assert angle_error(start.y[2], rocker) < 1e-13
    rates = [
        (np.unwrap([low, high])[1] - low) / 1e-6 * 2.0
        for low, high in zip(
            freudenstein(angle - 5e-7, sign), freudenstein(angle + 5e-7, sign), strict=True
        )
    ]
    assert start.y[4:] == pytest.approx(rates, abs=1e-7)
    # the other branch, and no third
    (other,) = start.others
    expected = freudenstein(angle, -sign)
    assert max(map(angle_error, other[1:], expected)) < 1e-9
    assert consistent_start(
        four_bar, {"q1": angle}, {}, guess=dict(zip(("q2", "q3"), other[1:], strict=True))
    ).y[2] == pytest.approx(other[2], abs=1e-12)
    assert "from the constraints: q2 = " in repr(start)
    assert "another solution, for guesses near it: q2 = " in repr(start)


def test_two_positions_of_the_crank_near_a_dead_centre_are_distinct() -> None:
    rocker = consistent_start(four_bars, {"phi": 0.5}, {}).y[2]
    start = consistent_start(four_bars, {"chi": rocker}, {}, guess={"phi": 0.5})
    (other,) = start.others
    guess = dict(zip(("psi", "chi"), other[1:], strict=True))
    near = consistent_start(four_bars, {"phi": other[0]}, {}, guess=guess)
    assert near.y[:3] == pytest.approx(other, abs=1e-9)
    assert 0.1 < abs(other[0] - start.y[0]) < 0.2


def test_slider_cranks_have_the_closed_form(crank: GeneratedModule) -> None:
    for angle in np.linspace(-3, 3, 7):
        rod = asin(-sin(angle) / 3)
        rate = -cos(angle) / 3 / cos(rod)
        expected = [angle, rod, 0.1 * cos(angle) + 0.3 * cos(rod), 1.0, rate,
            -0.1 * sin(angle) - 0.3 * sin(rod) * rate]  # fmt: skip
        right = consistent_start(crank, {"q1": angle, "q1_dot": 1.0}, {})
        assert right.y == pytest.approx(expected, abs=1e-14)
        left = consistent_start(crank, {"q1": angle}, {}, guess={"q2": 3.0, "x": -0.2})
        assert angle_error(left.y[1], pi - rod) < 1e-14
        assert left.y[2] == pytest.approx(0.1 * cos(angle) - 0.3 * cos(rod), abs=1e-14)
        (other,) = right.others
        assert angle_error(other[1], left.y[1]) < 1e-9
        assert other[2] == pytest.approx(left.y[2], abs=1e-9)
    # the slider given, at a guess where the rods are aligned
    start = consistent_start(crank, {"x": 0.35}, {})
    cosine = (0.1**2 + 0.35**2 - 0.3**2) / (2 * 0.1 * 0.35)
    assert abs(cos(start.y[0]) - cosine) < 1e-13


def test_constraints_that_move_give_velocities(lifted: GeneratedModule) -> None:
    start = consistent_start(lifted, {"x": 0.3}, {}, 2.0, guess={"y": -1.0})
    down = -sqrt(1.0 - 0.09)
    # x xdot + y ydot = (l + t/10)/10; least kinetic energy is along the thread
    assert start.y == pytest.approx([0.3, down, 0.03, 0.1 * down], abs=1e-15)
    given = {"x": 0.3, "y": down, "x_dot": 0.03}
    motion = integrate(lifted, (2, 2.5), given, {}, t_eval=[2.0, 2.5], backend="python")
    assert motion.y[:, 0] == pytest.approx(start.y, abs=1e-15)
    with pytest.raises(ValueError, match=r"lambda_1_dot = 1\.6 instead of 0"):
        integrate(lifted, (0, 1), (0.8, 0.0, 1.1, 0.0), {})


def test_velocities_without_constraints_remain() -> None:
    # energy couples spin and precession of the disc, whose slips contain the spin alone
    given = {"phi": 0.3, "chi_dot": 6.0}
    start = dict(zip(disc.STATE, consistent_start(disc, given, {}).y.tolist(), strict=True))
    assert start["psi_dot"] == start["phi_dot"] == 0.0
    assert start["x_dot"] == pytest.approx(0.3 * 6.0, abs=1e-14)
    guess = {"psi_dot": 0.2}
    assert consistent_start(disc, given, {}, guess=guess).y[disc.STATE.index("psi_dot")] == 0.2


@pytest.mark.long("other tests reach its code")
def test_many_starts_are_those_of_each(crank: GeneratedModule) -> None:
    angles = np.linspace(-3, 3, 5)
    batch = ensemble(crank, (0, 0.01), {"q1": angles, "q1_dot": 3.0}, {}, backend="python")
    run = prepare(crank, {})
    for k, angle in enumerate(angles):
        start = consistent_start(crank, {"q1": angle, "q1_dot": 3.0}, {})
        assert batch.y[:, k] == pytest.approx(run((0, 0.01), tuple(start.y)), abs=1e-12)
        by_name = run((0, 0.01), {"q1": angle, "q1_dot": 3.0})
        assert by_name == pytest.approx(batch.y[:, k], abs=1e-12)
    with pytest.raises(ValueError, match=r"no state of motion 2 with x = 0.5 m .* pin_1_x = -0.1 "):
        ensemble(crank, (0, 1), {"x": [0.3, 0.35, 0.5]}, {})
    with pytest.raises(ValueError, match=r"pin_1_x = .* instead of 0"):
        run((0, 1), (1.0, 0.0, 0.0, 1.0, 0.0, 0.0))


def test_a_prepared_function_checks_starts_as_others_do(crank: GeneratedModule) -> None:
    start = consistent_start(crank, {"q1": 0.8, "q1_dot": 3.0}, {}).y
    assembly, rng, seen = Assembly(crank, np.array([crank.DEFAULTS])), np.random.default_rng(2), []
    for size in np.logspace(-18, -11, 60):
        y = start + size * rng.uniform(-1, 1, len(start))
        ratio = assembly.relative(y[np.newaxis]).max() / EXACT
        if not 0.5 < ratio < 2.0:  # both sum in another order
            seen.append(assembly.is_exact(y.tolist()))
            assert seen[-1] == (ratio <= 1)
            assert seen[-1] == assembly.is_exact([*y[:3], *-y[3:]])  # the reverse motion
    assert {*seen} == {True, False}
    assert not assembly.is_exact([np.nan, *start[1:]])


def test_rounded_decimals_are_mended_and_larger_residuals_refused(crank: GeneratedModule) -> None:
    start = consistent_start(crank, {"q1": 1.0, "q1_dot": 1.0}, {}).y
    exact = integrate(crank, (0, 1), start, {}, t_eval=[0, 1], backend="python")
    assert np.array_equal(exact.y[:, 0], start)
    rounded = integrate(crank, (0, 1), np.round(start, 7), {}, t_eval=[0, 1], backend="python")
    residuals = crank.constraints(0.0, rounded.y[:, 0], crank.DEFAULTS)
    assert np.abs(residuals).max() < 1e-15 < np.abs(
        crank.constraints(0.0, np.round(start, 7), crank.DEFAULTS)).max()  # fmt: skip
    assert rounded.y[:, 1] == pytest.approx(exact.y[:, 1], abs=1e-5)
    for k in range(6):
        wrong = start + 1e-4 * np.eye(6)[k]
        with pytest.raises(
            ValueError, match=r"the state does not satisfy .* pin_1_\w+ = .* instead of 0"
        ):
            integrate(crank, (0, 1), wrong, {})


@pytest.mark.parametrize(("y0", "options", "message"), [
    ({"x": 0.5}, {}, "with x = 0.5 m .*1 degree of freedom: the nearest has pin_1_x = -0.1 inst"),
    ({"q1": 1.0, "q1_dot": 1.0, "x_dot": 3.0}, {}, "x_dot = 3 m/s .*pin_1_x_dot = .* instead of 0"),
    ({"q1": 1.0, "x": 0.3}, {}, "q1 = 1 rad, x = 0.3 m .* instead of 0; give fewer"),
    ((1.0, 0.0, 0.0, 0.0, 0.0, 0.0), {}, r"or take solvers.consistent_start\(module, \{\}"),
    ({"p1": 1.0}, {}, "y0 has no 'p1'; known names: q1, q2, x"),
    ({"q1": "a"}, {}, "q1: unit 'a' is not known: use m, cm"),
    ({"q1": np.nan}, {}, "q1 = nan"),
    ({"q1": [1.0, 2.0]}, {}, "y0 has shape"),
    ((1.0, 2.0), {}, "y0 has shape"),
    ({"q1": 1.0}, {"guess": {"p2": 1.0}}, "guess has no 'p2'; known names: q1"),
    ({"q1": 1.0}, {"guess": (1.0, 2.0)}, "guess has shape"),
    ({"q1": 1.0}, {"t": np.inf}, "t = inf"),
])  # fmt: skip
def test_invalid_starts_are_refused(
    y0: object, options: dict[str, object], message: str, crank: GeneratedModule
) -> None:
    with pytest.raises(ValueError, match=message):
        consistent_start(crank, y0, {}, **options)  # type: ignore[arg-type]


def test_systems_without_constraints_have_no_inconsistent_starts() -> None:
    import generated.single_pendulum as single

    with pytest.raises(ValueError, match="single_pendulum has no constraints"):
        consistent_start(single, {"theta": 1.0}, {})


def test_toggle_points_are_refused_and_their_neighbours_reported(four_bar: GeneratedModule) -> None:
    rhombus = {"a": 0.5, "b": 0.5, "c": 0.5, "d": 0.5}
    aligned = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    with pytest.raises(ValueError, match=r"condition inf .* at a toggle point.*; start elsewhere"):
        integrate(four_bar, (0, 1), aligned, rhombus, backend="python")
    near = (1e-7, 0.0, 1e-7, 0.0, 0.0, 0.0)
    with pytest.warns(SingularConfigurationWarning, match=r"condition \de\+1[34]"):
        integrate(four_bar, (0, 1e-3), near, rhombus, backend="python")
    regular = (1.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    integrate(four_bar, (0, 1e-3), regular, rhombus, backend="python")


@pytest.mark.parametrize("mistake", ["a wrong branch", "velocities at rest", "one step only"])
def test_mistakes_in_the_assembly_are_noticed(
    mistake: str, monkeypatch: pytest.MonkeyPatch, four_bar: GeneratedModule
) -> None:
    if mistake == "a wrong branch":
        closed = Assembly.closed
        turn = np.array([0.0, 2.0, 3.0])
        monkeypatch.setattr(Assembly, "closed", lambda self, q, f: closed(self, q + turn * f, f))
    if mistake == "velocities at rest":
        monkeypatch.setattr(Assembly, "_velocity_changes", lambda self, y, free: 0 * y[:, self.n :])
    if mistake == "one step only":
        monkeypatch.setattr("solvers.equations.assembly.STEPS", 1)
    with pytest.raises((AssertionError, ValueError)):
        test_four_bar_linkages_have_freudenstein_s_angles_in_both_branches(1.0, 1, four_bar)


def test_perturbations_of_completed_starts_are_their_derivatives() -> None:
    # of the given rolling; no constraint contains the rate of the heading, which remains 0
    given, size, h = {"phi": 0.3, "psi": 0.2, "phi_dot": 0.4}, len(disc.STATE), 1e-5

    def start(rolling: float) -> np.ndarray:
        return np.array(consistent_start(disc, given | {"chi_dot": rolling}, disc.DEFAULTS).y)

    rate = disc.STATE.index("chi_dot")
    row = np.concatenate([start(2.0), np.eye(size)[rate]])
    flags = np.array([name in given or name == "chi_dot" for name in disc.STATE])
    form = Form(disc, "variational", disc.DEFAULTS)
    (changed,) = tangent_start(form, 0.0, row[np.newaxis], flags)
    differences = (start(2.0 + h) - start(2.0 - h)) / (2 * h)
    assert changed[size:] == pytest.approx(differences, abs=1e-9)


def test_sweeps_complete_states_at_their_first_time(lifted: GeneratedModule) -> None:
    places = np.array([0.0, 0.48])
    axes = Grid({"x": places})
    definition = Sweep(lifted, axes, {"end": Final(("y",))}, 1.0, {"x_dot": 0.0})
    states, _, status = initial_states(definition, {"x": places})
    assert not status.any()
    lengths = np.hypot(states[:, 0], states[:, 1])
    assert lengths == pytest.approx([0.8, 0.8], rel=1e-13)  # that of the thread at t = 0


def test_many_starts_are_those_at_the_initial_time(lifted: GeneratedModule) -> None:
    # the length at 2 s is 0.8 m + 0.2 m, and grows by 0.1 m/s
    places = np.array([0.1, 0.6])
    batch = ensemble(lifted, (2.0, 2.0), {"x": places, "x_dot": 0.0}, {}, backend="python")
    angles = np.arctan2(batch.y[1], batch.y[0])
    assert np.hypot(*batch.y[:2]) == pytest.approx(1.0, abs=1e-14)
    radial = batch.y[2] * np.cos(angles) + batch.y[3] * np.sin(angles)
    assert radial == pytest.approx(0.1, abs=1e-14)
