r"""Two point masses on rigid massless rods, one below the other, in a vertical plane.

    +                  L. D. Landau, E. M. Lifshitz, Mechanics, § 5, problem 1
   θ1\ l1
      o m1
   θ2/ l2
    o m2
"""
from sympy import cos, sin, symbols

from derive import Coordinate, Parameter, PointMass, System

theta1, theta2, g = symbols("theta1 theta2 g", real=True)
m1, m2, l1, l2 = symbols("m1 m2 l1 l2", positive=True)
x1, y1 = l1 * sin(theta1), -l1 * cos(theta1)
x2, y2 = x1 + l2 * sin(theta2), y1 - l2 * cos(theta2)
system = System(
    name="double_pendulum",
    title="Double pendulum: two point masses on rigid massless rods in a vertical plane",
    coordinates=[Coordinate(theta1, "rad", "angle of the first rod from the downward vertical"),
                 Coordinate(theta2, "rad", "angle of the second rod from the downward vertical")],
    parameters=[Parameter(m1, "kg", 1.0, "first mass"), Parameter(m2, "kg", 1.0, "second mass"),
                Parameter(l1, "m", 2.0, "first length"), Parameter(l2, "m", 2.0, "second length"),
                Parameter(g, "m/s^2", 9.81, "gravitational acceleration")],
    masses=[PointMass(m1, (x1, y1)), PointMass(m2, (x2, y2))], reactions=[l1, l2])

PUBLISHED = r'''
source = "L. D. Landau, E. M. Lifshitz, Mechanics, § 5, problem 1"
lagrangian = """(m1 + m2)/2*l1**2*phi1_dot**2 + m2/2*l2**2*phi2_dot**2 \
+ m2*l1*l2*phi1_dot*phi2_dot*cos(phi1 - phi2) + (m1 + m2)*g*l1*cos(phi1) + m2*g*l2*cos(phi2)"""

[names]
phi1 = "theta1"
phi2 = "theta2"
'''
