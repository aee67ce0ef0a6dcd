"""Variables that a function or a loop changes step by step: coordinates and velocities.

A coordinate grows by the product of a velocity and the step size, a velocity by that of an
acceleration. Whether old or new values are used follows from the values themselves.
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from functools import cached_property

from derive.reading.programs.evaluation.calls import VariableValue
from derive.reading.programs.evaluation.following import Follower
from derive.reading.programs.evaluation.numeric_values import number
from derive.reading.programs.evaluation.sums import (
    Term,
    divisors,
    factors,
    inner,
    joined,
    product,
    quotients,
    terms,
    total,
)
from derive.reading.programs.findings.stages import Stages
from derive.reading.programs.syntax.formula_text import is_negative
from derive.reading.programs.syntax.trees import (
    Array,
    Choice,
    Expression,
    Name,
    NumberLiteral,
    OperatorExpression,
    replaced,
)

#: An entry at a time, such as theta[i+1] and y[i][0].
TIMED = re.compile(r"(.*?)\[([^\W\d]\w*)([+-]\d+)?\](.*)")


NO_STEP = NumberLiteral(0, "1")
#: A name of the time, such as tempo and sim_time, and not theta.
TIME = re.compile(r"(?i)(?:^|[._])(?:t(?:em.*)?|.*time|zeit)$")
LAST = re.compile(r"(.*?)\[(-1|end)()\](.*)")


@dataclass(frozen=True)
class Update:
    """A variable and what is added to it."""

    variable: str  # before the step, such as theta[i]
    line: int
    increment: tuple[Term, ...]
    damping: Expression | None = None  # the factor by which the velocity is multiplied
    damping_line: int = 0


@dataclass(frozen=True)
class Pair:
    """A coordinate and its velocity, which grow together."""

    coordinate: Update
    velocity: Update
    step: Expression | None  # the step size; None if no factor is written
    uses_new_velocity: bool
    #: Whether the velocity is one after a part of its update, as in the leapfrog method.
    uses_middle_velocity: bool
    #: Whether the coordinate grows by more than its velocity before or after the step.
    has_other_terms: bool


class Updates:
    """The updates of a function or a loop; under conditions, without or with `is_met`."""

    def __init__(self, follower: Follower, *, is_met: bool) -> None:
        self._is_met = is_met
        #: Lines and reasons of updates that are not followed.
        self.unread: list[tuple[int, str]] = []
        self._steps = [part for step in follower.steps for part in _parts(step, follower)]
        final = {}
        for path, value in follower.variables.items():
            for part in _parts(VariableValue(0, path, value), follower):
                final[part.path] = part.value
        changed = {step.path for step in self._steps}
        stages = Stages(
            self._steps,
            [self._chosen(value, path) for path, value in final.items() if path in changed],
        )
        #: Lines of stages that add others to the rate, instead of to the state.
        self.misplaced = stages.misplaced
        self._steps = [VariableValue(one.line, one.path, stages(one.value)) for one in self._steps]
        final = {path: stages(value) for path, value in final.items()}
        is_timed = any(TIMED.fullmatch(step.path) for step in self._steps)
        values = [step.value for step in self._steps] if is_timed else []
        used = {path for value in values for path in names(value)}
        self._old = {step.path: previous(step.path, used) for step in self._steps}
        #: Values that variables take, by identity.
        self._owners: dict[int, str] = {}
        for step in self._steps:
            value = self._chosen(step.value, step.path)
            is_copy = id(value) in self._owners and LAST.fullmatch(step.path)
            if not isinstance(value, Name | NumberLiteral) and not is_copy:
                self._owners[id(value)] = self._old[step.path]
        before = {path for step in self._steps for path in names(step.value)}
        for path, value in final.items():
            self._own_sums(self._old.get(path, path), value, before)
        result = (self._update(path, value) for path, value in final.items())
        self.updates: dict[str, Update] = {one.variable: one for one in result if one}
        self._final = {
            id(value) for path, value in final.items() if self._old.get(path, path) in before
        }
        #: Values that are used in the next step, such as accelerations.
        self._kept: dict[str, Expression] = {}
        others = {
            self._old.get(path, path): self._restored(value, set())
            for path, value in final.items()
            if self._old.get(path, path) not in self.updates and value.parts
        }
        self._kept = {path: one for path, one in others.items() if path not in {*names(one)}}
        #: Coordinates that grow by their last change and an acceleration, by Verlet's method.
        pairs = ((self._old.get(path, path), value) for path, value in final.items())
        self.recurrences = tuple(
            (old, acceleration)
            for old, value in pairs
            if (acceleration := recurrence(old, value, self._earlier(old, value, final)))
        )

    def _own_sums(self, old: str, value: Expression, before: Set[str]) -> None:
        """Count names for parts of an update, which have no value before, as its variable."""
        sums = [tree := inner(value)]
        while isinstance(tree, OperatorExpression) and tree.operator in ("+", "-"):
            sums.append(tree := inner(tree.operands[0]))
        if sums[-1] == Name(0, old):
            for one in sums:
                if id(one) in self._owners and self._owners[id(one)] not in before:
                    self._owners[id(one)] = old

    def _earlier(self, path: str, value: Expression, final: Mapping[str, Expression]) -> set[str]:
        """The names of a variable one step before: of an entry, or of a copy."""
        copies = {other for other, one in final.items() if one == Name(0, path)}
        return {previous(path, {*names(value)}), *copies} - {path}

    def _is_whole(self, tree: Expression) -> bool:
        return id(tree) in self._owners

    def _factors(self, term: Expression) -> list[Expression]:
        """The factors of a change, which can have a name, such as dv = a*dt."""
        whole = inner(term)
        if self._owners.get(id(whole)) in self.updates:
            return factors(term, self._is_whole)
        return factors(term, lambda tree: tree is not whole and self._is_whole(tree))

    def _chosen(self, value: Expression, old: str) -> Expression:
        """A value without conditions: that which changes a variable, or one of two that do."""
        value = inner(value)
        while isinstance(value, Choice):
            unchanged = Name(0, old)
            takes_after = value.before == unchanged or (self._is_met and value.after != unchanged)
            value = inner(value.after if takes_after else value.before)
        return value

    def _update(self, path: str, value: Expression) -> Update | None:
        old = self._old.get(path, path)
        value = self._chosen(value, old)
        damping, damping_line = None, 0
        match value:
            case OperatorExpression(operator="*", operands=(earlier, factor)) if self._owners.get(
                id(earlier)
            ) == old or earlier == Name(0, old):
                damping, damping_line, value = factor, value.line, earlier
            case OperatorExpression(
                operator="*", operands=(earlier, Name() | NumberLiteral() as factor)
            ) if Name(0, old) in (one for _, one in terms(earlier, self._is_whole)):
                damping, damping_line, value = factor, value.line, inner(earlier)
        line = value.line
        first = [*terms(value, lambda tree: self._owners.get(id(tree), old) != old)]
        if len(first) == 1 and first[0][1] != Name(0, old):
            first = [*quotients(*first[0])]
        own = [one for one in first if one[1] == Name(0, old)]
        if len(own) != 1 or own[0][0] != 1:
            return self._damped(old, line, first)
        rest = tuple(one for one in first if one is not own[0])
        return Update(old, line, rest, damping, damping_line) if rest or damping else None

    def _damped(self, old: str, line: int, result: list[Term]) -> Update | None:
        """The update of a variable that is first multiplied by a factor."""
        for term in result:
            parts = factors(term[1], lambda tree: self._owners.get(id(tree), old) != old)
            others = [one for one in parts if one != Name(0, old)]
            if term[0] == 1 and len(others) == len(parts) - 1 and others:
                rest = tuple(one for one in result if one is not term)
                return Update(old, line, rest, product(line, others), term[1].line)
        return None

    @cached_property
    def pairs(self) -> tuple[Pair, ...]:
        """Coordinates with their velocities, in the order of the program."""
        result = [pair for one in self.updates.values() if (pair := self._pair(one))]
        # of x += h*v and v += h*(-k*x), the factor of the first is the step size
        least = {pair.velocity.variable: _length(pair.step) for pair in result}
        result = [
            pair for pair in result
            if _length(pair.step) <= least.get(pair.coordinate.variable, math.inf)
        ]  # fmt: skip
        velocities = {pair.velocity.variable for pair in result}
        return tuple(pair for pair in result if pair.coordinate.variable not in velocities)

    @cached_property
    def times(self) -> tuple[str, ...]:
        """The variables that grow by the step size alone and have names of times."""
        steps = [pair.step for pair in self.pairs if pair.step]
        return tuple(
            one.variable
            for one in self.updates.values()
            if TIME.search(one.variable) and [*one.increment] in [[(1, step)] for step in steps]
        )

    def _pair(self, coordinate: Update) -> Pair | None:
        for sign, term in coordinate.increment:
            parts = self._factors(term)
            for part in parts:
                velocity, is_new, is_part = self._velocity(inner(part))
                if velocity is None or velocity is coordinate or sign < 0:
                    continue
                if is_part and self._is_whole(inner(term)):
                    continue  # a stage of a method
                is_last = id(inner(part)) in self._final or velocity.damping is not None
                is_middle = is_new and not is_last
                others = [one for one in parts if one is not part]
                if any(self._moves(one) for one in others):
                    continue
                step = product(term.line, others) if others else None
                if step and is_negative(step):
                    continue
                rest = [one for one in coordinate.increment if one[1] is not term]
                if step and (more_steps := self._same(rest, velocity)) is not None:
                    step, rest, is_middle = _whole([(1, step), *more_steps]), [], True
                more = is_part or bool(rest)
                for earlier in (name for _, one in rest for name in self._others(one, step)):
                    change = f"the update of {coordinate.variable} has the acceleration {earlier}"
                    self.unread.append((coordinate.line, f"{change} of another step"))
                    return None
                return Pair(coordinate, velocity, step, is_new, is_middle, more)
        return None

    def _same(self, increments: list[Term], velocity: Update) -> list[Term] | None:
        """The step sizes of other changes by the same velocity; None if there are others."""
        result = []
        for sign, term in increments:
            parts = self._factors(term)
            own = [one for one in parts if self._velocity(inner(one))[0] is velocity]
            if len(own) != 1:
                return None
            result.append((sign, product(term.line, [one for one in parts if one is not own[0]])))
        return result or None

    def _others(self, term: Expression, step: Expression | None) -> list[str]:
        """The variables in a term that are no step size: accelerations from before."""
        steps = {*names(step)} if step else set()
        parts = factors(term, self._is_whole)
        result = [one.path for one in parts if isinstance(one, Name)]
        return [path for path in result if path not in {*steps, *self._kept, "pi"}]

    def _velocity(self, tree: Expression) -> tuple[Update | None, bool, bool]:
        """The variable that a factor is, whether after its update, and whether in between."""
        if isinstance(tree, Name):
            return self.updates.get(tree.path), False, False
        if id(tree) in self._owners:
            return self.updates.get(self._owners[id(tree)]), True, False
        for sign, term in terms(tree, self._is_whole):
            if sign == 1 and isinstance(term, Name) and term.path in self.updates:
                return self.updates[term.path], False, True
        return None, False, False

    def _moves(self, tree: Expression) -> bool:
        """Whether a value depends on variables that are updated."""
        if isinstance(tree, Name):
            return tree.path in self.updates
        return any(map(self._moves, tree.parts))

    def acceleration(self, pair: Pair) -> tuple[Expression, frozenset[str]]:
        """The acceleration in values before the step, and the variables used after it."""
        used: set[str] = set()
        velocity, step = pair.velocity, pair.step
        step, factor = self._without_mass(velocity, step)
        result = [(sign, self._divided(term, step)) for sign, term in velocity.increment]
        if any(term is None for _, term in result):  # no common factor
            whole = [(sign, self._restored(term, used)) for sign, term in velocity.increment]
            quotient = total(velocity.line, whole), step or NO_STEP
            return OperatorExpression(velocity.line, "/", quotient), frozenset(used)
        divided = [(sign, self._restored(term, used)) for sign, term in result if term]
        value = total(velocity.line, joined(divided))
        return product(value.line, [value, *factor]) if factor else value, frozenset(used)

    def mixed(self, pair: Pair) -> list[tuple[int, str]]:
        """The coordinates that a term of an acceleration has before and after their change."""
        coordinates = {one.coordinate.variable for one in self.pairs}
        return [
            (term.line, path)
            for _, term in pair.velocity.increment
            for path in sorted(self._mixed(term, coordinates))
        ]

    def _mixed(self, tree: Expression, coordinates: Set[str]) -> set[str]:
        if self._owners.get(id(tree)) in coordinates:
            return set()
        result = {path for part in tree.parts for path in self._mixed(part, coordinates)}
        match tree:
            case OperatorExpression(operator="+" | "-"):
                return result  # the mean of two accelerations
        ages = [one for part in tree.parts for one in {*self._ages(part)}]
        return result | {path for path in coordinates if {(path, 0), (path, 1)} <= {*ages}}

    def _ages(self, tree: Expression) -> Iterator[tuple[str, int]]:
        """The variables in a value, with 0 before and 1 after their change."""
        owner = tree.path if isinstance(tree, Name) else self._owners.get(id(tree))
        if owner in self.updates:
            yield owner, int(not isinstance(tree, Name))
            return
        for part in tree.parts:
            yield from self._ages(part)

    def _without_mass(
        self, velocity: Update, step: Expression | None
    ) -> tuple[Expression | None, list[Expression]]:
        """The step size, and factors of a velocity that is a momentum, as 1/m of dt*p/m."""
        if step is None:
            return None, []
        parts = [*divisors(factors(step, self._is_whole))]
        terms_of = [self._factors(term) for _, term in velocity.increment]
        own = [one for one in parts if all(one in others for others in terms_of)]
        rest = [one for one in parts if one not in own and number(one) != 1]
        values = [self._restored(one, set()) for _, one in velocity.increment]
        is_used = any(velocity.variable in {*names(one)} for one in values)
        is_number = all(number(one) is not None for one in own)
        if is_number or is_used or any(number(one) is not None or self._moves(one) for one in rest):
            return step, []
        return product(step.line, own), rest

    def _divided(self, term: Expression, step: Expression | None) -> Expression | None:
        """A term without the step size; None if that is not a factor."""
        if step is None:
            return term
        parts = self._factors(term)
        for one in factors(step, self._is_whole):
            if one not in parts:
                return None
            parts.remove(one)
        return product(term.line, parts)

    def _restored(self, tree: Expression, used: set[str]) -> Expression:
        """A value with variables after their update replaced by the variables."""
        owner = self._owners.get(id(tree))
        if owner is not None and owner in self.updates:
            used.add(owner)
            return Name(tree.line, owner)
        if isinstance(tree, Name) and tree.path in self._kept:
            return self._kept[tree.path]
        parts = tuple(self._restored(part, used) for part in tree.parts)
        is_same = all(a is b for a, b in zip(parts, tree.parts, strict=True))
        return tree if is_same else replaced(tree, parts)


def _length(tree: Expression | None) -> int:
    """The number of names and numbers in a value."""
    if tree is None:
        return 0
    return sum(map(_length, tree.parts)) or 1


def _whole(steps: Sequence[Term]) -> Expression:
    """The sum of step sizes such as two halves of one."""
    parts = [*divisors(factors(steps[0][1]))]
    halves = [one for one in parts if (number(one) or 0) * len(steps) == 1]
    if halves and all(step == steps[0] for step in steps):
        parts.remove(halves[0])
        return product(steps[0][1].line, parts)
    size, line, rest = 0.0, steps[0][1].line, list[list[Expression]]()
    for sign, step in steps:
        parts = factors(step)
        size += sign * math.prod(number(one) or 1 for one in parts)
        rest.append([one for one in parts if number(one) is None])
    if size == 1 and rest[0] and all(one == rest[0] for one in rest):
        return product(line, rest[0])
    return total(line, steps)


def _parts(step: VariableValue, follower: Follower) -> list[VariableValue]:
    """The entries of an array that is assigned as a whole."""
    value = inner(step.value)
    if not isinstance(value, Array):
        return [step]
    first = follower.context.language.first_index
    return [
        VariableValue(step.line, f"{step.path}[{i + first}]", one)
        for i, one in enumerate(value.items)
    ]


def previous(path: str, used: Set[str]) -> str:
    """The variable that an entry follows: theta[i] for theta[i+1]; others for themselves."""
    if match := TIMED.fullmatch(path):
        offset = int(match[3] or 0) - 1
        before = f"{match[1]}[{match[2]}{f'{offset:+d}' if offset else ''}]{match[4]}"
        return before if before in used else path
    return path


def without_time(path: str) -> str:
    """The variable of which an entry is the value at a time."""
    match = TIMED.fullmatch(path) or LAST.fullmatch(path)
    return match[1] + match[4] if match else path


def names(tree: Expression) -> Iterator[str]:
    """The variables in a value."""
    if isinstance(tree, Name):
        yield tree.path
    for part in tree.parts:
        yield from names(part)


def recurrence(path: str, value: Expression, earlier: Set[str]) -> Expression | None:
    """The acceleration of a coordinate with a new value; None if that is no such step.

    `earlier` are the names of the coordinate one step before.
    """
    result = [*terms(value)]
    twice = [one for one in result if _is_twice(one, path)]
    last = [(sign, one) for sign, one in result if isinstance(one, Name) and one.path in earlier]
    rest = [one for one in result if one not in (*twice, *last)]
    if len(twice) != 1 or [sign for sign, _ in last] != [-1] or not rest:
        return None
    for step in _squares(factors(rest[0][1])):
        divided = [(sign, _divided(term, step)) for sign, term in rest]
        known = [(sign, term) for sign, term in divided if term]
        if len(known) == len(rest):
            return total(value.line, known)
    return None


def _is_twice(term: Term, path: str) -> bool:
    parts = factors(term[1])
    numbers = [number(one) for one in parts if one != Name(0, path)]
    return term[0] == 1 and numbers == [2] and len(parts) == 2


def _squares(parts: Sequence[Expression]) -> Iterator[list[Expression]]:
    """Squares of names among factors: as powers, or as a name that occurs twice."""
    for one in parts:
        match one:
            case OperatorExpression(operator="**", operands=(Name(), NumberLiteral(digits="2"))):
                yield [one]
            case Name() if parts.count(one) == 2:
                yield [one, one]


def _divided(term: Expression, step: Sequence[Expression]) -> Expression | None:
    """A term without the factors of a step; None if it lacks one of them."""
    for parts in (factors(term, lambda tree: tree.line != term.line), factors(term)):
        if all(one in parts for one in step):  # a value from another line stays whole
            for one in step:
                parts.remove(one)
            return product(term.line, parts)
    return None
