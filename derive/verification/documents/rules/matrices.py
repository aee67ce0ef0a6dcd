"""Matrices of a document: those of the system that it writes out, and wrong terms of products.

The matrices are those of small motions, and of the state space.
"""

import ast
from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import combinations

import sympy as sp

from derive.formulas.expression import parse
from derive.formulas.syntax import ExpressionError, is_sum, place, summands, syntax_tree
from derive.verification.documents.formula_translation import FormulaText
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.roles import Roles
from derive.verification.documents.rules.side_verdict import SideVerdict
from derive.verification.documents.rules.small_motions import SmallMotions
from derive.verification.documents.statements import ENTRY, WORD
from derive.verification.judging.verdict import Correction, Verdict

#: The name that stands for a part, and operations of the largest formula that is solved for one.
PART, MAX_OPERATIONS = "part_of_formula", 600
#: The largest denominator of a factor that is looked for.
MAX_DENOMINATOR = 100
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
        column = int(match[3]) - 1 if match[3] else 0
        names, quantities = self._namespace.names, self._namespace.letters.quantities
        if matrix not in self._namespace.composed and quantities.get(matrix) == "mass_matrix":
            own, derived, row = names.get(name), names.get(matrix), int(match[2]) - 1
            if own is None or derived is None or max(row, column) >= derived.rows:
                return None
            required = derived[row, column]
            return [None if _agree(self._namespace, own, required) else required]
        if matrix not in self._required or matrix not in self._namespace.composed:
            return None
        index = (int(match[2]) - 1) * names[matrix].cols + column
        return self._required[matrix][index : index + 1]

    def _compared(self, name: str) -> Required | None:
        """The entries in which a value differs from the likeliest matrix of the system."""
        value = self._namespace.names[name]
        least: Required | None = None
        if not isinstance(value, sp.MatrixBase):
            return None
        if self._namespace.letters.quantities.get(name) == "coriolis_matrix":
            return self._coriolis(value)
        for derived in (*self._of_shape(value.shape), *self._parts(name, value.shape)):
            if value.rows == len(self._namespace.rows) and has_scaled_rows(
                self._namespace, value, derived
            ):
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

    def _all(self, shape: tuple[int, int]) -> Iterator[sp.Matrix]:
        d, rows = self._namespace.derivation, self._namespace.rows
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

    def _parts(self, name: str, shape: tuple[int, int]) -> Iterator[sp.Matrix]:
        """Parts of the forces: those at rest, and those of velocities alone.

        Their sign is that of the side where the document has them, or any.
        """
        d = self._namespace.derivation
        if shape != (len(self._namespace.rows), 1):
            return
        forces = sp.Matrix([d.forcing[i] - d.system.applied[i] for i in self._namespace.rows])
        at_rest = forces.xreplace(dict.fromkeys(d.system.qdot, sp.S.Zero))
        for sign in self._signs(name):
            yield from (sign * at_rest, sign * (forces - at_rest))

    def _signs(self, name: str) -> Sequence[int]:
        """The signs that a part of the forces can have: -1 in M*q_ddot + name = tau."""
        quantities = self._namespace.letters.quantities
        masses = {one for one, kind in quantities.items() if kind == "mass_matrix"}
        letter = name.removesuffix("_column")
        named = (name, letter, f"{letter}*{self._namespace.letters.column}_dot")
        for formula in self._namespace.formulas:
            for side in formula.sides:
                signs = dict(_terms(side.text))
                own = next((signs[one] for one in named if one in signs), None)
                if own and any({*WORD.findall(one)} & masses for one in signs):
                    return (-own,)
        return (1, -1)

    def _coriolis(self, value: sp.MatrixBase) -> Required | None:
        """C is not unique: C q̇ must be the forces of inertia that are quadratic in q̇.

        Where it is not, entries that are those of Christoffel's symbols are correct.
        """
        d, system, n = self._namespace.derivation, self._namespace.derivation.system, value.rows
        speeds = sp.Matrix([system.qdot[i] for i in self._namespace.rows])
        if value.shape != (len(speeds), len(speeds)) or not value.free_symbols & {*speeds}:
            return None
        entries: list[sp.Expr | None] = []
        for row, i in enumerate(self._namespace.rows):
            force = system.applied[i] - d.potential_energy.diff(system.q[i]) - d.forcing[i]
            lacking = force - (value.row(row) * speeds)[0]
            if _agree(self._namespace, lacking, sp.S.Zero):
                entries += [None] * n
                continue
            usual = d.coriolis_matrix.extract([i], self._namespace.rows)
            are_usual = [
                _agree(self._namespace, own, one)
                for own, one in zip(value.row(row), usual, strict=True)
            ]
            is_one_wrong = are_usual.count(False) == 1
            entries += [
                None if is_one_wrong and are_usual[k] else value[row, k] + sp.cancel(lacking / v)
                for k, v in enumerate(speeds)
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


def _terms(text: str) -> Iterator[tuple[str, int]]:
    """The terms of a sum with their signs."""
    for term, sign in summands(syntax_tree(text)):
        start, end = place(text, term)
        yield text[start:end], sign


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


class MatrixTerms:
    """Seeks the one part of a side with which all rows of a formula hold."""

    def __init__(self, namespace: DocumentNamespace, linear: SmallMotions, roles: Roles) -> None:
        self._namespace, self._linear, self._roles = namespace, linear, roles

    def verdict(
        self,
        first: FormulaText,
        side: FormulaText,
        left: sp.MatrixBase,
        right: sp.MatrixBase,
        witness: str,
    ) -> SideVerdict | None:
        """The verdict with the correction of a part; None if no part alone is wrong."""
        for one, other in ((side, left), (first, right)):
            for start, end, is_whole in _parts(one.text):
                with suppress(ExpressionError, TypeError, ValueError):  # other shapes
                    result = self._of_part(one, start, end, is_whole, other, witness)
                    if result is not None:
                        return result
        return None

    def _of_part(
        self,
        one: FormulaText,
        start: int,
        end: int,
        is_whole: bool,
        other: sp.MatrixBase,
        witness: str,
    ) -> SideVerdict | None:
        part, unknown = one.part(start, end), sp.Symbol(PART)
        own = self._namespace.value(part.text)
        is_matrix = isinstance(own, sp.MatrixBase)
        if is_matrix and not is_whole:
            return None
        factor = f"{PART}*({part.text})" if is_whole else PART
        text = f"{one.text[:start]}({factor}){one.text[end:]}"
        difference = parse(text, {**self._namespace.all_names, PART: unknown}) - other
        required = self._solved(sp.Matrix([difference]), unknown)
        if required is None:
            return None
        if is_whole:
            if not required.is_Rational or required.q > MAX_DENOMINATOR:
                return None
            new = f"-{part.text}" if required == -1 else f"{required}*{part.text}"
            corrections = (Correction(part.text, new, (0, len(part.text))),)
            verdict = Verdict("", "wrong", part.text, corrections=corrections, witness=witness)
            return SideVerdict(verdict, ((0, part),), "value")
        if self._moving(required) <= self._moving(own):
            result = self._roles.value(part, "entry", required)
            return result if result.verdict.corrections else None
        return None

    def _moving(self, value: sp.Expr) -> set[sp.Symbol]:
        system = self._namespace.derivation.system
        return value.free_symbols & {*system.q, *system.qdot, *system.qddot, *system.p}

    def _solved(self, rows: sp.Matrix, unknown: sp.Symbol) -> sp.Expr | None:
        """The value of an unknown for which all rows vanish; None without one."""
        if unknown not in rows.free_symbols or rows.diff(unknown).has(unknown):
            return None
        for accelerations in self._accelerations():
            along = rows.xreplace(dict(self._namespace.model.momenta)).xreplace(accelerations)
            if sp.count_ops(along) > MAX_OPERATIONS:
                continue
            slope, rest = along.diff(unknown), along.xreplace({unknown: sp.S.Zero})
            row = next((k for k, one in enumerate(slope) if not self._vanishes(one)), None)
            if row is None:
                continue
            with suppress(ExpressionError, NotImplementedError):
                # products of rows show more quickly whether a value fits all of them
                if all(map(self._vanishes, rest * slope[row] - rest[row] * slope)):
                    return sp.factor(sp.cancel(-rest[row] / slope[row]))
        return None

    def _vanishes(self, value: sp.Expr) -> bool:
        return bool(value == 0) or self._namespace.model.context.is_zero(value)

    def _accelerations(self) -> Iterator[dict[sp.Symbol, sp.Expr]]:
        """Those of small motions, and of all."""
        if self._linear.is_origin and self._linear.accelerations:
            yield self._linear.accelerations
        derivation = self._namespace.derivation
        if self._namespace.model.has_inverse:
            yield dict(zip(derivation.system.qddot, derivation.accelerations, strict=True))


def _parts(text: str) -> Iterator[tuple[int, int, bool]]:
    """Entries of matrices that are written out, scalar factors, and whole terms of sums."""
    tree = syntax_tree(text)
    for node in ast.walk(tree):
        match node:
            case ast.Tuple(elts=items):
                yield from ((*place(text, one), False) for one in items)
            case ast.List(elts=items):
                rows = (one for one in items if not isinstance(one, ast.List))
                yield from ((*place(text, one), False) for one in rows)
    for term, _ in summands(tree) if is_sum(tree) or isinstance(tree, ast.UnaryOp) else ():
        yield (*place(text, term), True)
    for node in ast.walk(tree):
        match node:
            case ast.BinOp(left=left, op=ast.Mult() | ast.Div(), right=right):
                yield from ((*place(text, one), False) for one in (left, right))
