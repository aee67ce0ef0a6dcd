"""Stages of Runge-Kutta methods that are written out without a function of the rates.

The first stage is a formula of the state; the others are the same formula of a state that earlier
stages shift. They are given as entries of a function of the shifted state.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence

from derive.reading.programs.evaluation.calls import VariableValue
from derive.reading.programs.evaluation.numeric_values import number
from derive.reading.programs.evaluation.sums import factors, product, terms
from derive.reading.programs.syntax.trees import (
    Expression,
    FunctionCall,
    Item,
    Name,
    NumberLiteral,
    OperatorExpression,
    Result,
    replaced,
)

#: A name for the function of the rates, which no program can use.
RATES = "the rates"
#: Variables in the longest new value in which stages are searched.
MAX_PARTS = 32


class Stages:
    """The stages in the new values of variables, each time in as many stages."""

    def __init__(self, steps: Sequence[VariableValue], final: Sequence[Expression]) -> None:
        order = {id(step.value): place for place, step in enumerate(steps)}
        families = [one for value in final if (one := _family(value, order, shifts))]
        others = (_family(value, order, adds) for value in final)
        #: The lines of second stages that add others to the first one, without the step size.
        self.misplaced = [one[1].line for one in others if len(one) > 2]
        #: The step size, if each stage has it as a factor.
        self._common: list[Expression] = []
        #: The stage and the entry of values, by identity, and the states of the stages.
        self._places: dict[int, tuple[int, int]] = {}
        self._states: list[Mapping[str, Expression]] = []
        #: Values and what they are replaced by, by the identity of the values.
        self._known: dict[int, tuple[Expression, Expression]] = {}
        if len(families) < 2 or len({*map(len, families)}) > 1:
            return
        first = [factors(one[0]) for one in families]
        common = [one for one in first[0] if all(one in other for other in first[1:])]
        self._common = [one for one in common if isinstance(one, Name)]
        for stage, row in enumerate(zip(*families, strict=True)):
            shifted: dict[str, Expression] = {}
            for index, (one, value) in enumerate(zip(families, row, strict=True)):
                if not shifts(self._rate(one[0]), self._rate(value), shifted):
                    self._places, self._states = {}, []
                    return
                self._places[id(value)] = stage, index
            self._states.append(shifted)
        used = [
            (number, self._places[key][0])
            for number, state in enumerate(self._states)
            for value in state.values()
            for key in {*_within(value)} & {*self._places}
        ]
        if not used or any(earlier >= number for number, earlier in used):
            self._places = {}

    def _rate(self, stage: Expression) -> Expression:
        """A stage without the step size."""
        if not self._common:
            return stage
        parts = factors(stage)
        return product(stage.line, [one for one in parts if one not in self._common])

    def __call__(self, tree: Expression) -> Expression:
        """A value with its stages as entries of the function of the rates."""
        if not self._places:
            return tree
        if id(tree) not in self._known:
            self._known[id(tree)] = tree, self._replaced(tree)
        return self._known[id(tree)][1]

    def _replaced(self, tree: Expression) -> Expression:
        if id(tree) not in self._places:
            return self._inside(tree)
        stage, index = self._places[id(tree)]
        entry = Item(tree.line, self._call(tree.line, stage), (NumberLiteral(0, str(index)),))
        rate = Result(tree.line, entry, self._inside(self._rate(tree)))
        return product(tree.line, [*self._common, rate])

    def _inside(self, tree: Expression) -> Expression:
        parts = tuple(map(self, tree.parts))
        is_same = all(a is b for a, b in zip(parts, tree.parts, strict=True))
        return tree if is_same else replaced(tree, parts)

    def _call(self, line: int, stage: int) -> FunctionCall:
        names = sorted({name for state in self._states for name in state})
        state = self._states[stage]
        arguments = (self._inside(state.get(name, Name(line, name))) for name in names)
        return FunctionCall(line, Name(line, RATES), tuple(arguments))


def _family(
    value: Expression,
    order: Mapping[int, int],
    is_next: Callable[[Expression, Expression], bool],
) -> list[Expression]:
    """The stages in a new value: the first, and those of the same formula.

    The first stage of a coordinate can be its velocity, as in ``x + h/2*(v + v2)``.
    """
    found = {id(one): one for part in value.parts for one in _largest(part, order)}
    if len(found) > MAX_PARTS:
        return []
    stages = sorted(found.values(), key=lambda one: order.get(id(one), -1))
    for place, first in enumerate(stages):
        others = [one for one in stages[place + 1 :] if is_next(first, one)]
        if others:
            return [first, *others]
    return []


def _largest(tree: Expression, order: Mapping[int, int]) -> Iterator[Expression]:
    """The largest parts of a value that are those of variables, and names of variables."""
    if id(tree) in order or isinstance(tree, Name):
        yield tree
        return
    for part in tree.parts:
        yield from _largest(part, order)


def _within(tree: Expression) -> Iterator[int]:
    """The identities of the parts of a value."""
    for part in tree.parts:
        yield id(part)
        yield from _within(part)


def adds(first: Expression, other: Expression) -> bool:
    """Whether a formula is another with multiples, by numbers, of stages added to it."""
    start, result = ([*terms(one)] for one in (first, other))
    rest = result[len(start) :]
    return (
        bool(rest)
        and result[: len(start)] == start
        and all(
            any(one == first or adds(first, one) for one in _multiplied(term)) for _, term in rest
        )
    )


def _multiplied(term: Expression) -> Iterator[Expression]:
    """A term, and its factor that a number multiplies."""
    yield term
    match term:
        case OperatorExpression(operator="*", operands=(size, stage)) if number(size) is not None:
            yield stage


def shifts(
    first: Expression, other: Expression, found: dict[str, Expression] | None = None
) -> bool:
    """Whether a formula is another with terms added to some variables, which are noted."""
    found = {} if found is None else found
    if isinstance(first, Name) and first != other:
        is_shifted = any(sign == 1 and one == first for sign, one in terms(other))
        return is_shifted and found.setdefault(first.path, other) == other
    if not first.parts or len(first.parts) != len(other.parts):
        return first == other
    is_alike = replaced(first, other.parts) == other
    pairs = zip(first.parts, other.parts, strict=True)
    return is_alike and all(shifts(a, b, found) for a, b in pairs)
