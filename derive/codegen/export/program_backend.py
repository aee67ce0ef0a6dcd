"""Functions in the subset of Python that targets translate."""

from collections.abc import Iterable, Iterator

from derive.codegen.backend import Backend
from derive.codegen.module_functions import Contents, Function
from derive.codegen.operations.assignments import (
    FactorisationAssignment,
    SolutionAssignment,
    Statement,
    ValueAssignment,
)


class SubsetBackend(Backend):
    """Functions in the subset of Python that targets translate."""

    suffix = ".py"

    def name(self, name: str) -> str:
        return "y_" if name == "y" else name

    def file(self, contents: Contents) -> str:
        return "\n\n".join(map(self.function, contents.functions))

    def comment(self, text: str) -> str:
        return f"    {text!r}"

    def statement(self, statement: Statement, function: Function) -> Iterator[str]:
        match statement:
            case ValueAssignment(name, text):
                yield f"    {name} = {text}"
            case FactorisationAssignment(name, n, entries):
                yield f"    {name} = [0.0]*{n * n}"
                places = [i * n + j for i in range(n) for j in range(i, n)]
                yield from stores(name, places, entries)
                yield f"    factorise({name}, {n})"
            case SolutionAssignment(name, matrix, right):
                yield f"    {name} = [0.0]*{len(right)}"
                yield from stores(name, range(len(right)), right)
                yield f"    solve({matrix}, {name}, {len(right)})"

    def function(self, function: Function) -> str:
        assigned = self.assignments(function)
        inputs = [
            f"    {self.name(name)} = {argument}[{k}]"
            for argument, names in function.arguments("y").items()
            for k, name in enumerate(names)
            if name in function.lowering.inputs
        ]
        lines = self.body(function, inputs, assigned)
        arguments = ["t: float", "y: Vector"] if function.state else []
        arguments += ["qddot: Vector"] if function.accelerations else []
        arguments += ["params: Vector"]
        returns = "float" if not function.shape else "None"
        if function.shape:
            arguments.append("result: Vector")
            lines += stores("result", range(len(assigned.outputs)), assigned.outputs)
        else:
            lines.append(f"    return {assigned.outputs[0]}")
        about = f"{function.summary}\n\n{function.returns}"
        head = f"def {function.name}({', '.join(arguments)}) -> {returns}:"
        return "\n".join([head, f"    {about!r}", *lines])


def stores(vector: str, places: Iterable[int], texts: Iterable[str]) -> Iterator[str]:
    """Statements that assign elements of a vector."""
    for k, text in zip(places, texts, strict=True):
        yield f"    {vector}[{k}] = {text}"
