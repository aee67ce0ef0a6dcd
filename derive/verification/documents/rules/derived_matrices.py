"""The matrices of a system that documents write out: of small motions, and of the state space."""

from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import combinations

import sympy as sp

from derive.formulas.syntax import ExpressionError
from derive.verification.documents.letters.letters import ENTRY
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.small_motions import SmallMotions

#: Entries that a matrix must have, row by row; None for one that is correct.
Required = Sequence[sp.Expr | None]


class DerivedMatrices:
    """The entries that matrices and columns of a document must have.

    Which matrix of the system is meant follows from the entries: all must be correct, or as many
    of those that are not numbers as there are wrong ones. In other formulas, a matrix has its
    correct value.
    """

    def __init__(self, namespace: DocumentNamespace, linear: SmallMotions) -> None:
        self._namespace, self._linear = namespace, linear
        self._known: dict[tuple[int, int], list[sp.Matrix]] = {}
        names = [
            name for name, (formula, _) in namespace.defining.items() if formula.subject == name
        ]
        self._required = {
            name: required
            for name in dict.fromkeys((*names, *namespace.composed))
            if (required := self._compared(name)) is not None
        }
        corrected = {
            name: type(value)(*value.shape, _corrected(value, required))
            for name, required in self._required.items()
            if _wrong(required) and (value := namespace.names[name]) is not None
        }
        if corrected:
            namespace.correct(corrected)

    def required(self, name: str) -> Required | None:
        """The correct entries in place of wrong ones; None if no matrix of the system is meant."""
        return self._required.get(name)

    def entry(self, name: str) -> Required | None:
        """The same for an entry that is defined on its own, such as M_12."""
        match = ENTRY.match(name)
        if not match:
            return None
        matrix = match[1] if match[3] else f"{match[1]}_column"
        if matrix not in self._required or matrix not in self._namespace.composed:
            return None
        column = int(match[3]) - 1 if match[3] else 0
        index = (int(match[2]) - 1) * self._namespace.names[matrix].cols + column
        return self._required[matrix][index : index + 1]

    def _compared(self, name: str) -> Required | None:
        """The entries in which a value differs from the likeliest matrix of the system."""
        value = self._namespace.names[name]
        least: Required | None = None
        if not isinstance(value, sp.MatrixBase):
            return None
        if self._namespace.letters.quantities.get(name) == "coriolis_matrix":
            return self._coriolis(value)
        for derived in (*self._of_shape(value.shape), *self._parts(value.shape)):
            if value.rows == len(self._rows) and has_scaled_rows(self._namespace, value, derived):
                return [None] * len(value)
            entries = [
                None if _agree(self._namespace, a, b) else b
                for a, b in zip(value, derived, strict=True)
            ]
            wrong = _wrong(entries)
            right = sum(
                one is None and not a.is_number for one, a in zip(entries, value, strict=True)
            )
            if right >= max(1, wrong) and (least is None or wrong < _wrong(least)):
                least = entries
        return least

    def _of_shape(self, shape: tuple[int, int]) -> list[sp.Matrix]:
        if shape not in self._known:
            self._known[shape] = [one for one in self._all(shape) if one.shape == shape]
        return self._known[shape]

    @cached_property
    def _rows(self) -> list[int]:
        """The coordinates in the order of the document's columns."""
        names, q = self._namespace.names, self._namespace.derivation.system.q
        ordered = (names.get(name) for name in self._namespace.letters.ordered)
        return [q.index(symbol) for symbol in ordered if symbol in q]

    def _all(self, shape: tuple[int, int]) -> Iterator[sp.Matrix]:
        d, rows = self._namespace.derivation, self._rows
        n = len(rows)
        if n != len(d.system.q):
            return
        if shape == (n, n):
            yield d.mass_matrix.extract(rows, rows)
        if shape == (n, 1):
            yield sp.Matrix([d.forcing[i] for i in rows])
            at_rest = dict.fromkeys(d.system.qdot, sp.S.Zero)
            yield sp.Matrix([d.momenta[i].xreplace(at_rest) for i in rows])
        if self._linear.place is None:
            return
        if shape == (n, n):
            M, D, K, _ = self._linear.matrices
            yield from (one.extract(rows, rows) for one in (M, K, D))
        if n > 1 or shape[0] == 2:
            yield from self._of_states(shape, rows)

    def _parts(self, shape: tuple[int, int]) -> Iterator[sp.Matrix]:
        """Parts of the forces, on either side: those at rest, and those of velocities alone."""
        d = self._namespace.derivation
        if shape != (len(self._rows), 1):
            return
        forces = sp.Matrix([d.forcing[i] - d.system.applied[i] for i in self._rows])
        at_rest = forces.xreplace(dict.fromkeys(d.system.qdot, sp.S.Zero))
        yield from (at_rest, -at_rest, forces - at_rest, at_rest - forces)

    def _coriolis(self, value: sp.MatrixBase) -> Required | None:
        """C is not unique: C q̇ must be the forces of inertia that are quadratic in q̇."""
        d, system, n = self._namespace.derivation, self._namespace.derivation.system, value.rows
        speeds = sp.Matrix([system.qdot[i] for i in self._rows])
        if value.shape != (len(speeds), len(speeds)) or not value.free_symbols & {*speeds}:
            return None
        entries: list[sp.Expr | None] = []
        for row, i in enumerate(self._rows):
            force = system.applied[i] - d.potential_energy.diff(system.q[i]) - d.forcing[i]
            lacking = force - (value.row(row) * speeds)[0]
            is_right = _agree(self._namespace, lacking, sp.S.Zero)
            rests = [None if is_right else sp.cancel(lacking / speed) for speed in speeds]
            entries += [
                r if r is None else value[row, k] + r for k, r in zip(range(n), rests, strict=True)
            ]
        return entries

    def _of_states(self, shape: tuple[int, int], rows: Sequence[int]) -> Iterator[sp.Matrix]:
        """A and B of ẋ = A x + B F for all orders of the state."""
        n = len(rows)
        if shape[0] != 2 * n or (result := self._linear.state_matrices()) is None:
            return
        A, B = result
        for order in _orders(rows):
            if shape == (2 * n, 2 * n):
                yield A.extract(order, order)
            for columns in combinations(range(B.cols), shape[1]):
                yield B.extract(order, columns)


def has_scaled_rows(
    namespace: DocumentNamespace, value: sp.MatrixBase, derived: sp.MatrixBase
) -> bool:
    """Whether rows are those of the derived matrix, in equations that are divided by a factor.

    The factor is a length or a mass, usually. A row with a single entry shows none.
    """
    system = namespace.derivation.system
    for own, other in zip(value.tolist(), derived.tolist(), strict=True):
        k = next((k for k, one in enumerate(other) if one != 0), None)
        if k is None or sum(one != 0 for one in other) < 2 or own[k] == 0:
            return False
        factor = sp.cancel(own[k] / other[k])
        if not factor.free_symbols.isdisjoint((*system.q, *system.qdot)):
            return False
        if not all(_agree(namespace, a, factor * b) for a, b in zip(own, other, strict=True)):
            return False
    return True


def _agree(namespace: DocumentNamespace, one: sp.Expr, other: sp.Expr) -> bool:
    try:
        return namespace.model.context.is_zero(one - other)
    except (ExpressionError, NotImplementedError):
        return False


def _orders(rows: Sequence[int]) -> Iterator[list[int]]:
    """The rows of (q, q̇), first all coordinates and then all rates, or in pairs."""
    n = len(rows)
    yield [*rows, *(n + i for i in rows)]
    yield [k for i in rows for k in (i, n + i)]
    yield [*(n + i for i in rows), *rows]


def _corrected(value: sp.MatrixBase, required: Required) -> list[sp.Expr]:
    return [a if one is None else one for a, one in zip(value, required, strict=True)]


def _wrong(required: Required) -> int:
    return sum(one is not None for one in required)
