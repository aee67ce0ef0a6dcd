"""Integrals of constraints of velocities that can replace these: with factors that are never 0.

The gradients of integrals are combinations of the constraints, A rows + B known, with integrating
factors A. They can replace those rows whose columns of A have a determinant that is never 0.
"""

from collections.abc import Sequence
from functools import cached_property, reduce
from itertools import combinations
from typing import Any

import sympy as sp
from sympy.polys.matrices import DomainMatrix

from derive.formulas.proofs.trigonometric_field import TrigonometricField

#: Most integrals of which combinations are tried.
MOST = 12


class RegularIntegrals:
    """The choice of integrals, with the `rows` of constraints and `known` differentials."""

    def __init__(
        self,
        functions: TrigonometricField,
        known: Sequence[Sequence[Any]],
        rows: Sequence[Sequence[Any]],
        integrals: Sequence[sp.Expr],
    ) -> None:
        self._functions, self._known, self._integrals = functions, known, integrals[:MOST]
        # where a denominator is 0, there is no constraint
        self._rows = [_polynomials(row) for row in rows]

    def most(self, count: int) -> dict[int, sp.Expr]:
        """As many as possible, at most `count`, by the index of the row that each replaces."""
        best = self._extended((), count)
        return dict(
            zip(self._replaced(best) or (), (self._integrals[k] for k in best), strict=True)
        )

    def _extended(self, chosen: tuple[int, ...], count: int) -> tuple[int, ...]:
        """The longest choice that begins with the chosen ones."""
        best = chosen
        for k in range(chosen[-1] + 1 if chosen else 0, len(self._integrals)):
            if len(best) < count and self._replaced(trial := (*chosen, k)):
                best = max(best, self._extended(trial, count), key=len)
        return best

    def _replaced(self, chosen: tuple[int, ...]) -> tuple[int, ...] | None:
        """The rows that these integrals can replace together."""
        size, field = len(chosen), self._functions.field
        for columns in combinations(range(len(self._rows)), size):
            minor = [[self._factors[k][j] for j in columns] for k in chosen]
            *_, determinant = DomainMatrix(minor, (size, size), field).charpoly()  # up to its sign
            if self._functions.is_never_zero(determinant):
                return columns
        return None

    @cached_property
    def _factors(self) -> list[list[Any]]:
        """A, one row an integral."""
        functions, forms, m = self._functions, [*self._known, *self._rows], len(self._known)
        gradients = [functions.gradient(functions.value(f)) for f in self._integrals]
        columns = [[*column] for column in zip(*forms, *gradients, strict=True)]
        shape = (len(functions.variables), len(forms) + len(gradients))
        solution, pivots = DomainMatrix(columns, shape, functions.field).rref()
        entries, rows = solution.to_list(), {p: i for i, p in enumerate(pivots)}
        return [
            [entries[rows[j]][len(forms) + k] if j in rows else functions.field.zero
             for j in range(m, len(forms))]
            for k in range(len(gradients))
        ]  # fmt: skip


def _polynomials(row: Sequence[Any]) -> list[Any]:
    """A multiple of a row without denominators."""
    common = reduce(lambda a, b: a.lcm(b), (entry.denom for entry in row))
    return [entry * common for entry in row]
