r"""Words of formulas in plain text: ``theta1_dot`` is ``\dot{\theta}_1``, ``x**2`` is ``x^2``.

A word is a run of letters, digits and underscores without spaces. Nobody means a product of single
letters by one of these words, so that they are read so in LaTeX too.
"""

import re
from collections.abc import Iterator
from dataclasses import replace

from derive.reading.latex.layout.latex_symbols import GREEK
from derive.reading.latex.layout.pairs import pairs
from derive.reading.latex.layout.tokens import Token, braced, skip_spaces

#: In place of a token that is a Greek letter.
LETTER = "\ue000"
#: Names of Greek letters that are no products: mu and nu can be.
SPELLED = "|".join(one for one in sorted(GREEK, key=len, reverse=True) if len(one) > 2) + "|pi"
HEAD = rf"(?:{SPELLED}|[A-Za-z]|{LETTER})"
WORD = re.compile(
    rf"""(?:(?<![A-Za-z])|(?<=\bd)|(?<=\bd[23]))(?:
      (?P<head>{HEAD})(?P<index>_?\d{{1,2}})?_?(?P<dots>dot_?dot|d{{1,3}}ot)(?P<behind>_?\d{{1,2}})?
    | (?P<root>sqrt)
    | (?P<greek>{SPELLED})
    | (?P<energy>[KP]E)
    )(?![A-Za-z])
    | \b(?P<differential>d)(?P<order>[23])(?={HEAD})
    | \b(?P<variable>d[a-z])(?P<count>[23])\b""",
    re.VERBOSE,
)


def with_words(tokens: list[Token]) -> list[Token]:
    """The tokens with commands for words, and with braces around exponents in brackets."""
    result: list[Token] = []
    for run in _runs(tokens):
        result += _read(run)
    return _with_exponents(result)


def _runs(tokens: list[Token]) -> Iterator[list[Token]]:
    """The tokens in groups, of which each word is one."""
    run: list[Token] = []
    for token in tokens:
        if run and not (_character(token) and run[-1].span[1] == token.span[0]):
            yield run
            run = []
        run.append(token)
        if not _character(token):
            yield run
            run = []
    if run:
        yield run


def _character(token: Token) -> str:
    """The character of a token in a word; nothing if it does not belong to one."""
    if token.kind == "command":
        return LETTER if token.text in GREEK else ""
    return token.text if token.kind in ("letter", "digit", "_") else ""


def _read(run: list[Token]) -> list[Token]:
    """The tokens of a word, with commands for its parts."""
    text, result, done = "".join(map(_character, run)), list[Token](), 0
    for word in WORD.finditer(text):
        own = _of_word(run, word)
        result += [*run[done : word.start()], *own]
        done = word.end()
    return result + run[done:]


def _of_word(run: list[Token], word: re.Match[str]) -> list[Token]:
    start, end = run[word.start()].span[0], run[word.end() - 1].span[1]

    def part(name: str) -> list[Token]:
        return run[slice(*word.span(name))] if word[name] else []

    def command(name: str) -> list[Token]:
        """One command for a spelled name; other tokens as they are."""
        own = part(name)
        if len(own) == 1:
            return own
        return [Token("command", word[name], (own[0].span[0], own[-1].span[1]))]

    if word["dots"]:
        count = word["dots"].count("d")
        accent = Token("command", "d" * count + "ot", (start, end))
        letter = [accent, *braced(command("head"))]
        index = [one for name in ("index", "behind") for one in part(name) if one.kind == "digit"]
        if index:
            letter += [Token("_", "_", index[0].span), *braced(index)]
        last = replace(letter[-1], span=(end, end))
        return [*letter[:-1], last]
    for base, exponent in (("differential", "order"), ("variable", "count")):
        if word[base]:
            number = part(exponent)
            return [*part(base), Token("^", "^", number[0].span), *number]
    if word["energy"]:
        return [Token("word", word["energy"], (start, end))]
    return command("root" if word["root"] else "greek")


def _with_exponents(tokens: list[Token]) -> list[Token]:
    """The tokens with ``^`` for ``**``, and with braces around an exponent in brackets."""
    partner, result, at = pairs(tokens), list[Token](), 0
    while at < len(tokens):
        token = tokens[at]
        is_power = [one.kind for one in tokens[at : at + 2]] == ["*", "*"]
        result.append(replace(token, kind="^", text="^") if is_power else token)
        at += 2 if is_power else 1
        first = skip_spaces(tokens, at)
        if (is_power or token.kind == "^") and first in partner and tokens[first].text == "(":
            last = partner[first]
            result += braced(_with_exponents(tokens[first : last + 1]))
            at = last + 1
    return result
