"""State-space matrices in symbols and numbers, against closed forms, and what they are used for."""

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import sympy as sp
from cart_pole import cart_pole
from numpy.testing import assert_allclose
from scipy.linalg import solve_continuous_are

from derive import (
    Coordinate,
    Derivation,
    Input,
    Parameter,
    RigidBody,
    System,
    load,
    velocity,
)
from derive.system.parts import SystemDefinitionError
from solvers import Held, build, integrate, linearise
from solvers import load as module_of
from solvers.equations.linearisation import linear_system

cart = build(cart_pole)


def test_a_rigid_pole_on_a_cart_has_the_published_matrices() -> None:
    """University of Michigan, Control Tutorials, Inverted Pendulum: its angle has another sign."""
    x, theta, F = sp.symbols("x theta F", real=True)
    M, m, length, inertia = sp.symbols("M m l J", positive=True)
    b, g = sp.symbols("b g", real=True)
    names = ((M, "kg"), (m, "kg"), (length, "m"), (inertia, "kg m^2"), (b, "N s/m"))
    system = System(
        name="inverted_pendulum",
        title="Inverted pendulum",
        coordinates=[Coordinate(x, "m", "cart"), Coordinate(theta, "rad", "pole")],
        parameters=[
            *(Parameter(symbol, unit, 1.0, "") for symbol, unit in names),
            Parameter(g, "m/s^2", 9.8, ""),
        ],
        masses=[
            RigidBody(M, (x, 0), 0, 0),
            RigidBody(m, (x - length * sp.sin(theta), length * sp.cos(theta)), inertia, theta),
        ],
        dissipation=b * velocity(x) ** 2 / 2,
        forces=(F, 0),
        inputs=[Input(F, "N", "force")],
    )
    space = Derivation(system).state_space(outputs=["x", theta])
    p = inertia * (M + m) + M * m * length**2
    expected = sp.Matrix([
        [0, 0, 1, 0],
        [0, 0, 0, 1],
        [0, m**2 * g * length**2 / p, -(inertia + m * length**2) * b / p, 0],
        [0, m * g * length * (M + m) / p, -m * length * b / p, 0],
    ])  # fmt: skip
    assert (space.A - expected).applyfunc(sp.simplify).is_zero_matrix
    by_force = sp.Matrix([0, 0, (inertia + m * length**2) / p, m * length / p])
    assert (space.B - by_force).applyfunc(sp.simplify).is_zero_matrix
    assert sp.Matrix([[1, 0, 0, 0], [0, 1, 0, 0]]) == space.C
    assert space.D.is_zero_matrix
    assert space.rate.is_zero_matrix


@pytest.mark.parametrize("name", ["cart_pole", "double_pendulum", "swinging_atwood"])
def test_symbols_and_numbers_agree_at_any_point(name: str) -> None:
    system = cart_pole if name == "cart_pole" else load(name)
    module = cart if name == "cart_pole" else module_of(name)
    values = (0.7, 0.4, -0.3, 1.1, 0.6, -0.2)
    names = [*module.STATE, *(u.name for u in system.u)]
    point = dict(zip(names, values, strict=False))
    outputs = [f"{q}**2 + {q}_dot" for q in module.COORDINATES]
    space = Derivation(system).state_space(point, outputs)
    inputs = {u.name: point[u.name] for u in system.u} or None
    params = {"m": 0.9} if "m" in module.PARAMETERS else {}
    sizes = (matrix.shape for matrix in (space.A, space.B, space.C, space.D))
    pairs = zip(space.numbers(params), sizes, strict=True)
    numbers = [np.array(matrix).reshape(shape) for matrix, shape in pairs]
    state = {q: point[q] for q in module.STATE}
    plant = linearise(module, state, params, inputs=inputs)
    assert_allclose(plant.A, numbers[0], rtol=1e-11, atol=1e-11)
    assert_allclose(plant.B, numbers[1], rtol=1e-11, atol=1e-11)
    n = len(module.COORDINATES)
    expected = np.hstack([np.diag(2 * np.array(values[:n])), np.eye(n)])
    assert_allclose(numbers[2], expected)
    assert np.abs(plant.rate).max() > 0.1


def test_outputs_depend_on_state_and_inputs() -> None:
    space = Derivation(cart_pole).state_space(outputs=["x + l*sin(theta)", "F*cos(theta) - 2*T"])
    assert space.C[0, :] == sp.Matrix([[1, sp.Symbol("l", positive=True), 0, 0]])
    assert sp.Matrix([[0, 0], [1, -2]]) == space.D
    plant = linearise(cart, {}, {}, outputs=["theta"])
    assert plant.C.tolist() == [[0.0, 1.0, 0.0, 0.0]]
    assert plant.outputs == ("theta",)


def test_normal_modes_of_the_double_pendulum_are_known() -> None:
    """Equal masses and lengths: omega² = (2 ± √2) g/l, θ2 = ∓√2 θ1."""
    import generated.double_pendulum as dp

    plant = linearise(dp, {}, {"m1": 1, "m2": 1, "l1": 2, "l2": 2})
    slow, fast = plant.modes
    squares = (2 + np.array([-1, 1]) * np.sqrt(2)) * 9.81 / 2
    assert_allclose([slow.frequency, fast.frequency], np.sqrt(squares) / (2 * np.pi), rtol=1e-12)
    assert_allclose([m.damping_ratio for m in (slow, fast)], 0.0, atol=1e-12)
    assert_allclose(slow.shape, [1 / np.sqrt(2), 1.0], atol=1e-12)
    assert_allclose(fast.shape, [-1 / np.sqrt(2), 1.0], atol=1e-12)
    assert plant.stability == "neutral"


def test_damping_is_known() -> None:
    pendulum = module_of("driven_pendulum")
    params = {"a": 0.0, "c": 0.4, "m": 1.0, "l": 1.0}
    (mode,) = linearise(pendulum, {}, params).modes
    omega = np.sqrt(9.81)
    assert mode.damping_ratio == pytest.approx(0.4 / (2 * omega))
    assert mode.frequency == pytest.approx(np.sqrt(9.81 - 0.04) / (2 * np.pi))
    assert linearise(pendulum, {}, params).stability == "asymptotically stable"
    assert linearise(pendulum, {"theta": np.pi}, params).stability == "unstable"


def test_a_regulator_holds_the_pole_upright() -> None:
    plant = linearise(cart, {"theta": 0.0}, {})
    Q, R = np.diag([10.0, 1.0, 1.0, 1.0]), np.array([[1.0]])
    B = plant.B[:, :1]
    K = np.linalg.solve(R, B.T @ solve_continuous_are(plant.A, B, Q, R))
    held = Held(0.01, lambda t, y: {"F": -K[0] @ y})
    motion = integrate(cart, (0, 8), {"x": 0.0, "theta": 0.3}, {}, inputs=held)
    assert np.abs(motion.y[:, -1]).max() < 1e-2
    assert np.abs(motion.y[1]).max() < 0.5
    # with a force of the wrong sign it falls
    wrong = Held(0.01, lambda t, y: {"F": K[0] @ y})
    fallen = integrate(cart, (0, 1), {"x": 0.0, "theta": 0.3}, {}, inputs=wrong)
    assert np.abs(fallen.y[1]).max() > 1
    # the linear system predicts small motions
    small = integrate(
        cart, (0, 1), {"x": 0.0, "theta": 1e-4}, {}, inputs=lambda t, y: {"F": -K[0] @ y}
    )
    values, vectors = np.linalg.eig(plant.A - B @ K)
    weights = np.linalg.solve(vectors, np.array([0, 1e-4, 0, 0]))
    expected = (vectors @ (weights * np.exp(values))).real
    assert_allclose(small.y[:, -1], expected, atol=1e-9)


def test_systems_are_handed_over(monkeypatch: pytest.MonkeyPatch) -> None:
    plant = linearise(cart, {}, {}, outputs=["x"])
    system = plant.to_scipy()
    assert_allclose(np.linalg.eigvals(system.A), plant.eigenvalues)
    assert system.C.shape == (1, 4)
    calls: list[Any] = []
    fake = SimpleNamespace(ss=lambda *matrices, **names: calls.append((matrices, names)))
    monkeypatch.setitem(sys.modules, "control", fake)
    plant.to_control()
    ((matrices, names),) = calls
    assert [matrix.shape for matrix in matrices] == [(4, 4), (4, 2), (1, 4), (1, 2)]
    assert names == {"states": [*cart.STATE], "inputs": ["F", "T"], "outputs": ["x"]}
    monkeypatch.setitem(sys.modules, "control", None)
    with pytest.raises(ImportError, match="pip install control"):
        plant.to_control()


@pytest.mark.parametrize(
    ("at", "outputs", "message"),
    [
        ({"phi": 0}, None, "'phi' is no quantity of the point.*known are x, theta"),
        ({"theta": "1 +"}, None, "theta: cannot parse"),
        ({"theta": float("inf")}, None, "theta: .* is not a formula"),
        ({}, ["y"], "an output: .*y"),
        ({}, "x", "outputs = 'x' is not a sequence"),
    ],
)
def test_invalid_points_are_refused(at: Any, outputs: Any, message: str) -> None:
    with pytest.raises(SystemDefinitionError, match=message):
        Derivation(cart_pole).state_space(at, outputs)


@pytest.mark.parametrize("name", ["spherical_pendulum", "heavy_top", "swinging_atwood"])
def test_points_with_a_singular_mass_matrix_are_refused(name: str) -> None:
    with pytest.raises(SystemDefinitionError, match=f"mass matrix of '{name}' is singular at"):
        Derivation(load(name)).state_space()


def test_invalid_numbers_are_refused() -> None:
    with pytest.raises(SystemDefinitionError, match="matrices depend on t: give its value"):
        Derivation(load("driven_pendulum")).state_space().numbers()
    with pytest.raises(SystemDefinitionError, match="'mm' is no quantity"):
        Derivation(cart_pole).state_space().numbers({"mm": 1.0})
    for arguments, message in (
        (({"phi": 0.0}, {}), "y has no 'phi'"),
        (((1.0,), {}), r"y has shape \(1,\): give 4 numbers"),
        (({}, {"K": 1.0}), "params has no 'K'"),
        (({"x": np.nan}, {}), "x = nan must be a finite"),
    ):
        with pytest.raises(ValueError, match=message):
            linearise(cart, *arguments)
    with pytest.raises(ValueError, match=r"outputs has 'thta' .did you mean 'theta'"):
        linearise(cart, {}, {}, outputs=["thta"])
    with pytest.raises(ValueError, match="no derivative at y"):
        linearise(module_of("spherical_pendulum"), {}, {})


@pytest.mark.parametrize("infinite", [0, 1])
def test_outputs_without_a_finite_derivative_are_refused(
    infinite: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """That by the state or that by the inputs alone is not finite."""
    matrices = [np.ones((4, 4)), np.ones((4, 2))]
    matrices[infinite][0, 0] = np.inf
    monkeypatch.setattr(linear_system, "_of_outputs", lambda *_: matrices)
    with pytest.raises(ValueError, match="the outputs have no finite derivative at y"):
        linearise(cart, {}, {}, outputs=["x"])
