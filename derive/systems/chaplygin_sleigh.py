r"""Chaplygin's sleigh: a body on ice that a skate prevents from moving sideways.

           o m, J         J. I. Neimark, N. A. Fufaev, Dynamics of Nonholonomic Systems, III.2;
        /  a              A. M. Bloch, Nonholonomic Mechanics and Control, 1.7
     (x, y) skate, θ
"""
from sympy import cos, sin, symbols

from derive import Constraint, Coordinate, Parameter, RigidBody, Rod, System, velocity

x, y, theta = symbols("x y theta", real=True)
m, J, a = symbols("m J a", positive=True)
skate = velocity(y) * cos(theta) - velocity(x) * sin(theta)
system = System(
    name="chaplygin_sleigh", title="Chaplygin's sleigh: a body on ice with a skate",
    coordinates=[Coordinate(x, "m", "place of the skate"), Coordinate(y, "m", "across"),
                 Coordinate(theta, "rad", "direction of the skate")],
    parameters=[Parameter(m, "kg", 1.0, "mass"),
                Parameter(J, "kg m^2", 0.1, "moment of inertia about the centre of mass"),
                Parameter(a, "m", 0.3, "from the skate to the centre of mass")],
    masses=[RigidBody(m, (x + a * cos(theta), y + a * sin(theta)), J, theta)], potential=0,
    links=[Rod((x, y), 0)],
    constraints=[Constraint(skate, "skate", "N", "force on the skate, to its left")])

PUBLISHED = r'''
source = "A. M. Bloch, Nonholonomic Mechanics and Control, 1.7: reduced equations in v and omega"
euler_lagrange = ["v_dot = a*omega**2", "(J + m*a**2)*omega_dot = -m*a*v*omega"]

[names]
v = "x_dot*cos(theta) + y_dot*sin(theta)"
omega = "theta_dot"
'''
