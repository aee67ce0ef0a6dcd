"""Functions followed statement by statement: the values of their variables in the end."""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from typing import Self

from derive.reading.programs.arrays import entries, flat, product
from derive.reading.programs.context import APPENDING, Context, assigned, static_path
from derive.reading.programs.degrees import number
from derive.reading.programs.elementwise import elementwise
from derive.reading.programs.mathematics import IDENTITIES, applied, split
from derive.reading.programs.trees import (
    Array,
    Assignment,
    Branch,
    Call,
    Choice,
    Declaration,
    Definition,
    Evaluation,
    Fault,
    Item,
    Lambda,
    Loop,
    Member,
    Name,
    Number,
    Opaque,
    Operation,
    Result,
    Return,
    Slice,
    Statement,
    Tree,
)
from derive.reading.programs.values import Values, whole

#: Calls within calls that are followed.
MAX_CALLS = 8
LOOP = "a loop is not followed"
#: Nodes of the largest value of a function of values of functions.
MAX_NESTED = 500
STACKED = {"concatenate", "hstack", "vcat", "block", "concat", "r_", "append", "vstack"}


@dataclass(frozen=True)
class Step:
    """A value that a variable takes."""

    line: int
    path: str
    value: Tree


class Follower(Values):
    """Follows statements; names that are not assigned before stand for themselves."""

    def __init__(self, context: Context, owner: str = "") -> None:
        super().__init__(context, owner)
        self.steps: list[Step] = []
        #: The value that is returned, and values that are returned under conditions.
        self.returned: Tree | None = None
        self.other_returns: list[Return] = []
        self.calls: list[Call] = []
        #: Loops that are followed by themselves, and the values of variables before them.
        self.loops: list[tuple[Loop, dict[str, Tree]]] = []
        #: Statements that are not understood: line and reason.
        self.faults: list[tuple[int, str]] = []
        self.declared: set[str] = set()
        #: Names with one numeric value, which stay letters.
        self.fixed: set[str] = set()
        self.has_ended = False
        self.depth = 0

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
                case Evaluation(value=value):
                    self.value(value)
                case Branch():
                    self._branch(one)
                case Loop():
                    self._loop(one)
                case Fault(line=line, reason=reason):
                    self.faults.append((line, reason))
                case Declaration(name=name):
                    self.declared.add(name)
                case Definition():
                    pass  # followed by itself

    def _assign(self, one: Assignment) -> None:
        value = self.value(one.value)
        if one.operator:
            operands = (one.target, one.value)
            value = self.value(Operation(one.line, one.operator, operands))
        self.assign(one.line, one.target, value, is_declaration=one.is_declaration)

    def assign(self, line: int, target: Tree, value: Tree, *, is_declaration: bool = False) -> None:
        """Give a target, or several, a value."""
        if isinstance(target, Array):
            for one, part in zip(target.items, self._parts(target, value), strict=True):
                self.assign(line, one, part)
        elif isinstance(target, Item) and any(isinstance(i, Slice) for i in target.indices):
            self._assign_range(line, target, value)
        elif self._is_constant(target, value):
            return  # it stays a letter
        elif path := self.place(target):
            if _is_input(value):
                value = Name(line, path)
            if isinstance(target, Item) and whole(path[:-1].rpartition("[")[2]) is not None:
                self._open_array(target)
            for key in [key for key in self.variables if key.startswith((f"{path}[", f"{path}."))]:
                del self.variables[key]
            self.variables[path] = value
            if is_declaration:
                self.declared.add(path)
            self.steps.append(Step(line, path, value))

    def _is_constant(self, target: Tree, value: Tree) -> bool:
        is_known = static_path(target) in self.fixed
        return is_known and isinstance(target, Name | Member) and number(value) is not None

    def _open_array(self, target: Item) -> None:
        """Keep the entries of an array one by one, so that one of them can change."""
        place = self.place(target.base)
        items = entries(self.variables[place]) if place in self.variables else None
        if place and items is not None:
            del self.variables[place]
            first = self.context.language.first_index
            self.variables |= {f"{place}[{i + first}]": item for i, item in enumerate(items)}

    def _assign_range(self, line: int, target: Item, value: Tree) -> None:
        whole_range = all(
            isinstance(i, Slice) and i.lower is None and i.upper is None for i in target.indices
        )
        if whole_range:
            self.assign(line, target.base, value)
        elif isinstance(array := self.value(target), Array):
            for one, part in zip(array.items, self._parts(array, value), strict=True):
                self.assign(line, one, part)

    def _parts(self, target: Array, value: Tree) -> Sequence[Tree]:
        count = len(target.items)
        items = entries(flat(value))
        if items is not None and len(items) == count:
            return items
        if isinstance(value, Name):
            return self.named_entries(value.line, value.path, 0, count)
        if isinstance(value, Call):
            numbers = [Number(value.line, str(i)) for i in range(count)]
            return [Item(value.line, value, (number,)) for number in numbers]
        return [Opaque(value.line, "the values of several names are not followed")] * count

    def _branch(self, one: Branch) -> None:
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
            self.returned = Opaque(one.line, "the value depends on a condition")
        elif len(open_ones) == 1:
            self.variables = open_ones[0].variables
        else:
            self._merge(one.line, branches[1].variables, branches[0].variables)

    def _copy(self) -> Self:
        other = copy(self)
        other.variables, other.steps, other.calls = {**self.variables}, [*self.steps], []
        other.other_returns, other.returned, other.faults = [], None, []
        return other

    def _merge(self, line: int, before: dict[str, Tree], after: dict[str, Tree]) -> None:
        merged = {}
        for path in before | after:
            values = [one.get(path, Name(line, path)) for one in (before, after)]
            value = values[0] if values[0] == values[1] else Choice(line, *values)
            merged[path] = Name(line, path) if _is_input(value) else value
        self.variables = merged

    def _loop(self, one: Loop) -> None:
        if (body := elementwise(one)) is not None:
            self.run(body)
            return
        self.loops.append((one, {**self.variables}))
        for path in assigned(one.body):
            for key in [k for k in self.variables if k.startswith((f"{path}[", f"{path}."))]:
                del self.variables[key]
            self.variables[path] = Opaque(one.line, LOOP)

    def called(self, call: Call) -> Tree:
        """The value of a call: of mathematics, of arrays, or of a function of the program."""
        path = self.place(call.function) or ""
        arguments = tuple(map(self.value, call.arguments))
        library, name = split(path)
        made = Call(call.line, call.function, arguments, call.keywords)
        self.calls.append(made)
        if (function := self._function(call.function, path)) is not None:
            return self._inlined(made, function, call.arguments)
        if self._is_entry(call, path):
            return self.value(Item(call.line, call.function, call.arguments))
        if (value := _applied(call.line, path, arguments)) is not None:
            return value
        if name in APPENDING and isinstance(call.function, Member) and len(arguments) == 1:
            last = Item(call.line, call.function.base, (Number(call.line, "-1"),))
            self.assign(call.line, last, arguments[0])
            return made
        if name == "dot" and len(arguments) == 1 and isinstance(call.function, Member):
            return product(
                call.line, self.value(call.function.base), arguments[0], self.context.language
            )
        match name, arguments:
            case ("dot" | "matmul", (left, right)):
                return product(call.line, left, right, self.context.language)
            case ("solve" | "linsolve" | "mldivide", (matrix, column)):
                return Operation(call.line, "solve", (matrix, flat(column)))
            case ("inv" | "pinv" | "inverse", (matrix,)):
                return Operation(call.line, "inverse", (matrix,))
            case (("copy" | "flatten" | "ravel" | "reshape" | "tolist" | "transpose"), _) if (
                isinstance(call.function, Member) and library not in ("np", "numpy", "jnp")
            ):
                return flat(self.value(call.function.base))
            case _, (first, *rest) if name in STACKED and (stacked := _stacked(first, rest)):
                return stacked
            case _, (first, *rest) if name in IDENTITIES:
                return first if not rest or isinstance(first, Array) else _listed(made)
        return made

    def _is_entry(self, call: Call, path: str) -> bool:
        """Whether round brackets contain an index."""
        if not self.context.language.has_round_indices or not isinstance(call.function, Name):
            return False
        return path in self.context.variables or path in self.parameters

    def _function(self, tree: Tree, path: str) -> Definition | None:
        value = self.variables.get(path)
        if isinstance(value, Lambda):
            return value.function
        return None if path in self.parameters else self.context.function(path, self.owner)

    def _inlined(self, call: Call, function: Definition, given: tuple[Tree, ...]) -> Tree:
        if self.depth >= MAX_CALLS:
            return Opaque(call.line, f"calls of {function.name} within calls are not followed")
        parameters = [one.name for one in function.parameters]
        if parameters[:1] in (["self"], ["obj"]) and isinstance(call.function, Member):
            parameters = parameters[1:]
        own = {*parameters, *function.results}
        if self.context.language.assigns_locals:
            own |= {path for path in assigned(function.body) if "." not in path}
        callee = type(self)(self.context, function.owner or self.owner)
        callee.depth, callee.parameters = self.depth + 1, {*parameters}
        changed = assigned(function.body)
        variables = {k: v for k, v in self.variables.items() if root(k) not in own}
        named = dict(call.keywords)
        for index, name in enumerate(parameters):
            if index < len(call.arguments):
                variables[name] = call.arguments[index]
                place = self.place(given[index])
                if place and changed[name]:
                    callee.references[name] = place
                    variables |= {k: v for k, v in self.variables.items() if root(k) == place}
            elif name in named:
                variables[name] = self.value(named[name])
        callee.fixed = self.context.fixed.get(id(function.body), set())
        callee.variables = variables
        callee.run(function.body)
        self.calls += callee.calls
        self._take_back(callee, own, call)
        value = callee.result(function)
        return Result(call.line, call, self._trimmed(call, value))

    def _take_back(self, callee: "Follower", own: set[str], call: Call) -> None:
        """Take the values of variables that a function changes outside itself."""
        references = set(callee.references.values())
        own = (own | callee.declared) - references
        for key, value in callee.variables.items():
            if root(key) not in own and self.variables.get(key) is not value:
                self.variables[key] = value
        for place in references:
            array = self._collected(call.line, place)
            if array is not None:
                self.assign(
                    call.line,
                    Name(call.line, place),
                    Result(call.line, call, self._trimmed(call, array)),
                )
        self.steps += [one for one in callee.steps if root(one.path) not in own]

    def _trimmed(self, call: Call, value: Tree) -> Tree:
        """A value with large entries left out, in the later stages of a method."""
        if isinstance(value, Array):
            items = tuple(self._trimmed(call, one) for one in value.items)
            return Array(value.line, items)
        if value.size > MAX_NESTED and _has_results(call):
            return Opaque(value.line, "the formula is too large")
        return value

    def result(self, function: Definition) -> Tree:
        """The value that the function returns."""
        if self.other_returns:
            return Opaque(self.other_returns[0].line, "the value depends on a condition")
        if self.returned is not None:
            return self.returned
        values = tuple(self.variable(function.line, name) for name in function.results)
        if len(values) == 1:
            return values[0]
        return Array(function.line, values) if values else Opaque(function.line, "no value")


def root(path: str) -> str:
    """The variable of an entry or member."""
    return path.partition("[")[0].partition(".")[0]


def _applied(line: int, path: str, arguments: tuple[Tree, ...]) -> Tree | None:
    """The value of a function of mathematics, of each entry of an array."""
    if len(arguments) == 1 and (items := entries(arguments[0])) is not None:
        values = [applied(line, path, (one,)) for one in items]
        return Array(line, tuple(v for v in values if v)) if all(values) else None
    return applied(line, path, arguments)


def _is_input(tree: Tree) -> bool:
    """Whether a value is one of two numbers, such as a force to the left or to the right."""
    return isinstance(tree, Choice) and all(number(part) is not None for part in tree.parts)


def _has_results(tree: Tree) -> bool:
    """Whether values of functions of the program occur, as in the stages of a method."""
    return isinstance(tree, Result) or any(map(_has_results, tree.parts))


def _listed(call: Call) -> Tree:
    return Array(call.line, call.arguments)


def _stacked(first: Tree, rest: Sequence[Tree]) -> Tree | None:
    """Arrays one behind the other."""
    arrays = [*first.items] if isinstance(first, Array) and not rest else [first, *rest]
    parts = [entries(one) for one in arrays]
    if not arrays or all(part is None for part in parts):
        return first if isinstance(first, Array) and not rest else None
    rows = [part if part is not None else (one,) for one, part in zip(arrays, parts, strict=True)]
    return Array(first.line, tuple(one for row in rows for one in row))
