r"""Tokens without layout: spaces, labels, colours, sizes of brackets, boxes and braces below.

Further kinds of tokens arise: ``word`` (``\text{kin}``), ``prose`` (``\text{and hence}``), ``gap``
(``\quad``), ``open``, ``close`` and ``bar`` (brackets), ``begin`` and ``end`` of an environment,
``relation``.
"""

import re
from dataclasses import replace

from derive.reading.latex.pairs import is_operator
from derive.reading.latex.symbols import (
    ACCENTS,
    BOLD,
    BRACKETS,
    CONNECTIVES,
    FRAMES,
    GAPS,
    LAYOUT,
    MARKS,
    RELATIONS,
    SCRIPT,
    SEPARATORS,
    SPACES,
    TEXT,
    UPRIGHT,
)
from derive.reading.latex.tokens import Token, Unread

#: Lengths from which a space separates statements, in each unit.
WIDE = {"cm": 0.5, "mm": 5, "em": 1, "ex": 2, "pt": 10, "in": 0.2, "mu": 18}
#: Commands of one argument that an index or an exponent without braces takes with it.
UNARY = {*ACCENTS, *MARKS, *BOLD, *UPRIGHT, *SCRIPT, *TEXT, "sqrt"}


#: Fonts that hold to the end of their braces.
OLD_FONTS = {
    "rm": "mathrm", "bf": "mathbf", "cal": "mathcal", "it": "mathit", "sf": "mathsf",
    "tt": "mathtt",
}  # fmt: skip


def with_new_fonts(tokens: list[Token]) -> list[Token]:
    r"""Tokens in which ``{\bf r}`` is ``\mathbf{r}``."""
    result: list[Token] = []
    for token in tokens:
        if token.kind == "command" and token.text in OLD_FONTS:
            brace = max(0, len(result) - 1)
            while brace and result[brace].kind == "space":
                brace -= 1
            if not result or result[brace].kind != "{":
                raise Unread(rf"\{token.text} does not stand behind a brace")
            font = replace(token, text=OLD_FONTS[token.text], span=result[brace].span)
            result.insert(brace, font)
        else:
            result.append(token)
    return result


class Layout:
    """A reader of the tokens of a display."""

    def __init__(self, latex: str, tokens: list[Token]) -> None:
        self.latex = latex
        self.tokens = tokens
        self.result: list[Token] = []
        self.removed_braces: set[int] = set()

    def tokens_without_layout(self) -> list[Token]:
        """The tokens that carry a meaning."""
        at = 0
        while at < len(self.tokens):
            at = self._read(at)
        return self.result

    def _read(self, at: int) -> int:
        token = self.tokens[at]
        if token.kind == "command":
            return self._command(token, at + 1)
        if token.kind in (":", "=", "<", ">"):
            return self._relation(token, at + 1)
        if token.kind in BRACKETS:
            kind, shape = BRACKETS[token.kind]
            self.result.append(Token(kind, shape, token.span))
        elif token.kind == "~":
            self.result.append(Token("space", "~", token.span))
        elif not (token.kind == "}" and at in self.removed_braces):
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
            at = self._skip(at)
            if at >= len(self.tokens) or self.tokens[at].text != "=":
                raise Unread(r"\not is read before = alone")
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
        elif name in TEXT or name in ("intertext", "shortintertext") or name in UPRIGHT:
            return self._text(token, at)
        elif name in ("underbrace", "overbrace"):
            return self._brace(token, at)
        elif name in ("stackrel", "overset", "underset"):
            return self._over_relation(token, at)
        elif name in LAYOUT:
            at = self._star(at)
            for _ in range(LAYOUT[name]):
                at = self._end_of_argument(at)
            if name in FRAMES:
                return self._frame(token, at)
        else:
            self.result.append(token)
        return at

    def _frame(self, token: Token, at: int) -> int:
        """The brace behind a command that frames its content belongs to the command."""
        brace = self._skip(at)
        if brace >= len(self.tokens) or self.tokens[brace].kind != "{":
            return at
        self.result.append(replace(self.tokens[brace], span=token.span))
        return brace + 1

    def _star(self, at: int) -> int:
        return at + 1 if at < len(self.tokens) and self.tokens[at].kind == "*" else at

    def _skip(self, at: int) -> int:
        while at < len(self.tokens) and self.tokens[at].kind == "space":
            at += 1
        return at

    def _end_of_argument(self, at: int) -> int:
        start = self._skip(at)
        if start >= len(self.tokens):
            raise Unread("an argument is missing at the end")
        if self.tokens[start].kind != "{":
            return start + 1
        depth = 0
        for end in range(start, len(self.tokens)):
            depth += {"{": 1, "}": -1}.get(self.tokens[end].kind, 0)
            if depth == 0:
                return end + 1
        raise Unread("a brace is never closed")

    def _source(self, start: int, end: int) -> str:
        """The text of tokens without outer braces, spaces as they stand."""
        tokens = self.tokens[self._skip(start) : end]
        if tokens and tokens[0].kind == "{":
            tokens = tokens[1:-1]
        return "".join(f"\\{t.text}" if t.kind == "command" else t.text for t in tokens)

    def _bracket(self, token: Token, at: int) -> int:
        """A bracket with its size; no bracket stands beside a point."""
        at = self._skip(at)
        if at >= len(self.tokens):
            raise Unread(rf"\{token.text} has no bracket")
        bracket = self.tokens[at]
        name = "\\" + bracket.text if bracket.kind == "command" else bracket.kind
        span = token.span[0], bracket.span[1]
        if name == "." and token.text in ("left", "right"):
            self.result.append(Token("null", token.text, span))
            return at + 1
        if name not in BRACKETS:
            if token.text in ("left", "right"):
                raise Unread(rf"\{token.text} has no bracket")
            return at
        kind, shape = BRACKETS[name]
        side = {"l": "open", "r": "close"}.get(token.text[-1], "")
        if token.text in ("left", "right"):
            side = "open" if token.text == "left" else "close"
        if kind == "bar" and side:
            kind = side
        elif kind == "bar" and token.text.endswith("m"):
            kind = "middle"
        self.result.append(Token(kind, shape, span))
        return at + 1

    def _space(self, token: Token, at: int) -> int:
        start = self._star(at)
        end = self._end_of_argument(start)
        if self.tokens[self._skip(start)].kind != "{":  # \kern2pt
            while end < len(self.tokens) and re.fullmatch(r"[\d.a-z-]", self.tokens[end].text):
                end += 1
        length = re.fullmatch(r"\s*(-?[\d.]+)\s*([a-z]{2})\s*", self._source(start, end))
        is_wide = length is not None and _number(length[1]) >= WIDE.get(length[2], 1e9)
        self.result.append(Token("gap" if is_wide else "space", " ", token.span))
        return end

    def _environment(self, token: Token, at: int) -> int:
        end = self._end_of_argument(at)
        name = self._source(at, end).strip().removesuffix("*")
        if end < len(self.tokens) and self.tokens[end].kind == "[" and token.text == "begin":
            end = 1 + next(
                (
                    i
                    for i in range(end, min(end + 9, len(self.tokens)))
                    if self.tokens[i].kind == "]"
                ),
                end - 1,
            )
        if token.text == "begin" and name in ("array", "alignat", "alignedat", "IEEEeqnarray"):
            end = self._end_of_argument(end)
        last = self.tokens[end - 1].span[1]
        self.result.append(Token(token.text, name, (token.span[0], last)))
        return end

    def _text(self, token: Token, at: int) -> int:
        """Upright text: a word is a letter or a function, several words are prose."""
        at = self._star(at)
        end = self._end_of_argument(at)
        text = self._source(at, end)
        span = token.span[0], max(token.span[1], self.tokens[end - 1].span[1])
        words = re.sub(r"[~\s]+|\\[ ,;:]|\\q?quad", " ", text).strip(" ,.;:")
        is_text = token.text not in UPRIGHT
        is_word = re.fullmatch(r"[A-Za-z][A-Za-z0-9_'-]*", words)
        if not words:
            self.result.append(Token("gap" if is_text and text.strip(" ") else "space", " ", span))
            if text.strip() in tuple(",.;:"):
                self.result[-1] = Token(text.strip(), text.strip(), span)
        elif re.fullmatch(r"[A-Za-z]", words) or (
            re.fullmatch(r"d[a-z]", words) and not is_text  # \mathrm{dt}
        ):
            self.result += [Token("letter", letter, span) for letter in words]
        elif (is_word and words.lower() not in CONNECTIVES) or (is_text and self._is_operand()):
            self.result.append(Token("word", re.sub(r"\W+", "_", words), span))
        elif is_text:
            self.result.append(Token("prose", words, span))
        else:  # \mathrm{x + 1} and the like
            self.result.append(replace(token, text="mathrm"))
            return at
        return end

    def _is_operand(self) -> bool:
        r"""Whether an expression must come next, such as ``\text{losses of heat}`` behind +."""
        before = next(
            (t for t in reversed(self.result) if t.kind not in ("space", "gap", "&")), None
        )
        return before is not None and (before.kind == "relation" or is_operator(before))

    def _brace(self, token: Token, at: int) -> int:
        """A brace over or under an expression, whose label is left out."""
        end = self._end_of_argument(at)
        inner = Layout(self.latex, self.tokens[at:end]).tokens_without_layout()
        label = self._skip(end)
        if label < len(self.tokens) and self.tokens[label].kind in "_^":
            end = self._end_of_argument(label + 1)
        last = self.tokens[end - 1].span[1]
        self.result.append(Token("{", "{", token.span))
        self.result += inner
        self.result.append(Token("}", "}", (last, last)))
        return end

    def _over_relation(self, token: Token, at: int) -> int:
        middle = self._end_of_argument(at)
        end = self._end_of_argument(middle)
        inner = Layout(self.latex, self.tokens[middle:end]).tokens_without_layout()
        relations = [t for t in inner if t.kind == "relation"]
        if len(relations) != 1:
            raise Unread(rf"\{token.text} is read over a relation alone")
        is_definition = "def" in self._source(at, middle) and relations[0].text == "="
        span = token.span[0], self.tokens[end - 1].span[1]
        self.result.append(Token("relation", ":=" if is_definition else relations[0].text, span))
        return end


SIZES = frozenset(f"{size}{side}" for size in "big Big bigg Bigg".split() for side in ("", *"lrm"))


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return 0.0
