"""Joints: constraints whose multipliers are forces of the joints, by laws of single bodies."""

from collections.abc import Callable
from dataclasses import replace
from math import cos, sin
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from constrained_systems import bars

from derive import (
    Constraint,
    Coordinate,
    Parameter,
    PointMass,
    RigidBody,
    System,
    ball,
    fixed_distance,
    hinge,
    pin,
    prismatic,
    rolling_on_line,
    rolling_on_plane,
    rotations,
    slider,
    velocity,
)
from derive import load as load_system
from derive.system.parts import SystemDefinitionError
from holonomic import build, load

x, y, z, phi, psi, theta, g, alpha = sp.symbols("x y z phi psi theta g alpha", real=True)
m, length, R = sp.symbols("m l R", positive=True)
PARAMETERS = [Parameter(m, "kg", 1.5, "mass"), Parameter(length, "m", 0.8, "length"),
    Parameter(R, "m", 0.3, "radius"), Parameter(alpha, "rad", 0.4, "slope"),
    Parameter(g, "m/s^2", 9.81, "gravity")]  # fmt: skip
X, Y = Coordinate(x, "m", "to the right"), Coordinate(y, "m", "upwards")
PHI = Coordinate(phi, "rad", "of the body")
DOWNHILL = (sp.cos(alpha), -sp.sin(alpha))


def test_pinned_bars_are_the_double_bar_pendulum() -> None:
    pinned, hand = build(bars()), load("double_bar_pendulum")
    assert pinned.STATE == hand.STATE
    for name in ("rhs", "rhs_rational", "energy", "jacobian"):
        assert pinned.OPERATIONS[name] == hand.OPERATIONS[name]
    states = np.random.default_rng(1).uniform(-2, 2, (4, 9))
    for name in ("rhs_many", "energy_many"):
        values = (getattr(one, name)(0.0, states, one.DEFAULTS) for one in (pinned, hand))
        assert np.array_equal(*values)


@pytest.mark.parametrize("keep", [False, True])
def test_forces_of_pins_accelerate_each_bar(keep: bool) -> None:
    # oracle: Newton's and Euler's law of the lower bar, on which B alone acts besides weight
    module = build(replace(bars(), keep_coordinates=True))
    less = build(bars())
    z = np.array([0.4, -1.1, 0.7, 2.0])
    values = dict(zip(less.STATE, z, strict=True))
    values |= dict(zip(less.OUTPUTS, less.outputs(0.0, z, less.DEFAULTS), strict=True))
    state = [values[name] for name in module.STATE]
    rates = dict(zip(module.STATE, module.rhs(0.0, state, module.DEFAULTS), strict=True))
    one, at = (module, state) if keep else (less, z)
    forces = dict(zip(one.MULTIPLIERS, one.multipliers(0.0, at, one.DEFAULTS), strict=True))
    given = dict(zip(one.PARAMETERS, one.DEFAULTS, strict=True))
    mass, size = given["m2"], given["l2"]
    force = np.array([forces["B_x"], forces["B_y"]])
    moved = mass * np.array([rates["x2_dot"], rates["y2_dot"] + given["g"]])
    assert np.allclose(force, moved, rtol=1e-12)
    arm = size / 2 * np.array([-sin(z[1]), cos(z[1])])
    turned = mass * size**2 / 12 * rates["theta2_dot"]
    assert arm[0] * force[1] - arm[1] * force[0] == pytest.approx(turned, rel=1e-12)
    total = np.array([forces["A_x"], forces["A_y"]]) - force
    moved = given["m1"] * np.array([rates["x1_dot"], rates["y1_dot"] + given["g"]])
    assert np.allclose(total, moved, rtol=1e-12)


def wheel(constraints: list[Constraint]) -> System:
    """A uniform disc."""
    return System("wheel", "A disc", [X, Y, PHI], PARAMETERS,
        [RigidBody(m, (x, y), m * R**2 / 2, phi)], constraints=constraints)  # fmt: skip


@pytest.mark.parametrize("sign", [1, -1])
def test_a_disc_rolls_down_a_slope(sign: int) -> None:
    # oracle: a = (2/3) g sin(alpha), friction uphill a third of the weight's part
    slope = rolling_on_line("slope", (x, y), R, sign * phi, (0, 0), DOWNHILL)
    one = build(replace(wheel(slope), keep_coordinates=True))
    c, s, down, speed = cos(0.4), sin(0.4), 0.15, 0.6
    place = (down * c + 0.3 * s, -down * s + 0.3 * c)
    state = (*place, -sign * 0.5, speed * c, -speed * s, -sign * 2.0)
    assert np.allclose(one.constraints(0.0, state, one.DEFAULTS), 0, atol=1e-15)
    *_, ax, ay, turn = one.rhs(0.0, state, one.DEFAULTS)
    assert np.allclose([ax, ay], 2 / 3 * 9.81 * s * np.array([c, -s]), rtol=1e-12)
    assert turn == pytest.approx(-sign * 2 / 3 * 9.81 * s / 0.3, rel=1e-12)  # clockwise
    friction, normal = one.multipliers(0.0, state, one.DEFAULTS)
    assert friction == pytest.approx(-1.5 * 9.81 * s / 3, rel=1e-12)
    assert normal == pytest.approx(1.5 * 9.81 * c, rel=1e-12)


def test_a_disc_on_the_ground_has_one_coordinate() -> None:
    one = build(wheel(rolling_on_line("ground", (x, y), R, phi)))
    assert (one.COORDINATES, one.OUTPUTS[:2]) == (("phi",), ("x", "y"))
    assert one.outputs(0.0, (2.0, 1.0), one.DEFAULTS) == (-0.6, 0.3, -0.3, 0.0)


def test_the_force_of_a_slider_is_normal() -> None:
    rail = slider("rail", (x, y), (0, 1), DOWNHILL)
    bead = System("bead", "A bead", [X, Y], PARAMETERS, [PointMass(m, (x, y))], constraints=rail)
    one = build(bead)
    state = (0.5, 1 - 0.5 * np.tan(0.4), 1.0, -np.tan(0.4))
    assert np.allclose(one.constraints(0.0, state, one.DEFAULTS), 0, atol=1e-15)
    assert one.multipliers(0.0, state, one.DEFAULTS)[0] == pytest.approx(1.5 * 9.81 * cos(0.4))
    *_, ax, ay = one.rhs(0.0, state, one.DEFAULTS)
    assert np.allclose([ax, ay], 9.81 * sin(0.4) * np.array([cos(0.4), -sin(0.4)]))


def test_the_multiplier_of_a_distance_is_the_tension() -> None:
    rod = fixed_distance("rod", (x, y), (0, 0), length)
    one = build(System("swing", "S", [X, Y], PARAMETERS, [PointMass(m, (x, y))], constraints=rod))
    hand = load("single_pendulum")
    angle, rate = 0.6, 1.4
    state = 0.8 * np.array([sin(angle), -cos(angle), rate * cos(angle), rate * sin(angle)])
    expected = hand.reactions(0.0, (angle, rate), hand.params(m=1.5, l=0.8))
    assert one.multipliers(0.0, state, one.DEFAULTS) == pytest.approx(expected, rel=1e-12)


WHEELS = {
    "upright": ("zy", (psi, phi), "y"),
    "leaning": ("zxy", (psi, theta, phi), "y"),
    "steered": ("zxyzyx", (psi, theta, phi, 0.7, -0.4, phi), "x"),
    "sphere": ("zxy", (psi, theta, phi), ""),
}


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize("kind", WHEELS)
def test_the_point_of_contact_does_not_slip(kind: str) -> None:
    # oracle: differences of the position of the material point that touches the plane
    sequence, angles, axle = WHEELS[kind]
    q, axes = (x, y, z, psi, theta, phi), rotations(sequence, angles)
    joint = rolling_on_plane("ground", q, (x, y, z), R, axes, axle)
    rng = np.random.default_rng(3)
    at, rate, step = rng.uniform(-1, 1, 6), rng.normal(size=6), 1e-5

    def numbers(s: float) -> tuple[np.ndarray, np.ndarray]:
        known = dict(zip(q, at + s * rate, strict=True))
        return tuple(np.array(m.subs(known), float) for m in (sp.Matrix([x, y, z]), axes.matrix))

    before, now, after = map(numbers, (-step, 0.0, step))
    axis = now[1][:, "xyz".index(axle)] if axle else np.array([0.0, 1.0, 0.0])
    up = np.array([0, 0, 1.0])
    arm = np.array([0, 0, -1.0])
    arm += axis * axis[2]  # the lowest direction across the axle
    arm *= 0.3 / np.linalg.norm(arm)
    if axle:
        rim = [now[1] @ (np.cos(k) * u + np.sin(k) * v) for k in np.linspace(0, 6.3, 2000)
               for u, v in [np.delete(np.eye(3), "xyz".index(axle), axis=0)]]  # fmt: skip
        assert arm[2] == pytest.approx(0.3 * min(point[2] for point in rim), abs=1e-6)
    body = now[1].T @ arm  # the point in axes of the body
    moved = (after[0][:, 0] + after[1] @ body - before[0][:, 0] - before[1] @ body) / (2 * step)
    along = np.cross(axis, up) / np.linalg.norm(np.cross(axis, up))
    known = dict(zip((*q, *map(velocity, q)), (*at, *rate), strict=True)) | {R: 0.3}
    values = [float(one.formula.subs(known)) for one in joint]
    assert np.allclose(values[:2], [moved @ along, moved @ np.cross(up, along)], atol=1e-8)
    assert values[2] == pytest.approx(now[0][2, 0] + arm[2])
    assert [one.name for one in joint] == ["ground_along", "ground_across", "ground_normal"]


def test_a_sphere_rolls_without_an_axle() -> None:
    # upright, it turns about x, y and z of space at the rates of theta, phi and psi
    q, axes = (x, y, z, psi, theta, phi), rotations("zxy", (psi, theta, phi))
    joint = rolling_on_plane("ground", q, (x, y, z), R, axes)
    upright = [one.formula.subs({psi: 0, theta: 0, phi: 0}) for one in joint]
    across = velocity(y) + R * velocity(theta)
    assert upright == [velocity(x) - R * velocity(phi), across, z - R]


@pytest.mark.parametrize(("axle", "words"), [("w", "is 'w'"), ("z", "is vertical")])
def test_wheels_without_a_horizontal_axle_are_refused(axle: str, words: str) -> None:
    with pytest.raises(SystemDefinitionError, match=words):
        rolling_on_plane("A", (x, y, psi), (x, y, R), R, rotations("z", (psi,)), axle)


FILE = """
title = "Joints"
[coordinates]
x = { unit = "m" }
y = { unit = "m" }
z = { unit = "m" }
phi = {}
[parameters]
l = { value = 1, unit = "m" }
R = { value = 0.3, unit = "m" }
m = { value = 2, unit = "kg" }
g = { value = 9.81, unit = "m/s^2" }
[[masses]]
mass = "m"
position = POSITION
[[masses]]
mass = "m"
position = OTHER
[[joints]]
"""
SPIN = '{ rotations = "y", angles = ["phi"] }'
TURN = '{ rotations = "x", angles = ["y"] }'
IN_FILES = [
    ('pin = "A"\np = ["x", "y"]\nq = ["l*sin(phi)", 0]',
     pin("A", (x, y), (length * sp.sin(phi), 0))),
    ('ball = "A"\np = ["x", "y", "z"]\nq = [0, 0, "l"]', ball("A", (x, y, z), (0, 0, length))),
    ('slider = "A"\np = ["x", "y"]\nthrough = [0, 0]\ndirection = [1, 2]',
     slider("A", (x, y), (0, 0), (1, 2))),
    ('fixed_distance = "A"\np = ["x", "y"]\nq = [0, 0]\nlength = "l"',
     fixed_distance("A", (x, y), (0, 0), length)),
    ('rolling_on_line = "A"\ncentre = ["x", "y"]\nradius = "R"\nangle = "phi"',
     rolling_on_line("A", (x, y), R, phi)),
    (f'rolling_on_plane = "A"\ncentre = ["x", "y", "R"]\nradius = "R"\norientation = {SPIN}\n'
     'axle = "y"',
     rolling_on_plane("A", (x, y, z, phi), (x, y, R), R, rotations("y", [phi]), "y")),
    (f'hinge = "A"\np = ["x", "y", "z"]\nq = [0, 0, "l"]\nfirst = {SPIN}',
     hinge("A", (x, y, z), (0, 0, length), rotations("y", [phi]))),
    (f'prismatic = "A"\np = ["x", "y", "z"]\nq = [0, 0, 0]\nfirst = {TURN}\nsecond = {SPIN}\n'
     'axis = "x"', prismatic("A", (x, y, z), (0, 0, 0), rotations("x", [y]),
                             rotations("y", [phi]), "x")),
]  # fmt: skip


def file(tmp_path: Path, joint: str) -> Path:
    path, spatial = tmp_path / "jointed.toml", ("ball", "plane", "first")
    axes = 3 if any(word in joint for word in spatial) else 2
    positions = '["x", "y", "z"]', '["l*cos(phi)", "l*sin(phi)", "z"]'
    if axes == 2:
        positions = '["x", "y"]', '["l*cos(phi)", "z"]'
    text = FILE.replace("POSITION", positions[0]).replace("OTHER", positions[1])
    path.write_text(text + joint)
    return path


@pytest.mark.parametrize(("text", "joint"), IN_FILES)
def test_joints_in_files(text: str, joint: list[Constraint], tmp_path: Path) -> None:
    assert list(load_system(str(file(tmp_path, text))).conditions) == joint


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('p = ["x", "y"]', "must have one of the keys pin, ball"),
        ('pin = "A"\np = ["x", "y"]', "joints 1: a pin needs q"),
        ('pin = "A"\np = ["x", "y"]\nq = [0, 0]\nlength = 1', "a pin has no length; its keys"),
        ('pin = "A"\np = ["x"]\nq = [0, 0]', "a point of 1 components: give 2"),
        ('pin = "A"\np = "x"\nq = [0, 0]', "not a sequence"),
        ('slider = "x"\np = ["x", "y"]\nthrough = [0, 0]\ndirection = [1, 2]',
         "uses a name twice: x"),
        ('rolling_on_plane = "A"\ncentre = ["x", "y", "R"]\nradius = 1\norientation = [[1]]',
         "must be a table"),
        ('hinge = "A"\np = ["x", "y", "z"]\nq = [0, 0, 0]\nfirst = { matrix = [[1]] }',
         "has not three rows"),
        (f'hinge = "A"\np = ["x", "y", "z"]\nq = [0, 0, 0]\nfirst = {SPIN}\naxis = "w"',
         "axis of A is 'w'"),
        ('slider = "A"\np = ["x", "y"]\nthrough = [0, 0]\ndirection = [0, 0]',
         "direction of A is 0"),
        ('fixed_distance = "A"\np = ["x", "y"]\nq = [0, 0]\nlength = -1', "length of A is -1"),
    ],
)  # fmt: skip
def test_invalid_joints_are_refused(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(SystemDefinitionError, match=message):
        load_system(str(file(tmp_path, text)))


def test_joints_in_space_and_in_the_plane_differ() -> None:
    makes: list[Callable[[], object]] = [
        lambda: ball("A", (x, y), (0, 0)),
        lambda: pin("A", (x, y, z), (0, 0, 0)),
        lambda: rolling_on_plane("A", [x], (x, y, z), R, sp.eye(3)),
    ]
    for make in makes:
        with pytest.raises(SystemDefinitionError, match="give"):
            make()
