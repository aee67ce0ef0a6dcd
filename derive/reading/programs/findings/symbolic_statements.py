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
    """The statements of a SymPy script; None if it has no equations in functions of time."""
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        return None
    equations = tuple(_Reader().read(tree))
    has_equations = any(one.kind == "implicit" for one in equations)
    return RateFunction("", 1, equations) if has_equations else None


class _Reader:
    """Follows the assignments of a script from the first to the last."""

    def __init__(self) -> None:
        self._coordinates, self._modules = set[str](), set[str]()
        #: Names with other formulas than themselves, such as rates.
        self._values: dict[str, str] = {}

    def read(self, tree: ast.Module) -> Iterator[ProgramEquation]:
        """Yield the definitions and equations."""
        imported = (one for node in tree.body if isinstance(node, ast.Import) for one in node.names)
        self._modules = {one.asname or one.name for one in imported}
        for node in tree.body:
            for call in ast.walk(node):
                if isinstance(call, ast.Call) and _name(call.func) in ("Eq", "Equality"):
                    sides = [self._plain(one) for one in call.args[:2]]
                    text = " = ".join(sides)
                    if all(sides) and len(sides) == 2 and ("_ddot" in text or "ddt(" in text):
                        yield ProgramEquation(call.lineno, "implicit", "", "", text)
            if isinstance(node, ast.Assign) and len(node.targets) == 1:
                yield from self._assigned(node.targets[0], node.value)

    def _assigned(self, target: ast.expr, value: ast.expr) -> Iterator[ProgramEquation]:
        is_row = isinstance(target, ast.Tuple | ast.List)
        names = [_name(one) for one in (target.elts if is_row else [target])]  # type: ignore[attr-defined]
        made = value.func if isinstance(value, ast.Call) else None
        made = made.func if isinstance(made, ast.Call) else made  # Function('x')(t)
        if _name(made) in MOVING:
            self._coordinates.update(names)
        elif _name(made) not in LETTERS:
            values = value.elts if is_row and isinstance(value, ast.Tuple) else [value]
            for name, one in zip(names, values, strict=False):
                text = self._plain(one)
                if not text or text.isidentifier():  # a rate, or another name
                    self._values[name] = text
                elif not text.replace(".", "").isdigit():
                    yield ProgramEquation(one.lineno, "rate", name, "", f"{name} = {text}")

    def _plain(self, node: ast.expr) -> str:
        """A formula without needless brackets; empty if it cannot be read."""
        try:
            return ast.unparse(ast.parse(self._text(node), mode="eval"))
        except _UnreadError:
            return ""

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
            case ast.Call(func=ast.Attribute(value=operand, attr=name), args=arguments) if (
                _name(operand) not in self._modules
            ):
                return self._called(name, operand, arguments)
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
        if name in self._coordinates:  # theta(t)
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
            return text.removesuffix(RATES[order]) + RATES[order + times]
        return "ddt(" * times + text + ")" * times


def _name(node: ast.expr | None) -> str:
    """The name of a function or a letter, with or without its module."""
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ""
