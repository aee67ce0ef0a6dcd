r"""A robot arm of two links in a vertical plane, with a motor in each joint.

         q2  / l2        M. W. Spong, S. Hutchinson, M. Vidyasagar,
     l1 _.-´o            Robot Modeling and Control: planar elbow manipulator
    +-´ q1
"""
from sympy import cos, sin, symbols

from derive import Coordinate, Input, Parameter, RigidBody, Rod, System

q1, q2, tau1, tau2, g = symbols("q1 q2 tau1 tau2 g", real=True)
l1, l2, c1, c2, m1, m2, I1, I2 = symbols("l1 l2 c1 c2 m1 m2 I1 I2", positive=True)
elbow, turn = (l1 * cos(q1), l1 * sin(q1)), q1 + q2
hand, centre = ((elbow[0] + r * cos(turn), elbow[1] + r * sin(turn)) for r in (l2, c2))
system = System("two_link_arm", "Two-link robot arm in a vertical plane, with motors in its joints",
    [Coordinate(q1, "rad", "angle of the first link from the horizontal"),
     Coordinate(q2, "rad", "angle of the second link from the first one")],
    [Parameter(l1, "m", 0.4, "length of link 1"), Parameter(l2, "m", 0.3, "length of link 2"),
     Parameter(c1, "m", 0.2, "joint to centre 1"), Parameter(c2, "m", 0.15, "joint to centre 2"),
     Parameter(m1, "kg", 2.0, "mass of link 1"), Parameter(m2, "kg", 1.0, "mass of link 2"),
     Parameter(I1, "kg m^2", 0.03, "at centre 1"), Parameter(I2, "kg m^2", 0.01, "at centre 2"),
     Parameter(g, "m/s^2", 9.81, "gravitational acceleration")],
    [RigidBody(m1, (c1 * cos(q1), c1 * sin(q1)), I1, q1), RigidBody(m2, centre, I2, turn)],
    inputs=[Input(tau1, "N m", "motor 1"), Input(tau2, "N m", "motor 2")], forces=[tau1, tau2],
    outputs={"x": hand[0], "y": hand[1]}, links=[Rod((0, 0), elbow), Rod(elbow, hand)])

PUBLISHED = r'''
source = "M. W. Spong, S. Hutchinson, M. Vidyasagar, Robot Modeling and Control (2006)"
note = "The source's planar elbow manipulator; its centres of mass lc1 and lc2 are c1 and c2 here."
euler_lagrange = ["d11*q1_ddot + d12*q2_ddot + 2*h*q1_dot*q2_dot + h*q2_dot**2 + phi1 = tau1",
 "d12*q1_ddot + d22*q2_ddot - h*q1_dot**2 + phi2 = tau2"]
kinetic_energy = "(d11*q1_dot**2 + 2*d12*q1_dot*q2_dot + d22*q2_dot**2)/2"
potential_energy = "(m1*lc1 + m2*l1)*g*sin(q1) + m2*lc2*g*sin(q1 + q2)"

[names]
lc1 = "c1"
lc2 = "c2"
d11 = "m1*c1**2 + m2*(l1**2 + c2**2 + 2*l1*c2*cos(q2)) + I1 + I2"
d12 = "m2*(c2**2 + l1*c2*cos(q2)) + I2"
d22 = "m2*c2**2 + I2"
h = "-m2*l1*c2*sin(q2)"
phi1 = "(m1*c1 + m2*l1)*g*cos(q1) + m2*c2*g*cos(q1 + q2)"
phi2 = "m2*c2*g*cos(q1 + q2)"
'''
