"""The matrices of M q̈ + C q̇ = G + … in the notation of robotics."""

from collections.abc import Sequence

import sympy as sp

from derive.verification.documents.rules.known_values import DocumentNamespace

#: The entries that a matrix or column must have, row by row; None for one that is correct.
Required = Sequence[sp.Expr | None]


class Manipulator:
    """The entries that the matrix C and the column G of a document must have."""

    def __init__(self, namespace: DocumentNamespace) -> None:
        self._namespace, self._context = namespace, namespace.model.context

    def required(self, name: str) -> Required | None:
        """The correct entries in place of wrong ones; None if the name is not C or G."""
        kind, value = self._namespace.letters.quantities.get(name), self._namespace.names.get(name)
        rows = self._rows
        if not isinstance(value, sp.MatrixBase) or value.rows != len(rows):
            return None
        if kind == "coriolis_matrix" and value.cols == len(rows):
            return self._coriolis(value, rows)
        return self._gravity(value, rows) if kind == "gravity" and value.cols == 1 else None

    @property
    def _rows(self) -> list[int]:
        """The coordinates in the order of the document's columns."""
        names, q = self._namespace.names, self._namespace.derivation.system.q
        ordered = (names.get(name) for name in self._namespace.letters.ordered)
        return [q.index(symbol) for symbol in ordered if symbol in q]

    def _coriolis(self, value: sp.MatrixBase, rows: Sequence[int]) -> Required | None:
        """C is not unique: C q̇ must be the forces of inertia that are quadratic in q̇."""
        d, system = self._namespace.derivation, self._namespace.derivation.system
        speeds = sp.Matrix([system.qdot[i] for i in rows])
        if not value.free_symbols & {*speeds}:
            return None
        entries: list[sp.Expr | None] = []
        for row, i in enumerate(rows):
            force = system.applied[i] - d.potential_energy.diff(system.q[i]) - d.forcing[i]
            lacking = force - (value.row(row) * speeds)[0]
            for column, speed in enumerate(speeds):
                rest = None if self._context.is_zero(lacking) else sp.cancel(lacking / speed)
                entries.append(None if rest is None else value[row, column] + rest)
        return entries

    def _gravity(self, value: sp.MatrixBase, rows: Sequence[int]) -> Required | None:
        """G is the gradient of the potential energy, with either sign."""
        d, system = self._namespace.derivation, self._namespace.derivation.system
        gradient = [d.potential_energy.diff(system.q[i]) for i in rows]
        for sign in (-1, 1):
            wrong = [
                not self._context.is_zero(g - sign * v)
                for g, v in zip(value, gradient, strict=True)
            ]
            if not all(wrong):
                return [sign * v if one else None for one, v in zip(wrong, gradient, strict=True)]
        return None
