"""Tokens with arguments, before their layout is left out."""

from derive.reading.latex.layout.tokens import Token, UnreadError


class Cursor:
    """Tokens of a display, and places in them."""

    def __init__(self, tokens: list[Token]) -> None:
        self.tokens = tokens

    def star(self, at: int) -> int:
        """The token after a star, if there is one."""
        return at + 1 if at < len(self.tokens) and self.tokens[at].kind == "*" else at

    def skip(self, at: int) -> int:
        """The first token from a place on that is no space."""
        while at < len(self.tokens) and self.tokens[at].kind == "space":
            at += 1
        return at

    def end_of_argument(self, at: int) -> int:
        """The token after the argument at a place."""
        start = self.skip(at)
        if start >= len(self.tokens):
            raise UnreadError("an argument is missing at the end")
        if self.tokens[start].kind != "{":
            return start + 1
        depth = 0
        for end in range(start, len(self.tokens)):
            depth += {"{": 1, "}": -1}.get(self.tokens[end].kind, 0)
            if depth == 0:
                return end + 1
        raise UnreadError("a brace is never closed")

    def source(self, start: int, end: int) -> str:
        """The text of tokens without outer braces, spaces as they stand."""
        tokens = self.tokens[self.skip(start) : end]
        if tokens and tokens[0].kind == "{":
            tokens = tokens[1:-1]
        return "".join(f"\\{t.text}" if t.kind == "command" else t.text for t in tokens)
