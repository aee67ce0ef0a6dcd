"""Generated functions against the derivation, evaluated with 50 digits."""

import __future__

import ast
import inspect
import random
from collections.abc import Callable, Iterator, Sequence
from itertools import product
from math import cos, pi, sin
from types import ModuleType

import numpy as np
import pytest
import sympy as sp
from mpmath import mpf, workdps
from mutation import Mutation, is_constant
from numpy.testing import assert_allclose, assert_array_equal
from scipy.integrate import solve_ivp

from derive import Derivation
from solvers.equations.forms import Form

#: The functions' annotations name types that exist for type checkers only.
annotations = __future__.annotations.compiler_flag

EPS = float(np.finfo(float).eps)

FUNCTIONS = (
    "rhs",
    "jacobian",
    "energy",
    "mass_matrix",
    "positions",
    "hamiltonian_state",
    "rhs_hamiltonian",
    "jacobian_hamiltonian",
    "energy_hamiltonian",
    "lagrangian_state",
    "equilibrium",
    "linear",
)

#: How many rounding errors, in units of ε times the condition number, are allowed (0.5 occur).
FEW = 1


def formulas(derivation: Derivation) -> dict[str, Sequence[sp.Expr]]:
    """What each function should return, straight from the derivation."""
    system = derivation.system
    linear = derivation.linearisation()
    velocities, forces = derivation.hamilton_equations
    rhs = [*system.qdot, *derivation.accelerations]
    rhs_hamiltonian = [*velocities, *forces]
    state, canonical = (*system.q, *system.qdot), (*system.q, *system.p)
    return {
        "rhs": rhs,
        "jacobian": [f.diff(s) for f in rhs for s in state],
        "energy": [derivation.energy],
        "mass_matrix": list(derivation.mass_matrix),
        "positions": [x for mass in system.masses for x in mass.position],
        "hamiltonian_state": [*system.q, *derivation.momenta],
        "rhs_hamiltonian": rhs_hamiltonian,
        "jacobian_hamiltonian": [f.diff(s) for f in rhs_hamiltonian for s in canonical],
        "energy_hamiltonian": [derivation.hamiltonian],
        "lagrangian_state": [*system.q, *velocities],
        "equilibrium": list(linear.equilibrium),
        "linear": [*linear.mass_matrix, *linear.stiffness_matrix],
    }


HAMILTONIAN = {"rhs_hamiltonian", "jacobian_hamiltonian", "energy_hamiltonian", "lagrangian_state"}


def called(function: Callable[..., object], y: object, params: object) -> object:
    values = {"t": 0.3, "y": y, "params": params}
    return function(*(values[name] for name in inspect.signature(function).parameters))


def states(module: ModuleType) -> Iterator[tuple[list[float], list[float]]]:
    """Seeded random states, then degenerate ones: aligned, upright, far around, light masses."""
    n, generator = len(module.COORDINATES), random.Random(20)
    lengths = [module.UNITS[q] == "m" for q in module.COORDINATES]

    def possible(y: list[float]) -> list[float]:
        return [
            1 + abs(x) % 7 if positive else x
            for x, positive in zip(y, [*lengths, *[False] * n], strict=True)
        ]

    for _ in range(20):
        yield (
            possible([generator.uniform(-7, 7) for _ in range(2 * n)]),
            [generator.uniform(0.2, 3) for _ in module.PARAMETERS],
        )
    for angle, speed in product((0.0, pi / 2, pi, -pi, 1e6), (0.0, 1.5)):
        yield possible([angle] * n + [speed, *[-speed] * (n - 1)]), list(module.DEFAULTS)
    light = [
        1e-9 if name == "m1" else value
        for name, value in zip(module.PARAMETERS, module.DEFAULTS, strict=True)
    ]
    yield [1.0] * n + [0.5] * n, light
    yield [1.0, *[1.0 + 1e-5] * (n - 1)] + [0.5] * n, light


@pytest.mark.long("more cases of the same kind", keep=6, daily=18)
@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_are_exact_to_a_few_rounding_errors(
    derivation: Derivation, module: ModuleType, name: str
) -> None:
    system = derivation.system
    second = system.p if name in HAMILTONIAN else system.qdot
    symbols = (*system.q, *second, *system.params)
    # beside each value the weight of relative errors in its inputs: Σ |∂f/∂x x| + |f|
    values_and_weights = sp.lambdify(
        symbols,
        [
            (f, sum(sp.Abs(f.diff(s) * s) for s in symbols) + sp.Abs(f))
            for f in formulas(derivation)[name]
        ],
        modules="mpmath",
        cse=True,
    )
    function = getattr(module, name)
    for y, params in states(module):
        results = np.ravel(called(function, y, params))
        with workdps(50):
            exact = values_and_weights(*map(mpf, [*y, *params]))
            for result, (value, weight) in zip(results, exact, strict=True):
                assert abs(mpf(result) - value) <= FEW * EPS * weight


def test_the_rational_form_gives_the_same_rates(derivation: Derivation, module: ModuleType) -> None:
    system, n = derivation.system, len(derivation.system.q)
    symbols = (*system.q, *system.qdot, *system.params)
    # rounding sin q and cos q moves q itself, by ε in radians
    weights = sp.lambdify(
        symbols,
        [
            sum(sp.Abs(f.diff(s) * s) for s in symbols) + sum(sp.Abs(f.diff(q)) for q in system.q)
            for f in derivation.accelerations
        ],
        modules="math",
        cse=True,
    )
    for y, params in states(module):
        rational = module.rational_state(0.0, y, params)
        rates = module.rhs_rational(0.0, rational, params)
        expected = module.rhs(0.0, y, params)
        where = module.STATES["rational"].index
        for q, x, speed in zip(module.COORDINATES, y[:n], y[n:], strict=True):
            if module.UNITS[q] != "rad":
                assert (rational[where(q)], rates[where(q)]) == (x, speed)
                continue
            k = where(f"sin_{q}")
            assert where(f"cos_{q}") == k + 1
            assert rational[k : k + 2] == (sin(x), cos(x))
            assert rates[k : k + 2] == (
                pytest.approx(cos(x) * speed, rel=1e-15),
                pytest.approx(-sin(x) * speed, rel=1e-15),
            )
        for rate, value, weight in zip(rates[-n:], expected[n:], weights(*y, *params), strict=True):
            assert abs(rate - value) <= 2 * FEW * EPS * (weight + abs(value))


@pytest.mark.parametrize("name", ["rhs_rational", "rhs_variational", "rhs_sensitivity"])
def test_rational_right_hand_sides_call_no_function(module: ModuleType, name: str) -> None:
    source = ast.parse(inspect.getsource(getattr(module, name)))
    called = {
        node.func.id
        for node in ast.walk(source)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    }
    assert called == {"hasattr"}


@pytest.mark.parametrize("name", ["rhs", "rhs_hamiltonian"])
def test_jacobians_agree_with_complex_steps(module: ModuleType, name: str) -> None:
    function = getattr(module, f"{name}_many")
    jacobian = getattr(module, name.replace("rhs", "jacobian"))
    for y, params in states(module):
        steps = np.array(y)[:, None] + 1e-30j * np.eye(len(y))
        expected = function(0.0, steps, params).imag / 1e-30
        scale = np.abs(expected).max()
        assert_allclose(jacobian(0.0, y, params), expected, rtol=1e-9, atol=1e-11 * scale)


def test_variational_equations_propagate_a_linear_perturbation(module: ModuleType) -> None:
    meaning = " ".join(module.rhs_variational.__doc__.split())
    assert "a motion and its linear perturbation" in meaning
    n, generator = len(module.STATE), np.random.default_rng(4)
    for y, params in states(module):
        change = generator.normal(size=n)
        form = Form(module, "variational", params)
        rates = form.rhs(0.0, form.from_ordinary(0.0, np.concatenate([y, change])))
        motion = Form(module, "rational", params)
        assert tuple(rates[:-n]) == pytest.approx(
            motion.rhs(0.0, motion.from_ordinary(0.0, np.array(y)))
        )
        # the derivative of the Lagrangian form in this direction, exact by a complex step
        expected = module.rhs_many(0.0, np.array(y) + 1e-30j * change, params).imag / 1e-30
        scale = np.abs(np.array(module.jacobian(0.0, y, params)) * change).max()
        assert_allclose(rates[-n:], expected, rtol=1e-9, atol=1e-11 * scale)


def test_nothing_moves_at_the_equilibrium(module: ModuleType) -> None:
    for _, params in states(module):
        rest = module.equilibrium(params)
        rates = module.rhs(0.0, (*rest, *[0.0] * len(rest)), params)
        assert np.abs(rates).max() < 1e-12


def test_arrays_of_states_give_what_single_states_give(module: ModuleType) -> None:
    for name in formulas_names(module):
        cases = list(states(module))
        if name in ("rhs_rational", "rhs_variational", "rhs_sensitivity"):
            lagrangian = [Form(module, "lagrangian", params) for _, params in cases]
            forms = [form.in_form(name.removeprefix("rhs_")) for form in lagrangian]
            cases = [
                (form.from_ordinary(0.0, np.resize(y, len(form.ordinary))), form.params)
                for form, (y, _) in zip(forms, cases, strict=True)
            ]
        y = np.array([y for y, _ in cases]).T
        params = np.array([params for _, params in cases]).T
        function, many = getattr(module, name), getattr(module, f"{name}_many")
        together = called(many, y, params)
        for k, (state, values) in enumerate(cases):
            single = np.array(called(function, state, values))
            # NumPy's sine and cosine may differ from the C library's in the last digit
            assert_allclose(together[..., k], single, rtol=1e-9, atol=1e-9)
            assert_array_equal(called(many, state, values), together[..., k])


def formulas_names(module: ModuleType) -> list[str]:
    return [name.removesuffix("_many") for name in vars(module) if name.endswith("_many")]


def test_arrays_may_have_any_number_of_axes_and_numbers_beside_arrays(module: ModuleType) -> None:
    n = 2 * len(module.COORDINATES)
    y = np.random.default_rng(1).uniform(-1, 1, (n, 3, 2))
    assert module.rhs_many(0.0, y, module.DEFAULTS).shape == (n, 3, 2)
    assert module.jacobian_many(0.0, y, module.DEFAULTS).shape == (n, n, 3, 2)
    assert module.energy_many(0.0, y, module.DEFAULTS).shape == (3, 2)
    assert module.linear_many(module.DEFAULTS).shape[0] == 2
    assert module.mass_matrix_many(0.0, y, module.DEFAULTS).shape[2:] == (3, 2)


def test_functions_take_lists_tuples_and_arrays_and_do_not_modify_them(module: ModuleType) -> None:
    y = [0.3 * k + 0.1 for k in range(2 * len(module.COORDINATES))]
    array, params = np.array(y), np.array(module.DEFAULTS)
    assert module.rhs(0, y, module.DEFAULTS) == module.rhs(0, array, params)
    assert module.rhs(0, tuple(y), module.DEFAULTS) == module.rhs(0, array, params)
    assert all(type(value) is float for value in module.rhs(0, array, params))
    assert_array_equal(array, y)
    with pytest.raises(ValueError, match="unpack"):
        module.rhs(0, y[1:], module.DEFAULTS)


def test_the_mass_matrix_is_symmetric_and_positive_definite(module: ModuleType) -> None:
    for y, params in states(module):
        M = np.array(module.mass_matrix(0.0, y, params))
        assert_array_equal(M, M.T)
        scale = np.sqrt(np.diag(M))
        assert np.linalg.eigvalsh(M / np.outer(scale, scale))[0] > 0


def test_momenta_are_those_of_the_mass_matrix_and_lead_back_to_the_state(
    module: ModuleType,
) -> None:
    for y, params in list(states(module))[:20]:
        canonical = module.hamiltonian_state(0.0, y, params)
        assert_allclose(module.lagrangian_state(0.0, canonical, params), y, rtol=1e-11)
        n = len(y) // 2
        M = np.array(module.mass_matrix(0.0, y, params))
        assert_allclose(canonical[n:], M @ y[n:], rtol=1e-12, atol=1e-12)


def test_energy_does_not_change_along_either_right_hand_side(module: ModuleType) -> None:
    for form in ("", "_hamiltonian"):
        energy, rhs = (getattr(module, f"{name}{form}_many") for name in ("energy", "rhs"))
        for y, params in list(states(module))[:20]:
            flow = rhs(0.0, np.array(y), params)
            gradient = [
                energy(0.0, np.array(y) + 1e-30j * e, params).imag / 1e-30 for e in np.eye(len(y))
            ]
            power, scale = np.dot(gradient, flow), np.abs(gradient) @ np.abs(flow)
            assert abs(power) < 1e-13 * scale
            wrong = flow + np.eye(len(y))[-1] * 1e-6 * np.abs(flow).max()
            assert abs(np.dot(gradient, wrong)) > 1e-13 * scale


def test_both_forms_give_the_report_s_motion() -> None:
    # reference: an 80-bit Taylor series of the report's scene, 16 digits
    import generated.double_pendulum as dp

    expected = (2.2280642400930692, -0.2670447339117043, -1.9694093323354762, -2.9859792219408772)
    y0 = (pi / 2, pi, 0.0, 0.0)
    options = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-13, "args": (dp.DEFAULTS,)}
    lagrange = solve_ivp(dp.rhs, (0, 5), y0, **options).y[:, -1]
    start = dp.hamiltonian_state(0.0, y0, dp.DEFAULTS)
    hamilton = solve_ivp(dp.rhs_hamiltonian, (0, 5), start, **options).y[:, -1]
    assert_allclose(lagrange, expected, atol=1e-10)
    assert_allclose(dp.lagrangian_state(0.0, hamilton, dp.DEFAULTS), expected, atol=1e-10)
    coarse = solve_ivp(dp.rhs, (0, 5), y0, **(options | {"rtol": 1e-8})).y[:, -1]
    assert np.abs(coarse - expected).max() > 1e-10


@pytest.mark.long("more cases of the same kind", keep=14)
@pytest.mark.parametrize(
    "name",
    [
        "rhs",
        "rhs_hamiltonian",
        "energy",
        "energy_hamiltonian",
        "mass_matrix",
        "jacobian",
        "jacobian_hamiltonian",
        "equilibrium",
        "linear",
    ],
)
def test_every_mutation_of_a_function_changes_its_values(module: ModuleType, name: str) -> None:
    function = getattr(module, name)
    y, params = next(states(module))
    expected = np.ravel(called(function, y, params))
    source = ast.parse(inspect.getsource(function))
    mutated = 0
    while True:
        mutation = Mutation(mutated)
        tree = mutation.visit(ast.parse(inspect.getsource(function)))
        if mutation.count <= mutated:
            break
        namespace = dict(vars(module))
        code = compile(ast.fix_missing_locations(tree), name, "exec", flags=annotations)
        exec(code, namespace)
        assert np.abs(np.ravel(called(namespace[name], y, params)) - expected).max() > 1e-9
        mutated += 1
    assert mutated == operations(source)


def operations(tree: ast.AST) -> int:
    """Operations in a function's text, counted by Python's own parser."""
    return sum(
        (isinstance(node, ast.BinOp) and not is_constant(node))
        or (isinstance(node, ast.UnaryOp) and not isinstance(node.operand, ast.Constant))
        or (
            isinstance(node, ast.Call)
            and isinstance(node.func, ast.Name)
            and node.func.id in ("sin", "cos")
        )
        for node in ast.walk(tree)
    )


def test_docstrings_state_the_operations_of_the_text(module: ModuleType) -> None:
    for name in formulas_names(module):
        function = getattr(module, name)
        stated = int(inspect.getdoc(function).split(" operations")[0].split()[-1])
        assert stated == operations(ast.parse(inspect.getsource(function))), name


@pytest.mark.parametrize(
    ("name", "most"), [("rhs", 33), ("rhs_hamiltonian", 35), ("rhs_rational", 40)]
)
def test_right_hand_sides_of_the_double_pendulum_are_short(name: str, most: int) -> None:
    # straight-line code from a simplified Hamiltonian has 111, without reductions 87 and more
    import generated.double_pendulum as dp

    assert operations(ast.parse(inspect.getsource(getattr(dp, name)))) <= most
