r"""Whipple's bicycle: a frame with its rider, a fork that steers, and two wheels that roll.

       |_        psi: heading; phi: lean to the right; theta: pitch; delta: steering to the left
    ___/ \       chi, omega: turns of the wheels; (x, y): point of contact of the rear wheel
   (o)__(o)      x is forward, y to the left, z upwards
                 J. P. Meijaard et al., Proceedings of the Royal Society A 463 (2007) 1955
"""
from collections.abc import Sequence
from operator import add

from sympy import Expr, cos, pi, sin, symbols

from derive import (
    Coordinate,
    Orientation,
    Parameter,
    RigidBody,
    Rod,
    System,
    Wheel,
    rolling_on_plane,
    rotations,
)

x, y, psi, phi, theta, delta, chi, omega = q = symbols(
    "x y psi phi theta delta chi omega", real=True)
g, (w, c) = symbols("g", real=True), symbols("w c", positive=True)
tilt, r, R = pi / 10, 0.3, 0.35  # of the steering axis, from the vertical; radii of the wheels

def at(point: Sequence[Expr], axes: Orientation, *arm: Expr) -> tuple[Expr, ...]:
    """The end of an arm in body axes."""
    return tuple(map(add, point, axes.turned(arm)))

plane, frame = rotations("zx", (psi, phi)), rotations("zxy", (psi, phi, theta))
fork = rotations("zxyzy", (psi, phi, theta - tilt, delta, tilt))
behind = rotations("zxy", (psi, phi, chi))
ahead = rotations("zxyzy", (psi, phi, theta - tilt, delta, omega))
rear = at((x, y, 0), plane, 0, 0, r)
rider, foot = at(rear, frame, 0.3, 0, 0.6), at(rear, frame, w + c, 0, -r)  # foot: steering axis
front, bar = at(foot, fork, -c, 0, R), at(foot, fork, 0.9 - w - c, 0, 0.7)  # on the road
head, *grips = (at(foot, fork, -k * sin(tilt), side, k * cos(tilt))
                for k, side in ((0.7, 0), (1, 0), (1, 0.25), (1, -0.25)))
system = System(
    name="bicycle", title="Whipple's bicycle: two wheels that roll, a frame and a fork",
    coordinates=[Coordinate(x, "m", "rear contact"), Coordinate(y, "m", "the same, to the left"),
        Coordinate(psi, "rad", "heading"), Coordinate(phi, "rad", "lean to the right"),
        Coordinate(theta, "rad", "pitch of the frame"), Coordinate(delta, "rad", "steering angle"),
        Coordinate(chi, "rad", "rear wheel"), Coordinate(omega, "rad", "front wheel")],
    parameters=[Parameter(w, "m", 1.02, "wheel base"), Parameter(c, "m", 0.08, "trail"),
                Parameter(g, "m/s^2", 9.81, "gravitational acceleration")],
    masses=[RigidBody(85, rider, [[9.2, 0, -2.4], [0, 11, 0], [-2.4, 0, 2.8]], frame),
            RigidBody(4, bar, [[0.05892, 0, 0.00756], [0, 0.06, 0], [0.00756, 0, 0.00708]], fork),
            RigidBody(2, rear, (0.0603, 0.12, 0.0603), behind),
            RigidBody(3, front, (0.1405, 0.28, 0.1405), ahead)],
    constraints=[*rolling_on_plane("rear", q, rear, r, behind, "y"),
                 *rolling_on_plane("front", q, front, R, ahead, "y")],
    links=[Rod(2, 0, head), Rod(2, head), Rod(3, head, grips[0]), Rod(*grips[1:]),
           *(Wheel(k, size, plane=(axes.turned((1, 0, 0)), axes.turned((0, 0, 1))))
             for k, size, axes in ((2, r, behind), (3, R, ahead)))])

PUBLISHED = r'''
source = "J. P. Meijaard et al., Proceedings of the Royal Society A 463 (2007) 1955, table 1"
note = "Heights of the bodies of table 1, by rotations about x, y and the steering axis."
potential_energy = """g*(2*r*cos(phi) + 85*(r*cos(phi) + 3/10*n + 3/5*v) \
+ 4*(r*cos(phi) + (w + c)*n - r*v + (9/10 - w - c)*(f*cos(pi/10) - h*sin(pi/10)) \
+ 7/10*(f*sin(pi/10) + h*cos(pi/10))) + 3*(r*cos(phi) + (w + c)*n - r*v \
- c*(f*cos(pi/10) - h*sin(pi/10)) + 7/20*(f*sin(pi/10) + h*cos(pi/10))))"""

[names]
r = "3/10"
n = "-sin(theta)*cos(phi)"
v = "cos(theta)*cos(phi)"
f = "sin(phi)*sin(delta) - sin(theta - pi/10)*cos(phi)*cos(delta)"
h = "cos(theta - pi/10)*cos(phi)"
'''
