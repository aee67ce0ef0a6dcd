"""A derivation with generic states, against which formulas about its system are judged."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import sympy as sp

from derive.formulas.derivative import derivative
from derive.formulas.expression import FUNCTIONS, Scope, Value
from derive.formulas.numeric import Evaluator, NoValueError, solved
from derive.formulas.sampling import STATES, sample
from derive.mechanics.derivation import Derivation
from derive.system.symbols import TIME
from derive.system.system import System
from derive.verification.constrained_motions import motion
from derive.verification.engine import Context, State

#: Coordinates of the largest systems whose mass matrix, any or a diagonal one, is inverted in
#: formulas: with four, this takes a minute. Accelerations of larger ones are judged in numbers.
LARGEST_INVERSE, LARGEST_DIAGONAL = 3, 7

#: Factors of coordinates at states, tried until the Lagrangian is real: a thread limits
#: coordinates from above, a wheel's axis from below.
SIZES = (sp.S.One, sp.Rational(1, 20), sp.Integer(5))
#: Factors of all variables, by which decisive numbers change their signs.
SCALES = tuple(sp.Integer(10) ** power for power in (0, 1, -1, 2, -2, 3, -3))


@dataclass(frozen=True)
class Model:
    """A derivation, and names that formulas can use in addition to those of its system.

    Momenta and energy follow from `source_lagrangian`, the source's own, if there is one.
    """

    derivation: Derivation
    names: Scope
    source_lagrangian: sp.Expr | None = None

    def with_lagrangian(self, lagrangian: sp.Expr) -> Self:
        """The model with another Lagrangian that has the same equations of motion."""
        return replace(self, source_lagrangian=lagrangian)

    @cached_property
    def lagrangian(self) -> sp.Expr:
        """The Lagrangian of the source, or the derived one."""
        derived = self.derivation.lagrangian
        return derived if self.source_lagrangian is None else self.source_lagrangian

    @cached_property
    def momenta(self) -> Mapping[sp.Symbol, sp.Expr]:
        """∂L/∂q̇ of the Lagrangian, by the momentum's symbol."""
        system, values = self.derivation.system, list(self.derivation.momenta)
        if self.source_lagrangian is not None:
            values = [self.source_lagrangian.diff(qdot) for qdot in system.qdot]
        return dict(zip(system.p, values, strict=True))

    @cached_property
    def energy(self) -> sp.Expr:
        """q̇·∂L/∂q̇ - L of the Lagrangian."""
        if self.source_lagrangian is None:
            return self.derivation.energy
        pairs = zip(self.derivation.system.qdot, self.momenta.values(), strict=True)
        return sp.Add(*(qdot * p for qdot, p in pairs)) - self.source_lagrangian

    @cached_property
    def has_inverse(self) -> bool:
        """Whether accelerations and Hamiltonian are derived as formulas, which takes seconds."""
        if self.derivation.system.conditions:
            return False
        M = self.derivation.mass_matrix
        return M.rows <= (LARGEST_DIAGONAL if M.is_diagonal() else LARGEST_INVERSE)

    @cached_property
    def context(self) -> Context:
        """The names of formulas, and generic states with any accelerations."""
        system = self.derivation.system
        scope = {**own_names(system), **self.names}
        rates = {f"{p}_dot": time_derivative(system, value) for p, value in self.momenta.items()}
        states = (*(self._state(index) for index in range(STATES)), *self._further_states)
        return Context({**rates, **scope}, states, (self.momenta,))

    @cached_property
    def motions(self) -> Context:
        """The names of formulas, and generic states with the accelerations of motions."""
        system, derivation = self.derivation.system, self.derivation
        if system.conditions:
            dependent = frozenset((*system.q, *system.qdot, *system.qddot, *system.multipliers))
            moved = tuple(motion(derivation, state) for state in self.context.states)
            return replace(self.context, states=moved, implicit=dependent)
        states = []
        for state, evaluator in zip(self.context.states, self.context.evaluators, strict=True):
            values = solved(derivation.mass_matrix, derivation.forcing, evaluator)
            states.append({**state, **dict(zip(system.qddot, values, strict=True))})
        context = replace(self.context, states=tuple(states))
        if not self.has_inverse:
            return replace(context, implicit=frozenset(system.qddot))
        accelerations = dict(zip(system.qddot, derivation.accelerations, strict=True))
        return replace(context, substitutions=(self.momenta, accelerations))

    def agreement(self, difference: sp.Expr) -> str | None:
        """A note if a difference is zero at all states or along motions, otherwise None."""
        note = self.context.agreement(difference)
        return self.motions.agreement(difference) if note is None else note

    @property
    def _further_states(self) -> list[State]:
        """Larger or smaller states at which decisive numbers have signs not met before."""
        functions, states = self.derivation.decisive_numbers, list[State]()
        met = set[tuple[int, bool]]()
        for scale in SCALES if functions else ():
            for index in range(STATES):
                state = self._state(index, scale)
                evaluator = Evaluator(state)
                signs = {(k, bool(evaluator(s).number.real > 0)) for k, s in enumerate(functions)}
                if scale != 1 and signs - met:
                    states.append(state)
                met |= signs
        return states

    def _state(self, index: int, scale: sp.Expr = sp.S.One) -> State:
        """One of several states at which nothing vanishes, with the momenta of its velocities."""
        system = self.derivation.system
        moving = (*system.q, *system.qdot, *system.qddot, TIME, *system.multipliers)
        values = sample((*system.params, *moving), index)
        # at later states, angles exceed a right angle, so that sqrt(cos(x)**2) and cos(x) differ
        values |= {symbol: values[symbol] * scale * sp.Rational(1 + index, 5) for symbol in moving}
        for size in SIZES:
            state = values | {q: values[q] * size for q in system.q}
            if _is_real(self.derivation.lagrangian, state):
                break
        else:
            state = values
        evaluator = Evaluator(state)
        return state | {p: evaluator(value).rounded() for p, value in self.momenta.items()}


def variables(system: System) -> tuple[sp.Symbol, ...]:
    """Coordinates, velocities, accelerations, momenta, time and multipliers."""
    return (*system.q, *system.qdot, *system.qddot, *system.p, TIME, *system.multipliers)


def own_names(system: System) -> Scope:
    """Names of the system's variables, of its parameters, and of functions."""
    return {s.name: s for s in (*variables(system), *system.params)} | FUNCTIONS


def time_derivative(system: System, value: Value) -> Value:
    """The time derivative of a function of coordinates, velocities and time."""
    rates = zip((*system.q, *system.qdot), (*system.qdot, *system.qddot), strict=True)
    slope = derivative if isinstance(value, sp.Expr) else sp.diff
    return sum((slope(value, symbol) * rate for symbol, rate in rates), slope(value, TIME))


def depends_on(value: Value, symbols: Collection[sp.Symbol]) -> bool:
    """Whether `value` contains one of `symbols`."""
    return bool(value.free_symbols & {*symbols})


def _is_real(expression: sp.Expr, state: State) -> bool:
    try:
        return bool(Evaluator(state)(expression).rounded().is_real)
    except NoValueError:
        return False
