"""Forces that a motion needs, and base parameters, against textbooks and Lagrange's equations."""

import ctypes
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import sympy as sp
import trees
from numpy.testing import assert_allclose, assert_array_equal

import generated.furuta_pendulum as furuta
import generated.two_link_arm as arm
from derive import (
    Coordinate,
    Derivation,
    Input,
    Parameter,
    PointMass,
    System,
    load,
    names,
    reduced,
    velocity,
)
from derive.formulas.residues import Evaluation, NoRootError, RandomResidues, ResidueSeries, echelon
from derive.formulas.zero import vanishes
from derive.system.symbols import TIME
from solvers import build, integrate

Array = np.ndarray
#: State, accelerations and parameters.
Case = tuple[list[float], list[float], list[float]]


def states(
    module: ModuleType, count: int
) -> Iterator[tuple[list[float], list[float], list[float]]]:
    """Random states, accelerations and parameters, with inputs that are not 0."""
    rng, n = np.random.default_rng(3), len(module.COORDINATES)
    for _ in range(count):
        y, qddot = rng.uniform(-3, 3, 2 * n).tolist(), rng.uniform(-3, 3, n).tolist()
        yield y, qddot, rng.uniform(0.3, 2, len(module.PARAMETERS)).tolist()


def planar_elbow(y: Sequence[float], params: Sequence[float]) -> tuple[Array, Array, Array]:
    """M, C and g of M. W. Spong, S. Hutchinson, M. Vidyasagar, Robot Modeling and Control (2006).

    Section 7.4, planar elbow manipulator; lc1 and lc2 are the distances of the centres of mass. The
    acrobot of M. W. Spong, IEEE Control Systems 15 (1995) 49-55, has the same and no first torque.
    """
    (q1, q2, v1, v2), (l1, _, lc1, lc2, m1, m2, I1, I2, g) = y, params[:9]
    d11 = m1 * lc1**2 + m2 * (l1**2 + lc2**2 + 2 * l1 * lc2 * np.cos(q2)) + I1 + I2
    d12 = m2 * (lc2**2 + l1 * lc2 * np.cos(q2)) + I2
    d22 = m2 * lc2**2 + I2
    h = -m2 * l1 * lc2 * np.sin(q2)
    phi2 = m2 * lc2 * g * np.cos(q1 + q2)
    phi1 = (m1 * lc1 + m2 * l1) * g * np.cos(q1) + phi2
    C = np.array([[h * v2, h * v2 + h * v1], [-h * v1, 0]])
    return np.array([[d11, d12], [d12, d22]]), C, np.array([phi1, phi2])


def acrobot() -> ModuleType:
    """The arm without a motor in its first joint."""
    system = load("two_link_arm")
    motor = [Input(sp.Symbol("tau2", real=True), "N m", "motor of the elbow")]
    return build(replace(system, name="acrobot", inputs=motor, forces=[0, motor[0].symbol]))


@pytest.mark.parametrize("module", [arm, acrobot()], ids=["arm", "acrobot"])
def test_terms_are_those_of_the_textbook(module: ModuleType) -> None:
    for y, qddot, params in states(module, 20):
        M, C, g = planar_elbow(y, params)
        assert_allclose(module.mass_matrix(0, y, params), M, rtol=1e-13)
        assert_allclose(module.coriolis(0, y, params), C @ y[2:], rtol=1e-12)
        assert_allclose(module.gravity(0, y, params), g, rtol=1e-12, atol=1e-13)
        torques = M @ qddot + C @ y[2:] + g
        assert_allclose(module.inverse_dynamics(0, y, qddot, params), torques, rtol=1e-11)


def test_the_regressor_of_the_arm_is_that_of_the_textbook() -> None:
    for y, qddot, params in states(arm, 20):
        (q1, q2, v1, v2), (a1, a2), (l1, _, lc1, lc2, m1, m2, I1, I2, g) = y, qddot, params[:9]
        wave = np.cos(q2) * (2 * a1 + a2) - np.sin(q2) * (v2**2 + 2 * v1 * v2)
        turn, other = np.cos(q1 + q2), np.cos(q2) * a1 + np.sin(q2) * v1**2
        # Spong's parameters 1 and 3 are inertias about the first and the second joint
        theta = [m1 * lc1**2 + m2 * (l1**2 + lc2**2) + I1 + I2, m2 * l1 * lc2, m2 * lc2**2 + I2]
        theta += [m1 * lc1 + m2 * l1, m2 * lc2]
        # a1 Θ1 + a2 Θ3 = a1 (Θ1 - Θ3) + (a1 + a2) Θ3
        base = [theta[0] - theta[2], theta[2], g * theta[3], g * theta[4], theta[1]]
        assert_allclose(arm.base_parameters(params), base, rtol=1e-12)
        Y = [[a1, a1 + a2, np.cos(q1), turn, wave], [0, a1 + a2, 0, turn, other]]
        assert_allclose(arm.regressor(0, y, qddot, params), Y, rtol=1e-12)


def lagrange(derivation: Derivation) -> list[sp.Expr]:
    """d/dt ∂L/∂q̇ - ∂L/∂q - Q, straight from L, with inputs 0."""
    system, L = derivation.system, derivation.lagrangian
    residuals = []
    for q, v, applied in zip(system.q, system.qdot, system.applied, strict=True):
        p = L.diff(v)
        rate = sum(p.diff(x) * dx for x, dx in zip(system.q, system.qdot, strict=True))
        rate += sum(p.diff(x) * dx for x, dx in zip(system.qdot, system.qddot, strict=True))
        residuals.append(rate + p.diff(TIME) - L.diff(q) - applied)
    return [residual.subs(dict.fromkeys(system.u, 0)) for residual in residuals]


@pytest.mark.long("more cases of the same kind", keep=6, daily=13)
@pytest.mark.parametrize(
    "system", [*map(load, names()), load("chain_7"), trees.closed],
    ids=lambda system: system.name,
)  # fmt: skip
def test_forces_are_those_of_lagrange_s_equations(system: System) -> None:
    module, name, derivation = build(system), system.name, Derivation(reduced(system))
    system = derivation.system
    symbols = (TIME, *system.q, *system.qdot, *system.qddot, *system.params)
    exact = sp.lambdify(symbols, lagrange(derivation), "mpmath")
    potential = [derivation.potential_energy.diff(q) for q in system.q]
    exact_gravity = sp.lambdify(symbols, potential, "mpmath")
    applied = [one.subs(dict.fromkeys(system.u, 0)) for one in system.applied]
    exact_applied = sp.lambdify(symbols, applied, "mpmath")
    for y, qddot, params in states(module, 5):
        if name == "slider_crank":  # the rod is longer than the crank
            params[:2] = 0.1, 0.5
        if name == "foucault_pendulum":  # positions on a sphere
            params[1] = 6.0
        values = (0.3, *y, *qddot, *params)
        forces = module.inverse_dynamics(0.3, y, qddot, params)
        size = 1 + abs(np.array(forces)).max()
        close = {"rtol": 0, "atol": 1e-11 * size}
        assert_allclose(forces, [float(x) for x in exact(*values)], **close)
        gravity, coriolis = (getattr(module, k)(0.3, y, params) for k in ("gravity", "coriolis"))
        assert_allclose(gravity, [float(x) for x in exact_gravity(*values)], **close)
        inertia = np.array(module.mass_matrix(0.3, y, params)) @ qddot
        others = [float(x) for x in exact_applied(*values)]
        assert_allclose(inertia + coriolis + gravity - others, forces, **close)
        if module.PARAMETERS and not system.conditions:
            Y, base = module.regressor(0.3, y, qddot, params), module.base_parameters(params)
            assert_allclose(np.array(Y) @ base, forces, **close)


def test_forces_of_a_motion_are_its_inputs() -> None:
    for module, inputs in ((arm, {"tau1": 2.0, "tau2": -0.5}), (furuta, {"tau": 0.7})):
        params = module.params(**inputs)
        expected = [*inputs.values(), 0.0][:2]
        for y, _, _ in states(module, 5):
            qddot = module.rhs(0, y, params)[2:]
            forces = module.inverse_dynamics(0, y, qddot, params)
            assert_allclose(forces, expected, atol=1e-13)


def test_prescribed_motions_are_no_inputs_that_are_0() -> None:
    theta, s, x = sp.symbols("theta s x", real=True)
    m, length, c = sp.symbols("m l c", positive=True)
    pivoted = System(
        "pivoted", "A pendulum on a moving pivot", [Coordinate(theta, "rad", "angle")],
        [Parameter(m, "kg", 2.0, "mass"), Parameter(length, "m", 0.5, "length"),
         Parameter(c, "N m s", 0.1, "friction")],
        [PointMass(m, (s + length * sp.sin(theta), -length * sp.cos(theta)))], gravity=(0, 0),
        dissipation=c * velocity(theta) ** 2 / 2, forces=[x],
        inputs=[Input(s, "m", "pivot", motion=True), Input(x, "N m", "torque")],
    )  # fmt: skip
    module = build(pivoted)
    params = module.params(s_ddot=3.0, x=7.0)
    expected = 2 * 0.5**2 * 1.5 + 2 * 0.5 * np.cos(0.4) * 3.0 + 0.1 * 0.2
    assert module.inverse_dynamics(0, (0.4, 0.2), (1.5,), params) == pytest.approx((expected,))
    Y, base = module.regressor(0, (0.4, 0.2), (1.5,), params), module.base_parameters(params)
    assert np.array(Y) @ base == pytest.approx((expected,))


def test_forces_of_motions_with_constraints_include_those_of_these() -> None:
    disc = import_module("generated.rolling_disc")
    built = build(load("rolling_disc"))
    y = (0.1, 0.2, 0.3, 0.4, 0.5, 0.0, 0.0, 0.1, -0.2, 2.0)
    G = np.array(disc.constraints_jacobian(0, y, disc.DEFAULTS))[:, 5:]
    qddot = disc.rhs(0, y, disc.DEFAULTS)[5:]
    forces = built.inverse_dynamics(0, y, qddot, disc.DEFAULTS)
    reactions = G.T @ disc.multipliers(0, y, disc.DEFAULTS)
    assert_allclose(forces, reactions, atol=1e-12)
    assert abs(reactions).max() > 0.1
    assert "what inputs and constraints have to produce" in built.inverse_dynamics.__doc__


def test_arrays_and_c_give_what_single_states_give(tmp_path: Path) -> None:
    cases = [*states(arm, 6)]
    y, qddot, params = (np.array(part).T for part in zip(*cases, strict=True))
    many = arm.inverse_dynamics_many(0.0, y, qddot, params)
    single = np.array([arm.inverse_dynamics(0.0, *case) for case in cases])
    assert_array_equal(many, single.T)
    assert arm.regressor_many(0.0, y, qddot, params).shape == (2, 5, 6)
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("needs a C compiler")
    header = Path(arm.__file__).with_suffix(".h")
    (tmp_path / "arm.c").write_text(
        f'#include "{header}"\n'
        "void call(const double *y, const double *a, const double *p, double *r);\n"
        "void call(const double *y, const double *a, const double *p, double *r)\n"
        "{ two_link_arm_inverse_dynamics(0, y, a, p, r); }\n"
    )
    library = tmp_path / "arm.so"
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-ffp-contract=off", "-shared", "-fPIC"]
    subprocess.run([compiler, *flags, "-o", library, tmp_path / "arm.c", "-lm"], check=True)
    call, result = ctypes.CDLL(str(library)).call, np.empty(2)
    for case, expected in zip(cases, single, strict=True):
        arrays = [np.array(part) for part in case]
        call(*(ctypes.c_void_p(part.ctypes.data) for part in (*arrays, result)))
        assert_array_equal(result, expected)


def rank(rows_at: list[sp.Matrix], symbols: Sequence[sp.Symbol]) -> int:
    """Rank of matrices at random points, below each other, modulo a prime."""
    rows = []
    for seed, matrix in enumerate(rows_at):
        for attempt in range(200):
            point = RandomResidues(1000 * seed + attempt)
            known = {s: ResidueSeries(np.array([[point.residue(s)]], np.int64)) for s in symbols}
            evaluation = Evaluation(known, point)
            try:
                values = [int(evaluation(entry).rows[0, 0]) for entry in matrix]
            except NoRootError:
                continue
            rows += np.reshape(values, matrix.shape).tolist()
            break
    return len(echelon(rows))


@pytest.mark.parametrize("name", names())
def test_base_parameters_are_exact_and_as_few_as_possible(name: str) -> None:
    derivation = Derivation(reduced(load(name)))
    system, result = derivation.system, derivation.regressor
    forces = derivation.mass_matrix * sp.Matrix(system.qddot) - derivation.forcing
    differences = (result.matrix * result.parameters - forces).subs(dict.fromkeys(system.u, 0))
    assert all(map(vanishes, differences))
    count = len(result.parameters)
    moving = (TIME, *system.q, *system.qdot, *system.qddot)
    known = sorted(result.matrix.free_symbols - {*moving}, key=str)
    assert not {*known} & result.parameters.free_symbols
    # parameters in Y have the same values at all points
    fixed = {s: sp.Rational(k + 3, k + 2) for k, s in enumerate(known)}
    assert rank([result.matrix.subs(fixed)] * (count + 2), moving) == count
    others = sorted(result.parameters.free_symbols, key=str)
    assert rank([result.parameters.T] * (count + 2), others or moving) == count


def test_a_measured_motion_gives_the_base_parameters() -> None:
    truth = arm.params(m2=1.3, c2=0.2)
    t = np.linspace(0, 4, 400)
    motion = integrate(
        arm, (0, 4), {"q1": 0.0, "q2": 0.5}, truth, rtol=1e-11, atol=1e-11, t_eval=t,
        inputs=lambda t, y: (20 + 5 * np.sin(3 * t) - 4 * y[2], 4 * np.cos(2 * t) - y[3]),
    )  # fmt: skip
    qddot = arm.rhs_many(t, motion.y, [*truth[:9], *motion.inputs])[2:]
    Y = arm.regressor_many(t, motion.y, qddot, arm.DEFAULTS)
    rows, torques = np.moveaxis(Y, 1, 2).reshape(-1, 5), motion.inputs.ravel()
    base = np.linalg.lstsq(rows, torques)[0]
    assert_allclose(base, arm.base_parameters(truth), rtol=1e-6)
    assert abs(base / arm.base_parameters(arm.DEFAULTS) - 1).max() > 0.1
