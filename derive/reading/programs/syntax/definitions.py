"""From the syntax tree of a grammar to functions."""

from collections import deque
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from derive.reading.programs.syntax.code import (
    Assignment,
    Conditional,
    Definition,
    ExpressionStatement,
    FunctionParameter,
    Lambda,
    Return,
    Statement,
)
from derive.reading.programs.syntax.expressions import ExpressionTranslator, line, text
from derive.reading.programs.syntax.trees import Expression, Name

if TYPE_CHECKING:
    from tree_sitter import Node

#: Roles of nodes that are no statements of a body.
HEADERS = ("header", "parameters", "results", "skip", "otherwise")
#: Roles of parameters that are taken apart.
PATTERNS = ("array", "names")


class DefinitionTranslator(ExpressionTranslator):
    """Translates functions, with a name or without one."""

    _owner = ""

    def statements(self, nodes: Sequence["Node"]) -> tuple[Statement, ...]:
        """The statements at nodes."""
        raise NotImplementedError

    def _function_statements(self, node: "Node") -> Iterator[Statement]:
        header = next((one for one in self.children(node) if self.role(one) == "header"), node)
        parameters = self._first(node, "parameters") or self._first(header, "arguments")
        named = header.child_by_field_name("name") or self._first(header, "name")
        declared = header.child_by_field_name("declarator") or header
        operator = declared.child_by_field_name("declarator")  # operator() of C++
        if operator and operator.type == "operator_name":
            named = operator
        yield self._definition(node, self.word(named) if named else "", parameters)

    def _owner_of(self, node: "Node") -> str:
        """The class of a method that is defined outside it, such as P of ``P::step``."""
        header = node.child_by_field_name("declarator")
        named = header.child_by_field_name("declarator") if header else None
        namespace = named.child_by_field_name("scope") if named else None
        return text(namespace) if namespace else self._owner

    def _function_tree(self, node: "Node") -> Expression:
        """A function as a value, such as one that another returns."""
        header = next((one for one in self.children(node) if self.role(one) == "header"), node)
        return Lambda(line(node), self._definition(node, "", self._first(header, "arguments")))

    def _lambda_tree(self, node: "Node") -> Expression:
        parameters = node.child_by_field_name("parameter") or self._first(node, "parameters")
        parameters = parameters or self.children(node)[0]
        return Lambda(line(node), self._definition(node, "", parameters))

    def _definition(self, node: "Node", name: str, given: "Node | None") -> Definition:
        body = node.child_by_field_name("body")
        blocks = [one for one in self.children(node) if one.type == "block"]
        nodes = [body] if body else blocks or self._body(node)
        if self.role(node) == "lambda" and len(nodes) > 1:
            nodes = nodes[-1:]  # the parameter of a short function stands before its body
        first = [one for one in self.children(node) if self.role(one) == "initializers"]
        statements = self.statements([*first, *nodes])
        if self.language.returns_last or self.role(nodes[0] if nodes else node) != "block":
            statements = _with_return(statements)
        result = self._first(node, "results")
        results = tuple(self.word(one) for one in self._names(result)) if result else ()
        if node.type == "function" and not results:
            results = (name,)  # of Fortran
        parameters = tuple(self._parameters(given)) if given else ()
        if given:
            statements = (*self._unpacked(given), *statements)
        owner = self._owner_of(node) if name else self._owner
        return Definition(line(node), name, parameters, statements, owner, results)

    def _parameters(self, node: "Node") -> Iterator[FunctionParameter]:
        if self.role(node) == "name":
            yield FunctionParameter(self.word(node))
            return
        for index, child in enumerate(self._given(node)):
            if self.role(child) in PATTERNS:
                yield FunctionParameter(_place(index))
                continue
            name = child if self.role(child) == "name" else self._first(child, "name")
            default = next(
                filter(None, map(child.child_by_field_name, ("value", "right", "default_value"))),
                None,
            )
            value = self.tree(default) if default else None
            yield FunctionParameter(self.word(name) if name else _place(index), value)

    def _given(self, node: "Node") -> list["Node"]:
        """The parameters in a list of them, also those without a name."""
        return [one for one in self.children(node) if not one.type.endswith("_separator")]

    def _unpacked(self, node: "Node") -> Iterator[Statement]:
        """Assignments to the names of a parameter that is an array or a record."""
        for index, child in enumerate(self._given(node)):
            if self.role(child) in PATTERNS:
                value = Name(line(child), _place(index))
                yield from self.assigned(line(child), self.tree(child), "", value)

    def assigned(
        self, number: int, target: Expression, operator: str, value: Expression
    ) -> Iterator[Statement]:
        """The statements that give a target, or several, a value."""
        raise NotImplementedError

    def _names(self, node: "Node") -> Iterator["Node"]:
        for child in self.children(node):
            if self.role(child) == "name":
                yield child
            else:
                yield from self._names(child)

    def _body(self, node: "Node") -> list["Node"]:
        fields = [node.child_by_field_name(name) for name in ("condition", "name")]
        return [n for n in self.children(node) if self.role(n) not in HEADERS and n not in fields]

    def _first(self, node: "Node", role: str) -> "Node | None":
        """The first node of a role within a node, the nearest levels first."""
        nodes = deque(self.children(node))
        for _ in range(200):
            if not nodes:
                break
            one = nodes.popleft()
            if self.role(one) == role:
                return one
            if self.role(one) not in ("skip", "block"):
                nodes.extend(self.children(one))
        return None


def _with_return(statements: tuple[Statement, ...]) -> tuple[Statement, ...]:
    """The statements of a function whose value is its last expression."""
    match statements:
        case (*rest, ExpressionStatement(line=number, value=value)):
            return (*rest, Return(number, value))
        case (*_, Assignment(line=number, target=Name() as target, operator="")):
            return (*statements, Return(number, target))
        case (*rest, Conditional(number, body, otherwise, different)):
            arms = _with_return(body), _with_return(otherwise)
            return (*rest, Conditional(number, *arms, different))
    return statements


def _place(index: int) -> str:
    """A name for a parameter without one, which no program can use."""
    return f"parameter {index + 1}"
