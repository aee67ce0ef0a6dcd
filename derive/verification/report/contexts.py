"""Meanings of the report's symbols in terms of derived quantities.

Its y points downwards in vectors r (11)–(16) and upwards in positions (47)–(50). It writes
θ and φ for the same angles, and P for the potential energy and for momenta.
"""

from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any, TypeAlias

import sympy as sp

from derive.formulas import expression
from derive.formulas.numeric import Evaluator
from derive.mechanics.derivation import Derivation
from derive.mechanics.energies.reduction import reduced
from derive.system.files.system_catalogue import load
from derive.verification.judging.engine import Context
from derive.verification.judging.reference_system import depends_on, time_derivative

Vector: TypeAlias = sp.ImmutableDenseMatrix

#: A generic state for numeric witnesses: unequal masses and lengths, nothing at rest.
STATE = """
m1=1.3 m2=0.7 l1=1.1 l2=0.8 m=1.3 l=1.1 g=9.81 g_dot=0.21 theta1=0.6 theta2=-0.9 theta=0.6
theta1_dot=1.7 theta2_dot=-0.4 theta_dot=1.7 theta1_ddot=0.5 theta2_ddot=2.3 theta_ddot=0.5
chi1=0.3 chi2=0.2 t=0.4 theta0=0.15 psi=0.35 Ixx=1.1 Iyy=1.9 Izz=2.7 omega_x=0.4 omega_y=-0.7
omega_z=1.2 omega_x_dot=0.8 omega_y_dot=0.3 omega_z_dot=-0.6 stray=0.7
"""
NUMBERS = dict(pair.split("=") for pair in STATE.split())

#: The value of a printed letter without a meaning.
STRAY = sp.Symbol("stray")

G_DOT, TIME = sp.symbols("g_dot t", real=True)

FUNCTIONS: dict[str, Any] = {
    **{name: expression.FUNCTIONS[name] for name in ("sin", "cos", "sqrt", "pi")},
    "det": lambda matrix: matrix.det(),
    "inverse": lambda matrix: matrix.inv(),
    "norm": lambda vector: sp.sqrt(sp.factor_terms(reduced(vector.dot(vector)))),
    "at": lambda value, symbol, point: value.subs(symbol, point),
}

#: Letters for each coordinate and its momentum, which a number follows.
COORDINATES, MOMENTA = "theta phi q", "p p_theta p_phi P_theta"


@cache
def double_pendulum(*, moving: bool) -> Context:
    """The report's double pendulum; if `moving`, its equations of motion are assumed."""
    derivation = Derivation(load("double_pendulum"))
    system = derivation.system
    m1, m2, l1, l2, g = system.params
    (x1, y1), (x2, y2) = (mass.position for mass in system.masses)
    r1, r2 = (Vector([x, -y, 0]) for x, y in ((x1, y1), (x2, y2)))
    M = derivation.mass_matrix
    A = Vector(2, 2, lambda i, j: M[i, j] / M[i, i])
    namespace = _common_namespace(derivation) | {name: sp.Symbol(name) for name in ("chi1", "chi2")}
    namespace |= _named(
        "x1 y1 x2 y2 r1 r2 A B H", x1, y1, x2, y2, r1, r2, A, M, derivation.hamiltonian
    )
    ddt = namespace["ddt"]
    namespace |= {f"{name}_dot": ddt(namespace[name]) for name in ("x1", "y1", "x2", "y2")}
    speeds = (sp.sqrt(reduced(ddt(r).dot(ddt(r)))) for r in (r1, r2))
    namespace |= _named("v1 v2", *speeds)
    rows = zip(system.q, system.qdot, system.qddot, system.p, strict=True)
    for n, (q, qdot, qddot, p) in enumerate(rows, 1):
        for letter in COORDINATES.split():
            names = f"{letter}{n} {letter}{n}_dot {letter}{n}_ddot"
            namespace |= _named(names, q, qdot, qddot)
        for letter in MOMENTA.split():
            namespace |= _named(f"{letter}{n} {letter}{n}_dot", p, ddt(p))
        namespace |= _named(f"omega{n} E{n}", qdot, derivation.euler_lagrange[n - 1])
    # rod tensions: projections of Newton's law for each bob on its rod
    weight = Vector([0, g, 0])
    e1, e2 = r1 / l1, (r2 - r1) / l2
    F1, F2 = (m * ddt(ddt(r)) for m, r in ((m1, r1), (m2, r2)))
    T2 = reduced(-(F2 - m2 * weight).dot(e2))
    T1 = reduced(-(F1 - m1 * weight - T2 * e2).dot(e1))
    namespace |= _named("g_vector F1 F2 T1 T2", weight, F1, F2, T1, T2)
    return _context(derivation, namespace, moving=moving)


@cache
def single_pendulum(*, moving: bool) -> Context:
    """The report's single pendulum, including small oscillations."""
    derivation = Derivation(load("single_pendulum"))
    system = derivation.system
    (m, length, g), (q,), (qdot,), (qddot,) = system.params, system.q, system.qdot, system.qddot
    linear, residual = derivation.linearisation(), derivation.euler_lagrange[0]
    r, weight = length * Vector([sp.sin(q), sp.cos(q), 0]), Vector([0, g, 0])
    namespace = _common_namespace(derivation)
    F = m * namespace["ddt"](namespace["ddt"](r))
    T = -(F - m * weight).dot(r / length)
    speed, omega = sp.sqrt(length**2 * qdot**2), sp.sqrt(g / length)
    namespace |= _named("theta theta_dot theta_ddot E omega", q, qdot, qddot, residual, omega)
    namespace |= _named("r z v g_vector F T", r, r[2], speed, weight, F, T)
    namespace |= _named("I stiffness", linear.mass_matrix[0], linear.stiffness_matrix[0])
    namespace |= {name: sp.Symbol(name, real=True) for name in ("t", "theta0", "psi")}
    return _context(derivation, namespace, moving=moving)


@cache
def rigid_body() -> Context:
    """Torque on a rigid body in its principal axes: the inertial rate of change of I ω."""
    inertia = sp.symbols("Ixx Iyy Izz", positive=True)
    omega = sp.symbols("omega_x omega_y omega_z", real=True)
    omega_dot = sp.symbols("omega_x_dot omega_y_dot omega_z_dot", real=True)
    spin, spin_rate = (sp.diag(*inertia) * Vector(w) for w in (omega, omega_dot))
    torque = spin_rate + Vector(omega).cross(spin)
    symbols = (*inertia, *omega, *omega_dot)
    namespace = {s.name: s for s in symbols} | _named("tau_x tau_y tau_z", *torque)
    namespace |= _named("I_xx I_yy I_zz", *inertia)
    return Context(namespace, (Evaluator(_numbers(symbols)),), index_count=3)


def _named(names: str, *values: Any) -> dict[str, Any]:
    return dict(zip(names.split(), values, strict=True))


def _common_namespace(derivation: Derivation) -> dict[str, Any]:
    system = derivation.system
    momenta = dict(zip(system.p, derivation.momenta, strict=True))
    g = next(s for s in system.params if s.name == "g")

    def ddt(value: Any) -> Any:
        if depends_on(value, system.qddot):
            raise ValueError("third derivatives are not supported")
        return time_derivative(system, value.xreplace(momenta))

    def d(value: Any, symbol: sp.Symbol) -> Any:
        # L and H can depend on time through a varying gravity only
        varying = symbol == TIME and not value.has(TIME)
        return value.diff(g) * G_DOT if varying else value.diff(symbol)

    def only(value: Any, *symbols: sp.Symbol) -> Any:
        # the value with all other coordinates, velocities and accelerations set to 0
        if len({*symbols}) < len(symbols):
            raise ValueError("a quantity depends on different arguments")
        others = {*system.q, *system.qdot, *system.qddot} - {*symbols}
        return value.xreplace(momenta).subs(dict.fromkeys(others, 0))

    energies = derivation.kinetic_energy, derivation.potential_energy, derivation.lagrangian
    namespace = FUNCTIONS | {s.name: s for s in (*system.params, TIME)}
    return namespace | _named("K P L d ddt only", *energies, d, ddt, only)


def _context(derivation: Derivation, namespace: Mapping[str, Any], *, moving: bool) -> Context:
    system = derivation.system
    substitutions = [dict(zip(system.p, derivation.momenta, strict=True))]
    if moving:
        substitutions.append(dict(zip(system.qddot, derivation.accelerations, strict=True)))
    symbols = {symbol for symbol in namespace.values() if isinstance(symbol, sp.Symbol)}
    symbols |= {*system.q, *system.qdot, *system.qddot, *system.params}
    state = _numbers(symbols - {*system.p})
    for substitution in substitutions:
        for symbol, value in substitution.items():
            state[symbol] = value.evalf(50, subs=state)
    return Context(namespace, (Evaluator(state),), tuple(substitutions), len(system.q))


def _numbers(symbols: Iterable[sp.Symbol]) -> dict[sp.Symbol, sp.Expr]:
    by_name = {symbol.name: symbol for symbol in (*symbols, G_DOT, STRAY)}
    return {by_name[name]: sp.Rational(x) for name, x in NUMBERS.items() if name in by_name}
