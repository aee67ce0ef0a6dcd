"""From the syntax tree of a grammar to statements."""

import re
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

from derive.reading.programs.languages.language import Language
from derive.reading.programs.syntax.code import (
    Assignment,
    Conditional,
    Definition,
    ExpressionStatement,
    Fault,
    FunctionParameter,
    Lambda,
    Loop,
    Return,
    Statement,
    VariableDeclaration,
)
from derive.reading.programs.syntax.definitions import DefinitionTranslator
from derive.reading.programs.syntax.expressions import DIGITS, line, shown, text
from derive.reading.programs.syntax.trees import (
    Array,
    Expression,
    FunctionCall,
    Item,
    Member,
    Name,
    NumberLiteral,
    Record,
)

if TYPE_CHECKING:
    from tree_sitter import Node

#: What ends a round of a loop, and the statement that stands for it.
JUMPS = {"continue", "cycle", "CYCLE"}
JUMP = ExpressionStatement(0, Name(0, "continue"))
#: A condition that two indices are equal or different.
INDICES = re.compile(
    r"\(?\s*(\w+)\s*([!=~/]==?|≠|==|\.(?:ne|eq)\.|is not)\s*(\w+)\s*\)?", re.IGNORECASE
)
UNEQUAL, MAX_CONDITION = ("!=", "!==", "~=", "/=", "≠", ".ne.", ".NE.", "is not"), 100
#: Functions of VPython that build a body with the members that they are given.
SHAPES = frozenset("sphere box cylinder cone ellipsoid ring simple_sphere".split())
#: Levels of blocks in blocks.
MAX_BLOCKS = 60
#: Variables that a text assigns, and characters of the text in which they are searched.
ASSIGNED = re.compile(
    r"([^\W\d][\w.]{0,50})(?:\[[^\]]{0,30}\]|\([^)]{0,30}\))?\s{0,9}[-+*/^]?=(?!=)"
)
MAX_FAULT = 5_000
#: Roles of several variables of a loop.
SEVERAL = ("array", "values")
#: The number of columns in the type of a matrix, such as Matrix2d.
COLUMNS = re.compile(r"Matrix(\d)[df]?\Z")


class StatementTranslator(DefinitionTranslator):
    """Translates statements."""

    _blocks = 0

    def __init__(self, language: Language) -> None:
        super().__init__(language)
        #: Columns of matrices by their declarations.
        self._columns: dict[str, int] = {}

    def statements(self, nodes: Sequence["Node"]) -> tuple[Statement, ...]:
        """The statements at nodes, with those of blocks among them in one row."""
        result: list[Statement] = []
        for number, node in enumerate(nodes):
            own = [*self._statement(node)]
            result += own
            match own:
                case [Conditional() as last] if (JUMP in last.body) != (JUMP in last.otherwise):
                    # if (i == j) continue: what follows is for the others
                    rest = self.statements(nodes[number + 1 :])
                    body, others = (
                        () if JUMP in arm else rest for arm in (last.body, last.otherwise)
                    )
                    result[-1] = Conditional(last.line, body, others, last.different)
                    break
        return tuple(result)

    def _statement(self, node: "Node") -> Iterator[Statement]:
        role = self.role(node)
        if node.end_byte - node.start_byte < 12 and text(node).strip(" ;") in JUMPS:
            yield JUMP
            return
        if role == "skip":
            return
        method: Callable[[Node], Iterator[Statement]] | None
        method = getattr(self, f"_{role}_statements", None)
        if self._blocks > MAX_BLOCKS:
            yield _fault(node, "the blocks are nested too deeply")
        elif node.has_error and (method is None or role in ("assign", "update", "return", "")):
            yield _fault(node, f"{shown(node)!r} is not understood")
        elif method is None:
            yield ExpressionStatement(line(node), self.tree(node))
        else:
            self._blocks += 1
            yield from method(node)
            self._blocks -= 1

    def _block_statements(self, node: "Node") -> Iterator[Statement]:
        yield from self.statements(self.children(node))

    def _list_statements(self, node: "Node") -> Iterator[Statement]:
        """Statements with commas between them, or the entries of a matrix: ``M << a, b, c, d``."""
        first, *rest = self._listed(node)
        signs = [text(one) for one in first.children if not one.is_named]
        if self.role(first) != "binary" or signs != ["<<"]:
            yield from self.statements([first, *rest])
            return
        target, entry = self.children(first)
        entries = [self.tree(one) for one in (entry, *rest)]
        n = self._columns.get(text(target), 0)
        starts = range(0, len(entries), n) if n else ()
        rows = [Array(line(node), tuple(entries[i : i + n])) for i in starts]
        array = Array(line(node), tuple(rows or entries))
        value = array if rows else FunctionCall(array.line, Name(array.line, "vcat"), (array,))
        yield Assignment(line(node), self.tree(target), "", value)

    def _listed(self, node: "Node") -> list["Node"]:
        if self.role(node) != "list":
            return [node]
        return [one for child in self.children(node) for one in self._listed(child)]

    def _declaration_statements(self, node: "Node") -> Iterator[Statement]:
        kind = node.child_by_field_name("type")
        if kind and (columns := COLUMNS.search(text(kind))):
            names = filter(None, map(self._name_in, self.children(node)[1:]))
            self._columns |= {text(name): int(columns[1]) for name in names}
        for child in self.children(node):
            if self.role(child) == "declaration":
                yield from self._declaration_statements(child)
            elif self._is_assigned(child):
                yield from self.declared(self._statement(child))
            elif self.role(child) != "skip" and (name := self._name_in(child)):
                for one in self._several(child) or [name]:
                    yield VariableDeclaration(line(child), self.word(one))

    def _local_statements(self, node: "Node") -> Iterator[Statement]:
        """A declaration with a value, such as ``x := 1`` of Go and ``let x = 1`` of Rust."""
        name = node.child_by_field_name("pattern")
        if name and not node.child_by_field_name("value"):
            yield VariableDeclaration(line(node), self.word(name))
        else:
            yield from self.declared(self._assign_statements(node))

    def _is_assigned(self, node: "Node") -> bool:
        is_name = node.child_by_field_name("name") and not node.child_by_field_name("value")
        return self.role(node) == "assign" and len(self.children(node)) > 1 and not is_name

    def _class_statements(self, node: "Node") -> Iterator[Statement]:
        name = node.child_by_field_name("name") or node.child_by_field_name("type")
        word = self.word(name).partition("<")[0] if name else "?"
        outer, self._owner = self._owner, word
        body = node.child_by_field_name("body")
        if body:
            yield from self._statement(body)
        self._owner = outer

    def _field_statements(self, node: "Node") -> Iterator[Statement]:
        """Members of a class with their values; of C++, several in one statement."""
        name = None
        for index, child in enumerate(node.children):
            match node.field_name_for_child(index):
                case "property" | "declarator" | "name":
                    name = self._name_in(child)
                case "value" | "default_value" if name:
                    target: Expression = Name(line(child), self.word(name))
                    if not self.language.has_bare_members:
                        target = Member(target.line, Name(target.line, "this"), self.word(name))
                    yield from self.assigned(line(child), target, "", self.tree(child))

    def _assign_statements(self, node: "Node") -> Iterator[Statement]:
        children = [one for one in self.children(node) if self.role(one) != "skip"]
        left, right = children[0], children[-1]
        if left == right:
            return
        signs = [text(one) for one in node.children if one not in (left, right)]
        operator = next((one[:-1].strip(".:") for one in signs if one.endswith("=")), "")
        is_initialized = self.role(right) == "array" and self.role(left) == "name" and not signs
        if self.role(right) == "arguments" or is_initialized:  # x(1) and x{1} of C++
            values = self.children(right)
            array = Array(line(right), self._trees(values))
            value = self.tree(values[0]) if len(values) == 1 else array
            yield from self.assigned(line(node), self.tree(left), operator, value)
            return
        if self.role(right) == "assign":  # a = b = 1
            yield from self._statement(right)
            right = next(one for one in self.children(right) if self.role(one) != "skip")
        if self.role(right) == "block" and len(self.children(right)) > 1:
            *before, right = self.children(right)
            yield from self.statements(before)
        target = self.tree(left)
        if names := self._several(node):  # of Go
            target = Array(line(node), self._trees(names))
        if text(left).startswith("(;") and isinstance(target, Array):  # members by their names
            members = [(one.path, one) for one in target.items if isinstance(one, Name)]
            target = Record(target.line, tuple(members))
        yield from self.assigned(line(node), target, operator, self.tree(right))

    def assigned(
        self, number: int, target: Expression, operator: str, value: Expression
    ) -> Iterator[Statement]:
        """The statements that give a target, or several, a value."""
        match target, value:
            case Name(path=name) | Member(name=name), Lambda(function=one):
                yield Definition(one.line, name, one.parameters, one.body, self._owner)
            case FunctionCall(function=Name(path=name), arguments=given), _ if self._is_function(
                value
            ):
                parameters = tuple(FunctionParameter(p.path) for p in given if isinstance(p, Name))
                yield Definition(number, name, parameters, (Return(number, value),))
            case FunctionCall(line=at, function=base, arguments=indices), _:
                yield Assignment(number, Item(at, base, indices), operator, value)
            case _, Record(fields=fields):
                yield from self._members(number, target, fields)
            case Name(), FunctionCall(function=Name(path=name), arguments=()) if name in SHAPES:
                yield from self._members(number, target, _of_body(value))
            case Record(fields=fields), _:
                for name, to in fields:
                    yield Assignment(number, to, "", Member(number, value, name), True)
            case _:
                yield Assignment(number, target, operator, value)

    def _is_function(self, value: Expression) -> bool:
        """Whether ``f(x) = value`` defines a function, not an entry of an array."""
        language = self.language
        return not (language.has_round_indices or language.has_numbered_entries)

    def _members(
        self, number: int, target: Expression, fields: tuple[tuple[str, Expression], ...]
    ) -> Iterator[Statement]:
        for name, value in fields:
            yield from self.assigned(number, Member(number, target, name), "", value)

    def _update_statements(self, node: "Node") -> Iterator[Statement]:
        operator = "+" if "++" in text(node) else "-"
        target = self.tree(self.children(node)[0])
        yield Assignment(line(node), target, operator, NumberLiteral(line(node), "1"))

    def _macro_statements(self, node: "Node") -> Iterator[Statement]:
        name, *value = self.children(node)
        if value and DIGITS.fullmatch(text(value[0]).strip("() ")):
            number = NumberLiteral(line(node), text(value[0]).strip("() "))
            yield Assignment(line(node), Name(line(node), self.word(name)), "", number)

    def _initializers_statements(self, node: "Node") -> Iterator[Statement]:
        """Members with their values, before the body of a constructor."""
        for one in self.children(node):
            name, *rest = self.children(one)
            values = [value for part in rest for value in self.children(part)]
            if len(values) == 1:
                yield Assignment(line(one), self.tree(name), "", self.tree(values[0]))

    def _keyword_statements(self, node: "Node") -> Iterator[Statement]:
        if text(node).lower() == "return":
            yield Return(line(node), None)

    def _return_statements(self, node: "Node") -> Iterator[Statement]:
        values = [self.tree(one) for one in self.children(node)]
        value = Array(line(node), tuple(values)) if len(values) > 1 else None
        yield Return(line(node), values[0] if len(values) == 1 else value)

    def _branch_statements(self, node: "Node") -> Iterator[Statement]:
        before, other = map(node.child_by_field_name, ("initializer", "alternative"))
        if before:  # of Go
            yield from self._statement(before)
        condition, *rest = [one for one in self.children(node) if one != before]
        if other and self.role(other) != "otherwise":  # without a clause of its own
            body = self.statements([one for one in rest if one != other])
            others = self.statements([other])
        else:
            body = self.statements([one for one in rest if self.role(one) != "otherwise"])
            others = self._otherwise([one for one in rest if self.role(one) == "otherwise"])
        if indices := INDICES.fullmatch(text(condition)[:MAX_CONDITION]):
            first, relation, second = indices.groups()
            arms = (body, others) if relation in UNEQUAL else (others, body)
            yield Conditional(line(node), *arms, (first, second))
        else:
            yield Conditional(line(node), body, others)

    def _otherwise(self, nodes: list["Node"]) -> tuple[Statement, ...]:
        if not nodes:
            return ()
        first, *rest = nodes
        children = self.children(first)
        if first.type.startswith(("elif", "elseif")):
            body = self.statements(children[1:])
            return (Conditional(line(first), body, self._otherwise(rest)),)
        return self.statements(children)

    def _choice_statements(self, node: "Node") -> Iterator[Statement]:
        yield _fault(node, "a choice between cases is not followed")

    def _loop_statements(self, node: "Node") -> Iterator[Statement]:
        body = node.child_by_field_name("body")
        blocks = [one for one in self.children(node) if one.type == "block"]
        nodes = [body] if body else blocks or self._body(node)
        headers = [one for one in self.children(node) if self.role(one) == "header"]
        headers = headers or [one for one in self.children(node) if one not in nodes][:1] or [node]
        statements = self.statements(nodes)
        for header in reversed(headers):  # several in one line of Julia
            counted = header.child_by_field_name("left") or header
            name = self._name_in(counted) if header != node else None
            is_while = "while" in text(node)[:10].lower() or self.role(header) == "binary"
            variable = "" if is_while or name is None else self.word(name)
            bounds = self.bounds(node, header) if variable else None
            if len(names := self.children(counted)) > 1 and self.role(counted) in SEVERAL:
                given = header.child_by_field_name("right")
                if header.type == "range_clause" and given:  # i, value := range array, of Go
                    entry = Item(line(given), self.tree(given), (Name(line(given), variable),))
                    first = Assignment(entry.line, self.tree(names[1]), "", entry, True)
                    statements = (first, *statements)
                else:
                    variable, bounds = "", None
            statements = (Loop(line(node), variable, statements, bounds),)
        yield from statements


def _of_body(call: FunctionCall) -> tuple[tuple[str, Expression], ...]:
    """The members of a body of VPython, which stands at the origin by default."""
    origin = Array(call.line, (NumberLiteral(call.line, "0"),) * 3)
    return tuple(({"pos": origin} | dict(call.keywords)).items())


def _fault(node: "Node", reason: str) -> Fault:
    names = dict.fromkeys(ASSIGNED.findall(text(node)[:MAX_FAULT]))
    return Fault(line(node), reason, tuple(names))
