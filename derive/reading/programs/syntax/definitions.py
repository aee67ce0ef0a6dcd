"""From the syntax tree of a grammar to functions."""

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import replace
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
    _receiver = ""

    def statements(self, nodes: Sequence["Node"]) -> tuple[Statement, ...]:
        """The statements at nodes."""
        raise NotImplementedError

    def _name_tree(self, node: "Node") -> Expression:
        word = self.word(node)
        return Name(line(node), "self" if word == self._receiver else word)

    def _function_statements(self, node: "Node") -> Iterator[Statement]:
        if text(node).endswith(";") and not node.child_by_field_name("body"):
            return  # of an interface
        header = next((one for one in self.children(node) if self.role(one) == "header"), node)
        parameters = node.child_by_field_name("parameters") or self._first(node, "parameters")
        parameters = parameters or self._first(header, "arguments")
        named = header.child_by_field_name("name") or self._first(header, "name")
        declared = header.child_by_field_name("declarator") or header
        operator = declared.child_by_field_name("declarator")  # operator() of C++
        if operator and operator.type == "operator_name":
            named = operator
        name = self.word(named) if named else ""
        if node.type == "constructor_declaration":
            name = "constructor"
        receiver = node.child_by_field_name("receiver")  # of Go
        own = self._first(receiver, "name") if receiver else None
        outer, self._receiver = self._receiver, text(own) if own else self._receiver
        yield self._definition(node, name, parameters)
        self._receiver = outer

    def _owner_of(self, node: "Node") -> str:
        """The class of a method that is defined outside it, such as P of ``P::step``."""
        if receiver := node.child_by_field_name("receiver"):
            return text(receiver).strip("( )").rpartition(" ")[2].lstrip("*").partition("[")[0]
        header = node.child_by_field_name("declarator")
        named = header.child_by_field_name("declarator") if header else None
        namespace = named.child_by_field_name("scope") if named else None
        return text(namespace) if namespace else self._owner

    def _function_tree(self, node: "Node") -> Expression:
        """A function as a value, such as one that another returns."""
        header = next((one for one in self.children(node) if self.role(one) == "header"), node)
        return Lambda(line(node), self._definition(node, "", self._first(header, "arguments")))

    def _lambda_tree(self, node: "Node") -> Expression:
        parameters = node.child_by_field_name("parameter")
        parameters = parameters or node.child_by_field_name("parameters")
        parameters = parameters or self._first(node, "parameters") or self.children(node)[0]
        return Lambda(line(node), self._definition(node, "", parameters))

    def _definition(self, node: "Node", name: str, given: "Node | None") -> Definition:
        body = node.child_by_field_name("body")
        blocks = [one for one in self.children(node) if one.type == "block"]
        nodes = [body] if body else blocks or self._body(node)
        if self.role(node) == "lambda" and len(nodes) > 1:
            nodes = nodes[-1:]  # the parameter of a short function stands before its body
        first = [one for one in self.children(node) if self.role(one) == "initializers"]
        parameters = tuple(self._parameters(given)) if given else ()
        outer = self._hiding
        if self.language.has_bare_members:
            own = {one.name for one in parameters}
            self._hiding = outer | own | {*self._declared_in(nodes)}
        statements = self.statements([*first, *nodes])
        self._hiding = outer
        result = self._first(node, "results")
        results = tuple(self.word(one) for one in self._names(result)) if result else ()
        declared = node.child_by_field_name("result")  # of Go
        if declared and self.role(declared) == "parameters":
            given_names = (one.children_by_field_name("name") for one in self.children(declared))
            results = tuple(
                self.word(one) for names in given_names for one in names if one.is_named
            )
        if node.type == "function" and not results:
            results = (name,)  # of Fortran
        is_short = self.role(nodes[0] if nodes else node) != "block"
        ends_with_value = self.language.returns_last and not any(map(self._ends, nodes[-1:]))
        if not results and (is_short or ends_with_value):
            statements = _with_return(statements)
        if given:
            statements = (*self._unpacked(given), *statements)
        owner = self._owner_of(node) if name else self._owner
        return Definition(line(node), name, parameters, statements, owner, results)

    def _declared_in(self, nodes: Sequence["Node"]) -> Iterator[str]:
        """The variables that are declared at nodes or within them."""
        waiting = [*nodes]
        while waiting:
            node = waiting.pop()
            waiting += self.children(node)
            if self.role(node) == "declaration":
                names = map(self._name_in, self.children(node))
                yield from (self.word(one) for one in names if one)

    def _name_in(self, node: "Node") -> "Node | None":
        return node if self.role(node) == "name" else self._first(node, "name")

    def _ends(self, node: "Node") -> bool:
        """Whether a block ends with a statement that has no value, as those of Rust with ``;``."""
        inner = self.children(node) if self.role(node) == "block" else []
        return bool(inner) and text(inner[-1]).endswith(";")

    def _parameters(self, node: "Node") -> Iterator[FunctionParameter]:
        if self.role(node) == "name":
            yield FunctionParameter(self.word(node))
            return
        for index, child in enumerate(self._given(node)):
            if self.role(self._pattern(child)) in PATTERNS:
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
        given = [one for one in self.children(node) if not one.type.endswith("_separator")]
        return [name for one in given for name in self._several(one) or [one]]

    def _several(self, node: "Node") -> list["Node"]:
        """The names of one type, as in ``x, v float64`` of Go; none for a single one."""
        names = [one for one in node.children_by_field_name("name") if one.is_named]
        return names if len(names) > 1 else []

    def _pattern(self, node: "Node") -> "Node":
        """The names of a parameter, without its type."""
        inner = node.child_by_field_name("pattern") or node
        return self.children(inner)[-1] if inner.type == "reference_pattern" else inner

    def _unpacked(self, node: "Node") -> Iterator[Statement]:
        """Assignments to the names of a parameter that is an array or a record."""
        for index, child in enumerate(self._given(node)):
            if self.role(pattern := self._pattern(child)) in PATTERNS:
                value = Name(line(child), _place(index))
                yield from self.declared(self.assigned(line(child), self.tree(pattern), "", value))

    def declared(self, given: Iterator[Statement]) -> Iterator[Statement]:
        """Statements whose variables belong to the function."""
        for one in given:
            yield replace(one, is_declaration=True) if isinstance(one, Assignment) else one

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
