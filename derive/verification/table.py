"""Verdicts as a plain-text table."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from shutil import get_terminal_size
from textwrap import TextWrapper, shorten

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
        details = {
            "wrong term": one.wrong_term,
            "correct term" if one.wrong_term else "missing term": one.correct_term,
            "correct form": one.correction,
            "residual": one.residual and f"{one.residual} = {one.witness}",
            "value": "" if one.residual else one.witness,
            "note": one.note,
        }
        lines = [f"{title}: {text}" for title, text in details.items() if text]
        whole = one.verdict in ("misprint", "wrong", "unreadable")
        yield from table_row((one.id, one.verdict, one.printed), lines, width, id_width, whole)


def table_row(
    columns: Sequence[str],
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
    yield from (wrapped(detail, width, margin) for detail in details)


def wrapped(text: str, width: int, margin: int) -> str:
    """Wrap `text` with a left margin, and indent all lines but the first."""
    wrapper = TextWrapper(width, break_long_words=False, break_on_hyphens=False)
    wrapper.initial_indent, wrapper.subsequent_indent = " " * margin, " " * (margin + 2)
    return wrapper.fill(text)
