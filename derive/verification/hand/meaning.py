"""What the names in somebody's equations mean, and a state at which they have numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy as sp

from derive.formulas.expression import FUNCTIONS, parse
from derive.formulas.zero import vanishes
from derive.mechanics.derivation import Derivation
from derive.system.symbols import TIME
from derive.system.system import System
from solvers.io.toml_input import InputError

#: Digits of numbers, and what counts as zero there.
DIGITS, TINY = 40, sp.Float("1e-30")
#: At so many states a difference is looked at where nothing proves that it is zero.
PLACES = 5


@dataclass(frozen=True)
class Meaning:
    """A system, and names of somebody else for what is in it.

    Parameters
    ----------
    derivation : Derivation
        The system's.
    names : mapping of str to str
        Their names, and what they mean as formulas in the system's own. Of one that depends
        on coordinates, ``_dot`` and ``_ddot`` mean its rates.
    """

    derivation: Derivation
    names: Mapping[str, str]

    @property
    def system(self) -> System:
        """The system."""
        return self.derivation.system

    @cached_property
    def state(self) -> tuple[sp.Symbol, ...]:
        """All that changes: coordinates, their rates, momenta and time."""
        system = self.system
        return (*system.q, *system.qdot, *system.qddot, *system.p, TIME)

    @cached_property
    def scope(self) -> dict[str, Any]:
        """Every name that an equation may use."""
        own = {s.name: s for s in (*self.state, *self.system.params)} | FUNCTIONS
        theirs: dict[str, Any] = {}
        for name, text in self.names.items():
            try:
                value = parse(text, own)
            except ValueError as error:
                raise InputError(f"names.{name}: {error}") from error
            theirs[name] = value
            if value in self.system.q:
                theirs[f"p_{name}"] = dict(zip(self.system.q, self.system.p, strict=True))[value]
            if value.free_symbols & {*self.system.q}:
                theirs[f"{name}_dot"] = self.rate(value)
                theirs[f"{name}_ddot"] = self.rate(self.rate(value))
        return own | theirs

    def rate(self, value: sp.Expr) -> sp.Expr:
        """The rate of a function of coordinates, velocities and time."""
        system = self.system
        slopes = zip((*system.q, *system.qdot), (*system.qdot, *system.qddot), strict=True)
        return sp.Add(value.diff(TIME), *(value.diff(s) * rate for s, rate in slopes))

    def numbers(self, place: int = 0) -> dict[sp.Symbol, sp.Rational]:
        """A state at which nothing vanishes; in the first coordinates are smaller than lengths."""
        constants = {
            s: sp.Rational(11 * k + 17 + 3 * place, 7 * k + 11)
            for k, s in enumerate(self.system.params)
        }
        # of all signs, and on both sides of a right angle: roots of squares are no square's roots
        moving = {
            s: sp.Rational(5 * k + 3 + place, 9 * k + 14) * (1 + place) * (-1) ** ((k + place) % 3)
            for k, s in enumerate(self.state)
        }
        # lengths among coordinates are positive
        return constants | {s: abs(v) if s.is_positive else v for s, v in moving.items()}

    def holds(self, residual: sp.Expr) -> bool:
        """Whether a residual is zero with the accelerations of the motion, in numbers."""
        system, derivation = self.system, self.derivation
        for place in range(PLACES):
            numbers = self.numbers(place)
            M, f = (
                matrix.evalf(DIGITS, subs=numbers)
                for matrix in (derivation.mass_matrix, derivation.forcing)
            )
            moving = numbers | dict(zip(system.qddot, M.LUsolve(f), strict=True))
            slopes = [residual.diff(a).evalf(DIGITS, subs=moving) for a in system.qddot]
            # what holds whatever the accelerations are says nothing of them
            if not _is_small(residual, moving) or max(map(abs, slopes)) < TINY:
                return False
        return True

    def is_zero(self, expression: sp.Expr) -> bool:
        """Whether an expression is zero whatever the state; proved where that is possible."""
        for place in range(PLACES):
            if not _is_small(expression, self.numbers(place)):
                return False
        try:
            return vanishes(expression)
        except NotImplementedError:
            return True


def _is_small(expression: sp.Expr, numbers: Mapping[sp.Symbol, sp.Expr]) -> bool:
    """Whether an expression is zero beside its own terms."""
    terms = sp.Add.make_args(sp.expand_mul(expression))
    values = [term.evalf(DIGITS, subs=numbers) for term in terms]
    return bool(abs(sum(values)) <= TINY * max(map(abs, values)))
