"""The arguments of commands, and the depth to which they stand within one another."""

from collections.abc import Iterator
from contextlib import contextmanager

from derive.reading.latex.layout.latex_symbols import ACCENTS, FONTS, FRACTIONS, MARKS
from derive.reading.latex.layout.pairs import MAX_DEPTH, pairs
from derive.reading.latex.layout.tokens import Token, UnreadError

#: Kinds of tokens that are no argument.
NO_ARGUMENT = frozenset({"&", "row", "^", "_", "}", "begin", "end", "open", "close", "relation"})


class Arguments:
    """Tokens with the places of arguments."""

    def __init__(self, tokens: list[Token]) -> None:
        self.tokens = tokens
        self.partner = pairs(tokens)
        self.depth = 0

    @contextmanager
    def deeper(self) -> Iterator[None]:
        """One expression within another; raises `UnreadError` if there are too many."""
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise UnreadError(f"more than {MAX_DEPTH} expressions within one another")
        yield
        self.depth -= 1

    def skip(self, at: int, end: int) -> int:
        """The first token from a place on that is no space."""
        while at < end and self.tokens[at].kind == "space":
            at += 1
        return at

    def kind(self, at: int, end: int) -> str:
        """The kind of a token, empty behind the end."""
        return self.tokens[at].kind if at < end else ""

    def argument(self, at: int, end: int) -> tuple[int, int, int]:
        """Where the content of an argument starts and ends, and the token after it."""
        at = self.skip(at, end)
        kind = self.kind(at, end)
        if not kind or kind in NO_ARGUMENT:
            raise UnreadError("an argument is missing")
        if kind == "{":
            if at not in self.partner:
                raise UnreadError("a brace is never closed")
            return at + 1, self.partner[at], self.partner[at] + 1
        stop = at + 1
        if kind == "command":  # takes its own arguments with it
            name = self.tokens[at].text
            count = 2 if name in FRACTIONS else int(name in UNARY)
            with self.deeper():
                for _ in range(count):
                    stop = self.argument(stop, end)[2]
        return at, stop, stop

    def texts(self, start: int, stop: int) -> list[str]:
        """The texts of tokens without spaces, braces and fonts."""
        return [
            token.text
            for token in self.tokens[start:stop]
            if token.kind not in ("space", "{", "}") and token.text not in FONTS
        ]


UNARY = frozenset({*ACCENTS, *MARKS, *FONTS, "sqrt"})
