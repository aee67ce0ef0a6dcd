"""Equations of amplitudes: those of motion with functions of time that a document states."""

from collections.abc import Iterator
from contextlib import suppress
from functools import cached_property
from itertools import combinations

import sympy as sp

from derive.formulas.expression import parse
from derive.formulas.generic_values import is_small
from derive.formulas.syntax import ExpressionError
from derive.system.symbols import TIME
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.statements import DocumentFormula
from derive.verification.judging.reference_system import depends_on


class Amplitudes:
    """Equations in A and B by the equations of motion with x = A*cos(w*t) and y = B*cos(w*t)."""

    def __init__(self, namespace: DocumentNamespace) -> None:
        self._namespace, self._system = namespace, namespace.derivation.system

    def holds(self, formula: DocumentFormula) -> bool:
        """Whether a formula is one of these equations, or a sum or difference of two.

        It may be multiplied by a factor without amplitudes.
        """
        if len(formula.sides) != 2 or not self._equations:
            return False
        try:
            left, right = (self._value(one.text) for one in formula.sides)
        except (ExpressionError, NotImplementedError, TypeError, ValueError):
            return False
        names = self._amplitudes
        row = [(left - right).diff(one) for one in names]
        rest = (left - right).xreplace(dict.fromkeys(names, sp.S.Zero))
        moving = sp.Tuple(*row).free_symbols & {*names, *self._system.q, *self._system.qdot}
        if rest != 0 or moving or not any(row):
            return False
        rows = [[one.diff(name) for name in names] for one in self._equations]
        pairs = combinations(rows, 2)
        rows += [[a + s * b for a, b in zip(*pair, strict=True)] for pair in pairs for s in (1, -1)]
        return any(
            all(is_small(row[i] * one[j] - row[j] * one[i]) for i, j in combinations(columns, 2))
            for one in rows
            if (columns := range(len(names)))
        )

    def _value(self, text: str) -> sp.Expr:
        names = self._namespace.all_names
        value = parse(text, {**self._letters, **names})
        if not isinstance(value, sp.Expr) or isinstance(value, sp.MatrixBase):
            raise TypeError("a matrix")
        return value

    @cached_property
    def _letters(self) -> dict[str, sp.Symbol]:
        """Letters without a meaning, which are constants."""
        words = {word for one in self._namespace.formulas for word in one.words}
        unknown = words - {*self._namespace.all_names}
        return {word: sp.Symbol(word, positive=True) for word in sorted(unknown)}

    @cached_property
    def _motions(self) -> dict[sp.Symbol, sp.Expr]:
        """The functions of time that a document states all coordinates to be; empty for others."""
        return dict(self._stated())

    def _stated(self) -> Iterator[tuple[sp.Symbol, sp.Expr]]:
        names, system = self._namespace.all_names, self._system
        for formula in self._namespace.formulas:
            q = names.get(formula.subject)
            if q in system.q and len(formula.sides) == 2 and "t" in formula.words:
                with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
                    value = self._value(formula.sides[1].text)
                    if not depends_on(value, (*system.q, *system.qdot, *system.qddot)):
                        yield q, value

    @cached_property
    def _amplitudes(self) -> list[sp.Symbol]:
        """Constants that are factors of stated functions."""
        values = self._motions.values()
        return [
            s for s in self._letters.values()
            if any(one.has(s) and sp.expand(one - s * one.diff(s)) == 0 for one in values)
        ]  # fmt: skip

    @cached_property
    def _equations(self) -> list[sp.Expr]:
        """The equations of motion with the stated functions; none unless all are stated."""
        if {*self._motions} != {*self._system.q} or len(self._amplitudes) < len(self._motions):
            return []
        pairs = zip(self._system.q, self._system.qdot, self._system.qddot, strict=True)
        rates = {
            symbol: self._motions[q].diff(TIME, order)
            for q, *symbols in pairs
            for order, symbol in enumerate((q, *symbols))
        }
        return [one.xreplace(rates) for one in self._namespace.derivation.euler_lagrange]
