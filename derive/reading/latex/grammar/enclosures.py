"""Brackets, groups, arguments and matrices as terminals of the grammar."""

from abc import abstractmethod
from dataclasses import replace

from derive.reading.latex.grammar.letter_grammar import (
    AMBIGUOUS,
    LETTER_TYPES,
    LetterTokens,
    ends_bare_argument,
)
from derive.reading.latex.grammar.written_nodes import Symbol
from derive.reading.latex.layout.pairs import inside, is_operator
from derive.reading.latex.layout.tokens import Token, UnreadError

SHAPES = {"(": "ROUND", "[": "SQUARE", "{": "CURLY", "|": "NORM", "<": "ANGLE", "floor": "FLOOR"}
SHAPES["place"] = "PLACE"
SIGNS = {"+": ("SIGN", 1), "-": ("SIGN", -1), "*": ("TIMES", "*"), "/": ("SLASH", "/")}
REASONS = {
    "_": "an index behind an expression that is no letter",
    "'": "a prime behind an expression that is no letter",
    "}": "a brace is closed but never opened",
    "open": "a bracket is never closed",
    "close": "a bracket is closed but never opened",
    "bar": "a bar has no partner",
    "middle": "a bar between two expressions",
    "begin": "an environment is never ended",
    "end": r"\end without \begin",
    "nabla": "the operator nabla",
    "int": "an integral",
    "prod": "a product over an index",
    "lim": "a limit",
}


class Enclosures(LetterTokens):
    """Tokens of which brackets, groups and matrices are read."""

    def __init__(self, tokens: list[Token]) -> None:
        super().__init__(tokens)
        self.applied: set[int] = set()  # brackets that hold the arguments of a letter
        self.entries: set[int] = set()  # separators between entries of matrices

    @abstractmethod
    def between(self, start: int, end: int) -> list[Symbol]:
        """The terminals of some of the tokens."""

    def simple(self, at: int, result: list[Symbol]) -> Symbol:
        """The terminal of a token that is one by itself."""
        token = self.tokens[at]
        if token.kind in SIGNS:
            sign = Symbol(*SIGNS[token.kind], token.span)
            before = (result[-1].type, result[-1].value) if result else ("", "")
            if sign.value == -1 and (before == ("SIGN", 1) or before[0] == "TIMES"):
                return Symbol("NEGATIVE", -1, token.span)
            return sign
        if token.kind in (",", "relation"):
            return Symbol("COMMA" if token.kind == "," else "RELATION", token.text, token.span)
        if token.kind in ("open", "close", "bar") and at in self.partner:
            is_open = self.partner[at] > at
            if token.kind == "open" and self._is_applied(at, result):
                self.applied |= {at, self.partner[at]}
            shape = "APPLY" if at in self.applied else SHAPES[self._shape(at)]
            return Symbol(shape + ("_OPEN" if is_open else "_CLOSE"), "", token.span)
        raise UnreadError(REASONS.get(token.kind, f"{token.text!r} cannot stand here"))

    def _shape(self, at: int) -> str:
        """The shape of a bracket; angles around entries of a column are round brackets."""
        start, end = sorted((at, self.partner[at]))
        places = inside(start, end, self.partner)
        is_column = self.tokens[at].text == "<" and any(self.tokens[k].kind == "," for k in places)
        return "(" if is_column else self.tokens[at].text

    def _is_applied(self, at: int, result: list[Symbol]) -> bool:
        """Whether a bracket holds the arguments of the letter before it.

        A bracket behind the bare argument of a function is a factor.
        """
        shape = self.tokens[at].text
        if shape not in ("(", "[") or not result or result[-1].type not in LETTER_TYPES:
            return False
        places = inside(at, self.partner[at], self.partner)
        if shape == "[":
            return any(self.tokens[place].kind == "," for place in places)
        if [self.tokens[p].text for p in places if self.tokens[p].kind != "space"] == ["t"]:
            return True
        end_of_argument = ends_bare_argument(result)
        if end_of_argument == "LATIN":
            if self.tokens[at - 1].text == "~" or self.tokens[at - 1].kind == "gap":  # sin q\,(a)
                return False
            raise UnreadError(AMBIGUOUS)
        return not end_of_argument and result[-1].value.name != "partial"

    def read_argument(self, at: int, end: int, result: list[Symbol]) -> int:
        """The terminals of an argument of a command; its place includes its braces."""
        start, stop, after = self.argument(at, end)
        return self.enclosed(start, stop, after, result)

    def enclosed(self, start: int, stop: int, after: int, result: list[Symbol]) -> int:
        """The terminals of the content of an argument that ends before a token."""
        inner = self.between(start, stop)
        if not inner:
            raise UnreadError("an argument is empty")
        left, right = self.tokens[start].span[0], self.tokens[after - 1].span[1]
        result.append(Symbol("ARGUMENT_OPEN", "", (left, left)))
        result += inner
        result.append(Symbol("ARGUMENT_CLOSE", "", (right, right)))
        return after

    def group(self, at: int, end: int, result: list[Symbol]) -> int:
        """The terminals of an expression in braces."""
        if at not in self.partner:
            raise UnreadError("a brace is never closed")
        stop = self.partner[at]
        first, last = self.skip(at + 1, stop), self._skip_back(stop - 1)
        if self.kind(first, stop) == "open" and self.partner.get(first) == last:
            return self._bracket_in_braces(at, first, last, result)
        inner = self.between(at + 1, stop)
        if len(inner) == 1 and inner[0].type in ("SIGN", "TIMES", "SLASH", "COMMA"):
            result += inner  # {+}
        elif inner:
            self.grouped(at, inner, stop, result)
        return stop + 1

    def _skip_back(self, at: int) -> int:
        while self.tokens[at].kind == "space":
            at -= 1
        return at

    def _bracket_in_braces(self, at: int, first: int, last: int, result: list[Symbol]) -> int:
        r"""Brackets in braces are brackets, as in ``\theta{\left(t\right)}``."""
        inner = self.between(first + 1, last)
        opening = self.simple(first, result)
        start, end = self.tokens[at].span[0], self.tokens[self.partner[at]].span[1]
        result.append(replace(opening, span=(start, opening.span[1])))
        result += inner
        closing = self.simple(last, result)
        result.append(replace(closing, span=(closing.span[0], end)))
        return self.partner[at] + 1

    def grouped(self, at: int, inner: list[Symbol], stop: int, result: list[Symbol]) -> None:
        """Add terminals as a group from one token to another."""
        result.append(Symbol("GROUP_OPEN", "", self.tokens[at].span))
        result += inner
        result.append(Symbol("GROUP_CLOSE", "", self.tokens[stop].span))

    def matrix(self, at: int, end: int, result: list[Symbol]) -> int:
        """The terminals of a matrix."""
        token = self.tokens[at]
        if token.text in ("cases", "dcases"):
            raise UnreadError("a definition by cases")
        if at not in self.partner:
            raise UnreadError(REASONS["begin"])
        stop = self.partner[at]
        places = inside(at, stop, self.partner)
        self.entries |= {place for place in places if self.tokens[place].kind in ("&", "row")}
        inner = self.between(at + 1, stop)
        while inner and inner[-1].type == "ROW":
            inner.pop()
        result.append(Symbol("MATRIX_OPEN", token.text, token.span))
        result += inner
        result.append(Symbol("MATRIX_CLOSE", "", self.tokens[stop].span))
        return stop + 1

    def separator(self, at: int, end: int, result: list[Symbol]) -> int:
        """A separator of the entries of a matrix, or the end of a line in brackets."""
        token = self.tokens[at]
        if at in self.entries:
            result.append(Symbol("CELL" if token.kind == "&" else "ROW", "", token.span))
        elif token.kind == "row":
            after = self.skip(at + 1, end)
            is_next = after < end and (
                is_operator(self.tokens[after]) or self.kind(after, end) == "&"
            )
            if not is_next and (not result or result[-1].type not in ("SIGN", "TIMES", "SLASH")):
                raise UnreadError("a new row in brackets")
        return at + 1
