r"""Macros that a document defines, and their expansion.

Read are ``\newcommand``, ``\renewcommand``, ``\providecommand``, ``\DeclareMathOperator`` and
``\def`` with parameters one after the other.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import islice

from derive.reading.latex.layout.latex_symbols import GREEK
from derive.reading.latex.layout.tokens import (
    Token,
    UnreadError,
    argument,
    skip_spaces,
    tokenize,
)
from derive.reading.latex.tree import Span

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
    at = skip_spaces(tokens, start + 1)
    if at < len(tokens) and tokens[at].kind == "*":
        at = skip_spaces(tokens, at + 1)
    if command in ("def", "gdef"):
        return _plain_definition(latex, tokens, at)
    name = argument(tokens, at)
    inner = [t for t in tokens[slice(*name[0])] if t.kind != "space"] if name else []
    if name is None or len(inner) != 1 or inner[0].kind != "command":
        return None
    options: list[str] = []
    at = skip_spaces(tokens, name[1])
    while at < len(tokens) and tokens[at].kind == "[" and len(options) < 2:
        end = next((i for i in range(at, len(tokens)) if tokens[i].kind == "]"), None)
        if end is None:
            return None
        options.append(_text(latex, tokens[at + 1 : end]))
        at = skip_spaces(tokens, end + 1)
    body = argument(tokens, at)
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
    body = argument(tokens, at)
    if body is None:
        return None
    return Macro(name, _text(latex, tokens[slice(*body[0])]), count), body[1]


def _text(latex: str, tokens: list[Token]) -> str:
    return latex[tokens[0].span[0] : tokens[-1].span[1]] if tokens else ""


#: Tokens of a display after the expansion of macros.
MAX_TOKENS = 30_000
#: Macros within macros.
MAX_DEPTH = 40

#: Macros of the package physics, if the document does not define others of that name.
PHYSICS = {
    "abs": Macro("abs", r"\left|#1\right|", 1),
    "norm": Macro("norm", r"\left\|#1\right\|", 1),
    "dd": Macro("dd", r"\mathrm{d}"),
    "vu": Macro("vu", r"\hat{\mathbf{#1}}", 1),
    "vb": Macro("vb", r"\mathbf{#1}", 1),
    "va": Macro("va", r"\vec{#1}", 1),
    "eval": Macro("eval", r"\left.#1\right|", 1),
    "qty": Macro("qty", ""),
    "qc": Macro("qc", r",\quad "),
    "qq": Macro("qq", r"\quad\text{#1}\quad ", 1),
}
#: Words of that package between formulas, such as ``\qand``.
QUAD_WORDS = (
    "if then else otherwise unless given using where while assume since let for all and or as in"
)
PHYSICS |= {
    f"q{one}": Macro(f"q{one}", rf"\quad\text{{{one}}}\quad ") for one in QUAD_WORDS.split()
}
#: Matrices of that package, in the brackets that follow.
MATRICES = ("mqty", "matrixquantity", "bmqty", "pmqty")
DERIVATIVES = {
    **dict.fromkeys(("dv", "odv", "deriv"), r"\mathrm{d}"),
    **dict.fromkeys(("pdv", "pdiff", "pder", "pderiv", "pd", "PD"), r"\partial"),
}
#: Macros that many documents define in other files, and accents of older packages.
USUAL = {
    "d": Macro("d", r"\mathrm{d}"),
    "ddt": Macro("ddt", r"\frac{\mathrm{d} #1}{\mathrm{d} t}", 1),
    "half": Macro("half", r"\frac{1}{2}"),
    "inv": Macro("inv", r"\frac{1}{#1}", 1),
    "mbf": Macro("mbf", r"\mathbf{#1}", 1),
    "vect": Macro("vect", r"\vec{#1}", 1),
}
USUAL |= {
    one: Macro(one, rf"\{one.lower()}{{#1}}", 1)
    for one in ("Dot", "Ddot", "Hat", "Bar", "Tilde", "Vec")
}
LETTER = "|".join(["[A-Za-z]", *sorted(GREEK)])
#: Letters with dots as macros of other files, such as ``\xddot`` and ``\dottheta``.
DOTTED = re.compile(
    rf"(?!(?:c|o|d+)?dots?$)(?:(?P<letter>{LETTER})(?P<dots>d{{0,2}}dot)"
    rf"|(?P<dots_before>d{{0,2}}dot)(?P<letter_after>{LETTER}))"
)


def expanded(latex: str, tokens: list[Token], macros: Mapping[str, Macro]) -> list[Token]:
    """Tokens without macros and their definitions; an expansion has the span of its call.

    Raises
    ------
    Unread
        If a macro calls itself, has too few arguments, or becomes too long.
    """
    known = PHYSICS | USUAL | dict(macros)
    result: list[Token] = []
    waiting = [(token, 0) for token in reversed(tokens)]  # with the number of macros around it
    at = 0
    while waiting:
        token, depth = waiting.pop()
        if token.kind != "command":
            result.append(token)
        elif token.text in COMMANDS:
            ahead = [t for t, _ in reversed(waiting[-2000:])]
            found = definition(latex, [token, *ahead], 0)
            if found is None or depth:
                raise UnreadError(rf"\{token.text} defines no macro")
            known[found[0].name] = found[0]
            del waiting[len(waiting) - found[1] + 1 :]
        elif macro := known.get(token.text) or _dotted(token.text):
            if depth >= MAX_DEPTH:
                raise UnreadError(rf"the macro \{token.text} calls itself")
            if token.text in PHYSICS:
                _skip_star(waiting)
            body = _call(macro, token, waiting)
            waiting += [(t, depth + 1) for t in reversed(body)]
        elif token.text in DERIVATIVES:
            body = _derivative(DERIVATIVES[token.text], token, waiting)
            waiting += [(t, depth + 1) for t in reversed(body)]
        elif token.text in MATRICES:
            body = _matrix(token, waiting)
            waiting += [(t, depth + 1) for t in reversed(body)]
        else:
            result.append(token)
        at += 1
        if at > MAX_TOKENS or len(waiting) > MAX_TOKENS:
            raise UnreadError(f"more than {MAX_TOKENS} tokens")
    return result


def _call(macro: Macro, call: Token, waiting: list[tuple[Token, int]]) -> list[Token]:
    """The body of a macro with its arguments, which are taken from the waiting tokens."""
    arguments: list[list[Token]] = []
    end = call.span[1]
    if macro.default is not None:
        option = _optional(waiting)
        arguments.append(tokenize(macro.default) if option is None else option)
    while len(arguments) < macro.arguments:
        given = _taken(waiting)
        if given is None:
            raise UnreadError(rf"\{macro.name} needs {macro.arguments} arguments")
        arguments.append(given[0])
        end = max(end, given[1])
    return _substituted(macro, arguments, (call.span[0], end))


def _derivative(sign: str, call: Token, waiting: list[tuple[Token, int]]) -> list[Token]:
    r"""The fraction that ``\dv{x}{t}``, ``\dv{t}`` or ``\pdv[2]{L}{x}`` is."""
    _skip_star(waiting)
    option = _optional(waiting)
    order = f"^{{{''.join(t.text for t in option)}}}" if option else ""
    arguments: list[list[Token]] = []
    end = call.span[1]
    while len(arguments) < 3 and waiting and waiting[-1][0].kind == "{":
        given = _taken(waiting)
        if given is None:
            raise UnreadError("a brace is never closed")
        arguments.append(given[0])
        end = given[1]
    body = {
        1: rf"\frac{{{sign}{order}}}{{{sign} #1{order}}}",
        2: rf"\frac{{{sign}{order} #1}}{{{sign} #2{order}}}",
        3: rf"\frac{{{sign}^2 #1}}{{{sign} #2 {sign} #3}}",
    }.get(len(arguments))
    if body is None:
        raise UnreadError(rf"\{call.text} needs an argument in braces")
    return _substituted(Macro(call.text, body, len(arguments)), arguments, (call.span[0], end))


def _dotted(name: str) -> Macro | None:
    """The macro of a letter with dots."""
    match = DOTTED.fullmatch(name)
    if match is None:
        return None
    letter = match["letter"] or match["letter_after"]
    body = letter if len(letter) == 1 else rf"\{letter}"
    return Macro(name, rf"\{match['dots'] or match['dots_before']}{{{body}}}")


def _skip_star(waiting: list[tuple[Token, int]]) -> None:
    if waiting and waiting[-1][0].kind == "*":
        waiting.pop()


def _matrix(call: Token, waiting: list[tuple[Token, int]]) -> list[Token]:
    r"""The matrix that ``\mqty[a & b \\ c & d]`` is, of any brackets."""
    _skip_star(waiting)
    while waiting and waiting[-1][0].kind == "space":
        waiting.pop()
    closing = {"[": "]", "(": ")", "{": "}"}.get(waiting[-1][0].kind if waiting else "")
    if closing is None:
        raise UnreadError(rf"\{call.text} needs entries in brackets")
    waiting.pop()
    body, depth = list[Token](), 0
    while waiting:
        token = waiting.pop()[0]
        if depth == 0 and token.kind == closing:
            edges = (tokenize(rf"\{one}{{bmatrix}}") for one in ("begin", "end"))
            first, last = ([replace(t, span=call.span) for t in edge] for edge in edges)
            return [*first, *body, *last]
        depth += {"[": 1, "(": 1, "{": 1, "]": -1, ")": -1, "}": -1}.get(token.kind, 0)
        body.append(token)
    raise UnreadError("a bracket is never closed")


def _substituted(macro: Macro, arguments: list[list[Token]], span: Span) -> list[Token]:
    """The body of a macro with its arguments, all of them in the place of the call."""
    body = tokenize(macro.body)
    result: list[Token] = []
    at = 0
    while at < len(body):
        if body[at].kind == "#" and at + 1 < len(body) and body[at + 1].kind == "digit":
            number = int(body[at + 1].text)
            if not 1 <= number <= len(arguments):
                raise UnreadError(rf"\{macro.name} has no argument #{number}")
            result += [replace(token, span=span) for token in arguments[number - 1]]
            at += 2
        else:
            result.append(replace(body[at], span=span))
            at += 1
        if len(result) > MAX_TOKENS:
            raise UnreadError(f"more than {MAX_TOKENS} tokens")
    return result


def _taken(waiting: list[tuple[Token, int]]) -> tuple[list[Token], int] | None:
    """The next argument, which is removed, and where it ends in the display."""
    while waiting and waiting[-1][0].kind == "space":
        waiting.pop()
    if not waiting:
        return None
    first = waiting.pop()[0]
    if first.kind != "{":
        return [first], first.span[1]
    taken: list[Token] = []
    depth = 1
    while waiting:
        token = waiting.pop()[0]
        depth += {"{": 1, "}": -1}.get(token.kind, 0)
        if depth == 0:
            return taken, token.span[1]
        taken.append(token)
    return None


def _optional(waiting: list[tuple[Token, int]]) -> list[Token] | None:
    if not waiting or waiting[-1][0].kind != "[":
        return None
    waiting.pop()
    taken: list[Token] = []
    while waiting:
        token = waiting.pop()[0]
        if token.kind == "]":
            return taken
        taken.append(token)
    return None
