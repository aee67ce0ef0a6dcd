r"""Two uniform bars, one hinged below the other, in a vertical plane.

    +                  R. B. Levien, S. M. Tan, Am. J. Phys. 61 (1993) 1038
   θ1\\ l1, m1
      \\
   θ2// l2, m2
"""
from sympy import cos, sin, symbols

from derive import Coordinate, Parameter, RigidBody, Rod, System

theta1, theta2, g = symbols("theta1 theta2 g", real=True)
m1, m2, l1, l2 = symbols("m1 m2 l1 l2", positive=True)
x1, y1 = l1 / 2 * sin(theta1), -l1 / 2 * cos(theta1)
x2, y2 = 2 * x1 + l2 / 2 * sin(theta2), 2 * y1 - l2 / 2 * cos(theta2)
system = System(
    name="double_bar_pendulum", title="Double pendulum of uniform bars in a vertical plane",
    coordinates=[Coordinate(theta1, "rad", "angle of the first bar from the downward vertical"),
                 Coordinate(theta2, "rad", "angle of the second bar from the downward vertical")],
    parameters=[Parameter(m1, "kg", 1.0, "first mass"), Parameter(m2, "kg", 1.0, "second mass"),
                Parameter(l1, "m", 1.0, "first length"), Parameter(l2, "m", 1.0, "second length"),
                Parameter(g, "m/s^2", 9.81, "gravitational acceleration")],
    masses=[RigidBody(m1, (x1, y1), m1 * l1**2 / 12, theta1),
            RigidBody(m2, (x2, y2), m2 * l2**2 / 12, theta2)],
    links=[Rod((0, 0), (2 * x1, 2 * y1), (2 * x2 - 2 * x1, 2 * y2 - 2 * y1))])

PUBLISHED = r'''
source = "Wikipedia, Double pendulum: two equal bars"
note = "The source takes equal masses and lengths: m2 = m1, l2 = l1."
lagrangian = """m*l**2/6*(theta2_dot**2 + 4*theta1_dot**2 + 3*theta1_dot*theta2_dot\
*cos(theta1 - theta2)) + m*g*l/2*(3*cos(theta1) + cos(theta2))"""

[equal]
m2 = "m1"
l2 = "l1"

[names]
m = "m1"
l = "l1"

[hamilton]
theta1 = """6/(m*l**2)*(2*p_theta1 - 3*cos(theta1 - theta2)*p_theta2)
 /(16 - 9*cos(theta1 - theta2)**2)"""
theta2 = """6/(m*l**2)*(8*p_theta2 - 3*cos(theta1 - theta2)*p_theta1)
 /(16 - 9*cos(theta1 - theta2)**2)"""
'''
