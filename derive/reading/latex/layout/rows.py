r"""The statements of a display, from its rows, columns and separators.

A display holds several statements, separated by ``,``, ``;``, ``.``, wide spaces, words, arrows and
ends of rows. A part continues the statement before it

- if it begins with a relation, or the part before ends with a relation or an operator, or a bracket
  is open;
- if it begins with +, a sign of multiplication or a slash, except after a comma or a word;
- if it begins with − and has no relation, or the statement before has none, or its row starts
  with ``&`` and the first row of the statement does not;
- if its row starts with ``&`` and has no relation, and the first row of the statement does not.

A number behind a comma is a further value, as in ``i = 1, 2``.
A number in brackets at the end of a row, after a wide space or a mark of punctuation, is the number
of the equation.
"""

from dataclasses import dataclass, field
from itertools import takewhile

from derive.reading.latex.layout.latex_symbols import ELLIPSES, MATRICES, ROWS
from derive.reading.latex.layout.pairs import inside, is_operator, pairs
from derive.reading.latex.layout.tokens import Token, UnreadError

HARD = frozenset({",", ";", "prose", "."})
SEPARATORS = HARD | {"gap", "row", "&"}
#: What can stand between an equation and its number.
BEFORE_NUMBERS = frozenset({"gap", "&", ",", ";", "."})


@dataclass
class Part:
    """Tokens between two separators."""

    tokens: list[Token] = field(default_factory=list)
    separators: list[Token] = field(default_factory=list)  # before the tokens
    starts_row: bool = False  # behind an & at the start of its row
    ends_row: bool = False
    has_relation: bool = False
    row_has_relation: bool = False  # here or in the cells of the row behind it

    @property
    def boundaries(self) -> set[str]:
        """The kinds of the separators before the tokens."""
        return {token.kind for token in self.separators}


def flattened(tokens: list[Token]) -> list[Token]:
    """Tokens with the rows of environments as rows of the display; matrices stay.

    Braces around statements and one-sided brackets of environments are left out.
    """
    tokens = [token for token in tokens if token.kind != "null"]
    partner = pairs(tokens)
    result: list[Token] = []
    kept: set[int] = set()
    joined: set[int] = set()  # ends of lines within one equation
    for at, token in enumerate(tokens):
        if token.kind == "begin":
            end = partner.get(at)
            if end is None:
                raise UnreadError(rf"\begin{{{token.text}}} has no \end")
            if _is_matrix(tokens, at, end, partner):
                kept |= {at, end}
            elif token.text not in ROWS and token.text not in MATRICES:
                raise UnreadError(f"the environment {token.text!r} is not known")
            elif token.text in ("cases", "dcases") and not _starts_statement(result):
                if _are_statements(tokens, at, end, partner):
                    while not _starts_statement(result):
                        result.pop()  # the name of all rows, such as a vector of these components
                else:
                    kept |= {at, end}
            if token.text in ("multline", "multlined"):
                joined |= set(inside(at, end, partner))
            if at not in kept:
                token = Token("row", "", (token.span[1], token.span[1]))
        elif token.kind == "end" and at not in kept:
            token = Token("row", "", (token.span[0], token.span[0]))
        is_joined = token.kind == "row" and at in joined
        if not is_joined and not _encloses_statement(tokens, at, partner):
            result.append(token)
    return result


def _starts_statement(tokens: list[Token]) -> bool:
    """Whether nothing stands before a place in its row but brackets."""
    before = next((t for t in reversed(tokens) if t.kind not in ("space", "&", "open")), None)
    return before is None or before.kind in SEPARATORS


def _are_statements(tokens: list[Token], start: int, end: int, partner: dict[int, int]) -> bool:
    """Whether all rows are statements, and not values with conditions behind a separator."""
    rows: list[list[str]] = [[]]
    for place in inside(start, end, partner):
        if tokens[place].kind == "row":
            rows.append([])
        else:
            rows[-1].append(tokens[place].kind)
    heads = [[*takewhile(lambda kind: kind not in SEPARATORS, row)] for row in rows if row]
    return all("relation" in head for head in heads)


def _is_matrix(tokens: list[Token], start: int, end: int, partner: dict[int, int]) -> bool:
    name = tokens[start].text
    places = inside(start, end, partner)
    has_relation = any(tokens[place].kind == "relation" for place in places)
    return name in MATRICES and not (name == "array" and has_relation)


def _encloses_statement(tokens: list[Token], at: int, partner: dict[int, int]) -> bool:
    """Whether a token is a brace around a statement, or a bracket of an environment of rows."""
    token = tokens[at]
    if token.kind in ("open", "close"):
        step = 1 if token.kind == "open" else -1
        other = at + step
        while 0 <= other < len(tokens) and tokens[other].kind in ("space", "row"):
            other += step
        if not 0 <= other < len(tokens) or tokens[other].kind not in ("begin", "end"):
            return False
        start, end = sorted((other, partner.get(other, other)))
        return not _is_matrix(tokens, start, end, partner)
    if token.kind not in ("{", "}") or at not in partner:
        return False
    start, end = sorted((at, partner[at]))
    before = next(
        (t for t in reversed(tokens[max(0, start - 9) : start]) if t.kind != "space"), None
    )
    if before is not None and before.kind in ("^", "_", "command", "}"):
        return False
    return any(
        tokens[place].kind in ("relation", "&", "row", "prose")
        or (tokens[place].kind == "begin" and tokens[place].text in ROWS)
        or (tokens[place].kind == "{" and _encloses_statement(tokens, place, partner))
        for place in inside(start, end, partner)
    )


def parts(tokens: list[Token]) -> list[Part]:
    """The parts of a display between its separators, none of them empty."""
    partner = pairs(tokens)
    result = [Part()]
    at, row_is_empty = 0, True
    while at < len(tokens):
        token, part = tokens[at], result[-1]
        if _is_implication(part, tokens, at):
            token = Token(";", token.text, token.span)
        end = partner.get(at, 0)
        if end > at:
            part.tokens += tokens[at : end + 1]
            at, row_is_empty = end, False
        elif token.kind in SEPARATORS and (token.kind != "." or _ends_sentence(tokens, at)):
            if any(t.kind != "space" for t in part.tokens):
                result.append(Part())
            result[-1].separators.append(token)
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


def _is_implication(part: Part, tokens: list[Token], at: int) -> bool:
    r"""Whether an arrow ``\to`` stands between two equations, unlike one to a limit."""
    if tokens[at].kind != "relation" or tokens[at].text != "->" or not part.has_relation:
        return False
    row = takewhile(lambda token: token.kind not in SEPARATORS, tokens[at + 1 :])
    behind = [token.text for token in row if token.kind == "relation"]
    return behind[:1] == ["="]


def _ends_sentence(tokens: list[Token], at: int) -> bool:
    row = (tokens[k] for k in range(at + 1, len(tokens)))
    behind = (t for t in takewhile(lambda token: token.kind != "row", row) if t.kind != "space")
    after = next(behind, None)
    if after is None or after.kind in ("gap", "prose", "&", "begin", "end", "."):
        return True
    return after.kind == "open" and _is_number([after, *behind])


def statements(tokens: list[Token]) -> list[list[Token]]:
    """The tokens of each statement of a display."""
    result: list[Part] = []
    for part in parts(tokens):
        if _is_number_of_equation(part):
            continue
        part.tokens = _without_number(part)
        if all(token.kind == "space" for token in part.tokens):
            continue
        if result and _lists_value(result[-1], part):
            result[-1].tokens += part.separators + part.tokens
        elif result and _continues(result[-1], part):
            result[-1].tokens += part.tokens
            result[-1].has_relation |= part.has_relation
        else:
            result.append(part)
    return [_without_brackets(part.tokens) for part in result]


def _without_brackets(tokens: list[Token]) -> list[Token]:
    r"""A condition in brackets, such as ``(x \ll 1)``, without them."""
    places = [at for at, token in enumerate(tokens) if token.kind != "space"]
    start, end = places[0], places[-1]
    partner = pairs(tokens) if tokens[start].kind == "open" else {}
    inner = inside(start, end, partner) if partner.get(start) == end else []
    is_condition = any(tokens[at].kind == "relation" for at in inner)
    return tokens[start + 1 : end] if is_condition else tokens


def _is_number_of_equation(part: Part) -> bool:
    tokens = [token for token in part.tokens if token.kind != "space"]
    return bool(part.boundaries & BEFORE_NUMBERS) and part.ends_row and _is_number(tokens)


def _is_number(tokens: list[Token]) -> bool:
    """Whether tokens are a number in brackets, such as (12) or (2.3)."""
    return (
        len(tokens) > 2
        and (tokens[0].kind, tokens[-1].kind) == ("open", "close")
        and all(token.kind in ("digit", ".", "-") for token in tokens[1:-1])
    )


def _without_number(part: Part) -> list[Token]:
    r"""Tokens without the number of the equation behind ``~`` or ``\;`` at the end of a row."""
    start = len(part.tokens) - 1
    while part.ends_row and start > 0 and part.tokens[start].kind in ("close", "digit", ".", "-"):
        start -= 1
    is_apart = start > 0 and part.tokens[start - 1].text == "~"
    return part.tokens[:start] if is_apart and _is_number(part.tokens[start:]) else part.tokens


def _lists_value(statement: Part, part: Part) -> bool:
    r"""Whether a part is a further value, as in ``i = 1, 2, \dots, n``."""
    if not statement.has_relation or part.boundaries != {","}:
        return False
    last = [token for token in statement.tokens[-9:] if token.kind != "space"][-1]
    tokens = [token for token in part.tokens if token.kind != "space"]
    if len(tokens) == 1 and (tokens[0].text in ELLIPSES or last.text in ELLIPSES):
        return True
    return all(token.kind in ("digit", ".") for token in tokens)


def _continues(statement: Part, part: Part) -> bool:
    start = next(token for token in part.tokens if token.kind != "space")
    last = next(token for token in reversed(statement.tokens) if token.kind != "space")
    if start.kind == "relation":
        return True
    if part.boundaries & HARD:
        return False
    if last.kind == "relation" or is_operator(last):
        return True
    if is_operator(start) and start.kind != "-":
        return True
    is_indented = part.starts_row and not statement.starts_row
    if start.kind == "-":
        return not (part.row_has_relation and statement.has_relation) or is_indented
    if "row" in part.boundaries:
        return is_indented and not part.row_has_relation
    return "&" in part.boundaries and not statement.has_relation
