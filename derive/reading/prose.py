"""The text of a document around its formulas, as HTML of a few plain elements."""

import re
from collections.abc import Callable, Iterator
from html import escape
from html.parser import HTMLParser
from itertools import takewhile
from typing import NamedTuple

from derive.reading.document import CodeCell, Display, Document
from derive.reading.document_formats import known_formats

#: In place of a formula, its number between characters that no text has.
OPENING, CLOSING = "\ue000", "\ue001"
PLACE = re.compile(f"{OPENING}(\\d+){CLOSING}")
#: Elements that are kept, without their attributes; others that contain blocks; empty ones.
KEPT = frozenset(
    """p h1 h2 h3 h4 h5 h6 ul ol li dl dt dd table caption thead tbody tr th td blockquote pre div
    code kbd em strong b i sub sup""".split()
)
DIVISIONS = frozenset(
    "article aside details figcaption figure footer header main nav section summary".split()
)
EMPTY = frozenset(("br", "hr"))
#: Elements whose contents are not text of the document.
SKIPPED = frozenset(
    "head script style svg iframe object template noscript textarea select button math".split()
)
#: Elements that end where one of the same group starts, up to the elements that contain both.
IMPLIED = {
    **{
        tag: ({"p"}, {"li", "td", "th", "dd", "blockquote", "div"})
        for tag in "p ul ol dl h1 h2 h3 h4 h5 h6 table pre blockquote div".split()
    },
    "li": ({"li"}, {"ul", "ol"}),
    **{tag: ({"dt", "dd"}, {"dl"}) for tag in ("dt", "dd")},
    **{tag: ({"td", "th"}, {"tr"}) for tag in ("td", "th")},
    "tr": ({"tr"}, {"table", "thead", "tbody"}),
}
#: Elements in which only formulas stood.
VACANT = re.compile(r"<p>\s*</p>|<pre>(?:<code>)?\s*(?:</code>)?</pre>")
#: Elements that end before a display and start again behind it.
DIVIDED = frozenset(("p", "pre", "code"))
#: Elements at whose end stands what belongs below a formula of their text.
BLOCKS = frozenset(("p", "li", "td", "th", "dd", "dt", "h1", "h2", "h3", "h4", "h5", "h6"))


class FormulaMarkup(NamedTuple):
    """HTML in the place of a formula, and below the paragraph that contains it."""

    inside: str
    below: str = ""


def prose(
    document: Document,
    formula: Callable[[Display], FormulaMarkup],
    program: Callable[[CodeCell], str],
) -> str:
    """The document as HTML: its text, in order, with its formulas and programs.

    Elements keep no attributes, so that nothing is executed or fetched. A display stands between
    paragraphs.

    Parameters
    ----------
    document
        The document.
    formula, program
        The markup of a formula, and what follows a program of a notebook; they are not called for
        what stands in a part that is left out.

    Raises
    ------
    OSError
        When a package is missing that the format needs.
    """
    form = known_formats()[document.kind]
    programs = {one.start: one for one in document.programs}
    parts = []
    for start, end in _cells(document):
        if start in programs:
            parts.append(f"<pre><code>{escape(document.text[start:end])}</code></pre>")
            parts.append(program(programs[start]))
        else:
            text = "".join(_with_places(document, start, end))
            parts.append(_Blocks(document.displays, formula).html(form.prose(text)))
    return "\n".join(parts)


def _cells(document: Document) -> Iterator[tuple[int, int]]:
    """Start and end of the cells of a notebook, or of the text."""
    starts = document.cells or (0,)
    yield from zip(starts, (*(start - 1 for start in starts[1:]), len(document.text)), strict=True)


def _with_places(document: Document, start: int, end: int) -> Iterator[str]:
    """The pieces of a part of the text, with numbers in place of formulas."""
    table = str.maketrans("", "", OPENING + CLOSING)
    for number, one in enumerate(document.displays):
        if start <= one.extent[0] < end:
            yield document.text[start : one.extent[0]].translate(table)
            start = one.extent[1]
            own = document.text[slice(*one.extent)]
            margin = own[: len(own) - len(own.lstrip())]
            yield f"{margin}{OPENING}{number}{CLOSING}" + "\n\n" * own.endswith("\n")
    yield document.text[start:end].translate(table)


class _Blocks(HTMLParser):
    """The text of a page as plain elements, closed in order, with formulas in their places."""

    def __init__(
        self, displays: tuple[Display, ...], formula: Callable[[Display], FormulaMarkup]
    ) -> None:
        super().__init__()
        self._displays, self._formula = displays, formula
        self._pieces: list[str] = []
        self._open: list[str] = []
        self._skipped = ""
        self._below: list[str] = []

    def html(self, text: str) -> str:
        """The elements of a text."""
        self.feed(text)
        self.close()
        self._close(0)
        return VACANT.sub("", "".join([*self._pieces, *self._below]))

    def handle_starttag(self, tag: str, attrs: object) -> None:
        if tag == "body":
            self._skipped = ""
        if self._skipped:
            return
        if tag in SKIPPED:
            self._skipped = tag
            return
        tag = "div" if tag in DIVISIONS else tag
        if tag in EMPTY:
            self._pieces.append(f"<{tag}>")
        elif tag in KEPT:
            ended, containing = IMPLIED.get(tag, (set(), set()))
            for depth in range(len(self._open) - 1, -1, -1):
                if self._open[depth] in containing:
                    break
                if self._open[depth] in ended:
                    self._close(depth)
                    break
            self._open.append(tag)
            self._pieces.append(f"<{tag}>")

    def handle_endtag(self, tag: str) -> None:
        if self._skipped:
            self._skipped = "" if tag == self._skipped else self._skipped
            return
        tag = "div" if tag in DIVISIONS else tag
        if tag in self._open:
            self._close(len(self._open) - 1 - self._open[::-1].index(tag))

    def _close(self, depth: int) -> None:
        """Close the elements that are open from a depth on."""
        while len(self._open) > depth:
            tag = self._open.pop()
            is_block = tag in BLOCKS
            if is_block and not tag.startswith(("p", "h")):
                self._append_below()
            self._pieces.append(f"</{tag}>")
            if is_block:
                self._append_below()

    def _append_below(self) -> None:
        self._pieces += self._below
        self._below.clear()

    def handle_data(self, data: str) -> None:
        if self._skipped:
            return
        for k, piece in enumerate(PLACE.split(data)):
            if k % 2 == 0:
                self._pieces.append(escape(piece, quote=False))
                continue
            display = self._displays[int(piece)]
            inside, below = self._formula(display)
            if display.is_inline:
                self._pieces.append(inside)
                self._below.append(below)
                continue
            around = list(takewhile(DIVIDED.__contains__, reversed(self._open)))
            self._pieces += [f"</{tag}>" for tag in around]
            self._append_below()
            self._pieces += [inside, below, *(f"<{tag}>" for tag in reversed(around))]
