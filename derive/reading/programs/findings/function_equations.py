"""Equations in the syntax of formulas, from values of rates and accelerations; their names."""

import re
from collections.abc import Callable, Iterable

from derive.reading.programs.evaluation.arrays import entries, is_square
from derive.reading.programs.evaluation.calls import VariableValue
from derive.reading.programs.program import EquationKind, Origin, ProgramEquation, UnreadPart
from derive.reading.programs.syntax.formula_text import UnwrittenError, Writer, cleaned
from derive.reading.programs.syntax.trees import (
    Array,
    Expression,
    Item,
    Name,
    NumberLiteral,
    OperatorExpression,
    Result,
)


class FunctionEquations:
    """The equations of one function, and the parts of it that are no formulas."""

    def __init__(self, function: str, named: Callable[[str], str]) -> None:
        self._function, self._named = function, named
        self.equations: list[ProgramEquation] = []
        self.unread: list[UnreadPart] = []
        self._systems: list[tuple[Expression, dict[int, tuple[str, str]]]] = []

    def acceleration(self, line: int, coordinate: str, velocity: str, value: Expression) -> None:
        """Add the equation of an acceleration."""
        solved = _entry_of_solution(value)
        if solved is None:
            name = self._named(coordinate)
            self._add(line, "acceleration", name, velocity, f"{name}_ddot", value)
            return
        system, index = solved
        known = next((rows for one, rows in self._systems if one == system), None)
        if known is None:
            self._systems.append((system, known := {}))
        known[index] = (self._named(coordinate), velocity)

    def rate(self, line: int, variable: str, value: Expression) -> None:
        """Add the equation of a rate, such as that of a momentum."""
        name = self._named(variable)
        self._add(line, "rate", name, "", f"{name}_dot", value)

    def end(self) -> None:
        """Add the rows of linear systems whose solutions are accelerations."""
        for system, unknowns in self._systems:
            matrix, column = system.parts
            values = entries(column)
            if isinstance(matrix, Name) and values is not None:
                matrix = _letters(matrix, len(values))
            count = len(matrix.items) if isinstance(matrix, Array) else 0
            is_known = is_square(matrix) and values is not None and len(values) == count
            if not is_known or values is None or set(unknowns) != {*range(count)}:
                reason = "a linear system for the accelerations is not followed"
                self.unread.append(UnreadPart(system.line, reason, self._function))
                continue
            for row, value in zip(matrix.parts, values, strict=True):
                terms = [
                    OperatorExpression(
                        row.line, "*", (factor, Name(row.line, f"\0{unknowns[i][0]}_ddot"))
                    )
                    for i, factor in enumerate(row.parts)
                    if factor != NumberLiteral(0, "0")
                ]
                left: Expression = terms[0] if terms else NumberLiteral(row.line, "0")
                for term in terms[1:]:
                    left = OperatorExpression(row.line, "+", (left, term))
                self._add(value.line, "implicit", "", "", left, value)

    def _add(
        self,
        line: int,
        kind: EquationKind,
        coordinate: str,
        velocity: str,
        left: Expression | str,
        value: Expression,
    ) -> None:
        writer = Writer(lambda path: path[1:] if path[0] == "\0" else self._named(path))
        try:
            if isinstance(left, str):
                writer.add(left)
            else:
                writer.write(left)
            writer.add(" = ")
            writer.write(value)
        except UnwrittenError as error:
            reason = error.reason if error.line == line else f"line {error.line}: {error.reason}"
            self.unread.append(UnreadPart(line, reason, self._function))
            return
        origins: tuple[Origin, ...] = tuple(writer.origins)
        self.equations.append(
            ProgramEquation(line, kind, coordinate, velocity, writer.text, origins)
        )


def _entry_of_solution(value: Expression) -> tuple[Expression, int] | None:
    match value:
        case Result(value=inner):
            return _entry_of_solution(inner)
        case Item(
            base=OperatorExpression(operator="solve") as system,
            indices=(NumberLiteral(digits=digits),),
        ):
            return system, int(digits)
    return None


def _letters(matrix: Name, count: int) -> Array:
    """A matrix that is not known, as one of letters."""
    line, path, numbers = matrix.line, matrix.path, range(1, count + 1)
    rows = (tuple(Name(line, f"{path}[{i},{j}]") for j in numbers) for i in numbers)
    return Array(line, tuple(Array(line, row) for row in rows))


#: Objects that stand for the program's own values.
OWN = ("self.", "this.")
#: A member of one of several bodies, such as b[0].x.
BODY = re.compile(r"\w+\[(\d+)\]\.(\w+)")
#: An entry of an array of times.
TIMES = re.compile(r"(?:t|time)\[[^\[\]]*\]")


class Names:
    """Identifiers for the variables of a function, different for different variables."""

    def __init__(self, steps: Iterable[VariableValue]) -> None:
        #: Other names of entries, such as theta of ``theta = y[0]``.
        self._others: dict[str, str] = {}
        first: dict[str, Expression] = {}
        for step in steps:
            value = first.setdefault(step.path, step.value)
            if isinstance(value, Name) and "[" in value.path and "[" not in step.path:
                self._others.setdefault(value.path, step.path)
        self.given: dict[str, str] = {"pi": "pi"}

    def define(self, path: str, name: str) -> None:
        """Give a variable a name, such as theta_dot."""
        self.given[path] = name

    def in_program(self, path: str) -> str:
        """The name of a variable in the program."""
        return self._others.get(path, path)

    def __call__(self, path: str) -> str:
        """The name of a variable."""
        if path not in self.given:
            short = self._others.get(path, path)
            for prefix in OWN:
                short = short.removeprefix(prefix)
            last = short.rpartition(".")[2]
            if TIMES.fullmatch(short):
                last = "t"
            if of_body := BODY.fullmatch(short):
                last = f"{of_body[2]}_{of_body[1]}"
            choices = [cleaned(one) for one in (last, short, path)]
            choices += [f"{choices[-1]}_{i}" for i in range(2, 1000)]
            used = set(self.given.values())
            self.given[path] = next(one for one in choices if one not in used)
        return self.given[path]

    @property
    def read(self) -> dict[str, str]:
        """The names of the program and those in the equations."""
        return {path: name for path, name in self.given.items() if path != "pi"}
