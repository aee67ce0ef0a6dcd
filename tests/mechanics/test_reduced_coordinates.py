"""Fewest coordinates: reduced systems move as the full ones and as those written by hand."""

from collections.abc import Callable
from dataclasses import replace
from itertools import permutations
from math import cos, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy as sp

import derive.mechanics.reduced_coordinates as implementation
from derive import (
    TIME,
    Constraint,
    Coordinate,
    Derivation,
    Input,
    Parameter,
    PointMass,
    RigidBody,
    System,
    reduced,
    velocity,
)
from derive import load as load_system
from derive.codegen.function_specs import FORCES
from derive.codegen.module_files import texts
from derive.commands.regenerate import main
from derive.mechanics.derivation import RedundancyWarning
from derive.mechanics.equations import Equations
from derive.system.parts import SystemDefinitionError
from holonomic import build, integrate, load, load_scene, run_scene

x, y, s, theta, phi, g, F = sp.symbols("x y s theta phi g F", real=True)
m, a, b, c = sp.symbols("m a b c", positive=True)
u = sp.Symbol("u", positive=True)
KG, GRAVITY = Parameter(m, "kg", 1.5, "mass"), Parameter(g, "m/s^2", 9.81, "gravity")
LENGTHS = [Parameter(a, "m", 0.4, "crank"), Parameter(b, "m", 1.1, "rod")]
X, Y, S = (Coordinate(one, "m", f"length {one}") for one in (x, y, s))
THETA, PHI = (Coordinate(one, "rad", f"angle {one}") for one in (theta, phi))
U = Coordinate(u, "m", "length of the rod along the rail")
#: Functions that differ, or do not exist, where all coordinates are independent from the start.
OTHER = {
    "energy_rational",
    "outputs",
    "outputs_jacobian",
    "outputs_parameter_jacobian",
    "multipliers",
    "reactions",
    "points",
    *FORCES,
}
#: Functions of reduced and full systems that have the same values.
COMPARED = ("rhs", "multipliers", "energy", "positions")


def double_pendulum() -> System:
    """The shipped double pendulum from Cartesian coordinates and two pins."""
    names = "theta1 theta2 x1 y1 x2 y2 g"
    theta1, theta2, x1, y1, x2, y2, weight = sp.symbols(names, real=True)
    m1, m2, l1, l2 = sp.symbols("m1 m2 l1 l2", positive=True)
    angles = [Coordinate(q, "rad", "of a rod") for q in (theta1, theta2)]
    lengths = [Coordinate(q, "m", "of a mass") for q in (x1, y1, x2, y2)]
    defaults = {m1: 1.0, m2: 1.0, l1: 2.0, l2: 2.0, weight: 9.81}
    parameters = [Parameter(p, "1", value, "given") for p, value in defaults.items()]
    return System("pinned_pendulum", "Two pins", [*angles, *lengths], parameters,
        [PointMass(m1, (x1, y1)), PointMass(m2, (x2, y2))], coincide=[
        ((x1, y1), (l1 * sp.sin(theta1), -l1 * sp.cos(theta1))),
        ((x2, y2), (x1 + l2 * sp.sin(theta2), y1 - l2 * sp.cos(theta2)))])  # fmt: skip


def cart(n: int) -> System:
    """The shipped chain on a cart, from Cartesian coordinates of all masses."""
    q = [sp.Symbol("x", real=True), *sp.symbols(f"theta1:{n + 1}", real=True)]
    points = [(q[0], sp.S.Zero)]
    points += [sp.symbols(f"x{k} y{k}", real=True) for k in range(1, n + 1)]
    masses = sp.symbols(f"m0:{n + 1}", positive=True)
    rods = sp.symbols(f"l1:{n + 1}", positive=True)
    pins = [
        (end, (start[0] + rod * sp.sin(angle), start[1] - rod * sp.cos(angle)))
        for start, end, rod, angle in zip(points, points[1:], rods, q[1:], strict=False)
    ]
    free = [Coordinate(one, "m", "of a mass") for end in points[1:] for one in end]
    parameters = [Parameter(p, "1", 1.0, "given") for p in (*masses, *rods)]
    units = ["m", *["rad"] * n]
    coordinates = [Coordinate(one, unit, "kept") for one, unit in zip(q, units, strict=True)]
    return System("pinned_cart", "Pins", [*coordinates, *free], [*parameters, GRAVITY],
        [PointMass(*one) for one in zip(masses, points, strict=True)], coincide=pins)  # fmt: skip


def crank(**changes: object) -> System:
    """A slider-crank in all coordinates; the closing condition across the rail has two branches."""
    joint = (a * sp.cos(theta), a * sp.sin(theta))
    end = (joint[0] + b * sp.cos(phi), joint[1] + b * sp.sin(phi))
    centre = (joint[0] + b * sp.cos(phi) / 2, joint[1] + b * sp.sin(phi) / 2)
    slider, rod = PointMass(m, (x, 0)), RigidBody(m, centre, m * b**2 / 12, phi)
    given: dict[str, object] = {"coincide": [(end, (x, 0))]} | changes
    return System("crank", "Slider-crank", [THETA, PHI, X], [KG, *LENGTHS, GRAVITY],
        [slider, rod], **given)  # fmt: skip


def closed_crank() -> System:
    """The same with the rod's length along the rail, which is positive."""
    across = a * sp.sin(theta)
    constraints = [Constraint(x - a * sp.cos(theta) - u, "along", "N"),
        Constraint(u**2 + across**2 - b**2, "rod", "N/m")]  # fmt: skip
    middle = (a * sp.cos(theta) + u / 2, across / 2)
    rod = RigidBody(m, middle, m * b**2 / 12, -sp.atan(across / u))
    return System("closed_crank", "Slider-crank with a positive length", [THETA, X, U],
        [KG, *LENGTHS, GRAVITY], [PointMass(m, (x, 0)), rod], constraints=constraints)  # fmt: skip


def driven() -> System:
    """Friction, forces, an input and a prescribed motion act on eliminated coordinates."""
    pivot = Input(s, "m", "pivot", motion=True)
    vx, vy = velocity(x), velocity(y)
    return System("driven", "Driven pendulum", [X, Y, THETA], [KG, *LENGTHS, GRAVITY],
        [PointMass(m, (x, y))], dissipation=(vx**2 + 2 * vy**2) / 5, forces=(F, x * vy, 0),
        inputs=[Input(F, "N", "force"), pivot], outputs={"height": y + a},
        coincide=[((x, y), (s + a * sp.sin(theta), -a * sp.cos(theta)))])  # fmt: skip


def lifted() -> System:
    """The length of the rod depends on time; another coordinate is a function of time."""
    rod = a + sp.sin(TIME) / 5
    return System("lifted", "Growing pendulum", [X, Y, THETA, S], [KG, *LENGTHS, GRAVITY],
        [PointMass(m, (x, y)), PointMass(m, (x + s, y))], constraints=[s - TIME**2, a * x
        - a * rod * sp.sin(theta), y + rod * sp.cos(theta)])  # fmt: skip


def rolling() -> System:
    """A ratio of angles, and a velocity constraint, which remains."""
    constraints = [phi - theta * 3, velocity(y) * sp.cos(x / 3) - velocity(x) * sp.sin(x / 3)]
    masses = [PointMass(m, (x, y)), PointMass(m, (x + a * sp.sin(phi), y - b * sp.cos(theta)))]
    return System("rolling", "Gears", [THETA, PHI, X, Y], [KG, *LENGTHS, GRAVITY], masses,
        constraints=constraints)  # fmt: skip


def guided() -> System:
    """The constraint that remains depends on the eliminated coordinate."""
    return System("guided", "Guided", [X, Y, S], [KG, *LENGTHS, GRAVITY], [PointMass(m, (x, y)),
        PointMass(m, (s, x))], constraints=[s - 2 * x, s**2 + y**2 - b**2])  # fmt: skip


SYSTEMS = (guided, double_pendulum, closed_crank, crank, driven, lifted, rolling)


def differences(system: System) -> dict[str, float]:
    """Largest differences of the reduced system from the full one, at states of both."""
    less = functions(reduced(system))
    full = functions(replace(system, keep_coordinates=True))
    rng, found = np.random.default_rng(1), dict.fromkeys(COMPARED, 0.0)
    params = [*less["DEFAULTS"][: len(system.parameters)], *rng.uniform(0.3, 1, len(system.inputs))]
    for _ in range(3):
        z, t = rng.uniform(-1, 1, len(less["STATE"])), rng.uniform(0.2, 1)
        for _ in range(20 * ("correction" in less)):  # onto the remaining constraints
            z = z + less["correction"](t, z, params)
        values = dict(zip(less["STATE"], z, strict=True))
        values |= dict(zip(less["OUTPUTS"], less["outputs"](t, z, params), strict=True))
        state = [values[name] for name in full["STATE"]]
        pairs = ((less[name](t, z, params), full[name](t, state, params)) for name in COMPARED)
        results = dict(zip(COMPARED, pairs, strict=True))
        rates = dict(zip(full["STATE"], results["rhs"][1], strict=True))
        results["rhs"] = results["rhs"][0], [rates[name] for name in less["STATE"]]
        results["constraints"] = full["constraints"](t, state, params), 0.0
        positive = [values[name] for name in full["POSITIVE"] if name in values]
        results["signs"] = positive, np.abs(positive)
        for name, pair in results.items():
            found[name] = max(found.get(name, 0.0), np.abs(np.subtract(*pair)).max(initial=0.0))
    return found


def functions(system: System) -> dict[str, Any]:
    """The names of a module with few functions."""
    namespace: dict[str, Any] = {}
    names = (*COMPARED, "outputs", "constraints", "correction")
    exec(texts(Derivation(system), names)[f"{system.name}.py"], namespace)
    return namespace


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize(("make", "name"), [(double_pendulum, "double_pendulum"), *(
    (lambda n=n: cart(n), f"cart_{n}") for n in (1, 3))])  # fmt: skip
def test_pinned_systems_are_those_written_by_hand(make: Callable[[], System], name: str) -> None:
    less, hand = build(make()), load(name)
    assert less.STATE == hand.STATE
    shared = {*hand.OPERATIONS} - OTHER
    assert {*less.OPERATIONS} - OTHER == shared
    assert {k: less.OPERATIONS[k] for k in shared} == {k: hand.OPERATIONS[k] for k in shared}
    z, params = np.random.default_rng(4).uniform(-2, 2, (len(hand.STATE), 8)), hand.DEFAULTS
    for function in ("rhs", "energy", "mass_matrix", "positions", "jacobian"):
        many = f"{function}_many"
        same = getattr(less, many)(0.0, z, params), getattr(hand, many)(0.0, z, params)
        assert np.array_equal(*same)


@pytest.mark.long("more cases of the same kind", keep=3)
@pytest.mark.parametrize("make", SYSTEMS)
def test_reduced_motions_are_those_of_all_coordinates(make: Callable[[], System]) -> None:
    found = differences(make())
    if make in (lifted, driven):  # the energy is Jacobi's integral, without prescribed motions
        del found["energy"]
    assert max(found.values()) < 1e-12, found


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize("mistake", ["sign", "branch", "work", "forces"])
def test_mistakes_change_motions(mistake: str, monkeypatch: pytest.MonkeyPatch) -> None:
    make = {"branch": closed_crank, "forces": driven}.get(mistake, double_pendulum)
    if mistake == "sign":  # of an eliminated coordinate
        divided = implementation._divided
        monkeypatch.setattr(implementation, "_divided", lambda phi, q: _negative(divided(phi, q)))
    if mistake == "branch":  # the negative root
        root = implementation._root
        monkeypatch.setattr(implementation, "_root", lambda phi, q: _negative(root(phi, q)))
    if mistake == "work":  # multipliers without the inertia of eliminated coordinates
        monkeypatch.setattr(Equations, "euler_lagrange", property(lambda d: -d.forcing))
    if mistake == "forces":  # of coordinates that remain, alone
        monkeypatch.setattr(implementation._Reduction, "_force", lambda _, q: sp.S.Zero)
    assert max(differences(make()).values()) > 1e-2


def _negative(value: sp.Expr | None) -> sp.Expr | None:
    return None if value is None else -value


def test_a_constraint_is_eliminated_once(monkeypatch: pytest.MonkeyPatch) -> None:
    system = double_pendulum()
    eliminated = [one.constraint.name for one in reduced(system).eliminated]
    assert sorted(eliminated) == sorted(one.name for one in system.conditions)
    assert reduced(reduced(system)) == reduced(system)
    # a constraint that follows from others is omitted, one that contradicts them is refused
    first = system.conditions[0]
    again = replace(first, formula=2 * first.formula, name="again")
    with pytest.warns(RedundancyWarning, match="left out: again") as caught:
        assert reduced(replace(system, constraints=[*system.conditions, again])) == reduced(system)
    assert caught[0].filename == __file__
    other = again.with_formula(first.formula - 1)
    with pytest.raises(SystemDefinitionError, match=r"again .* contradicts pin_1_x, .* -1 = 0"):
        reduced(replace(system, constraints=[*system.conditions, other]))


@pytest.mark.parametrize(
    ("constraint", "formula"),
    [
        (x**2 + y**2 - a**2, None),
        (y - sp.sin(x), sp.sin(x)),
        (a * y - sp.sin(x), sp.sin(x) / a),
        ((a + b) * (y - x), x),
        ((a - b) * (y - x**2), None),  # a may be b
        (g * y - x**2, None),  # g may be 0
        (x * y - a, None),
        (sp.cos(y) * (1 + x**2) - x, None),
        (y + sp.sin(y) - x**2, None),
        (u**2 + x**2 - a**2, sp.sqrt(a**2 - x**2)),
        (u**2 + 2 * sp.sin(x) * u - a, sp.sqrt(a + sp.sin(x) ** 2) - sp.sin(x)),
        (u**2 - 4 * u + x**2, None),  # two positive roots
        (u**3 - x**2, None),
        (u * a - x**2, x**2 / a),
        (velocity(y) - velocity(x), None),
    ],
)
def test_no_branch_is_chosen(constraint: sp.Expr, formula: sp.Expr | None) -> None:
    last = U if u in constraint.free_symbols else Y
    system = System("s", "S", [X, last], [KG, *LENGTHS, GRAVITY],
        [PointMass(m, (x, last.symbol))], constraints=[constraint])  # fmt: skip
    found = reduced(system).eliminated
    assert Derivation(system).degrees_of_freedom == 1
    if formula is None:
        assert reduced(system) is system
    else:
        assert [one.coordinate for one in found] == [last]
        assert sp.simplify(found[0].formula - formula) == 0
        kept = replace(system, keep_coordinates=True)
        assert reduced(kept) is kept


FILE = """
title = "Slider-crank"
constraints = ["x - a*cos(theta) - u", "u**2 + (a*sin(theta))**2 - b**2"]
keep_coordinates = KEEP

[coordinates]
theta = { meaning = "angle of the crank" }
u = { unit = "m", positive = true }
x = { unit = "m", meaning = "position of the slider" }

[parameters]
a = { value = 0.1, unit = "m" }
b = { value = 0.3, unit = "m" }
m = { value = 2, unit = "kg" }
g = { value = 9.81, unit = "m/s^2" }

[[masses]]
mass = "m"
position = ["x", "0"]

[[masses]]
mass = "m"
position = ["a*cos(theta)", "a*sin(theta)"]
"""


@pytest.mark.parametrize("keep", [False, True])
def test_the_command_states_degrees_of_freedom(
    keep: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "crank.toml").write_text(FILE.replace("KEEP", str(keep).lower()))
    assert main([str(tmp_path / "crank.toml"), "--output", str(tmp_path)]) == 0
    text = f"{tmp_path}/crank.toml: 3 coordinates, 2 constraints, 1 degree of freedom"
    line = capsys.readouterr().out.splitlines()[0]
    assert line == (text if keep else f"{text}: u and x follow from theta")
    code = (tmp_path / "crank.py").read_text()
    assert ("u [m]: sqrt(" in code) == (not keep)
    assert ('COORDINATES = ("theta",)' in code) == (not keep)


@pytest.mark.long("other tests reach its code")
def test_a_mechanism_of_one_degree_of_freedom_is_a_quadrature(tmp_path: Path) -> None:
    (tmp_path / "crank.toml").write_text(FILE.replace("KEEP", "false"))
    (tmp_path / "scene.toml").write_text("""
title = "Slider-crank"
system = "crank.toml"
duration = "3 s"
accuracy = 1e-9
[initial]
theta = "1 rad"
""")
    scene = load_scene(tmp_path / "scene.toml")
    result = run_scene(scene)
    assert result.selection.model.name == "quadrature"
    # oracle: all coordinates and both constraints, by an integrator
    (tmp_path / "all.toml").write_text(FILE.replace("KEEP", "true"))
    module, along = load(str(tmp_path / "all.toml")), sqrt(0.09 - (0.1 * sin(1)) ** 2)
    start = (1.0, along, 0.1 * cos(1) + along, 0, 0, 0)
    motion = integrate(module, (0, 3), start, module.DEFAULTS, rtol=1e-13, atol=1e-13)
    assert np.abs(result.y[:, -1] - motion.y[[0, 3], -1]).max() < 1e-8


@pytest.mark.long("other tests reach its code")
def test_eliminated_coordinates_are_measured() -> None:
    pinned, hand = double_pendulum(), load_system("double_pendulum")
    for outputs in (["y2"], ["x1", "x2_dot"]):
        formulas = ["l1*sin(theta1)", "l1*cos(theta1)*theta1_dot + l2*cos(theta2)*theta2_dot"]
        expected = Derivation(hand).identifiable(outputs=formulas if len(outputs) > 1 else outputs)
        found = Derivation(reduced(pinned)).identifiable(outputs=outputs)
        assert str(found) == str(expected)
    with pytest.raises(SystemDefinitionError, match=r"Derivation\(derive.reduced\(system\)\)"):
        Derivation(pinned).identifiable(outputs=["x2"])


@pytest.mark.parametrize("make", [guided, lifted, closed_crank])
def test_constraints_keep_their_order(make: Callable[[], System]) -> None:
    for given in permutations(make().conditions):
        both = reduced(replace(make(), constraints=given)).all_conditions
        assert [one.name for one in both] == [one.name for one in given]


def test_formulas_with_other_functions_vanish_if_their_expansions_do() -> None:
    a, b = sp.symbols("a b", real=True)
    for formula in (sp.exp(a) * (b + 1) - sp.exp(a) * b - sp.exp(a), sp.sin(a) ** 2 - sp.S.One
                    + sp.cos(a) ** 2):  # fmt: skip
        assert implementation._vanishes(formula)
        assert not implementation._vanishes(formula + sp.exp(b))
        assert not implementation._vanishes(formula + 1)
