r"""Two equal pendulums side by side, their bobs joined by a spring relaxed at equilibrium.

    +       +      A. P. French, Vibrations and Waves (1971), chapter 5
     \       \  l
      o~~~~~~~o m
          k, d
"""
from sympy import cos, sin, sqrt, symbols

from derive import Coordinate, Parameter, PointMass, Rod, Spring, System

theta1, theta2, g = symbols("theta1 theta2 g", real=True)
m, l, k, d = symbols("m l k d", positive=True)
(x1, y1), (x2, y2) = [(l * sin(q), -l * cos(q)) for q in (theta1, theta2)]
system = System(
    name="coupled_pendulums", title="Two pendulums coupled by a spring between their bobs",
    coordinates=[Coordinate(theta1, "rad", "angle of the first from the downward vertical"),
                 Coordinate(theta2, "rad", "angle of the second from the downward vertical")],
    parameters=[Parameter(m, "kg", 1.0, "mass of a bob"), Parameter(l, "m", 1.0, "length"),
                Parameter(k, "N/m", 1.0, "stiffness"), Parameter(d, "m", 1.0, "distance of pivots"),
                Parameter(g, "m/s^2", 9.81, "gravitational acceleration")],
    masses=[PointMass(m, (x1, y1)), PointMass(m, (d + x2, y2))], gravity=(0, -g),
    potential=k * (sqrt((d + x2 - x1)**2 + (y2 - y1)**2) - d)**2 / 2,
    links=[Rod((0, 0), 0), Rod((d, 0), 1), Spring(0, 1)])

PUBLISHED = r'''
source = "Hooke's law for a spring between the bobs"
note = "A. P. French, Vibrations and Waves (1971), chapter 5, treats small motions."
potential_energy = """k/2*(sqrt(d**2 + 2*d*l*(sin(theta2) - sin(theta1)) \
+ 2*l**2*(1 - cos(theta1 - theta2))) - d)**2 - m*g*l*(cos(theta1) + cos(theta2))"""
kinetic_energy = "m*l**2/2*(theta1_dot**2 + theta2_dot**2)"
'''
