"""Formulas that hold for small motions about an equilibrium."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from itertools import product

import sympy as sp

from derive.formulas.generic_values import is_small
from derive.formulas.syntax import ExpressionError
from derive.mechanics.derivation import Derivation
from derive.system.parts import SystemDefinitionError
from derive.system.symbols import TIME
from derive.system.system import System
from derive.verification.documents.letters.energies import StatedInertia
from derive.verification.documents.letters.letters import KINDS
from derive.verification.judging.reference_system import ReferenceSystem

#: Coordinates of the largest systems whose accelerations are solved for.
MAX_INVERSE = 3
#: The value of parameters that only couple accelerations.
COUPLING = 0.1
EPSILON = sp.Symbol("epsilon", positive=True)


class SmallMotions:
    """The linearised equations of motion of a derivation, with forces that are small, too."""

    def __init__(
        self, derivation: Derivation, place: Mapping[sp.Symbol, sp.Expr] | None = None
    ) -> None:
        self._derivation, self._place = derivation, place

    def agrees(self, difference: sp.Expr, model: ReferenceSystem) -> bool:
        """Whether a difference vanishes to first order at the origin."""
        scaled = self._scaled(difference)
        try:
            values = (scaled.subs(EPSILON, 0), scaled.diff(EPSILON).subs(EPSILON, 0))
            return all(map(model.context.is_zero, values))
        except (ExpressionError, NotImplementedError):
            return False

    def holds(
        self,
        difference: sp.Expr,
        model: ReferenceSystem,
        *,
        is_displaced: bool = False,
        is_first_order: bool = False,
    ) -> bool:
        """Whether a difference that is linear in the state vanishes along small motions.

        With `is_displaced`, coordinates in it are displacements from the equilibrium; with
        `is_first_order`, it need not be linear.
        """
        system = self._derivation.system
        state = (*system.q, *system.qdot, *system.qddot)
        has_place = self.is_origin or (is_displaced and self.place is not None)
        if not difference.free_symbols & {*state} or not has_place:
            return False
        scaled, is_zero = self._scaled(difference), model.context.is_zero
        try:
            if not is_zero(scaled.subs(EPSILON, 0)):
                return False
            if not is_first_order and not is_zero(scaled.diff(EPSILON, 2)):
                return False
            linear = sp.expand(scaled.diff(EPSILON).subs(EPSILON, 0))
            if is_first_order and linear == 0:
                return True
            if not linear.is_Add:
                return False  # a term that vanishes by itself, as r_ddot does, has no right factor
            if self.accelerations is not None:
                return is_zero(linear.xreplace(self.accelerations))
            return any(is_zero(one) for one in self._combinations(linear))
        except (ExpressionError, NotImplementedError):
            return False

    def is_solution(self, value: sp.Expr) -> bool:
        """Whether a function of time solves the linear equation of a single coordinate.

        So does the rate of such a function.
        """
        system = self._derivation.system
        if len(system.q) > 1 or not self.is_origin or not value.has(TIME):
            return False
        rates = (value, value.diff(TIME), value.diff(TIME, 2))
        symbols = (*system.q, *system.qdot, *system.qddot)
        rest = self._equations[0].xreplace(dict(zip(symbols, rates, strict=True)))
        return bool(sp.simplify(rest) == 0)

    def is_motion(self, motions: Mapping[sp.Symbol, sp.Expr]) -> bool:
        """Whether functions of time of all coordinates solve the linear equations."""
        system = self._derivation.system
        if {*motions} != {*system.q} or not self.is_origin or system.conditions:
            return False
        if not all(value.has(TIME) for value in motions.values()):
            return False
        rates = along(system, motions)
        return all(is_small(one.xreplace(rates)) for one in self._equations)

    def acceleration(self, symbol: sp.Symbol, value: sp.Expr) -> sp.Expr | None:
        """The acceleration of small motions if `value` seems to be one: without functions."""
        full = self._derivation.euler_lagrange
        if not self.is_origin:
            return None
        if value.atoms(sp.Function) or not sp.Tuple(*full).atoms(sp.Function):
            return None
        return (self.accelerations or {}).get(symbol)

    @cached_property
    def place(self) -> Mapping[sp.Symbol, sp.Expr] | None:
        """An equilibrium: one that is given, the origin, or where springs at 0 are at rest."""
        if self._place is not None:
            return self._place
        system = self._derivation.system
        place = dict.fromkeys(system.q, sp.S.Zero)
        for q, force in zip(system.q, self._forces_at_rest, strict=True):
            others = {one: value for one, value in place.items() if one != q}
            rest = force.xreplace(others)
            slope = rest.diff(q)
            if rest.subs(q, 0) != 0 and slope != 0 and q not in slope.free_symbols:
                place[q] = sp.expand(-rest.subs(q, 0) / slope)
        return place if self._is_equilibrium(place) else None

    @cached_property
    def _forces_at_rest(self) -> list[sp.Expr]:
        system = self._derivation.system
        still = dict.fromkeys((*system.qdot, *system.qddot, *self._forces), sp.S.Zero)
        return [one.xreplace(still) for one in self._derivation.euler_lagrange]

    def _is_equilibrium(self, place: Mapping[sp.Symbol, sp.Expr]) -> bool:
        return all(is_small(one.xreplace(place)) for one in self._forces_at_rest)

    @property
    def is_origin(self) -> bool:
        """Whether there is an equilibrium at the origin."""
        return self.place is not None and not any(self.place.values())

    @cached_property
    def matrices(self) -> tuple[sp.Matrix, sp.Matrix, sp.Matrix, Mapping[sp.Symbol, sp.Matrix]]:
        """M, D, K and the columns of forces F of M q̈ + D q̇ + K q = F about the equilibrium."""
        system, equations = self._derivation.system, self._equations

        def column(symbol: sp.Symbol) -> sp.Matrix:
            return sp.Matrix([one.diff(symbol) for one in equations])

        M, D, K = (
            sp.Matrix.hstack(*map(column, symbols))
            for symbols in (system.qddot, system.qdot, system.q)
        )
        return M, D, K, {one: -column(one) for one in sorted(self._forces, key=str)}

    @cached_property
    def _equations(self) -> list[sp.Expr]:
        """The linear equations of motion."""
        assert self.place is not None
        shifts = {q: value + EPSILON * q for q, value in self.place.items()}
        system = self._derivation.system
        shifts |= {s: EPSILON * s for s in (*system.qdot, *system.qddot, *self._forces)}
        shifted = (one.xreplace(shifts) for one in self._derivation.euler_lagrange)
        return [one.diff(EPSILON).subs(EPSILON, 0) for one in shifted]

    @cached_property
    def derivation(self) -> Derivation | None:
        """The derivation of a system with these equations of motion; None without any."""
        if self.accelerations is None or not self.is_origin:
            return None
        M, D, K, inputs = self.matrices
        system = self._derivation.system
        forces = -D * sp.Matrix(system.qdot) - K * sp.Matrix(system.q)
        forces += sum((one * column for one, column in inputs.items()), sp.zeros(*forces.shape))
        return self._with_matrix(system.q, M, forces)

    def of_mode(self, relation: sp.Expr, q: sp.Symbol) -> Derivation | None:
        """The derivation of one coordinate for motions with a linear relation of two.

        None if motions do not keep the relation.
        """
        system = self._derivation.system
        if len(system.q) != 2 or self.derivation is None or system.conditions:
            return None
        slopes = sp.Matrix([relation.diff(one) for one in system.q])
        own = system.q.index(q)
        if (
            slopes.free_symbols
            or slopes[1 - own] == 0
            or relation.subs(q, 0).subs(system.q[1 - own], 0)
        ):
            return None
        mode = sp.Matrix([sp.S.One, sp.S.One])
        mode[1 - own] = -slopes[own] / slopes[1 - own]
        M, D, K, inputs = self.matrices
        mass, stiffness = ((mode.T * one * mode)[0, 0] for one in (M, K))
        if any(D) or inputs or not all(map(is_small, (K - stiffness / mass * M) * mode)):
            return None
        return self._with_matrix((q,), sp.Matrix([[mass]]), sp.Matrix([-stiffness * q]))

    def _with_matrix(
        self, q: Sequence[sp.Symbol], M: sp.Matrix, forces: sp.Matrix
    ) -> Derivation | None:
        """The derivation of some coordinates with a constant mass matrix and these forces."""
        system = self._derivation.system
        inertia = StatedInertia(sp.S.One, (sp.S.Zero, sp.S.Zero), sp.ImmutableDenseMatrix(M))
        # with these values, M is positive
        coupling = M.free_symbols - sp.Tuple(*M.diagonal()).free_symbols
        parameters = [
            replace(one, default=COUPLING) if one.symbol in coupling else one
            for one in system.parameters
        ]
        with suppress(SystemDefinitionError):
            linear = System(
                system.name, system.title, [one for one in system.coordinates if one.symbol in q],
                parameters, [inertia],
                potential=sp.S.Zero, gravity=(sp.S.Zero, sp.S.Zero), forces=[*forces],
            )  # fmt: skip
            return Derivation(linear)
        return None

    @cached_property
    def turned(self) -> tuple["SmallMotions", ...]:
        """The small motions about equilibria with some angles turned by π, as upright."""
        functions = sp.Tuple(*self._derivation.euler_lagrange).atoms(sp.Function)
        angles = [q for q in self._derivation.system.q if sp.Tuple(*functions).has(q)]
        origin = dict.fromkeys(self._derivation.system.q, sp.S.Zero)
        places = (
            origin | dict(zip(angles, turns, strict=True))
            for turns in product((sp.S.Zero, sp.pi), repeat=len(angles))
            if any(turns)
        )
        return tuple(
            SmallMotions(self._derivation, place) for place in places if self._is_equilibrium(place)
        )

    def _combinations(self, linear: sp.Expr) -> Iterator[sp.Expr]:
        """What vanishes if an equation is one of those of small motions, times a factor."""
        for equation in self._equations:
            for symbol in self._derivation.system.qddot:
                if (factor := equation.diff(symbol)) != 0:
                    yield linear * factor - equation * linear.diff(symbol)
                    break

    @cached_property
    def accelerations(self) -> dict[sp.Symbol, sp.Expr] | None:
        """The accelerations of small motions; None if there is no equilibrium, or for many."""
        system = self._derivation.system
        if len(system.q) > MAX_INVERSE or self.place is None:
            return None
        M, D, K, forces = self.matrices
        if M.det() == 0:
            return None
        rest = -D * sp.Matrix(system.qdot) - K * sp.Matrix(system.q)
        rest += sum((one * column for one, column in forces.items()), sp.zeros(*rest.shape))
        return dict(zip(system.qddot, M.LUsolve(rest), strict=True))

    def state_matrices(self) -> tuple[sp.Matrix, sp.Matrix] | None:
        """A and B of ẋ = A x + B F for x = (q, q̇); None if they are not derived."""
        if self.accelerations is None:
            return None
        system, n = self._derivation.system, len(self._derivation.system.q)
        state = (*system.q, *system.qdot)
        rates = sp.Matrix([*system.qdot, *(self.accelerations[a] for a in system.qddot)])
        forces = sorted(self._forces, key=str)
        A = rates.jacobian(state).applyfunc(sp.factor)
        B = rates.jacobian(forces) if forces else sp.zeros(2 * n, 0)
        return A, B.applyfunc(sp.factor)

    def _scaled(self, expression: sp.Expr) -> sp.Expr:
        system = self._derivation.system
        small = (*system.q, *system.qdot, *system.qddot, *self._forces)
        return expression.xreplace({symbol: EPSILON * symbol for symbol in small})

    @cached_property
    def _forces(self) -> set[sp.Symbol]:
        """Parameters of the applied forces that occur nowhere else."""
        d, system = self._derivation, self._derivation.system
        applied = sp.Tuple(*system.applied)
        elsewhere = sp.Tuple(d.lagrangian).free_symbols | {*system.q, *system.qdot}
        alone = applied.free_symbols - elsewhere
        at_rest = dict.fromkeys((*system.q, *system.qdot), sp.S.Zero)

        def is_input(symbol: sp.Symbol) -> bool:
            is_named = symbol.name.partition("_")[0] in KINDS["force"]
            slopes = (one.diff(symbol) for one in system.applied)
            return any((is_named or one.is_number) and one.xreplace(at_rest) for one in slopes)

        return {*filter(is_input, alone)}


def has_initial_values(motion: sp.Expr) -> bool:
    """Whether value and rate of a function of time are letters at 0, such as x_0 and v_0."""
    values = (sp.simplify(one.subs(TIME, 0)) for one in (motion, motion.diff(TIME)))
    return motion.has(TIME) and all(one.is_Symbol for one in values)


def along(system: System, motions: Mapping[sp.Symbol, sp.Expr]) -> dict[sp.Symbol, sp.Expr]:
    """Coordinates and their rates as functions of time, by those of all coordinates."""
    return {
        symbol: motions[q].diff(TIME, order)
        for q, *symbols in zip(system.q, system.qdot, system.qddot, strict=True)
        for order, symbol in enumerate((q, *symbols))
    }
