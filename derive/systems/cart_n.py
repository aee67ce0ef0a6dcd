r"""A chain of N pendulums on a cart.

    ─┤ m0 ├─── x       Wikipedia, Inverted pendulum, for n = 1
        \ l1
         o m1 …
"""
from sympy import Symbol, cos, sin, symbols

from derive import Cart, Coordinate, Parameter, PointMass, Rail, Rod, System


def system(n: int) -> System:
    x, g, m0 = Symbol("x", real=True), Symbol("g", real=True), Symbol("m0", positive=True)
    q = symbols(f"theta1:{n + 1}", real=True)
    m, l = (symbols(f"{letter}1:{n + 1}", positive=True) for letter in "ml")
    xs, ys = [x, *(a * sin(b) for a, b in zip(l, q))], [-a * cos(b) for a, b in zip(l, q)]
    return System(
        name=f"cart_{n}", title=f"Cart on a rail with a chain of {n} pendulums",
        coordinates=[Coordinate(x, "m", "position of the cart"),
                     *(Coordinate(s, "rad", "angle of a rod from hanging") for s in q)],
        parameters=[Parameter(s, "kg", 1.0, "mass") for s in (m0, *m)]
        + [Parameter(s, "m", 1.0, "length of a rod") for s in l]
        + [Parameter(g, "m/s^2", 9.81, "gravitational acceleration")],
        masses=[PointMass(s, (sum(xs[:k + 1]), sum(ys[:k]))) for k, s in enumerate((m0, *m))],
        links=[Cart(0, l[0] / 2, h := l[0] / 4), Rail((0, -h), (1, -h)), Rod(*range(n + 1))])


PUBLISHED = r'''
system = "cart_1"
source = "Wikipedia, Inverted pendulum: on a cart, without a force"
note = "The source measures the angle from the upright, in the other direction."
lagrangian = """(M + m)*x_dot**2/2 - m*l*x_dot*theta_dot*cos(theta) + m*l**2*theta_dot**2/2 \
- m*g*l*cos(theta)"""
euler_lagrange = [
"(M + m)*x_ddot - m*l*theta_ddot*cos(theta) + m*l*theta_dot**2*sin(theta) = 0",
"l*theta_ddot - g*sin(theta) = x_ddot*cos(theta)",
]

[names]
M = "m0"
m = "m1"
l = "l1"
theta = "theta1 - pi"
'''
