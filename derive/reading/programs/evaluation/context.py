"""What is known about a program before a function of it is followed."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

from derive.reading.programs.languages.language import Language
from derive.reading.programs.program import ProgramError
from derive.reading.programs.syntax.code import (
    Assignment,
    Conditional,
    Definition,
    ExpressionStatement,
    Loop,
    Statement,
    VariableDeclaration,
)
from derive.reading.programs.syntax.trees import Array, Expression, FunctionCall, Item, Member, Name

#: Expressions that are followed in one program.
MAX_STEPS = 60_000
#: Names of the object that a method belongs to.
OWN_OBJECTS = ("self", "this", "obj", "Self")
#: Methods that add an entry to an array.
APPENDING = ("append", "push", "push_back", "emplace_back")


@dataclass
class ProgramContext:
    """The functions of a program, and its variables that have one value."""

    language: Language
    functions: dict[str, list[Definition]] = field(default_factory=dict)
    #: The names that have one numeric value in a function, by the identity of its statements.
    fixed: dict[int, set[str]] = field(default_factory=dict)
    #: The bounds of loops over bodies in a function, by the identity of its statements.
    counts: dict[int, set[str]] = field(default_factory=dict)
    #: Lengths of the arrays that calls pass for parameters, by the identity of the statements.
    passed: dict[int, dict[str, set[int]]] = field(default_factory=dict)
    #: Lengths of arrays with an entry for each body.
    lengths: set[int] = field(default_factory=set)
    #: The values of those with one value in the whole program.
    constants: dict[str, Expression] = field(default_factory=dict)
    #: Names that are assigned anywhere.
    variables: set[str] = field(default_factory=set)
    #: Names that are assigned once, and their values.
    shared: dict[str, Expression] = field(default_factory=dict)
    #: Names that stay letters although they have one formula, of constants alone.
    kept: frozenset[str] = frozenset()
    steps: int = 0

    def spend(self) -> None:
        """Count a step; `ProgramError` if there are too many."""
        self.steps += 1
        if self.steps > MAX_STEPS:
            raise ProgramError(f"the program takes more than {MAX_STEPS} steps to follow")

    def function(self, path: str, owner: str) -> Definition | None:
        """The function that a name stands for in a class; None if there is none, or several."""
        base, _, name = path.rpartition(".")
        result = self.functions.get(name, [])
        if base not in ("", *OWN_OBJECTS, owner):
            result = [one for one in result if one.owner == base]  # of the class itself
            owner = base
        own = [one for one in result if one.owner == owner]
        if len(own or result) != 1:
            return None
        return (own or result)[0]


def static_path(tree: Expression) -> str:
    """The name of a target as written, without entries; empty for others."""
    match tree:
        case Name(path=path):
            return path
        case Member(base=base, name=name):
            return f"{outer}.{name}" if (outer := static_path(base)) else ""
        case Item(base=base):
            return static_path(base)
    return ""


def targets(tree: Expression) -> Iterator[Expression]:
    """The single targets of an assignment."""
    if isinstance(tree, Array):
        for one in tree.items:
            yield from targets(one)
    else:
        yield tree


def statements(body: tuple[Statement, ...], *, inner: bool) -> Iterator[Statement]:
    """All statements in order, with those of blocks; of functions within if `inner`."""
    for one in body:
        yield one
        match one:
            case Conditional():
                yield from statements(one.body, inner=inner)
                yield from statements(one.otherwise, inner=inner)
            case Loop():
                yield from statements(one.body, inner=inner)
            case Definition() if inner:
                yield from statements(one.body, inner=inner)


def declared(body: tuple[Statement, ...]) -> set[str]:
    """The names that belong to a function by their declarations."""
    result = set()
    for one in statements(body, inner=False):
        if isinstance(one, VariableDeclaration):
            result.add(one.name)
        elif isinstance(one, Assignment) and one.is_declaration:
            result.update(map(static_path, targets(one.target)))
    return {path for path in result if "." not in path}


def assigned(body: tuple[Statement, ...], *, inner: bool = False) -> Counter[str]:
    """How often each name is assigned, as a whole or in part."""
    result: Counter[str] = Counter()
    for one in statements(body, inner=inner):
        match one:
            case Assignment():
                result.update(map(static_path, targets(one.target)))
            case ExpressionStatement(value=FunctionCall(function=Member(base=base, name=name))):
                if name in APPENDING:
                    result[static_path(base)] += 1
    return result
