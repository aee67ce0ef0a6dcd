"""Fortran 2008: one module, and a program that runs the simulation."""

import ast
from collections.abc import Iterator

from derive.codegen.export.target import Target

ROW = """\
! Print a row of output, with all digits.
subroutine print_row(t, values)
    real(dp), intent(in) :: t, values(0:*)
    integer :: n
    write (*, "(es25.16e3, *(:, ',', es25.16e3))") t, (values(n), n = 0, COLUMNS - 1)
end subroutine
"""

MAIN = """\
program main
    use {name}_motion
    implicit none
    print "(a)", "{heading}"
    if (.not. simulate()) stop 3
end program
"""


class Fortran(Target):
    """Procedures of a module, with vectors that count from 0."""

    title, suffix = "Fortran", ".f90"
    row, main = ROW, MAIN
    command = "gfortran -O2 -ffp-contract=off {file} -o {stem} && ./{stem}"
    arithmetic = "Compile with -ffp-contract=off, or products and sums are fused on some machines."
    comment = "! {}"
    types = {"float": "real(dp)", "int": "integer", "bool": "logical"}
    number, truth = "{}_dp", (".false.", ".true.")
    logic = (".or.", ".and.", ".not. ")
    variable = fixed = assignment = "{name} = {value}"
    increment = "{name} = {name} + {value}"
    vector = "{name} = 0.0_dp"
    loop = "do {name} = {start}, {stop} - 1"
    repeat, condition = "do while ({test})", "if ({test}) then"
    another, otherwise = "else if ({test}) then", "else"
    leave, invocation, continued = "exit", "call {call}", " &"
    element, conversion = "{name}({index})", "real({}, dp)"
    functions = {"floor": "real(floor({}, int64), dp)", "pow": "({}**{})"}
    integer = "integer, parameter :: {name} = {value}"
    real = "real(dp), parameter :: {name} = {value}"
    table = "real(dp), parameter :: {name}(0:*) = [", "]"

    def name(self, name: str) -> str:
        # capital letters do not distinguish names
        own = [*self.routine.parameters, *self.routine.variables, *self.routine.counters]
        names = [*self.program.constants, *own]
        twins = [one for one in names if one.lower() == name.lower()]
        return f"{name}_{twins.index(name)}" if name in twins[1:] else name

    def head(self) -> str:
        return (
            f"module {self.exported.name}_motion\n    use, intrinsic :: iso_fortran_env, only: "
            "dp => real64, int64\n    implicit none"
        )

    def constants(self) -> Iterator[str]:
        yield from super().constants()
        yield "\ncontains"

    def signature(self) -> str:
        arguments = ", ".join(map(self.name, self.routine.parameters))
        if self.routine.returns:
            return f"function {self.routine.name}({arguments}) result(answer)"
        return f"subroutine {self.routine.name}({arguments})"

    def closing(self, part: str) -> str:
        procedure = "function" if self.routine.returns else "subroutine"
        return f"end {({'loop': 'do', 'condition': 'if', 'function': procedure})[part]}"

    def declarations(self) -> Iterator[str]:
        routine = self.routine
        for name, kind in routine.parameters.items():
            intent = "inout" if name in routine.changed else "in"
            is_vector, text = kind == "vector", self.name(name)
            type_ = "real(dp)" if is_vector else self.types[kind]
            yield f"{type_}, intent({intent}) :: {text}{'(0:*)' * is_vector}"
        sizes = {
            statement.targets[0].id: self.text(statement.value.right)
            for statement in ast.walk(routine.node)
            if isinstance(statement, ast.Assign)
            and isinstance(statement.targets[0], ast.Name)
            and isinstance(statement.value, ast.BinOp)
            and isinstance(statement.value.left, ast.List)
        }
        for name, kind in routine.variables.items():
            text = self.name(name)
            if name in sizes:
                yield f"real(dp) :: {text}(0:{sizes[name]} - 1)"
            else:
                yield f"{self.types[kind]} :: {text}"
        if routine.counters:
            yield f"integer :: {', '.join(map(self.name, routine.counters))}"
        if routine.returns:
            yield f"{self.types[routine.returns]} :: answer"

    def returned(self, value: str) -> Iterator[str]:
        yield f"answer = {value}"
        yield "return"

    def tail(self) -> str:
        return f"end module {self.exported.name}_motion\n\n{super().tail()}"


target = Fortran
