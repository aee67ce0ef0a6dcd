"""Irrational numbers and roots in formulas: generated for every language, or refused by name."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

from derive import Coordinate, Derivation, Parameter, PointMass, System
from derive.codegen.expression_graph.sympy_translation import UnsupportedFunctionError
from derive.codegen.module_functions import contents
from derive.commands.regenerate import main
from derive.system.parts import SystemDefinitionError
from solvers.app.modules import build, load
from solvers.integration.integrate import integrate

DRIVEN = """
potential = "0"
[coordinates]
x = { unit = "m" }
[parameters]
f = { value = 0.7, unit = "1/s" }
[forces]
x = "cos(2*pi*f*t) + pi/3"
[[masses]]
mass = "1"
position = ["x", "0"]
"""

x = sp.Symbol("x", real=True)
r, k = sp.symbols("r k", positive=True)


def particle(potential: sp.Expr, q: sp.Symbol = x, position: sp.Expr | None = None) -> System:
    return System(
        name="particle",
        title="A particle on a line",
        coordinates=[Coordinate(q, "m", "position")],
        parameters=[Parameter(k, "1", 1.3, "strength")],
        masses=[PointMass(1, (q if position is None else position, 0))],
        potential=potential,
    )


@pytest.mark.parametrize("backend", ["python", "compiled"])
def test_pi_in_a_formula_is_generated_and_integrated(backend: str, tmp_path: Path) -> None:
    path = tmp_path / "driven.toml"
    path.write_text(DRIVEN)
    module = load(str(path))
    for t in (0.1, 0.3, 1.7):
        argument = 2 * math.pi * 0.7 * t
        rate = module.rhs(t, (0.0, 0.0), module.DEFAULTS)[1]
        assert rate == pytest.approx(math.cos(argument) + math.pi / 3, rel=4e-16)
    # ẍ = cos(2πft) + π/3 from rest
    start, params = (0.0, 0.0), module.DEFAULTS
    motion = integrate(module, (0, 3), start, params, rtol=1e-13, atol=1e-13, backend=backend)
    omega = 2 * math.pi * 0.7
    exact = (1 - np.cos(3 * omega)) / omega**2 + math.pi / 3 * 9 / 2
    assert motion.y[0, -1] == pytest.approx(exact, rel=1e-12)


def test_rational_multiples_of_pi_are_literals_right_to_the_last_bit(tmp_path: Path) -> None:
    path = tmp_path / "driven.toml"
    path.write_text(DRIVEN)
    assert main([str(path), "--output", str(tmp_path)]) == 0
    for suffix in (".py", ".h"):
        numbers = {
            float(n) for n in re.findall(r"\d\.\d{10,}", (tmp_path / f"driven{suffix}").read_text())
        }
        assert numbers >= {2 * math.pi, float((sp.pi / 3).evalf(30))}
    assert float((sp.pi / 3).evalf(30)) != 1 / 3 * math.pi  # as two roundings would give


@pytest.mark.parametrize("exponent", ["3/2", "1/2", "-1/2", "5/2", "1/4", "-7/4", "3/8"])
def test_powers_by_square_roots_are_generated(exponent: str) -> None:
    power = float(sp.Rational(exponent))
    module = build(particle(k * r ** sp.Rational(exponent), r))
    for value in (0.3, 1.7, 20.0):
        energy = module.energy(0.0, (value, 0.0), module.DEFAULTS)
        assert energy == pytest.approx(1.3 * value**power, rel=2e-15)
        force = module.rhs(0.0, (value, 0.0), module.DEFAULTS)[1]
        assert force == pytest.approx(-1.3 * power * value ** (power - 1), rel=2e-15)


@pytest.mark.parametrize("system", [
    particle(k * x ** sp.Rational(3, 2)),
    particle(k * x**2, position=sp.sqrt(x)),
    particle(k * x**2, position=sp.sin(x) ** 2 / x),
    particle(k * r**2, r),
])  # fmt: skip
def test_there_is_no_linear_form_where_its_matrices_would_not_be_finite(system: System) -> None:
    derivation = Derivation(system)
    assert "linear" not in {f.name for f in contents(derivation).functions}
    with pytest.raises(SystemDefinitionError, match=r"infinite terms|r is positive|not finite"):
        derivation.linearisation()


@pytest.mark.parametrize(
    ("potential", "reason"),
    [
        (sp.gamma(k) * x, r"'gamma\(k\)': the function gamma is unknown; use sin, .*sqrt"),
        (sp.zeta(r) * k, r"'zeta\(r\)': the function zeta is unknown; use sin, .*Piecewise"),
    ],
)
def test_what_is_not_generated_is_named_with_the_way_out(potential: sp.Expr, reason: str) -> None:
    q = r if r in potential.free_symbols else x
    with pytest.raises(UnsupportedFunctionError, match=f"no generated code for {reason}"):
        contents(Derivation(particle(potential, q)))


def test_a_power_of_a_parameter_is_written_with_exp_and_log() -> None:
    module = build(particle(sp.exp(k * sp.log(r)), r))
    assert module.energy(0.0, (1.7, 0.0), (1.3,)) == pytest.approx(1.7**1.3, rel=1e-15)
