"""Formulas of documents as MathML, with wrong terms marked."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import fields
from html import escape
from itertools import groupby, pairwise

from derive.formulas.typeset.lettering import denominator
from derive.formulas.typeset.typesetting import APPLY, MINUS, TIMES, brackets, grouped, infix
from derive.reading.latex.tree import (
    Application,
    AtPlace,
    Call,
    Derivative,
    Dotted,
    Letter,
    Matrix,
    Node,
    Norm,
    Number,
    Power,
    Product,
    Quotient,
    Root,
    Span,
    Statement,
    Sum,
    Summation,
    Transpose,
    Tuple,
)
from derive.verification.documents.pages.letter_mathml import letter_and_index, raised, symbol

RELATIONS = {":=": "≔", "~": "≈", "<=": "≤", ">=": "≥", "!=": "≠", "->": "→", "in": "∈"}
FUNCTIONS = {"asin": "arcsin", "acos": "arccos", "atan": "arctan", "sign": "sgn", "log": "ln"}
#: Binding strengths: an operand that binds less than its neighbour needs brackets.
SUM, PRODUCT, CALL, POWER, ATOM = range(5)
#: The bracket with which an expression starts, and the pair that it belongs to.
BRACKET = re.compile(
    r"(?:\\left|\\[Bb]igg?l?)?\s*(?:\\begin\{(?=[bB]matrix))?([(\[]|\\\{|\\lbrace|[bB]matrix)"
)
BRACKETS = {"(": "()", "[": "[]", "bmatrix": "[]"} | dict.fromkeys(
    (r"\{", r"\lbrace", "Bmatrix"), "{}"
)
GAP = '<mspace width="0.167em"/>'


def statement_html(
    latex: str, statement: Statement, marked: Sequence[Span] = (), word: str = "wrong-term"
) -> str:
    """A formula as MathML elements, between which a line can break.

    Parameters
    ----------
    latex, statement
        The formula.
    marked
        Parts of the LaTeX. Marked are the parts of the formula within them, or the smallest part
        around one that contains none.
    word
        The class of marked parts.
    """
    everything = [node for side in statement.sides for node in _nodes(side)]
    typesetter = _Typesetter(latex, [_visible(span, everything) for span in marked], word)
    elements = []
    for relation, side in zip(("", *statement.relations), statement.sides, strict=True):
        head, *tail = typesetter.terms(side)
        elements += [infix(_relation(relation)) + head if relation else head, *tail]
    return "<wbr>".join(f'<math displaystyle="true">{one}</math>' for one in elements)


def _nodes(node: Node) -> Iterator[Node]:
    """A node and all nodes within it."""
    pending: list[object] = [node]
    while pending:
        one = pending.pop()
        if isinstance(one, tuple):
            pending += one
        elif isinstance(one, Node):
            yield one
            pending += [getattr(one, field.name) for field in fields(one)]


def _visible(span: Span, everything: Sequence[Node]) -> Span:
    """The span if it contains a node, otherwise the term of its sign, or the node around it."""
    if any(_is_within(one.span, span) for one in everything):
        return span
    around = [one for one in everything if _is_within(span, one.span)]
    smallest = min(around, key=lambda one: one.span[1] - one.span[0], default=None)
    if isinstance(smallest, Sum):
        signed = (term.span for _, term in smallest.terms if span[1] <= term.span[0])
        return next(signed, smallest.span)
    return smallest.span if smallest else span


def _is_within(inner: Span, outer: Span) -> bool:
    return outer[0] <= inner[0] and inner[1] <= outer[1]


class _Typesetter:
    """The markup of nodes, some of which are marked."""

    def __init__(self, latex: str, marked: Sequence[Span], word: str) -> None:
        self._latex, self._marked, self._word = latex, marked, word
        self._within_mark = _Typesetter(latex, (), word) if marked else self

    def terms(self, node: Node) -> list[str]:
        """The terms of a sum with their signs; a node that is no sum is one term."""
        if not isinstance(node, Sum) or self._is_marked(node):
            return [self._markup(node)[0]]
        terms = []
        for k, (sign, term) in enumerate(node.terms):
            before = ("" if sign > 0 else MINUS) if k == 0 else infix("+" if sign > 0 else "−")
            if self._is_marked(term):  # with its sign, which may be wrong
                terms.append(self._mark(before + self._within_mark.operand(term, PRODUCT)))
            else:
                terms.append(before + self.operand(term, PRODUCT))
        return terms

    def operand(self, node: Node, least: int) -> str:
        """The markup of a node, in brackets if it binds less than `least`."""
        markup, binding = self._markup(node)
        return markup if binding >= least else self._enclosed(node, markup)

    def _enclosed(self, node: Node, markup: str) -> str:
        """The markup in the brackets of the document."""
        result = self._brackets_of(node)
        return brackets(markup, *BRACKETS[result[1] if result else "("])

    def _brackets_of(self, node: Node) -> re.Match[str] | None:
        return BRACKET.match(self._latex, *node.span)

    def _is_marked(self, node: Node) -> bool:
        return any(_is_within(node.span, one) for one in self._marked)

    def _mark(self, markup: str) -> str:
        return f'<mrow class="{self._word}">{markup}</mrow>'

    def _markup(self, node: Node) -> tuple[str, int]:
        """The markup of a node and its binding strength."""
        if self._is_marked(node):
            markup, binding = self._within_mark._markup(node)
            return self._mark(markup), binding
        match node:
            case Number(digits=digits):
                return f"<mn>{escape(digits)}</mn>", ATOM
            case Letter():
                return symbol(node), ATOM
            case Sum():
                return "".join(self.terms(node)), SUM
            case Product(factors=factors):
                return self._product(factors), PRODUCT
            case Quotient(numerator=above, denominator=below):
                return _fraction(self._row(above), self._row(below)), PRODUCT
            case Power(base=Call(function=name, argument=argument), exponent=exponent):
                function = f"<msup>{_function(name)}{self._row(exponent)}</msup>"
                return function + self._argument(argument), CALL
            case Power(base=Letter(index=str(index), primes=0) as base, exponent=exponent) if index:
                pair = "".join(letter_and_index(base))
                return f"<msubsup>{pair}{self._row(exponent)}</msubsup>", POWER
            case Power(base=base, exponent=exponent):
                return (
                    f"<msup>{grouped(self.operand(base, ATOM))}{self._row(exponent)}</msup>",
                    POWER,
                )
            case Root(radicand=radicand, degree=2):
                return f"<msqrt>{self._row(radicand)}</msqrt>", ATOM
            case Root(radicand=radicand, degree=degree):
                return f"<mroot>{self._row(radicand)}<mn>{degree}</mn></mroot>", ATOM
            case Call(function=name, argument=argument):
                return _function(name) + self._argument(argument), CALL
            case Application(head=head, arguments=arguments):
                return symbol(head) + APPLY + brackets(self._list(arguments)), ATOM
            case Derivative():
                return self._derivative(node), PRODUCT
            case Dotted(operand=operand, dots=dots):
                return (
                    f"<mover>{grouped(self.operand(operand, ATOM))}<mo>{'.' * dots}</mo></mover>",
                    ATOM,
                )
            case Matrix():
                return self._matrix(node), ATOM
            case Tuple(items=items):
                return self._enclosed(node, self._list(items)), ATOM
            case Transpose(operand=operand):
                return f"<msup>{grouped(self.operand(operand, ATOM))}<mi>T</mi></msup>", POWER
            case Norm(operand=operand):
                return brackets(self._markup(operand)[0], "|", "|"), ATOM
            case AtPlace(operand=operand):
                return brackets(self._markup(operand)[0], "", "|"), ATOM
            case Summation():
                return self._summation(node), PRODUCT

    def _row(self, node: Node) -> str:
        return grouped(self._markup(node)[0])

    def _list(self, nodes: Sequence[Node]) -> str:
        return "<mo>,</mo>".join(self._markup(node)[0] for node in nodes)

    def _product(self, factors: Sequence[Node]) -> str:
        pieces = [self.operand(factors[0], PRODUCT)]
        for before, factor in pairwise(factors):
            is_function = any(isinstance(_base(one), Call) for one in (before, factor))
            is_number = isinstance(_base(factor), Number)
            pieces.append("<mo>·</mo>" if is_number else TIMES + GAP * is_function)
            pieces.append(self.operand(factor, PRODUCT))
        return "".join(pieces)

    def _argument(self, argument: Node) -> str:
        has_call = any(isinstance(one, Call) for one in _nodes(argument))
        markup, binding = self._markup(argument)
        is_simple = binding >= PRODUCT and not has_call and not self._brackets_of(argument)
        return APPLY + (GAP + markup if is_simple else self._enclosed(argument, markup))

    def _derivative(self, node: Derivative) -> str:
        sign = "<mo>∂</mo>" if node.is_partial else "<mi>d</mi>"
        below = ""
        for variable, group in groupby(self.operand(one, ATOM) for one in node.variables):
            below += sign + _times(variable, len(list(group)))
        is_simple = isinstance(node.operand, Letter)
        above = _times(sign, len(node.variables)) + (self._row(node.operand) if is_simple else "")
        fraction = _fraction(grouped(above), grouped(below))
        return fraction if is_simple else fraction + self._bracketed(node.operand)

    def _bracketed(self, node: Node) -> str:
        markup, binding = self._markup(node)
        return markup if binding == ATOM else self._enclosed(node, markup)

    def _matrix(self, node: Matrix) -> str:
        cells = ("".join(f"<mtd>{self._markup(one)[0]}</mtd>" for one in row) for row in node.rows)
        rows = "".join(f"<mtr>{row}</mtr>" for row in cells)
        return self._enclosed(node, f"<mtable>{rows}</mtable>")

    def _summation(self, node: Summation) -> str:
        index = symbol(node.index) if node.index else ""
        below = index + (f"<mo>=</mo>{self._row(node.lower)}" if node.lower else "")
        above = self._row(node.upper) if node.upper else "<mrow></mrow>"
        sign = '<mo movablelimits="false">∑</mo>'
        sign = f"<munderover>{sign}{grouped(below)}{above}</munderover>" if below else sign
        return sign + self.operand(node.body, PRODUCT)


def _base(node: Node) -> Node:
    return _base(node.base) if isinstance(node, Power) else node


def _times(markup: str, order: int) -> str:
    return raised(grouped(markup), f"<mn>{order}</mn>" if order > 1 else "")


def _relation(sign: str) -> str:
    return RELATIONS.get(sign, escape(sign))


def _function(name: str) -> str:
    return f"<mi>{escape(FUNCTIONS.get(name, name))}</mi>"


def _fraction(above: str, below: str) -> str:
    return f"<mfrac>{above}{denominator(below)}</mfrac>"
