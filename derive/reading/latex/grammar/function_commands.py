r"""Functions with and without a backslash, and where their bare arguments end."""

import re

from derive.reading.latex.grammar.written_nodes import Symbol
from derive.reading.latex.layout.latex_symbols import FUNCTIONS
from derive.reading.latex.layout.tokens import Token

#: Functions in letters without a backslash, as in ``cos{\theta}``; the short ones stand alone.
SPELLED = re.compile(r"(?:arc)?(?:sin|cos|tan)h?|exp|log")
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
