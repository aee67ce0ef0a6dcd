r"""A star in the meridian plane of a galaxy: chaos in a cubic potential.

      y
      |  .      M. Hénon, C. Heiles, Astron. J. 69 (1964) 73
      | / \
      |/_._\__ x
"""
from sympy import Rational, symbols

from derive import Coordinate, PointMass, System

x, y = symbols("x y", real=True)
system = System(
    name="henon_heiles",
    title="Hénon and Heiles: a star in the meridian plane of a galaxy, in their units",
    coordinates=[Coordinate(x, "m", "first position"), Coordinate(y, "m", "second position")],
    parameters=[],
    masses=[PointMass(1, (x, y))],
    potential=(x**2 + y**2) / 2 + x**2 * y - y**3 * Rational(1, 3))

PUBLISHED = r'''
source = "M. Hénon, C. Heiles, Astron. J. 69 (1964) 73"
hamiltonian = "(p_x**2 + p_y**2)/2 + (x**2 + y**2 + 2*x**2*y - 2*y**3/3)/2"

[accelerations]
x = "-x - 2*x*y"
y = "-y - x**2 + y**2"
'''
