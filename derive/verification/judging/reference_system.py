"""A derivation with generic states, against which formulas about its system are judged."""

from collections.abc import Callable, Collection, Hashable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import islice
from typing import Any, Self, TypeVar

import sympy as sp

from derive.formulas.expression import FUNCTIONS, Namespace, Value
from derive.formulas.functions import derivative, turning_arguments
from derive.formulas.generic_values import STATES, is_small, near_zeros, sample
from derive.formulas.numeric import Evaluator, NoValueError, solved
from derive.formulas.syntax import ExpressionError
from derive.mechanics.derivation import Derivation
from derive.system.symbols import TIME
from derive.system.system import System
from derive.verification.judging.constrained_motions import motion
from derive.verification.judging.engine import IN_NUMBERS, UNDECIDED, Context, State

#: Coordinates of the largest systems whose mass matrix, any or a diagonal one, is inverted in
#: formulas: with four, this takes a minute. Accelerations of larger ones are judged in numbers.
LARGEST_INVERSE, LARGEST_DIAGONAL = 3, 7

#: Factors of coordinates at states, tried until the Lagrangian is real: a thread limits
#: coordinates from above, a wheel's axis from below.
SIZES = (sp.S.One, sp.Rational(1, 20), sp.Integer(5))
#: The number of states near the turning arguments of a formula.
MOST_TURNING = 60
#: Factors of all variables, by which decisive numbers change their signs.
SCALES = tuple(sp.Integer(10) ** power for power in (0, 1, -1, 2, -2, 3, -3))

Result = TypeVar("Result")


@dataclass(frozen=True)
class ReferenceSystem:
    """A derivation, and names that formulas can use in addition to those of its system.

    Momenta and energy follow from `source_lagrangian`, the source's own, if there is one.
    """

    derivation: Derivation
    names: Namespace
    source_lagrangian: sp.Expr | None = None
    #: A formula near whose own turning arguments there are further states, if it has any.
    printed: sp.Expr | None = None
    #: Results that do not depend on the names, for all models that replace parts of this one,
    #: each with the derivation and the Lagrangian on which it depends.
    _shared: dict[tuple[Hashable, ...], Any] = field(
        default_factory=dict, repr=False, compare=False
    )

    def with_lagrangian(self, lagrangian: sp.Expr) -> Self:
        """The model with another Lagrangian that has the same equations of motion."""
        return replace(self, source_lagrangian=lagrangian)

    def of(self, derivation: Derivation, names: Namespace) -> Self:
        """A derivation with other names; what is known of derivations remains."""
        return replace(
            self, derivation=derivation, names=names, source_lagrangian=None, printed=None
        )

    def about(self, printed: sp.Expr) -> Self:
        """The model with states near the turning arguments of a formula that the system has not.

        Between states, the formula can have another form: what is not proved is undecided.
        """
        if self._own_turns(printed):
            return replace(self, printed=printed)
        return replace(self, printed=None) if self.printed is not None else self

    def _own_turns(self, printed: sp.Expr) -> list[sp.Expr]:
        turns, system = turning_arguments(printed), self.derivation.system
        if system.conditions:  # their roots are coordinates that constraints give
            turns = tuple(one for one in turns if not one[1].startswith("power"))
        if not turns:
            return []
        conditions = (one.formula for one in system.conditions)
        known = turning_arguments(
            sp.Tuple(self.derivation.lagrangian, *system.applied, *conditions)
        )
        return [
            number
            for number, kind in turns
            if not any(kind == own and _turn_together(number, one, kind) for one, own in known)
        ]

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
    def forces(self) -> tuple[sp.Expr, ...]:
        """The applied forces without those that are in the Lagrangian of the source."""
        system = self.derivation.system
        if self.source_lagrangian is None or not any(system.applied):
            return tuple(system.applied)
        own = euler_lagrange(system, self.source_lagrangian - self.derivation.lagrangian)
        return tuple(force + given for force, given in zip(system.applied, own, strict=True))

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
        namespace = {**own_names(system), **self.names}
        rates = {f"{p}_dot": time_derivative(system, value) for p, value in self.momenta.items()}
        evaluators = self._evaluators_at("generic", self._generic)
        unproved = IN_NUMBERS if self.printed is None else UNDECIDED
        return Context({**rates, **namespace}, evaluators, (self.momenta,), unproved=unproved)

    @cached_property
    def motions(self) -> Context:
        """The names of formulas, and generic states with the accelerations of motions."""
        system, derivation = self.derivation.system, self.derivation
        if system.conditions:
            dependent = frozenset((*system.q, *system.qdot, *system.qddot, *system.multipliers))
            moved = self._evaluators_at("moved", self._moved)
            return replace(self.context, evaluators=moved, implicit=dependent)
        moving = self._evaluators_at("moving", self._moving)
        context = replace(self.context, evaluators=moving)
        if not self.has_inverse:
            return replace(context, implicit=frozenset(system.qddot))
        accelerations = dict(zip(system.qddot, derivation.accelerations, strict=True))
        return replace(context, substitutions=(self.momenta, accelerations))

    def agreement(self, difference: sp.Expr) -> str | None:
        """A note if a difference is zero at all states or along motions, otherwise None."""
        note = self.context.agreement(difference)
        return self.motions.agreement(difference) if note is None else note

    def constancy(self, value: sp.Expr) -> str | None:
        """A note if a value is the same at all states and times, otherwise None."""
        system = self.derivation.system
        value = value.xreplace(self.momenta)
        slopes = (value.diff(one) for one in (*system.q, *system.qdot, TIME))
        return self.context.agreement(*slopes)

    def _evaluators_at(
        self, kind: str, states: Callable[[], Iterator[State]]
    ) -> tuple[Evaluator, ...]:
        """Evaluators at states of a kind, the same for all models with these energies."""
        return self.once((kind, self.printed), lambda: tuple(map(Evaluator, states())))

    def once(self, key: Hashable, compute: Callable[[], Result]) -> Result:
        """A result that depends on the derivation, the Lagrangian and a key alone."""
        whole = self.derivation, self.source_lagrangian, key
        if whole not in self._shared:
            self._shared[whole] = compute()
        result: Result = self._shared[whole]
        return result

    def _generic(self) -> Iterator[State]:
        """The generic states, and those near the turning arguments of a formula."""
        yield from map(self._state, range(STATES))
        yield from self._further_states
        if self.printed is not None:
            yield from islice(self._turning_states(self.printed), MOST_TURNING)

    def _moving(self) -> Iterator[State]:
        """The states with the accelerations of motions."""
        derivation, qddot = self.derivation, self.derivation.system.qddot
        for evaluator in self.context.evaluators:
            values = solved(derivation.mass_matrix, derivation.forcing, evaluator)
            yield {**evaluator.state, **dict(zip(qddot, values, strict=True))}

    def _moved(self) -> Iterator[State]:
        """The states of motions near the generic ones, and those near others that exist."""
        for index, state in enumerate(self.context.states):
            try:
                yield motion(self.derivation, state)
            except ExpressionError:
                if index < STATES:
                    raise

    def _turning_states(self, printed: sp.Expr) -> Iterator[State]:
        """States near zeros of the turning arguments of a formula, where it is a real number."""
        system = self.derivation.system
        symbols = (*system.qdot, *system.q, TIME, *system.qddot, *system.params)
        for number in self._own_turns(printed):
            number = number.xreplace(self.momenta)
            for near in near_zeros(number, self._state(0), symbols):
                state = self._with_momenta(near)
                if _is_real(self.derivation.lagrangian, state) and _is_real(printed, state):
                    yield state

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
        for size in SIZES if self._can_be_complex else ():
            state = values | {q: values[q] * size for q in system.q}
            if _is_real(self.derivation.lagrangian, state):
                return self._with_momenta(state)
        return self._with_momenta(values)

    @cached_property
    def _can_be_complex(self) -> bool:
        """Whether the Lagrangian has roots, or functions other than sines and cosines."""
        return bool(turning_arguments(self.derivation.lagrangian))

    def _with_momenta(self, state: State) -> State:
        evaluator = Evaluator({s: x for s, x in state.items() if s not in self.momenta})
        return {**state, **{p: evaluator(x).rounded() for p, x in self.momenta.items()}}


def variables(system: System) -> tuple[sp.Symbol, ...]:
    """Coordinates, velocities, accelerations, momenta, time and multipliers."""
    return (*system.q, *system.qdot, *system.qddot, *system.p, TIME, *system.multipliers)


def own_names(system: System) -> Namespace:
    """Names of the system's variables, of its parameters, and of functions."""
    return {s.name: s for s in (*variables(system), *system.params)} | FUNCTIONS


def time_derivative(system: System, value: Value) -> Value:
    """The time derivative of a function of coordinates, velocities and time."""
    rates = zip((*system.q, *system.qdot), (*system.qdot, *system.qddot), strict=True)
    slope = derivative if isinstance(value, sp.Expr) else sp.diff
    return sum((slope(value, symbol) * rate for symbol, rate in rates), slope(value, TIME))


def euler_lagrange(system: System, lagrangian: sp.Expr) -> tuple[sp.Expr, ...]:
    """d/dt ∂L/∂q̇ - ∂L/∂q for each coordinate."""
    pairs = zip(system.q, system.qdot, strict=True)
    return tuple(
        time_derivative(system, lagrangian.diff(qdot)) - lagrangian.diff(q) for q, qdot in pairs
    )


def depends_on(value: Value, symbols: Collection[sp.Symbol]) -> bool:
    """Whether `value` contains one of `symbols`."""
    return bool(value.free_symbols & {*symbols})


def _is_real(expression: sp.Expr, state: State) -> bool:
    try:
        return bool(Evaluator(state)(expression).rounded().is_real)
    except (NoValueError, NotImplementedError):
        return False


def _turn_together(one: sp.Expr, other: sp.Expr, kind: str) -> bool:
    """Whether a function of two numbers changes its form at the same states.

    For choices and roots, the quotient of the numbers may depend on positive symbols.
    """
    symbols = one.free_symbols | other.free_symbols
    moving = [symbol for symbol in symbols if not symbol.is_positive]
    if not moving or not kind.startswith(("choice", "power")):
        return is_small(one - other) or is_small(one + other)
    return all(is_small(one.diff(s) * other - one * other.diff(s)) for s in moving)
