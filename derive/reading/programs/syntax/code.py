"""Statements of programs, whatever their language."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from derive.reading.programs.syntax.trees import Tree


@dataclass(frozen=True)
class Assignment:
    """A value for a target; with an operator, such as ``+``, the target is changed by it."""

    line: int
    target: Tree
    operator: str
    value: Tree
    is_declaration: bool = False


@dataclass(frozen=True)
class Declaration:
    """A variable of a function, without a value."""

    line: int
    name: str


@dataclass(frozen=True)
class Return:
    """The end of a function, and its value if it has one."""

    line: int
    value: Tree | None


@dataclass(frozen=True)
class Evaluation:
    """An expression of which the value is dropped, such as a call."""

    line: int
    value: Tree


@dataclass(frozen=True)
class Branch:
    """A conditional statement."""

    line: int
    body: tuple[Statement, ...]
    otherwise: tuple[Statement, ...]


@dataclass(frozen=True)
class Loop:
    """A loop; `variable` is empty if it does not count."""

    line: int
    variable: str
    body: tuple[Statement, ...]


@dataclass(frozen=True)
class Parameter:
    """A parameter of a function."""

    name: str
    default: Tree | None = None


@dataclass(frozen=True)
class Definition:
    """A function; `owner` is its class, `results` are the variables that it returns by name."""

    line: int
    name: str
    parameters: tuple[Parameter, ...]
    body: tuple[Statement, ...]
    owner: str = ""
    results: tuple[str, ...] = ()


@dataclass(frozen=True)
class Lambda(Tree):
    """A function without a name, as a value."""

    function: Definition = field(compare=False)


@dataclass(frozen=True)
class Fault:
    """A statement that is not understood, and the variables that it may change."""

    line: int
    reason: str
    names: tuple[str, ...] = ()


Statement: TypeAlias = (
    Assignment | Declaration | Return | Evaluation | Branch | Loop | Definition | Fault
)
