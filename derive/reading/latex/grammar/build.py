"""Syntax trees from the rules of the grammar: one method a rule, with its children."""

from dataclasses import dataclass, replace
from itertools import pairwise

from derive.reading.latex.grammar.derivatives import applied, fraction
from derive.reading.latex.grammar.letter_grammar import AMBIGUOUS
from derive.reading.latex.grammar.products import divided
from derive.reading.latex.grammar.written_nodes import (
    Operator,
    Part,
    SumSign,
    WrittenNode,
    around,
    is_symbol,
    node,
    product,
)
from derive.reading.latex.layout.tokens import UnreadError
from derive.reading.latex.tree import (
    Application,
    AtPlace,
    Call,
    Dotted,
    Letter,
    Matrix,
    Node,
    Norm,
    Number,
    Power,
    Root,
    Span,
    Sum,
    Transpose,
    Tuple,
)


class Build:
    """The methods that the parser calls, in the order in which rules end."""

    def start(self, children: list[list[Part]]) -> Node:
        """A side of a statement; several expressions are a list of values."""
        (items,) = children
        nodes = tuple(map(node, items))
        return Tuple(nodes, around(nodes)) if len(nodes) > 1 else nodes[0]

    def expression(self, children: list[Part]) -> Part:
        """Terms with signs."""
        signs = [c for c in children if is_symbol(c, "SIGN")]
        terms = [c for c in children if not is_symbol(c, "SIGN")]
        if len(terms) == 1 and (not signs or signs[0].value == 1):
            return terms[0]
        leading = [1] if len(signs) < len(terms) else []
        values = [*leading, *(sign.value for sign in signs)]
        nodes = [node(term) for term in terms]
        return Sum(tuple(zip(values, nodes, strict=True)), around(children))

    def term(self, children: list[Part]) -> Part:
        """Factors side by side, with signs of multiplication and slashes."""
        if len(children) == 1:
            return children[0]
        return applied(divided(children))

    def negative(self, children: list[Part]) -> Node:
        """A term with a minus behind another sign, as in a + -b."""
        return Sum(((-1, node(children[1])),), around(children))

    def power(self, children: list[Part]) -> Node:
        """A base with an exponent."""
        base, _, exponent = children
        return Power(node(base), node(exponent), around(children))

    coefficient_power = accented_power = time_power = greek_power = power

    def transposed(self, children: list[Part]) -> Node:
        """A transposed matrix."""
        return Transpose(node(children[0]), around(children))

    def argument(self, children: list[Part]) -> WrittenNode:
        """The content of the braces of an argument."""
        first, content, last = children
        inner = content[0] if isinstance(content, list) else content
        return WrittenNode(node(inner), around((first, last)), "argument")

    def application(self, children: list[Part]) -> Node:
        """A letter before brackets."""
        head, _, items, _ = children
        return Application(head.value, tuple(map(node, items)), around((head, children[-1])))

    coefficient_application = accented_application = greek_application = application

    def items(self, children: list[Part]) -> list[Part]:
        """Expressions between commas."""
        return [c for c in children if not is_symbol(c, "COMMA")]

    def bracketed(self, children: list[Part]) -> Part:
        """An expression in brackets, or several."""
        first, items, last = children
        span = around((first, last))
        if len(items) > 1:
            return Tuple(tuple(map(node, items)), span)
        if isinstance(items[0], Operator | SumSign):
            raise UnreadError("a derivative or a sum in brackets has no operand")
        return WrittenNode(node(items[0]), span, "brackets")

    def group(self, children: list[Part]) -> Part:
        """An expression in braces."""
        first, items, last = children
        span = around((first, last))
        if len(items) > 1:
            return Tuple(tuple(map(node, items)), span)
        if isinstance(items[0], Operator | SumSign):
            return replace(items[0], span=span)
        return WrittenNode(node(items[0]), span, "braces")

    def norm(self, children: list[Part]) -> Node:
        """An expression between bars; of a matrix, its determinant."""
        operand, span = node(children[1]), around((children[0], children[-1]))
        return Call("det", operand, span) if isinstance(operand, Matrix) else Norm(operand, span)

    def at_place(self, children: list[Part]) -> Node:
        """An expression at a place."""
        return AtPlace(node(children[1]), around((children[0], children[-1])))

    def over(self, children: list[Part]) -> list[Part]:
        r"""A fraction written with ``\over``."""
        return [fraction(node(children[0]), node(children[2]), around(children))]

    def fraction(self, children: list[Part]) -> Part:
        """A quotient or a derivative."""
        sign, numerator, denominator = children
        span = around((sign, children[-1]))
        return fraction(node(numerator), node(denominator), span)

    def root(self, children: list[Part]) -> Node:
        """A root."""
        return Root(node(children[1]), children[0].value, around(children))

    def dotted(self, children: list[Part]) -> Node:
        """Dots over an expression."""
        return Dotted(node(children[1]), children[0].value, around(children))

    def matrix(self, children: list[Part]) -> Node:
        """Rows between the start and the end of an environment."""
        rows = tuple(c for c in children if isinstance(c, tuple))
        if len({len(row) for row in rows}) > 1:
            raise UnreadError("the rows of a matrix have different lengths")
        span = around((children[0], children[-1]))
        result = Matrix(rows, span)
        return Call("det", result, span) if children[0].value == "vmatrix" else result

    def row(self, children: list[Part]) -> tuple[Node, ...]:
        """Entries of a matrix."""
        return tuple(c for c in children if not is_symbol(c, "CELL"))

    def cell(self, children: list[Part]) -> Node:
        """An entry of a matrix."""
        if not children:
            raise UnreadError("an entry of a matrix is empty")
        return node(children[0])

    def sum(self, children: list[Part]) -> SumSign:
        """The sign of a sum with its bounds."""
        bounds = [c for c in children if isinstance(c, Bound)]
        indices = next((b.indices for b in bounds if b.indices), ())
        lower = next((b.value for b in bounds if b.indices), None)
        upper = next((b.value for b in bounds if not b.indices), None)
        return SumSign(indices, lower, upper, around(children))

    def lower(self, children: list[Part]) -> "Bound":
        """The indices of a sum and their first value."""
        _, _, items, *first, _ = children
        written = [node(item) for item in items]
        indices = tuple(f for one in written for f in getattr(one, "factors", (one,)))
        if first and first[0].value != "=":
            raise UnreadError("a sum over a condition")
        letters = tuple(index for index in indices if isinstance(index, Letter))
        if len(letters) < len(indices):
            raise UnreadError("the index of a sum is no letter")
        return Bound(node(first[1]) if first else None, around(children[:2]), letters)

    def upper(self, children: list[Part]) -> "Bound":
        """The last value of the index of a sum."""
        return Bound(node(children[1]), children[1].span)

    def call(self, children: list[Part]) -> Part:
        """A function, its power and its argument."""
        function, *powers, argument = children
        span = around(children)
        is_bare = isinstance(argument, WrittenNode) and argument.form == "bare"
        result: Node = Call(function.value, node(argument), span)
        if powers:
            result = Power(result, node(powers[0]), span)
        return WrittenNode(result, span, "bare") if is_bare else result

    def function_power(self, children: list[Part]) -> WrittenNode:
        """The power of a function before its argument."""
        _, exponent = children
        if isinstance(exponent.node, Sum):
            raise UnreadError("a negative power of a function before its argument")
        return exponent

    def function_argument(self, children: list[Part]) -> Part:
        """The argument of a function."""
        return children[0]

    def raised_group(self, children: list[Part]) -> Node:
        """A power behind braces."""
        raise UnreadError("an exponent of the function or of its argument")

    def raised_accented(self, children: list[Part]) -> WrittenNode:
        """A letter with dots, with its exponent."""
        return WrittenNode(node(children[0]), children[0].span, "bare")

    def bare(self, children: list[Part]) -> WrittenNode:
        """An argument without brackets."""
        ends_well = isinstance(children[-1], list)
        factors = [f for c in children for f in (c if isinstance(c, list) else [node(c)])]
        letters = [f for f in factors if not isinstance(f, Number) and not _is_pi(f)]
        is_tight = all(a.span[1] == b.span[0] for a, b in pairwise(factors))
        if len(letters) > 1 and not ends_well and not is_tight:
            raise UnreadError(AMBIGUOUS)
        return WrittenNode(product(factors), around(factors), "bare")

    def counted(self, children: list[Part]) -> WrittenNode:
        """An argument of a number and brackets, a fraction or a letter with dots."""
        number, *rest = [c for c in children if not is_symbol(c, "TIMES")]
        if len(rest) > 1:
            raise UnreadError(AMBIGUOUS)
        factors = [node(number), node(rest[0])]
        return WrittenNode(product(factors), around(children), "bare")

    def scaled(self, children: list[Part]) -> Node:
        """A number before a sign of multiplication, in an argument without brackets."""
        return node(children[0])

    def last(self, children: list[Part]) -> list[Node]:
        """The end of an argument without brackets."""
        return [node(child) for child in children]


@dataclass(frozen=True)
class Bound:
    """A bound of a sum."""

    value: Node | None
    span: Span
    indices: tuple[Letter, ...] = ()  # of the lower bound


def _is_pi(factor: Node) -> bool:
    return isinstance(factor, Letter) and factor.identifier == "pi"
