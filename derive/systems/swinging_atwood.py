"""Two masses on a thread over two pulleys, of which one can also swing.

      o────o         N. B. Tufillaro, T. A. Abbott, D. J. Griffiths, Am. J. Phys. 52 (1984) 895
     /     |
    /θ r   |
   o m    [M]
"""
from sympy import cos, sin, symbols

from derive import Coordinate, Parameter, PointMass, System

theta, g = symbols("theta g", real=True)
r, M, m = symbols("r M m", positive=True)
system = System(
    name="swinging_atwood",
    title="Swinging Atwood machine: one of two masses on a thread over pulleys swings",
    coordinates=[Coordinate(r, "m", "length of thread from its pulley to the swinging mass"),
                 Coordinate(theta, "rad", "angle of that thread from the downward vertical")],
    parameters=[Parameter(M, "kg", 3.0, "mass that only goes up and down"),
                Parameter(m, "kg", 1.0, "mass that swings"),
                Parameter(g, "m/s^2", 9.81, "gravitational acceleration")],
    masses=[PointMass(M, (0, r)), PointMass(m, (r * sin(theta), -r * cos(theta)))],
)
