"""A target language: one file in `derive.codegen.backends` with one `Backend`."""

from abc import ABC, abstractmethod
from collections.abc import Iterable
from importlib import import_module
from pkgutil import iter_modules
from typing import ClassVar

from derive.codegen import backends
from derive.codegen.module_functions import Contents, Function
from derive.codegen.operations.assignments import Assignments, LanguageNotation, Statement

#: Place of the digest of all files of a system, by which files that belong together are known.
DIGEST = "@digest@"
#: Names that generated functions use themselves.
RESERVED = ("t", "y", "state", "qddot", "params", "signs", "result")


class Backend(LanguageNotation, ABC):
    """The statements and files of a target language.

    A file in the folder ``derive/codegen/backends`` defines a subclass and ``backend``, its
    instance; nothing is registered.
    """

    #: Ending of the generated files' names, such as ``.py``.
    suffix: ClassVar[str]

    @abstractmethod
    def file(self, contents: Contents) -> str:
        """The text of one file with all contents."""

    def files(self, contents: Contents) -> dict[str, str]:
        """The texts of the generated files of a system, by name."""
        return {f"{contents.system.name}{self.suffix}": self.file(contents)}

    @abstractmethod
    def function(self, function: Function) -> str:
        """The text of a function for one state."""

    @abstractmethod
    def comment(self, text: str) -> str:
        """A comment on a line of its own, in the body of a function."""

    @abstractmethod
    def statement(self, statement: Statement, function: Function) -> Iterable[str]:
        """The lines that compute a named value, in the body of a function."""

    def notation(self, function: Function) -> LanguageNotation:
        """The notation in a function."""
        return self

    def assignments(self, function: Function) -> Assignments:
        """The assignments of a function, in the notation of this language."""
        reserved = {*RESERVED, *function.state, *function.accelerations, *function.parameters}
        return Assignments(function.lowering, reserved, self.notation(function))

    def body(self, function: Function, inputs: Iterable[str], assigned: Assignments) -> list[str]:
        """The lines of a function's body, from the given lines of its inputs to the outputs."""
        lines = [self.comment("inputs"), *inputs]
        blocks = {
            "terms of the parameters alone": assigned.constants,
            "intermediate terms": assigned.terms,
        }
        for title, statements in blocks.items():
            if statements:
                lines.append(self.comment(title))
                for statement in statements:
                    lines += self.statement(statement, function)
        return [*lines, self.comment("outputs")]


def find_backends() -> list[Backend]:
    """The backends of all target languages, found by their files."""
    modules = sorted(module.name for module in iter_modules(backends.__path__))
    return [import_module(f"{backends.__name__}.{name}").backend for name in modules]
