r"""A crank moves a slider by a rod, as in a pump; or a piston turns the crank, as in an engine.

     A o-._
    r /    `-._ l          Wikipedia, Piston motion equations
   - + φ - - - `[M]- - -   the guide
"""
from sympy import atan, cos, sin, symbols

from derive import Block, Constraint, Coordinate, Parameter, PointMass, Rail, RigidBody, Rod, System

phi, w, g = symbols("phi w g", real=True)
u, r, l, m1, m2, M = symbols("u r l m1 m2 M", positive=True)
A, rod = (r * cos(phi), r * sin(phi)), (l**2 - u**2 - w**2) / (2 * l)
x, y = A[0] + u, A[1] + w
system = System("slider_crank", "Slider-crank: a crank and a rod, uniform bars, and a slider",
    [Coordinate(phi, "rad", "angle of the crank"), Coordinate(w, "m", "height of the rod's ends"),
     Coordinate(u, "m", "their distance along the guide")],
    [Parameter(r, "m", 0.1, "crank"), Parameter(l, "m", 0.3, "rod"),
     Parameter(m1, "kg", 1.0, "crank"), Parameter(m2, "kg", 0.6, "rod"),
     Parameter(M, "kg", 0.8, "slider"), Parameter(g, "m/s^2", 9.81, "gravity")],
    [RigidBody(m1, (A[0] / 2, A[1] / 2), m1 * r**2 / 12, phi), PointMass(M, (x, y)),
     RigidBody(m2, (A[0] + u / 2, A[1] + w / 2), m2 * l**2 / 12, atan(w / u))],
    constraints=[Constraint(y, "guide", "N", "force of the guide on the slider, upwards"),
                 Constraint(rod, "rod", "N", "tension of the rod: the mean of its ends' forces")],
    outputs={"x": x}, links=[Rod((0, 0), A), Rod(A, 1), Rail((0, 0), (1, 0)), Block(1, r, r / 2)])

PUBLISHED = r'''
source = "Wikipedia, Piston motion equations; S. Cardona Foix et al., Mech. Sci. 8 (2017) 91"
note = "Eksergian's equation of motion, written by hand, with J, the inertia at the crank."
euler_lagrange = ["x = r*cos(phi) + sqrt(l**2 - r**2*sin(phi)**2)",
 "x_dot = -phi_dot*(r*sin(phi) + r**2*sin(phi)*cos(phi)/sqrt(l**2 - r**2*sin(phi)**2))",
 "J*phi_ddot + J_dot*phi_dot/2 + (m1 + m2)*g*r*cos(phi)/2 = 0"]

[names]
x = "r*cos(phi) + u"
J = """m1*r**2/3 + m2*(r**2 + r*sin(phi)*(r*sin(phi) - u_dot/phi_dot)
 + (r*sin(phi) - u_dot/phi_dot)**2)/3 + M*(r*sin(phi) - u_dot/phi_dot)**2"""
'''
