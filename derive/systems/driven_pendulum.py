r"""A pendulum whose pivot oscillates vertically: P. L. Kapitza's, which can stand upright.

    ↕ a cos(Ω t)      L. D. Landau, E. M. Lifshitz, Mechanics, § 5, problem 3c; § 30, problem 1
    +
     \ l
      o m
"""
from sympy import cos, sin, symbols

from derive import TIME, Coordinate, Parameter, PointMass, Rod, System, velocity

theta, a, Omega, c, g = symbols("theta a Omega c g", real=True)
m, l = symbols("m l", positive=True)
system = System(
    name="driven_pendulum",
    title="Driven pendulum: its pivot oscillates vertically, and its joint has friction",
    coordinates=[Coordinate(theta, "rad", "angle of the rod from the downward vertical")],
    parameters=[Parameter(m, "kg", 1.0, "mass of the bob"), Parameter(l, "m", 1.0, "length"),
                Parameter(a, "m", 0.1, "amplitude"), Parameter(Omega, "rad/s", 100.0, "frequency"),
                Parameter(c, "N m s", 0.0, "friction"), Parameter(g, "m/s^2", 9.81, "gravity")],
    masses=[PointMass(m, (l * sin(theta), a * cos(Omega * TIME) - l * cos(theta)))],
    dissipation=c * velocity(theta)**2 / 2, links=[Rod((0, a * cos(Omega * TIME)), 0)])

PUBLISHED = r'''
source = "L. D. Landau, E. M. Lifshitz, Mechanics, § 5, problem 3 (c)"
note = "The source measures the pivot downwards, omits total derivatives and has no friction."
lagrangian = """m*l**2*phi_dot**2/2 + m*l*A*gamma**2*cos(gamma*t)*cos(phi) + m*g*l*cos(phi)"""

[equal]
c = "0"

[names]
phi = "theta"
A = "-a"
gamma = "Omega"
'''
