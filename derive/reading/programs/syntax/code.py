"""Statements of programs, whatever their language."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from derive.reading.programs.syntax.trees import Expression


@dataclass(frozen=True)
class Assignment:
    """A value for a target; with an operator, such as ``+``, the target is changed by it."""

    line: int
    target: Expression
    operator: str
    value: Expression
    is_declaration: bool = False


@dataclass(frozen=True)
class VariableDeclaration:
    """A variable of a function, without a value."""

    line: int
    name: str


@dataclass(frozen=True)
class Return:
    """The end of a function, and its value if it has one."""

    line: int
    value: Expression | None


@dataclass(frozen=True)
class ExpressionStatement:
    """An expression of which the value is dropped, such as a call."""

    line: int
    value: Expression


@dataclass(frozen=True)
class Conditional:
    """A conditional statement; the body is that of two `different` indices if these are known."""

    line: int
    body: tuple[Statement, ...]
    otherwise: tuple[Statement, ...]
    different: tuple[str, str] = ("", "")


@dataclass(frozen=True)
class Loop:
    """A loop; `variable` is empty if it does not count from `bounds[0]` to before `bounds[1]`."""

    line: int
    variable: str
    body: tuple[Statement, ...]
    bounds: tuple[Expression, Expression] | None = None


@dataclass(frozen=True)
class FunctionParameter:
    """A parameter of a function."""

    name: str
    default: Expression | None = None


@dataclass(frozen=True)
class Definition:
    """A function; `owner` is its class, `results` are the variables that it returns by name."""

    line: int
    name: str
    parameters: tuple[FunctionParameter, ...]
    body: tuple[Statement, ...]
    owner: str = ""
    results: tuple[str, ...] = ()


@dataclass(frozen=True)
class Lambda(Expression):
    """A function without a name, as a value."""

    function: Definition = field(compare=False)


@dataclass(frozen=True)
class Fault:
    """A statement that is not understood, and the variables that it may change."""

    line: int
    reason: str
    names: tuple[str, ...] = ()


Statement: TypeAlias = (
    Assignment
    | VariableDeclaration
    | Return
    | ExpressionStatement
    | Conditional
    | Loop
    | Definition
    | Fault
)
