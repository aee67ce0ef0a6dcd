r"""A point mass on a massless straight spring in a vertical plane.

    +             P. Lynch, Int. J. Non-Linear Mech. 37 (2002) 345
    |\
    |θ\ r, k
        o m
"""
from sympy import cos, sin, symbols

from derive import Coordinate, Parameter, PointMass, System

theta, g = symbols("theta g", real=True)
r, m, k, l = symbols("r m k l", positive=True)
system = System(
    name="elastic_pendulum",
    title="Elastic pendulum: a point mass on a massless spring in a vertical plane",
    coordinates=[Coordinate(r, "m", "length of the spring"),
                 Coordinate(theta, "rad", "angle of the spring from the downward vertical")],
    parameters=[Parameter(m, "kg", 1.0, "mass of the bob"),
                Parameter(k, "N/m", 100.0, "stiffness of the spring"),
                Parameter(l, "m", 1.0, "length of the spring without load"),
                Parameter(g, "m/s^2", 9.81, "gravitational acceleration")],
    masses=[PointMass(m, (r * sin(theta), -r * cos(theta)))], potential=k * (r - l)**2 / 2,
    gravity=(0, -g), equilibrium=(l + m * g / k, 0))

PUBLISHED = r'''
source = "Wikipedia, Elastic pendulum"
lagrangian = """m/2*(x_dot**2 + (l0 + x)**2*theta_dot**2) - k*x**2/2 + g*m*(l0 + x)*cos(theta)"""

[names]
x = "r - l"
l0 = "l"

[accelerations]
r = "(l0 + x)*theta_dot**2 - k/m*x + g*cos(theta)"
theta = "-g/(l0 + x)*sin(theta) - 2*x_dot/(l0 + x)*theta_dot"
'''
