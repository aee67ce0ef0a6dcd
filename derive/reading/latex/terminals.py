r"""The terminals of the grammar, from tokens.

Of a bare argument, as in ``\sin 2\theta l``, the grammar takes numbers and Latin letters up to and
including the first Greek letter, and a ``t`` behind it: the terminals tell these kinds apart.
"""

import re
from collections.abc import Callable
from dataclasses import replace

from derive.reading.latex.functions import (
    AMBIGUOUS,
    LETTER_TYPES,
    ends_bare_argument,
    function_at,
)
from derive.reading.latex.letters import Letters
from derive.reading.latex.pairs import inside, is_operator
from derive.reading.latex.parts import Symbol
from derive.reading.latex.symbols import (
    ACCENTS,
    BOLD,
    FONTS,
    FRACTIONS,
    GREEK,
    INVERTIBLE,
    MARKS,
    SLASHES,
    TIMES,
    VARIATIONS,
)
from derive.reading.latex.tokens import Token, Unread
from derive.reading.latex.tree import Letter, Number

SHAPES = {"(": "ROUND", "[": "SQUARE", "{": "CURLY", "|": "NORM", "<": "ANGLE", "floor": "FLOOR"}
SIGNS = {"+": ("SIGN", 1), "-": ("SIGN", -1), "*": ("TIMES", "*"), "/": ("SLASH", "/")}
STARS = {"*": "star", "star": "star", "ast": "star", "dagger": "dagger", "circ": "circ"}
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
    "pm": "two signs at once",
    "mp": "two signs at once",
    "int": "an integral",
    "prod": "a product over an index",
    "lim": "a limit",
}


class Terminals(Letters):
    """A reader of the tokens of one side of a statement."""

    def __init__(self, tokens: list[Token]) -> None:
        super().__init__(tokens)
        self.applied: set[int] = set()  # brackets that hold the arguments of a letter
        self.entries: set[int] = set()  # separators between entries of matrices

    def all(self) -> list[Symbol]:
        """All terminals, in order."""
        return self._between(0, len(self.tokens))

    def _between(self, start: int, end: int) -> list[Symbol]:
        result: list[Symbol] = []
        with self.deeper():
            at = start
            while at < end:
                at = self._read(at, end, result)
        return result

    def _read(self, at: int, end: int, result: list[Symbol]) -> int:
        token = self.tokens[at]
        if token.kind in ("space", "gap"):
            return at + 1
        if token.kind == "digit" or (token.kind == "." and self.kind(at + 1, end) == "digit"):
            return self._number(at, end, result)
        if function := function_at(self.tokens, at, end):
            return self._function(function[0], at, function[1], end, result)
        if letter := self.letter(at, end):
            kind = _type(letter[0])
            is_behind = ends_bare_argument(result) == "GREEK" and kind in ("LATIN", "GREEK")
            if is_behind and result[-1].value.identifier in VARIATIONS:
                raise Unread(AMBIGUOUS)
            result.append(Symbol(kind, letter[0], letter[0].span))
            if letter[2]:
                self._superscript(letter[2], end, result)
            return letter[1]
        readers: dict[str, Callable[[int, int, list[Symbol]], int]] = {
            "command": self._command,
            "^": self._superscript,
            "{": self._group,
            "begin": self._matrix,
            "&": self._separator,
            "row": self._separator,
        }
        if token.kind in readers:
            return readers[token.kind](at, end, result)
        result.append(self._simple(at, result))
        return at + 1

    def _simple(self, at: int, result: list[Symbol]) -> Symbol:
        """The terminal of a token that is one by itself."""
        token = self.tokens[at]
        if token.kind in SIGNS:
            return Symbol(*SIGNS[token.kind], token.span)
        if token.kind in (",", "relation"):
            return Symbol("COMMA" if token.kind == "," else "RELATION", token.text, token.span)
        if token.kind in ("open", "close", "bar") and at in self.partner:
            is_open = self.partner[at] > at
            if token.kind == "open" and self._is_applied(at, result):
                self.applied |= {at, self.partner[at]}
            shape = "APPLY" if at in self.applied else SHAPES[token.text]
            return Symbol(shape + ("_OPEN" if is_open else "_CLOSE"), "", token.span)
        raise Unread(REASONS.get(token.kind, f"{token.text!r} cannot stand here"))

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
            raise Unread(AMBIGUOUS)
        return not end_of_argument and result[-1].value.name != "partial"

    def _number(self, at: int, end: int, result: list[Symbol]) -> int:
        start, digits = at, ""
        while at < end:
            token = self.tokens[at]
            is_point = token.kind == "." and self.kind(at + 1, end) == "digit"
            if [t.kind for t in self.tokens[at : at + 4]] == ["{", ",", "}", "digit"]:
                digits += "."
                at += 3
            elif token.kind == "digit" or (is_point and "." not in digits):
                digits += token.text
                at += 1
            else:
                break
        behind = "".join(token.text for token in self.tokens[at : min(at + 3, end)])
        if re.fullmatch(r"[eE][+-]\d", behind):
            raise Unread("a number with an exponent behind e")
        span = self.tokens[start].span[0], self.tokens[at - 1].span[1]
        result.append(Symbol("NUMBER", Number(digits, span), span))
        return at

    def _function(self, name: str, start: int, at: int, end: int, result: list[Symbol]) -> int:
        span = self.tokens[start].span[0], self.tokens[at - 1].span[1]
        script = self.skip(at, end)
        if self.kind(script, end) == "_":
            raise Unread("the base of a logarithm" if name == "log" else "an index of a function")
        if self.kind(script, end) == "'":
            raise Unread("a prime behind a function")
        if self.kind(script, end) == "^" and name in INVERTIBLE:
            first, stop, after = self.argument(script + 1, end)
            if self.texts(first, stop) == ["-", "1"]:
                name, at = f"a{name}", after
        result.append(Symbol("FUNCTION", name, span))
        return at

    # --- arguments, groups and matrices

    def _argument(self, at: int, end: int, result: list[Symbol]) -> int:
        """The terminals of an argument of a command; its place includes its braces."""
        start, stop, after = self.argument(at, end)
        return self._enclosed(start, stop, after, result)

    def _enclosed(self, start: int, stop: int, after: int, result: list[Symbol]) -> int:
        inner = self._between(start, stop)
        if not inner:
            raise Unread("an argument is empty")
        left, right = self.tokens[start].span[0], self.tokens[after - 1].span[1]
        result.append(Symbol("ARGUMENT_OPEN", "", (left, left)))
        result += inner
        result.append(Symbol("ARGUMENT_CLOSE", "", (right, right)))
        return after

    def _group(self, at: int, end: int, result: list[Symbol]) -> int:
        if at not in self.partner:
            raise Unread("a brace is never closed")
        stop = self.partner[at]
        first, last = self.skip(at + 1, stop), self._skip_back(stop - 1)
        if self.kind(first, stop) == "open" and self.partner.get(first) == last:
            return self._bracket_in_braces(at, first, last, result)
        inner = self._between(at + 1, stop)
        if len(inner) == 1 and inner[0].type in ("SIGN", "TIMES", "SLASH", "COMMA"):
            result += inner  # {+}
        elif inner:
            self._grouped(at, inner, stop, result)
        return stop + 1

    def _skip_back(self, at: int) -> int:
        while self.tokens[at].kind == "space":
            at -= 1
        return at

    def _bracket_in_braces(self, at: int, first: int, last: int, result: list[Symbol]) -> int:
        r"""Brackets in braces are brackets, as in ``\theta{\left(t\right)}``."""
        inner = self._between(first + 1, last)
        opening = self._simple(first, result)
        start, end = self.tokens[at].span[0], self.tokens[self.partner[at]].span[1]
        result.append(replace(opening, span=(start, opening.span[1])))
        result += inner
        closing = self._simple(last, result)
        result.append(replace(closing, span=(closing.span[0], end)))
        return self.partner[at] + 1

    def _grouped(self, at: int, inner: list[Symbol], stop: int, result: list[Symbol]) -> None:
        result.append(Symbol("GROUP_OPEN", "", self.tokens[at].span))
        result += inner
        result.append(Symbol("GROUP_CLOSE", "", self.tokens[stop].span))

    def _matrix(self, at: int, end: int, result: list[Symbol]) -> int:
        token = self.tokens[at]
        if token.text in ("cases", "dcases"):
            raise Unread("a definition by cases")
        if at not in self.partner:
            raise Unread(REASONS["begin"])
        stop = self.partner[at]
        places = inside(at, stop, self.partner)
        self.entries |= {place for place in places if self.tokens[place].kind in ("&", "row")}
        inner = self._between(at + 1, stop)
        while inner and inner[-1].type == "ROW":
            inner.pop()
        result.append(Symbol("MATRIX_OPEN", token.text, token.span))
        result += inner
        result.append(Symbol("MATRIX_CLOSE", "", self.tokens[stop].span))
        return stop + 1

    def _separator(self, at: int, end: int, result: list[Symbol]) -> int:
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
                raise Unread("a new row in brackets")
        return at + 1

    # --- commands

    def _command(self, at: int, end: int, result: list[Symbol]) -> int:
        token = self.tokens[at]
        name = token.text
        if name in FRACTIONS:
            result.append(Symbol("FRACTION", "", token.span))
            return self._argument(self._argument(at + 1, end, result), end, result)
        if name in ACCENTS:
            result.append(Symbol("DOTS", ACCENTS[name], token.span))
            return self._argument(at + 1, end, result)
        if name in FONTS:
            return self._font(at, end, result)
        if name == "sqrt":
            return self._root(at, end, result)
        if name == "sum":
            return self._sum(at, end, result)
        if name in TIMES or name in SLASHES or name == "over":
            kind = "OVER" if name == "over" else "TIMES" if name in TIMES else "SLASH"
            result.append(Symbol(kind, name, token.span))
            return at + 1
        if name in MARKS:
            raise Unread(rf"\{name} over an expression that is no letter")
        raise Unread(REASONS.get(name, rf"the command \{name} is not known"))

    def _font(self, at: int, end: int, result: list[Symbol]) -> int:
        start, stop, after = self.argument(at + 1, end)
        was_bold, self.is_bold = self.is_bold, self.is_bold or self.tokens[at].text in BOLD
        inner = self._between(start, stop)
        self.is_bold = was_bold
        if inner:
            self._grouped(at, inner, after - 1, result)
        return after

    def _root(self, at: int, end: int, result: list[Symbol]) -> int:
        degree, start = 2, self.skip(at + 1, end)
        token = self.tokens[min(start, end - 1)]
        if token.kind == "open" and start in self.partner:
            stop = self.partner[start]
            if token.text == "(":  # √(x)
                result.append(Symbol("ROOT", degree, self.tokens[at].span))
                return self._enclosed(start, stop + 1, stop + 1, result)
            text = "".join(self.texts(start + 1, stop))
            if not re.fullmatch(r"[2-9]", text):
                raise Unread("the degree of a root is not one of 2 to 9")
            degree, start = int(text), stop + 1
        result.append(Symbol("ROOT", degree, self.tokens[at].span))
        return self._argument(start, end, result)

    def _sum(self, at: int, end: int, result: list[Symbol]) -> int:
        result.append(Symbol("SUM", "", self.tokens[at].span))
        bounds: dict[str, list[Symbol]] = {"_": [], "^": []}
        at = self.skip(at + 1, end)
        while (kind := self.kind(at, end)) in bounds:
            if bounds[kind]:
                raise Unread("two lower or two upper bounds of a sum")
            name = "LOWER" if kind == "_" else "UPPER"
            bounds[kind].append(Symbol(name, "", self.tokens[at].span))
            at = self.skip(self._argument(at + 1, end, bounds[kind]), end)
        result += bounds["_"] + bounds["^"]
        return at

    def _superscript(self, at: int, end: int, result: list[Symbol]) -> int:
        start, stop, after = self.argument(at + 1, end)
        span = self.tokens[at].span[0], self.tokens[after - 1].span[1]
        texts = self.texts(start, stop)
        if texts in (["T"], ["top"], ["intercal"]):
            result.append(Symbol("TRANSPOSED", "", span))
            return after
        if texts in (["-", "T"], ["-", "top"]):
            raise Unread("the transpose of an inverse")
        if texts and set(texts) <= {"'", "prime"}:
            raise Unread(REASONS["'"])
        if self.kind(self.skip(start, stop), stop) == "open" and len(texts) == 3:
            raise Unread("a number in brackets in the place of an exponent")
        if self.kind(after, end) == "digit" and self.tokens[after - 1].kind == "digit":
            raise Unread("a digit behind an exponent without braces")
        result.append(Symbol("POWER", "", self.tokens[at].span))
        if len(texts) == 1 and texts[0] in STARS:
            star = Letter(STARS[texts[0]], self.tokens[start].span)
            kinds = ("ARGUMENT_OPEN", "LATIN", "ARGUMENT_CLOSE")
            result += [Symbol(kind, star, span) for kind in kinds]
            return after
        return self._argument(at + 1, end, result)


def _type(letter: Letter) -> str:
    """The kind of a letter: with dots, the time t, Greek, or any other."""
    if letter.dots:
        return "ACCENTED"
    if letter.identifier == "t" and not letter.primes:
        return "TIME"
    name = re.sub(r"(?:bar|hat|tilde|check|breve|ring|under)+$", "", letter.name)
    return "GREEK" if letter.name in GREEK or name in GREEK else "LATIN"
