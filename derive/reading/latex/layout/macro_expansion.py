r"""Macros replaced by their bodies.

Some macros of the package physics are known, such as ``\dv{x}{t}``.
"""

from collections.abc import Mapping
from dataclasses import replace

from derive.reading.latex.layout.macros import COMMANDS, Macro, definition
from derive.reading.latex.layout.tokens import Token, UnreadError, tokenize
from derive.reading.latex.tree import Span

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
    "qty": Macro("qty", ""),
}
DERIVATIVES = {"dv": r"\mathrm{d}", "odv": r"\mathrm{d}", "pdv": r"\partial"}


def expanded(latex: str, tokens: list[Token], macros: Mapping[str, Macro]) -> list[Token]:
    """Tokens without macros and their definitions; an expansion has the span of its call.

    Raises
    ------
    Unread
        If a macro calls itself, has too few arguments, or becomes too long.
    """
    known = PHYSICS | dict(macros)
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
        elif token.text in known:
            if depth >= MAX_DEPTH:
                raise UnreadError(rf"the macro \{token.text} calls itself")
            body = _call(known[token.text], token, waiting)
            waiting += [(t, depth + 1) for t in reversed(body)]
        elif token.text in DERIVATIVES:
            body = _derivative(DERIVATIVES[token.text], token, waiting)
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
