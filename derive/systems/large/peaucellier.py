r"""Peaucellier's and Lipkin's linkage of seven bars: its joint P moves on a straight line.

         O        L = OA = OC, s = AB = BC = CP = PA, r = OQ = QB
       / Q \
      /  B  \     A. B. Kempe, How to Draw a Straight Line (1877): OB OP = L² - s²,
     C<     >A    which maps the circle of B through O to a line
         P
"""
from sympy import cos, sin, symbols

from derive import Constraint, Coordinate, Parameter, PointMass, Rod, System

phi, theta, g = symbols("phi theta g", real=True)
w, u, L, s, r, m = symbols("w u L s r m", positive=True)
along, across = (w * sin(theta), -w * cos(theta)), (u * cos(theta), u * sin(theta))
O, Q, B = (0, 0), (0, -r), (r * sin(phi), -r - r * cos(phi))
A, C = (tuple(p + sign * q for p, q in zip(along, across)) for sign in (1, -1))
P = tuple(2 * p - q for p, q in zip(along, B))  # A + C - B: opposite sides are parallel
x, y = r * (cos(theta) + cos(phi - theta)), r * (sin(phi - theta) - sin(theta))  # B in their axes
system = System("peaucellier", "Peaucellier-Lipkin linkage, whose joint P moves on a straight line",
    [Coordinate(phi, "rad", "angle of the crank from below"),
     Coordinate(theta, "rad", "direction from O to the centre of the rhombus"),
     Coordinate(w, "m", "distance of this centre from O"),
     Coordinate(u, "m", "half of the diagonal AC")],
    [Parameter(L, "m", 0.5, "OA and OC"), Parameter(s, "m", 0.25, "side of the rhombus"),
     Parameter(r, "m", 0.16, "crank, and distance of Q from O"),
     Parameter(m, "kg", 1.0, "mass of each joint"), Parameter(g, "m/s^2", 9.81, "gravity")],
    [PointMass(m, joint) for joint in (A, B, C, P)],
    constraints=[Constraint((l**2 - p**2 - q**2) / (2 * l), name + other, "N",
                            f"sum of the tensions of {name} and {other}")
                 for name, other, l, p, q in (("OA", "OC", L, w, u), ("AB", "CP", s, w - x, u - y),
                                              ("BC", "PA", s, w - x, u + y))],
    links=[Rod(O, 0, 3, 2, O), Rod(0, 1, 2), Rod(Q, 1)], keep_coordinates=True)

PUBLISHED = r'''
source = "A. B. Kempe, How to Draw a Straight Line (1877)"
note = "The line of P; the equation of motion by hand: J is the inertia at OB, of angle phi/2."
euler_lagrange = ["2*w*cos(theta) - r*(1 + cos(phi)) = (L**2 - s**2)/(2*r)",
 "J*phi_ddot/2 + J_dot*phi_dot/4 + 4*m*g*r*sin(phi) = 0"]

[names]
J = """m*(4*r**2 + 2*L**2 + (L**2 - s**2)**2/(4*r**2*cos(phi/2)**4)
 + (L*sin(phi/2)*((L**2 - s**2)/(2*r*cos(phi/2)**2) - 2*r)/u)**2/2)"""
'''
