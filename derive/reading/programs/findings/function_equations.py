"""Equations in the syntax of formulas, from values of rates and accelerations."""

from collections.abc import Callable

from derive.reading.programs.evaluation.arrays import entries, is_square
from derive.reading.programs.program import EquationKind, Origin, ProgramEquation, UnreadPart
from derive.reading.programs.syntax.formula_text import UnwrittenError, Writer
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
