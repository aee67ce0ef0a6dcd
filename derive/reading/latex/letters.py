r"""Letters with their accents, indices and primes, and the other symbols of the grammar.

Of a bare argument, as in ``\sin 2\theta l``, the grammar takes numbers and Latin letters up to and
including the first Greek letter, and a ``t`` behind it: the symbols tell these kinds apart.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from derive.reading.latex.rows import MAX_DEPTH, pairs
from derive.reading.latex.symbols import (
    ACCENTS,
    BOLD,
    ELLIPSES,
    FUNCTIONS,
    GREEK,
    INVERTIBLE,
    LETTERS,
    MARKS,
    SCRIPT,
    SLASHES,
    TIMES,
    UPRIGHT,
)
from derive.reading.latex.tokens import Token, Unread
from derive.reading.latex.tree import Letter, Number, Span

FONTS = BOLD | SCRIPT | UPRIGHT
#: Functions in letters without a backslash, as in ``cos{\theta}``; the short ones stand alone.
SPELLED = re.compile(r"(?:arc)?(?:sin|cos|tan)h?|exp|log")
SPELLED_ALONE = re.compile(r"(?:ln|sec|csc|cot|det|sgn)(?![a-z])")
ARGUMENTS = {"frac": 2, "tfrac": 2, "dfrac": 2, "cfrac": 2, "sqrt": 1}


@dataclass(frozen=True, slots=True)
class Symbol:
    """A terminal of the grammar, its value and its place."""

    type: str
    value: Any
    span: Span


class Symbols:
    """The symbols of the grammar for the tokens of one side of a statement."""

    def __init__(self, tokens: list[Token]) -> None:
        self.tokens = tokens
        self.partner = pairs(tokens)
        self.depth = 0
        self.bold = False
        self.applied: set[int] = set()  # brackets that hold the arguments of a letter

    def all(self) -> list[Symbol]:
        """All symbols, in order."""
        return self._range(0, len(self.tokens))

    def _range(self, start: int, end: int) -> list[Symbol]:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise Unread(f"more than {MAX_DEPTH} expressions within one another")
        result: list[Symbol] = []
        at = start
        while at < end:
            at = self._read(at, end, result)
        self.depth -= 1
        return result

    def _read(self, at: int, end: int, result: list[Symbol]) -> int:
        token = self.tokens[at]
        if token.kind in ("space", "gap"):
            return at + 1
        if token.kind == "digit" or (token.kind == "." and self._is_digit(at + 1)):
            return self._number(at, end, result)
        if function := self._function(at):
            return self._called(*function, end, result)
        if letter := self._letter(at, end):
            return self._lettered(*letter, end, result)
        if token.kind == "command":
            return self._command(at, end, result)
        if token.kind == "^":
            return self._superscript(at, end, result)
        if token.kind == "{":
            return self._group(at, result)
        if token.kind == "begin":
            return self._matrix(at, result)
        result.append(self._simple(at, result))
        return at + 1

    # --- simple symbols

    def _simple(self, at: int, result: list[Symbol]) -> Symbol:
        token = self.tokens[at]
        if token.kind == "open":
            if at not in self.partner:
                raise Unread("a bracket is never closed")
            applied = token.text in ("(", "[") and self._is_applied(at, result)
            if applied:
                self.applied.add(at)
            name = "APPLY" if applied else SHAPES[token.text]
            return Symbol(name + "_OPEN", token.text, token.span)
        if token.kind == "close":
            if at not in self.partner:
                raise Unread("a bracket is closed but never opened")
            applied = self.partner[at] in self.applied
            return Symbol(("APPLY" if applied else SHAPES[token.text]) + "_CLOSE", "", token.span)
        if token.kind == "bar":
            if at not in self.partner:
                raise Unread("a bar has no partner")
            side = "_OPEN" if self.partner[at] > at else "_CLOSE"
            return Symbol(SHAPES["|"] + side, "", token.span)
        if token.kind in ("+", "-"):
            return Symbol("SIGN", 1 if token.kind == "+" else -1, token.span)
        if token.kind in SIMPLE:
            return Symbol(SIMPLE[token.kind], token.text, token.span)
        raise Unread(REASONS.get(token.kind, f"{token.text!r} cannot stand here"))

    def _is_digit(self, at: int) -> bool:
        return at < len(self.tokens) and self.tokens[at].kind == "digit"

    def _is_applied(self, at: int, result: list[Symbol]) -> bool:
        """Whether a letter stands before a bracket, outside the bare argument of a function."""
        if not result or result[-1].type not in LETTER_TYPES:
            return False
        inside = [t for t in self.tokens[at + 1 : self.partner[at]] if t.kind != "space"]
        if [t.text for t in inside] == ["t"]:
            return True
        if result[-1].value.name == "partial" or _in_bare_argument(result):
            return False
        if self.tokens[at].text == "[":
            return self._has_comma(at)
        return True

    def _has_comma(self, at: int) -> bool:
        end = self.partner[at]
        at += 1
        while at < end:
            if self.tokens[at].kind == ",":
                return True
            at = max(at, self.partner.get(at, at)) + 1
        return False

    def _number(self, at: int, end: int, result: list[Symbol]) -> int:
        digits = ""
        start = at
        while at < end:
            token = self.tokens[at]
            is_point = token.kind == "." and self._is_digit(at + 1) and "." not in digits
            if token.kind == "{" and [t.kind for t in self.tokens[at : at + 4]] == DECIMAL_COMMA:
                digits += "."
                at += 3
            elif token.kind == "digit" or is_point:
                digits += token.text
                at += 1
            elif token.kind == "." and digits.isdigit() and not is_point and at + 1 < end:
                raise Unread("a number ends with a point")
            else:
                break
        span = self.tokens[start].span[0], self.tokens[at - 1].span[1]
        result.append(Symbol("NUMBER", Number(digits, span), span))
        return at

    # --- arguments

    def _skip(self, at: int, end: int) -> int:
        while at < end and self.tokens[at].kind == "space":
            at += 1
        return at

    def _argument(self, at: int, end: int) -> tuple[int, int, int]:
        """Where the content of an argument starts and ends, and the token after it."""
        at = self._skip(at, end)
        if at >= end:
            raise Unread("an argument is missing")
        token = self.tokens[at]
        if token.kind == "{":
            if at not in self.partner:
                raise Unread("a brace is never closed")
            return at + 1, self.partner[at], self.partner[at] + 1
        if token.kind == "command":
            count = ARGUMENTS.get(token.text, int(token.text in ACCENTS or token.text in MARKS))
            stop = at + 1
            for _ in range(max(count, int(token.text in FONTS))):
                self.depth += 1
                if self.depth > MAX_DEPTH:
                    raise Unread(f"more than {MAX_DEPTH} commands within one another")
                stop = self._argument(stop, end)[2]
                self.depth -= 1
            return at, stop, stop
        if token.kind in ("&", "row", "^", "_", "}", "begin", "end", "open", "close"):
            raise Unread("an argument is missing")
        return at, at + 1, at + 1

    def _symbols_of_argument(self, at: int, end: int, result: list[Symbol]) -> int:
        start, stop, after = self._argument(at, end)
        self._symbols_between(start, stop, result)
        closing = result[-1]
        right = max(closing.span[1], self.tokens[after - 1].span[1])
        result[-1] = replace(closing, span=(right, right))
        return after

    def _symbols_between(self, start: int, stop: int, result: list[Symbol]) -> int:
        inner = self._range(start, stop)
        if not inner:
            raise Unread("an argument is empty")
        left, right = self.tokens[start].span[0], self.tokens[stop - 1].span[1]
        result.append(Symbol("ARGUMENT_OPEN", "", (left, left)))
        result += inner
        result.append(Symbol("ARGUMENT_CLOSE", "", (right, right)))
        return stop

    def _group(self, at: int, result: list[Symbol]) -> int:
        if at not in self.partner:
            raise Unread("a brace is never closed")
        end = self.partner[at]
        inner = self._range(at + 1, end)
        if len(inner) == 1 and inner[0].type in ("SIGN", "TIMES", "SLASH", "COMMA"):
            result += inner
        elif inner:
            result.append(Symbol("GROUP_OPEN", "", self.tokens[at].span))
            result += inner
            result.append(Symbol("GROUP_CLOSE", "", self.tokens[end].span))
        return end + 1

    def _matrix(self, at: int, result: list[Symbol]) -> int:
        token = self.tokens[at]
        if token.text in ("cases", "dcases"):
            raise Unread("a definition by cases")
        end = self.partner.get(at)
        if end is None:
            raise Unread(rf"\begin{{{token.text}}} has no \end")
        inner = self._range(at + 1, end)
        while inner and inner[-1].type == "ROW":
            inner.pop()
        result.append(Symbol("MATRIX_OPEN", token.text, token.span))
        result += inner
        result.append(Symbol("MATRIX_CLOSE", "", self.tokens[end].span))
        return end + 1

    # --- commands

    def _command(self, at: int, end: int, result: list[Symbol]) -> int:
        token = self.tokens[at]
        name = token.text
        if name in ("frac", "tfrac", "dfrac", "cfrac"):
            result.append(Symbol("FRACTION", "", token.span))
            after = self._symbols_of_argument(at + 1, end, result)
            return self._symbols_of_argument(after, end, result)
        if name == "sqrt":
            return self._root(at, end, result)
        if name in ACCENTS:
            result.append(Symbol("DOTS", ACCENTS[name], token.span))
            return self._symbols_of_argument(at + 1, end, result)
        if name in FONTS:
            return self._font(at, end, result)
        if name == "sum":
            return self._sum(at, end, result)
        if name in TIMES or name in SLASHES:
            result.append(Symbol("TIMES" if name in TIMES else "SLASH", name, token.span))
            return at + 1
        if name == "over":
            result.append(Symbol("OVER", "", token.span))
            return at + 1
        if name in MARKS:
            raise Unread(rf"\{name} stands over an expression that is no letter")
        raise Unread(REASONS.get(name, rf"the command \{name} is not known"))

    def _font(self, at: int, end: int, result: list[Symbol]) -> int:
        start, stop, after = self._argument(at + 1, end)
        was_bold, self.bold = self.bold, self.bold or self.tokens[at].text in BOLD
        inner = self._range(start, stop)
        self.bold = was_bold
        if inner:
            result.append(Symbol("GROUP_OPEN", "", self.tokens[at].span))
            result += inner
            result.append(Symbol("GROUP_CLOSE", "", self.tokens[after - 1].span))
        return after

    def _root(self, at: int, end: int, result: list[Symbol]) -> int:
        token = self.tokens[at]
        degree = 2
        start = self._skip(at + 1, end)
        if start < end and self.tokens[start].text == "(" and start in self.partner:  # √(x)
            result.append(Symbol("ROOT", degree, token.span))
            return self._symbols_between(start, self.partner[start] + 1, result)
        if start < end and self.tokens[start].kind == "open" and self.tokens[start].text == "[":
            stop = self.partner.get(start, start)
            text = "".join(t.text for t in self.tokens[start + 1 : stop]).strip(" {}")
            if not re.fullmatch(r"[2-9]", text):
                raise Unread("the degree of a root is not one of 2 to 9")
            degree, start = int(text), stop + 1
        result.append(Symbol("ROOT", degree, token.span))
        return self._symbols_of_argument(start, end, result)

    def _sum(self, at: int, end: int, result: list[Symbol]) -> int:
        result.append(Symbol("SUM", "", self.tokens[at].span))
        bounds: dict[str, list[Symbol]] = {"_": [], "^": []}
        at = self._skip(at + 1, end)
        while at < end and self.tokens[at].kind in bounds:
            bound = bounds[self.tokens[at].kind]
            if bound:
                raise Unread("a sum has two lower or two upper bounds")
            bound.append(Symbol({"_": "LOWER", "^": "UPPER"}[self.tokens[at].kind], "", (at, at)))
            at = self._skip(self._symbols_of_argument(at + 1, end, bound), end)
        result += bounds["_"] + bounds["^"]
        return at

    def _superscript(self, at: int, end: int, result: list[Symbol]) -> int:
        start, stop, after = self._argument(at + 1, end)
        span = self.tokens[at].span[0], self.tokens[after - 1].span[1]
        texts = [t.text for t in self.tokens[start:stop] if t.kind not in ("space", "{", "}")]
        while texts and texts[0] in FONTS:
            texts = texts[1:]
        if texts in (["T"], ["top"], ["intercal"]):
            result.append(Symbol("TRANSPOSED", "", span))
            return after
        if len(texts) == 1 and texts[0] in STARS:
            name = STARS[texts[0]]
            result.append(Symbol("POWER", "", span))
            place = self.tokens[start].span
            result += [
                Symbol("ARGUMENT_OPEN", "", place),
                Symbol("LATIN", Letter(name, place), place),
                Symbol("ARGUMENT_CLOSE", "", span[1:] * 2),
            ]
            return after
        if texts and set(texts) <= {"'", "prime"}:
            raise Unread("a prime behind an expression that is no letter")
        if self.tokens[self._skip(start, stop)].kind == "open":
            raise Unread("a number in brackets in the place of an exponent")
        if self._is_digit(after) and self.tokens[after - 1].kind == "digit" and after < end:
            raise Unread("a digit behind an exponent without braces")
        result.append(Symbol("POWER", "", self.tokens[at].span))
        return self._symbols_of_argument(at + 1, end, result)

    # --- functions

    def _function(self, at: int) -> tuple[str, int] | None:
        """The function whose name starts at a place, and the token after it."""
        token = self.tokens[at]
        if token.kind == "command" and token.text in FUNCTIONS:
            return FUNCTIONS[token.text], at + 1
        if token.kind == "word" and token.text in FUNCTIONS and self._is_followed(at + 1):
            return FUNCTIONS[token.text], at + 1
        if token.kind != "letter":
            return None
        stop = at
        while stop < len(self.tokens) and self.tokens[stop].kind == "letter" and stop < at + 9:
            stop += 1
        run = "".join(t.text for t in self.tokens[at:stop])
        is_first = at == 0 or self.tokens[at - 1].kind != "letter"
        found = SPELLED.match(run) or (SPELLED_ALONE.match(run) if is_first else None)
        return (FUNCTIONS[found[0]], at + len(found[0])) if found else None

    def _is_followed(self, at: int) -> bool:
        r"""Whether an argument can start at a place: ``\text{sec}`` behind a number is a unit."""
        at = self._skip(at, len(self.tokens))
        kinds = ("letter", "digit", "command", "open", "bar", "{", "^")
        return at < len(self.tokens) and self.tokens[at].kind in kinds

    def _called(self, name: str, at: int, end: int, result: list[Symbol]) -> int:
        span = self.tokens[at - 1].span
        token = self.tokens[at - 1]
        if token.kind == "letter":
            span = self.tokens[at - len(name)].span[0], span[1]
        at = self._skip(at, end)
        if at < end and self.tokens[at].kind == "_":
            raise Unread("the base of a logarithm" if name == "log" else "a function with an index")
        if at < end and self.tokens[at].kind == "^" and name in INVERTIBLE:
            start, stop, after = self._argument(at + 1, end)
            if [t.text for t in self.tokens[start:stop] if t.kind != "space"] == ["-", "1"]:
                name, at = f"a{name}", after
        result.append(Symbol("FUNCTION", name, span))
        return at

    # --- letters

    def _lettered(
        self, letter: Letter, at: int, raised: int, end: int, result: list[Symbol]
    ) -> int:
        result.append(Symbol(_type(letter), letter, letter.span))
        if raised:
            self._superscript(raised, end, result)
        return at

    def _letter(self, at: int, end: int) -> tuple[Letter, int, int] | None:
        """The letter at a place, the token after it, and where an exponent before its index is."""
        found = self._base(at, end)
        if found is None:
            return None
        letter, at = found
        raised = 0
        while at < end:
            script = self._skip(at, end)
            kind = self.tokens[script].kind if script < end else ""
            if kind == "_":
                start, stop, after = self._argument(script + 1, end)
                if letter.index:
                    raise Unread(f"two indices at the letter {letter.name}")
                letter = replace(letter, index=index_text(self.tokens[start:stop]))
            elif kind == "'":
                after = script + 1
                letter = replace(letter, primes=letter.primes + 1)
            elif kind == "^" and not raised:
                start, stop, after = self._argument(script + 1, end)
                inner = [t.text for t in self.tokens[start:stop] if t.kind != "space"]
                if inner and set(inner) == {"prime"}:
                    letter = replace(letter, primes=letter.primes + len(inner))
                elif self._skip(after, end) < end and (
                    self.tokens[self._skip(after, end)].kind == "_"
                ):
                    raised = script
                else:
                    break
            else:
                break
            at = after
            if kind == "_" and self._is_digit(at) and at < end:
                raise Unread("a digit behind an index without braces")
            letter = replace(letter, span=(letter.span[0], self.tokens[at - 1].span[1]))
        return letter, at, raised

    def _spelled(self, at: int, end: int) -> tuple[Letter, int] | None:
        """A name such as ``t1`` or ``td2``, as in programs: letters, then digits as the index."""
        stop = at
        while stop < end and self.tokens[stop].kind == "letter":
            stop += 1
        if at == stop and (at == end or self.tokens[at].text not in GREEK):
            return None
        stop, name_end = max(stop, at + 1), max(stop, at + 1)
        while self._is_digit(stop) and stop < end:
            stop += 1
        if stop == name_end or (at and self.tokens[at - 1].kind == "letter"):
            return None
        name, index = ("".join(t.text for t in part) for part in (
            self.tokens[at:name_end], self.tokens[name_end:stop],
        ))  # fmt: skip
        span = self.tokens[at].span[0], self.tokens[stop - 1].span[1]
        return Letter(name, span, index, is_bold=self.bold), stop

    def _base(self, at: int, end: int) -> tuple[Letter, int] | None:
        token = self.tokens[at]
        bold = self.bold
        if spelled := self._spelled(at, end):
            return spelled
        if token.kind in ("letter", "word"):
            return Letter(token.text, token.span, is_bold=bold), at + 1
        if token.kind == "{" and at in self.partner:  # {\theta}_1
            after = self.partner[at] + 1
            if after < end and self.tokens[after].kind in ("_", "'"):
                inner = self._letter(self._skip(at + 1, after), after - 1)
                if inner is not None and self._skip(inner[1], after - 1) == after - 1:
                    return replace(inner[0], span=(token.span[0], token.span[0])), after
            return None
        if token.kind != "command":
            return None
        name = token.text
        if name in GREEK or name in LETTERS:
            plain = name.removeprefix("var") if name in ("varepsilon", "varpi") else name
            return Letter(plain, token.span, is_bold=bold), at + 1
        if name in ELLIPSES:
            return Letter("dots", token.span), at + 1
        if name not in ACCENTS and name not in MARKS and name not in FONTS:
            return None
        start, stop, after = self._argument(at + 1, end)
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise Unread(f"more than {MAX_DEPTH} commands within one another")
        start = self._skip(start, stop)
        while (
            start < stop and self.partner.get(start) == stop - 1 and self.tokens[start].kind == "{"
        ):
            start, stop = self._skip(start + 1, stop - 1), stop - 1
        is_function = start < stop and self._function(start) is not None
        inner = self._letter(start, stop) if start < stop and not is_function else None
        self.depth -= 1
        if inner is None or self._skip(inner[1], stop) != stop or inner[2]:
            return None
        letter = replace(inner[0], span=(token.span[0], self.tokens[after - 1].span[1]))
        if name in ACCENTS:
            letter = replace(letter, dots=letter.dots + ACCENTS[name])
        elif name in MARKS:
            letter = replace(letter, name=letter.name + MARKS[name])
        elif name in BOLD:
            letter = replace(letter, is_bold=True)
        return letter, after


SHAPES = {"(": "ROUND", "[": "SQUARE", "{": "CURLY", "|": "NORM", "<": "ANGLE", "floor": "FLOOR"}
SIMPLE = {
    "*": "TIMES",
    "/": "SLASH",
    ",": "COMMA",
    "&": "CELL",
    "row": "ROW",
    "relation": "RELATION",
}
STARS = {"*": "star", "star": "star", "ast": "star", "dagger": "dagger", "circ": "circ"}
REASONS = {
    "_": "an index behind an expression that is no letter",
    "'": "a prime behind an expression that is no letter",
    "}": "a brace is closed but never opened",
    "middle": "a bar between two expressions",
    "end": r"\end without \begin",
    "nabla": "the operator nabla",
    "pm": "two signs at once",
    "mp": "two signs at once",
    "int": "an integral",
    "prod": "a product over an index",
    "lim": "a limit",
    "footnote": "a footnote",
}
DECIMAL_COMMA = ["{", ",", "}", "digit"]
LETTER_TYPES = frozenset({"LATIN", "GREEK", "TIME", "ACCENTED"})


def _type(letter: Letter) -> str:
    if letter.dots:
        return "ACCENTED"
    if letter.name == "t" and not letter.index and not letter.primes:
        return "TIME"
    stem = re.sub(r"(?:bar|hat|tilde|check|breve|ring|under)+$", "", letter.name)
    return "GREEK" if stem in GREEK or letter.name in GREEK else "LATIN"


def _in_bare_argument(result: list[Symbol]) -> bool:
    """Whether the last symbol, a letter, belongs to the bare argument of a function."""
    at = len(result) - 1
    is_last = True
    while at >= 0:
        kind = result[at].type
        if kind == "FUNCTION":
            return True
        if kind == "ARGUMENT_CLOSE":  # an exponent
            depth = 1
            while depth and at:
                at -= 1
                depth += {"ARGUMENT_CLOSE": 1, "ARGUMENT_OPEN": -1}.get(result[at].type, 0)
            if not at or result[at - 1].type != "POWER":
                return False
            at -= 1
        elif kind not in ("NUMBER", "LATIN", "GREEK", "TIME") or (
            not is_last and kind in ("GREEK", "TIME") and result[at + 1].type != "TIME"
        ):
            return False
        is_last = False
        at -= 1
    return False


def index_text(tokens: list[Token]) -> str:
    """An index as text: ``kin``, ``theta_1`` or ``i+1``."""
    return "".join(_index_parts(tokens)).strip()


def _index_parts(tokens: list[Token]) -> Iterator[str]:
    for token in tokens:
        if token.kind in ("letter", "digit", "word", "+", "-", ",", "_", "'", "prose", "*"):
            yield token.text
        elif token.kind in ("space", "gap", "{", "}") or _is_font(token):
            continue
        elif token.kind == "command" and token.text in ACCENTS:
            yield token.text
        elif token.kind == "command" and token.text.isalpha():
            if token.text in EXPRESSIONS:
                raise Unread(rf"\{token.text} in an index")
            yield token.text
        elif token.kind in ("relation", "open", "close", "."):
            raise Unread("an index that is neither a letter, a number nor a word")
        else:
            raise Unread(f"{token.text!r} in an index")


def _is_font(token: Token) -> bool:
    return token.kind == "command" and token.text in FONTS


EXPRESSIONS = frozenset({"frac", "sqrt", "sum", "dfrac", "tfrac", "nabla", "over"})
