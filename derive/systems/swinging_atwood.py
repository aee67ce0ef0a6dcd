"""Two masses on a thread over two pulleys; one of them can also swing.

      o────o         N. B. Tufillaro, T. A. Abbott, D. J. Griffiths, Am. J. Phys. 52 (1984) 895
     /     |
    /θ r   |
   o m    [M]
"""
from sympy import cos, sin, symbols

from derive import Coordinate, Parameter, PointMass, System, Thread, Wheel

theta, g = symbols("theta g", real=True)
r, M, m = symbols("r M m", positive=True)
system = System(
    name="swinging_atwood",
    title="Swinging Atwood machine: one of two masses on a thread over pulleys swings",
    coordinates=[Coordinate(r, "m", "length of the thread from its pulley to the swinging mass"),
                 Coordinate(theta, "rad", "angle of that thread from the downward vertical")],
    parameters=[Parameter(M, "kg", 3.0, "mass that moves vertically"),
                Parameter(m, "kg", 1.0, "mass that swings"),
                Parameter(g, "m/s^2", 9.81, "gravitational acceleration")],
    masses=[PointMass(M, (-1, r - 2)), PointMass(m, (r * sin(theta), -r * cos(theta)))],
    potential=M * g * r - m * g * r * cos(theta),
    links=[Thread(0, (-1, 0), (0, 0), 1), Wheel((-1, 0), 0.05), Wheel((0, 0), 0.05)])

PUBLISHED = r'''
source = "Imperial College, The Swinging Atwood's Machine; after N. B. Tufillaro et al. (1984)"
hamiltonian = "(p_r**2/(1 + mu) + p_theta**2/r**2)/(2*m) + m*g*r*(mu - cos(theta))"

[names]
mu = "M/m"
'''
