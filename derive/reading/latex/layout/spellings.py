"""Other spellings of LaTeX: characters of Unicode, and fonts from before LaTeX."""

import unicodedata
from dataclasses import replace
from itertools import groupby

from derive.reading.latex.layout.latex_symbols import COMBINING
from derive.reading.latex.layout.pairs import pairs
from derive.reading.latex.layout.tokens import (
    Token,
    UnreadError,
    argument,
    braced,
    script_of,
    tokenize,
)

#: Fonts that hold to the end of their braces.
OLD_FONTS = {
    "rm": "mathrm", "bf": "mathbf", "cal": "mathcal", "it": "mathit", "sf": "mathsf",
    "tt": "mathtt",
}  # fmt: skip

#: What stands above a letter for its rates.
POINTS = {".": "dot", "cdot": "dot", "..": "ddot", "cdotcdot": "ddot", "...": "dddot"}


def with_new_fonts(tokens: list[Token]) -> list[Token]:
    r"""Tokens in which ``{\bf r}`` is ``\mathbf{r}``.

    Behind no brace, such a font is meant for the next letter or braces: ``\bf M(\bf q)``.
    """
    result: list[Token] = []
    for token in tokens:
        if token.kind == "command" and token.text in OLD_FONTS:
            brace = max(0, len(result) - 1)
            while brace and result[brace].kind == "space":
                brace -= 1
            font = replace(token, text=OLD_FONTS[token.text])
            if result and result[brace].kind == "{":
                result.insert(brace, replace(font, span=result[brace].span))
            else:
                result.append(font)
        else:
            result.append(token)
    return result


def with_fractions_of_derivatives(tokens: list[Token]) -> list[Token]:
    r"""Tokens in which ``\partial_{x}`` is ``\frac{\partial}{\partial x}``."""
    partner, result, at = pairs(tokens), list[Token](), 0
    while at < len(tokens):
        sign = tokens[at]
        index = next((k for k in range(at + 1, len(tokens)) if tokens[k].kind != "space"), at)
        first = index + 1
        if sign.text == "partial" and tokens[index].kind == "_" and first < len(tokens):
            last = partner.get(first, first)
            variable = tokens[first + 1 : last] if last > first else [tokens[first]]
            result += [replace(sign, text="frac"), *braced([sign])]
            result += braced([replace(sign, span=tokens[index].span), *variable])
            at = last
        else:
            result.append(sign)
        at += 1
    return result


def with_points_above(tokens: list[Token]) -> list[Token]:
    r"""Tokens in which ``\overset{.}{x}`` is ``\dot{x}``."""
    result: list[Token] = []
    at = 0
    while at < len(tokens):
        one = tokens[at]
        above = argument(tokens, at + 1) if one.text in ("overset", "stackrel") else None
        below = argument(tokens, above[1]) if above else None
        points = [t.text for t in tokens[slice(*above[0])] if t.kind != "space"] if above else []
        is_letter = below is not None and all(t.text != "=" for t in tokens[slice(*below[0])])
        if above and is_letter and (name := POINTS.get("".join(points))):
            result.append(replace(one, text=name))
            at = above[1]
        else:
            result.append(one)
            at += 1
    return result


def with_dots_on_variables(tokens: list[Token]) -> list[Token]:
    r"""Tokens in which ``\dot{\partial} q`` below a derivative is ``\partial\dot{q}``."""
    result: list[Token] = []
    at = 0
    while at < len(tokens):
        texts = [one.text for one in tokens[at : at + 4]]
        letter = argument(tokens, at + 4) if texts == ["dot", "{", "partial", "}"] else None
        if letter is None:
            result.append(tokens[at])
            at += 1
        else:
            inner, at_end = tokens[slice(*letter[0])], letter[1]
            accent = replace(tokens[at], span=inner[0].span)
            result += [tokens[at + 2], accent, *braced(inner)]
            at = at_end
    return result


def with_unicode_scripts(tokens: list[Token]) -> list[Token]:
    """The tokens with accents before their letters, and raised text as an exponent."""
    result: list[Token] = []
    for kind, group in groupby(tokens, _script):
        marked = list(group)
        if kind == "accent":
            letter = [result.pop()] if result else []
            if not letter or letter[0].kind not in ("letter", "command"):
                raise UnreadError(f"the accent {marked[0].text!r} has no letter")
            for token in marked:
                start, end = letter[0].span[0], token.span[1]
                accent = Token("command", COMBINING[token.text], (start, end))
                letter = [accent, *braced(letter)[:-1], Token("}", "}", (end, end))]
            result += letter
        elif kind:
            span = marked[0].span[0], marked[-1].span[1]
            simple = [unicodedata.normalize("NFKC", token.text) for token in marked]
            inner = [replace(t, span=span) for text in simple for t in tokenize(text)]
            result += [Token(kind, kind, span), *braced(inner)]
        else:
            result += marked
    return result


def _script(token: Token) -> str:
    """Whether a character is an accent, raised or lowered."""
    if token.kind != token.text or token.kind.isascii():
        return ""
    return "accent" if token.text in COMBINING else script_of(token.text)
