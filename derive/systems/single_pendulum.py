r"""One point mass on a rigid massless rod in a vertical plane.

    +         L. D. Landau, E. M. Lifshitz, Mechanics, § 11, problem 1
    |\
    | \ l
    |θ \
        o m
"""
from sympy import cos, sin, symbols

from derive import Coordinate, Parameter, PointMass, System

theta, g = symbols("theta g", real=True)
m, l = symbols("m l", positive=True)
system = System(
    name="single_pendulum",
    title="Single pendulum: a point mass on a rigid massless rod in a vertical plane",
    coordinates=[Coordinate(theta, "rad", "angle of the rod from the downward vertical")],
    parameters=[Parameter(m, "kg", 1.0, "mass of the bob"), Parameter(l, "m", 2.0, "length"),
                Parameter(g, "m/s^2", 9.81, "gravitational acceleration")],
    masses=[PointMass(m, (l * sin(theta), -l * cos(theta)))], reactions=[l])

PUBLISHED = r'''
source = "L. D. Landau, E. M. Lifshitz, Mechanics, § 11, problem 1"
energy = "m*l**2*theta_dot**2/2 - m*g*l*cos(theta)"
euler_lagrange = ["theta_ddot + g/l*sin(theta) = 0"]
hamiltonian = "p_theta**2/(2*m*l**2) - m*g*l*cos(theta)"
'''
