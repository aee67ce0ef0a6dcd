"""Programs in the subset of Python that targets translate: functions, types and parts."""

import ast
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

from derive.codegen.backend import Backend
from derive.codegen.module_functions import Contents, Function
from derive.codegen.operations.assignments import (
    FactorisationAssignment,
    SolutionAssignment,
    Statement,
    ValueAssignment,
)

Type = Literal["float", "int", "bool", "vector"]

#: Types by their annotations.
ANNOTATIONS: dict[str, Type] = {
    "float": "float", "int": "int", "bool": "bool", "Vector": "vector",
}  # fmt: skip
COMPARISONS = (ast.Compare, ast.BoolOp)


@dataclass
class Routine:
    """A function of a program, with the types of its variables."""

    node: ast.FunctionDef
    returns: Type | None
    parameters: dict[str, Type]
    #: Variables in order of their first assignment; counters of loops are not among them.
    variables: dict[str, Type] = field(default_factory=dict)
    counters: list[str] = field(default_factory=list)
    #: Parameters whose elements it changes, directly or by calls.
    changed: set[str] = field(default_factory=set)
    #: Variables that are assigned more than once, or whose elements change.
    mutable: set[str] = field(default_factory=set)

    @property
    def name(self) -> str:
        """Its name."""
        return self.node.name

    @property
    def doc(self) -> list[str]:
        """The lines of its docstring."""
        return (ast.get_docstring(self.node) or "").splitlines()

    @property
    def body(self) -> list[ast.stmt]:
        """Its statements, without the docstring."""
        return self.node.body[1 if self.doc else 0 :]

    @cached_property
    def used(self) -> set[str]:
        """Names that occur in its body."""
        return names_in(self.body)

    @property
    def calls(self) -> set[str]:
        """Names of the functions that it calls."""
        return {called(node) for one in self.body for node in ast.walk(one)} - {""}


def called(node: ast.AST) -> str:
    """The name of the function that a call calls; empty for other nodes."""
    match node:
        case ast.Call(func=ast.Name(id=name)):
            return name
    return ""


def names_in(nodes: Iterable[ast.AST]) -> set[str]:
    """All names in some nodes."""
    return {node.id for one in nodes for node in ast.walk(one) if isinstance(node, ast.Name)}


class ExportedProgram:
    """Constants and functions, from a tree of Python, that functions called `entry` need.

    Attributes
    ----------
    constants : dict
        Values by name: int, float, or a list of float.
    routines : dict
        Functions by name, each after those that it calls.
    """

    def __init__(self, tree: ast.Module, entry: Collection[str]) -> None:
        self._functions = {one.name: one for one in tree.body if isinstance(one, ast.FunctionDef)}
        every = dict(_constants(tree))
        self.routines: dict[str, Routine] = {}
        for name in entry:
            self._add(name, every)
        own = ((one, {*one.variables, *one.parameters}) for one in self.routines.values())
        used = {name for one, names in own for name in one.used - names}
        self.constants = {name: value for name, value in every.items() if name in used}

    @property
    def library(self) -> set[str]:
        """Names of the functions of the mathematical library, and of Python, that are called."""
        return {name for one in self.routines.values() for name in one.calls} - {*self.routines}

    def type_of(self, node: ast.expr, routine: Routine) -> Type:
        """The type of an expression."""
        match node:
            case ast.Constant(value=value):
                return "bool" if isinstance(value, bool) else _type_of_value(value)
            case ast.Name(id=name):
                if name in routine.counters:
                    return "int"
                known = routine.variables | routine.parameters
                return known[name] if name in known else _type_of_value(self._every[name])
            case ast.Call():
                name = called(node)
                routine = self.routines.get(name) or routine
                return (routine.returns or "float") if name in self.routines else "float"
            case ast.BinOp(left=ast.List(), op=ast.Mult()):
                return "vector"
            case ast.BinOp(left=left, right=right):
                types = {self.type_of(left, routine), self.type_of(right, routine)}
                return "float" if "float" in types or isinstance(node.op, ast.Div) else "int"
            case ast.UnaryOp(op=ast.Not()):
                return "bool"
            case ast.UnaryOp(operand=operand):
                return self.type_of(operand, routine)
        return "bool" if isinstance(node, COMPARISONS) else "float"

    def _add(self, name: str, constants: Mapping[str, object]) -> None:
        """Add a function after those that it calls."""
        if name in self.routines or name not in self._functions:
            return
        self._every = constants
        node = self._functions[name]
        returns = ANNOTATIONS.get(ast.unparse(node.returns)) if node.returns else None
        arguments = ((one.arg, one.annotation) for one in node.args.args)
        parameters = {arg: ANNOTATIONS[ast.unparse(kind)] for arg, kind in arguments if kind}
        routine = Routine(node, returns, parameters)
        for inner in sorted(routine.calls):
            self._add(inner, constants)
        for statement in _flat(routine.body):
            self._note(statement, routine)
        self.routines[name] = routine

    def _note(self, statement: ast.stmt, routine: Routine) -> None:
        """The variables that a statement assigns, and the vectors that it changes."""
        match statement:
            case ast.For(target=ast.Name(id=name)):
                if name not in routine.counters:
                    routine.counters.append(name)
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                if name in routine.variables:
                    routine.mutable.add(name)
                else:
                    routine.variables[name] = self.type_of(value, routine)
            case ast.AugAssign(target=ast.Name(id=name)):
                routine.mutable.add(name)
            case ast.Assign(targets=[ast.Subscript(value=ast.Name(id=name))]):
                routine.mutable.add(name)
        for node in _own_nodes(statement):
            if inner := self.routines.get(called(node)):
                assert isinstance(node, ast.Call)
                pairs = zip(inner.parameters, node.args, strict=True)
                changed = (arg for name, arg in pairs if name in inner.changed)
                routine.mutable |= {arg.id for arg in changed if isinstance(arg, ast.Name)}
        routine.changed = routine.mutable & {*routine.parameters}


def _type_of_value(value: object) -> Type:
    return "vector" if isinstance(value, list) else "int" if isinstance(value, int) else "float"


def _constants(tree: ast.Module) -> Iterator[tuple[str, object]]:
    """Constants of a module, several of which one statement may define."""
    for statement in tree.body:
        match statement:
            case ast.Assign(targets=[ast.Tuple(elts=targets)], value=ast.Tuple(elts=values)):
                for target, one in zip(targets, values, strict=True):
                    yield ast.unparse(target), ast.literal_eval(one)
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                if not isinstance(value, ast.Subscript):  # not an alias of a type
                    yield name, ast.literal_eval(value)


def _flat(statements: Iterable[ast.stmt]) -> Iterator[ast.stmt]:
    """Statements, and those inside of loops and conditions, in order."""
    for one in statements:
        yield one
        for part in ("body", "orelse"):
            yield from _flat(getattr(one, part, ()))


def _own_nodes(statement: ast.stmt) -> Iterator[ast.AST]:
    """The nodes of a statement without those of the statements inside."""
    for child in ast.iter_child_nodes(statement):
        if not isinstance(child, ast.stmt):
            yield from ast.walk(child)


class Without(ast.NodeTransformer):
    """Removes everything that depends on absent functions, constants and vectors.

    Parameters and arguments of these names go, statements that call these functions or assign
    these variables, and loops over these constants.
    """

    def __init__(self, tree: ast.Module, absent: Collection[str]) -> None:
        self._absent = {*absent}
        functions = (one for one in tree.body if isinstance(one, ast.FunctionDef))
        self._gone = {
            one.name: {k for k, arg in enumerate(one.args.args) if arg.arg in self._absent}
            for one in functions
        }

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST | None:
        """A function without absent parameters, unless it is absent itself."""
        if node.name in self._absent:
            return None
        node.args.args = [arg for arg in node.args.args if arg.arg not in self._absent]
        return self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """A call without absent arguments."""
        gone = self._gone.get(called(node), set())
        node.args = [arg for k, arg in enumerate(node.args) if k not in gone]
        return self.generic_visit(node)

    def visit_Expr(self, node: ast.Expr) -> ast.AST | None:
        """A call of a function that is there."""
        return None if called(node.value) in self._absent else self.generic_visit(node)

    def visit_Assign(self, node: ast.Assign) -> ast.AST | None:
        """An assignment that needs nothing absent."""
        self.generic_visit(node)
        return None if names_in([node]) & self._absent else node

    def visit_For(self, node: ast.For) -> ast.AST | None:
        """A loop over a range that is there."""
        return None if names_in([node.iter]) & self._absent else self.generic_visit(node)


def operations(program: ExportedProgram, name: str) -> int:
    """The most arithmetic operations, comparisons and library calls in a call of a function.

    Of conditions the longer branch counts; loops must be over ranges.
    """
    known = {key: value for key, value in program.constants.items() if isinstance(value, int)}
    return _operations(program.routines[name].body, program, known)


def _operations(
    statements: Iterable[ast.stmt], program: ExportedProgram, known: Mapping[str, int]
) -> int:
    total = 0
    for one in statements:
        indices = {n for node in _own_nodes(one) for n in _index_nodes(node)}
        for node in _own_nodes(one):
            total += isinstance(node, ast.BinOp | ast.Compare) and node not in indices
            inner = called(node)
            if inner in program.routines:
                total += operations(program, inner)
            elif inner and inner not in ("float", "range"):
                total += 1
        total += isinstance(one, ast.AugAssign)
        match one:
            case ast.For(target=ast.Name(id=counter), iter=ast.Call(args=arguments), body=body):
                limits = [_whole(argument, known) for argument in arguments]
                for value in range(*limits):
                    total += _operations(body, program, {**known, counter: value})
            case ast.If(body=body, orelse=orelse):
                total += max(_operations(part, program, known) for part in (body, orelse))
    return total


def _index_nodes(node: ast.AST) -> Iterator[ast.AST]:
    """The nodes of whole numbers: of indices, and of lengths of vectors."""
    match node:
        case ast.Subscript(slice=part) | ast.BinOp(left=ast.List(), right=part):
            yield from (node, *ast.walk(part)) if isinstance(node, ast.BinOp) else ast.walk(part)


def _whole(node: ast.expr, known: Mapping[str, int]) -> int:
    """The value of an expression of whole numbers."""
    match node:
        case ast.Constant(value=int(value)):
            return value
        case ast.Name(id=name):
            return known[name]
        case ast.BinOp(left=left, op=op, right=right):
            a, b = _whole(left, known), _whole(right, known)
            return (
                a + b if isinstance(op, ast.Add) else a * b if isinstance(op, ast.Mult) else a - b
            )
    raise NotImplementedError(f"no number of {ast.unparse(node)}")


class SubsetBackend(Backend):
    """Functions in the subset of Python that targets translate."""

    suffix = ".py"

    def name(self, name: str) -> str:
        return "y_" if name == "y" else name

    def file(self, contents: Contents) -> str:
        return "\n\n".join(map(self.function, contents.functions))

    def comment(self, text: str) -> str:
        return f"    {text!r}"

    def statement(self, statement: Statement, function: Function) -> Iterator[str]:
        match statement:
            case ValueAssignment(name, text):
                yield f"    {name} = {text}"
            case FactorisationAssignment(name, n, entries):
                yield f"    {name} = [0.0]*{n * n}"
                places = [i * n + j for i in range(n) for j in range(i, n)]
                yield from stores(name, places, entries)
                yield f"    factorise({name}, {n})"
            case SolutionAssignment(name, matrix, right):
                yield f"    {name} = [0.0]*{len(right)}"
                yield from stores(name, range(len(right)), right)
                yield f"    solve({matrix}, {name}, {len(right)})"

    def function(self, function: Function) -> str:
        assigned = self.assignments(function)
        inputs = [
            f"    {self.name(name)} = {argument}[{k}]"
            for argument, names in function.arguments("y").items()
            for k, name in enumerate(names)
            if name in function.lowering.inputs
        ]
        lines = self.body(function, inputs, assigned)
        arguments = ["t: float", "y: Vector"] if function.state else []
        arguments += ["qddot: Vector"] if function.accelerations else []
        arguments += ["params: Vector"]
        returns = "float" if not function.shape else "None"
        if function.shape:
            arguments.append("result: Vector")
            lines += stores("result", range(len(assigned.outputs)), assigned.outputs)
        else:
            lines.append(f"    return {assigned.outputs[0]}")
        about = f"{function.summary}\n\n{function.returns}"
        head = f"def {function.name}({', '.join(arguments)}) -> {returns}:"
        return "\n".join([head, f"    {about!r}", *lines])


def stores(vector: str, places: Iterable[int], texts: Iterable[str]) -> Iterator[str]:
    """Statements that assign elements of a vector."""
    for k, text in zip(places, texts, strict=True):
        yield f"    {vector}[{k}] = {text}"
