"""Formulas that hold for small motions about the origin of the coordinates."""

from functools import cached_property

import sympy as sp

from derive.formulas.expression import ExpressionError
from derive.mechanics.derivation import Derivation
from derive.verification.model import Model

EPSILON = sp.Symbol("epsilon", positive=True)


class Linear:
    """The linearised equations of motion of a derivation, with forces that are small, too."""

    def __init__(self, derivation: Derivation) -> None:
        self._derivation = derivation

    def agrees(self, difference: sp.Expr, model: Model) -> bool:
        """Whether a difference vanishes to first order at the origin."""
        scaled = self._scaled(difference)
        try:
            values = (scaled.subs(EPSILON, 0), scaled.diff(EPSILON).subs(EPSILON, 0))
            return all(map(model.context.is_zero, values))
        except (ExpressionError, NotImplementedError):
            return False

    def holds(self, difference: sp.Expr, model: Model) -> bool:
        """Whether a difference that is linear in the state vanishes along small motions."""
        system = self._derivation.system
        state = (*system.q, *system.qdot, *system.qddot)
        if not difference.free_symbols & {*state} or self._accelerations is None:
            return False
        scaled = self._scaled(difference)
        try:
            if not model.context.is_zero(scaled.subs(EPSILON, 0)):
                return False
            linear = scaled.diff(EPSILON).subs(EPSILON, 0)
            if not model.context.is_zero(scaled.diff(EPSILON, 2)):
                return False
            return model.context.is_zero(linear.xreplace(self._accelerations))
        except (ExpressionError, NotImplementedError):
            return False

    def acceleration(self, symbol: sp.Symbol, value: sp.Expr) -> sp.Expr | None:
        """The acceleration of small motions if `value` seems to be one: without functions."""
        full = self._derivation.euler_lagrange
        if value.atoms(sp.Function) or not sp.Tuple(*full).atoms(sp.Function):
            return None
        return (self._accelerations or {}).get(symbol)

    @cached_property
    def _accelerations(self) -> dict[sp.Symbol, sp.Expr] | None:
        """The accelerations of small motions; None if there is no equilibrium at the origin."""
        d, system = self._derivation, self._derivation.system
        if len(system.q) > 3:
            return None
        equations = [self._scaled(one) for one in d.euler_lagrange]
        if any(sp.simplify(one.subs(EPSILON, 0)) != 0 for one in equations):
            return None
        linear = [one.diff(EPSILON).subs(EPSILON, 0) for one in equations]
        matrix = sp.Matrix([[one.diff(a) for a in system.qddot] for one in linear])
        rest = -sp.Matrix([one.xreplace(dict.fromkeys(system.qddot, sp.S.Zero)) for one in linear])
        if matrix.det() == 0:
            return None
        return dict(zip(system.qddot, matrix.LUsolve(rest), strict=True))

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
        return {
            s for s in alone if any(one.diff(s).is_number and one.diff(s) for one in system.applied)
        }
