r"""The terminals of the grammar, from tokens.

Of a bare argument, as in ``\sin 2\theta l``, the grammar takes numbers and Latin letters up to and
including the first Greek letter, and a ``t`` behind it: the terminals tell these kinds apart.
"""

import re
from typing import TYPE_CHECKING

from derive.reading.latex.grammar.enclosures import REASONS, Enclosures
from derive.reading.latex.grammar.letter_grammar import AMBIGUOUS, ends_bare_argument, function_at
from derive.reading.latex.grammar.written_nodes import Symbol
from derive.reading.latex.layout.latex_symbols import (
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
from derive.reading.latex.layout.tokens import UnreadError
from derive.reading.latex.tree import Letter, Number

if TYPE_CHECKING:
    from collections.abc import Callable

STARS = {"*": "star", "star": "star", "ast": "star", "dagger": "dagger", "circ": "circ"}


class Terminals(Enclosures):
    """A reader of the tokens of one side of a statement."""

    def all(self) -> list[Symbol]:
        """All terminals, in order."""
        return self.between(0, len(self.tokens))

    def between(self, start: int, end: int) -> list[Symbol]:
        """The terminals of some of the tokens."""
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
                raise UnreadError(AMBIGUOUS)
            result.append(Symbol(kind, letter[0], letter[0].span))
            if letter[2]:
                self._superscript(letter[2], end, result)
            return letter[1]
        readers: dict[str, Callable[[int, int, list[Symbol]], int]] = {
            "command": self._command,
            "^": self._superscript,
            "{": self.group,
            "begin": self.matrix,
            "&": self.separator,
            "row": self.separator,
        }
        if token.kind in readers:
            return readers[token.kind](at, end, result)
        result.append(self.simple(at, result))
        return at + 1

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
            raise UnreadError("a number with an exponent behind e")
        span = self.tokens[start].span[0], self.tokens[at - 1].span[1]
        result.append(Symbol("NUMBER", Number(digits, span), span))
        return at

    def _function(self, name: str, start: int, at: int, end: int, result: list[Symbol]) -> int:
        span = self.tokens[start].span[0], self.tokens[at - 1].span[1]
        script = self.skip(at, end)
        if self.kind(script, end) == "_":
            raise UnreadError(
                "the base of a logarithm" if name == "log" else "an index of a function"
            )
        if self.kind(script, end) == "'":
            raise UnreadError("a prime behind a function")
        if self.kind(script, end) == "^" and name in INVERTIBLE:
            first, stop, after = self.argument(script + 1, end)
            if self.texts(first, stop) == ["-", "1"]:
                name, at = f"a{name}", after
        result.append(Symbol("FUNCTION", name, span))
        return self._exponent_in_brackets(at, end, result)

    def _exponent_in_brackets(self, at: int, end: int, result: list[Symbol]) -> int:
        r"""Read the exponent of a function of the package physics: ``\sin[2](x)`` is sin² x."""
        start = self.skip(at, end)
        stop = self.partner.get(start, start)
        digits = "".join(self.texts(start + 1, stop))
        has_argument = self.kind(self.skip(stop + 1, end), end) == "open"
        if not (digits.isdigit() and self.tokens[start].text == "[" and has_argument):
            return at
        span = self.tokens[start].span[0], self.tokens[stop].span[1]
        exponent = ("POWER", ""), ("ARGUMENT_OPEN", ""), ("NUMBER", Number(digits, span))
        result += [Symbol(kind, one, span) for kind, one in (*exponent, ("ARGUMENT_CLOSE", ""))]
        return stop + 1

    # --- commands

    def _command(self, at: int, end: int, result: list[Symbol]) -> int:
        token = self.tokens[at]
        name = token.text
        if name in FRACTIONS:
            result.append(Symbol("FRACTION", "", token.span))
            return self.read_argument(self.read_argument(at + 1, end, result), end, result)
        if name in ACCENTS:
            result.append(Symbol("DOTS", ACCENTS[name], token.span))
            return self.read_argument(at + 1, end, result)
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
            raise UnreadError(rf"\{name} over an expression that is no letter")
        raise UnreadError(REASONS.get(name, rf"the command \{name} is not known"))

    def _font(self, at: int, end: int, result: list[Symbol]) -> int:
        start, stop, after = self.argument(at + 1, end)
        was_bold, self.is_bold = self.is_bold, self.is_bold or self.tokens[at].text in BOLD
        inner = self.between(start, stop)
        self.is_bold = was_bold
        if inner:
            self.grouped(at, inner, after - 1, result)
        return after

    def _root(self, at: int, end: int, result: list[Symbol]) -> int:
        degree, start = 2, self.skip(at + 1, end)
        token = self.tokens[min(start, end - 1)]
        if token.kind == "open" and start in self.partner:
            stop = self.partner[start]
            if token.text == "(":  # √(x)
                result.append(Symbol("ROOT", degree, self.tokens[at].span))
                return self.enclosed(start, stop + 1, stop + 1, result)
            text = "".join(self.texts(start + 1, stop))
            if not re.fullmatch(r"[2-9]", text):
                raise UnreadError("the degree of a root is not one of 2 to 9")
            degree, start = int(text), stop + 1
        result.append(Symbol("ROOT", degree, self.tokens[at].span))
        return self.read_argument(start, end, result)

    def _sum(self, at: int, end: int, result: list[Symbol]) -> int:
        result.append(Symbol("SUM", "", self.tokens[at].span))
        bounds: dict[str, list[Symbol]] = {"_": [], "^": []}
        at = self.skip(at + 1, end)
        while (kind := self.kind(at, end)) in bounds:
            if bounds[kind]:
                raise UnreadError("two lower or two upper bounds of a sum")
            name = "LOWER" if kind == "_" else "UPPER"
            bounds[kind].append(Symbol(name, "", self.tokens[at].span))
            at = self.skip(self.read_argument(at + 1, end, bounds[kind]), end)
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
            raise UnreadError("the transpose of an inverse")
        if texts and set(texts) <= {"'", "prime"}:
            raise UnreadError(REASONS["'"])
        if self.kind(self.skip(start, stop), stop) == "open" and len(texts) == 3:
            raise UnreadError("a number in brackets in the place of an exponent")
        if self.kind(after, end) == "digit" and self.tokens[after - 1].kind == "digit":
            raise UnreadError("a digit behind an exponent without braces")
        result.append(Symbol("POWER", "", self.tokens[at].span))
        if len(texts) == 1 and texts[0] in STARS:
            star = Letter(STARS[texts[0]], self.tokens[start].span)
            kinds = ("ARGUMENT_OPEN", "LATIN", "ARGUMENT_CLOSE")
            result += [Symbol(kind, star, span) for kind in kinds]
            return after
        return self.read_argument(at + 1, end, result)


def _type(letter: Letter) -> str:
    """The kind of a letter: with dots, the time t, Greek, or any other."""
    if letter.dots:
        return "ACCENTED"
    if letter.identifier == "t" and not letter.primes:
        return "TIME"
    name = re.sub(r"(?:bar|hat|tilde|check|breve|ring|under)+$", "", letter.name)
    return "GREEK" if letter.name in GREEK or name in GREEK else "LATIN"
