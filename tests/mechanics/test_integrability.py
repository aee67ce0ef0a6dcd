"""Constraints of velocities: which are constraints of positions, by Frobenius' theorem."""

from dataclasses import replace
from pathlib import Path

import pytest
import sympy as sp
from differential_constraints import (
    R,
    a,
    c,
    constrained,
    dphi,
    dtheta,
    dx,
    dy,
    dz,
    m,
    phi,
    s,
    theta,
    x,
    y,
    z,
)

from derive import TIME, Derivation, PointMass
from derive.commands.regenerate import main
from derive.mechanics.constraints import integrability
from derive.system.parts import SystemDefinitionError
from holonomic import build, integrate

u = sp.Symbol("u", real=True)
WHEEL = """
title = "A wheel on a line"
constraints = ["x_dot - R*phi_dot"]

[coordinates]
x = { unit = "m" }
phi = {}

[parameters]
R = { value = 0.3, unit = "m" }
m = { value = 1, unit = "kg" }
g = { value = 9.81, unit = "m/s^2" }

[[masses]]
mass = "m"
position = ["x", "R"]
"""
DISC = [dx - R * dphi * c, dy - R * dphi * s]


@pytest.mark.long("more cases of the same kind", keep=4)
@pytest.mark.parametrize(
    ("constraints", "integrable", "nonholonomic"),
    [
        ([dx - R * dphi], 1, 0),  # a wheel on a line
        (DISC, 0, 2),  # a vertical disc, which turns
        ([*DISC, dtheta], 3, 0),  # which does not turn
        ([*DISC, theta - phi], 2, 0),  # which turns as it rolls
        ([dx * s - dy * c], 0, 1),  # a knife edge
        ([dx * c + dy * s - R * dphi, dx * s - dy * c], 0, 2),  # the disc, in other words
        ([dz - y * dx], 0, 1),
        ([dz - y * dx, dy], 2, 0),  # hidden: the first is integrable with the second
        ([dz - y * dx, y - 1], 1, 0),
        ([c * dx - s * a * dtheta, c * c * dy - s * dtheta], 2, 0),
        ([dz - y * dx, dphi - 2 * x * dx], 1, 1),  # one of two
        ([dz - y * dx, 2 * dphi - 2 * y * dx + 2 * dy], 1, 1),  # neither, but the difference
        ([dx - TIME**2], 1, 0),
        ([dx - y * TIME], 0, 1),
        ([dx - u], 0, 1),  # an input may be any function of time
        ([dx - u * dy], 0, 1),
        ([dx * sp.tan(theta) - dtheta], 1, 0),
        ([dx - R * sp.cos(theta / 2 + phi / 3) * dphi], 0, 1),
        ([dx - 2 * c * s * dtheta + sp.sin(2 * theta) * dtheta], 1, 0),  # a hidden zero
        ([dx - dtheta, dx - dtheta + 0 * dy], 1, 0),  # twice the same
        ([x - theta, dx - dtheta], 0, 0),  # nothing new
    ],
)
def test_integrability_is_decided(
    constraints: list[sp.Expr], integrable: int, nonholonomic: int
) -> None:
    result = constrained(*constraints).integrability
    assert (result.integrable, result.nonholonomic) == (integrable, nonholonomic)
    assert not result.note


@pytest.mark.parametrize(
    ("constraints", "count"),
    [([dz - y * dx], 1), ([dx * s - dy * c], 1), ([x - y, dz - y * dtheta], 1)],
)
def test_one_point_shows_that_no_integral_exists(
    constraints: list[sp.Expr], count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However long the constraints are; an integral is searched if they are short enough."""
    monkeypatch.setattr(integrability, "LONGEST", 0)
    result = constrained(*constraints).integrability
    assert (result.integrable, result.nonholonomic, result.note) == (0, count, "")
    undecided = constrained(dx - R * dphi).integrability
    assert (undecided.integrable, undecided.note) == (0, "the constraints are too long")


@pytest.mark.long("more cases of the same kind", keep=3)
@pytest.mark.parametrize(
    ("constraints", "integrals"),
    [
        ([dx - R * dphi], [R * phi - x]),
        ([(1 + x**2) * c * (x * dx + y * dy)], [x**2 + y**2]),  # an integrating factor
        ([dx - a * c * dtheta, (dy - a * s * dtheta) * c], [a * s - x, a * c + y]),
        ([dz - y * dx, dy], [y, z - x * y]),
        ([x * dx + y * dy + theta * s * dtheta], [x**2 + y**2 + 2 * s - 2 * theta * c]),
        ([x**3 * dx - dz + 2 * TIME], [x**4 - 4 * z + 4 * TIME**2]),
        ([*DISC, theta - phi], [x - R * sp.sin(theta), y + R * sp.cos(theta)]),
    ],
)
def test_integrals_are_constant_and_complete(
    constraints: list[sp.Expr], integrals: list[sp.Expr]
) -> None:
    # oracle: equal functions of equal constants have dependent gradients
    d = constrained(*constraints)
    variables = [x, y, z, theta, phi, TIME]
    found = d.integrability.integrals
    assert len(found) == len(integrals)
    known = [*d.holonomic, *integrals]
    generic = dict(
        zip((*variables, R, a), map(sp.Rational, (3, 5, 7, 1, 1, 2, 11, 13)), strict=True)
    )
    if theta - phi not in d.holonomic:
        generic[phi] = sp.Rational(4)
    rows = sp.Matrix([*known, *found]).jacobian(variables).subs(generic).evalf(30)
    assert rows[: len(known), :].rank(iszerofunc=_is_zero) == len(known)
    assert rows.rank(iszerofunc=_is_zero) == len(known)


def _is_zero(number: sp.Expr) -> bool:
    return bool(abs(number) < 1e-20)


def test_formulas_that_cannot_be_decided_are_reported() -> None:
    result = constrained(dx * sp.exp(x) - dy).integrability
    assert result.nonholonomic == 1
    assert "exp(x) is not a rational function" in result.note
    assert "not decided" in str(result)


def test_an_integral_that_is_no_polynomial_is_left_out() -> None:
    result = constrained(y * dx - x * dy).integrability  # x/y, which is not finite at y = 0
    assert (result.integrals, result.integrable) == ((), 1)


@pytest.mark.parametrize(
    ("constraints", "held"),
    [
        ([2 * y * dx + x * dy], ()),  # x² y, whose gradient is 0 at x = 0
        ([2 * y * dx + x * dy, dz - dphi], (phi - z,)),
        # of y cos(theta) - x sin(theta) and one of these, gradients are not always independent
        ([*DISC, dtheta], (theta, x - R * phi * c, y - R * phi * s)),
        ([dx - x * sp.tan(theta) * dtheta], (x * c,)),
    ],
)
def test_motions_are_kept_on_integrals_with_factors_that_are_never_0(
    constraints: list[sp.Expr], held: tuple[sp.Expr, ...]
) -> None:
    result = constrained(*constraints).integrability
    assert {*map(sp.expand, result.held.values())} == {*held}
    missing = result.integrable - len(held)
    left = f"{missing} without an integral that can be kept at its value at the start"
    assert (left in str(result)) == bool(missing)


def test_the_statement_names_the_reason() -> None:
    assert str(constrained(dx - R * dphi).integrability) == (
        "1 integrable: positions remain restricted; constant along a motion: R*phi - x"
    )
    assert "must not be used to remove velocities" in str(constrained(*DISC).integrability)
    assert str(constrained(x - y).integrability) == ""


def test_the_command_prints_the_decision(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "wheel.toml"
    path.write_text(WHEEL)
    assert main([str(path), "--output", str(tmp_path)]) == 0
    assert "constraints of velocities: 1 integrable" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("constraint", "reason"),
    [(dx * s - dy * c, "not integrable"), (x**2 + y**2 - R**2, "not independent")],
)
def test_hamilton_s_form_is_refused_with_the_reason(constraint: sp.Expr, reason: str) -> None:
    system = constrained(constraint).system
    d = Derivation(replace(system, masses=[PointMass(m, (x, y)), PointMass(m, (theta, z + phi)),
        PointMass(m, (phi, z))]))  # fmt: skip
    for name in ("hamiltonian", "hamilton_equations"):
        with pytest.raises(SystemDefinitionError, match=reason):
            getattr(d, name)
    module = build(d.system)
    with pytest.raises(ValueError, match="constraints leave its coordinates and momenta not indep"):
        integrate(module, (0, 1), [0.0] * 10, module.DEFAULTS, form="hamiltonian")
