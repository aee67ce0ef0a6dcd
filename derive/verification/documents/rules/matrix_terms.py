"""The wrong part of a formula with products of matrices: an entry, a factor or a sign."""

import ast
from collections.abc import Iterator
from contextlib import suppress

import sympy as sp

from derive.formulas.expression import parse
from derive.formulas.syntax import ExpressionError, is_sum, place, summands, syntax_tree
from derive.verification.documents.formula_translation import FormulaText
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.roles import Roles
from derive.verification.documents.rules.side_verdict import SideVerdict
from derive.verification.documents.rules.small_motions import SmallMotions
from derive.verification.judging.verdict import Correction, Verdict

#: The name that stands for a part, and operations of the largest formula that is solved for one.
PART, MAX_OPERATIONS = "part_of_formula", 600
#: The largest denominator of a factor that is looked for.
MAX_DENOMINATOR = 100


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
