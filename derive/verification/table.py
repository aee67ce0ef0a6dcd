"""Verdicts as a plain-text table."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from shutil import get_terminal_size
from textwrap import fill, shorten

from derive.verification.verdict import Verdict

#: Columns of the verdict, and of the widest table.
VERDICT_WIDTH, MAX_WIDTH = 13, 120


def table_width() -> int:
    """Return the width of the terminal, limited to `MAX_WIDTH`."""
    return min(get_terminal_size((100, 24)).columns, MAX_WIDTH)


def verdict_rows(verdicts: Sequence[Verdict], width: int) -> Iterator[str]:
    """Yield the lines of a table of verdicts; only correct equations are abbreviated."""
    id_width = max((len(one.id) for one in verdicts), default=0) + 2
    for one in verdicts:
        details = [f"{title}: {text}" for title, text in _details(one) if text]
        whole = one.verdict in ("misprint", "wrong", "unreadable")
        yield from table_row((one.id, one.verdict, one.printed), details, width, id_width, whole)


def table_row(
    columns: tuple[str, str, str],
    details: Iterable[str],
    width: int,
    id_width: int = 7,
    whole: bool = False,
) -> Iterator[str]:
    """Yield the lines of one row: id, verdict and text, with wrapped details below the text."""
    label, verdict, text = columns
    margin = id_width + VERDICT_WIDTH
    head = f"{label:<{id_width}}{verdict:<{VERDICT_WIDTH}}"
    if whole:
        yield head + wrapped(text, width, margin).lstrip()
    else:
        yield head + shorten(text, width - margin, placeholder=" ...")
    for detail in details:
        yield wrapped(detail, width, margin)


def wrapped(text: str, width: int, margin: int) -> str:
    """Wrap `text` with a left margin, and indent all lines but the first."""
    return fill(
        text,
        width,
        initial_indent=" " * margin,
        subsequent_indent=" " * (margin + 2),
        break_long_words=False,
        break_on_hyphens=False,
    )


def _details(one: Verdict) -> Iterator[tuple[str, str]]:
    if one.wrong_term:
        yield "wrong term", one.wrong_term
    yield "correct term" if one.wrong_term else "missing term", one.correct_term
    yield "correct form", one.correction
    if one.residual:
        yield "residual", f"{one.residual} = {one.witness}"
    else:
        yield "value", one.witness
    yield "note", one.note
