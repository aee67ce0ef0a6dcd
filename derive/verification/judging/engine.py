"""The judging engine: statements compared with derived values, in numbers and by proof.

``"x1 = l1*sin(theta1)"`` is a statement with two sides, ``"a = b = c"`` has
three, ``"a >= b"`` is an inequality, and ``"a = b; c = d"`` is two statements.
An index i in a name stands for every number: ``q_i_dot`` for ``q1_dot`` and ``q2_dot``.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import sympy as sp

from derive.formulas.expression import Namespace, parse
from derive.formulas.generic_values import STATES
from derive.formulas.numeric import DIGITS, Approximation, Evaluator, NoValueError, mp
from derive.formulas.syntax import RELATION, ExpressionError
from derive.formulas.zero import is_positive, vanishes

State = Mapping[sp.Symbol, sp.Expr]

INDEXED = re.compile(r"\b([A-Za-z]\w*?)_i(?=_|\b)")

#: The relative difference of values that a witness shows, if there is one.
VISIBLE = mp.mpf("1e-6")
#: Digits of the numbers of a state, and characters of the longest fraction among them.
SHOWN, MAX_FRACTION = 10, 12
#: The note on what no proof decides.
IN_NUMBERS = f"not proved: the sides agree to {DIGITS} digits at {STATES} generic states"
#: The note where a formula can change its form between the states, so that it is not verified.
UNDECIDED = (
    "not proved: the sides agree where compared, but the formula can change its form elsewhere"
)


@dataclass(frozen=True)
class Comparison:
    """Two neighbouring sides of a statement, or one entry of each if they are matrices."""

    relation: str
    residual: sp.Expr  # left minus right; of an inequality, larger minus smaller side
    comparable: bool  # both sides are numbers, or both are matrices


@dataclass(frozen=True)
class Check:
    """Whether a statement holds, and the first comparison in it that does not hold."""

    holds: bool
    comparison: int = 0  # its index
    witness: str = ""  # its residual as a number, at the first state of the context


@dataclass(frozen=True)
class Context:
    """The names that statements can use, and generic states at which they are evaluated.

    Substitutions, applied in order, leave independent symbols only: they replace momenta by
    velocities and, if the equations of motion are assumed, accelerations. States agree with them.
    """

    namespace: Namespace
    evaluators: tuple[Evaluator, ...]  # at the states; contexts with other names can share them
    substitutions: tuple[State, ...] = ()
    index_count: int = 0  # an index takes the values 1 to index_count
    implicit: frozenset[sp.Symbol] = frozenset()  # dependent, but without a substitution
    unproved: str = IN_NUMBERS  # the note on what no proof decides

    def check(self, text: str, definitions: Namespace | None = None) -> Check:
        """Check every part of `text`, with additional names from `definitions`."""
        for index, comparison in enumerate(self.comparisons(text, definitions)):
            residual = comparison.residual
            if comparison.relation != "=":
                if not is_positive(residual, strictly="=" not in comparison.relation):
                    return Check(False, index, "not proved positive")
            elif not comparison.comparable or not self.is_zero(residual):
                return Check(False, index, sp.sstr(self.value(residual).n(6)))
        return Check(holds=True)

    def comparisons(self, text: str, definitions: Namespace | None = None) -> list[Comparison]:
        """Split `text` into comparisons of two numbers each."""
        namespace = {**self.namespace, **(definitions or {})}
        return [
            comparison
            for part in text.split(";")
            for index in (range(1, self.index_count + 1) if INDEXED.search(part) else (0,))
            for comparison in _compared(INDEXED.sub(rf"\g<1>{index}", part), namespace)
        ]

    def is_zero(self, expression: sp.Expr) -> bool:
        """Whether `expression` is zero: by proof, or where none is possible, at many states."""
        return self.agreement(expression) is not None

    def is_small(self, *expressions: sp.Expr) -> bool:
        """Whether all `expressions` are zero at all states, as far as the digits show."""
        return all(self._is_small(one, place) for place in self.evaluators for one in expressions)

    def is_small_somewhere(self, *expressions: sp.Expr) -> bool:
        """Whether all `expressions` are zero at one of the states."""
        places = self.evaluators
        return any(all(self._is_small(one, place) for one in expressions) for place in places)

    def are_multiples(
        self, one: sp.Expr, other: sp.Expr, accelerations: Iterable[sp.Symbol]
    ) -> bool:
        """Whether two equations that are linear in accelerations are multiples of each other."""
        factors = ((one.diff(a), other.diff(a)) for a in accelerations)
        return any(
            not self.is_small(factor)
            and not self.is_small(other_factor)
            and self.is_small(one * other_factor - other * factor)
            for factor, other_factor in factors
        )

    def agreement(self, *differences: sp.Expr) -> str | None:
        """Return "" if all `differences` are proved zero, `unproved` if they are zero at states.

        None if one of them is not zero.
        """
        if not self.is_small(*differences):
            return None
        try:
            return "" if all(map(self._vanishes, differences)) else None
        except NotImplementedError:
            if len(self.states) < STATES:
                raise
            return self.unproved

    def witness(self, value: sp.Expr, derived: sp.Expr) -> str:
        """Both values at the first state where they differ, with as many digits as show it."""
        index = self.first_difference(value, derived)
        pair = [self.value(side, index) for side in (value, derived)]
        for digits in range(8, DIGITS, 4):
            texts = [sp.sstr(number.n(digits)) for number in pair]
            if texts[0] != texts[1]:
                break
        return " instead of ".join(texts)

    def state(
        self, value: sp.Expr, derived: sp.Expr, quantities: Mapping[str, sp.Expr]
    ) -> dict[str, str]:
        """Numbers of quantities where values differ, by their names, in the order of the state.

        They have as many digits as the difference needs to be computed again.
        """
        order = {symbol: k for k, symbol in enumerate(self.states[0])}
        ranks = {name: (order.get(one, len(order)), name) for name, one in quantities.items()}
        index = self.first_difference(value, derived)
        size = abs(self._approximation(value - derived, self.evaluators[index]).number)
        lost = -mp.log10(size) if size else 0
        digits = min(SHOWN + max(0, int(mp.ceil(lost))), DIGITS)
        names = sorted(quantities, key=ranks.__getitem__)
        return {name: self._written(quantities[name], index, digits) for name in names}

    def _written(self, quantity: sp.Expr, index: int, digits: int) -> str:
        number = self.states[index].get(quantity, quantity)
        if not number.is_Rational or len(str(number)) > MAX_FRACTION:
            number = self.value(quantity, index).n(digits)
        return str(sp.sstr(number))

    def first_difference(self, value: sp.Expr, derived: sp.Expr) -> int:
        """The index of the first state where values differ visibly, or else of that where most."""
        largest, result = mp.zero, 0
        for index, place in enumerate(self.evaluators):
            difference = self._approximation(value - derived, place)
            size = abs(difference.number) / (1 + abs(self._approximation(derived, place).number))
            if not difference.is_zero and size > largest:
                largest, result = size, index
            if largest > VISIBLE:
                break
        return result

    def value(self, expression: sp.Expr, index: int = 0) -> sp.Expr:
        """The value of `expression` at a state."""
        return self._approximation(expression, self.evaluators[index]).rounded()

    @property
    def states(self) -> tuple[State, ...]:
        """The states."""
        return tuple(one.state for one in self.evaluators)

    def _is_small(self, expression: sp.Expr, evaluator: Evaluator) -> bool:
        return self._approximation(expression, evaluator).is_zero

    def _approximation(self, expression: sp.Expr, evaluator: Evaluator) -> Approximation:
        try:
            return evaluator(expression)
        except (NoValueError, NotImplementedError) as error:
            raise ExpressionError(f"the formula has no value at a generic state: {error}") from None

    def _vanishes(self, expression: sp.Expr) -> bool:
        for substitution in self.substitutions:
            expression = expression.xreplace(substitution)
        if expression.free_symbols & self.implicit:
            raise NotImplementedError(f"cannot prove that {str(expression)[:80]!r} vanishes")
        return vanishes(expression)


def joined(*notes: str) -> str:
    """Join the notes that are not empty."""
    return "; ".join(filter(None, notes))


def _compared(text: str, namespace: Namespace) -> Iterator[Comparison]:
    pieces = RELATION.split(text)
    if len(pieces) == 1:
        raise ExpressionError(f"{text.strip()[:80]!r} is not a statement: it has no =, < or >")
    sides = [parse(piece, namespace) for piece in pieces[::2]]
    for left, relation, right in zip(sides, pieces[1::2], sides[1:], strict=False):
        pair = (right, left) if "<" in relation else (left, right)
        shapes = [side.shape for side in pair if isinstance(side, sp.MatrixBase)]
        if len(set(shapes)) > 1:
            both = " and ".join(map(str, shapes))
            raise ExpressionError(f"cannot compare matrices of shapes {both}")
        if len(shapes) == 1:  # a number beside a matrix stands for each entry
            ones = sp.ones(*shapes[0])
            pair = tuple(s if isinstance(s, sp.MatrixBase) else s * ones for s in pair)
        difference = pair[0] - pair[1]
        for residual in difference if shapes else [difference]:
            yield Comparison(relation, residual, comparable=len(shapes) != 1)
