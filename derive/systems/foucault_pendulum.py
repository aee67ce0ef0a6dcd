r"""A pendulum on the turning Earth, seen from there.

    +             L. D. Landau, E. M. Lifshitz, Mechanics, § 39, problem 3
    |\ l
    | \     x east, y north;  the Earth turns at Ω, and g is what a plumb line at the pivot shows
        o m
"""
from sympy import cos, sin, sqrt, symbols

from derive import TIME, Coordinate, Parameter, PointMass, System

x, y, g, Omega, latitude = symbols("x y g Omega latitude", real=True)
m, l = symbols("m l", positive=True)
z, turned, c, s = -sqrt(l**2 - x**2 - y**2), Omega * TIME, cos(latitude), sin(latitude)
outward, axial = z * c - y * s, y * c + z * s
system = System(
    name="foucault_pendulum", title="Foucault's pendulum: on the turning Earth, seen from there",
    coordinates=[Coordinate(x, "m", "place to the east"), Coordinate(y, "m", "place to the north")],
    parameters=[Parameter(m, "kg", 28.0, "mass"), Parameter(l, "m", 67.0, "length"),
                Parameter(g, "m/s^2", 9.81, "gravity"), Parameter(Omega, "rad/s", 7.292e-5, "rate"),
                Parameter(latitude, "rad", 0.8527, "latitude")], potential=m * g * z,
    masses=[PointMass(m, (outward * cos(turned) - x * sin(turned),
                          outward * sin(turned) + x * cos(turned), axial))])
