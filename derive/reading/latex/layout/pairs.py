"""Brackets, braces, bars and environments with their partners, and arguments of commands."""

from collections.abc import Iterator
from contextlib import contextmanager

from derive.reading.latex.layout.latex_symbols import (
    ACCENTS,
    FONTS,
    FRACTIONS,
    MARKS,
    SLASHES,
    TIMES,
)
from derive.reading.latex.layout.tokens import Token, UnreadError

#: Brackets within brackets.
MAX_DEPTH = 60
OPENERS = {"{": "}", "open": "close", "begin": "end"}


def pairs(tokens: list[Token]) -> dict[int, int]:
    """The partner of each bracket, brace, bar and environment that has one.

    Raises
    ------
    Unread
        If more than `MAX_DEPTH` of them stand within one another.
    """
    partner: dict[int, int] = {}
    stack: list[int] = []
    for at, token in enumerate(tokens):
        if token.kind in OPENERS:
            stack.append(at)
        elif token.kind == "bar":
            is_open = bool(stack) and tokens[stack[-1]].kind == "bar"
            if is_open and not _awaits(tokens, at, partner):
                _join(partner, stack.pop(), at)
            else:
                stack.append(at)
        elif token.kind in ("}", "close", "end"):
            while stack and tokens[stack[-1]].kind == "bar":
                stack.pop()
            if token.kind == "end" and any(_fits(tokens[one], token) for one in stack):
                while tokens[stack[-1]].kind == "open":  # never closed, in one of the rows
                    stack.pop()
            if stack and _fits(tokens[stack[-1]], token):
                _join(partner, stack.pop(), at)
        if len(stack) > MAX_DEPTH:
            raise UnreadError(f"more than {MAX_DEPTH} brackets within one another")
    return partner


def _join(partner: dict[int, int], start: int, end: int) -> None:
    partner[start], partner[end] = end, start


def _fits(start: Token, end: Token) -> bool:
    return OPENERS.get(start.kind) == end.kind and (start.kind == "{" or start.text == end.text)


def _awaits(tokens: list[Token], at: int, partner: dict[int, int]) -> bool:
    """Whether an expression must follow the tokens before a place."""
    for before in range(at - 1, max(-1, at - 9), -1):
        token = tokens[before]
        if token.kind == "bar":
            return partner.get(before, at) >= before
        if token.kind not in ("space", "gap"):
            return is_operator(token) or token.kind in ("relation", "open", "{")
    return True


def is_operator(token: Token) -> bool:
    """Whether a token is a sign between two terms or factors."""
    return token.kind in ("+", "-", "*", "/") or (
        token.kind == "command" and (token.text in TIMES or token.text in SLASHES)
    )


def inside(start: int, end: int, partner: dict[int, int]) -> list[int]:
    """Places between two brackets, but for those in further brackets between them."""
    places = []
    at = start + 1
    while at < end:
        places.append(at)
        at = max(at, partner.get(at, at)) + 1
    return places


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
