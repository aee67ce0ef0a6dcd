r"""The statements of a display, from its rows, columns and separators.

A display holds several statements, separated by ``,``, ``;``, ``.``, wide spaces, words, arrows and
ends of rows. A part continues the statement before it

- if it begins with a relation, or the part before ends with a relation or an operator, or a bracket
  is open;
- if it begins with +, a sign of multiplication or a slash, except after a comma or a word;
- if it begins with − and has no relation, or the statement before has none, or its row starts
  with ``&`` and the first row of the statement does not;
- if its row starts with ``&`` and has no relation, and the first row of the statement does not.

An integer in brackets after a wide space at the end of a row is the number of the equation.
"""

from dataclasses import dataclass, field

from derive.reading.latex.symbols import MATRICES, ROWS, SLASHES, TIMES
from derive.reading.latex.tokens import Token, Unread

#: Brackets within brackets.
MAX_DEPTH = 60
OPENERS = {"{": "}", "open": "close", "begin": "end"}
HARD = frozenset({",", ";", "prose", "."})
SEPARATORS = HARD | {"gap", "row", "&"}


@dataclass
class Part:
    """Tokens between two separators."""

    tokens: list[Token] = field(default_factory=list)
    boundaries: set[str] = field(default_factory=set)  # kinds of the separators before
    starts_row: bool = False  # behind an & at the start of its row
    ends_row: bool = False
    has_relation: bool = False
    row_has_relation: bool = False  # here or in the cells of the row behind it


def pairs(tokens: list[Token]) -> dict[int, int]:
    """The partner of each bracket, brace and matrix that has one."""
    partner: dict[int, int] = {}
    stack: list[int] = []
    for at, token in enumerate(tokens):
        if token.kind in OPENERS:
            stack.append(at)
        elif token.kind == "bar":
            top = tokens[stack[-1]] if stack else None
            if top is not None and top.kind == "bar" and not _awaits(tokens, at):
                _join(partner, stack.pop(), at)
            else:
                stack.append(at)
        elif token.kind in ("}", "close", "end"):
            while stack and tokens[stack[-1]].kind == "bar":
                stack.pop()
            if stack and _fits(tokens[stack[-1]], token):
                _join(partner, stack.pop(), at)
        if len(stack) > MAX_DEPTH:
            raise Unread(f"more than {MAX_DEPTH} brackets within one another")
    return partner


def _join(partner: dict[int, int], start: int, end: int) -> None:
    partner[start], partner[end] = end, start


def _fits(start: Token, end: Token) -> bool:
    return OPENERS.get(start.kind) == end.kind and (start.kind == "{" or start.text == end.text)


def _awaits(tokens: list[Token], at: int) -> bool:
    """Whether an expression must follow the tokens before a place."""
    before = next((t for t in reversed(tokens[:at][-9:]) if t.kind not in ("space", "gap")), None)
    return before is None or _is_operator(before) or before.kind in ("relation", "open", "bar", "{")


def _is_operator(token: Token) -> bool:
    return token.kind in ("+", "-", "*", "/") or (
        token.kind == "command" and (token.text in TIMES or token.text in SLASHES)
    )


def flattened(tokens: list[Token]) -> list[Token]:
    """Tokens with the rows of environments as rows of the display; matrices stay.

    Braces around statements and one-sided brackets of environments are left out.
    """
    tokens = [token for token in tokens if token.kind != "null"]
    partner = pairs(tokens)
    result: list[Token] = []
    kept: set[int] = set()
    for at, token in enumerate(tokens):
        if token.kind == "begin":
            end = partner.get(at)
            if end is None:
                raise Unread(rf"\begin{{{token.text}}} has no \end")
            if _is_matrix(tokens, at, end, partner):
                kept |= {at, end}
            elif token.text not in ROWS:
                raise Unread(f"the environment {token.text!r} is not known")
            elif token.text in ("cases", "dcases") and not _starts_statement(result):
                kept |= {at, end}
            if at not in kept:
                row = Token("row", "", (token.span[1], token.span[1]))
                if result and result[-1].kind == "open" and at - 1 not in partner:
                    result.pop()
                token = row
        elif token.kind == "end" and at not in kept:
            token = Token("row", "", (token.span[0], token.span[0]))
        closes_rows = token.kind == "close" and at not in partner and _ends_rows(result)
        if not closes_rows and not _holds_statement(tokens, at, partner):
            result.append(token)
    return result


def _ends_rows(tokens: list[Token]) -> bool:
    return bool(tokens) and tokens[-1].kind == "row" and not tokens[-1].text


def _starts_statement(tokens: list[Token]) -> bool:
    before = next((t for t in reversed(tokens) if t.kind not in ("space", "&")), None)
    if before is not None and before.kind == "open":
        return True
    return before is None or before.kind in (*HARD, "row", "gap")


def _inside(start: int, end: int, partner: dict[int, int]) -> list[int]:
    """Places between two brackets and outside the brackets between them."""
    places = []
    at = start + 1
    while at < end:
        places.append(at)
        at = partner[at] + 1 if partner.get(at, 0) > at else at + 1
    return places


def _is_matrix(tokens: list[Token], start: int, end: int, partner: dict[int, int]) -> bool:
    name = tokens[start].text
    if name != "array":
        return name in MATRICES
    return not any(tokens[at].kind == "relation" for at in _inside(start, end, partner))


def _holds_statement(tokens: list[Token], at: int, partner: dict[int, int]) -> bool:
    """Whether a token is one of a pair of braces around a statement."""
    if tokens[at].kind not in ("{", "}") or at not in partner:
        return False
    start, end = sorted((at, partner[at]))
    before = next(
        (t for t in reversed(tokens[max(0, start - 9) : start]) if t.kind != "space"), None
    )
    if before is not None and (before.kind in ("^", "_", "command", "}")):
        return False
    kinds = ("relation", "&", "row", "prose", "begin")
    return any(tokens[place].kind in kinds for place in _inside(start, end, partner)) and (
        not _within_matrix(tokens, start, end, partner)
    )


def _within_matrix(tokens: list[Token], start: int, end: int, partner: dict[int, int]) -> bool:
    """Whether braces hold a matrix and no relation."""
    kinds = {tokens[place].kind for place in _inside(start, end, partner)}
    return (
        "begin" in kinds
        and not kinds & {"relation", "&", "row", "prose"}
        and all(
            tokens[place].text in MATRICES
            for place in _inside(start, end, partner)
            if tokens[place].kind == "begin"
        )
    )


def parts(tokens: list[Token]) -> list[Part]:
    """The parts of a display between its separators, none of them empty."""
    partner = pairs(tokens)
    result = [Part()]
    at, row_is_empty = 0, True
    while at < len(tokens):
        token, part = tokens[at], result[-1]
        end = partner.get(at, 0)
        if end > at:
            part.tokens += _on_one_row(tokens[at : end + 1])
            at, row_is_empty = end, False
        elif token.kind in SEPARATORS and (token.kind != "." or _ends_sentence(tokens, at)):
            if any(t.kind != "space" for t in part.tokens):
                result.append(Part())
            result[-1].boundaries.add(token.kind)
            is_first = token.kind == "&" and row_is_empty
            result[-1].starts_row = is_first or (token.kind == "gap" and result[-1].starts_row)
            row_is_empty = token.kind == "row" or (row_is_empty and token.kind in ("&", "gap"))
        else:
            part.tokens.append(token)
            part.has_relation |= token.kind == "relation"
            row_is_empty &= token.kind == "space"
        at += 1
    result = [part for part in result if any(t.kind != "space" for t in part.tokens)]
    row_has_relation, row_ends = False, True
    for part in reversed(result):
        row_has_relation = part.row_has_relation = row_has_relation or part.has_relation
        part.ends_row = row_ends
        row_ends = "row" in part.boundaries
        if part.boundaries != {"&"}:
            row_has_relation = False
    return result


def _on_one_row(tokens: list[Token]) -> list[Token]:
    r"""An expression in brackets without the ends of rows in it, those of a matrix aside.

    Brackets of a fixed size may be on different rows, unlike ``\left`` and ``\right``.
    """
    result: list[Token] = []
    depth = 0
    for token in tokens:
        depth += (token.kind == "begin") - (token.kind == "end")
        if depth or token.kind not in ("row", "&"):
            result.append(token)
    return result


def _ends_sentence(tokens: list[Token], at: int) -> bool:
    after = next((t for t in tokens[at + 1 : at + 9] if t.kind != "space"), None)
    return after is None or after.kind in ("row", "gap", "prose", "&", "begin", "end", ".")


def statements(tokens: list[Token]) -> list[list[Token]]:
    """The tokens of each statement of a display."""
    result: list[Part] = []
    for part in parts(tokens):
        if _is_number_of_equation(part):
            continue
        if result and _continues(result[-1], part):
            result[-1].tokens += part.tokens
            result[-1].has_relation |= part.has_relation
        else:
            result.append(part)
    return [part.tokens for part in result]


def _is_number_of_equation(part: Part) -> bool:
    tokens = [token for token in part.tokens if token.kind != "space"]
    return (
        bool(part.boundaries & {"gap", "&"})
        and part.ends_row
        and len(tokens) > 2
        and (tokens[0].kind, tokens[-1].kind) == ("open", "close")
        and all(token.kind in ("digit", ".", "-") for token in tokens[1:-1])
    )


def _continues(statement: Part, part: Part) -> bool:
    start = next(token for token in part.tokens if token.kind != "space")
    last = next(token for token in reversed(statement.tokens) if token.kind != "space")
    if start.kind == "relation":
        return True
    if part.boundaries & HARD:
        return False
    if last.kind == "relation" or _is_operator(last):
        return True
    if _is_operator(start) and start.kind != "-":
        return True
    is_indented = part.starts_row and not statement.starts_row
    if start.kind == "-":
        return not (part.row_has_relation and statement.has_relation) or is_indented
    if "row" in part.boundaries:
        return is_indented and not part.row_has_relation
    return "&" in part.boundaries and not statement.has_relation
