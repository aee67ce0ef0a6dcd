r"""A star in the meridian plane of a galaxy: chaos in the simplest potential that has it.

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
    coordinates=[Coordinate(x, "m", "first place"), Coordinate(y, "m", "second place")],
    parameters=[],
    masses=[PointMass(1, (x, y))],
    potential=(x**2 + y**2) / 2 + x**2 * y - y**3 * Rational(1, 3),
)
