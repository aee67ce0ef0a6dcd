"""One point mass on a rigid massless rod in a vertical plane."""

from sympy import cos, sin, symbols

from derive.system import Coordinate, Parameter, PointMass, System

theta, g = symbols("theta g", real=True)
m, l = symbols("m l", positive=True)

system = System(
    name="single_pendulum",
    title="Single pendulum: a point mass on a rigid massless rod in a vertical plane",
    coordinates=[Coordinate(theta, "rad", "angle of the rod from the downward vertical")],
    parameters=[Parameter(m, "kg", 1.0, "mass of the bob"),
                Parameter(l, "m", 2.0, "length of the rod"),
                Parameter(g, "m/s^2", 9.81, "gravitational acceleration")],
    masses=[PointMass(m, (l * sin(theta), -l * cos(theta)))],
)
