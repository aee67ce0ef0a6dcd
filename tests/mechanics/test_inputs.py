"""Inputs of a system: declared, generated, differentiated, and replaced by formulas."""

from importlib import import_module
from pathlib import Path
from types import ModuleType

import mpmath as mp
import numpy as np
import pytest
from cart_pole import F, T, cart_pole, theta, x
from numpy.testing import assert_allclose
from sympy import Symbol, cos, sin

from derive import (
    Coordinate,
    Derivation,
    Input,
    PointMass,
    System,
    load,
    names,
    velocity,
    with_inputs,
)
from derive.handout.derivation_document import document
from derive.handout.formats.page import page
from derive.system.parts import SystemDefinitionError
from solvers import build
from solvers.equations.module import ELEMENTARY, function, has_function, inputs, with_functions

FILE = """
title = "A cart with a force"
forces = { x = "F" }
dissipation = "c*u*x_dot**2/2"
potential = "0"

[coordinates]
x = { unit = "m" }

[parameters]
M = { value = 2, unit = "kg" }
c = { value = 1, unit = "N s/m" }

[inputs]
F = { unit = "N", meaning = "force" }
u = {}

[[masses]]
mass = "M"
position = ["x", "0"]
"""


@pytest.fixture(scope="module")
def module() -> ModuleType:
    return build(cart_pole)


def test_inputs_are_the_last_parameters(module: ModuleType) -> None:
    assert module.INPUTS == module.PARAMETERS[-2:] == ("F", "T")
    assert module.DEFAULTS[-2:] == (0.0, 0.0)
    assert inputs(module) == ("F", "T")
    assert module.UNITS["F"] == "N"
    assert "F [N]: force on the cart" in module.__doc__
    rest = module.rhs(0.0, (0.0, 0.0, 0.0, 0.0), module.params(F=3.0))
    assert rest == pytest.approx((0, 0, 6, -20))


@pytest.mark.parametrize("name", [name for name in names() if not load(name).inputs])
def test_systems_without_inputs_have_none(name: str) -> None:
    shipped = import_module(f"generated.{name}")
    assert not hasattr(shipped, "INPUTS")
    assert inputs(shipped) == ()


@pytest.mark.parametrize("name", ["cart_pole", *names()])
def test_jacobians_agree_with_differences_of_50_digits(name: str) -> None:
    module = build(cart_pole) if name == "cart_pole" else import_module(f"generated.{name}")
    rhs = function(module, "rhs")
    exact = with_functions(rhs, {name: getattr(mp, name) for name in ELEMENTARY})
    generator = np.random.default_rng(22)
    y = generator.uniform(0.3, 0.9, len(module.STATE)).tolist()
    params = generator.uniform(0.5, 1.5, len(module.PARAMETERS)).tolist()
    count = len(params) - len(inputs(module))
    with mp.workdps(50):
        numbers = [mp.mpf(x) for x in (*y, *params)]
        step, columns = mp.mpf(10) ** -17, []
        for k in range(len(numbers)):
            ends = []
            for sign in (1, -1):
                moved = [x + sign * step * (j == k) for j, x in enumerate(numbers)]
                ends.append(exact(mp.mpf("0.3"), moved[: len(y)], moved[len(y) :]))
            columns.append([float((a - b) / (2 * step)) for a, b in zip(*ends, strict=True)])
    expected = np.split(np.array(columns).T, [len(y), len(y) + count], axis=1)
    for stem, part in zip(
        ("jacobian", "parameter_jacobian", "input_jacobian"), expected, strict=True
    ):
        assert has_function(module, stem) == bool(part.size)
        if part.size:
            value = function(module, stem)(0.3, y, params)
            scale = np.abs(part).max()
            assert_allclose(value, part, rtol=1e-12, atol=1e-13 * scale)
            many = function(module, f"{stem}_many")(0.3, y, params)
            assert_allclose(many, part, rtol=1e-12, atol=1e-13 * scale)


def test_the_power_of_inputs_changes_the_energy(module: ModuleType) -> None:
    y, params = (0.3, 0.2, 0.5, -1.1), module.params(F=2.0, T=0.7)
    expected = 2.0 * 0.5 - 0.1 * 0.5**2 + 0.7 * np.cos(0.2) * -1.1
    assert module.power(0.0, y, params) == pytest.approx(expected)


def test_a_file_declares_inputs(tmp_path: Path) -> None:
    path = tmp_path / "cart.toml"
    path.write_text(FILE)
    system = load(path)
    assert [(u.symbol.name, u.unit, u.meaning) for u in system.inputs] == [
        ("F", "N", "force"),
        ("u", "1", "u"),
    ]
    assert build(system).rhs(0.0, (0.0, 3.0), (2.0, 1.0, 5.0, 0.5)) == (3.0, 1.75)
    path.write_text(FILE.replace('unit = "N", meaning', 'value = 1, unit = "N", meaning'))
    with pytest.raises(SystemDefinitionError, match=r"unknown key 'value' in inputs\.F"):
        load(path)


def test_formulas_replace_inputs() -> None:
    system = with_inputs(cart_pole, {"F": "-3*x - 2*x_dot + t", "T": 2 * theta})
    assert system.inputs == ()
    forces = Derivation(system).forcing
    expected = Derivation(cart_pole).forcing.subs({F: Symbol("u", real=True)})
    t, u = Symbol("t", real=True), Symbol("u", real=True)
    expected = expected.subs({u: -3 * x - 2 * velocity(x) + t, T: 2 * theta})
    assert (forces - expected).expand().is_zero_matrix
    some = with_inputs(cart_pole, {"T": 0})
    assert [u.symbol for u in some.inputs] == [F]


def test_an_input_in_positions_is_a_function_of_time() -> None:
    """The driven pendulum, with the height of its pivot as input."""
    driven, s = load("driven_pendulum"), Symbol("s", real=True)
    (length,) = (p for p in driven.params if p.name == "l")
    (q,) = driven.q
    position = (length * sin(q), s - length * cos(q))
    pendulum = System(
        "driven_pendulum", "A pendulum with a moving pivot", driven.coordinates,
        driven.parameters, [PointMass(driven.params[0], position)],
        dissipation=driven.dissipation, inputs=[Input(s, "m", "height of the pivot")],
    )  # fmt: skip
    with pytest.raises(SystemDefinitionError, match=r"positions .* depend on s, .*with_inputs"):
        Derivation(pendulum).forcing  # noqa: B018
    built = build(with_inputs(pendulum, {"s": "a*cos(Omega*t)"}))
    params = (1.0, 0.7, 0.1, 30.0, 0.2, 9.81)
    expected = import_module("generated.driven_pendulum").rhs(0.4, (1.0, 2.0), params)
    assert built.rhs(0.4, (1.0, 2.0), params) == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize(
    ("formulas", "message"),
    [
        ({"G": "0"}, r"no input 'G'.*inputs are F, T"),
        ({"F": "K*x"}, r"input F: .*K"),
        ({"F": "__import__('os')"}, "input F: "),
        ({"F": float("nan")}, "input F: 'nan' is not a formula"),
        ({"F": "F + 1"}, "input F: .*F"),
    ],
)
def test_invalid_formulas_are_refused(formulas: dict[str, object], message: str) -> None:
    with pytest.raises(SystemDefinitionError, match=message):
        with_inputs(cart_pole, formulas)


def test_invalid_inputs_are_refused() -> None:
    with pytest.raises(SystemDefinitionError, match="cannot be 0, its default value"):
        Input(Symbol("F", positive=True), "N", "force")
    with pytest.raises(SystemDefinitionError, match=r"inputs contains 'F'.* Input objects"):
        System("a", "a", [Coordinate(x, "m", "x")], [], [PointMass(1, (x, 0))], 0, inputs=["F"])
    with pytest.raises(SystemDefinitionError, match="uses a name twice: x"):
        System(
            "a", "a", [Coordinate(x, "m", "x")], [], [PointMass(1, (x, 0))], 0,
            inputs=[Input(x, "N", "force")],
        )  # fmt: skip
    with pytest.raises(SystemDefinitionError, match="mass F depends on F"):
        System(
            "a", "a", [Coordinate(x, "m", "x")], [], [PointMass(F, (x, 0))], 0,
            inputs=[Input(F, "N", "force")],
        )  # fmt: skip


def test_a_document_lists_inputs() -> None:
    text = page(document(Derivation(cart_pole)))
    assert "The inputs may change during a motion." in text
    assert "force on the cart" in text


def test_inputs_in_positions_are_named_in_order() -> None:
    forces = [Symbol(name, real=True) for name in "abcdef"]
    moved = System("moved", "Moved", [Coordinate(x, "m", "")], [],
        [PointMass(1, (x, sum(one**2 for one in forces)))], potential=0,
        inputs=[Input(one, "m", "") for one in forces])  # fmt: skip
    with pytest.raises(SystemDefinitionError, match=f"depend on {', '.join('abcdef')}, whose"):
        Derivation(moved)
