"""A target language of exports: one file in `derive.codegen.export.targets` with one `Target`."""

import ast
import re
from abc import ABC, abstractmethod
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from textwrap import wrap
from typing import ClassVar

from derive.codegen.export import targets
from derive.codegen.export.exported_program import ExportedProgram, called
from derive.codegen.module_summary import broken_sum

WIDTH = 96
#: Precedence of operators, from the weakest on.
OR, AND, NOT, COMPARED, SUM, PRODUCT, SIGN, ATOM = range(8)
BINARY: dict[type[ast.AST], tuple[str, int]] = {
    ast.Add: (" + ", SUM), ast.Sub: (" - ", SUM),
    ast.Mult: ("*", PRODUCT), ast.Div: ("/", PRODUCT),
}  # fmt: skip
COMPARED_BY: dict[type[ast.AST], str] = {
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==",
}  # fmt: skip


@dataclass(frozen=True)
class ExportedFile:
    """A program of a system, and the texts of its file."""

    name: str  # of the system
    stem: str  # of the file
    about: str  # the header's text
    program: ExportedProgram
    columns: tuple[str, ...] = ()  # names of the columns of rows of output; none: only functions
    values: tuple[float, ...] = ()  # of the parameters and inputs
    start: tuple[float, ...] = ()  # coordinates and velocities
    angles: tuple[int, ...] = ()  # numbers of the coordinates whose sines are in the state
    event: tuple[int, float] | None = None  # number of a coordinate or velocity, and its value


class Target(ABC):
    """How a language writes programs; by default as C and its relatives do.

    A file in the folder ``derive/codegen/export/targets`` defines a subclass and names it
    ``target``; nothing is registered. Class variables are templates of statements, whose fields
    are in braces.
    """

    title: ClassVar[str]
    #: Ending of files, such as ``.rs``.
    suffix: ClassVar[str]
    #: That of libraries, where it differs.
    library_suffix: ClassVar[str] = ""
    #: How to run a file, as a shell command with {file}; empty if it is a library.
    command: ClassVar[str]
    #: Whether files may be libraries of functions, whether they may have simulations, and whether
    #: these are programs rather than functions.
    has_libraries: ClassVar[bool] = True
    has_simulations: ClassVar[bool] = True
    is_program: ClassVar[bool] = True
    #: Whether a simulation that is no program reports events.
    has_events: ClassVar[bool] = False
    #: Whether a simulation needs equal steps.
    has_fixed_steps: ClassVar[bool] = False
    #: Functions of the simulation that a library has, beside those that they call.
    entry: ClassVar[tuple[str, ...]] = ()
    #: Whether numbers are of single precision.
    is_single: ClassVar[bool] = False
    #: What the language does with floating-point arithmetic, for the header.
    arithmetic: ClassVar[str] = "Arithmetic is that of IEEE 754; nothing is fused or reordered."
    #: Words that no variable may have as its name, beside those of C and Python.
    reserved: ClassVar[str] = ""

    #: The function that prints a row of output, and the text that runs a simulation.
    row: ClassVar[str] = ""
    main: ClassVar[str] = ""

    comment: ClassVar[str] = "// {}"
    indentation: ClassVar[str] = "    "
    types: ClassVar[dict[str, str]] = {"float": "double", "int": "int", "bool": "bool"}
    number: ClassVar[str] = "{}"
    truth: ClassVar[tuple[str, str]] = ("false", "true")
    logic: ClassVar[tuple[str, str, str]] = ("||", "&&", "!")
    variable: ClassVar[str] = "{type} {name} = {value};"
    #: A variable that is assigned once.
    fixed: ClassVar[str] = "const {type} {name} = {value};"
    vector: ClassVar[str] = "double {name}[{size}] = {{0.0}};"
    assignment: ClassVar[str] = "{name} = {value};"
    increment: ClassVar[str] = "{name} += {value};"
    loop: ClassVar[str] = "for (int {name} = {start}; {name} < {stop}; {name}++) {{"
    repeat: ClassVar[str] = "while ({test}) {{"
    condition: ClassVar[str] = "if ({test}) {{"
    another: ClassVar[str] = "}} else if ({test}) {{"
    otherwise: ClassVar[str] = "}} else {{"
    close: ClassVar[str] = "}"
    leave: ClassVar[str] = "break;"
    answer: ClassVar[str] = "return {value};"
    invocation: ClassVar[str] = "{call};"
    #: A statement for a parameter that is not used; empty if none is needed.
    unused: ClassVar[str] = ""
    #: What follows a line that goes on.
    continued: ClassVar[str] = ""
    #: Whether a sum must be broken after its signs.
    breaks_after_operators: ClassVar[bool] = False
    #: Number of the first element of a vector.
    first: ClassVar[int] = 0
    element: ClassVar[str] = "{name}[{index}]"
    #: Conversion of a whole number.
    conversion: ClassVar[str] = "(double){}"
    #: Names of functions where they differ.
    functions: ClassVar[dict[str, str]] = {"abs": "fabs"}
    integer: ClassVar[str] = "static const int {name} = {value};"
    real: ClassVar[str] = "static const double {name} = {value};"
    table: ClassVar[tuple[str, str]] = ("static const double {name}[{size}] = {{", "}};")
    #: What follows the last number of a table.
    last: ClassVar[str] = ""

    def __init__(self, exported: ExportedFile) -> None:
        self.exported, self.program = exported, exported.program
        self.routine = next(iter(self.program.routines.values()))  # the one that is written

    # what a language may replace

    def head(self) -> str:
        """The text between the header and the constants."""
        return ""

    def tail(self) -> str:
        """The text after the functions."""
        return self.main.format(**self._names) if self.exported.columns else ""

    @property
    def _names(self) -> dict[str, str]:
        """Names for the templates of texts."""
        file, heading = self.exported.stem + self.suffix, ",".join(self.exported.columns)
        return {
            "name": self.exported.name,
            "stem": self.exported.stem,
            "file": file,
            "heading": heading,
        }

    @abstractmethod
    def signature(self) -> str:
        """The first line of the function."""

    def declarations(self) -> Iterator[str]:
        """Lines before the statements of the function."""
        for name in self.routine.parameters:
            if name not in self.routine.used and self.unused:
                yield self.unused.format(name=self.name(name))

    def documentation(self) -> Iterator[str]:
        """Comments before the first line of the function."""
        return self.remarks(self.routine.doc)

    def closing(self, part: str) -> str:
        """The last line of a ``loop``, ``condition`` or ``function``."""
        return self.close

    def product(self, text: str) -> str:
        """A product that is a part of a sum."""
        return text

    def argument(self, text: str, name: str, *, changes: bool) -> str:
        """A vector that a function takes, and perhaps changes."""
        return text

    def invoked(self, call: ast.Call, target: str = "") -> str:
        """A call of a function of the program, whose result `target` receives."""
        if target:
            return self.assignment.format(name=target, value=self.text(call))
        return self.invocation.format(call=self.text(call))

    def returned(self, value: str) -> Iterator[str]:
        """The statements that return a value."""
        yield self.answer.format(value=value)

    # expressions

    def name(self, name: str) -> str:
        """A name, changed where the language reserves it or a constant has it."""
        is_hiding = name in self.routine.variables and name in self.program.constants
        return f"{name}_" if is_hiding or name in self._words() else name

    @classmethod
    @cache
    def _words(cls) -> frozenset[str]:
        return frozenset(f"{RESERVED} {cls.reserved}".split())

    def literal(self, value: object) -> str:
        """A number, or a truth value."""
        if isinstance(value, bool):
            return self.truth[value]
        return self.number.format(repr(value)) if isinstance(value, float) else repr(value)

    def text(self, node: ast.expr, outer: int = 0) -> str:
        """The text of an expression, in brackets where an operator of rank `outer` needs them."""
        text, rank = self._expression(node)
        return f"({text})" if rank < outer else text

    def _expression(self, node: ast.expr) -> tuple[str, int]:
        """The text of an expression, and the rank of its operator."""
        match node:
            case ast.Constant(value=value):
                return self.literal(value), ATOM
            case ast.Name(id=name):
                return self.name(name), ATOM
            case ast.Subscript(value=ast.Name(id=name), slice=index):
                text = self.element.format(name=self.name(name), index=self._index(index))
                return text, ATOM
            case ast.BinOp(left=left, op=op, right=right):
                sign, rank = BINARY[type(op)]
                # two signs do not follow each other in every language
                strict = ATOM if isinstance(right, ast.UnaryOp) else rank + 1
                parts = [self.text(left, rank), self.text(right, strict)]
                if rank == SUM:
                    pairs = zip(parts, (left, right), strict=True)
                    parts = [self._term(text, part) for text, part in pairs]
                return sign.join(parts), rank
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return f"-{self.text(operand, ATOM)}", SIGN
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                return f"{self.logic[2]}({self.text(operand)})", NOT
            case ast.BoolOp(op=op, values=values):
                rank = AND if isinstance(op, ast.And) else OR
                return f" {self.logic[rank]} ".join(self.text(one, NOT) for one in values), rank
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                sign = COMPARED_BY[type(op)]
                return f"{self.text(left, SUM)} {sign} {self.text(right, SUM)}", COMPARED
            case ast.Call(args=arguments):
                return self._call(called(node), arguments), ATOM
        raise NotImplementedError(f"no text of {ast.unparse(node)}")

    def _term(self, text: str, node: ast.expr) -> str:
        """The text of a term of a sum."""
        is_product = isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult)
        is_float = is_product and self.program.type_of(node, self.routine) == "float"
        return self.product(text) if is_float else text

    def _index(self, index: ast.expr) -> str:
        """The number of an element, counted as the language does."""
        if not self.first:
            return self.text(index)
        if isinstance(index, ast.Constant) and isinstance(index.value, int):
            return str(index.value + self.first)
        return f"{self.text(index)} + {self.first}"

    def _call(self, name: str, arguments: Sequence[ast.expr]) -> str:
        """A call of a function of the program or of the mathematical library."""
        if name == "float":
            return self.conversion.format(self.text(arguments[0], ATOM))
        texts = [self.text(one) for one in arguments]
        inner = self.program.routines.get(name)
        if inner and name not in self.functions:
            for k, (parameter, kind) in enumerate(inner.parameters.items()):
                if kind == "vector":
                    one, changes = arguments[k], parameter in inner.changed
                    assert isinstance(one, ast.Name)
                    texts[k] = self.argument(texts[k], one.id, changes=changes)
        else:
            name = self.functions.get(name, name)
            if "{" in name:
                return name.format(*texts)
        return f"{name}({', '.join(texts)})"

    # statements

    def file(self) -> str:
        """The text of the file."""
        parts = [self.header(), self.head(), "\n".join(self.constants())]
        if self.exported.columns:
            parts.append(self.row.format())
        for routine in self.program.routines.values():
            if routine.name != "print_row" and routine.name not in self.functions:
                self.routine = routine
                parts.append("\n".join(self.function()))
        parts.append(self.tail())
        return "\n\n".join(part.strip("\n") for part in parts if part.strip()) + "\n"

    def header(self) -> str:
        """The comment at the start of the file."""
        about = f"{self.exported.about}\n\n{self.arithmetic}"
        if self.exported.columns:
            about += f"\n\nRun it with:\n\n    {self.command.format(**self._names)}"
        return "\n".join(self.remarks(about.splitlines()))

    def remarks(self, lines: Iterable[str]) -> Iterator[str]:
        """Comments on lines of their own."""
        return (self.comment.format(line).rstrip() for line in lines)

    def constants(self) -> Iterator[str]:
        """The definitions of constants."""
        for name, value in self.program.constants.items():
            if isinstance(value, list):
                start, end = (part.format(name=name, size=len(value)) for part in self.table)
                numbers = wrap(", ".join(map(self.literal, value)) + self.last, WIDTH - 4)
                lines = (f"{self.indentation}{line}" for line in numbers)
                yield self.continuing([start, *lines, end])
            else:
                template = self.integer if isinstance(value, int) else self.real
                yield template.format(name=name, value=self.literal(value))

    def function(self) -> Iterator[str]:
        """The lines of the function."""
        yield from self.documentation()
        yield from self._broken_signature()
        yield from (f"{self.indentation}{line}" for line in self.declarations())
        yield from self.block(self.routine.body, 1, {*self.routine.parameters})
        yield self.closing("function")

    def block(
        self, statements: Sequence[ast.stmt], depth: int, defined: Collection[str]
    ) -> Iterator[str]:
        """The lines of statements; some variables are `defined` before."""
        pad, known = self.indentation * depth, {*defined}
        for statement in statements:
            match statement:
                case ast.For(target=ast.Name(id=name), iter=ast.Call(args=[*start, stop])):
                    first, last = self.text(start[0]) if start else "0", self.text(stop)
                    yield pad + self.loop.format(name=self.name(name), start=first, stop=last)
                    yield from self.block(statement.body, depth + 1, known)
                    yield pad + self.closing("loop")
                case ast.While(test=test, body=body):
                    yield self.line(pad, self.repeat.format(test=self.text(test)))
                    yield from self.block(body, depth + 1, known)
                    yield pad + self.closing("loop")
                case ast.If():
                    yield from self._condition(statement, self.condition, depth, known)
                    yield pad + self.closing("condition")
                case ast.Expr(value=ast.Constant(value=str(remark))):
                    yield pad + self.comment.format(remark)
                case _:
                    yield from (self.line(pad, text) for text in self.simple(statement, known))

    def _condition(
        self, statement: ast.If, template: str, depth: int, known: set[str]
    ) -> Iterator[str]:
        pad = self.indentation * depth
        yield self.line(pad, template.format(test=self.text(statement.test)))
        yield from self.block(statement.body, depth + 1, known)
        match statement.orelse:
            case [ast.If() as other]:
                yield from self._condition(other, self.another, depth, known)
            case [_, *_]:
                yield pad + self.otherwise.format()
                yield from self.block(statement.orelse, depth + 1, known)

    def simple(self, statement: ast.stmt, known: set[str]) -> Iterator[str]:
        """The texts of a statement without others inside; `known` variables are defined."""
        match statement:
            case ast.Assign(targets=[ast.Name(id=name)], value=value) if name not in known:
                known.add(name)
                yield self.definition(name, value)
            case ast.Assign(targets=[target], value=value):
                yield self._assigned(self.text(target), value)
            case ast.AugAssign(target=target, value=value):
                added = self._term(self.text(value), value)
                yield self.increment.format(name=self.text(target), value=added)
            case ast.Expr(value=ast.Call() as call):
                yield self.invoked(call)
            case ast.Break():
                yield self.leave
            case ast.Return(value=ast.expr() as value):
                yield from self.returned(self.text(value))
            case _:
                raise NotImplementedError(f"no text of {ast.unparse(statement)}")

    def definition(self, name: str, value: ast.expr) -> str:
        """The definition of a variable."""
        kind, is_fixed = self.routine.variables[name], name not in self.routine.mutable
        if kind == "vector":
            assert isinstance(value, ast.BinOp)
            return self.vector.format(name=self.name(name), size=self.text(value.right))
        template = self.fixed if is_fixed else self.variable
        return template.format(type=self.types[kind], name=self.name(name), value=self.text(value))

    def _assigned(self, target: str, value: ast.expr) -> str:
        if isinstance(value, ast.Call) and called(value) in self.program.routines:
            return self.invoked(value, target)
        return self.assignment.format(name=target, value=self.text(value))

    def line(self, pad: str, text: str) -> str:
        """A statement on one line, or on several if it is long."""
        if len(pad) + len(text) <= WIDTH:
            return pad + text
        lines = broken_sum(text, WIDTH - len(pad) - 4).splitlines()
        if self.breaks_after_operators:
            for k, line in enumerate(lines[1:], 1):
                if line[:2] in ("+ ", "- "):
                    lines[k - 1], lines[k] = f"{lines[k - 1]} {line[0]}", line[2:]
        first, *others = (f"{pad}{'    ' * (k > 0)}{line}" for k, line in enumerate(lines))
        return self.continuing([first, *others])

    def _broken_signature(self) -> Iterator[str]:
        """The first line of the function, broken after commas if it is long."""
        text, length = self.signature(), len(self.indentation)
        kept = re.sub(r"(?<!,) ", "\0", text)  # where it is not broken
        lines = wrap(kept, WIDTH - length, break_on_hyphens=False) if len(text) > WIDTH else [text]
        lines = [line.replace("\0", " ") for line in lines]
        yield self.continuing([lines[0], *(f"{self.indentation * 2}{line}" for line in lines[1:])])

    def continuing(self, lines: Sequence[str]) -> str:
        """Lines of one statement."""
        return f"{self.continued}\n".join(lines)


#: Words that C, Python or several targets reserve.
RESERVED = """
    auto break case char const continue default do double else enum extern float for goto if inline
    int long register return short signed sizeof static struct switch typedef union unsigned void
    volatile while and as assert async await class def del elif except finally from global import in
    is lambda nonlocal not or pass raise try with yield None True False true false null
    function var let new this package public private type end
"""


def find_targets() -> dict[str, type[Target]]:
    """The targets by name, found by their files."""
    found = sorted(module.name for module in iter_modules(targets.__path__))
    return {name: import_module(f"{targets.__name__}.{name}").target for name in found}
