"""Tangents in turned axes: equal dot products, of fewer angles."""

from itertools import product

import pytest
import sympy as sp

from derive import Coordinate, Derivation, Parameter, PointMass, System, rotations
from derive.mechanics.energies.kinetics import turned

x, y, psi, phi, theta, g = symbols = sp.symbols("x y psi phi theta g", real=True)
a, b = sp.symbols("a b", positive=True)
AT = dict(zip((*symbols, a, b), (0.3, -0.7, 0.9, 0.4, -1.1, 9.8, 1.3, 0.6), strict=True))


def tangents(position: tuple[sp.Expr, ...], *variables: sp.Symbol) -> list[tuple[sp.Expr, ...]]:
    return [tuple(component.diff(v) for component in position) for v in variables]


def products(vectors: list[tuple[sp.Expr, ...]]) -> list[float]:
    pairs = product(vectors, vectors)
    return [float(sum(p * r for p, r in zip(u, v, strict=True)).subs(AT)) for u, v in pairs]


def angles(vectors: list[tuple[sp.Expr, ...]]) -> int:
    return sum(len(sp.Tuple(*v).free_symbols & {psi, phi, theta}) for v in vectors)


@pytest.mark.parametrize("sequence", ["zxy", "zyx", "xyz", "zxz"])
def test_dot_products_remain_and_angles_vanish(sequence: str) -> None:
    arm = rotations(sequence, (psi, phi, theta)).turned((a, b, 1))
    position = tuple(p + r for p, r in zip((x, y, 0), arm, strict=True))
    before = tangents(position, x, y, psi, phi, theta)
    after = turned(before)
    assert products(after) == pytest.approx(products(before), rel=1e-13, abs=1e-13)
    assert angles(after) < angles(before)


def test_the_mass_matrix_of_a_vehicle_does_not_depend_on_its_heading() -> None:
    # the arm is too long to be expanded
    frame = rotations("zxy", (psi, phi, theta))
    arm = frame.turned([sp.Add(*(k * a**k * b for k in range(1, 9))), b + a**2, a + b])
    position = tuple(p + r for p, r in zip((x, y, 0), arm, strict=True))
    q = (x, y, psi, phi, theta)
    system = System(
        "vehicle", "A vehicle", [Coordinate(s, "m" if s in (x, y) else "rad", "any") for s in q],
        [Parameter(a, "m", 1.0, "length"), Parameter(b, "m", 1.0, "length"),
         Parameter(g, "m/s^2", 9.81, "gravity")],
        [PointMass(2, position), PointMass(3, (x, y, 0)), PointMass(1, frame.turned((0, 1, 1)))],
    )  # fmt: skip
    M = Derivation(system).mass_matrix
    assert not any(psi in entry.free_symbols for entry in M[2:, 2:])


def test_tangents_of_other_motions_stay_as_they_are() -> None:
    moving = [tangents((a * sp.cos(psi) + b * sp.cos(phi), a * sp.sin(psi) + b * sp.sin(phi)), *q)
              for q in ((psi, phi), (phi, psi))]  # fmt: skip
    ellipse = tangents((a * sp.cos(psi), b * sp.sin(psi)), psi)
    for vectors in (*moving, ellipse, [(sp.sin(psi) ** 2, sp.S.Zero)], [(sp.S.One,)]):
        assert turned(vectors) == vectors
