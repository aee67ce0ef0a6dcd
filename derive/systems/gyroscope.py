r"""A balanced gyroscope: a rotor in two gimbals, which have inertia, too.

     __|__      outer gimbal: alpha, about the vertical; inner one: beta, about its own axis
    / |=| \     rotor: gamma, about its axis in the inner gimbal
    \_____/     K. G. Valeev, R. R. Islamov, Soviet Applied Mechanics 7 (1971) 760
"""
from sympy import symbols

from derive import Coordinate, Parameter, RigidBody, Rod, System, Wheel, rotations

alpha, beta, gamma = q = symbols("alpha beta gamma", real=True)
I, A1, B1, C1, A, C = symbols("I A1 B1 C1 A C", positive=True)
outer, inner, rotor = rotations("z", q[:1]), rotations("zx", q[:2]), rotations("zxy", q)
x, y, z, O, axle = (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0), inner.turned((0, 0.8, 0))
values = {I: (2, "outer gimbal"), A1: (2, "inner one, across"), B1: (1, "about its axis"),
          C1: (1, "about the rotor's"), A: (2, "rotor, across"), C: (3, "about its axis")}
system = System(
    name="gyroscope", title="Gyroscope: a rotor in two gimbals with inertia, in space",
    coordinates=[Coordinate(s, "rad", f"angle {s}") for s in q], potential=0,
    parameters=[Parameter(s, "kg m^2", *value) for s, value in values.items()],
    masses=[RigidBody(1, O, moments, axes) for axes, moments in (
        (outer, (I, 2 * I, I)), (inner, (B1, C1, A1)), (rotor, (A, C, A)))],
    links=[Wheel(O, 1, plane=(outer.turned(x), z)), Rod(axle, tuple(-part for part in axle)),
           Wheel(O, 0.8, plane=(inner.turned(x), inner.turned(y))), Rod(z, (0, 0, 1.2)),
           Wheel(2, 0.5, plane=(rotor.turned(x), rotor.turned(z))), Rod((0, 0, -1.2), (0, 0, -1))])

PUBLISHED = r'''
source = "K. G. Valeev, R. R. Islamov, Soviet Applied Mechanics 7 (1971) 760"
note = "The source's angles and moments, without its spring; the equations are by hand."
kinetic_energy = """(I + (A + A1)*cos(beta)**2 + C1*sin(beta)**2)*alpha_dot**2/2
 + (A + B1)*beta_dot**2/2 + C*(gamma_dot + alpha_dot*sin(beta))**2/2"""
euler_lagrange = ["""(A + B1)*beta_ddot + (A + A1 - C1)*alpha_dot**2*sin(beta)*cos(beta)
 - C*(gamma_dot + alpha_dot*sin(beta))*alpha_dot*cos(beta) = 0"""]

[momenta]
gamma = "C*(gamma_dot + alpha_dot*sin(beta))"
alpha = """(I + (A + A1)*cos(beta)**2 + C1*sin(beta)**2)*alpha_dot
 + C*(gamma_dot + alpha_dot*sin(beta))*sin(beta)"""
'''
