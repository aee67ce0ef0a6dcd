"""What a program computes: equations, constants, the method of integration and its faults."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

#: An equation gives an acceleration, the rate of a variable, or a row of M q̈ = f.
EquationKind: TypeAlias = Literal["acceleration", "rate", "implicit"]

FindingKind: TypeAlias = Literal[
    "explicit_euler",
    "semi_implicit_euler",
    "mixed_update",
    "leapfrog",
    "verlet",
    "runge_kutta",
    "library",
    "frame_step",
    "lost_step",
    "damping",
    "degrees",
]


class ProgramError(ValueError):
    """A program cannot be read; the message gives the reason and the way out."""


@dataclass(frozen=True)
class Origin:
    """The line of the program that a part of an equation comes from."""

    start: int  # of the part, in the text of the equation
    end: int
    line: int


@dataclass(frozen=True)
class ProgramEquation:
    """An equation of motion, in the syntax of `derive.formulas.expression`.

    The rate of the coordinate theta is written theta_dot, its acceleration theta_ddot,
    whatever the program calls its velocity.
    """

    line: int  # of the statement that gives the acceleration or the rate
    kind: EquationKind
    coordinate: str  # as in the text; empty in a row of M q̈ = f
    velocity: str  # in the program's words, such as "self.a1_v" or "y[1]"; empty for a rate
    text: str  # such as "theta_ddot = -g/l*sin(theta)"
    origins: tuple[Origin, ...] = ()


@dataclass(frozen=True)
class RateFunction:
    """A function, or a loop in it, that computes rates or changes coordinates step by step."""

    name: str  # empty for the statements outside all functions
    line: int
    equations: tuple[ProgramEquation, ...]
    #: Names of the program, such as "y[1]" or "self.m1", and those of the equations.
    names: Mapping[str, str] = field(default_factory=dict)
    #: The equations with the names of constants that follow from others, as I of I = m*l**2/3.
    short: tuple[ProgramEquation, ...] = field(default=(), repr=False)


@dataclass(frozen=True)
class NumericConstant:
    """A name with one numeric value in the whole program."""

    name: str  # in the program, such as "self.m1"
    value: str  # in the syntax of formulas, such as "pi/2"
    line: int


@dataclass(frozen=True)
class Finding:
    """A remark on the method of integration, which is a fault where it cannot be meant."""

    line: int
    kind: FindingKind
    function: str
    text: str
    is_fault: bool = False


@dataclass(frozen=True)
class UnreadPart:
    """A part that cannot be followed, and why."""

    line: int
    reason: str
    function: str = ""


@dataclass(frozen=True)
class Program:
    """A program as far as it can be followed."""

    file: str
    language: str
    functions: tuple[RateFunction, ...]
    constants: tuple[NumericConstant, ...]
    findings: tuple[Finding, ...]
    unread: tuple[UnreadPart, ...]

    @property
    def equations(self) -> tuple[ProgramEquation, ...]:
        """The equations of all functions."""
        return tuple(equation for one in self.functions for equation in one.equations)
