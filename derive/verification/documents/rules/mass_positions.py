"""Positions of masses that a document defines, such as x_1 and y_1, and their correct values."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import permutations

import sympy as sp

from derive.formulas.expression import Value
from derive.formulas.syntax import ExpressionError
from derive.verification.documents.letters.positions import COLUMN, POINT
from derive.verification.documents.rules.known_values import DocumentNamespace

#: The components of a point: names and values. An entry of a column has that column's name.
Point = Sequence[tuple[str, int, sp.Expr]]


class MassPositions:
    """Components that belong to a mass whose other components are correct, up to their signs."""

    def __init__(self, namespace: DocumentNamespace) -> None:
        self._namespace = namespace
        #: Correct values of wrong components, by name and index in a column.
        self._required: dict[tuple[str, int], sp.Expr] = {}
        for point in _points(namespace):
            for mass in namespace.derivation.system.masses:
                result = self._of_mass(point, mass.position)
                if result is not None:
                    self._required |= result
                    break

        if self._required:
            namespace.correct(dict(self._corrected()))

    def required(self, name: str, index: int = 0) -> sp.Expr | None:
        """The value of a wrong component; None if it is correct, or not known."""
        return self._required.get((name, index))

    def _corrected(self) -> Iterator[tuple[str, Value]]:
        for (name, index), required in self._required.items():
            value = self._namespace.names[name]
            if isinstance(value, sp.MatrixBase):
                entries = [*value]
                entries[index] = required
                yield name, sp.ImmutableDenseMatrix(entries)
            else:
                yield name, required

    def _of_mass(
        self, point: Point, position: Sequence[sp.Expr]
    ) -> Mapping[tuple[str, int], sp.Expr] | None:
        """The components that are not those of a mass; None if it is another mass."""
        if len(position) != len(point):
            return None
        fewest: list[tuple[str, int, sp.Expr]] | None = None
        for order in permutations(position):  # the same axes first
            pairs = list(zip(point, order, strict=True))
            right = [r for (_, _, value), r in pairs if self._agrees(value, r)]
            wrong = [
                (name, index, _signed(r, value))
                for (name, index, value), r in pairs
                if not any(r is one for one in right)
            ]
            moving = {*self._namespace.derivation.system.q}
            is_known = any(r.free_symbols & moving for r in right)
            is_known &= all(value.free_symbols & moving for *_, value in wrong)
            if is_known and len(wrong) < 2 and (fewest is None or len(wrong) < len(fewest)):
                fewest = wrong
        return None if fewest is None else {(name, k): value for name, k, value in fewest}

    def _agrees(self, value: sp.Expr, position: sp.Expr) -> bool:
        """Whether a value is a component of a position up to its sign and a constant."""
        system, is_zero = self._namespace.derivation.system, self._namespace.model.context.is_zero
        with suppress(ExpressionError, NotImplementedError):
            return any(
                all(is_zero((value - sign * position).diff(q)) for q in system.q)
                for sign in (1, -1)
            )
        return False


def _signed(position: sp.Expr, value: sp.Expr) -> sp.Expr:
    """A component with the sign with which it shares more terms with the written value."""
    written = {*sp.Add.make_args(sp.expand(value))}

    def shared(signed: sp.Expr) -> tuple[int, int]:
        terms = written & {*sp.Add.make_args(sp.expand(signed))}
        return len(terms), sum(one.is_Symbol for one in terms)

    return -position if shared(-position) > shared(position) else position


def _points(namespace: DocumentNamespace) -> Iterator[Point]:
    """The points that a document defines, by their components or as columns."""
    points: dict[str, list[tuple[str, int, sp.Expr]]] = {}
    q = {*namespace.derivation.system.q}
    for name in namespace.defining:
        value = namespace.names[name]
        if isinstance(value, sp.MatrixBase):
            is_point = COLUMN.match(name) and value.cols == 1
            if is_point and not q.issuperset(value):  # which is a column of coordinates
                yield [(name, index, one) for index, one in enumerate(value)]
        elif match := POINT.match(name):
            points.setdefault(match[2] or "", []).append((name, 0, value))
    yield from (point for point in points.values() if len(point) > 1)
