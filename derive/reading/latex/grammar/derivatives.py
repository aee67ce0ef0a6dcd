"""Derivatives that are written as fractions, and what they and sums apply to."""

from derive.reading.latex.grammar.written_nodes import (
    Operator,
    Part,
    SumSign,
    WrittenNode,
    around,
    factors_of,
    node,
    product,
)
from derive.reading.latex.layout.latex_symbols import VARIATIONS
from derive.reading.latex.layout.tokens import UnreadError
from derive.reading.latex.tree import (
    Application,
    Derivative,
    Letter,
    Node,
    Number,
    Power,
    Product,
    Quotient,
    Span,
    Sum,
    Summation,
)


def fraction(numerator: Node, denominator: Node, span: Span) -> Node | Operator:
    r"""A quotient, or a derivative such as ``\frac{\partial L}{\partial\dot q}``."""
    if isinstance(numerator, Sum) and len(numerator.terms) == 1:
        ((sign, term),) = numerator.terms
        inner = fraction(term, denominator, span)
        if isinstance(inner, Derivative):
            return Sum(((sign, inner),), span)
        return Quotient(numerator, denominator, span)
    if _sign(numerator) in VARIATIONS and _sign(denominator) == _sign(numerator):
        raise UnreadError("a quotient of differences or variations")
    result = _differential(numerator)
    variables = result and _variables(denominator, result[0])
    if result is None or variables is None:
        return Quotient(numerator, denominator, span)
    name, order, operands = result
    if order != len(variables):
        raise UnreadError("the orders above and below a derivative differ")
    if not operands:
        return Operator(variables, name == "partial", span)
    return Derivative(product(operands), variables, name == "partial", span)


def _sign(factors: Node) -> str:
    """The name of the letter with which a product starts."""
    if isinstance(factors, Product) and isinstance(factors.factors[0], Letter):
        return factors.factors[0].identifier
    return ""


def _sign_of_differential(factor: Node) -> str | None:
    """The name of d or ∂."""
    if not isinstance(factor, Letter) or factor.dots or factor.primes:
        return None
    return factor.name if factor.identifier in ("d", "partial") else None


def _raised(factor: Node) -> tuple[Node, int]:
    """A factor and its exponent, if that can be the order of a derivative, otherwise 1."""
    if isinstance(factor, Power) and isinstance(factor.exponent, Number):
        digits = factor.exponent.digits
        if digits in tuple("123456789"):
            return factor.base, int(digits)
    return factor, 1


def _differential(numerator: Node) -> tuple[str, int, list[Node]] | None:
    """The sign, the order and the operands of a numerator such as ∂²L."""
    first, *rest = factors_of(numerator)
    if isinstance(first, Application) and first.head.name == "d" and len(first.arguments) == 1:
        return "d", 1, [first.arguments[0], *rest]
    sign, order = _raised(first)
    name = _sign_of_differential(sign)
    return (name, order, rest) if name else None


def _variables(denominator: Node, name: str) -> tuple[Node, ...] | None:
    """The variables of a denominator such as ∂x ∂y², one for each order."""
    factors = factors_of(denominator)
    variables: list[Node] = []
    if len(factors) % 2:
        return None
    for sign, raised in zip(factors[::2], factors[1::2], strict=True):
        variable, count = _raised(raised)
        letter = variable.base if isinstance(variable, Power) else variable  # of q^i
        if _sign_of_differential(sign) != name or not isinstance(letter, Letter | Application):
            return None
        variables += [variable] * count
    return tuple(variables)


def slashed_derivative(before: list[Part], behind: list[Part]) -> list[Part] | None:
    r"""A derivative such as ``\partial L/\partial\dot q``, instead of the factors before it."""
    name = _sign_of_differential(node(behind[0]))
    if name is None or len(behind) < 2:
        return None
    for count in (1, 2):
        if len(before) < count:
            return None
        above = before[-count:]
        if any(isinstance(part, Operator | SumSign) for part in above):
            return None
        result = _differential(product([node(part) for part in above]))
        if result is not None and result[0] == name:
            stop = 2 * result[1] if name == "partial" else 2
            stop = min(stop, len(behind) // 2 * 2)
            while stop > 2 and _sign_of_differential(node(behind[stop - 2])) != name:
                stop -= 2
            if not result[2]:
                behind = _with_operand(behind, stop)
            below = product([node(part) for part in behind[:stop]])
            del before[-count:]
            span = around([*above, *behind[:stop]])
            return [fraction(product([node(p) for p in above]), below, span), *behind[stop:]]
    return None


def _with_operand(behind: list[Part], stop: int) -> list[Part]:
    """The factors below a slash, of which brackets behind the last variable are the operand."""
    last = node(behind[stop - 1])
    if not isinstance(last, Application) or len(last.arguments) != 1:
        return behind
    brackets = WrittenNode(last.arguments[0], (last.head.span[1], last.span[1]), "brackets")
    return [*behind[: stop - 1], last.head, brackets, *behind[stop:]]


def applied(parts: list[Part]) -> Part:
    """A product in which derivatives and sums have their operands.

    The operand is the bracket behind the sign of a derivative, or else the rest of the term; a sum
    reaches to the end of the term.
    """
    done: list[Part] = []  # from right to left
    for part in reversed(parts):
        if isinstance(part, Operator | SumSign) and done:
            first = done[-1]
            is_operator = isinstance(part, Operator)
            if is_operator and isinstance(first, WrittenNode) and first.form == "brackets":
                operands = [done.pop()]
            else:
                operands, done = done[::-1], []
            operand = product([node(p) for p in operands])
            span = around([part, *operands])
            if isinstance(part, Operator):
                operand = Derivative(operand, part.variables, part.is_partial, span)
            else:
                for index in reversed(part.indices or (None,)):
                    operand = Summation(operand, index, part.lower, part.upper, span)
            done.append(operand)
        else:
            done.append(part)
    parts = done[::-1]
    return parts[0] if len(parts) == 1 else product([node(part) for part in parts])
