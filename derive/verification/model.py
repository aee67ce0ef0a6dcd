"""A derivation with generic states, against which formulas about its system are judged."""

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from derive.formulas.expression import FUNCTIONS, Scope, Value
from derive.mechanics.derivation import Derivation
from derive.system.symbols import TIME
from derive.system.system import System
from derive.verification.engine import DIGITS, SUFFICIENT_STATES, TINY, Context, State, is_small


@dataclass(frozen=True)
class Model:
    """A derivation, and names that formulas can use in addition to those of its system."""

    derivation: Derivation
    names: Scope

    @cached_property
    def context(self) -> Context:
        """The names of formulas, and generic states."""
        system = self.derivation.system
        states = tuple(generic_state(system, index) for index in range(SUFFICIENT_STATES))
        return Context({**own_names(system), **self.names}, states)

    def holds_along_motions(self, residual: sp.Expr) -> bool:
        """Whether an equation of motion holds with the derived accelerations, in numbers."""
        derivation, accelerations = self.derivation, self.derivation.system.qddot
        for state in self.context.states:
            M = derivation.mass_matrix.evalf(DIGITS, subs=state)
            f = derivation.forcing.evalf(DIGITS, subs=state)
            solved = {**state, **dict(zip(accelerations, M.LUsolve(f), strict=True))}
            derivatives = [residual.diff(a).evalf(DIGITS, subs=solved) for a in accelerations]
            # an identity, which holds with any accelerations, is not an equation of motion
            if not is_small(residual, solved) or max(map(abs, derivatives)) < TINY:
                return False
        return True


def variables(system: System) -> tuple[sp.Symbol, ...]:
    """Coordinates, velocities, accelerations, momenta and time."""
    return (*system.q, *system.qdot, *system.qddot, *system.p, TIME)


def own_names(system: System) -> Scope:
    """Names of the system's variables, of its parameters, and of functions."""
    return {s.name: s for s in (*variables(system), *system.params)} | FUNCTIONS


def generic_state(system: System, index: int) -> State:
    """One of many states at which nothing vanishes; at the first, coordinates are small."""
    shift = 17 + 3 * index
    values = {s: sp.Rational(11 * k + shift, 7 * k + 11) for k, s in enumerate(system.params)}
    for k, symbol in enumerate(variables(system)):
        # signs vary, and angles exceed a right angle, so that sqrt(x**2) and x differ
        size = sp.Rational(5 * k + 3 + index, 9 * k + 14) * (1 + index)
        values[symbol] = size * (1 if symbol.is_positive else (-1) ** ((k + index) % 3))
    return values


def time_derivative(system: System, value: Value) -> Value:
    """The time derivative of a function of coordinates, velocities and time."""
    rates = zip((*system.q, *system.qdot), (*system.qdot, *system.qddot), strict=True)
    return sum((value.diff(symbol) * rate for symbol, rate in rates), value.diff(TIME))


def depends_on(value: Value, symbols: Collection[sp.Symbol]) -> bool:
    """Whether `value` contains one of `symbols`."""
    return bool(value.free_symbols & {*symbols})
