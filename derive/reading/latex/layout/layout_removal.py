r"""Tokens without layout: spaces, labels, colours, sizes of brackets, boxes and braces below.

Further kinds of tokens arise: ``word`` (``\text{kin}``), ``prose`` (``\text{and hence}``), ``gap``
(``\quad``), ``open``, ``close`` and ``bar`` (brackets), ``begin`` and ``end`` of an environment,
``relation``.
"""

import re
from dataclasses import replace

from derive.reading.latex.layout.latex_symbols import (
    BRACKETS,
    CONNECTIVES,
    FRAMES,
    GAPS,
    LAYOUT,
    MATRICES,
    RELATIONS,
    SEPARATORS,
    SPACES,
    TEXT,
    UPRIGHT,
)
from derive.reading.latex.layout.pairs import is_operator
from derive.reading.latex.layout.tokens import Token, UnreadError, argument, skip_spaces
from derive.reading.latex.tree import Span

#: Lengths from which a space separates statements, in each unit.
WIDE = {"cm": 0.5, "mm": 5, "em": 1, "ex": 2, "pt": 10, "in": 0.2, "mu": 18}


#: Abbreviations of energies.
ENERGY = re.compile(r"[KPTkp]\.[Ee]\.")


class Layout:
    """A reader of the tokens of a display."""

    def __init__(self, tokens: list[Token]) -> None:
        self.tokens = tokens
        self.result: list[Token] = []
        self._opened: list[int] = []  # places of \left in the result

    def tokens_without_layout(self) -> list[Token]:
        """The tokens that carry a meaning."""
        at = 0
        while at < len(self.tokens):
            at = self._read(at)
        return self.result

    def star(self, at: int) -> int:
        """The token after a star, if there is one."""
        return at + 1 if at < len(self.tokens) and self.tokens[at].kind == "*" else at

    def skip(self, at: int) -> int:
        """The first token from a place on that is no space."""
        return skip_spaces(self.tokens, at)

    def end_of_argument(self, at: int) -> int:
        """The token after the argument at a place."""
        if self.skip(at) >= len(self.tokens):
            raise UnreadError("an argument is missing at the end")
        if (result := argument(self.tokens, at)) is None:
            raise UnreadError("a brace is never closed")
        return result[1]

    def source(self, start: int, end: int) -> str:
        """The text of tokens without outer braces, spaces as they stand."""
        tokens = self.tokens[self.skip(start) : end]
        if tokens and tokens[0].kind == "{":
            tokens = tokens[1:-1]
        return "".join(f"\\{t.text}" if t.kind == "command" else t.text for t in tokens)

    def _read(self, at: int) -> int:
        token = self.tokens[at]
        if token.kind == "command":
            return self._command(token, at + 1)
        if token.kind in (":", "=", "<", ">"):
            return self._relation(token, at + 1)
        if token.kind in BRACKETS:
            kind, shape = BRACKETS[token.kind]
            self.result.append(Token(kind, shape, token.span))
        elif ENERGY.fullmatch(abbreviation := "".join(t.text for t in self.tokens[at : at + 4])):
            span = token.span[0], self.tokens[at + 3].span[1]
            self.result.append(Token("word", abbreviation.replace(".", ""), span))
            return at + 4
        elif token.kind == "~":
            self.result.append(Token("space", "~", token.span))
        else:
            self.result.append(token)
        return at + 1

    def _relation(self, token: Token, at: int) -> int:
        pair = token.text + (self.tokens[at].text if at < len(self.tokens) else "")
        if pair in (":=", "=:"):
            span = token.span[0], self.tokens[at].span[1]
            self.result.append(Token("relation", RELATIONS[pair], span))
            return at + 1
        self.result.append(Token("relation", RELATIONS[token.text], token.span))
        return at

    def _command(self, token: Token, at: int) -> int:
        name = token.text
        if name in RELATIONS and name.isalpha():
            self.result.append(Token("relation", RELATIONS[name], token.span))
        elif name == "not":
            at = self.skip(at)
            if at >= len(self.tokens) or self.tokens[at].text != "=":
                raise UnreadError(r"\not is read before = alone")
            self.result.append(Token("relation", "!=", token.span))
            at += 1
        elif name in ("left", "right", *SIZES):
            return self._bracket(token, at)
        elif "\\" + name in BRACKETS:
            kind, shape = BRACKETS["\\" + name]
            self.result.append(Token(kind, shape, token.span))
        elif name in SEPARATORS:
            self.result.append(Token(";", name, token.span))
        elif name in GAPS:
            self.result.append(Token("gap", " ", token.span))
        elif name in SPACES or name.isspace():
            self.result.append(Token("space", "~", token.span))
        elif name in ("hspace", "hskip", "kern", "mkern", "mskip"):
            return self._space(token, at)
        elif name in ("begin", "end"):
            return self._environment(token, at)
        elif name in MATRICES and self._opens_group(at):
            return self._plain_matrix(token, at)
        elif name in TEXT or name in ("intertext", "shortintertext") or name in UPRIGHT:
            return self._text(token, at)
        elif name in ("binom", "dbinom", "tbinom"):
            return self._column(token, at)
        elif name in ("underbrace", "overbrace"):
            return self._brace(token, at)
        elif name in ("stackrel", "overset", "underset"):
            return self._over_relation(token, at)
        elif name == "underline" and self._is_long(at):
            return self._frame(token, at)
        elif name in LAYOUT:
            at = self.star(at)
            for _ in range(LAYOUT[name]):
                at = self.end_of_argument(at)
            if name in FRAMES:
                return self._frame(token, at)
        else:
            self.result.append(token)
        return at

    def _is_long(self, at: int) -> bool:
        """Whether an argument in braces is no single letter."""
        inside, _ = argument(self.tokens, at) or ((at, at), at)
        return sum(one.kind != "space" for one in self.tokens[slice(*inside)]) > 1

    def _frame(self, token: Token, at: int) -> int:
        """The brace behind a command that frames its content belongs to the command."""
        brace = self.skip(at)
        if brace >= len(self.tokens) or self.tokens[brace].kind != "{":
            return at
        self.result.append(replace(self.tokens[brace], span=token.span))
        return brace + 1

    def _bracket(self, token: Token, at: int) -> int:
        """A bracket with its size; no bracket stands beside a point."""
        at = self.skip(at)
        if at >= len(self.tokens):
            raise UnreadError(rf"\{token.text} has no bracket")
        bracket = self.tokens[at]
        name = "\\" + bracket.text if bracket.kind == "command" else bracket.kind
        span = token.span[0], bracket.span[1]
        if name == "." and token.text in ("left", "right"):
            self._pair(token)
            self.result.append(Token("null", token.text, span))
            return at + 1
        if name not in BRACKETS:
            if token.text in ("left", "right"):
                raise UnreadError(rf"\{token.text} has no bracket")
            return at
        kind, shape = BRACKETS[name]
        start = self._pair(token)
        if kind == "bar" and start is not None and self.result[start].kind == "null":
            self.result[start] = replace(self.result[start], kind="open", text="place")
            self.result.append(Token("close", "place", span))
            return self._behind_scripts(at + 1)
        side = {"l": "open", "r": "close"}.get(token.text[-1], "")
        if token.text in ("left", "right"):
            side = "open" if token.text == "left" else "close"
        if kind == "bar" and side:
            kind = side
        elif kind == "bar" and token.text.endswith("m"):
            kind = "middle"
        self.result.append(Token(kind, shape, span))
        return at + 1

    def _pair(self, token: Token) -> int | None:
        r"""The place in the result of the \left of a \right."""
        if token.text == "left":
            self._opened.append(len(self.result))
        is_end = token.text == "right" and self._opened
        return self._opened.pop() if is_end else None

    def _behind_scripts(self, at: int) -> int:
        """The token behind an index and an exponent."""
        after = self.skip(at)
        while after < len(self.tokens) and self.tokens[after].kind in "_^":
            at = self.end_of_argument(after + 1)
            after = self.skip(at)
        return at

    def _space(self, token: Token, at: int) -> int:
        start = self.star(at)
        end = self.end_of_argument(start)
        if self.tokens[self.skip(start)].kind != "{":  # \kern2pt
            while end < len(self.tokens) and re.fullmatch(r"[\d.a-z-]", self.tokens[end].text):
                end += 1
        length = re.fullmatch(r"\s*(-?[\d.]+)\s*([a-z]{2})\s*", self.source(start, end))
        is_wide = length is not None and _number(length[1]) >= WIDE.get(length[2], 1e9)
        self.result.append(Token("gap" if is_wide else "space", " ", token.span))
        return end

    def _environment(self, token: Token, at: int) -> int:
        end = self.end_of_argument(at)
        name = self.source(at, end).strip().removesuffix("*")
        option = "".join(t.text for t in self.tokens[end : end + 3])
        if token.text == "begin" and option in ("[t]", "[b]", "[c]"):
            end += len(option)
        if token.text == "begin" and name in ("array", "alignat", "alignedat", "IEEEeqnarray"):
            end = self.end_of_argument(end)
        last = self.tokens[end - 1].span[1]
        self.result.append(Token(token.text, name, (token.span[0], last)))
        return end

    def _opens_group(self, at: int) -> bool:
        at = self.skip(at)
        return at < len(self.tokens) and self.tokens[at].kind == "{"

    def _plain_matrix(self, token: Token, at: int) -> int:
        r"""The matrix ``\pmatrix{a & b \cr c & d}`` of plain TeX as an environment."""
        start, end = self.skip(at), self.end_of_argument(at)
        last = self.tokens[end - 1].span
        self.result.append(Token("begin", token.text, token.span))
        self.result += Layout(self.tokens[start + 1 : end - 1]).tokens_without_layout()
        self.result.append(Token("end", token.text, last))
        return end

    def _column(self, token: Token, at: int) -> int:
        r"""The column of two entries that ``\binom{a}{b}`` is in mechanics, as an environment."""
        middle = self.end_of_argument(at)
        end = self.end_of_argument(middle)
        last = self.tokens[end - 1].span
        self.result.append(Token("begin", "pmatrix", token.span))
        for start, stop in ((at, middle), (middle, end)):
            inner = self.tokens[self.skip(start) : stop]
            inner = inner[1:-1] if inner[0].kind == "{" else inner
            self.result += Layout(inner).tokens_without_layout()
            self.result.append(Token("row", "", (inner[-1].span[1],) * 2))
        self.result[-1] = Token("end", "pmatrix", last)
        return end

    def _text(self, token: Token, at: int) -> int:
        at = self.star(at)
        end = self.end_of_argument(at)
        span = token.span[0], max(token.span[1], self.tokens[end - 1].span[1])
        words = words_of(self.source(at, end), span, token.text in UPRIGHT, self._is_operand())
        if words is None:  # \mathrm{x + 1}
            self.result.append(replace(token, text="mathrm"))
            return at
        self.result += words
        return end

    def _is_operand(self) -> bool:
        r"""Whether an expression must come next, such as ``\text{losses of heat}`` behind +."""
        before = next(
            (t for t in reversed(self.result) if t.kind not in ("space", "gap", "&")), None
        )
        return before is not None and (before.kind == "relation" or is_operator(before))

    def _brace(self, token: Token, at: int) -> int:
        """A brace over or under an expression, whose label is left out."""
        end = self.end_of_argument(at)
        inner = Layout(self.tokens[at:end]).tokens_without_layout()
        label = self.skip(end)
        if label < len(self.tokens) and self.tokens[label].kind in "_^":
            end = self.end_of_argument(label + 1)
        last = self.tokens[end - 1].span[1]
        self.result.append(Token("{", "{", token.span))
        self.result += inner
        self.result.append(Token("}", "}", (last, last)))
        return end

    def _over_relation(self, token: Token, at: int) -> int:
        middle = self.end_of_argument(at)
        end = self.end_of_argument(middle)
        inner = Layout(self.tokens[middle:end]).tokens_without_layout()
        relations = [t for t in inner if t.kind == "relation"]
        if len(relations) != 1:
            raise UnreadError(rf"\{token.text} is read over a relation alone")
        is_definition = "def" in self.source(at, middle) and relations[0].text == "="
        span = token.span[0], self.tokens[end - 1].span[1]
        self.result.append(Token("relation", ":=" if is_definition else relations[0].text, span))
        return end


SIZES = frozenset(f"{size}{side}" for size in "big Big bigg Bigg".split() for side in ("", *"lrm"))


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return 0.0


def words_of(text: str, span: Span, is_upright: bool, is_operand: bool) -> list[Token] | None:
    r"""The tokens of upright text: a word is a letter, several words are prose.

    Several words where an expression must come are a letter, too.

    Parameters
    ----------
    text
        The argument of the command.
    span
        The place of the command with its argument.
    is_upright
        Whether the command is one of formulas, such as ``\mathrm``.
    is_operand
        Whether an expression must come here, such as behind +.

    Returns
    -------
    list or None
        None for a formula in upright letters, such as ``\mathrm{x + 1}``.
    """
    words = re.sub(r"[~\s]+|\\[ ,;:]|\\q?quad", " ", text).strip(" ,.;:")
    is_differential = is_upright and re.fullmatch(r"d[a-z]", words)  # \mathrm{dt}
    is_word = re.fullmatch(r"[A-Za-z][A-Za-z0-9_'-]*", words)
    if not words:
        sign = text.strip()
        is_wide = bool(text.strip(" ")) and not is_upright
        kind = sign if sign in tuple(",.;:") else "gap" if is_wide else "space"
        return [Token(kind, kind, span)]
    if re.fullmatch(r"[A-Za-z]", words) or is_differential:
        return [Token("letter", letter, span) for letter in words]
    if (is_word and words.lower() not in CONNECTIVES) or (is_operand and not is_upright):
        return [Token("word", re.sub(r"\W+", "_", words), span)]
    return None if is_upright else [Token("prose", words, span)]
