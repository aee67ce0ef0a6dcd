"""Which parameters outputs determine: known cases, and ranks of generated Jacobians."""

from importlib import import_module

import numpy as np
import pytest
import sympy as sp

from derive import Coordinate, Derivation, Input, Parameter, PointMass, System, load, velocity
from derive.formulas.residues import (
    PRIME,
    Evaluation,
    NoRootError,
    RandomResidues,
    ResidueSeries,
    branches,
    echelon,
    null_space,
)
from derive.mechanics.specialisation import specialised
from derive.system.parts import SystemDefinitionError

x = sp.Symbol("x", real=True)
m, k1, k2, c, F = sp.symbols("m k1 k2 c F", positive=True)


def oscillator(**parts: object) -> System:
    parameters = [Parameter(s, "1", 1.0, "a number") for s in (m, k1, k2, c, F)]
    base = {"potential": (k1 + k2) * x**2 / 2, "dissipation": c * velocity(x) ** 2 / 2}
    return System("o", "An oscillator", [Coordinate(x, "m", "a length")], parameters,
        [PointMass(m, (x, 0))], **(base | parts))  # fmt: skip


def lines(system: str | System, *outputs: str, unknown: list[str] | None = None) -> list[str]:
    derivation = Derivation(load(system) if isinstance(system, str) else system)
    return str(derivation.identifiable(unknown, outputs or None)).split("\n")


def test_a_pendulums_angle_determines_the_ratio_of_gravity_and_length() -> None:
    pendulum = lines("single_pendulum")
    assert pendulum == [
        "m: no output depends on it",
        "l, g: only as g/l; give one of them a value",
    ]
    assert lines("single_pendulum", unknown=["l"]) == ["l: determined"]


def test_positions_determine_lengths_and_energies_masses() -> None:
    assert lines("double_pendulum", "x2")[0] == "l1, l2, g: determined"
    assert lines("double_pendulum", "theta1", "theta2", "energy") == [
        "m1, m2, l1, l2, g: only as g**2*m1, l2**2*m1, l1**2*m1, m2/m1; give one of them a value"
    ]


def test_angles_of_a_double_pendulum_determine_ratios() -> None:
    expected = [
        "m1, m2: only as m2/m1; give one of them a value",
        "l1, l2, g: only as g/l1, l2/l1; give one of them a value",
    ]
    assert lines("double_pendulum") == expected
    assert lines("double_pendulum", "theta2") == expected  # one angle is enough


def test_sums_products_and_other_functions_are_named() -> None:
    plain = oscillator()
    assert lines(plain, unknown=["k1", "k2", "c"]) == [
        "c: determined",
        "k1, k2: only as k1 + k2; give one of them a value",
    ]
    assert lines(plain, unknown=["m", "k1", "c"]) == [
        "m, k1, c: only as 2 functions of m, k1, c; give one of them a value"
    ]
    assert lines(oscillator(potential=k1 * x**2 / 2), unknown=["m", "k1", "c"]) == [
        "m, k1, c: only as c/m, k1/m; give one of them a value"
    ]


def test_parameters_to_hold_come_from_the_preferred_order() -> None:
    result = Derivation(load("double_pendulum")).identifiable()
    assert result.to_hold(["g"]) == ("m1", "g")
    assert result.to_hold(["l2", "m2"]) == ("m2", "l2")


@pytest.mark.parametrize("name", ["double_pendulum", "elastic_pendulum", "driven_pendulum",
    "swinging_atwood", "rotating_hoop", "spherical_pendulum", "coupled_pendulums"])  # fmt: skip
def test_generated_jacobians_have_the_same_rank_where_coordinates_are_measured(name: str) -> None:
    module, random = import_module(f"generated.{name}"), np.random.default_rng(1)
    params = random.uniform(0.5, 2, len(module.PARAMETERS))
    rows = [
        row
        for t, *y in random.uniform(0.3, 1.2, (60, 1 + len(module.STATE)))
        for row in module.parameter_jacobian(t, y, params.tolist())
    ]
    singular = np.linalg.svd(np.array(rows) * params, compute_uv=False)
    missing = int((singular < 1e-10 * singular[0]).sum())
    assert missing == len(Derivation(load(name)).identifiable().to_hold())


def test_kinks_and_jumps_leave_friction_determined() -> None:
    stop = sp.Piecewise((0, x < 0), (k2 * x, x < 1), (c * x, True))
    forces = [-F * sp.sign(velocity(x)) + sp.Max(0, -k1 * x) + stop]
    friction = oscillator(dissipation=0, potential=0, forces=forces)
    assert lines(friction, unknown=["F", "k1", "k2", "c"]) == ["F, k1, k2, c: determined"]


FORMULAS = [sp.sin(2 * x) + sp.cos(x / 3), sp.tan(x), sp.exp(-x / 2), sp.log(1 + x), sp.atan(x),
    sp.sqrt(x**2 + 2), x ** sp.Rational(3, 4), sp.tanh(x), sp.sinh(x) * sp.cosh(2 * x), x**-3,
    sp.Abs(x) * x, sp.Float("0.5") * x**1.5, sp.atan2(x, 1 + x), x**c]  # fmt: skip


@pytest.mark.parametrize("formula", FORMULAS, ids=str)
def test_derivatives_of_residues_are_those_of_formulas(formula: sp.Expr) -> None:
    for seed in range(40):
        try:
            assert derivatives_agree(formula, seed)
            return
        except NoRootError:
            continue
    pytest.fail("no point has all roots")


def at_random(seed: int) -> tuple[np.ndarray, Evaluation]:
    """A series x(t) with its derivative by x, and the evaluation there, where c is constant."""
    point, rows = RandomResidues(seed), np.zeros((2, 6), np.int64)
    rows[0], rows[1, 0] = [point.residue(k) for k in range(6)], 1
    constant = np.zeros((2, 6), np.int64)
    constant[0, 0] = point.residue("c")
    return rows, Evaluation({x: ResidueSeries(rows), c: ResidueSeries(constant)}, point)


def derivatives_agree(formula: sp.Expr, seed: int) -> bool:
    rows, evaluate = at_random(seed)
    values, slopes = evaluate(formula).rows[1], evaluate(sp.diff(formula, x)).rows[0]
    # the series in time of f(x(t)) has the derivative f'(x) x'
    series, n = evaluate(formula).rows[0], np.arange(6)
    rate = ResidueSeries(slopes[np.newaxis]) * ResidueSeries(np.roll(rows[:1] * n % PRIME, -1))
    in_time = ((series * n)[1:] % PRIME == rate.rows[0][:-1]).all()
    return bool(in_time and (values == slopes).all())


@pytest.mark.parametrize("zero", [
    sp.sin(x + c) - sp.sin(x) * sp.cos(c) - sp.cos(x) * sp.sin(c),
    sp.cos(x - 2 * c) - sp.cos(x) * sp.cos(2 * c) - sp.sin(x) * sp.sin(2 * c),
    sp.sin(x / 2) ** 2 + sp.cos(x / 2) ** 2 - 1,
    sp.exp(x + c / 3) - sp.exp(x) * sp.exp(c / 3),
    sp.sign(x - c) + sp.sign(c - x),
    sp.Abs(x - c) - (x - c) * sp.sign(x - c),
], ids=str)  # fmt: skip
def test_residues_obey_the_equations_of_functions(zero: sp.Expr) -> None:
    _, evaluate = at_random(1)
    assert not evaluate(zero).rows.any()
    assert evaluate(zero.args[0]).rows.any()


@pytest.mark.parametrize("argument", [x - c, c - x])
def test_both_branches_of_a_sign_are_chosen(argument: sp.Expr) -> None:
    signs = [RandomResidues(1, one).sign(argument) for one in branches([sp.sign(argument)])]
    assert sorted(signs) == [-1, 1]


def test_rows_modulo_a_prime_have_the_null_space_of_rationals() -> None:
    rows = [[1, 2, 3], [2, 4, 6], [1, 0, 1]]
    assert len(echelon(rows)) == 2
    assert null_space(rows, 3) == [[1, 1, PRIME - 1]]
    assert null_space([[1, 0, 0], [0, 1, 3]], 3) == [[0, 1, pow(-3, -1, PRIME)]]


def test_unknown_names_are_refused_with_the_nearest() -> None:
    derivation = Derivation(load("double_pendulum"))
    with pytest.raises(SystemDefinitionError, match=r"no parameter 'L1'.*did you mean 'l1'"):
        derivation.identifiable(["L1"])
    with pytest.raises(SystemDefinitionError, match="did you mean 'theta1'"):
        derivation.identifiable(outputs=["thet1"])


def test_inputs_that_change_determine_more_than_constant_ones() -> None:
    g, i = sp.symbols("g i", real=True)
    k = sp.Symbol("k", positive=True)
    hoist = System("hoist", "A load that a motor lifts", [Coordinate(x, "m", "height")],
        [Parameter(s, "1", 1.0, "a number") for s in (m, k, g)], [PointMass(m, (x, 0))],
        potential=m * g * x, forces=[k * i], inputs=[Input(i, "A", "current")])  # fmt: skip
    assert lines(hoist, unknown=["k", "g"]) == ["k, g: determined"]
    assert lines(hoist) == ["g: determined", "m, k: only as k/m; give one of them a value"]
    (constant,) = lines(specialised(hoist, {"i": 2.0}), unknown=["k", "g"])
    assert constant.startswith("k, g: only as")
