"""Calls in programs: of functions of the program, of mathematics and of arrays."""

from dataclasses import dataclass

from derive.reading.programs.evaluation.arrays import entries, of_arrays, of_entries
from derive.reading.programs.evaluation.context import (
    APPENDING,
    OWN_OBJECTS,
    ProgramContext,
    assigned,
    declared,
    static_path,
)
from derive.reading.programs.evaluation.counted_loops import mapped
from derive.reading.programs.evaluation.mathematics import METHODS, split
from derive.reading.programs.evaluation.numeric_values import number
from derive.reading.programs.evaluation.values import Values, root
from derive.reading.programs.syntax.code import Definition, Lambda, Return, Statement
from derive.reading.programs.syntax.trees import (
    Array,
    Expression,
    FunctionCall,
    Item,
    Member,
    Name,
    NumberLiteral,
    Opaque,
    Record,
    Result,
)

#: Calls within calls that are followed.
MAX_CALLS = 8
#: Methods that return an entry of an array.
ENTRIES = ("getEntry", "get")
#: Nodes of the largest value of a function of values of functions.
MAX_NESTED = 500
CONDITION = "the value depends on a condition"


@dataclass(frozen=True)
class VariableValue:
    """A value that a variable takes."""

    line: int
    path: str
    value: Expression


class Calls(Values):
    """The values of calls; those of functions of the program are followed."""

    def __init__(self, context: ProgramContext, owner: str = "") -> None:
        super().__init__(context, owner)
        self.steps: list[VariableValue] = []
        #: The value that is returned, and values that are returned under conditions.
        self.returned: Expression | None = None
        self.other_returns: list[Return] = []
        self.calls: list[FunctionCall] = []
        self.declared: set[str] = set()
        self.depth = 0

    def run(self, body: tuple[Statement, ...]) -> None:
        """Follow statements in order."""
        raise NotImplementedError

    def assign(self, line: int, target: Expression, value: Expression) -> None:
        """Give a target, or several, a value."""
        raise NotImplementedError

    def called(self, call: FunctionCall) -> Expression:
        """The value of a call: of mathematics, of arrays, or of a function of the program."""
        path = self.place(call.function) or ""
        if isinstance(other := self.variables.get(path), Name):
            path = other.path  # another name of a function
        arguments = tuple(map(self.value, call.arguments))
        name = split(path)[1]
        if not path and isinstance(call.function, Member):
            name = call.function.name  # the method of a value without a name
        made = FunctionCall(call.line, call.function, arguments, call.keywords)
        self.calls.append(made)
        if (function := self._function(call.function, path)) is not None:
            return self._inlined(made, function, call.arguments)
        if self._is_entry(call, path, arguments):
            return self.value(Item(call.line, call.function, call.arguments))
        if name == "view" and len(call.arguments) > 1:  # of Julia
            return self.value(Item(call.line, call.arguments[0], call.arguments[1:]))
        match arguments:
            case (Name(path="t" | "time"),) if path in self.parameters:
                return Name(call.line, path)  # a load as a function of time
        if (value := of_entries(call.line, path, arguments)) is not None:
            return value
        if path == "copy" and len(arguments) == 2:  # of Go
            self.assign(call.line, call.arguments[0], arguments[1])
            return made
        if name in ENTRIES and isinstance(call.function, Member) and len(arguments) == 1:
            return self.value(Item(call.line, call.function.base, call.arguments))
        if name == "new" and isinstance(call.function, Member):  # of a type of Rust
            path = static_path(call.function.base)
        if name in METHODS and isinstance(call.function, Member):
            operands = (self.value(call.function.base), *arguments)
            value = of_entries(call.line, name, operands)
            value = value or of_arrays(
                FunctionCall(call.line, Name(call.line, name), operands),
                name,
                None,
                self.context.language,
            )
            if value is not None:
                return value
        if name == "map" and isinstance(call.function, Member):
            match arguments:
                case (Lambda(function=of_entry),):
                    array = mapped(of_entry, call.function.base)
                    return made if array is None else self.value(array)
        if name in APPENDING and isinstance(call.function, Member) and len(arguments) == 1:
            last = Item(call.line, call.function.base, (NumberLiteral(call.line, "-1"),))
            self.assign(call.line, last, arguments[0])
            return made
        value = of_arrays(made, path or name, self._base(call), self.context.language)
        return made if value is None else value

    def _base(self, call: FunctionCall) -> Expression | None:
        """The object of a method."""
        function = call.function
        return self.value(function.base) if isinstance(function, Member) else None

    def _is_entry(self, call: FunctionCall, path: str, arguments: tuple[Expression, ...]) -> bool:
        """Whether round brackets contain an index."""
        language = self.context.language
        has_numbers = len(arguments) > 0 and all(number(one) is not None for one in arguments)
        is_possible = language.has_round_indices or (language.has_numbered_entries and has_numbers)
        if not is_possible or not isinstance(call.function, Name):
            return False
        return root(path) in self.context.variables or root(path) in self.parameters

    def _function(self, tree: Expression, path: str) -> Definition | None:
        value = self.variables.get(path)
        if isinstance(value, Lambda):
            return value.function
        return self.context.function(path, self.owner)  # passed by its name, if a parameter

    def _inlined(
        self, call: FunctionCall, function: Definition, given: tuple[Expression, ...]
    ) -> Expression:
        if self.depth >= MAX_CALLS:
            return Opaque(call.line, f"calls of {function.name} within calls are not followed")
        parameters = [one.name for one in function.parameters]
        if parameters[:1] in (["self"], ["obj"]) and isinstance(call.function, Member):
            is_of_class = call.function.base in (Name(0, function.owner), Name(0, "Self"))
            parameters = parameters[not is_of_class :]
        own = {*parameters, *function.results, *declared(function.body)}
        if self.context.language.assigns_locals:
            own |= {path for path in assigned(function.body) if "." not in path}
        callee = type(self)(self.context, function.owner or self.owner)
        callee.depth, callee.parameters = self.depth + 1, {*parameters}
        changed = assigned(function.body)
        variables = {k: v for k, v in self.variables.items() if root(k) not in own}
        named = dict(call.keywords)
        lengths = self.context.passed.setdefault(id(function.body), {})
        for index, name in enumerate(parameters):
            if index < len(call.arguments):
                if not isinstance(call.arguments[index], Name | Opaque):
                    length = len(entries(call.arguments[index]) or ())
                    lengths.setdefault(name, set()).add(length)
                variables[name] = call.arguments[index]
                place = self.place(given[index])
                if place and changed[name]:
                    callee.references[name] = place
                    variables |= {k: v for k, v in self.variables.items() if root(k) == place}
            elif name in named:
                variables[name] = self.value(named[name])
        callee.fixed = self.context.fixed.get(id(function.body), set())
        callee.counts = self.context.counts.get(id(function.body), set())
        callee.variables = variables
        callee.run(function.body)
        self.calls += callee.calls
        self._take_back(callee, own, call)
        value = callee.result(function)
        return Result(call.line, call, self._trimmed(call, value))

    def _take_back(self, callee: "Calls", own: set[str], call: FunctionCall) -> None:
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

    def _trimmed(self, call: FunctionCall, value: Expression) -> Expression:
        """A value with large entries left out, in the later stages of a method."""
        if isinstance(value, Array):
            items = tuple(self._trimmed(call, one) for one in value.items)
            return Array(value.line, items)
        if value.size > MAX_NESTED and _has_results(call):
            return Opaque(value.line, "the formula is too large")
        return value

    def result(self, function: Definition) -> Expression:
        """The value that the function returns."""
        if self.other_returns:
            return Opaque(self.other_returns[0].line, CONDITION)
        if self.returned is not None:
            return self._with_members(self.returned)
        values = tuple(self.variable(function.line, name) for name in function.results)
        if len(values) == 1:
            return values[0]
        return Array(function.line, values) if values else Opaque(function.line, "no value")

    def _with_members(self, tree: Expression) -> Expression:
        """A variable whose members were assigned one by one, as a record of their values."""
        if not isinstance(tree, Name) or tree.path in {*OWN_OBJECTS, *self.parameters}:
            return tree
        start = f"{tree.path}."
        fields = tuple(
            (key.removeprefix(start), value)
            for key, value in self.variables.items()
            if key.startswith(start)
        )
        is_flat = all(name.isidentifier() for name, _ in fields)
        return Record(tree.line, fields) if fields and is_flat else tree


def _has_results(tree: Expression) -> bool:
    """Whether values of functions of the program occur, as in the stages of a method."""
    return isinstance(tree, Result) or any(map(_has_results, tree.parts))
