"""What a SymPy script states: positions, energies, and equations ``Eq(left, right)``.

The script is read, never run. Coordinates are the functions of time; what `diff` gives is written
as rates of names.
"""

import ast
from collections.abc import Iterator

from derive.reading.programs.program import ProgramEquation, RateFunction

#: Functions of formulas by their names in SymPy, and such as change nothing.
FUNCTIONS = {"sin", "cos", "tan", "exp", "log", "sqrt", "Abs", "sinh", "cosh", "tanh"}
UNCHANGED = {"simplify", "expand", "factor", "trigsimp", "together", "cancel", "S", "sympify"}
#: Calls that make functions of time, and letters.
MOVING, LETTERS = {"Function", "dynamicsymbols"}, {"symbols", "Symbol", "var"}
#: Endings of rates, and the most derivatives by time.
RATES, MAX_RATES = ("", "_dot", "_ddot"), 4
OPERATORS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**"}


class _UnreadError(Exception):
    """A part that states nothing in formulas."""


def symbolic_statements(text: str) -> RateFunction | None:
    """The statements of a SymPy script; None if it has no functions of time or no statements."""
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        return None
    reader = _Reader()
    equations = tuple(reader.read(tree))
    has_statements = reader.coordinates and any(one.kind == "implicit" for one in equations)
    return RateFunction("", 1, equations) if has_statements else None


class _Reader:
    """Follows the assignments of a script from the first to the last."""

    def __init__(self) -> None:
        self.coordinates: set[str] = set()
        #: Names with other formulas than themselves, such as rates.
        self._values: dict[str, str] = {}
        self._modules: set[str] = set()

    def read(self, tree: ast.Module) -> Iterator[ProgramEquation]:
        """Yield the definitions and equations."""
        imported = (one for node in tree.body if isinstance(node, ast.Import) for one in node.names)
        self._modules = {one.asname or one.name for one in imported}
        for node in tree.body:
            for call in ast.walk(node):
                if isinstance(call, ast.Call) and _name(call.func) in ("Eq", "Equality"):
                    yield from self._equation(call)
            if isinstance(node, ast.Assign) and len(node.targets) == 1:
                yield from self._assigned(node.targets[0], node.value)

    def _equation(self, call: ast.Call) -> Iterator[ProgramEquation]:
        try:
            left, right = (_plain(self._text(one)) for one in call.args[:2])
        except (_UnreadError, ValueError):
            return
        if "_ddot" in left + right or "ddt(" in left + right:
            yield ProgramEquation(call.lineno, "implicit", "", "", f"{left} = {right}")

    def _assigned(self, target: ast.expr, value: ast.expr) -> Iterator[ProgramEquation]:
        names = [one.id for one in _items(target) if isinstance(one, ast.Name)]
        made = value.func if isinstance(value, ast.Call) else None
        inner = made.func if isinstance(made, ast.Call) else made  # Function('x')(t)
        if _name(inner) in MOVING:
            self.coordinates.update(names)
        elif _name(inner) not in LETTERS:
            values = [*_items(value)] if isinstance(target, ast.Tuple) else [value]
            for name, one in zip(names, values, strict=False):
                yield from self._defined(name, one)

    def _defined(self, name: str, value: ast.expr) -> Iterator[ProgramEquation]:
        try:
            text = _plain(self._text(value))
        except _UnreadError:
            self._values[name] = ""
            return
        if text.isidentifier():  # a rate, or another name
            self._values[name] = text
        elif not text.replace(".", "").isdigit():
            yield ProgramEquation(value.lineno, "rate", name, "", f"{name} = {text}")

    def _text(self, node: ast.expr) -> str:
        match node:
            case ast.Constant(value=int() | float() as number):
                return str(number)
            case ast.Name(id="pi") | ast.Attribute(attr="pi"):
                return "pi"
            case ast.Name(id=name) if self._values.get(name, name):
                return self._values.get(name, name)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return f"(-{self._text(operand)})"
            case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
                return f"({self._text(left)} {OPERATORS[type(op)]} {self._text(right)})"
            case ast.Call(func=ast.Attribute(value=operand, attr="diff"), args=variables) if (
                _name(operand) not in self._modules
            ):
                return self._derivative(operand, variables)
            case ast.Call(func=ast.Attribute(value=operand, attr="simplify" | "expand")):
                return self._text(operand)
            case ast.Call(func=function, args=[first, *rest]):
                return self._called(_name(function), first, rest)
        raise _UnreadError

    def _called(self, name: str, first: ast.expr, rest: list[ast.expr]) -> str:
        if name in ("diff", "Derivative"):
            return self._derivative(first, rest)
        if name == "Rational" and len(rest) == 1:
            return f"({self._text(first)}/{self._text(rest[0])})"
        if name in UNCHANGED:
            return self._text(first)
        if name in FUNCTIONS and not rest:
            return f"{name}({self._text(first)})"
        if name in self.coordinates:  # theta(t)
            return name
        raise _UnreadError

    def _derivative(self, operand: ast.expr, variables: list[ast.expr]) -> str:
        text, times = self._text(operand), 0
        for one in variables:
            match one:
                case ast.Constant(value=int() as count) if times:  # diff(x, t, 2)
                    times += count - 1
                case ast.Tuple(elts=[_, ast.Constant(value=int() as count)]):
                    times += count
                case ast.Name(id="t"):
                    times += 1
                case _:
                    text = f"diff({text}, {self._text(one)})"
        if not 0 <= times <= MAX_RATES:
            raise _UnreadError
        order = next(k for k in (2, 1, 0) if text.endswith(RATES[k]))
        if text.isidentifier() and order + times < len(RATES):
            return text.removesuffix(RATES[order]) + RATES[order + times] if times else text
        for _ in range(times):
            text = f"ddt({text})"
        return text


def _plain(text: str) -> str:
    """A formula without needless brackets."""
    return ast.unparse(ast.parse(text, mode="eval"))


def _items(node: ast.expr) -> list[ast.expr]:
    return list(node.elts) if isinstance(node, ast.Tuple | ast.List) else [node]


def _name(node: ast.expr | None) -> str:
    """The name of a function, with or without its module."""
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ""
