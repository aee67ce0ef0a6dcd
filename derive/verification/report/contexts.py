"""What the report's symbols mean, in terms of our own derivations.

The report measures its vectors r with y downwards (11)–(16), and its positions
x, y with y upwards (47)–(50). It writes θ and φ for the same angles, and P for
the potential energy as well as for momenta.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any, TypeAlias

import sympy as sp

from derive.mechanics.derivation import Derivation
from derive.mechanics.reduction import reduced
from derive.system.catalogue import load
from derive.verification.statement import Context

Vector: TypeAlias = sp.ImmutableDenseMatrix

#: A generic state for numeric witnesses: unequal masses and lengths, nothing at rest.
NUMBERS = {
    "m1": "1.3", "m2": "0.7", "l1": "1.1", "l2": "0.8", "m": "1.3", "l": "1.1", "g": "9.81",
    "g_dot": "0.21", "theta1": "0.6", "theta2": "-0.9", "theta": "0.6", "theta1_dot": "1.7",
    "theta2_dot": "-0.4", "theta_dot": "1.7", "theta1_ddot": "0.5", "theta2_ddot": "2.3",
    "theta_ddot": "0.5", "chi1": "0.3", "chi2": "0.2", "t": "0.4", "theta0": "0.15",
    "psi": "0.35", "Ixx": "1.1", "Iyy": "1.9", "Izz": "2.7", "omega_x": "0.4",
    "omega_y": "-0.7", "omega_z": "1.2", "omega_x_dot": "0.8", "omega_y_dot": "0.3",
    "omega_z_dot": "-0.6", "stray": "0.7",
}  # fmt: skip

#: A letter that was printed and means nothing.
STRAY = sp.Symbol("stray")

FUNCTIONS: dict[str, Any] = {
    "sin": sp.sin,
    "cos": sp.cos,
    "sqrt": sp.sqrt,
    "pi": sp.pi,
    "det": lambda matrix: matrix.det(),
    "inverse": lambda matrix: matrix.inv(),
    "norm": lambda vector: sp.sqrt(sp.factor_terms(reduced(vector.dot(vector)))),
    "at": lambda expression, symbol, value: expression.subs(symbol, value),
}


@cache
def double_pendulum(*, moving: bool) -> Context:
    """The report's double pendulum; where `moving`, its equations of motion hold."""
    derivation = Derivation(load("double_pendulum"))
    system = derivation.system
    m1, m2, l1, l2, g = system.params
    M, H = derivation.mass_matrix, derivation.hamiltonian
    (x1, y1), (x2, y2) = (mass.position for mass in system.masses)
    r1, r2 = (Vector([x, -y, 0]) for x, y in ((x1, y1), (x2, y2)))
    scope = _common(derivation) | {
        "x1": x1, "y1": y1, "x2": x2, "y2": y2, "r1": r1, "r2": r2, "H": H,
        "A": Vector(2, 2, lambda i, j: M[i, j] / M[i, i]), "B": M,
        "chi1": sp.Symbol("chi1"), "chi2": sp.Symbol("chi2"),
    }  # fmt: skip
    for k in range(2):
        i, q, qdot, p = k + 1, system.q[k], system.qdot[k], system.p[k]
        scope |= {
            f"theta{i}": q, f"phi{i}": q, f"q_{i}": q, f"theta_{i}": q, f"phi_{i}": q,
            f"theta{i}_dot": qdot, f"phi{i}_dot": qdot, f"omega{i}": qdot,
            f"qdot_{i}": qdot, f"thetadot_{i}": qdot, f"phidot_{i}": qdot,
            f"theta{i}_ddot": system.qddot[k], f"phi{i}_ddot": system.qddot[k],
            f"p_theta{i}": p, f"P_theta{i}": p, f"p_phi{i}": p, f"p_{i}": p,
            f"P_theta_{i}": p, f"p_theta_{i}": p, f"p_phi_{i}": p,
            f"pdot_{i}": scope["ddt"](p), f"Pdot_theta{i}": scope["ddt"](p),
            f"Pdot_theta_{i}": scope["ddt"](p),
            f"E{i}": derivation.euler_lagrange[k], f"E_{i}": derivation.euler_lagrange[k],
        }  # fmt: skip
        for name, (x, y) in (("1", (x1, y1)), ("2", (x2, y2))):
            scope |= {f"x{name}_dot": scope["ddt"](x), f"y{name}_dot": scope["ddt"](y)}
    # rod tensions by projecting Newton's law for each bob on its rod
    weight = Vector([0, g, 0])
    e1, e2 = r1 / l1, (r2 - r1) / l2
    F1, F2 = (m * _acceleration(r, scope) for m, r in ((m1, r1), (m2, r2)))
    T2 = reduced(-(F2 - m2 * weight).dot(e2))
    scope |= {
        "g_vector": weight, "F1": F1, "F2": F2, "T2": T2,
        "T1": reduced(-(F1 - m1 * weight - T2 * e2).dot(e1)),
    }  # fmt: skip
    return _context(derivation, scope, moving=moving)


@cache
def single_pendulum(*, moving: bool) -> Context:
    """The report's single pendulum, its small oscillation included."""
    derivation = Derivation(load("single_pendulum"))
    system = derivation.system
    (m, length, g), (q,) = system.params, system.q
    linear = derivation.linearisation()
    r = length * Vector([sp.sin(q), sp.cos(q), 0])
    t, theta0, psi = sp.symbols("t theta0 psi", real=True)
    scope = _common(derivation) | {
        "theta": q, "theta_dot": system.qdot[0], "theta_ddot": system.qddot[0],
        "E": derivation.euler_lagrange[0], "r": r, "z": r[2], "g_vector": Vector([0, g, 0]),
        "v": sp.sqrt(length**2 * system.qdot[0] ** 2), "t": t, "theta0": theta0, "psi": psi,
        "I": linear.mass_matrix[0], "stiffness": linear.stiffness_matrix[0],
        "omega": sp.sqrt(g / length),
    }  # fmt: skip
    F = m * _acceleration(r, scope)
    scope |= {"F": F, "T": -(F - m * scope["g_vector"]).dot(r / length)}
    return _context(derivation, scope, moving=moving)


@cache
def rigid_body() -> Context:
    """Torque on a rigid body in its principal axes: the rate of I ω as seen from space."""
    inertia = sp.symbols("Ixx Iyy Izz", positive=True)
    omega = sp.symbols("omega_x omega_y omega_z", real=True)
    omega_dot = sp.symbols("omega_x_dot omega_y_dot omega_z_dot", real=True)
    spin = Vector([i * w for i, w in zip(inertia, omega, strict=True)])
    change = Vector([i * w for i, w in zip(inertia, omega_dot, strict=True)])
    torque = change + Vector(omega).cross(spin)
    symbols = (*inertia, *omega, *omega_dot)
    scope = {s.name: s for s in symbols}
    scope |= dict(zip(("tau_x", "tau_y", "tau_z"), torque, strict=True))
    return Context(scope, (), _numbers(symbols), 3)


def _common(derivation: Derivation) -> dict[str, Any]:
    system = derivation.system
    momenta = dict(zip(system.p, derivation.momenta, strict=True))
    rates = dict(zip(system.q + system.qdot, system.qdot + system.qddot, strict=True))
    g = next(s for s in system.params if s.name == "g")
    g_dot, time = sp.Symbol("g_dot", real=True), sp.Symbol("t", real=True)

    def ddt(value: Any) -> Any:
        if value.free_symbols & {*system.qddot}:
            raise ValueError("third derivatives have no symbol here")
        value = value.xreplace(momenta)
        terms = [value.diff(s) * rate for s, rate in rates.items()]
        return sum(terms[1:], terms[0])

    def d(value: Any, symbol: sp.Symbol) -> Any:
        if symbol == time and not value.has(time):
            # the one way in which L and H may know the time: a weight that changes
            return value.diff(g) * g_dot
        return value.diff(symbol)

    def only(value: Any, *symbols: sp.Symbol) -> Any:
        # what is left of a value when all coordinates and velocities but these are taken away
        others = {*system.q, *system.qdot, *system.qddot} - {*symbols}
        return value.xreplace(momenta).subs(dict.fromkeys(others, 0))

    return FUNCTIONS | {s.name: s for s in (*system.params, time)} | {
        "d": d, "ddt": ddt, "only": only, "K": derivation.kinetic_energy,
        "P": derivation.potential_energy, "L": derivation.lagrangian,
    }  # fmt: skip


def _acceleration(r: Vector, scope: Mapping[str, Any]) -> Vector:
    return scope["ddt"](scope["ddt"](r))


def _context(derivation: Derivation, scope: Mapping[str, Any], *, moving: bool) -> Context:
    system = derivation.system
    substitutions = [dict(zip(system.p, derivation.momenta, strict=True))]
    if moving:
        substitutions.append(dict(zip(system.qddot, derivation.accelerations, strict=True)))
    extra = [s for s in scope.values() if isinstance(s, sp.Symbol)]
    state = _numbers({*system.q, *system.qdot, *system.qddot, *system.params, *extra} - {*system.p})
    for substitution in substitutions:
        for symbol, value in substitution.items():
            state[symbol] = value.evalf(50, subs=state)
    return Context(scope, tuple(substitutions), state, len(system.q))


def _numbers(symbols: Any) -> dict[sp.Symbol, sp.Expr]:
    extra = sp.Symbol("g_dot", real=True), STRAY
    return {s: sp.Rational(NUMBERS[s.name]) for s in (*symbols, *extra)}
