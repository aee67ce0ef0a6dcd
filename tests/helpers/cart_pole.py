"""A pole on a cart with a force as input, and its coordinates measured from upright."""

from sympy import cos, sin, symbols

from derive import Coordinate, Input, Parameter, PointMass, System, velocity

x, theta, F, T = symbols("x theta F T", real=True)
M, m, length = symbols("M m l", positive=True)
g, b = symbols("g b", real=True)

cart_pole = System(
    name="cart_pole",
    title="A pole on a cart",
    coordinates=[
        Coordinate(x, "m", "position of the cart"),
        Coordinate(theta, "rad", "angle of the pole from upright"),
    ],
    parameters=[
        Parameter(M, "kg", 0.5, "mass of the cart"),
        Parameter(m, "kg", 0.2, "mass at the end of the pole"),
        Parameter(length, "m", 0.3, "length of the pole"),
        Parameter(b, "N s/m", 0.1, "friction of the cart"),
        Parameter(g, "m/s^2", 9.81, "gravity"),
    ],
    masses=[PointMass(M, (x, 0)), PointMass(m, (x + length * sin(theta), length * cos(theta)))],
    dissipation=b * velocity(x) ** 2 / 2,
    forces=(F, T * cos(theta)),
    inputs=[
        Input(F, "N", "force on the cart"),
        Input(T, "N m", "torque on the pole"),
    ],
)
