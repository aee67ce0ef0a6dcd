r"""Letters with their accents, indices and primes; functions, with or without a backslash."""

import re
from collections.abc import Iterator
from dataclasses import replace

from derive.reading.latex.grammar.written_nodes import Symbol
from derive.reading.latex.layout.latex_symbols import (
    ACCENTS,
    BOLD,
    ELLIPSES,
    FONTS,
    FUNCTIONS,
    GREEK,
    LETTERS,
    MARKS,
)
from derive.reading.latex.layout.pairs import Arguments
from derive.reading.latex.layout.tokens import Token, UnreadError
from derive.reading.latex.tree import Letter

#: Functions in letters without a backslash, as in ``cos{\theta}``; the short ones stand alone.
SPELLED = re.compile(r"(?:arc)?(?:sin|cos|tan|sen)h?|exp|log")
SPELLED_ALONE = re.compile(r"(?:ln|sec|csc|cot|det|sgn)(?![a-z])")
LONGEST = 7
#: Symbols of a bare argument, so that long runs of letters take no longer than their length.
LONGEST_ARGUMENT = 100
AMBIGUOUS = "where the argument of a function ends is ambiguous without brackets"
#: Kinds of tokens with which an argument can start.
STARTS = frozenset({"letter", "word", "digit", "command", "open", "bar", "{", "^"})
LETTER_TYPES = frozenset({"LATIN", "GREEK", "TIME", "ACCENTED"})


def function_at(tokens: list[Token], at: int, end: int) -> tuple[str, int] | None:
    """The function whose name starts at a place, and the token after it."""
    token = tokens[at]
    if token.kind == "command" and token.text in FUNCTIONS:
        name, at = FUNCTIONS[token.text], at + 1
        if name == "atan" and at < end and tokens[at].text == "2":  # \arctan2(y, x)
            return "atan2", at + 1
        return name, at
    if token.kind == "word" and token.text in FUNCTIONS:
        kinds = (tokens[k].kind for k in range(at + 1, end))
        is_function = next((kind for kind in kinds if kind != "space"), "") in STARTS
        return (FUNCTIONS[token.text], at + 1) if is_function else None  # \text{sec} is a unit
    if token.kind != "letter":
        return None
    run = ""
    for letter in tokens[at : min(end, at + LONGEST)]:
        if letter.kind != "letter":
            break
        run += letter.text
    is_first = at == 0 or tokens[at - 1].kind != "letter"
    result = SPELLED.match(run) or (SPELLED_ALONE.match(run) if is_first else None)
    return (FUNCTIONS[result[0]], at + len(result[0])) if result else None


def ends_bare_argument(result: list[Symbol]) -> str:
    """The type of the last symbol, a letter, if a bare argument of a function ends with it."""
    at, start = len(result) - 1, max(len(result) - LONGEST_ARGUMENT, 0)
    while at >= start:
        kind = result[at].type
        if kind == "FUNCTION":
            return result[-1].type
        if kind == "ARGUMENT_CLOSE":  # an exponent
            depth = 1
            while depth and at:
                at -= 1
                depth += {"ARGUMENT_CLOSE": 1, "ARGUMENT_OPEN": -1}.get(result[at].type, 0)
            if not at or result[at - 1].type != "POWER":
                return ""
            at -= 2
            continue
        is_letter = kind in ("NUMBER", "LATIN", "GREEK", "TIME")
        is_end = kind == "TIME" or (kind == "GREEK" and result[at + 1 :][:1] != [])
        if not is_letter or (is_end and at < len(result) - 1 and result[at + 1].type != "TIME"):
            return ""
        at -= 1
    return ""


class LetterTokens(Arguments):
    """Tokens in which letters are found."""

    is_bold = False  # whether a font around the tokens makes letters bold

    def letter(self, at: int, end: int) -> tuple[Letter, int, int] | None:
        """The letter at a place, the token after it, and where an exponent before its index is.

        In ``x^2_1`` the exponent stands between the letter and its index; otherwise its place is 0.
        """
        result = self._base(at, end)
        if result is None:
            return None
        letter, at = result
        raised = 0
        while at < end:
            script = self.skip(at, end)
            if [token.kind for token in self.tokens[script : script + 2]] == ["{", "}"]:
                script = self.skip(script + 2, end)  # x{}_1
            kind = self.kind(script, end)
            if kind == "_":
                start, stop, at = self.argument(script + 1, end)
                letter = _with_index(letter, self.tokens[start:stop])
                if self.kind(at, end) == "digit" and self.tokens[at - 1].kind == "digit":
                    raise UnreadError("a digit behind an index without braces")
            elif kind == "'":
                at = script + 1
                letter = replace(letter, primes=letter.primes + 1)
            elif kind == "^" and not raised:
                start, stop, after = self.argument(script + 1, end)
                marks = self.texts(start, stop)
                if marks and set(marks) <= {"prime", "'"}:
                    letter = replace(letter, primes=letter.primes + len(marks))
                elif self.kind(self.skip(after, end), end) == "_":
                    raised = script
                else:
                    break
                at = after
            else:
                break
            letter = replace(letter, span=(letter.span[0], self.tokens[at - 1].span[1]))
        return letter, at, raised

    def _base(self, at: int, end: int) -> tuple[Letter, int] | None:
        """A letter without scripts, and the token after it."""
        token = self.tokens[at]
        if token.kind == "{":
            return self._in_braces(at, end)
        if spelled := self._spelled(at, end):
            return spelled
        if token.kind in ("letter", "word"):
            return Letter(token.text, token.span, is_bold=self.is_bold), at + 1
        if token.kind != "command":
            return None
        if token.text in GREEK or token.text in LETTERS:
            return Letter(token.text, token.span, is_bold=self.is_bold), at + 1
        if token.text in ELLIPSES:
            return Letter("dots", token.span), at + 1
        return self._accented(at, end)

    def _accented(self, at: int, end: int) -> tuple[Letter, int] | None:
        """A letter in the argument of an accent or a font."""
        token = self.tokens[at]
        if token.text not in ACCENTS and token.text not in MARKS and token.text not in FONTS:
            return None
        start, stop, after = self.argument(at + 1, end)
        inner = self._alone(start, stop)
        if inner is None:
            return None
        letter = replace(inner, span=(token.span[0], self.tokens[after - 1].span[1]))
        if token.text in ACCENTS:
            letter = replace(letter, dots=letter.dots + ACCENTS[token.text])
        elif token.text in MARKS:
            letter = replace(letter, name=letter.name + MARKS[token.text])
        elif token.text in BOLD:
            letter = replace(letter, is_bold=True)
        return letter, after

    def _alone(self, start: int, stop: int) -> Letter | None:
        """The letter that tokens are, with nothing beside it but braces."""
        start = self.skip(start, stop)
        if start >= stop or function_at(self.tokens, start, stop):
            return None
        with self.deeper():
            if self.tokens[start].kind == "{" and self.partner.get(start, 0) == stop - 1:
                return self._alone(start + 1, stop - 1)
            result = self.letter(start, stop)
        if result is None or result[2] or self.skip(result[1], stop) != stop:
            return None
        return result[0]

    def _in_braces(self, at: int, end: int) -> tuple[Letter, int] | None:
        r"""A letter in braces before an index, a prime or time: ``{\theta}_1``, ``{\dot x}(t)``."""
        if at not in self.partner:
            return None
        after = self.partner[at] + 1
        is_marked = self.kind(after, end) in ("_", "'")
        letter = self._alone(at + 1, after - 1) if is_marked or self._is_time(after, end) else None
        return None if letter is None else (replace(letter, span=self.tokens[at].span), after)

    def _is_time(self, at: int, end: int) -> bool:
        """Whether tokens begin with the argument t in brackets."""
        places = [k for k in range(at, min(end, at + 6)) if self.tokens[k].kind != "space"][:3]
        kinds = [self.tokens[k].kind for k in places]
        return kinds == ["open", "letter", "close"] and self.tokens[places[1]].text == "t"

    def _spelled(self, at: int, end: int) -> tuple[Letter, int] | None:
        """A name such as ``t1`` or ``td2``, as in programs, with its digits as the index."""
        tokens = self.tokens
        if tokens[at].text in GREEK:
            stop = at + 1
        elif at and tokens[at - 1].kind == "letter":
            return None
        else:
            stop = at
            while self.kind(stop, end) == "letter":
                stop += 1
        last = stop
        while self.kind(last, end) == "digit":
            last += 1
        run = "".join(token.text for token in tokens[at:stop])
        if run in ("const", "constant"):
            span = tokens[at].span[0], tokens[stop - 1].span[1]
            is_short = any(token.text == "." for token in tokens[stop : stop + 1])
            return Letter(run, span), stop + is_short
        if stop in (at, last) or SPELLED.search(run):
            return None
        name, index = run, "".join(token.text for token in tokens[stop:last])
        if name in ("e", "E") and at and tokens[at - 1].kind == "digit":
            raise UnreadError("a number with an exponent behind e")
        span = tokens[at].span[0], tokens[last - 1].span[1]
        return Letter(name, span, index, is_bold=self.is_bold), last


def _with_index(letter: Letter, tokens: list[Token]) -> Letter:
    if letter.index:
        raise UnreadError(f"two indices at the letter {letter.name}")
    return replace(letter, index="".join(_index(tokens)).strip())


def _index(tokens: list[Token]) -> Iterator[str]:
    """The parts of an index as text, such as ``theta``, ``_`` and ``1``."""
    for token in tokens:
        if token.kind in ("space", "gap", "{", "}") or token.text in FONTS:
            continue
        is_name = token.kind == "command" and (token.text in INDICES or token.text in GREEK)
        if not is_name and token.kind not in INDEX_KINDS:
            raise UnreadError("an index that is neither letters, numbers nor a word")
        yield token.text


INDEX_KINDS = frozenset({"letter", "digit", "word", "prose", "+", "-", ",", "_", "'", "*"})
INDICES = frozenset(
    {*LETTERS, *ELLIPSES, *ACCENTS, *MARKS, "max", "min", "top", "perp", "parallel"}
)
