"""Factors side by side, and quotients with a slash."""

from derive.reading.latex.grammar.derivatives import slashed_derivative
from derive.reading.latex.grammar.written_nodes import (
    Operator,
    Part,
    SumSign,
    Symbol,
    WrittenNode,
    around,
    factors_of,
    is_symbol,
    node,
    product,
)
from derive.reading.latex.layout.latex_symbols import GREEK, VARIATIONS
from derive.reading.latex.layout.tokens import UnreadError
from derive.reading.latex.tree import (
    Application,
    Call,
    Dotted,
    Letter,
    Node,
    Number,
    Power,
    Quotient,
    Tuple,
)

NUMERIC = ("NUMBER", "TIMES", "SLASH")
AMBIGUOUS = "what stands below the slash is ambiguous without brackets"


def divided(children: list[Part]) -> list[Part]:
    r"""Factors with the quotients that slashes denote.

    A slash divides the factor before it by the factor behind it: ``1/2 m v^2`` is (1/2) m v². A
    number below the slash takes the factors that follow without a space, as in ``p^2/2m``. In
    ``p / m l`` the quotient is p/m, and ambiguous, since p/(m l) can be meant.

    Raises
    ------
    Unread
        If the denominator is ambiguous, as in ``k/mx``, or the numerator, as in ``\sin\theta/2``.
    """
    result: list[Part] = []
    at = 0
    while at < len(children):
        child = children[at]
        if is_symbol(child, "SLASH"):
            stop = at + 1
            while stop < len(children) and not is_symbol(children[stop], "TIMES", "SLASH"):
                stop += 1
            behind = _quotient(result, children[at + 1 : stop])
            result += behind
            at = stop
            continue
        if is_symbol(child, "TIMES"):
            if child.value == "times" and any(map(_is_marked, children[at - 1 : at + 2 : 2])):
                stop = next(
                    (k + 1 for k in range(at + 1, len(children)) if _is_vector(children[k])), 0
                )
                if not (stop and result and result[-1] is children[at - 1]):
                    raise UnreadError("a vector product")
                result[-1:] = [_cross(result[-1], children[at + 1 : stop])]
                at = stop
                continue
        else:
            before = children[at - 1] if at else None
            if is_symbol(child, "NUMBER") and is_symbol(before, "NUMBER"):
                raise UnreadError("two numbers side by side")
            is_last = at == len(children) - 1 and not isinstance(before, Operator | SumSign | None)
            if is_last and _may_be_number(child) and not is_symbol(before, *NUMERIC):
                raise UnreadError("a number in brackets, which may be that of the equation")
            result.append(child)
        at += 1
    return result


def _may_be_number(part: Part) -> bool:
    """Whether a part is a whole number in brackets, like the number of an equation."""
    is_enclosed = isinstance(part, WrittenNode) and part.form == "brackets"
    return is_enclosed and isinstance(part.node, Number) and part.node.digits.isdigit()


def _is_variation(part: Part) -> bool:
    """Whether a part is the letter Δ, which may belong to the letter behind it."""
    return isinstance(part, Symbol) and getattr(part.value, "identifier", "") in VARIATIONS


def _is_marked(part: Part) -> bool:
    """Whether a part is a letter in bold, or with a hat or a bar."""
    letter = part.value if isinstance(part, Symbol) else part
    return isinstance(letter, Letter) and (letter.is_bold or letter.name.endswith(("hat", "bar")))


def _is_vector(part: Part) -> bool:
    return _is_marked(part) or (isinstance(part, WrittenNode) and part.form == "brackets")


def _cross(one: Part, others: list[Part]) -> Node:
    """The vector product of a vector and another one, which can have factors before it."""
    left, right = node(one), product([node(part) for part in others])
    both = Tuple((left, right), around([left, right]))
    return Call("cross", both, both.span)


def _quotient(before: list[Part], behind: list[Part]) -> list[Part]:
    """The quotient of the last factor, which is removed, and the factors that follow it."""
    if result := slashed_derivative(before, behind):
        return result
    left, right = before.pop(), behind[0]
    is_bare = isinstance(left, WrittenNode) and left.form == "bare"
    if is_bare and (is_symbol(right, "NUMBER") or not _ends_with_angle(left.node)):
        raise UnreadError("what stands above the slash is ambiguous without brackets")
    count = 1
    is_tight = len(behind) > 1 and right.span[1] == behind[1].span[0]
    if is_symbol(right, "NUMBER") and not is_symbol(left, "NUMBER"):
        while count < len(behind) and behind[count - 1].span[1] == behind[count].span[0]:
            count += 1
    elif is_symbol(right, "NUMBER"):
        pass
    elif (
        _is_variation(right)
        or (is_tight and not isinstance(behind[1], WrittenNode))
        or _has_brackets(right)
    ):
        raise UnreadError(AMBIGUOUS)
    below = product([node(part) for part in behind[:count]])
    is_number = is_symbol(left, "NUMBER") and is_symbol(right, "NUMBER")
    is_ambiguous = not is_number and any(map(_is_letter, behind[count : count + 1]))
    span = around([left, *behind[:count]])
    return [Quotient(node(left), below, span, is_ambiguous), *behind[count:]]


def _is_letter(part: Part) -> bool:
    """Whether a part is a letter, or a power or a rate of one."""
    one = part.value if isinstance(part, Symbol) else part
    while isinstance(one, Power | Dotted):
        one = one.base if isinstance(one, Power) else one.operand
    return isinstance(one, Letter)


def _ends_with_angle(call: Node) -> bool:
    r"""Whether a bare argument ends with a Greek letter: ``\sin\theta/l`` is (sin θ)/l."""
    function = call.base if isinstance(call, Power) else call
    last = factors_of(function.argument)[-1] if isinstance(function, Call) else function
    return isinstance(last, Letter) and last.name in GREEK


def _has_brackets(part: Part) -> bool:
    """Whether a part is a letter before brackets, other than x(t) and r(θ)."""
    if not isinstance(part, Application):
        return False
    argument = part.arguments[0]
    is_function = isinstance(argument, Letter) and argument.name in ("t", *GREEK)
    return not (is_function and len(part.arguments) == 1)
