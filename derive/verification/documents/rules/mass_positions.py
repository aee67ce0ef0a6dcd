"""Positions of masses that a document defines, such as x_1 and y_1, and their correct values."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import combinations, permutations

import sympy as sp

from derive.formulas.expression import FUNCTIONS, Value, parse
from derive.formulas.generic_values import is_nonzero
from derive.formulas.syntax import ExpressionError
from derive.system.symbols import TIME
from derive.verification.documents.letters.candidates import SystemCandidate
from derive.verification.documents.letters.stated_positions import COLUMN
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.statements import POINT, WORD, DocumentFormula
from derive.verification.judging.reference_system import time_derivative

#: The components of a point: names and values. An entry of a column has that column's name.
Point = Sequence[tuple[str, int, sp.Expr]]


class MassPositions:
    """Components that belong to a mass whose other components are correct, up to their signs."""

    def __init__(self, namespace: DocumentNamespace) -> None:
        self._namespace = namespace
        self._rates = _rates(namespace)
        #: Correct values of wrong components, by name and index in a column.
        self._required: dict[tuple[str, int], sp.Expr] = {}
        #: Components of which one is wrong, but either can be.
        self._undecided: set[tuple[str, int]] = set()
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

    def is_undecided(self, name: str, index: int = 0) -> bool:
        """Whether this component or another one is wrong."""
        return (name, index) in self._undecided

    def opposite(self, rate: str) -> DocumentFormula | None:
        """The definition of a component whose stated `rate` has the opposite sign.

        None if another formula contains the component: kinetic energies have the same value with
        either sign, so that nothing else decides which of both is wrong.
        """
        name = rate.removesuffix("_dot")
        defining = self._namespace.defining.get(name)
        if name == rate or name not in self._rates or not POINT.match(name) or not defining:
            return None
        others = (one for one in self._namespace.formulas if one is not defining[0])
        is_used = any(name in one.words for one in others)
        own = self._rate(self._namespace.names[name])
        return None if is_used or not self._is_zero(self._rates[name] + own) else defining[0]

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
        possible: list[list[tuple[str, int, sp.Expr]]] = []
        for order in permutations(position):  # the same axes first
            pairs = list(zip(point, order, strict=True))
            right = [r for (_, _, value), r in pairs if self._agrees(value, r)]
            wrong = [
                (name, index, self._signed(r, name, value))
                for (name, index, value), r in pairs
                if not any(r is one for one in right)
            ]
            moving = {*self._namespace.derivation.system.q}
            is_known = any(r.free_symbols & moving for r in right)
            is_known &= all(value.free_symbols & moving for *_, value in wrong)
            if is_known and len(wrong) < 2:
                possible.append(wrong)
        if not possible:
            return None

        def rank(wrong: list[tuple[str, int, sp.Expr]]) -> tuple[int, int]:
            return len(wrong), -sum(self._contradicts_rate(name) for name, *_ in wrong)

        first = min(possible, key=rank)
        best = [{(name, k) for name, k, _ in one} for one in possible if rank(one) == rank(first)]
        if any(names != best[0] for names in best):  # of two equal components, either can be wrong
            self._undecided |= set().union(*best)
            return {}
        return {(name, k): value for name, k, value in first}

    def _contradicts_rate(self, name: str) -> bool:
        """Whether the stated rate of a component is not that of its value."""
        stated = self._rates.get(name)
        return stated is not None and not self._is_zero(
            stated - self._rate(self._namespace.names[name])
        )

    def _agrees(self, value: sp.Expr, position: sp.Expr) -> bool:
        """Whether a value is a component of a position up to its sign and a constant."""
        q = self._namespace.derivation.system.q
        return any(
            all(self._is_zero((value - sign * position).diff(one)) for one in q) for sign in (1, -1)
        )

    def _signed(self, position: sp.Expr, name: str, value: sp.Expr) -> sp.Expr:
        """A component with the sign of its stated rate.

        Without one it is that with which it shares more terms with the written value.
        """
        stated = self._rates.get(name)
        if stated is not None:
            for one in (position, -position):
                if self._is_zero(stated - self._rate(one)):
                    return one
        written = {*sp.Add.make_args(sp.expand(value))}

        def shared(signed: sp.Expr) -> tuple[int, int]:
            terms = written & {*sp.Add.make_args(sp.expand(signed))}
            return len(terms), sum(one.is_Symbol for one in terms)

        return -position if shared(-position) > shared(position) else position

    def _rate(self, value: sp.Expr) -> sp.Expr:
        return time_derivative(self._namespace.derivation.system, value)

    def _is_zero(self, value: sp.Expr) -> bool:
        with suppress(ExpressionError, NotImplementedError):
            return self._namespace.model.context.is_zero(value)
        return False


def _rates(namespace: DocumentNamespace) -> dict[str, sp.Expr]:
    """The rates that a document states for components, by their names."""
    result: dict[str, sp.Expr] = {}
    for formula in namespace.formulas:
        name = formula.subject.removesuffix("_dot")
        if name != formula.subject and POINT.match(name):
            with suppress(ExpressionError, NotImplementedError):
                value = namespace.value(formula.sides[-1].text)
                if not isinstance(value, sp.MatrixBase):
                    result[name] = value
    return result


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


def is_no_rate(formula: DocumentFormula, candidate: SystemCandidate) -> bool:
    """Whether a formula states the rate of a component of a position that no function has.

    Coordinates whose rates it does not contain can be constant there.
    """
    name = formula.subject.removesuffix("_dot")
    if name == formula.subject or not POINT.match(name) or name in candidate.coordinates:
        return False
    words = {*candidate.coordinates, *(f"{q}_dot" for q in candidate.coordinates)}
    words |= candidate.letters - {"t"}
    if not {*WORD.findall(formula.sides[-1].text)} <= {*words, *FUNCTIONS, "t"}:
        return False  # such as speeds by name
    symbols = {word: sp.Symbol(word) for word in words}
    try:
        value = parse(formula.sides[-1].text, {**symbols, **FUNCTIONS, "t": TIME})
    except ExpressionError:
        return False
    pairs = [(symbols[q], symbols[f"{q}_dot"]) for q in candidate.coordinates]
    if not isinstance(value, sp.Expr):
        return False
    slopes = [(q, value.diff(v)) for q, v in pairs]
    if any(is_nonzero(slope.diff(v)) for _, slope in slopes for _, v in pairs):
        return True
    resting = value.xreplace({v: sp.S.Zero for _, v in pairs})
    if any(is_nonzero(resting.diff(q)) for q, _ in pairs):  # a term has lost its rate
        return True
    slopes = [(q, slope) for q, slope in slopes if slope] + [(TIME, resting)]
    return any(is_nonzero(a.diff(p) - b.diff(q)) for (q, a), (p, b) in combinations(slopes, 2))
