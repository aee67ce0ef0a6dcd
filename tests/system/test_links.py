"""Links: parts of pictures between points, from the system to the module and its pictures."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from sympy import cos, pi, sin, symbols, sympify

from derive import (
    TIME,
    Block,
    Box,
    Cart,
    Coordinate,
    Derivation,
    Input,
    Parameter,
    Plate,
    PointMass,
    Rail,
    RigidBody,
    Rod,
    Spring,
    System,
    Thread,
    Wheel,
    load,
    rotations,
    with_inputs,
)
from derive.codegen.module_files import texts
from derive.system.line_links import Link
from derive.system.parts import SystemDefinitionError
from solvers import Scene, build, run_scene
from solvers.equations.module import links
from solvers.player.motion_plots import figure, outline
from solvers.player.sampled_motion import tracks
from solvers.scenes.scene_output import together

x, theta, s = symbols("x theta s", real=True)
l, m, g = symbols("l m g", positive=True)  # noqa: E741
BOB = (x + l * sin(theta), -l * cos(theta))


def cart(*joined: Link, **others: object) -> System:
    """A body on a cart."""
    return System(
        "linked_cart", "A body on a cart",
        [Coordinate(x, "m", "position"), Coordinate(theta, "rad", "angle")],
        [Parameter(m, "kg", 1.0, "mass"), Parameter(l, "m", 2.0, "length"),
         Parameter(g, "m/s^2", 9.81, "gravity")],
        [PointMass(m, (x, 0)), RigidBody(m, BOB, m * l**2 / 12, theta)],
        links=joined, **others,
    )  # fmt: skip


def shape(link: Link, values: dict[object, float]) -> np.ndarray:
    (_, points), *_ = cart(link).shapes
    return np.array([[float(r.subs(values)) for r in point] for point in points])


def test_a_module_has_the_points_that_links_join() -> None:
    everything = [Cart(0, l / 4, l / 8), Rail((0, 0), (1, 0)), Rod(0, 1), Spring((0, 0), 0)]
    everything += [Thread((0, 0), 1), Plate(0, 1, (0, l * TIME)), Wheel(1, l / 4), Block(1, l, 1)]
    module = build(cart(*everything))
    y, params = [0.3, 0.7, 0.1, 0.2], [1.0, 2.0, 9.81]
    points = np.array(module.points(1.5, y, params))
    bob = [0.3 + 2 * np.sin(0.7), -2 * np.cos(0.7)]
    found = {kind: points[list(numbers)] for kind, numbers in links(module)}
    assert_allclose(found["rod"], [[0.3, 0], bob])
    assert_allclose(found["spring"], [[0, 0], [0.3, 0]])
    assert_allclose(found["thread"], [[0, 0], bob])
    assert_allclose(found["rail"], [[0, 0], [1, 0]])
    c, s = np.cos(0.7), np.sin(0.7)
    wheel = found["wheel"] - bob  # with a spoke at the angle of the body
    assert_allclose(wheel, [[0, 0], [c / 2, s / 2], [-s / 2, c / 2]])
    plates = [points[list(numbers)] for kind, numbers in links(module) if kind == "plate"]
    assert_allclose(plates[0], [[0.05, -0.125], [0.55, -0.125], [0.55, 0.125], [0.05, 0.125]])
    assert_allclose(plates[1][2], [0, 3])
    assert_allclose(np.linalg.norm(plates[2][1] - plates[2][0]), 2)
    assert [kind for kind, _ in links(module)].count("ring") == 2  # of the cart
    assert "points" in module.TIMED
    many = module.points_many(0.0, np.tile(np.reshape(y, (4, 1)), 3), params)
    assert many.shape == (len(points), 2, 3)


def test_the_ground_is_the_height_of_a_cart_below_its_centre() -> None:
    (_, box), *wheels = cart(Cart((0, 0), 4, 2)).shapes
    assert box == ((-2, -1), (2, -1), (2, 1), (-2, 1))
    for _, (centre, rim, _) in wheels:
        radius = rim[0] - centre[0]
        assert centre[1] + radius == -1  # touches the box
        assert centre[1] - radius == -2


def test_angles_turn_wheels_and_blocks() -> None:
    assert_allclose(shape(Wheel((1, 2), 3), {}), [[1, 2], [4, 2], [1, 5]])
    assert_allclose(shape(Wheel((1, 2), 3, pi / 2), {}), [[1, 2], [1, 5], [-2, 2]])
    corners = shape(Block(1, 4, 2), {x: 0, theta: 0, l: 1})
    assert_allclose(corners, [[-2, -2], [2, -2], [2, 0], [-2, 0]])
    turned = shape(Block((0, 0), 4, 2, pi / 2), {})
    assert_allclose(turned, [[1, -2], [1, 2], [-1, 2], [-1, -2]])


def test_links_of_a_body_in_space_turn_with_it() -> None:
    phi = symbols("phi", real=True)
    body = RigidBody(m, (x, 0, 0), (m, m, m), rotations("zx", (phi, theta)))

    def points(link: Link) -> list[np.ndarray]:
        values = {x: 2.0, phi: 0.3, theta: 0.5}
        shapes = link.shapes([body, PointMass(m, (0, 0, 0))])
        return [
            np.array([[float(sympify(r).subs(values)) for r in point] for point in corners])
            for _, corners in shapes
        ]

    axes = np.array(rotations("zx", (phi, theta)).matrix.subs({phi: 0.3, theta: 0.5}), dtype=float)
    centre = np.array([2.0, 0, 0])
    (wheel,) = points(Wheel(0, 3))
    assert_allclose(wheel, [centre, centre + 3 * axes[:, 0], centre + 3 * axes[:, 1]])
    (turned,) = points(Wheel(0, 1, pi / 2))
    assert_allclose(turned[1], centre + axes[:, 1], atol=1e-12)
    (upright,) = points(Wheel(1, 3))  # about a mass without an orientation
    assert_allclose(upright, [[0, 0, 0], [3, 0, 0], [0, 0, 3]])
    faces = points(Box(0, 6, 4, 2))
    assert len(faces) == 6
    corners = (np.concatenate(faces) - centre) @ axes  # in body axes
    assert_allclose(np.abs(corners), np.tile([3, 2, 1], (24, 1)))
    assert len({tuple(np.round(corner)) for corner in corners}) == 8
    for face in faces:  # flat, with right angles
        assert_allclose((face[1] - face[0]) @ (face[2] - face[1]), 0, atol=1e-12)
        assert_allclose(face[0] + face[2], face[1] + face[3], atol=1e-12)
    with pytest.raises(SystemDefinitionError, match=r"Box is one in space: .* give a Block"):
        cart(Box(0, 1, 1, 1))


def test_a_system_without_links_has_no_points() -> None:
    text = texts(Derivation(cart()))["linked_cart.py"]
    assert "LINKS" not in text
    assert "def points" not in text
    # a specialised module has functions of the motion alone
    assert "LINKS" not in texts(Derivation(cart(Rod(0, 1))), ["rhs"])["linked_cart.py"]


def test_links_follow_substituted_and_prescribed_inputs() -> None:
    pivot = System(
        "pivot", "", [Coordinate(theta, "rad", "")],
        [Parameter(m, "kg", 1.0, ""), Parameter(l, "m", 1.0, ""),
         Parameter(g, "m/s^2", 9.81, "")],
        [PointMass(m, (s + l * sin(theta), -l * cos(theta)))],
        inputs=[Input(s, "m", "pivot", motion=True)], links=[Rod((s, 0), 0), Wheel((s, 0), 1)],
    )  # fmt: skip
    moving = build(pivot).points(2.0, (0.0, 0.0), (1, 1, 9.81, 0.5, 3.0, 0.0, 1.0))
    assert moving[0] == pytest.approx((3.5, 0))
    (_, (start, _)), (_, (centre, _, _)) = with_inputs(pivot, {"s": "sin(t)"}).shapes
    assert start == centre == (sin(TIME), 0)


def test_a_file_states_links(tmp_path: Path) -> None:
    path = tmp_path / "linked.toml"
    path.write_text("""
title = "Linked"
potential = 0
[coordinates]
x = { unit = "m" }
alpha = { unit = "rad" }
[parameters]
R = { value = 1, unit = "m" }
[[masses]]
mass = 1
position = ["x", "R"]
inertia = 1
angle = "alpha"
[[links]]
wheel = 0
radius = "R"
angle = "-x/R"
[[links]]
rail = [["0", "0"], [1, 0]]
[[links]]
cart = ["x", "0"]
width = 1
height = "R/2"
""")
    wheel, rail, box = load(path).links
    place, R = load(path).q[0], load(path).params[0]
    assert wheel == Wheel(0, R, -place / R)
    assert rail == Rail((0, 0), (1, 0))
    assert box == Cart((place, 0), 1, R / 2)


@pytest.mark.parametrize(
    ("links_text", "words"),
    [
        ("rod = [0]", "Rod has 1 points: give 2"),
        ("rod = [0, 1]", "mass 1: masses are numbered from 0 to 0"),
        ("rod = 0", "rod = 0 in links 1 must be a list of points"),
        ('rod = [0, "x"]', "Rod contains 'x': give the number of a mass"),
        ('rod = [0, ["x"]]', "a point of 1 components: give 2"),
        ('rod = [0, ["q", 0]]', "links 1: .*q"),
        ("rod = [0, [0, 0]]\nradius = 1", "a rod has no radius"),
        ("radius = 1", "must have one of the keys rod, thread"),
        ("wheel = 0", "links 1: a wheel needs radius; its keys are wheel, radius, angle"),
        ("wheel = 0\nradius = 1\nplane = [[1, 0, 0], [0, 1, 0]]", "plane of 3 and 3 components"),
        ("wheels = 0", "unknown key 'wheels'.*wheel"),
        ('rod = [0, ["x_dot", 0]]', "links depends on x_dot"),
    ],
)
def test_wrong_links_are_refused(links_text: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "wrong.toml"
    start = 'potential = 0\n[coordinates]\nx = { unit = "m" }\n[[masses]]\nmass = 1\n'
    path.write_text(f'{start}position = ["x", 0]\n[[links]]\n{links_text}\n')
    with pytest.raises(SystemDefinitionError, match=words):
        load(path)


def test_links_of_other_types_are_refused() -> None:
    with pytest.raises(SystemDefinitionError, match="links contains 'rod': give a list of Link"):
        cart("rod")  # type: ignore[arg-type]
    with pytest.raises(SystemDefinitionError, match="plane has 1 vectors"):
        Wheel(0, 1, plane=((1, 0),))  # type: ignore[arg-type]


def test_outlines_are_lines_in_the_plane_of_view() -> None:
    corners = np.array([[0.0, 0], [1, 0], [1, 1]])
    assert_allclose(outline("rod", corners, 1), corners)
    assert_allclose(outline("plate", corners, 1), [*corners, corners[0]])
    # a circle from an oblique direction: conjugate radii of an ellipse
    centre, first, second = (np.array(p) for p in ([1.0, 2], [3.0, 2], [1.5, 3]))
    ring = outline("ring", np.stack([centre, first, second]), 1) - centre
    inverse = np.linalg.inv(np.transpose([first - centre, second - centre]))
    assert_allclose(np.linalg.norm(ring @ inverse.T, axis=1), 1)
    assert_allclose(outline("wheel", np.stack([centre, first, second]), 1)[:2], [centre, first])
    spring = outline("spring", np.array([[0.0, 0], [3, 4]]), 5)
    assert_allclose([spring[0], spring[-1]], [[0, 0], [3, 4]])
    across = spring @ [-0.8, 0.6]
    assert np.abs(across).max() == pytest.approx(0.1)
    teeth = across[2:-2]  # to both sides in turn, ever further along the spring
    assert (teeth[1:] * teeth[:-1] < 0).all()
    assert (np.diff(spring @ [0.6, 0.8]) > 0).all()
    moved = outline("spring", np.array([[1.0, -2], [4, 2]]), 5)
    assert_allclose(moved, spring + np.array([1, -2]))
    start, end = outline("rail", np.array([[0.0, 1], [2, 1]]), 3)
    assert start[1] == end[1] == 1
    assert end[0] - start[0] > 100


def test_a_closed_linkage_and_its_rail_are_drawn() -> None:
    theta1, theta2, theta3 = symbols("theta1:4", real=True)
    a = (cos(theta1) / 2, sin(theta1) / 2)
    end = (a[0] + cos(theta2), a[1] + sin(theta2))
    b = (1 + cos(theta3), sin(theta3))
    system = System(
        "bars", "Bars", [Coordinate(q, "rad", "") for q in (theta1, theta2, theta3)], [],
        [PointMass(1, a), PointMass(1, end), PointMass(1, b)], potential=0, coincide=[(end, b)],
        links=[Rod((0, 0), 0), Rod(0, 1), Rod(2, (1, 0)), Rail((0, 0), (1, 0))],
    )  # fmt: skip
    module = build(system)
    # the crank is upright, so that both other bars start at the same angle to their line
    half = np.hypot(1, 0.5) / 2
    up, line = np.arccos(half), np.arctan2(-0.5, 1)
    start = (np.pi / 2, line + up, np.pi + line - up, 1.0)
    rates = np.linalg.lstsq(*_closing(module, start), rcond=None)[0]
    scene = Scene(module, (), (*start[:3], *rates), 1.0, model="full", samples=21)
    result = run_scene(scene)
    (track,) = tracks(together([result]))
    assert track.links == (("rod", (3, 0)), ("rod", (0, 1)), ("rod", (2, 4)), ("rail", (3, 4)))
    assert track.points[1].tolist() == [[1.0] * 21, [0.0] * 21]
    ends = track.positions[1] - track.positions[0]
    assert_allclose(np.linalg.norm(ends, axis=0), 1, atol=1e-9)
    assert_allclose(track.positions[1], track.positions[2], atol=1e-9)  # no gap in the loop
    panels = {panel.get_ylabel(): panel for panel in figure(together([result])).axes}
    path = panels["y / m"]
    assert np.ptp(path.get_ylim()) < 5  # the rail does not stretch it
    assert len(path.lines) == 2 * 3 + 3 + 1  # paths with their ends, rods, the rail


def _closing(module: object, start: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Linear equations of velocities: the loop stays closed, and the crank has its velocity."""
    rates = [module.constraints(0.0, (*start[:3], *e), ())[2:] for e in np.eye(3)]  # type: ignore[attr-defined]
    return np.vstack([np.transpose(rates), [1, 0, 0]]), np.array([0, 0, start[3]])
