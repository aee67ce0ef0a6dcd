r"""A free asymmetric body: it turns over and over about the axis of the middle moment of inertia.

     C
     |___           no force; orientation by a unit quaternion
    /___/|-- B      L. D. Landau, E. M. Lifshitz, Mechanics, § 36
    |___|/
    /
   A
"""
from sympy import sqrt, symbols

from derive import Box, Coordinate, Parameter, RigidBody, System, quaternion

w, x, y, z = kappa = symbols("w x y z", real=True)
A, B, C = symbols("A B C", positive=True)
sides = (sqrt((B + C - A) / 2), sqrt((C + A - B) / 2), sqrt((A + B - C) / 2))
system = System(
    name="free_body", title="Free asymmetric body in space, by a unit quaternion",
    coordinates=[Coordinate(s, "1", f"of the quaternion: cos or sin of half an angle, {s}")
                 for s in kappa],
    parameters=[Parameter(A, "kg m^2", 1.0, "moment of inertia about the first axis"),
                Parameter(B, "kg m^2", 2.0, "moment of inertia about the second axis"),
                Parameter(C, "kg m^2", 2.5, "moment of inertia about the third axis")],
    masses=[RigidBody(12, (0, 0, 0), (A, B, C), quaternion(*kappa))], potential=0,
    links=[Box(0, *sides)])

PUBLISHED = r'''
source = "L. D. Landau, E. M. Lifshitz, Mechanics, § 36, equations (36.5)"
euler_lagrange = ["A*p_dot + (C - B)*q*r = 0", "B*q_dot + (A - C)*r*p = 0",
 "C*r_dot + (B - A)*p*q = 0"]

[names]
p = "2*(w*x_dot - x*w_dot + z*y_dot - y*z_dot)"
q = "2*(w*y_dot - y*w_dot + x*z_dot - z*x_dot)"
r = "2*(w*z_dot - z*w_dot + y*x_dot - x*y_dot)"
'''
