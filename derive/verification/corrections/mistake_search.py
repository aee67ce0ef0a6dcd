"""Search for the one mistake in a formula: a change of one piece that makes the whole right.

The values that a piece must have are known (`pieces`). They are compared with its own: a
quotient or a difference that is a monomial of known factors is a change of the piece, and so is
another sine or cosine with the required values. Changes are sorted, simplest first; whether one
mends the formula is for the caller to check.
"""

import ast
import math
from collections.abc import Iterator
from dataclasses import dataclass

import sympy as sp

from derive.formulas.syntax import ExpressionError, is_sum
from derive.verification.corrections.goals import Goal
from derive.verification.corrections.monomials import CLOSE, Monomial, Monomials
from derive.verification.corrections.pieces import FormulaPart, Pieces
from derive.verification.corrections.source_names import SourceNames
from derive.verification.corrections.state_samples import Numbers, quotient, samples
from derive.verification.corrections.vocabulary import Vocabulary
from derive.verification.judging.reference_system import ReferenceSystem, depends_on
from derive.verification.judging.terms import difference

#: States in all, and those at which required values are compared.
STATES, COMPARED = 320, 64


@dataclass(frozen=True)
class Change:
    """A piece and its replacement; with `is_added`, a term to add to the piece."""

    piece: FormulaPart
    replacement: str
    cost: float
    is_added: bool = False


class Search:
    """The changes of a formula that give it the values of a goal."""

    def __init__(
        self,
        text: str,
        names: SourceNames,
        model: ReferenceSystem,
        goal: Goal,
        correct: sp.Expr | None,
    ) -> None:
        self._names, self._goal = names, goal
        self._namespace, derivation = model.context.namespace, model.derivation
        self._qddot = derivation.system.qddot
        self._samples = samples(model, STATES, along_motions=goal.along_motions)
        self._elsewhere = samples(model, COMPARED, along_motions=False)
        left, equals, right = text.partition("=")
        self._sides = [Pieces(left, 0, self._namespace, self._samples)]
        if equals:
            self._sides.append(Pieces(right, len(left) + 1, self._namespace, self._samples))
        self._pieces = [*self._required()]
        self._wholes = [piece for piece in self._pieces if piece.parent is None]
        brackets = (p.source for p in self._pieces if p.parent and is_sum(p.node))
        derived = sp.Tuple(goal.value, correct or sp.S.Zero)
        if goal.is_equation:
            derived = sp.Tuple(*derivation.mass_matrix, *derivation.forcing)
        self._vocabulary = Vocabulary(names, self._samples, brackets, derived, goal.foreign)
        self._fits: dict[tuple[int, ...], list[Monomials]] = {}

    @property
    def is_equation(self) -> bool:
        """Whether the formula is an equation of motion."""
        return self._goal.is_equation

    def changes(self) -> list[Change]:
        """Changes of one piece that give the values of the goal, simplest first."""
        return sorted(self._changes(), key=lambda change: change.cost)

    @property
    def terms(self) -> list[tuple[FormulaPart, int]]:
        """The terms of the formula, and the signs of their sides in an equation."""
        terms = []
        for whole, side in zip(self._wholes, (1, -1), strict=False):
            parts = [p for p in self._pieces if p.is_summand and p.parent is whole]
            terms += [(part, side) for part in (parts if is_sum(whole.node) else [whole])]
        return terms

    def is_right(self, text: str) -> bool:
        """Whether a formula has the values of the goal; an equation holds along motions only."""
        try:
            value = difference(text, self._namespace)
        except ExpressionError:  # a correction with a function that formulas do not have
            return False
        if not _are_close(self._samples(value), self._samples(self._goal.value)):
            return False
        return not self._goal.is_equation or not _are_close(
            self._elsewhere(value), [0.0] * COMPARED
        )

    def _changes(self) -> Iterator[Change]:
        for piece in self._pieces:
            if piece in self._wholes[:1] and isinstance(piece.node, ast.Name):
                continue  # a formula for a quantity
            if piece.is_term:
                yield from self._products(piece)
                # a term that is missing in an equation is missing on the left
                if piece not in self._wholes[1:] and (is_sum(piece.node) or not piece.is_summand):
                    yield from self._additions(piece)
            if isinstance(piece.node, ast.Call):
                yield from self._waves(piece)

    def _required(self) -> Iterator[FormulaPart]:
        """All pieces, with the values that are required of them."""
        sides = self._sides
        other = sides[1].value if len(sides) > 1 else self._samples(self._goal.value)
        states = [k for k in range(STATES) if math.isfinite(sides[0].value[k] + other[k])]
        if len(states) < COMPARED:
            raise NotImplementedError("the formula has no value at most states")
        yield from sides[0].walk(other, states[:COMPARED])
        if len(sides) > 1:
            yield from sides[1].walk(sides[0].value, states[:COMPARED])

    def _products(self, piece: FormulaPart) -> Iterator[Change]:
        """The piece times a monomial, or 0."""
        pairs = [(piece.required[k], piece.value[k]) for k in piece.states]
        if all(abs(required) <= CLOSE * abs(value) for required, value in pairs):
            if piece.is_summand:
                yield Change(piece, "0", 1.5 + self._size(piece))
            return
        ratios = [*map(quotient, piece.required, piece.value)]
        for ratio in self._identified(piece, ratios):
            if not piece.parent and any(base.is_Add for base, _ in ratio.powers):
                continue  # another formula altogether
            source = piece.source
            if ratio.coefficient == -1 and not ratio.powers:
                if piece.parent and not piece.is_summand:
                    continue  # the sign is that of a whole term
                new = f"-({source})" if is_sum(piece.node) else f"-{source}"
                new = source[1:] if source.startswith("-") and not is_sum(piece.node) else new
            else:
                new = sp.sstr(self._names.parse(source) * ratio.expression)
            longer = max(0, len(new) - len(source))
            several = is_sum(piece.node)  # all terms of a sum are less likely to be wrong than one
            cost = ratio.change + 0.1 * longer + self._size(piece) + several
            yield Change(piece, new, cost)

    def _additions(self, piece: FormulaPart) -> Iterator[Change]:
        """A monomial that is missing in the piece."""
        lacking = [r - v for r, v in zip(piece.required, piece.value, strict=True)]
        for missing in self._identified(piece, lacking):
            new = sp.sstr(missing.expression)
            size = self._size(piece) if piece.parent else 0
            yield Change(piece, new, 1.5 + 0.4 * missing.length + size, is_added=True)

    def _waves(self, piece: FormulaPart) -> Iterator[Change]:
        """Another sine or cosine in place of the piece."""
        for factor in self._vocabulary.waves_like(piece.source):
            for sign in (1, -1):
                pairs = [(sign * factor.values[k], piece.required[k]) for k in piece.states]
                if piece.is_squared:
                    pairs = [(abs(a), abs(b)) for a, b in pairs]
                if all(abs(a - b) <= CLOSE for a, b in pairs):
                    new = sp.sstr(sign * factor.expression)
                    yield Change(piece, new, 1.5 - sign / 2 + self._size(piece))

    def _size(self, piece: FormulaPart) -> float:
        """A small cost of long pieces, and in equations of motion of those with accelerations."""
        names = (node.id for node in ast.walk(piece.node) if isinstance(node, ast.Name))
        values = [self._namespace.get(name) for name in names]  # True is none in a condition
        accelerated = any(depends_on(x, self._qddot) for x in values if isinstance(x, sp.Expr))
        return 0.01 * (piece.end - piece.start) + (self.is_equation and accelerated)

    def _identified(self, piece: FormulaPart, values: Numbers) -> Iterator[Monomial]:
        """The monomials with these values: along motions, accelerations depend on the rest."""
        key = tuple(piece.states)
        if key not in self._fits:
            factors = self._vocabulary.factors
            bound = [
                f for f in factors if depends_on(self._names.meaning(f.expression), self._qddot)
            ]
            free = [f for f in factors if f not in bound]
            orders = [free, bound + free] if self._goal.is_equation else [factors]
            self._fits[key] = [Monomials(order, key) for order in orders]
        fits = self._fits[key]
        result = (fit.identified(values, up_to_sign=piece.is_squared) for fit in fits)
        yield from dict.fromkeys(monomial for monomial in result if monomial)


def _are_close(a: Numbers, b: Numbers) -> bool:
    """Whether numbers are equal wherever both are finite."""
    pairs = [(x, y) for x, y in zip(a, b, strict=True) if math.isfinite(x + y)]
    return bool(pairs) and all(abs(x - y) <= CLOSE * max(1, abs(x), abs(y)) for x, y in pairs)
