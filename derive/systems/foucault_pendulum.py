r"""A pendulum on the rotating Earth, in the Earth's frame.

    +             L. D. Landau, E. M. Lifshitz, Mechanics, § 39, problem 3
    |\ l
    | \     x east, y north;  the Earth rotates at Ω; g is along the plumb line
        o m
"""
from sympy import cos, sin, sqrt, symbols

from derive import TIME, Coordinate, Parameter, PointMass, System

x, y, g, Omega, latitude = symbols("x y g Omega latitude", real=True)
m, l = symbols("m l", positive=True)
z, angle, c, s = -sqrt(l**2 - x**2 - y**2), Omega * TIME, cos(latitude), sin(latitude)
outward, axial = z * c - y * s, y * c + z * s
system = System(
    name="foucault_pendulum",
    title="Foucault's pendulum: on the rotating Earth, in the Earth's frame",
    coordinates=[Coordinate(x, "m", "to the east"), Coordinate(y, "m", "to the north")],
    parameters=[Parameter(m, "kg", 28.0, "mass"), Parameter(l, "m", 67.0, "length"),
                Parameter(g, "m/s^2", 9.81, "gravity"), Parameter(Omega, "rad/s", 7.292e-5, "rate"),
                Parameter(latitude, "rad", 0.8527, "latitude")], potential=m * g * z,
    masses=[PointMass(m, (outward * cos(angle) - x * sin(angle),
                          outward * sin(angle) + x * cos(angle), axial))])

PUBLISHED = r'''
source = "Coriolis' theorem: L. D. Landau, E. M. Lifshitz, Mechanics, § 39, equation (39.6)"
note = "L = m v²/2 + m v·(Ω × r) + m (Ω × r)²/2 - U in the rotating frame, for r on the sphere."
lagrangian = """m/2*(x_dot**2 + y_dot**2 + z_dot**2) + m*(x_dot*wx + y_dot*wy + z_dot*wz)
 + m/2*(wx**2 + wy**2 + wz**2) - m*g*z"""

[names]
z = "-sqrt(l**2 - x**2 - y**2)"
wx = "-Omega*cos(latitude)*sqrt(l**2 - x**2 - y**2) - Omega*sin(latitude)*y"
wy = "Omega*sin(latitude)*x"
wz = "-Omega*cos(latitude)*x"
'''
