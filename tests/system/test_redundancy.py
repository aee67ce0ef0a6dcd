"""Redundant constraints are left out; contradictory and singular ones are refused."""

import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

import derive.mechanics.constraints.redundancy
import generated.single_pendulum as single
from derive import (
    TIME,
    Constraint,
    Coordinate,
    Derivation,
    Parameter,
    PointMass,
    System,
    velocity,
    write,
)
from derive.mechanics.derivation import RedundancyWarning
from derive.system.parts import SystemDefinitionError
from holonomic import build, integrate

x, y, z, theta1, theta2, theta3, theta4 = sp.symbols("x y z theta1:5", real=True)
m, length, d = sp.symbols("m l d", positive=True)
g = sp.Symbol("g", real=True)
PARAMETERS = [
    Parameter(m, "kg", 1.5, "mass"),
    Parameter(length, "m", 0.5, "length of the cranks"),
    Parameter(d, "m", 1.2, "distance of the pivots"),
    Parameter(g, "m/s^2", 9.81, "gravity"),
]
OPTIONS = {"rtol": 1e-11, "atol": 1e-11, "backend": "python"}


def at(q: sp.Symbol, size: sp.Expr = length, dx: sp.Expr = sp.S.Zero) -> tuple[sp.Expr, sp.Expr]:
    return dx + size * sp.cos(q), size * sp.sin(q)


def in_plane(*constraints: sp.Expr | Constraint) -> System:
    """A point with constraints."""
    plane = [Coordinate(x, "m", "to the right"), Coordinate(y, "m", "upwards")]
    return System("point", "A point", plane, PARAMETERS, [PointMass(m, (x, y))],
        constraints=constraints)  # fmt: skip


def parallelogram() -> System:
    """A bar that hangs on three equal and parallel cranks, of which two suffice."""
    angles = [Coordinate(q, "rad", f"angle {q}") for q in (theta1, theta2, theta3, theta4)]
    bar = [at(theta1)[k] + d * f for k, f in enumerate((sp.cos(theta4), sp.sin(theta4)))]
    middle = [at(theta1)[k] + d / 2 * f for k, f in enumerate((sp.cos(theta4), sp.sin(theta4)))]
    return System("parallelogram", "A bar on three cranks", angles, PARAMETERS,
        [PointMass(m, at(q, length, k * d / 2)) for k, q in enumerate((theta1, theta3, theta2))]
        + [PointMass(m, middle)],
        coincide=[(bar, at(theta2, dx=d)), (middle, at(theta3, dx=d / 2))])  # fmt: skip


def locked() -> System:
    """A point on an axis, or at a place of another one, where both constraints are needed."""
    space = [Coordinate(q, "m", f"along {q}") for q in (x, y, z)]
    return System("locked", "A point that may be locked", space, PARAMETERS,
        [PointMass(m, (x, y, z))], constraints=[x * y, x * (x - d)])  # fmt: skip


def loop_in_space() -> System:
    """A four-bar linkage by positions in space and distances."""
    p, q = sp.symbols("p_x p_y p_z", real=True), sp.symbols("q_x q_y q_z", real=True)
    ends = [((*p,), (0, 0, 0), length), ((*p,), (*q,), d), ((*q,), (d, 0, 0), length)]
    rods = [sum((a - b) ** 2 for a, b in zip(*pair, strict=True)) - r**2 for *pair, r in ends]
    return System("loop", "A loop in space", [Coordinate(s, "m", str(s)) for s in (*p, *q)],
        PARAMETERS, [PointMass(m, p), PointMass(m, q)],
        constraints=[*rods, p[1], q[1], p[1] - 2 * q[1]])  # fmt: skip


def ring_of_links(n: int, *, relative: bool) -> System:
    """Links from the origin back to it, with a mass at each joint."""
    q = sp.symbols(f"q1:{n + 1}", real=True)
    angles = [sum(q[: k + 1]) for k in range(n)] if relative else q
    ends = [
        [sum(at(angle)[axis] for angle in angles[:k]) for axis in (0, 1)] for k in range(1, n + 1)
    ]
    return System("links", "A ring of links", [Coordinate(s, "rad", "") for s in q], PARAMETERS,
        [PointMass(m, end) for end in ends], coincide=[(ends[-1], (0, 0))])  # fmt: skip


def ring_of_masses(n: int, rod: float | sp.Expr) -> System:
    """Masses in the plane, joined by rods; the radius of the earth is no size of theirs."""
    points = [sp.symbols(f"x{k} y{k}", real=True) for k in range(n)]
    rods = [(a - c) ** 2 + (b - d) ** 2 - sp.sympify(rod) ** 2
            for (a, b), (c, d) in pairwise([*points, points[0]])]  # fmt: skip
    earth = Parameter(sp.Symbol("R", positive=True), "m", 6.4e6, "radius of the earth")
    coordinates = [Coordinate(s, "m", "") for point in points for s in point]
    return System("masses", "A ring of masses", coordinates, [*PARAMETERS, earth],
        [PointMass(m, point) for point in points], constraints=rods)  # fmt: skip


def names(system: System) -> tuple[list[str], list[str]]:
    """Names of the constraints that remain, and of those left out."""
    derivation = Derivation(system)
    return [one.name for one in derivation.system.conditions], [
        one.name for one in derivation.redundant
    ]


CIRCLE = x**2 + y**2 - length**2


@pytest.mark.parametrize(("system", "left_out"), [
    (in_plane(CIRCLE, 3 * CIRCLE), ["lambda_2"]),
    (in_plane(CIRCLE, sp.sqrt(x**2 + y**2) - length), ["lambda_2"]),
    (in_plane(x - y, x + y - d, x - 2 * y + d / 2), ["lambda_3"]),
    (in_plane(x - TIME, 2 * x - 2 * TIME), ["lambda_2"]),
    (in_plane(velocity(x) - velocity(y), x - y), ["lambda_1"]),  # that of velocities follows
    (in_plane(x - y, (x - y) ** 2), ["lambda_2"]),
    (parallelogram(), ["pin_2_y"]),
    (locked(), ["lambda_2"]),
    (loop_in_space(), ["lambda_6"]),
])  # fmt: skip
def test_redundant_constraints_are_left_out(system: System, left_out: list[str]) -> None:
    every = [one.name for one in system.conditions]
    with pytest.warns(RedundancyWarning, match=f"left out: {', '.join(left_out)}; they follow"):
        kept, redundant = names(system)
    assert redundant == left_out
    assert kept == [name for name in every if name not in left_out]


def test_the_warning_of_redundancy_is_of_the_line_that_derives() -> None:
    system = in_plane(CIRCLE, 3 * CIRCLE)
    with pytest.warns(RedundancyWarning) as caught:
        Derivation(system)
    assert [one.filename for one in caught] == [__file__]


@pytest.mark.parametrize("system", [
    in_plane(CIRCLE),
    in_plane(x - sp.sin(TIME)),
    in_plane(x - d, y - length),
    in_plane(x - y, velocity(x) + velocity(y) - 1),
    in_plane(velocity(x) - y * velocity(y)),
])  # fmt: skip
def test_independent_constraints_remain(system: System) -> None:
    assert names(system) == ([one.name for one in system.conditions], [])


@pytest.mark.long("more cases of the same kind", keep=2, daily=10)
@pytest.mark.parametrize(("system", "freedom"), [
    *((ring_of_links(n, relative=relative), n - 2)
      for relative in (False, True) for n in (4, 5, 6, 8)),
    *((ring_of_masses(n, rod), n) for rod in (length, 20.0, 0.01) for n in (3, 4, 5, 6)),
])  # fmt: skip
def test_rings_keep_all_constraints_and_move(system: System, freedom: int) -> None:
    assert Derivation(system).degrees_of_freedom == freedom
    module, rng = build(system), np.random.default_rng(3)
    turns = 2 * np.pi * np.arange(len(system.masses)) / len(system.masses)
    if system.name == "links":  # a regular polygon, up to an angle of each link
        place = rng.normal(scale=0.05, size=len(turns)) + turns
        if system.masses[-1].position[0].has(sum(system.q)):
            place = np.diff(place, prepend=0.0)
    else:
        size = float(sp.sqrt(-system.conditions[0].formula.subs(dict.fromkeys(system.q, 0))
            .subs(length, 0.5))) / 2 / np.sin(np.pi / len(turns))  # fmt: skip
        place = size * np.ravel([np.cos(turns), np.sin(turns)], "F")
    y0 = np.concatenate([place, 0.1 * rng.normal(size=len(place))])
    for _ in range(9):
        y0 = y0 + module.correction(0.0, y0, module.DEFAULTS)
    motion = integrate(module, (0, 1), y0, module.DEFAULTS, **OPTIONS)
    energies = module.energy_many(motion.t, motion.y, module.DEFAULTS)
    assert np.ptp(energies) < 1e-8 * np.abs(energies).max()
    residuals = module.constraints_many(motion.t, motion.y, module.DEFAULTS)
    assert np.abs(residuals).max() < 1e-8


@pytest.mark.parametrize(("system", "message"), [
    (in_plane(CIRCLE, x**2 + y**2 - d**2), r"no configuration .* residual is lambda_\d = "),
    (in_plane(x**2 + y**2 + d**2), r"no configuration .* residual is lambda_1 = 1.44"),
    (in_plane(sp.sqrt(-d - x**2)), "no configuration"),
    (in_plane(x - d, x - length), "no configuration"),
    (in_plane(x - TIME, x - 2 * TIME), "lambda_2 .* does not follow from them"),
    (in_plane(velocity(x) - 1, velocity(x) - 2), "lambda_2 .* does not follow from them"),
    (in_plane((x - y) ** 2), "lambda_1 .* the gradient of a formula is 0"),
    (in_plane(CIRCLE, (x - d) ** 2 + y**2 - (d - length) ** 2), "rods that are just long enough"),
])  # fmt: skip
def test_contradictory_and_singular_constraints_are_refused(system: System, message: str) -> None:
    with pytest.raises(SystemDefinitionError, match=message) as refusal:
        Derivation(system)
    assert "change" in str(refusal.value)


def test_components_in_which_points_agree_are_no_constraints() -> None:
    pair = ((x, y, 0), (length * sp.cos(theta1), length * sp.sin(theta1), 0))
    coordinates = [Coordinate(x, "m", "x"), Coordinate(y, "m", "y"), Coordinate(theta1, "rad", "q")]
    planar = System("planar", "A planar loop in space", coordinates, PARAMETERS,
        [PointMass(m, (x, 0, y))], coincide=[pair])  # fmt: skip
    assert [one.name for one in planar.conditions] == ["pin_1_x", "pin_1_y"]


@pytest.mark.long("other tests reach its code")
@pytest.mark.filterwarnings("ignore:constraints of system 'parallelogram'")
def test_a_bar_on_three_cranks_moves_as_a_pendulum() -> None:
    module = build(parallelogram())
    assert "pin_2_y, left out" in module.__doc__
    assert module.MULTIPLIERS == ("pin_1_x", "pin_1_y", "pin_2_x")
    start = (-1.0, -1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    motion = integrate(module, (0, 1), start, module.DEFAULTS, **OPTIONS)
    # oracle: all masses move alike, on circles of the cranks' length
    turned = integrate(single, (0, 1), (np.pi / 2 - 1, 0.0), single.params(l=0.5), **OPTIONS)
    assert motion.y[0, -1] == pytest.approx(turned.y[0, -1] - np.pi / 2, abs=1e-10)
    assert np.ptp(motion.y[:3], axis=0).max() < 1e-12
    left_out = [module.redundant_constraints(0.0, y, module.DEFAULTS)[0] for y in motion.y.T]
    assert np.abs(left_out).max() < 1e-12
    others = module.params(l=0.6)
    assert module.redundant_constraints(0.0, start, others)[0] == pytest.approx(0.0)


def test_equations_with_a_redundant_row_have_no_solution(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        derive.mechanics.constraints.redundancy,
        "independent",
        lambda equations: (equations.system.conditions, ()),
    )
    with pytest.raises(ZeroDivisionError):
        write(in_plane(CIRCLE, 3 * CIRCLE), tmp_path)


def test_numpy_is_loaded_for_constraints_alone() -> None:
    code = (
        "import sys; from derive import Derivation, load; d = Derivation(load('double_pendulum'));"
        "d.accelerations; print('numpy' in sys.modules)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == "False\n"
