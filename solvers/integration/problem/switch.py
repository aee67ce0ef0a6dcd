"""Zeros of switching functions, which end steps."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from solvers.equations.forms import Form
from solvers.runge_kutta.stepper import Array, NotFiniteError

#: Stands for a switching function that is 0, with the sign that is held.
TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True)
class SwitchEvent:
    """An event that ends a step: a switching function changes its sign, or does not stay 0."""

    form: Form  # Lagrange's, with the signs that are held
    index: int
    level: float  # the value that counts as 0, up to rounding errors
    terminal: ClassVar[bool] = True

    def __call__(self, t: float, y: Array) -> float:
        """The switching function at an ordinary state, or 1 - s² of one that stays 0."""
        value = self.value(t, y) - self.level
        return value or TINY * (self.form.signs[self.index] or 1.0)

    def value(self, t: float, y: Array) -> float:
        """The same without the level."""
        k, state = self.index, y[: len(self.form.state)]
        try:
            if self.form.signs[k]:
                return float(self.form.values(t, state)[k])
            return float(1 - self.form.switching(t, state).signs[k] ** 2)
        except ArithmeticError as error:
            raise NotFiniteError(f"a switching function at t = {t}: {error}") from error
