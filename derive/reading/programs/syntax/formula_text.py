"""Expressions of programs in the syntax of `derive.formulas.expression`."""

import re
from collections.abc import Callable
from unicodedata import name as unicode_name
from unicodedata import normalize

from derive.reading.programs.program import Origin
from derive.reading.programs.syntax.trees import (
    MAX_DEPTH,
    MAX_SIZE,
    Choice,
    Expression,
    FunctionCall,
    Item,
    Name,
    NumberLiteral,
    Opaque,
    OperatorExpression,
    Result,
)

FUNCTIONS = ("sin", "cos", "tan", "exp", "log", "sqrt")
PRECEDENCE = {"+": 1, "-": 1, "*": 2, "/": 2, "**": 4}
ATOM = 5


class UnwrittenError(ValueError):
    """A part of an expression is no formula."""

    def __init__(self, line: int, reason: str) -> None:
        super().__init__(reason)
        self.line, self.reason = line, reason


class Writer:
    """Writes an expression, and notes the lines that its parts come from."""

    def __init__(self, named: Callable[[str], str]) -> None:
        self._named = named
        self._text: list[str] = []
        self._length = 0
        self.origins: list[Origin] = []

    def add(self, text: str) -> None:
        """Append characters."""
        self._text.append(text)
        self._length += len(text)

    @property
    def text(self) -> str:
        """All characters."""
        return "".join(self._text)

    def write(
        self, tree: Expression, line: int = 0, level: int = 0, *, is_first: bool = True
    ) -> None:
        """Append an expression that stands within one of a precedence and a line.

        The first factor of the first term is negative without brackets.
        """
        if tree.size > MAX_SIZE or tree.depth > MAX_DEPTH:
            raise UnwrittenError(tree.line, "the formula is too large")
        has_brackets = precedence(tree) < level and not (is_first and is_negative(tree))
        if has_brackets:
            self.add("(")
        start = self._length
        self._write(tree, is_first=is_first or has_brackets)
        if tree.line != line:
            self.origins.append(Origin(start, self._length, tree.line))
        if has_brackets:
            self.add(")")

    def _write(self, tree: Expression, *, is_first: bool) -> None:
        match tree:
            case NumberLiteral(digits=digits):
                self.add(digits)
            case Name(path=path):
                self.add(self._named(path))
            case OperatorExpression(line=line, operator="-", operands=(operand,)):
                self.add("-")
                self.write(operand, line, 2, is_first=False)
            case OperatorExpression(line=line, operator=operator, operands=(left, right)) if (
                own := PRECEDENCE.get(operator, 0)
            ):
                is_power = operator == "**"
                if own == 1 and (positive := without_sign(right)) is not None:
                    operator, right = "-" if operator == "+" else "+", positive
                self.write(left, line, own + is_power, is_first=is_first and not is_power)
                self.add(f" {operator} " if own == 1 else operator)
                self.write(right, line, 3 if is_power else own + 1, is_first=False)
            case FunctionCall(line=line, function=Name(path=name), arguments=(argument,)) if (
                name in FUNCTIONS
            ):
                self.add(f"{name}(")
                self.write(argument, line)
                self.add(")")
            case Result(line=line, value=value):
                self.write(value, line, is_first=is_first)
            case _:
                raise UnwrittenError(tree.line, reason(tree))


def without_sign(tree: Expression) -> Expression | None:
    """A product without the sign that it begins with; None if there is none."""
    match tree:
        case OperatorExpression(operator="-", operands=(operand,)):
            return operand
        case OperatorExpression(line=line, operator="*" | "/" as operator, operands=(left, right)):
            positive = without_sign(left)
            return (
                None if positive is None else OperatorExpression(line, operator, (positive, right))
            )
        case Result(line=line, call=call, value=value):
            positive = without_sign(value)
            return None if positive is None else Result(line, call, positive)
    return None


def is_negative(tree: Expression) -> bool:
    """Whether an expression begins with a sign."""
    return isinstance(tree, OperatorExpression) and tree.operator == "-" and len(tree.operands) == 1


def precedence(tree: Expression) -> int:
    """How strongly the parts of an expression hold together."""
    match tree:
        case OperatorExpression(operator="-", operands=(_,)):
            return 1
        case OperatorExpression(operator=operator):
            return PRECEDENCE.get(operator, ATOM)
        case Result(value=value):
            return precedence(value)
    return ATOM


def reason(tree: Expression) -> str:
    """Why an expression is no formula."""
    match tree:
        case Opaque(reason=text):
            return text
        case Choice():
            return "a conditional statement changes the value"
        case FunctionCall(function=Name(path=path)):
            return f"the function {path} is not followed"
        case FunctionCall():
            return "a call is not followed"
        case Item(base=OperatorExpression(operator="solve")):
            return "the solution of a linear system stands within a formula"
    return "a value that is no number stands within a formula"


def plain(tree: Expression) -> str:
    """An index, as written; `UnwrittenError` for others."""
    writer = Writer(lambda path: path)
    writer.write(tree)
    return writer.text.replace(" ", "")


def cleaned(path: str) -> str:
    """A name of a program as an identifier, such as theta_1 of ``θ₁``."""
    letters = [_spelled(letter) for letter in normalize("NFKD", path)]
    return re.sub(r"\W+", "_", "".join(letters)).strip("_") or "x"


def _spelled(letter: str) -> str:
    if letter.isascii():
        return letter
    words = unicode_name(letter, "").split()
    if "GREEK" in words and "LETTER" in words:
        return words[-1].lower() if "SMALL" in words else words[-1].title()
    if words[:1] == ["GREEK"]:  # variants, such as the second phi
        return words[1].lower()
    return {"COMBINING DOT ABOVE": "_dot", "COMBINING DIAERESIS": "_ddot"}.get(
        " ".join(words), "" if "COMBINING" in words else letter
    )
