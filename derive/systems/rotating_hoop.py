r"""A bead on a hoop that rotates about its vertical diameter.

      .─+─.          J. R. Taylor, Classical Mechanics (2005), example 7.6
     /  |  \  ↻ Ω
    |   +   |
     \  |θ o m
      '─+─'
"""
from sympy import cos, sin, symbols

from derive import TIME, Coordinate, Parameter, PointMass, System, Wheel

theta, Omega, g = symbols("theta Omega g", real=True)
m, R = symbols("m R", positive=True)
system = System(
    name="rotating_hoop",
    title="Bead on a hoop that rotates about its vertical diameter",
    coordinates=[Coordinate(theta, "rad", "angle of the bead from the bottom of the hoop")],
    parameters=[Parameter(m, "kg", 1.0, "mass of the bead"), Parameter(R, "m", 1.0, "radius"),
                Parameter(Omega, "rad/s", 4.0, "angular velocity of the hoop"),
                Parameter(g, "m/s^2", 9.81, "gravitational acceleration")],
    masses=[PointMass(m, (R * sin(theta) * cos(Omega * TIME), R * sin(theta) * sin(Omega * TIME),
                          -R * cos(theta)))],
    links=[Wheel((0, 0, 0), R, plane=((cos(Omega * TIME), sin(Omega * TIME), 0), (0, 0, 1)))])

PUBLISHED = r'''
source = "J. R. Taylor, Classical Mechanics (2005), example 7.6"
lagrangian = "m*R**2/2*(theta_dot**2 + omega**2*sin(theta)**2) - m*g*R*(1 - cos(theta))"

[names]
omega = "Omega"

[accelerations]
theta = "(omega**2*cos(theta) - g/R)*sin(theta)"
'''
