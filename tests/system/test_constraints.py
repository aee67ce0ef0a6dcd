"""Systems with constraints: multipliers, and projection."""

from collections.abc import Callable
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from constrained_systems import (
    GRAVITY,
    KG,
    PLANE,
    ROD,
    START,
    g,
    length,
    lifted,
    m,
    phi,
    pinned,
    swing,
    x,
    y,
)

from derive import (
    TIME,
    Constraint,
    Derivation,
    PointMass,
    System,
    velocity,
    write,
)
from derive.codegen.forms.lagrangian_form import LagrangianForm
from derive.system.parts import SystemDefinitionError
from holonomic import build, ensemble, integrate
from solvers.equations.forms import Form
from solvers.equations.module import GeneratedModule
from solvers.references.elliptic import pendulum
from solvers.runge_kutta.method_catalogue import SCIPY


@pytest.fixture(scope="module")
def module() -> GeneratedModule:
    return build(swing())


def exact(times: np.ndarray) -> np.ndarray:
    """Cartesian states of the swing, in elliptic functions."""
    angle, rate = pendulum(0.8, 9.81, (1.0, 0.0), times).T
    s, c = np.sin(angle), np.cos(angle)
    return 0.8 * np.array([s, -c, c * rate, s * rate])


def test_the_multiplier_is_that_of_the_textbook() -> None:
    d, (vx, vy) = Derivation(swing()), map(velocity, (x, y))
    rod = sp.Symbol("rod", real=True)
    ax, ay = swing().qddot
    assert list(d.euler_lagrange) == [m * ax - 2 * rod * x, m * ay + m * g - 2 * rod * y]
    tension = m * (g * y - vx**2 - vy**2) / (2 * (x**2 + y**2))
    assert sp.simplify(d.multipliers[0] - tension) == 0
    assert sp.simplify(d.accelerations[0] - 2 * tension * x / m) == 0


def test_motions_satisfy_newton_s_second_law_with_the_reactions() -> None:
    # oracle: forces on the mass are its weight and those of the pin; the rod is in equilibrium
    pin, rng = build(pinned()), np.random.default_rng(2)
    for _ in range(5):
        angle, rate = rng.uniform(-3, 3, 2)
        s, c = np.sin(angle), np.cos(angle)
        state = [0.8 * s, -0.8 * c, angle, 0.8 * c * rate, 0.8 * s * rate, rate]
        *_, ax, ay, alpha = pin.rhs(0.0, state, pin.DEFAULTS)
        fx, fy = pin.multipliers(0.0, state, pin.DEFAULTS)
        assert np.allclose([1.5 * ax, 1.5 * ay + 1.5 * 9.81], [fx, fy], rtol=1e-12, atol=1e-12)
        assert abs(c * fx + s * fy) < 1e-12 * np.hypot(fx, fy)  # the rod has no inertia
        assert alpha == pytest.approx(-9.81 / 0.8 * s, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("make", [swing, pinned, lifted])
def test_accelerations_keep_the_constraints(make: Callable[[], System]) -> None:
    # oracle: differences of the constraints themselves along the motion of the right-hand side
    one, rng = build(make()), np.random.default_rng(3)
    n, h = len(one.COORDINATES), 1e-4
    for _ in range(3):
        q, v, t = rng.uniform(0.3, 1, n), rng.normal(size=n), 0.7
        a = np.array(one.rhs(t, (*q, *v), one.DEFAULTS)[n:])
        values = []
        for s in (-h, 0, h):
            path = q + v * s + a * s * s / 2
            values.append(np.array(one.constraints(t + s, (*path, *v), one.DEFAULTS)))
        count = len(one.MULTIPLIERS)
        second = (values[0] - 2 * values[1] + values[2])[:count] / h**2
        first = (values[2] - values[0])[:count] / (2 * h)
        assert np.abs(second).max() < 1e-6
        assert np.allclose(first, values[1][count:], atol=1e-6)  # rates of the coordinates' ones


@pytest.mark.parametrize("make", [swing, pinned, lifted])
def test_jacobians_are_derivatives(make: Callable[[], System]) -> None:
    one = build(make())
    z = np.random.default_rng(4).uniform(0.3, 1, len(one.STATE))
    steps = 1e-6 * np.eye(len(z))
    rows = [
        (np.array(one.rhs(0.3, z + dz, one.DEFAULTS)) - one.rhs(0.3, z - dz, one.DEFAULTS)) / 2e-6
        for dz in steps
    ]
    assert np.allclose(one.jacobian(0.3, z, one.DEFAULTS), np.transpose(rows), atol=1e-6)
    change = np.random.default_rng(5).normal(size=len(z))
    form = Form(one, "variational", one.DEFAULTS)
    perturbed = form.rhs(0.3, form.from_ordinary(0.3, np.array([*z, *change])))[-len(z) :]
    assert np.allclose(perturbed, np.transpose(rows) @ change, atol=1e-5)


@pytest.mark.parametrize("degree", [0, 1])
def test_the_right_side_of_constraints_is_that_of_their_derivatives(degree: int) -> None:
    # oracle: decimal differences of the constraints themselves along a motion at constant speed
    slip = velocity(y) * sp.cos(x + TIME) - velocity(x) * TIME * y - y * sp.sin(TIME)
    formula = [x * y * sp.cos(TIME) - x**2 * TIME - y**3, slip][degree]
    one = System("one", "One", PLANE, [KG], [PointMass(m, (x, y))], potential=0,
        constraints=[formula])  # fmt: skip
    (gamma,) = Derivation(one).constraint_forcing
    at = dict(zip((x, y, velocity(x), velocity(y), TIME), (0.7, -0.4, 1.3, 0.8, 0.5), strict=True))

    def along(s: mp.mpf) -> mp.mpf:
        p, r, t = 0.7 + 1.3 * s, -0.4 + 0.8 * s, 0.5 + s
        if degree == 0:
            return p * r * mp.cos(t) - p**2 * t - r**3
        return 0.8 * mp.cos(p + t) - 1.3 * t * r - r * mp.sin(t)

    with mp.workdps(30):
        expected = -float(mp.diff(along, 0, 2 - degree))
    assert float(gamma.subs(at)) == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("method", SCIPY)
def test_methods_of_scipy_keep_the_constraints(method: str, module: GeneratedModule) -> None:
    times = np.linspace(0, 2, 9)
    motion = integrate(module, (0, 2), START, module.DEFAULTS, method=method, t_eval=times,
        rtol=1e-8, atol=1e-8)  # fmt: skip
    assert np.abs(module.constraints_many(0.0, motion.y, module.DEFAULTS)).max() < 2e-15
    assert np.abs(motion.y - exact(times)).max() < 1e-4


def test_lanes_keep_the_constraints(module: GeneratedModule) -> None:
    angles = np.linspace(0.2, 2.5, 9)
    starts = 0.8 * np.array([np.sin(angles), -np.cos(angles), 0 * angles, 0 * angles])
    batch = ensemble(module, (0, 3), starts, module.DEFAULTS, rtol=1e-10, atol=1e-10,
        t_eval=[1.0, 3.0])  # fmt: skip
    for i, angle in enumerate(angles):
        theta, _ = pendulum(0.8, 9.81, (angle, 0.0), np.array([0.0, 1.0, 3.0])).T
        expected = 0.8 * np.array([np.sin(theta), -np.cos(theta)])[:, 1:]
        assert np.abs(batch.samples[:2, i] - expected).max() < 1e-7
    residuals = module.constraints_many(0.0, batch.samples, module.DEFAULTS)
    assert np.abs(residuals).max() < 1e-14


def test_a_moving_constraint_does_work() -> None:
    one = build(lifted())
    start = (0.0, -0.8, 1.0, -0.1)
    motion = integrate(one, (0, 2), start, one.DEFAULTS, rtol=1e-12, atol=1e-12, energy=True,
        t_eval=np.linspace(0, 2, 401))  # fmt: skip
    power = one.power_many(motion.t, motion.y, one.DEFAULTS)
    gained = np.array([np.trapezoid(power[: n + 1], motion.t[: n + 1]) for n in range(401)])
    assert np.abs(motion.energy - motion.energy[0] - gained).max() < 1e-4
    assert np.ptp(motion.energy) > 0.5
    lengths = np.hypot(*motion.y[:2])
    assert np.abs(lengths - (0.8 + motion.t / 10)).max() < 4e-16


@pytest.mark.parametrize("mistake", ["none", "sign of G", "no rate of G"])
def test_mistakes_break_the_constraint(
    mistake: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    jacobian = LagrangianForm._constraint_jacobian.func  # type: ignore[attr-defined]
    if mistake == "sign of G":
        wrong = property(lambda form: [[-row[0], *row[1:]] for row in jacobian(form)])
        monkeypatch.setattr(LagrangianForm, "_constraint_jacobian", wrong)
    if mistake == "no rate of G":
        nothing = property(lambda form: [form._graph.node(0)])
        monkeypatch.setattr(LagrangianForm, "_constraint_forcing", nothing)
    write(swing(), tmp_path)
    namespace: dict[str, object] = {}
    exec((tmp_path / "swing.py").read_text(), namespace)
    *_, ax, ay = namespace["rhs"](0.0, (0.48, -0.64, 2.0, 1.5), (1.5, 0.8, 9.81))  # type: ignore[operator]
    second = 2 * (0.48 * ax - 0.64 * ay + 2.0**2 + 1.5**2)
    assert (abs(second) < 1e-12) == (mistake == "none")


def test_invalid_constraints_are_refused() -> None:
    def system(**changes: object) -> System:
        return System("s", "S", PLANE, [KG, ROD, GRAVITY], [PointMass(m, (x, y))], **changes)

    for changes, message in (
        ({"constraints": [length]}, "depends on no coordinate"),
        ({"constraints": [velocity(x) ** 2 - 1]}, "not affine in the velocities"),
        ({"constraints": [x - phi]}, "unknown symbols: phi"),
        ({"constraints": "x"}, "is not a sequence"),
        ({"coincide": [((x, y),)]}, "pairs of points"),
        ({"coincide": [((x, y), (0,))]}, "pairs of points"),
        ({"constraints": [x], "reactions": [length]}, "reactions and constraints"),
        ({"constraints": [Constraint(x - y, "x")]}, "uses a name twice: x"),
    ):
        with pytest.raises(SystemDefinitionError, match=message):
            system(**changes)
