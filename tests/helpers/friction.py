"""Blocks with dry friction."""

from functools import cache

import sympy as sp

from derive import TIME, Coordinate, Parameter, PointMass, RigidBody, System, velocity
from solvers.app.modules import build
from solvers.equations.module import GeneratedModule

x, y, W, K, P, F, G, V, c = sp.symbols("x y W K P F G V c", real=True)
v, w = velocity(x), velocity(y)
X, Y = Coordinate(x, "m", "position"), Coordinate(y, "m", "position")


@cache
def block() -> GeneratedModule:
    """A block on a belt with velocity V, with a spring, a weight and a drive."""
    relative = V - v
    friction = F * sp.sign(relative) * (1 - c * sp.Abs(relative))
    units = {W: "N", K: "N/m", P: "N", F: "N", V: "m/s", c: "s/m"}
    parameters = [Parameter(symbol, unit, 0.0, "") for symbol, unit in units.items()]
    force = W - K * x + P * sp.cos(TIME) + friction
    masses = [PointMass(1, (x, 0))]
    return build(System("block", "", [X], parameters, masses, sp.S.Zero, forces=[force]))


BELT = {"K": 1.0, "F": 1.0, "V": 0.4, "c": 0.2}


@cache
def slider_crank(*, keep_coordinates: bool) -> GeneratedModule:
    """A crank of 0.1 m with a torque P, a rod of 0.3 m, and a slider with friction F."""
    phi, psi = sp.symbols("phi psi", real=True)
    a, b = sp.symbols("a b", positive=True)
    arm, rod = (r * sp.Matrix([sp.cos(q), sp.sin(q)]) for r, q in ((a, phi), (b, psi)))
    masses = [
        RigidBody(2, (0, 0), sp.Rational(1, 100), phi),
        RigidBody(2, tuple(arm + rod / 2), b**2 / 6, psi),
    ]
    return build(
        System(
            *("slider_crank", "", [Coordinate(q, "rad", "") for q in (phi, psi)] + [X]),
            [
                Parameter(s, *part, "")
                for s, part in {
                    a: ("m", 0.1),
                    b: ("m", 0.3),
                    P: ("N m", 0.5),
                    F: ("N", 1.0),
                }.items()
            ],
            [*masses, PointMass(1, (x, 0))],
            *(sp.S.Zero, None, sp.S.Zero, (P, 0, -F * sp.sign(v))),
            coincide=[(tuple(arm + rod), (x, 0))],
            keep_coordinates=keep_coordinates,
        )
    )


@cache
def stacked() -> GeneratedModule:
    """A block of 1 kg on a cart of 2 kg, pulled by a force that grows; friction F and G."""
    between, below = F * sp.sign(v - w), G * sp.sign(w)
    forces = (P * TIME - between, between - below)
    parameters = [Parameter(s, "N", 1.0, "friction") for s in (F, G)]
    parameters.append(Parameter(P, "N/s", 1.0, "growth of the force"))
    masses = [PointMass(1, (x, 0)), PointMass(2, (y, 0))]
    return build(System("stacked", "", [X, Y], parameters, masses, sp.S.Zero, forces=forces))
