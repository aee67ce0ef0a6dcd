r"""N point masses on rigid massless rods, one below the other, in a vertical plane.

    +                  M. Braun, Arch. Appl. Mech. 72 (2003) 899
     \ l1
      o m1
      ⋮
      o mn
"""
from sympy import Symbol, cos, sin, symbols

from derive import Coordinate, Parameter, PointMass, System


def system(n: int) -> System:
    q, g = symbols(f"theta1:{n + 1}", real=True), Symbol("g", real=True)
    m, l = (symbols(f"{letter}1:{n + 1}", positive=True) for letter in "ml")
    xs, ys = [[a * sin(b) for a, b in zip(l, q)], [-a * cos(b) for a, b in zip(l, q)]]
    return System(
        name=f"chain_{n}", title=f"Chain of {n} point masses on rigid rods in a vertical plane",
        coordinates=[Coordinate(s, "rad", "angle of a rod from the downward vertical") for s in q],
        parameters=[*(Parameter(s, "kg", 1.0, "mass of a bob") for s in m),
                    *(Parameter(s, "m", 1.0, "length of a rod") for s in l),
                    Parameter(g, "m/s^2", 9.81, "gravitational acceleration")],
        masses=[PointMass(m[k], (sum(xs[:k + 1]), sum(ys[:k + 1]))) for k in range(n)])


PUBLISHED = r'''
system = "chain_3"
source = "textbooks, for n links"
note = "Σ μ l_j (cos(θi - θj) θj'' + sin(θi - θj) θj'²) + μ g sin θi = 0, μ: mass below both joints"
euler_lagrange = [
"""M1*l1*theta1_ddot + M2*l2*(cos(theta1 - theta2)*theta2_ddot + sin(theta1 - theta2)*theta2_dot**2)
 + m3*l3*(cos(theta1 - theta3)*theta3_ddot + sin(theta1 - theta3)*theta3_dot**2)
 + M1*g*sin(theta1) = 0""",
"""M2*l1*(cos(theta2 - theta1)*theta1_ddot + sin(theta2 - theta1)*theta1_dot**2) + M2*l2*theta2_ddot
 + m3*l3*(cos(theta2 - theta3)*theta3_ddot + sin(theta2 - theta3)*theta3_dot**2)
 + M2*g*sin(theta2) = 0""",
"""m3*l1*(cos(theta3 - theta1)*theta1_ddot + sin(theta3 - theta1)*theta1_dot**2) + m3*l3*theta3_ddot
 + m3*l2*(cos(theta3 - theta2)*theta2_ddot + sin(theta3 - theta2)*theta2_dot**2)
 + m3*g*sin(theta3) = 0""",
]

[names]
M1 = "m1 + m2 + m3"
M2 = "m2 + m3"
'''
