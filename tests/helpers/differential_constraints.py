"""Constraints of velocities of a mass, as formulas."""

import sympy as sp

from derive import Coordinate, Input, Parameter, PointMass, System, velocity
from derive.mechanics.constraints.differentiated_constraints import Constraints

x, y, z, theta, phi = sp.symbols("x y z theta phi", real=True)
u = sp.Symbol("u", real=True)
m, R, a = sp.symbols("m R a", positive=True)
dx, dy, dz, dtheta, dphi = map(velocity, (x, y, z, theta, phi))
s, c = sp.sin(theta), sp.cos(theta)


def constrained(*constraints: sp.Expr) -> Constraints:
    """A mass, and coordinates that move no other one; nothing is integrated."""
    q = [Coordinate(symbol, "m", "a coordinate") for symbol in (x, y, z, theta, phi)]
    parameters = [Parameter(symbol, "m", 1.0, "a constant") for symbol in (m, R, a)]
    masses = [PointMass(m, (k, 0)) for k in (x, y, z, theta, phi)]
    system = System("s", "S", q, parameters, masses, potential=0, constraints=constraints,
        inputs=[Input(u, "1", "an input")])  # fmt: skip
    return Constraints(system)
