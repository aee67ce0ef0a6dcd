"""The functions of a program, the loops in them, and the statements outside all functions."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from derive.reading.programs.evaluation.arrays import entries
from derive.reading.programs.evaluation.context import (
    OWN_OBJECTS,
    ProgramContext,
    assigned,
    statements,
    static_path,
    targets,
)
from derive.reading.programs.evaluation.counted_loops import counts, expressions, integer
from derive.reading.programs.evaluation.following import Follower
from derive.reading.programs.evaluation.numeric_values import constant, number
from derive.reading.programs.evaluation.values import root
from derive.reading.programs.findings.runge_kutta import called
from derive.reading.programs.syntax.code import (
    Assignment,
    Definition,
    ExpressionStatement,
    Lambda,
    Loop,
    Return,
    Statement,
)
from derive.reading.programs.syntax.trees import (
    Array,
    Expression,
    FunctionCall,
    Item,
    Member,
    Name,
    Opaque,
    replaced,
)

#: Names of constants that no program defines: of a canvas in Processing and p5.js.
OUTER = frozenset(("pi", "height", "width", "windowHeight", "windowWidth"))
#: Entries of the longest vector that is followed as one in a loop.
MAX_VECTOR = 3


@dataclass(frozen=True)
class Region:
    """Statements that are followed from the first to the last."""

    name: str
    line: int
    definition: Definition  # of a loop, its body as a function without parameters
    follower: Follower
    is_loop: bool = False


def prepare(context: ProgramContext, body: tuple[Statement, ...]) -> None:
    """Collect the functions and constants of a program."""
    everything = [*statements(body, inner=True)]
    context.variables = {*assigned(body, inner=True)}
    for one in everything:
        if isinstance(one, Definition):
            context.functions.setdefault(one.name, []).append(one)
            context.variables.discard(one.name)
    values: dict[str, list[Expression]] = {}
    assignments: Counter[str] = Counter()
    for namespace in (body, *(one.body for one in everything if isinstance(one, Definition))):
        fixed = _fixed(context, namespace)
        context.fixed[id(namespace)] = {*fixed}
        context.counts[id(namespace)] = counts(namespace)
        assignments.update({*assigned(namespace)})
        for path, value in fixed.items():
            values.setdefault(path, []).append(value)
    bounds = {bound for result in context.counts.values() for bound in result}
    for path, result in values.items():
        if len(result) == assignments[path] and len({constant(value) for value in result}) == 1:
            items, first = entries(result[0]), context.language.first_index
            entry = {f"{path}[{i + first}]": one for i, one in enumerate(items or ())}
            context.constants |= entry or {path: result[0]}
            if f"len({path})" in bounds:
                context.lengths.add(len(entry))
    sizes = (integer(context.constants.get(path)) for path in bounds)
    context.lengths |= {size for size in sizes if size}


def _fixed(context: ProgramContext, body: tuple[Statement, ...]) -> dict[str, Expression]:
    """The names that have one numeric value in a function, and the values."""
    values: dict[str, list[Expression | None]] = {}
    reader = Follower(context)
    for one in statements(body, inner=False):
        if isinstance(one, Assignment):
            given = None if one.operator else reader.value(one.value)
            single = [*targets(one.target)]
            parts: Sequence[Expression | None] = [given]
            if len(single) != 1:
                known = isinstance(given, Array) and len(given.items) == len(single)
                parts = given.items if known and isinstance(given, Array) else [None] * len(single)
            for target, value in zip(single, parts, strict=True):
                is_whole = isinstance(target, Name | Member)
                values.setdefault(static_path(target), []).append(value if is_whole else None)
    fixed = {}
    for path, result in values.items():
        numbers = {constant(value) if value is not None else None for value in result}
        if path and result[0] is not None and len(numbers) == 1 and None not in numbers:
            fixed[path] = result[0]
    return fixed


def regions(context: ProgramContext, body: tuple[Statement, ...]) -> list[Region]:
    """All regions, followed twice: then each knows the values that others assign once."""
    result = [*_regions(context, body)]
    once = _assigned_once(body)
    for region in result:
        own = {one.name for one in region.definition.parameters}
        for path, value in region.follower.variables.items():
            if region.is_loop and isinstance(value, Name):
                continue  # a value before
            if path in once - own and _is_formula(value) and not _contains(value, path):
                context.shared[path] = _elsewhere(value, own, region.definition.name)
    return [*_regions(context, body)]


def derived_constants(context: ProgramContext) -> frozenset[str]:
    """The names with one formula of numeric constants, or of the size of a canvas."""

    def is_constant(tree: Expression, within: frozenset[str] = frozenset()) -> bool:
        parts = tree.parts
        match tree:
            case Name(path=path):
                if path in OUTER or path in context.constants:
                    return True
                if path in within or path not in context.shared:
                    return False
                parts, within = (context.shared[path],), within | {path}
            case FunctionCall(arguments=arguments):
                parts = arguments
        return all(is_constant(part, within) for part in parts)

    return frozenset(
        path for path, value in context.shared.items() if value.parts and is_constant(value)
    )


def _assigned_once(body: tuple[Statement, ...]) -> set[str]:
    """Names with one formula, even repeated; numbers that they have at the beginning aside."""
    counts: Counter[str] = Counter()
    formulas: dict[str, Expression] = {}
    for one in _everything(body):
        if isinstance(one, Assignment):
            for target in targets(one.target):
                path = static_path(target)
                is_whole = isinstance(target, Name | Member) and not one.operator
                is_known = number(one.value) is not None or formulas.get(path) == one.value
                formulas.setdefault(path, one.value)
                counts[path] += (not is_known) if is_whole else 2
        elif isinstance(one, ExpressionStatement) and isinstance(one.value, FunctionCall):
            # a function can change its arguments, and a method its object
            changed = [*one.value.parts]
            if isinstance(one.value.function, Member):
                changed.append(one.value.function.base)
            counts.update({static_path(part): 2 for part in changed})
    return {path for path, count in counts.items() if count == 1}


def _everything(body: tuple[Statement, ...]) -> Iterator[Statement]:
    """All statements, also those of functions without a name."""
    for one in statements(body, inner=True):
        yield one
        if isinstance(one, ExpressionStatement | Assignment):
            for callback in _callbacks(one.value):
                yield from _everything(callback.body)


def _elsewhere(tree: Expression, parameters: set[str], function: str) -> Expression:
    """A value with the parameters of a function as names that others do not have."""
    if isinstance(tree, Name):
        is_parameter = root(tree.path) in parameters - {*OWN_OBJECTS}
        return Name(tree.line, f"{function}.{tree.path}") if is_parameter else tree
    parts = tuple(_elsewhere(part, parameters, function) for part in tree.parts)
    is_same = all(a is b for a, b in zip(parts, tree.parts, strict=True))
    return tree if is_same else replaced(tree, parts)


def _is_formula(value: Expression) -> bool:
    """Whether a value is a formula: no number, and no value of a function that is not known."""
    return number(value) is None and not isinstance(value, Opaque) and not _has_call(value)


def _has_call(tree: Expression) -> bool:
    return called(tree) is not None or any(map(_has_call, tree.parts))


def _contains(tree: Expression, path: str) -> bool:
    if isinstance(tree, Name):
        return tree.path == path or tree.path.startswith((f"{path}[", f"{path}."))
    return any(_contains(part, path) for part in tree.parts)


def _regions(context: ProgramContext, body: tuple[Statement, ...]) -> Iterator[Region]:
    yield from _followed(context, Definition(1, "", (), body), {}, body)
    for one in statements(body, inner=True):
        if isinstance(one, Definition):
            yield from _followed(context, one, _vectors(context, one), one.body)
        elif isinstance(one, Return) and isinstance(one.value, Lambda):
            yield from _followed(context, one.value.function, {}, one.value.function.body)
        elif isinstance(one, ExpressionStatement | Assignment):
            for callback in _callbacks(one.value):
                yield from _followed(context, callback, {}, callback.body)


def _vectors(context: ProgramContext, function: Definition) -> dict[str, Expression]:
    """The parameters of a function for which all calls pass vectors of one length."""
    result = dict[str, Expression]()
    series = {  # with an index that counts, such as that of time
        static_path(one.base)
        for one in expressions(function.body)
        if isinstance(one, Item) and any(number(index) is None for index in one.indices)
    }
    for name, lengths in context.passed.get(id(function.body), {}).items():
        is_vector = len(lengths) == 1 and name not in series
        if is_vector and 1 < (length := min(lengths)) <= MAX_VECTOR:
            result[name] = _vector(context, name, function.line, length)
    return result


def _vector(context: ProgramContext, path: str, line: int, length: int) -> Array:
    """A vector of names for its entries."""
    first = context.language.first_index
    return Array(line, tuple(Name(line, f"{path}[{i + first}]") for i in range(length)))


def _callbacks(tree: Expression) -> Iterator[Definition]:
    """Functions without a name that a call takes and that assign something, such as a frame's."""
    if isinstance(tree, FunctionCall):
        for one in tree.arguments:
            if isinstance(one, Lambda) and assigned(one.function.body):
                yield one.function
    for part in tree.parts:
        yield from _callbacks(part)


def _followed(
    context: ProgramContext,
    definition: Definition,
    variables: dict[str, Expression],
    namespace: tuple[Statement, ...],
    *,
    is_loop: bool = False,
) -> Iterator[Region]:
    follower = Follower(context, definition.owner)
    follower.parameters = {one.name for one in definition.parameters}
    follower.fixed = context.fixed.get(id(namespace), set())
    follower.counts = context.counts.get(id(namespace), set())
    follower.variables = variables
    follower.run(definition.body)
    name = definition.name
    if definition.owner and name:
        name = f"{definition.owner}.{name}"
    yield Region(name, definition.line, definition, follower, is_loop)
    for loop, before in follower.loops:
        yield from _followed(
            context,
            _as_function(loop, definition),
            _kept(context, loop, before),
            namespace,
            is_loop=True,
        )


def _as_function(loop: Loop, outer: Definition) -> Definition:
    return Definition(loop.line, outer.name, outer.parameters, loop.body, outer.owner)


def _kept(
    context: ProgramContext, loop: Loop, before: dict[str, Expression]
) -> dict[str, Expression]:
    """The values before a loop of the variables that it does not change."""
    whole = {*assigned(loop.body)}
    changed = {root(path) for path in whole} | {loop.variable}
    for one in statements(loop.body, inner=False):
        if isinstance(one, ExpressionStatement) and isinstance(one.value, FunctionCall):
            # a function can change arrays that are passed
            is_own = context.function(static_path(one.value.function), "") is not None
            for part in one.value.arguments:
                path = static_path(part)
                if is_own or isinstance(before.get(path), Array):
                    whole.add(path)
    kept = {
        path: value
        for path, value in before.items()
        if path not in whole and (root(path) not in changed or "." in path)
    }
    for path in [one for one in before if one in whole]:  # vectors that change keep their length
        items = entries(before[path]) or ()
        if 1 < len(items) <= MAX_VECTOR and not any(map(entries, items)):
            kept[path] = _vector(context, path, loop.line, len(items))
    return kept
