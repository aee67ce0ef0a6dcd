r"""A mass on a nonlinear spring with friction and a harmonic force.

    |  k, beta                  G. Duffing, Erzwungene Schwingungen bei veränderlicher
    |-/\/\/\-[m]--> F cos(Ω t)  Eigenfrequenz, Vieweg 1918
    |   c    |--> x
"""
from sympy import cos, symbols

from derive import TIME, Block, Coordinate, Parameter, PointMass, Spring, System, velocity

x, k, beta, F, Omega, c = symbols("x k beta F Omega c", real=True)
m = symbols("m", positive=True)
system = System(
    name="duffing", title="Duffing's oscillator: a nonlinear spring, friction and a harmonic force",
    coordinates=[Coordinate(x, "m", "displacement")],
    parameters=[Parameter(m, "kg", 1.0, "mass"), Parameter(k, "N/m", 1.0, "linear stiffness"),
                Parameter(beta, "N/m^3", 1.0, "cubic stiffness"),
                Parameter(c, "N s/m", 0.1, "friction"), Parameter(F, "N", 0.2, "force amplitude"),
                Parameter(Omega, "rad/s", 1.0, "frequency of the force")],
    masses=[PointMass(m, (x, 0))],
    potential=k * x**2 / 2 + beta * x**4 / 4 - F * x * cos(Omega * TIME),
    dissipation=c * velocity(x)**2 / 2, links=[Spring((-2, 0), 0), Block(0, 0.3, 0.3)])

PUBLISHED = r'''
source = "Wikipedia, Duffing equation"

[equal]
m = "1"

[names]
delta = "c"
alpha = "k"
gamma = "F"
omega = "Omega"

[accelerations]
x = "gamma*cos(omega*t) - delta*x_dot - alpha*x - beta*x**3"
'''
