"""Derivation times of chains of pendulums, here and with SymPy's own mechanics."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp
import sympy.physics.mechanics as me
from sympy.core.cache import clear_cache

from derive.codegen.module_files import files
from derive.codegen.module_functions import contents
from derive.mechanics.derivation import Derivation
from derive.system.files.system_catalogue import load


def lambdified_rhs() -> Callable[..., Any]:
    """SymPy's function for the right-hand side of the double pendulum."""
    derivation = Derivation(load("double_pendulum"))
    system = derivation.system
    rates = [*system.qdot, *derivation.accelerations]
    return sp.lambdify([[*system.q, *system.qdot], system.params], rates, "numpy")


def chain(n: int, form: str = "") -> tuple[float, float, str, str]:
    """Seconds to derive and to write a right-hand side of n pendulums, and both texts."""
    clear_cache()  # otherwise SymPy reuses earlier results
    start = time.perf_counter()
    generated = contents(Derivation(load(f"chain_{n}")), (f"rhs{form}",))
    derived = time.perf_counter()
    texts = files(generated)
    seconds = time.perf_counter() - derived
    return derived - start, seconds, texts[f"chain_{n}.py"], texts[f"chain_{n}.h"]


@dataclass(frozen=True)
class Mechanics:
    """A chain of pendulums by SymPy's own mechanics."""

    mass_matrix: sp.Matrix  # of the equations of first order: coordinates, then speeds
    forcing: sp.Matrix
    coordinates: Sequence[Any]  # functions of time, as the speeds
    speeds: Sequence[Any]
    constants: Sequence[sp.Symbol]  # masses, lengths and g

    @property
    def rates(self) -> list[sp.Expr]:
        """The equations, solved."""
        return list(self.mass_matrix.LUsolve(self.forcing))


def mechanics(n: int) -> Mechanics:
    """Derive a chain of n pendulums, as SymPy's documentation does."""
    method, q, constants = _lagranges_method(n)
    speeds = me.dynamicsymbols(f"u1:{n + 1}")
    named = dict(zip((angle.diff() for angle in q), speeds, strict=True))
    mass_matrix, forcing = (m.subs(named) for m in (method.mass_matrix_full, method.forcing_full))
    return Mechanics(mass_matrix, forcing, q, speeds, constants)


def lagranges_method(n: int) -> float:
    """Seconds until SymPy's ``LagrangesMethod`` and ``lambdify`` have M and f of n pendulums."""
    clear_cache()
    start = time.perf_counter()
    method, q, constants = _lagranges_method(n)
    state = (q, [angle.diff() for angle in q], *constants)
    sp.lambdify(state, (method.mass_matrix, method.forcing), cse=True)
    return time.perf_counter() - start


def _lagranges_method(n: int) -> tuple[Any, list[Any], tuple[sp.Symbol, ...]]:
    q, g = me.dynamicsymbols(f"theta1:{n + 1}"), sp.Symbol("g")
    m, lengths = sp.symbols(f"m1:{n + 1}"), sp.symbols(f"l1:{n + 1}")
    frame, pivot = me.ReferenceFrame("N"), me.Point("O")
    pivot.set_vel(frame, 0)
    x, y, bobs = sp.S.Zero, sp.S.Zero, []
    for k in range(n):
        x, y = x + lengths[k] * sp.sin(q[k]), y - lengths[k] * sp.cos(q[k])
        point = pivot.locatenew(f"P{k}", x * frame.x + y * frame.y)
        point.set_vel(frame, point.pos_from(pivot).dt(frame))
        bob = me.Particle(f"bob{k}", point, m[k])
        bob.potential_energy = m[k] * g * y
        bobs.append(bob)
    method = me.LagrangesMethod(me.Lagrangian(frame, *bobs), q)
    method.form_lagranges_equations()
    return method, q, (*m, *lengths, g)
