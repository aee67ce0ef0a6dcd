r"""Macros that a document defines.

Read are ``\newcommand``, ``\renewcommand``, ``\providecommand``, ``\DeclareMathOperator`` and
``\def`` with parameters one after the other.
"""

import re
from dataclasses import dataclass
from itertools import islice

from derive.reading.latex.layout.tokens import Token, tokenize

COMMANDS = frozenset(
    """newcommand renewcommand providecommand DeclareRobustCommand DeclareMathOperator def
    gdef""".split()
)
START = re.compile(rf"\\(?:{'|'.join(sorted(COMMANDS))})(?![A-Za-z])")


@dataclass(frozen=True)
class Macro:
    r"""A macro: the number of its arguments, the first one if it is optional, and its body."""

    name: str
    body: str
    arguments: int = 0
    default: str | None = None


#: Macros of a document, and characters of a definition.
MAX_MACROS, MAX_LENGTH = 1000, 1000


def macros_of(text: str) -> dict[str, Macro]:
    """The macros that a document defines; a later definition replaces an earlier one."""
    macros: dict[str, Macro] = {}
    for match in islice(START.finditer(text), MAX_MACROS):
        if not _is_comment(text, match.start()):
            excerpt = text[match.start() : match.start() + MAX_LENGTH]
            result = definition(excerpt, tokenize(excerpt), 0)
            if result is not None:
                macros[result[0].name] = result[0]
    return macros


def _is_comment(text: str, position: int) -> bool:
    line = text[text.rfind("\n", 0, position) + 1 : position]
    return re.search(r"(?<!\\)%", line) is not None


def definition(latex: str, tokens: list[Token], start: int) -> tuple[Macro, int] | None:
    """The macro that a command defines, and the token after it; None if it defines no macro."""
    command = tokens[start].text
    at = _skip(tokens, start + 1)
    if at < len(tokens) and tokens[at].kind == "*":
        at = _skip(tokens, at + 1)
    if command in ("def", "gdef"):
        return _plain_definition(latex, tokens, at)
    name = _argument(tokens, at)
    inner = [t for t in tokens[slice(*name[0])] if t.kind != "space"] if name else []
    if name is None or len(inner) != 1 or inner[0].kind != "command":
        return None
    options: list[str] = []
    at = _skip(tokens, name[1])
    while at < len(tokens) and tokens[at].kind == "[" and len(options) < 2:
        end = next((i for i in range(at, len(tokens)) if tokens[i].kind == "]"), None)
        if end is None:
            return None
        options.append(_text(latex, tokens[at + 1 : end]))
        at = _skip(tokens, end + 1)
    body = _argument(tokens, at)
    if body is None or (options and not re.fullmatch(r"\s*\d\s*", options[0])):
        return None
    text = _text(latex, tokens[slice(*body[0])])
    if command == "DeclareMathOperator":
        text = rf"\operatorname{{{text}}}"
    count = int(options[0]) if options else 0
    default = options[1] if len(options) > 1 else None
    return Macro(inner[0].text, text, count, default), body[1]


def _plain_definition(latex: str, tokens: list[Token], at: int) -> tuple[Macro, int] | None:
    if at >= len(tokens) or tokens[at].kind != "command":
        return None
    name, at, count = tokens[at].text, at + 1, 0
    while at + 1 < len(tokens) and tokens[at].kind == "#":
        count, at = count + 1, at + 2
    if at >= len(tokens) or tokens[at].kind != "{":
        return None
    body = _argument(tokens, at)
    if body is None:
        return None
    return Macro(name, _text(latex, tokens[slice(*body[0])]), count), body[1]


def _skip(tokens: list[Token], at: int) -> int:
    while at < len(tokens) and tokens[at].kind == "space":
        at += 1
    return at


def _argument(tokens: list[Token], at: int) -> tuple[tuple[int, int], int] | None:
    """Tokens of the argument at a place, and the token after it; None if there is none."""
    at = _skip(tokens, at)
    if at >= len(tokens):
        return None
    if tokens[at].kind != "{":
        return (at, at + 1), at + 1
    depth = 0
    for end in range(at, len(tokens)):
        depth += {"{": 1, "}": -1}.get(tokens[end].kind, 0)
        if depth == 0:
            return (at + 1, end), end + 1
    return None


def _text(latex: str, tokens: list[Token]) -> str:
    return latex[tokens[0].span[0] : tokens[-1].span[1]] if tokens else ""
