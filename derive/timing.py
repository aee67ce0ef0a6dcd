"""What deriving a chain of pendulums costs, here and with SymPy's own mechanics."""

from __future__ import annotations

import time

import sympy as sp
from sympy.core.cache import clear_cache
from sympy.physics.mechanics import (
    LagrangesMethod,
    Lagrangian,
    Particle,
    Point,
    ReferenceFrame,
    dynamicsymbols,
)

from derive.c import header
from derive.catalogue import load
from derive.derivation import Derivation
from derive.functions import contents
from derive.python import module


def chain(n: int, form: str = "") -> tuple[float, float, str, str]:
    """Seconds to derive and to emit a right-hand side of n pendulums, and both texts."""
    clear_cache()  # SymPy remembers what it has computed
    begin = time.perf_counter()
    generated = contents(Derivation(load(f"chain_{n}")), (f"rhs{form}",))
    derived = time.perf_counter()
    python, c = module(generated), header(generated)
    return derived - begin, time.perf_counter() - derived, python, c


def lagranges_method(n: int) -> float:
    """Seconds until SymPy's ``LagrangesMethod`` and ``lambdify`` have M and f of n pendulums."""
    clear_cache()
    begin = time.perf_counter()
    q, g = dynamicsymbols(f"theta1:{n + 1}"), sp.Symbol("g")
    m, lengths = sp.symbols(f"m1:{n + 1}"), sp.symbols(f"l1:{n + 1}")
    frame, pivot = ReferenceFrame("N"), Point("O")
    pivot.set_vel(frame, 0)
    x, y, bobs = sp.S.Zero, sp.S.Zero, []
    for k in range(n):
        x, y = x + lengths[k] * sp.sin(q[k]), y - lengths[k] * sp.cos(q[k])
        place = pivot.locatenew(f"P{k}", x * frame.x + y * frame.y)
        place.set_vel(frame, place.pos_from(pivot).dt(frame))
        bob = Particle(f"bob{k}", place, m[k])
        bob.potential_energy = m[k] * g * y
        bobs.append(bob)
    method = LagrangesMethod(Lagrangian(frame, *bobs), q)
    method.form_lagranges_equations()
    state = (q, [angle.diff() for angle in q], m, lengths, g)
    sp.lambdify(state, (method.mass_matrix, method.forcing), cse=True)
    return time.perf_counter() - begin
