"""Names of a program as names in its equations."""

import re
from collections.abc import Iterable

from derive.reading.programs.evaluation.calls import VariableValue
from derive.reading.programs.syntax.formula_text import cleaned
from derive.reading.programs.syntax.trees import Expression, Name

#: Objects that stand for the program's own values.
OWN = ("self.", "this.")
#: A member of one of several bodies, such as b[0].x.
BODY = re.compile(r"\w+\[(\d+)\]\.(\w+)")


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
