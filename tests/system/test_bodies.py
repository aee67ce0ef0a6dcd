"""Rigid bodies in space: beside point masses, elliptic functions, and what is conserved."""

import re
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import sympy as sp
from rigid_body_motions import free_body, top_inclination
from scipy.integrate import solve_ivp

import generated.free_body
import generated.heavy_top as heavy_top
import generated.spherical_pendulum
from derive import (
    Coordinate,
    Derivation,
    Orientation,
    Parameter,
    PointMass,
    RigidBody,
    System,
    load,
    quaternion,
    rotation_matrix,
    rotations,
    velocity,
)
from derive.codegen.module_files import texts
from derive.mechanics.quasi_velocities import QuasiVelocities
from derive.mechanics.reduced_coordinates import reduced
from derive.system.parts import SystemDefinitionError
from holonomic import Status, build, ensemble, integrate, prepare
from solvers.equations.forms import Form
from solvers.equations.module import GeneratedModule
from solvers.integration.checks.singularity import SingularityWarning, singular_coordinates

w, x, y, z, a, b, c, g = sp.symbols("w x y z a b c g", real=True)
phi, theta, psi = sp.symbols("phi theta psi", real=True)
m, length, A, B, C = sp.symbols("m l A B C", positive=True)
KAPPA = [Coordinate(s, "1", "of the quaternion") for s in (w, x, y, z)]
PLACE = [Coordinate(s, "m", "of the centre of mass") for s in (a, b, c)]
ANGLES = [Coordinate(s, "rad", "Euler's angle") for s in (phi, theta, psi)]
GRAVITY = Parameter(g, "m/s^2", 9.81, "gravity")
MOMENTS = [Parameter(s, "kg m^2", v, "moment") for s, v in ((A, 1.0), (B, 2.0), (C, 2.5))]
NINE = [Coordinate(s, "1", "of the matrix") for s in sp.symbols("r1:10", real=True)]
MATRIX = rotation_matrix(sp.Matrix(3, 3, [one.symbol for one in NINE]).tolist())
NORM = w**2 + x**2 + y**2 + z**2 - 1
TOP = [Parameter(m, "kg", 1.2, "mass"), Parameter(length, "m", 0.5, "of the centre"), GRAVITY]


def free(orientation: Orientation, coordinates: list[Coordinate]) -> System:
    body = RigidBody(1, (0, 0, 0), (A, B, C), orientation)
    return System("free", "A free body", coordinates, MOMENTS, [body], potential=0)


def top(orientation: Orientation, coordinates: list[Coordinate]) -> System:
    body = RigidBody(m, orientation.turned((0, 0, length)), (A, A, C), orientation)
    return System("top", "A heavy top", coordinates, [*TOP, MOMENTS[0], MOMENTS[2]], [body])


#: Masses and places, in body axes, of points that are together a body.
POINTS = [(10, (3, 1, -2)), (5, (-4, 6, 1)), (8, (2, -5, 7)), (3, (-1, 2, 9))]
MASS = sum(mass for mass, _ in POINTS)
CENTRE = sum((mass * sp.Matrix(r) for mass, r in POINTS), sp.zeros(3, 1)) / MASS


def tensor_about(point: sp.Matrix) -> sp.Matrix:
    arms = [(mass, sp.Matrix(r) - point) for mass, r in POINTS]
    parts = (mass * (r.dot(r) * sp.eye(3) - r * r.T) for mass, r in arms)
    return sum(parts, sp.zeros(3))


def joined(*, as_points: bool, axes: Orientation, inner: list[Coordinate]) -> System:
    """A body that hangs by a ball joint from a spring, with friction; or its points."""
    origin = sp.Matrix([a, b, c])
    hook = tuple(origin + axes.matrix * sp.Matrix([1, 2, 3]))
    masses = [PointMass(mass, tuple(origin + axes.matrix * sp.Matrix(r))) for mass, r in POINTS]
    centre = tuple(origin + axes.matrix * CENTRE)
    if not as_points:
        masses = [RigidBody(MASS, centre, tensor_about(CENTRE), axes)]
    last = inner[0].symbol
    return System(
        "joined", "A body on a spring", [*PLACE, *inner], [GRAVITY], masses,
        potential=3 * hook[2] ** 2, gravity=(0, 0, -g), coincide=[(hook[:2], (0, 0))],
        dissipation=velocity(a) ** 2 / 7 + velocity(last) ** 2 / 5,
        constraints=list(axes.conditions),
    )  # fmt: skip


def derived(system: System) -> GeneratedModule:
    """Some functions of the module of a system, which takes less time than all."""
    functions = ("rhs", "energy", "constraints", "correction")
    text = texts(Derivation(system), functions)[f"{system.name}.py"]
    exec(text, vars(module := ModuleType(system.name)))
    return module  # type: ignore[return-value]


def consistent(module: GeneratedModule, seed: int) -> np.ndarray:
    """A random state that satisfies the constraints."""
    state = np.random.default_rng(seed).uniform(0.2, 0.9, len(module.STATE))
    for _ in range(60):
        state = state + module.correction(0.0, state, module.DEFAULTS)
    assert np.abs(module.constraints(0.0, state, module.DEFAULTS)).max() < 1e-14
    return state


ORIENTATIONS = {
    "zxz": rotations("zxz", (phi, theta, psi)),
    "zyxz": rotations("zyxz", (phi, 2 * theta, psi + phi, 0.3)),
    "y": rotations("y", [theta * phi]),
    "matrix": rotation_matrix(rotations("xzy", (phi, theta, psi)).rows),
    "quaternion": quaternion(w, x, y, z),
    "nine": MATRIX,
}


@pytest.mark.parametrize("name", ORIENTATIONS)
def test_the_angular_velocity_is_that_of_the_matrix(name: str) -> None:
    one = ORIENTATIONS[name]
    symbols = sorted(one.matrix.free_symbols, key=str)
    values = dict(zip(symbols, (0.3, 0.8, -0.5), strict=False))
    rates = dict(zip(symbols, (0.7, -1.1, 0.4), strict=False))
    if name == "quaternion":
        values = dict(zip((w, x, y, z), (0.2, 0.4, 0.4, 0.8), strict=True))
        rates = dict(zip((w, x, y, z), (2.0, -1.0, 2.0, -1.0), strict=True))
    if name == "nine":
        turned = ORIENTATIONS["zxz"].matrix.subs({phi: 0.3, theta: 0.8, psi: -0.5})
        spin = sp.Matrix([[0, -3, 2], [3, 0, -1], [-2, 1, 0]])
        values, rates = (
            dict(zip(MATRIX.matrix, matrix, strict=True)) for matrix in (turned, turned * spin)
        )
    R = one.matrix
    change = sum((R.diff(s) * rate for s, rate in rates.items()), sp.zeros(3))
    spin = np.array((R.T * change).subs(values), dtype=float)
    omega = sum(np.array(one.turn(s), dtype=object) * rate for s, rate in rates.items())
    omega = np.array([sp.sympify(part).subs(values) for part in omega], dtype=float)
    assert np.allclose(spin, -spin.T, atol=1e-15)
    assert np.allclose(omega, [spin[2, 1], spin[0, 2], spin[1, 0]], atol=1e-14)
    assert np.allclose(np.array((R.T * R).subs(values), dtype=float), np.eye(3), atol=1e-15)


def test_the_lagrangian_of_the_top_is_that_of_the_textbook() -> None:
    # L. D. Landau, E. M. Lifshitz, Mechanics, § 35, problem 1
    d = Derivation(top(ORIENTATIONS["zxz"], ANGLES))
    dphi, dtheta, dpsi = map(velocity, (phi, theta, psi))
    across = A + m * length**2
    expected = (
        across * (dtheta**2 + dphi**2 * sp.sin(theta) ** 2) / 2
        + C * (dpsi + dphi * sp.cos(theta)) ** 2 / 2
        - m * g * length * sp.cos(theta)
    )
    assert sp.simplify(d.lagrangian - expected) == 0
    conserved = d.momenta[0]  # the vertical component of the angular momentum
    assert sp.simplify(d.angular_momentum[2] - conserved) == 0


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(
    ("axes", "inner"),
    [(ORIENTATIONS["zxz"], ANGLES), (ORIENTATIONS["quaternion"], KAPPA), (MATRIX, NINE)],
    ids=["angles", "quaternion", "matrix"],
)
def test_a_body_moves_as_its_points(axes: Orientation, inner: list[Coordinate]) -> None:
    body, points = (
        derived(joined(as_points=as_points, axes=axes, inner=inner)) for as_points in (False, True)
    )
    for seed in range(3):
        state = consistent(body, seed)
        rates, expected = (one.rhs(0.0, state, one.DEFAULTS) for one in (body, points))
        assert np.allclose(rates, expected, rtol=1e-11, atol=1e-11)
        energies = [one.energy(0.0, state, one.DEFAULTS) for one in (body, points)]
        assert energies[0] == pytest.approx(energies[1], rel=1e-13)


MISTAKES: dict[str, tuple[object, ...]] = {
    "inertia about another point": (f"{__name__}.CENTRE", sp.zeros(3, 1)),
    "no gyroscopic forces": (QuasiVelocities, "inertial_forces", (sp.S.Zero,) * 6),
    "space for body axes": (
        "derive.codegen.forms.quaternion_form.columns",
        lambda parts: ((-x, -y, -z), (w, z, -y), (-z, w, x), (y, -x, w)),
    ),
}


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistakes_are_found_beside_the_points(
    mistake: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(*MISTAKES[mistake])
    with pytest.raises(AssertionError):
        test_a_body_moves_as_its_points(ORIENTATIONS["quaternion"], KAPPA)


@pytest.fixture(scope="module")
def by_quaternion() -> GeneratedModule:
    return generated.free_body  # type: ignore[return-value]


def test_derivatives_of_quaternions_are_derivatives(by_quaternion: GeneratedModule) -> None:
    one = by_quaternion
    state = np.random.default_rng(4).uniform(0.3, 1, 8)  # of any norm
    steps = state[:, np.newaxis] + 1e-30j * np.eye(8)
    expected = one.rhs_many(0.0, steps, one.DEFAULTS).imag / 1e-30
    assert np.allclose(one.jacobian(0.0, state, one.DEFAULTS), expected, rtol=1e-12)
    change = np.arange(1.0, 9.0)
    form = Form(one, "variational", one.DEFAULTS)
    rates = form.rhs(0.0, form.from_ordinary(0.0, np.array([*state, *change])))
    assert np.allclose(rates[-8:], expected @ change, rtol=1e-12)


def start(omega: tuple[float, ...], kappa: tuple[float, ...] = (1, 0, 0, 0)) -> np.ndarray:
    """A state by a quaternion and the angular velocity in body axes."""
    w0, x0, y0, z0 = kappa
    rows = np.array([[-x0, -y0, -z0], [w0, -z0, y0], [z0, w0, -x0], [-y0, x0, w0]])
    return np.array([*kappa, *(rows @ omega / 2)])


def angular_velocity(states: np.ndarray) -> np.ndarray:
    w0, x0, y0, z0 = states[:4]
    rows = np.array([[-x0, w0, z0, -y0], [-y0, -z0, w0, x0], [-z0, y0, -x0, w0]])
    return 2 * np.einsum("ijt,jt->it", rows, states[4:])


TIMES = np.linspace(0, 100, 401)
STRICT = {"method": "verner98", "rtol": 1e-13, "atol": 1e-13, "t_eval": TIMES}


@pytest.mark.parametrize("rates", [(0.6, 0.9), (0.9, 0.3)])
def test_a_free_body_moves_by_elliptic_functions(
    rates: tuple[float, float], by_quaternion: GeneratedModule
) -> None:
    first, third = rates
    module = by_quaternion
    motion = integrate(module, (0, 100), start((first, 0, third)), module.DEFAULTS, **STRICT)
    expected = free_body((1.0, 2.0, 2.5), rates, TIMES)
    assert np.abs(angular_velocity(motion.y) - expected).max() < 1e-11
    assert np.abs(module.constraints_many(0.0, motion.y, module.DEFAULTS)).max() < 1e-15
    momentum = module.angular_momentum_many(TIMES, motion.y, module.DEFAULTS)
    assert np.abs(momentum - momentum[:, :1]).max() < 1e-11
    energy = module.energy_many(TIMES, motion.y, module.DEFAULTS)
    assert np.abs(energy - energy[0]).max() < 1e-11
    wrong = free_body((1.0, 2.0, 2.5 + 1e-8), rates, TIMES)
    assert np.abs(wrong - expected).max() > 1e-9


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("kind", ["angles", "quaternion"])
@pytest.mark.parametrize("released", [(0.6, 0.1, 12.0), (1.0, 0.5, 8.0), (1.2, 4.0, 3.0)])
def test_a_heavy_top_nods_by_elliptic_functions(
    kind: str, released: tuple[float, float, float]
) -> None:
    inclination, precession, spin = released
    if kind == "angles":
        module = build(top(ORIENTATIONS["zxz"], ANGLES))
        state = (0.0, inclination, 0.0, precession, 0.0, spin)
    else:
        module = build(top(ORIENTATIONS["quaternion"], KAPPA))
        omega = (0.0, precession * np.sin(inclination), precession * np.cos(inclination) + spin)
        state = start(omega, (np.cos(inclination / 2), np.sin(inclination / 2), 0.0, 0.0))
    motion = integrate(module, (0, 100), state, module.DEFAULTS, **STRICT)
    across = 1.0 + 1.2 * 0.5**2
    expected = top_inclination((across, 2.5), 1.2 * 9.81 * 0.5, released, TIMES)
    heights = module.positions_many(TIMES, motion.y, module.DEFAULTS)[0, 2] / 0.5
    assert np.abs(heights - expected).max() < 1e-10
    assert np.ptp(expected) > 0.002
    vertical = module.angular_momentum_many(TIMES, motion.y, module.DEFAULTS)[2]
    assert np.abs(vertical - vertical[0]).max() < 1e-11
    energy = module.energy_many(TIMES, motion.y, module.DEFAULTS)
    assert np.abs(energy - energy[0]).max() < 1e-10


@pytest.mark.long("more cases of the same kind", keep=3)
@pytest.mark.parametrize("backend", ["python", "compiled"])
@pytest.mark.parametrize("method", ["rk4", "dop853", "gauss2", "radau3", "LSODA"])
def test_methods_keep_the_norm(method: str, backend: str, by_quaternion: GeneratedModule) -> None:
    module = by_quaternion
    if method == "LSODA" and backend == "compiled":
        return  # a method of SciPy
    options = {"h": 0.02} if method in ("rk4", "gauss2", "radau3") else {"rtol": 1e-9}
    chosen = {} if method == "LSODA" else {"backend": backend}
    motion = integrate(
        module, (0, 2), start((0.6, 0.1, 0.9)), {}, method=method, **options, **chosen
    )
    assert np.abs(module.constraints_many(0.0, motion.y, module.DEFAULTS)).max() < 1e-15


def test_lanes_keep_the_norm(by_quaternion: GeneratedModule) -> None:
    rates = np.linspace(0.3, 0.9, 9)
    starts = np.transpose([start((0.6, 0.0, rate)) for rate in rates])
    batch = ensemble(by_quaternion, (0, 20), starts, {}, rtol=1e-11, atol=1e-11, t_eval=[20.0])
    for k, rate in enumerate(rates):
        expected = free_body((1.0, 2.0, 2.5), (0.6, rate), np.array([20.0]))
        assert np.abs(angular_velocity(batch.samples[:, k]) - expected).max() < 1e-8


def test_equations_are_nearly_as_short_as_euler_s(by_quaternion: GeneratedModule) -> None:
    # by hand: E κ̇ 21, |h|² 5, ḣ from h × J h 6, Eᵀ ḣ - |h|² κ 28; and constants of the moments
    total, constant = by_quaternion.OPERATIONS["rhs"]
    assert total - constant <= 70
    assert "rational" not in by_quaternion.FORMS  # nothing calls sine or cosine
    assert {*by_quaternion.CALLS_FUNCTIONS} <= {"points"}  # sides of the box in pictures
    mass = QuasiVelocities(Derivation(top(ORIENTATIONS["quaternion"], KAPPA))).mass_matrix
    assert mass == 4 * sp.diag(A + m * length**2, A + m * length**2, C)


def test_gimbal_lock_is_refused_with_a_way_out() -> None:
    module = build(top(ORIENTATIONS["zxz"], ANGLES))
    with pytest.raises(ValueError, match=r"gimbal lock\), give the orientation by a quaternion"):
        integrate(module, (0, 1), (0.0, 0.0, 0.0, 1.0, 0.0, 5.0), {})
    module = build(top(ORIENTATIONS["quaternion"], KAPPA))
    sleeping = integrate(module, (0, 10), start((0.0, 0.0, 30.0)), {}, rtol=1e-10, atol=1e-10)
    assert np.abs(sleeping.y[1:3]).max() < 1e-12  # a fast top stays upright


#: A top that falls past its upright state, where the axes of precession and spin coincide.
FALLING = (0.3, 0.0, 1.0, 1e-12, 0.0, -8.0)
LIMITED = {"max_steps": 2000}  # most of them near this state
LOCK = r"gimbal lock at theta = \S+e-\d\d rad, t = 0\.1457\d* s: there phi and psi turn a body "


@pytest.mark.parametrize("backend", ["compiled", "python"])
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_gimbal_lock_on_the_way_is_named_with_a_way_out(backend: str) -> None:
    options = {**LIMITED, "backend": backend}
    motion = integrate(heavy_top, (0, 5), FALLING, {}, **options)
    assert not motion.success
    assert re.search(LOCK, motion.message)
    assert re.search(LOCK, str(motion))
    assert "give the orientation by a quaternion" in motion.message
    free = integrate(heavy_top, (0, 5), (*FALLING[:3], 3.0, 0.0, -8.0), {}, **options)
    assert free.success


# phi and psi by themselves are not predictable behind it, but their sum is
@pytest.mark.filterwarnings(
    "ignore::solvers.integration.checks.predictability.PredictabilityWarning"
)
def test_a_motion_passes_closely_by_gimbal_lock() -> None:
    motion = integrate(heavy_top, (0, 5), (*FALLING[:3], 1e-9, 0.0, -8.0), {}, energy=True)
    assert motion.success
    assert abs(motion.energy[-1] - motion.energy[0]) < 1e-8
    phi, psi = motion.y[:2, -1]  # each passage turns them by pi, in opposite directions
    assert np.exp(1j * (phi + psi)) == pytest.approx(np.exp(0.3j), abs=1e-3)


def test_gimbal_lock_on_the_way_of_many_motions_is_named() -> None:
    starts = np.transpose([FALLING, (0, 0, 1.0, 2.0, 0, 0), FALLING])
    with pytest.warns(SingularityWarning, match="2 of 3 motions failed; of motion 0: " + LOCK):
        ensemble(heavy_top, (0, 5), starts, {}, **LIMITED)
    run = prepare(heavy_top, {}, **LIMITED)
    with pytest.raises(ArithmeticError, match=LOCK):
        run((0, 5), FALLING)


@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_a_failure_for_another_reason_is_no_gimbal_lock() -> None:
    options = {"method": "verner98", "rtol": 1e-9, "max_steps": 3, "backend": "python"}
    motion = integrate(heavy_top, (0, 5), (0, 0, 1.0, 2.0, 0, 0), {}, **options)
    assert motion.status is Status.STEP_LIMIT
    assert "lock" not in motion.message
    other = singular_coordinates(
        generated.spherical_pendulum, (1.0, 1.0, 9.81), (0, (1, 0, 0, 0)), (1, (1e-6, 0, 0, 0))
    )
    assert other.startswith("coordinates are singular at theta = 1e-06 rad, t = 1 s: there changes")
    assert "of phi move no mass" in other


def test_a_tensor_has_the_energy_of_its_principal_moments() -> None:
    turned = rotations("xz", (0.4, 1.1))
    turned = np.array(turned.matrix, dtype=float)
    tensor = turned @ np.diag([1.0, 2.0, 2.5]) @ turned.T
    tensor = (tensor + tensor.T) / 2
    body = RigidBody(1, (0, 0, 0), tensor.tolist(), ORIENTATIONS["zxz"])
    system = System("body", "A body", ANGLES, [], [body], potential=0)
    matrix = Derivation(system).mass_matrix.subs({phi: 0.3, theta: 0.8, psi: -0.5})
    W = np.array([ORIENTATIONS["zxz"].turn(s) for s in (phi, theta, psi)])
    W = np.array(sp.Matrix(W).subs({phi: 0.3, theta: 0.8, psi: -0.5}), dtype=float)
    assert np.allclose(np.array(matrix, dtype=float), W @ tensor @ W.T, rtol=1e-12)


def test_invalid_bodies_are_refused() -> None:
    axes, place = ORIENTATIONS["zxz"], (a, b, c)
    for inertia, words in (
        ((1, 1), "has 2: give three principal moments"),
        ((1, 1, 3), "moment of inertia 3 is larger than the sum of both others"),
        ((1, -1, 1), "moment of inertia -1 is negative"),
        (A, "is not a sequence"),
        ([(1, 0, 0), (1, 1, 0), (0, 0, 1)], "is not symmetric"),
        ([(1, 0), (0, 1)], "is no tensor"),
        ([(1, 2, 0), (2, 1, 0), (0, 0, 1)], "a principal moment that is negative or larger"),
        ([(1, 0.99, 0), (0.99, 1, 0), (0, 0, 1)], "1.0]] has a principal moment"),
        ("abc", "is not a sequence"),
    ):
        with pytest.raises(SystemDefinitionError, match=words):
            RigidBody(m, place, inertia, axes)
    with pytest.raises(SystemDefinitionError, match="in space: give three"):
        RigidBody(m, (a, b), (A, A, C), axes)
    with pytest.raises(
        SystemDefinitionError, match=r"in the plane: give two .* or the orientation"
    ):
        RigidBody(m, place, A, theta)
    for wrong, words in (
        (lambda: rotations("abc", (phi, theta, psi)), "is no sequence of rotations"),
        (lambda: rotations("zxz", (phi, theta)), "has 3 axes"),
        (lambda: rotations("zxz", "abc"), "is not a sequence"),
        (lambda: quaternion(w, x, y, y), "is not four coordinates"),
        (lambda: quaternion(1, x, y, z), "is not four coordinates"),  # type: ignore[arg-type]
        (lambda: rotation_matrix([(1, 0), (0, 1)]), "three rows of three formulas"),
        (lambda: axes.turned((0, 1)), "give three in body axes"),
    ):
        with pytest.raises(SystemDefinitionError, match=words):
            wrong()
    unknown = quaternion(*sp.symbols("w x y q", real=True))
    with pytest.raises(SystemDefinitionError, match="orientation of body 1 contains unknown sym"):
        free(unknown, KAPPA)


ROD = [Parameter(m, "kg", 1.2, "mass"), Parameter(A, "kg m^2", 0.7, "across the rod"),
       Parameter(g, "m/s^2", 9.81, "gravity")]  # fmt: skip


def rod(inertia: tuple[object, ...], constraints: list[sp.Expr]) -> System:
    """A thin rod on a ball joint, a metre above its centre of mass."""
    axes = ORIENTATIONS["quaternion"]
    body = RigidBody(m, axes.turned((0, 0, -1)), inertia, axes)
    return System("rod", "A thin rod", KAPPA, ROD, [body], constraints=constraints)


SPIN = w * velocity(z) - z * velocity(w) + y * velocity(x) - x * velocity(y)  # about the rod


@pytest.mark.long("compiles loops of a body in space")
def test_a_rod_that_cannot_spin_moves_as_a_spherical_pendulum() -> None:
    module, pendulum = build(rod((A, A, 0), [SPIN])), generated.spherical_pendulum
    strict = STRICT | {"t_eval": [0.0, 1.0, 2.0, 3.0]}
    motion = integrate(module, (0, 3), start((1.0, 2.0, 0.0), (0.8, 0.6, 0, 0)), {}, **strict)
    # oracle: equal moments m l² + A and weights, from the angle from below and the rates there
    length = 1 + 0.7 / 1.2
    params = pendulum.params(m=1.0, l=length, g=9.81)
    centre = module.positions_many(motion.t, motion.y, module.DEFAULTS)[0]
    theta, azimuth = np.arccos(-centre[2, 0]), np.arctan2(centre[1, 0], centre[0, 0])
    by_angles = (theta, azimuth, 1.0, 2.0 / np.sin(theta))
    other = integrate(pendulum, (0, 3), by_angles, params, **strict)
    expected = pendulum.positions_many(other.t, other.y, params)[0] / length
    assert np.abs(centre - expected).max() < 1e-11
    assert np.abs(module.constraints_many(0.0, motion.y, module.DEFAULTS)).max() < 1e-14


@pytest.mark.parametrize("inertia", [(A, A, 0), (0, 0, 0)])
def test_rotations_without_inertia_are_refused_with_a_way_out(inertia: tuple[object, ...]) -> None:
    words = r"rotations of body m with .*0.* move no mass; give positive .* rotations\('xy'"
    with pytest.raises(SystemDefinitionError, match=words):
        Derivation(rod(inertia, []))


def test_a_copy_of_a_system_has_each_norm_once() -> None:
    system = free(ORIENTATIONS["quaternion"], KAPPA)
    assert replace(system) == system
    assert [one.name for one in system.conditions] == ["rigid_1"]


def test_conditions_of_a_matrix_that_cannot_be_decided_remain() -> None:
    stretch = sp.sqrt(x) - sp.exp(y)
    assert rotation_matrix([(1, 0, 0), (0, stretch, 0), (0, 0, 1)]).conditions == (
        (stretch**2 - 1) / 2,
    )


@pytest.mark.long("the same bodies in the other order", keep=1)
@pytest.mark.parametrize("is_first", [True, False])
@pytest.mark.filterwarnings("ignore:constraints of system 'satellite'")
def test_a_reaction_wheel_turns_about_an_axis_of_a_body(is_first: bool) -> None:
    axes = quaternion(w, x, y, z)
    turned = rotation_matrix((axes.matrix * rotations("z", [phi]).matrix).tolist())
    bodies = [
        RigidBody(3, (0, 0, 0), (A, B, C), axes),
        RigidBody(1, (0, 0, 0), (1, 1, 1.5), turned),
    ]
    system = System("satellite", "", [*KAPPA, ANGLES[0]], MOMENTS,
        bodies[:: -1 if is_first else 1], potential=0)  # fmt: skip
    assert Derivation(system).degrees_of_freedom == 4
    module, rates, wheel = build(system), np.array([0.7, -1.1, 0.9]), 5.0
    start = (1, 0, 0, 0, 0.3, 0, *rates / 2, wheel)
    motion = integrate(module, (0, 3), start, {}, rtol=1e-11, atol=1e-11)
    for function in (module.angular_momentum_many, module.energy_many):
        values = np.atleast_2d(function(motion.t, motion.y, module.DEFAULTS))
        assert abs(values - values[:, :1]).max() < 1e-10 * abs(values).max()
    # Euler's equations of both bodies as one, whose wheel keeps its momentum about its axis
    own, across = 1.5 * (wheel + rates[2]), np.array([2.0, 3.0, 2.5])

    def euler(t: float, state: np.ndarray) -> list[float]:
        omega, real, vector = state[:3], state[3], state[4:7]
        torque = -np.cross(omega, across * omega + [0, 0, own])
        turn = (real * omega + np.cross(vector, omega)) / 2
        return [*torque / across, -vector @ omega / 2, *turn, own / 1.5 - omega[2]]

    expected = solve_ivp(euler, (0, 3), [*rates, *start[:5]], "DOP853", rtol=1e-12, atol=1e-12)
    assert motion.y[:5, -1] == pytest.approx(expected.y[3:, -1], abs=1e-9)


@pytest.mark.parametrize("norm", [NORM, 3 * NORM, sp.sqrt(NORM + 1) - 1])
@pytest.mark.filterwarnings("ignore:constraints of system 'normed'")
def test_a_quaternion_may_have_its_norm_as_a_constraint(norm: sp.Expr) -> None:
    system = free(quaternion(w, x, y, z), KAPPA)
    start = (1, 0, 0, 0, 0, 0.3, 0.2, -0.1)
    given = derived(replace(system, name="normed", constraints=[norm]))
    rates = [one.rhs(0.0, start, one.DEFAULTS) for one in (given, derived(system))]
    assert rates[0] == pytest.approx(rates[1], abs=1e-15)


def test_a_positive_component_of_a_quaternion_may_follow_from_the_others() -> None:
    positive = sp.symbols("w", positive=True)
    coordinates = [Coordinate(positive, "1", "of the quaternion"), *KAPPA[1:]]
    system = reduced(free(quaternion(positive, x, y, z), coordinates))
    assert system.q == (x, y, z)
    assert not system.conditions
    module, other = derived(system), derived(free(ORIENTATIONS["quaternion"], KAPPA))
    state = consistent(other, 3)
    rates = other.rhs(0.0, state, other.DEFAULTS)
    short = module.rhs(0.0, state[[1, 2, 3, 5, 6, 7]], module.DEFAULTS)
    assert np.allclose(short, np.array(rates)[[1, 2, 3, 5, 6, 7]], rtol=1e-12)


GYRO = """
[coordinates]
phi = {}
theta = {}
psi = {}
[parameters]
m = { value = 1.2, unit = "kg" }
l = { value = 0.5, unit = "m" }
g = { value = 9.81, unit = "m/s^2" }
A = { value = 1, unit = "kg m^2", positive = true }
C = { value = 2.5, unit = "kg m^2", positive = true }
[[masses]]
mass = "m"
position = ["l*sin(theta)*sin(phi)", "-l*sin(theta)*cos(phi)", "l*cos(theta)"]
inertia = ["A", "A", "C"]
orientation = { rotations = "zxz", angles = ["phi", "theta", "psi"] }
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "gyro.toml"
    path.write_text(text)
    return path


def test_a_file_may_have_bodies_in_space(tmp_path: Path) -> None:
    system = load(str(written(tmp_path, GYRO)))
    assert Derivation(system).lagrangian == Derivation(top(ORIENTATIONS["zxz"], ANGLES)).lagrangian
    text = GYRO.replace("psi = {}", 'psi = {}\nw = { unit = "1" }')
    text = text.replace('rotations = "zxz", angles = [', 'quaternion = ["w", ')
    assert load(str(written(tmp_path, text))).masses[0].orientation == quaternion(
        w, phi, theta, psi
    )
    rows = '[["cos(phi)", "-sin(phi)", 0], ["sin(phi)", "cos(phi)", 0], [0, 0, 1]]'
    text = GYRO.replace('rotations = "zxz", angles = ["phi", "theta", "psi"]', f"matrix = {rows}")
    text = text.replace('["A", "A", "C"]', '[["A", 0, 0], [0, "A", 0.1], [0, 0.1, "C"]]')
    body = load(str(written(tmp_path, text))).masses[0]
    assert body.orientation.rows == rotations("z", [phi]).rows
    assert body.tensor == sp.Matrix([[A, 0, 0], [0, A, 0.1], [0, 0.1, C]]).xreplace(
        {sp.Float(0.1): sp.Rational(1, 10)}
    )


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('rotations = "zxz", ', "", "give rotations = "),
        ('rotations = "zxz"', 'rotation = "zxz"', "unknown key 'rotation' in orientation of mas"),
        ('"zxz"', '"zxq"', "is no sequence of rotations"),
        ('inertia = ["A", "A", "C"]', 'inertia = "A"', "must be a list"),
        ('inertia = ["A", "A", "C"]', "", "must be a list"),
        ('["A", "A", "C"]', '["A", "A", "theta"]', "inertia of body m depends on theta"),
        ('orientation = {', 'angle = "phi"\norientation = {', "an angle and an orientation"),
        ("orientation =", "# ", "three moments of inertia but no orientation"),
        ('rotations = "zxz", angles', "quaternion", "has 3 components: give four"),
    ],
)  # fmt: skip
def test_invalid_bodies_of_files_are_refused(
    old: str, new: str, words: str, tmp_path: Path
) -> None:
    assert old in GYRO
    with pytest.raises(SystemDefinitionError, match=words):
        load(str(written(tmp_path, GYRO.replace(old, new))))
