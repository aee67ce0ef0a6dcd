r"""Displays that go on in the next one: ``$$L = T - V =$$`` before ``$$= m \dot{x}^2/2$$``."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace

from derive.reading.document import Display

#: Delimiters of displays without an environment of their own.
DELIMITERS = ("$$", r"\[", r"\\[")
#: Relations and signs at the end or at the start of a display, which a side must follow or precede.
RELATION = r"=|\\approx|\\equiv|\\simeq"
ENDS = re.compile(rf"(?:{RELATION}|(?<![_^])[+-]|\\cdot|\\times)\s*\Z")
STARTS = re.compile(rf"\s*(?:{RELATION}|\+)")
#: Text between two displays that are one formula: spaces and tags of a paragraph.
BETWEEN = re.compile(r"(?:\s|<br\s*/?>|</?p>)*\Z", re.IGNORECASE)


def joined(displays: Iterable[Display], text: str) -> Iterator[Display]:
    """The displays of a text, with those that continue the one before as parts of it."""
    before: Display | None = None
    for one in displays:
        if before and _continues(before, one, text):
            latex = before.latex
            if STARTS.match(one.latex):  # the sign is repeated
                latex = ENDS.sub("", latex)
            latex = latex.ljust(one.start - before.start) + one.latex
            before = replace(before, latex=latex, extent=(before.extent[0], one.extent[1]))
            continue
        if before:
            yield before
        before = one
    if before:
        yield before


def _continues(before: Display, one: Display, text: str) -> bool:
    return (
        before.delimiter in DELIMITERS
        and before.delimiter == one.delimiter
        and before.cell == one.cell
        and not before.is_inline
        and not one.is_inline
        and BETWEEN.match(text, before.extent[1], one.extent[0]) is not None
        and bool(ENDS.search(before.latex) or STARTS.match(one.latex))
    )
