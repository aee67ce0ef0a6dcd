r"""A point mass on a rigid massless rod that swings in all directions.

    +             L. D. Landau, E. M. Lifshitz, Mechanics, § 14, problem 1
    |\ l
    |θ\
    ----o m   φ about the vertical
"""
from sympy import cos, sin, symbols

from derive import Coordinate, Parameter, PointMass, System

theta, phi, g = symbols("theta phi g", real=True)
m, l = symbols("m l", positive=True)
system = System(
    name="spherical_pendulum",
    title="Spherical pendulum: a point mass on a rigid massless rod, in space",
    coordinates=[Coordinate(theta, "rad", "angle of the rod from the downward vertical"),
                 Coordinate(phi, "rad", "direction of the rod about the vertical")],
    parameters=[Parameter(m, "kg", 1.0, "mass of the bob"), Parameter(l, "m", 1.0, "length"),
                Parameter(g, "m/s^2", 9.81, "gravitational acceleration")],
    masses=[PointMass(m, (l * sin(theta) * cos(phi), l * sin(theta) * sin(phi), -l * cos(theta)))])

PUBLISHED = r'''
source = "L. D. Landau, E. M. Lifshitz, Mechanics, § 14, problem 1"
energy = "m*l**2*(theta_dot**2 + sin(theta)**2*phi_dot**2)/2 - m*g*l*cos(theta)"

[momenta]
phi = "m*l**2*phi_dot*sin(theta)**2"
'''
