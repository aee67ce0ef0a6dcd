"""Functions followed statement by statement: the values of their variables in the end."""

from collections.abc import Iterable, Sequence
from copy import copy
from dataclasses import replace
from typing import Self

from derive.reading.programs.evaluation.arrays import entries, flat
from derive.reading.programs.evaluation.calls import CONDITION, Calls, VariableValue
from derive.reading.programs.evaluation.context import ProgramContext, assigned, static_path
from derive.reading.programs.evaluation.counted_loops import (
    BODIES,
    changed_vectors,
    elementwise,
    has_index,
    integer,
)
from derive.reading.programs.evaluation.numeric_values import constant, number
from derive.reading.programs.evaluation.values import is_zeros, row_or_column, whole
from derive.reading.programs.syntax.code import (
    Assignment,
    Conditional,
    Definition,
    ExpressionStatement,
    Fault,
    Loop,
    Return,
    Statement,
    VariableDeclaration,
)
from derive.reading.programs.syntax.trees import (
    Array,
    Choice,
    Expression,
    FunctionCall,
    Item,
    Member,
    Name,
    NumberLiteral,
    Opaque,
    OperatorExpression,
    Slice,
)

LOOP = "a loop is not followed"
#: Components of vectors that a loop counts.
MAX_COMPONENTS = 3


class Follower(Calls):
    """Follows statements; names that are not assigned before stand for themselves."""

    def __init__(self, context: ProgramContext, owner: str = "") -> None:
        super().__init__(context, owner)
        #: Loops that are followed by themselves, and the values of variables before them.
        self.loops: list[tuple[Loop, dict[str, Expression]]] = []
        #: Statements that are not understood: line and reason.
        self.faults: list[tuple[int, str]] = []
        self.has_ended = False

    def run(self, body: tuple[Statement, ...]) -> None:
        """Follow statements in order."""
        for one in body:
            if self.has_ended:
                return
            match one:
                case Assignment():
                    self._assign(one)
                case Return(value=value):
                    self.returned = None if value is None else self.value(value)
                    self.has_ended = True
                case ExpressionStatement(value=value):
                    self._call(value)
                case Conditional():
                    self._branch(one)
                case Loop():
                    self._loop(one)
                case Fault(line=line, reason=reason):
                    self.faults.append((line, reason))
                    self._close(one.names, line, reason)
                case VariableDeclaration(name=name):
                    self.declared.add(name)
                case Definition():
                    pass  # followed by itself

    def _call(self, tree: Expression) -> None:
        """Follow a call; a function that is not known may fill an empty array."""
        value = self.value(tree)
        if (
            isinstance(value, FunctionCall)
            and isinstance(tree, FunctionCall)
            and not is_zeros(tree)
        ):
            for place in filter(None, map(self.place, tree.arguments)):
                known = self.variables.get(place)
                if known and is_zeros(known) and not self._has_entries(place):
                    reason = "a function that is not followed may change the array"
                    self.variables[place] = Opaque(tree.line, reason)

    def _has_entries(self, place: str) -> bool:
        return any(key.startswith(f"{place}[") for key in self.variables)

    def _assign(self, one: Assignment) -> None:
        value = self.value(one.value)
        if isinstance(one.target, Name) and not one.operator:
            is_copy = isinstance(one.value, FunctionCall) and isinstance(value, Name)
            (self.copies.add if is_copy else self.copies.discard)(one.target.path)
        if one.operator:
            operands = (one.target, one.value)
            value = self.value(OperatorExpression(one.line, one.operator, operands))
        self.assign(one.line, one.target, value, is_declaration=one.is_declaration)

    def assign(
        self, line: int, target: Expression, value: Expression, *, is_declaration: bool = False
    ) -> None:
        """Give a target, or several, a value."""
        if isinstance(target, Array):
            for one, part in zip(target.items, self._parts(target, value), strict=True):
                self.assign(line, one, part, is_declaration=is_declaration)
        elif isinstance(target, Item) and any(isinstance(i, Slice) for i in target.indices):
            self._assign_range(line, target, value)
        elif self._is_constant(target, value):
            if array := self._letters(line, target, value):
                self.variables[static_path(target)] = array
            return  # it stays a letter
        elif static_path(target) in self.counts | self.context.kept and isinstance(
            target, Name | Member
        ):
            return
        elif path := self.place(target):
            if self._is_input(value, path):
                value = Name(line, path)
            if isinstance(target, Item) and whole(path[:-1].rpartition("[")[2]) is not None:
                self._open_array(target)
            for key in [key for key in self.variables if key.startswith((f"{path}[", f"{path}."))]:
                del self.variables[key]
            self.variables[path] = value
            if is_declaration:
                self.declared.add(path)
            self.steps.append(VariableValue(line, path, value))

    def _is_constant(self, target: Expression, value: Expression) -> bool:
        numbers = constant(value)
        if isinstance(numbers, tuple) and 0 in numbers and {*map(abs, numbers)} <= {0, 1}:
            return False  # a force acts on one coordinate, and not on others; an origin
        is_known = static_path(target) in self.fixed
        return is_known and isinstance(target, Name | Member) and numbers is not None

    def _letters(self, line: int, target: Expression, value: Expression) -> Array | None:
        """An array of numbers as entries with names, one for each of the bodies that are read."""
        items, first = entries(value), self.context.language.first_index
        if items is None:
            return None
        count = BODIES if len(items) in self.context.lengths else len(items)
        path = static_path(target)
        names: list[Expression] = [Name(line, f"{path}[{i + first}]") for i in range(count)]
        if count == len(items) <= MAX_COMPONENTS:  # of gravity, what is 0 stays so
            pairs = zip(items, names, strict=True)
            names = [item if constant(item) == 0 else name for item, name in pairs]
        return Array(line, tuple(names))

    def _open_array(self, target: Item) -> None:
        """Keep the entries of an array one by one, so that one of them can change."""
        place = self.place(target.base)
        items = entries(self.variables[place]) if place in self.variables else None
        if place and items is not None:
            del self.variables[place]
            first = self.context.language.first_index
            self.variables |= {f"{place}[{i + first}]": item for i, item in enumerate(items)}

    def _assign_range(self, line: int, target: Item, value: Expression) -> None:
        whole_range = all(
            isinstance(i, Slice) and i.lower is None and i.upper is None for i in target.indices
        )
        if whole_range:
            self.assign(line, target.base, value)
        elif (index := row_or_column(target)) is not None:
            self.assign(line, Item(target.line, target.base, (index,)), value)
        elif isinstance(array := self.value(target), Array):
            for one, part in zip(array.items, self._parts(array, value), strict=True):
                self.assign(line, one, part)

    def _parts(self, target: Array, value: Expression) -> Sequence[Expression]:
        count = len(target.items)
        if all(isinstance(one, Array) and len(one.items) == 1 for one in target.items):
            parts = self._parts(
                replace(target, items=tuple(one.parts[0] for one in target.items)), value
            )
            return [Array(part.line, (part,)) for part in parts]
        items = entries(flat(value))
        if items is not None and len(items) == count:
            return items
        if isinstance(value, Name):
            return self.named_entries(value.line, value.path, 0, count)
        if isinstance(value, FunctionCall) and value.function == Name(0, "deal"):  # of MATLAB
            return [Name(value.line, static_path(one)) for one in target.items]
        if isinstance(value, FunctionCall):
            numbers = [NumberLiteral(value.line, str(i)) for i in range(count)]
            return [Item(value.line, value, (number,)) for number in numbers]
        return [Opaque(value.line, "the values of several names are not followed")] * count

    def _branch(self, one: Conditional) -> None:
        values = [self.variables.get(name) for name in one.different]
        indices = [None if value is None else number(value) for value in values]
        if None not in indices:
            self.run(one.body if indices[0] != indices[1] else one.otherwise)
            return
        branches = [self._copy(), self._copy()]
        count = len(self.steps)
        for branch, body in zip(branches, (one.body, one.otherwise), strict=True):
            branch.run(body)
            self.steps += branch.steps[count:]
            self.calls += branch.calls
            self.faults += branch.faults
        open_ones = [branch for branch in branches if not branch.has_ended]
        for branch in branches:
            if branch.has_ended and branch.returned is not None:
                self.other_returns.append(Return(one.line, branch.returned))
            self.other_returns += branch.other_returns
        if not open_ones:
            self.has_ended = True
            self.returned = Opaque(one.line, CONDITION)
        elif len(open_ones) == 1:
            self.variables = open_ones[0].variables
        else:
            self._merge(one.line, branches[1].variables, branches[0].variables)

    def _copy(self) -> Self:
        other = copy(self)
        other.variables, other.steps, other.calls = {**self.variables}, [*self.steps], []
        other.other_returns, other.returned, other.faults = [], None, []
        return other

    def _merge(
        self, line: int, before: dict[str, Expression], after: dict[str, Expression]
    ) -> None:
        merged = {}
        for path in before | after:
            values = [one.get(path, Name(line, path)) for one in (before, after)]
            value = values[0] if values[0] == values[1] else Choice(line, *values)
            merged[path] = Name(line, path) if self._is_input(value, path) else value
        self.variables = merged

    def _loop(self, one: Loop) -> None:
        indices = self.range(*one.bounds) if one.bounds else None
        if indices is not None:
            before = self.variables.get(one.variable)
            self.indices[one.variable] = indices.stop
            for index in indices:
                self.variables[one.variable] = NumberLiteral(one.line, str(index))
                self.run(one.body)
            for kept in (self.variables, self.indices):
                kept.pop(one.variable, None)  # an inner loop of the same variable has removed it
            if before is not None:
                self.variables[one.variable] = before
            return
        if (body := elementwise(one)) is not None:
            self.run(body)
            return
        if (components := self._components(one)) is not None:
            for path in changed_vectors(one):
                entries_of = [f"{path}[{component}]" for component in components]
                if self.variables.keys().isdisjoint([path, *entries_of]):
                    self.variables |= {entry: Name(one.line, entry) for entry in entries_of}
            for component in components:
                self.variables[one.variable] = NumberLiteral(one.line, str(component))
                self.run(one.body)
            del self.variables[one.variable]
            return
        self.loops.append((one, {**self.variables}))
        self._close(assigned(one.body), one.line, LOOP)

    def _components(self, one: Loop) -> range | None:
        """The indices of a loop over the components of vectors; None of other loops."""
        if one.bounds is None or not has_index(one):
            return None
        values = (self.context.constants.get(static_path(bound), bound) for bound in one.bounds)
        first, end = (integer(self.value(value)) for value in values)
        is_short = first is not None and end is not None and first < end <= first + MAX_COMPONENTS
        return range(first or 0, end or 0) if is_short else None

    def _close(self, paths: Iterable[str], line: int, reason: str) -> None:
        """Give variables values that cannot be followed."""
        for path in paths:
            for key in [k for k in self.variables if k.startswith((f"{path}[", f"{path}."))]:
                del self.variables[key]
            self.variables[path] = Opaque(line, reason)

    def _is_input(self, tree: Expression, path: str = "") -> bool:
        """Whether a value is one of two constants, such as a force to the left or to the right.

        With a path, also whether it is a variable within limits that are constants.
        """
        if not isinstance(tree, Choice):
            return False
        others = [one for one in tree.parts if one != Name(0, path)]
        return len(others) > 0 and all(map(self._is_number, others))

    def _is_number(self, tree: Expression) -> bool:
        match tree:
            case OperatorExpression(operands=operands):
                return all(map(self._is_number, operands))
            case Name(path=path):
                return path in self.context.constants or path == "pi"
        return number(tree) is not None
