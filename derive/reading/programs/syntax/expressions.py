"""From the syntax tree of a grammar to expressions.

Each method translates the nodes of one role; the tables in `languages` give the role of each type
of node. Types without a role are values that cannot be followed.
"""

import re
from collections.abc import Iterator, Sequence
from functools import reduce
from typing import TYPE_CHECKING

from derive.reading.programs.languages.language import Language
from derive.reading.programs.syntax.trees import (
    MAX_DEPTH,
    Array,
    Choice,
    Comprehension,
    Expression,
    FunctionCall,
    Item,
    Member,
    Name,
    NumberLiteral,
    Opaque,
    OperatorExpression,
    Record,
    Slice,
    TextLiteral,
)

if TYPE_CHECKING:
    from tree_sitter import Node

#: Digits with the suffixes of all languages, such as 9.81f, 1d0 and 2.0_dp.
DIGITS = re.compile(
    r"(\d[\d_]*\.?\d*|\.\d+)(?:[eEdD]([+-]?\d+))?(?:_\w+|[fiu](?:8|16|32|64|size)|[fFlLuUdD]*)"
)
#: Powers of powers in a row.
MAX_POWERS = 20
OPERATORS = {"^": "**", "\\": "solve", "×": "*", "÷": "/", "//": "//", "dot": "@"}


class ExpressionTranslator:
    """Translates expressions."""

    def __init__(self, language: Language) -> None:
        self.language = language
        self._depth = 0
        #: Variables of the function with the names of members, if these are written alone.
        self._hiding: set[str] = set()

    def tree(self, node: "Node") -> Expression:
        """The expression at a node."""
        if self._depth > MAX_DEPTH:
            return Opaque(line(node), "the expression is nested too deeply")
        method = getattr(self, f"_{self.role(node)}_tree", None)
        if method is None or (node.has_error and not node.child_count):
            return Opaque(line(node), f"{shown(node)!r} is not followed")
        self._depth += 1
        try:
            return method(node)
        finally:
            self._depth -= 1

    def role(self, node: "Node") -> str:
        """The role of a node; empty if it has none."""
        return self.language.roles.get(node.type, "")

    def children(self, node: "Node") -> list["Node"]:
        """The named children that are no comments."""
        return [one for one in node.named_children if not one.is_extra and one.type != "comment"]

    def _trees(self, nodes: Sequence["Node"]) -> tuple[Expression, ...]:
        return tuple(map(self.tree, nodes))

    def _name_tree(self, node: "Node") -> Expression:
        return Name(line(node), self.word(node))

    def word(self, node: "Node") -> str:
        """The text of a name."""
        word = text(node)
        return word if self.language.is_case_sensitive else word.lower()

    def _number_tree(self, node: "Node") -> Expression:
        if text(node).startswith("-"):
            return OperatorExpression(line(node), "-", (self._digits(node, text(node)[1:]),))
        return self._digits(node, text(node))

    def _digits(self, node: "Node", given: str) -> Expression:
        if not (match := DIGITS.fullmatch(given)):
            return Opaque(line(node), f"{shown(node)!r} is not followed")
        digits, exponent = match[1].replace("_", ""), match[2]
        return NumberLiteral(line(node), digits + (f"e{exponent}" if exponent else ""))

    def _text_tree(self, node: "Node") -> Expression:
        return TextLiteral(line(node), text(node).strip("\"'`"))

    def _wrapper_tree(self, node: "Node") -> Expression:
        # a bracket, or a cast, whose value stands last
        inner = [one for one in self.children(node) if self.role(one) != "skip"]
        return self.tree(inner[-1]) if inner else Opaque(line(node), "an empty bracket")

    def _block_tree(self, node: "Node") -> Expression:
        """The value of a macro of an expression, or of a block with one expression."""
        inner = [one for one in self.children(node) if self.role(one) != "skip"]
        if len(inner) != 1:
            return Opaque(line(node), f"{shown(node)!r} is not followed")
        return self.tree(inner[0])

    def _first_tree(self, node: "Node") -> Expression:
        return self.tree(self.children(node)[0])

    def _qualified_tree(self, node: "Node") -> Expression:
        return self.tree(self.children(node)[-1])

    def _associated_tree(self, node: "Node") -> Expression:
        """A name in a module, or a function of a type, such as ``Pendulum::new``."""
        *path, name = self.children(node)
        owner = text(path[-1]).rpartition("::")[2] if path else ""
        if owner[:1].isupper() and node.parent and node.parent.type == "call_expression":
            return Member(line(node), Name(line(node), owner), self.word(name))
        return self.tree(name)

    def _member_tree(self, node: "Node") -> Expression:
        base, *_, name = self.children(node)
        if self.language.has_bare_members and text(base) == "this":
            if self.word(name) in self._hiding:
                return Opaque(line(node), f"{text(name)} is a member and a variable")
            return self.tree(name)
        if text(name).isdigit():  # of a tuple of Rust
            return Item(line(node), self.tree(base), (self.tree(name),))
        return Member(line(node), self.tree(base), self.word(name))

    def _item_tree(self, node: "Node") -> Expression:
        base, *indices = self.children(node)
        if len(indices) == 1 and self.role(indices[0]) in ("arguments", "indices", "array"):
            indices = self.children(indices[0])
        result = self._trees(indices)
        if len(result) == 1 and isinstance(result[0], TextLiteral):
            return Member(line(node), self.tree(base), result[0].value)
        return Item(line(node), self.tree(base), result)

    def _slice_tree(self, node: "Node") -> Expression:
        bounds: list[Expression | None] = [None]
        for child in node.children:
            if child.type in (":", "..", "..="):
                bounds.append(None)
            elif child.is_named and child.type not in ("end_keyword", "spread_operator"):
                bounds[-1] = self.tree(child)
        if len(bounds) > 2:
            return Opaque(line(node), "a range with a step is not followed")
        upper = bounds[-1]
        if upper and any(child.type == "..=" for child in node.children):
            upper = OperatorExpression(line(node), "+", (upper, NumberLiteral(line(node), "1")))
        return Slice(line(node), bounds[0], upper)

    def _part_tree(self, node: "Node") -> Expression:
        """A range of entries of Go."""
        base, lower, upper = map(node.child_by_field_name, ("operand", "start", "end"))
        bounds = (self.tree(one) if one else None for one in (lower, upper))
        whole = self.tree(base or node.children[0])
        return Item(line(node), whole, (Slice(line(node), *bounds),))

    def _all_tree(self, node: "Node") -> Expression:
        return Slice(line(node), None, None)

    def _call_tree(self, node: "Node") -> Expression:
        function, *rest = [one for one in self.children(node) if self.role(one) != "skip"]
        nodes = [one for part in rest for one in self._arguments(part)]
        if any(one.type == "for_clause" for one in nodes):
            array = self._comprehension(node, nodes)
            return FunctionCall(line(node), self.tree(function), (array,))
        if function.type == "operator" and text(function) == "-" and len(nodes) == 1:  # of Julia
            return OperatorExpression(line(node), "-", (self.tree(nodes[0]),))
        keywords = [one for one in nodes if self.role(one) == "keyword"]
        arguments = [one for one in nodes if self.role(one) != "keyword"]
        named = tuple((self.word(k), self.tree(v)) for k, v in map(self._pair, keywords))
        return FunctionCall(line(node), self.tree(function), self._trees(arguments), named)

    def _invocation_tree(self, node: "Node") -> Expression:
        """A call of a method or a constructor of Java."""
        named = node.child_by_field_name("name") or node.child_by_field_name("type")
        base, given = map(node.child_by_field_name, ("object", "arguments"))
        word = text(named).partition("<")[0].rpartition(".")[2] if named else ""
        function: Expression = Name(line(node), word)
        if base:
            function = Member(line(node), self.tree(base), word)
        return FunctionCall(
            line(node), function, self._trees(self.children(given) if given else ())
        )

    def _arguments(self, node: "Node") -> list["Node"]:
        return self.children(node) if self.role(node) == "arguments" else [node]

    def _pair(self, node: "Node") -> tuple["Node", "Node"]:
        children = self.children(node)
        return children[0], children[-1]

    def _binary_tree(self, node: "Node") -> Expression:
        left, sign, right = [one for one in node.children if not one.is_extra][:3]
        operator = text(sign).lstrip(".")
        operator = OPERATORS.get(operator, operator)
        if operator not in ("+", "-", "*", "/", "**", "@", "solve"):
            return Opaque(line(node), f"the operator {text(sign)} is not followed")
        if operator == "**" and text(sign) == "^" and not self.language.has_caret_powers:
            return Opaque(line(node), f"^ is no power in {self.language.name}")
        if operator == "**":
            return self._power(node)
        operands = (self.tree(left), self.tree(right))
        if operator == "/" and self.language.has_whole_quotients:
            match operands:
                case NumberLiteral(digits=a), NumberLiteral(digits=b) if (
                    f"{a}{b}".isdigit() and int(b)
                ):
                    return NumberLiteral(line(node), str(int(a) // int(b)))
        return OperatorExpression(line(node), operator, operands)

    def _power(self, node: "Node") -> Expression:
        """A power; grammars differ from their languages in -x^2, in 2x^2 and in x^y^z."""
        base, *exponents = self._powers(node)
        if self.role(base) == "unary" and text(base).startswith("-"):
            operand = self.children(base)[-1]
            return OperatorExpression(line(node), "-", (self._raised(operand, exponents),))
        if self.role(base) == "product":
            left, right = self.children(base)
            power = self._raised(right, exponents)
            return OperatorExpression(line(node), "*", (self.tree(left), power))
        return self._raised(base, exponents)

    def _powers(self, node: "Node", level: int = 0) -> list["Node"]:
        """The base and the exponents of powers of powers that are written without brackets."""
        parts = [one for one in node.children if not one.is_extra]
        is_power = self.role(node) == "binary" and text(parts[1]).lstrip(".") in ("^", "**")
        if not is_power or level > MAX_POWERS:
            return [node]
        return [*self._powers(parts[0], level + 1), *self._powers(parts[2], level + 1)]

    def _raised(self, base: "Node", exponents: Sequence["Node"]) -> Expression:
        trees = self._trees([base, *exponents])
        if self.language.has_left_powers:
            return reduce(lambda a, b: OperatorExpression(a.line, "**", (a, b)), trees)
        return reduce(lambda b, a: OperatorExpression(a.line, "**", (a, b)), reversed(trees))

    def _conditional_tree(self, node: "Node") -> Expression:
        first, second, third = self.children(node)
        after = first if self.language.name == "Python" else second  # a if condition else b
        return Choice(line(node), self.tree(third), self.tree(after))

    def _product_tree(self, node: "Node") -> Expression:
        left, right = self.children(node)
        if left.end_byte != right.start_byte:
            return Opaque(line(node), f"{shown(node)!r} is not understood")
        return OperatorExpression(line(node), "*", (self.tree(left), self.tree(right)))

    def _unary_tree(self, node: "Node") -> Expression:
        sign, operand = [one for one in node.children if not one.is_extra][:2]
        match text(sign):
            case "+":
                return self.tree(operand)
            case "-":
                return OperatorExpression(line(node), "-", (self.tree(operand),))
            case "*" | "&":  # of a pointer
                return self.tree(operand)
        return Opaque(line(node), f"{shown(node)!r} is not followed")

    def _transpose_tree(self, node: "Node") -> Expression:
        return OperatorExpression(line(node), "transpose", (self.tree(self.children(node)[0]),))

    def _array_tree(self, node: "Node") -> Expression:
        if node.child_by_field_name("length"):  # [value; count] of Rust
            value = self.tree(self.children(node)[0])
            is_zero = isinstance(value, NumberLiteral) and float(value.digits) == 0
            return self._zeros_tree(node) if is_zero else Opaque(line(node), "a repeated value")
        return Array(line(node), self._trees(self.children(node)))

    def _zeros_tree(self, node: "Node") -> Expression:
        return FunctionCall(line(node), Name(line(node), "zeros"), ())

    def _values_tree(self, node: "Node") -> Expression:
        """One value, or several, in a statement of Go."""
        items = self._trees(self.children(node))
        return items[0] if len(items) == 1 else Array(line(node), items)

    def _literal_tree(self, node: "Node") -> Expression:
        """The members of an object of Go with their names, or the entries of an array."""
        has_names = any(self.role(one) == "pair" for one in self.children(node))
        return self._record_tree(node) if has_names else self._array_tree(node)

    def _branch_tree(self, node: "Node") -> Expression:
        """A conditional as a value."""
        first, second = map(node.child_by_field_name, ("consequence", "alternative"))
        if not (first and second):
            return Opaque(line(node), "a conditional without a second value")
        return Choice(line(node), self.tree(second), self.tree(first))

    def _otherwise_tree(self, node: "Node") -> Expression:
        return self._block_tree(node)

    def _matrix_tree(self, node: "Node") -> Expression:
        rows = [
            tuple(one for child in self.children(row) for one in self._entries(child))
            for row in self.children(node)
        ]
        if [len(row) for row in rows] == [1]:
            return rows[0][0]  # a bracket
        if len(rows) == 1 or all(len(row) == 1 for row in rows):
            items = Array(line(node), tuple(one for row in rows for one in row))
            return FunctionCall(line(node), Name(line(node), "vcat"), (items,))
        return Array(line(node), tuple(Array(one.line, row) for row in rows for one in row[:1]))

    def _entries(self, node: "Node") -> list[Expression]:
        """The entries of a row of a matrix: ``a -b`` are two of them."""
        left, sign, right = [*(one for one in node.children if not one.is_extra), *[node] * 3][:3]
        if self.role(node) != "binary" or text(sign) not in ("+", "-"):
            return [self.tree(node)]
        *before, last = self._entries(left)
        value = self.tree(right)
        if left.end_byte < sign.start_byte and sign.end_byte == right.start_byte:
            is_negative = text(sign) == "-"
            own = OperatorExpression(line(sign), "-", (value,)) if is_negative else value
            return [*before, last, own]
        return [*before, OperatorExpression(line(node), text(sign), (last, value))]

    def _comprehension_tree(self, node: "Node") -> Expression:
        return self._comprehension(node, self.children(node))

    def _comprehension(self, node: "Node", children: Sequence["Node"]) -> Expression:
        """The array of the first child for each value of the index in the others."""
        element, *clauses = children
        parts = (self.children(one) if one.type == "for_clause" else [one] for one in clauses)
        clauses = [one for part in parts for one in part]
        bounds = self.bounds(clauses[0], clauses[0]) if len(clauses) == 1 else None
        if bounds is None:
            return Opaque(line(node), f"{shown(node)!r} is not followed")
        variable = self.word(self.children(clauses[0])[0])
        return Comprehension(line(node), self.tree(element), variable, *bounds)

    def bounds(self, node: "Node", header: "Node") -> tuple[Expression, Expression] | None:
        """The first value of the index of a loop, and the one after the last; None if not known."""
        condition = node.child_by_field_name("condition")
        condition = condition or header.child_by_field_name("condition")
        one = NumberLiteral(line(node), "1")
        if header.type == "range_clause":  # of Go
            array = header.child_by_field_name("right")
            return (NumberLiteral(line(node), "0"), self._count(array)) if array else None
        given = node.child_by_field_name("right") or node.child_by_field_name("value")
        if condition and self.role(condition) == "binary":
            _, sign, last = [part for part in condition.children if not part.is_extra][:3]
            first = header.child_by_field_name("initializer") or header
            while self.children(first) and self.role(first) != "call":
                first = self.children(first)[-1]
            end = self.tree(last)
            if text(sign) == "<=":
                end = OperatorExpression(line(node), "+", (end, one))
            return (self.tree(first), end) if text(sign) in ("<", "<=") else None
        parts = [given] if given else self.children(header)
        if len(parts) == 1 and not given:  # of Fortran
            parts = self.children(parts[0])
        match tuple(map(self.tree, parts[1:] or parts)):
            case (*_, FunctionCall(function=Name(path="range"), arguments=(end,))):
                return NumberLiteral(line(node), "0"), end
            case (*_, FunctionCall(function=Name(path="range"), arguments=(lower, end))):
                return lower, end
            case (*_, Slice(lower=Expression() as lower, upper=Expression() as upper)):
                if self.language.is_half_open:
                    return lower, upper
                return lower, OperatorExpression(line(node), "+", (upper, one))
            case (lower, upper) if len(parts) == 3 and self.role(parts[1]):
                return lower, OperatorExpression(line(node), "+", (upper, one))
        return None

    def _count(self, node: "Node") -> Expression:
        """A number, or the length of an array."""
        if self.role(node) in ("number", "call"):
            return self.tree(node)
        return FunctionCall(line(node), Name(line(node), "len"), (self.tree(node),))

    def _record_tree(self, node: "Node") -> Expression:
        return Record(line(node), tuple(self._fields(node)))

    def _fields(self, node: "Node") -> Iterator[tuple[str, Expression]]:
        for child in self.children(node):
            if self.role(child) == "pair":
                key, value = self._pair(child)
                yield text(key).strip("\"'`"), self.tree(value)
            elif self.role(child) == "name":
                yield self.word(child), self.tree(child)

    def _names_tree(self, node: "Node") -> Expression:
        """Names of members, as in ``const {m1, l1} = p``."""
        return Record(line(node), tuple(self._fields(node)))


def line(node: "Node") -> int:
    """The line of a node, counted from 1."""
    return node.start_point[0] + 1


def text(node: "Node") -> str:
    """The text of a node."""
    return (node.text or b"").decode("utf-8", "replace")


def shown(node: "Node") -> str:
    """The beginning of the text of a node, for messages."""
    return " ".join(text(node)[:60].split())[:40]
