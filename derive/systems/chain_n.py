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
