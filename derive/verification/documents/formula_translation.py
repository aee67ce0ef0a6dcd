"""Formulas in the syntax of `derive.formulas.expression`, translated from trees of LaTeX.

They remember which LaTeX each of their parts comes from.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import assert_never

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
    Sum,
    Summation,
    Transpose,
    Tuple,
    indexed,
    letters,
    nodes,
)

#: Binding strengths: a part that binds less than its place requires is put into brackets.
SUM, PRODUCT, POWER, ATOM = range(4)


@dataclass(frozen=True)
class FormulaText:
    """A formula in our syntax, and the spans of its parts: start and end here, and in LaTeX."""

    text: str
    binding: int = ATOM
    parts: tuple[tuple[int, int, Span], ...] = ()
    entries: tuple["FormulaText", ...] = ()  # of a column or matrix that is written out, row by row

    def shifted(self, offset: int) -> Iterator[tuple[int, int, Span]]:
        """The parts, `offset` characters later."""
        return ((start + offset, end + offset, span) for start, end, span in self.parts)

    def part(self, start: int, end: int) -> "FormulaText":
        """The characters from `start` to `end`."""
        inner = tuple(
            (a - start, b - start, span) for a, b, span in self.parts if start <= a and b <= end
        )
        return FormulaText(self.text[start:end], SUM, inner)

    def source(self, start: int, end: int) -> Span | None:
        """The LaTeX of the characters from `start` to `end`: of all parts within them."""
        spans = [span for a, b, span in self.parts if start <= a and b <= end]
        return (min(s for s, _ in spans), max(e for _, e in spans)) if spans else None


def joined_text(binding: int, *pieces: FormulaText | str) -> FormulaText:
    """A formula from pieces, with the places of their parts."""
    text, parts = "", list[tuple[int, int, Span]]()
    for piece in pieces:
        if isinstance(piece, FormulaText):
            parts += piece.shifted(len(text))
            text += piece.text
        else:
            text += piece
    return FormulaText(text, binding, tuple(parts))


#: Endings of the names of a quantity and of its rates.
RATES = ("", "_dot", "_ddot", "_dddot")


def stem(name: str) -> str:
    """The name of a quantity without the ending of its rate."""
    return re.sub(r"_d{1,3}ot\Z", "", name)


def order(name: str) -> int:
    """The order of a rate: 0 for a quantity, 1 for its rate."""
    return RATES.index(name.removeprefix(stem(name)))


def is_derivative(name: str) -> bool:
    """Whether a name is that of a derivative, such as dL_dtheta."""
    return name.startswith("d") and "_d" in stem(name)  # but delta_dot is a rate


#: Reciprocals of functions that formulas have.
RECIPROCALS = {"sec": "cos", "csc": "sin"}

#: Letters of potentials, whose primes are derivatives by their own arguments.
FUNCTIONS_OF_PLACES = ("V", "U", "W", "f", "F")

#: Most terms of a sum that is written out.
MAX_TERMS = 20
#: Most terms and factors that are read: each is evaluated within the next.
MAX_SUM, MAX_PRODUCT = 400, 200


class UntranslatableError(ValueError):
    """A formula that has no translation; the message states why."""


@dataclass(frozen=True)
class LetterNotation:
    """What the letters of a document are, as far as a translation depends on it."""

    functions: frozenset[str] = frozenset()  # identifiers before brackets that hold arguments
    times: frozenset[str] = frozenset()  # those of them that time alone is the argument of
    matrices: frozenset[str] = frozenset()  # identifiers of matrices and columns
    count: int = 1  # values of an index without bounds
    is_counted: bool = True  # unless several coordinates have no numbers
    primes_are_rates: bool = False
    primed: frozenset[str] = frozenset()  # letters whose primes are rates beside dots of others
    calls: frozenset[str] = frozenset()  # functions whose arguments are kept: f(t + h, w)
    factors: frozenset[str] = frozenset()  # identifiers before brackets that hold a column
    moving: frozenset[str] = frozenset()  # letters that have dots
    slope: str = ""  # the letter by which primes are derivatives, as u' = du/dθ
    columns: frozenset[str] = frozenset()  # functions that are columns, beside a scalar: g(q), g


@dataclass
class FormulaTranslator:
    """Translations of trees; collects derivatives of letters, which become names."""

    notation: LetterNotation = LetterNotation()
    #: Names such as ``dL_dtheta_1_dot``, with the identifier of L and the texts of variables.
    derivatives: dict[str, tuple[str, tuple[str, ...]]] = field(default_factory=dict)

    def text(self, node: Node, least: int = SUM) -> FormulaText:
        """The translation of a tree, in brackets if it binds less than `least`."""
        result = self._text(node)
        if not any(span == node.span for *_, span in result.parts):
            whole = (0, len(result.text), node.span)
            result = replace(result, parts=(*result.parts, whole))
        return result if result.binding >= least else joined_text(ATOM, "(", result, ")")

    def name(self, letter: Letter) -> str:
        """The identifier of a letter with its dots."""
        are_rates = self.notation.primes_are_rates or letter.name in self.notation.primed
        primes = letter.primes if are_rates else 0
        is_slope = letter.primes and not letter.dots and letter.name not in FUNCTIONS_OF_PLACES
        if (slope := self.notation.slope) and is_slope:
            return self._slope(identifier(letter), (slope,) * letter.primes)
        name = identifier(letter) + "_prime" * (letter.primes - primes)
        name = f"{name}_column" if letter.is_bold else name
        return name + RATES[letter.dots + primes]

    def _slope(self, operand: str, variables: tuple[str, ...]) -> str:
        """The name of a derivative."""
        name = f"d{operand}" + "".join(f"_d{one}" for one in variables)
        self.derivatives[name] = operand, variables
        return name

    def _text(self, node: Node) -> FormulaText:
        match node:
            case Number(digits=digits):
                return FormulaText(digits)
            case Letter():
                return FormulaText(self.name(node))
            case Sum(terms=terms):
                return self._sum(terms)
            case Product(factors=factors):
                return self._product(factors)
            case Quotient(numerator=above, denominator=below):
                return joined_text(PRODUCT, self.text(above, PRODUCT), "/", self.text(below, POWER))
            case Power(base=base, exponent=exponent):
                return self._power(base, exponent)
            case Root(radicand=radicand, degree=2):
                return joined_text(ATOM, "sqrt(", self.text(radicand), ")")
            case Root(radicand=radicand, degree=degree):
                return joined_text(POWER, self.text(radicand, ATOM), f"**(1/{degree})")
            case Call(function=name, argument=argument):
                return self._call(name, argument)
            case Application():
                return self._application(node)
            case Derivative():
                return self._derivative(node)
            case Dotted(operand=Power(base=Letter() as base, exponent=exponent), dots=dots):
                # a dot over a power is that of the letter, which is wide enough for both
                return self._power(replace(base, dots=base.dots + dots), exponent)
            case Dotted(operand=operand, dots=dots):
                return self._rate(self._text(operand), dots)
            case Matrix(rows=rows):
                return self._matrix(rows)
            case Tuple(items=items):
                return self._matrix([(item,) for item in items])
            case Transpose(operand=Tuple() as column):
                return self._text(column)
            case Transpose(operand=operand):
                return joined_text(ATOM, "transpose(", self.text(operand), ")")
            case Norm(operand=operand):
                return joined_text(ATOM, "norm(", self.text(operand), ")")
            case Summation():
                return self._summation(node)
            case AtPlace():
                raise UntranslatableError("a value at a place")
        assert_never(node)

    def _sum(self, terms: Sequence[tuple[int, Node]]) -> FormulaText:
        if len(terms) > MAX_SUM:
            raise UntranslatableError(f"a sum of more than {MAX_SUM} terms")
        pieces: list[FormulaText | str] = []
        for sign, term in terms:
            between = "-" if sign < 0 else "+"
            pieces.append(f" {between} " if pieces else between * (sign < 0))
            pieces.append(self.text(term, PRODUCT))
        return joined_text(SUM, *pieces)

    def _product(self, factors: Sequence[Node]) -> FormulaText:
        if len(factors) > MAX_PRODUCT:
            raise UntranslatableError(f"a product of more than {MAX_PRODUCT} factors")
        pieces: list[FormulaText | str] = []
        for factor in self._factors(factors):
            # a quotient behind a factor is one factor: a*(b/c) keeps its parts
            text = self.text(factor, PRODUCT if not pieces else POWER)
            pieces += ["*", text] if pieces else [text]
        return joined_text(PRODUCT, *pieces)

    def _factors(self, factors: Sequence[Node]) -> Iterator[Node]:
        """The factors, also those of letters before brackets that are products."""
        for number, factor in enumerate(factors):
            before = factors[number - 1] if number else None
            if isinstance(before, Power) and self._holds_time(before, factor):
                continue  # the power of a function: f^2(t)
            if isinstance(factor, Application) and not self._is_function(factor):
                yield from (factor.head, _in_brackets(factor))
            else:
                yield factor

    def _holds_time(self, before: Power, factor: Node) -> bool:
        """Whether a factor is (t) behind the power of a function of time."""
        base, length = before.base, factor.span[1] - factor.span[0]
        is_time = isinstance(factor, Letter) and factor.identifier == "t" and length > 1
        return is_time and isinstance(base, Letter) and self.name(base) in self.notation.times

    def _power(self, base: Node, exponent: Node) -> FormulaText:
        is_enclosed = isinstance(base, Application) and base.span[0] < base.head.span[0]
        if isinstance(base, Application) and not (is_enclosed or self._is_function(base)):
            power = Power(_in_brackets(base), exponent, (base.head.span[1], base.span[1]))
            return self._product([base.head, power])
        inverse = isinstance(exponent, Sum) and len(exponent.terms) == 1 and exponent.terms[0]
        if inverse and inverse[0] < 0 and getattr(inverse[1], "digits", "") == "1":
            is_matrix = isinstance(base, Matrix) or (
                isinstance(base, Letter) and self.name(base) in self.notation.matrices
            )
            if is_matrix:
                return joined_text(ATOM, "inverse(", self.text(base), ")")
        if isinstance(base, Letter) and self.name(base) in self.notation.matrices:
            if getattr(exponent, "digits", "") != "2":
                raise UntranslatableError("a power of a matrix")
            return joined_text(ATOM, "square(", self.text(base), ")")
        if isinstance(base, Letter) and self.name(base) == "e" and _is_formula(exponent):
            return self._call("exp", exponent)
        return joined_text(POWER, self.text(base, ATOM), "**", self.text(exponent, ATOM))

    def _call(self, name: str, argument: Node) -> FormulaText:
        if name in RECIPROCALS:
            return joined_text(PRODUCT, f"1/{RECIPROCALS[name]}(", self.text(argument), ")")
        if name == "cot":
            inner = self.text(argument)
            return joined_text(PRODUCT, "cos(", inner, ")/sin(", inner, ")")
        arguments = argument.items if isinstance(argument, Tuple) else (argument,)
        pieces = [piece for one in arguments for piece in (", ", self.text(one))]
        return joined_text(ATOM, f"{name}(", *pieces[1:], ")")

    def _application(self, node: Application) -> FormulaText:
        name = self.name(node.head)
        if name in self.notation.calls:
            pieces = [piece for one in node.arguments for piece in (", ", self.text(one))]
            return joined_text(ATOM, f"{name}(", *pieces[1:], ")")
        if self._is_function(node):
            if all(isinstance(one, Number) for one in node.arguments):
                raise UntranslatableError("a value at a place")
            return FormulaText(f"{name}_column" if name in self.notation.columns else name)
        return self._product([node.head, _in_brackets(node)])

    def _is_function(self, node: Application) -> bool:
        name = self.name(node.head)
        if name in self.notation.times and not any(map(_is_of_time, node.arguments)):
            return False
        is_moving = node.head.name in self.notation.moving
        if is_moving and any(_is_factor(node.head, one) for one in node.arguments):
            return False
        if name in self.notation.functions | self.notation.calls:
            return True
        return len(node.arguments) > 1 and name not in self.notation.factors

    def _derivative(self, node: Derivative) -> FormulaText:
        times = [one for one in node.variables if isinstance(one, Letter) and one.name == "t"]
        if len(times) == len(node.variables) and not (
            node.is_partial and isinstance(node.operand, Letter) and not node.operand.dots
        ):
            return self._rate(self._text(node.operand), len(times))
        variables = tuple(self._text(one).text for one in node.variables)
        operand = self._text(node.operand)
        if isinstance(node.operand, Letter | Application) and operand.text.isidentifier():
            return FormulaText(self._slope(operand.text, variables))
        for variable in variables:
            if not node.is_partial and variable in self.notation.moving:  # along the motion
                operand = joined_text(PRODUCT, "ddt(", operand, f")/{variable}_dot")
            else:
                operand = joined_text(ATOM, "diff(", operand, f", {variable})")
        return operand

    def _rate(self, operand: FormulaText, times: int) -> FormulaText:
        name = operand.text
        is_letter = name.isidentifier() and name not in self.derivatives and name != "t"
        if is_letter and order(name) + times < len(RATES):
            return FormulaText(stem(name) + RATES[order(name) + times])
        for _ in range(times):
            operand = joined_text(ATOM, "ddt(", operand, ")")
        return operand

    def _matrix(self, rows: Sequence[Sequence[Node]]) -> FormulaText:
        pieces: list[FormulaText | str] = ["["]
        entries: list[FormulaText] = []
        if len(rows) > 1 and all(len(row) == 1 for row in rows):
            entries = [self.text(entry) for (entry,) in rows]
            pieces = [piece for entry in entries for piece in (", ", entry)]
            return replace(joined_text(ATOM, "(", *pieces[1:], ")"), entries=tuple(entries))
        for i, row in enumerate(rows):
            pieces.append(", [" if i else "[")
            for j, entry in enumerate(row):
                entries.append(self.text(entry))
                pieces += [", " * bool(j), entries[-1]]
            pieces.append("]")
        return replace(joined_text(ATOM, *pieces, "]"), entries=tuple(entries))

    def _summation(self, node: Summation) -> FormulaText:
        first, last = _whole(node.lower, 1), _whole(node.upper, self.notation.count)
        if node.index is None and isinstance(node.body, Letter) and node.body.name in TOTALS:
            return self.text(node.body)  # the sum of the forces of an axis, which has no letter
        if node.index is None or not 0 <= last - first < MAX_TERMS:
            raise UntranslatableError("a sum without an index, or of too many terms")
        is_counted = self.notation.is_counted or isinstance(node.upper, Number)
        if not is_counted and any(map(_is_rate, nodes(node.body))):
            raise UntranslatableError("a sum over coordinates that have no numbers")
        terms = [(1, indexed(node.body, node.index.name, k)) for k in range(first, last + 1)]
        return self._sum(terms)


def _is_rate(node: Node) -> bool:
    return isinstance(node, Derivative) or (isinstance(node, Letter) and bool(node.dots))


#: Letters of forces and torques, of which a sum without an index is the total.
TOTALS = frozenset(("F", "M", "tau", "T"))


def identifier(letter: Letter) -> str:
    """The name of a letter, of word characters alone: ``s_1_plus_2`` of s with the index 1 + 2."""
    name = letter.identifier.replace("+", "_plus_").replace("-", "_minus_")
    name = re.sub(r"\W", "_", name)
    return name if name[:1].isalpha() else f"letter_{name}"


def _is_factor(head: Letter, argument: Node) -> bool:
    """Whether brackets behind a coordinate hold a factor, with rates or with this coordinate."""
    if isinstance(argument, Letter):
        return False
    return any(one.dots or one.identifier == head.identifier for one in letters(argument))


def _is_of_time(argument: Node) -> bool:
    """Whether an argument is a time: a letter, a number, or t with others such as t + h."""
    if isinstance(argument, Letter | Number):
        return True
    names = [one.identifier for one in letters(argument)]
    return "t" in names and not any(isinstance(one, Call) for one in nodes(argument))


def _is_formula(exponent: Node) -> bool:
    """Whether an exponent is one of e = 2.718...: no number, and no index."""
    names = {one.name for one in letters(exponent)}
    return bool(names) and not (isinstance(exponent, Letter) and names <= {*"ijkmn"})


def _in_brackets(node: Application) -> Node:
    """The contents of the brackets behind a letter: an expression, or a column of several."""
    span = (node.head.span[1], node.span[1])
    if len(node.arguments) == 1:
        (one,) = node.arguments
        # a power of m(l(x)) is not one of x alone
        return replace(one, span=span) if isinstance(one, Application) else one
    return Tuple(node.arguments, span)


def _whole(node: Node | None, default: int) -> int:
    match node:
        case Number(digits=digits) if digits.isdigit():
            return int(digits)
        case None | Letter():
            return default
    raise UntranslatableError("a sum with bounds that are not whole numbers")
