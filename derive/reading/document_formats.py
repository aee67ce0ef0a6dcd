"""Documents of any kind as text with displays; nothing that they contain is executed."""

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from importlib import import_module
from itertools import accumulate
from pathlib import Path
from pkgutil import iter_modules
from types import ModuleType

from derive.reading import formats
from derive.reading.document import CodeCell, Display, Document, Kind, Place
from derive.reading.formats import notebook, tex
from derive.reading.plain_formulas import PLAIN, with_plain_formulas
from derive.reading.scanning import Excerpt, UnreadDisplay
from solvers.io.toml_input import InputError, read_bytes

#: Bytes of the largest document and of the largest notebook, most of which are outputs.
MAX_BYTES, MAX_NOTEBOOK_BYTES = 2_000_000, 20_000_000
#: Displays of a document, and all of its formulas.
MAX_DISPLAYS, MAX_FORMULAS = 2_000, 20_000
#: Places that a note lists.
MAX_PLACES = 5


def known_formats() -> dict[Kind, ModuleType]:
    """All formats by their kinds: every file in the package `formats` is one."""
    names = (f"{formats.__name__}.{one.name}" for one in iter_modules(formats.__path__))
    return {module.KIND: module for module in map(import_module, names)}


def kinds() -> dict[str, Kind]:
    """Kinds of documents by the suffixes of their files."""
    return {suffix: kind for kind, one in known_formats().items() for suffix in one.SUFFIXES}


def read_document(path: str | os.PathLike[str]) -> Document:
    """Read the formulas of a document, whose kind is that of its file's suffix.

    Raises
    ------
    InputError
        If there is no such file, its kind is unknown, it is too large, or it is no text.
    """
    file = Path(path)
    kind = kinds().get(file.suffix.lower())
    if kind is None:
        raise InputError(f"{file} is no document: documents end in {', '.join(kinds())}")
    most = MAX_NOTEBOOK_BYTES if kind == "notebook" else MAX_BYTES
    try:
        text = _text(file, read_bytes(file, most))
    except OSError as error:
        raise InputError(f"{file}: {error.strerror or error}") from error
    return _notebook(file, text) if kind == "notebook" else _document(file, kind, text)


def _text(file: Path, content: bytes) -> str:
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")  # older documents; the formulas are in ASCII
    if "\0" in text:
        raise InputError(f"{file} is no text: it contains the character NUL")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _document(file: Path, kind: Kind, text: str) -> Document:
    empty = Document(str(file), kind, text, ())
    if kind == "latex":
        return _scanned(empty, [(0, text)], tex.definitions(text), tex.notes(text))
    return _scanned(empty, [(0, text)], tex.definitions(text, comment="(?!)"), ())


def _notebook(file: Path, content: str) -> Document:
    try:
        cells = notebook.cells(content)
    except ValueError as error:
        raise InputError(f"{file}: {error}") from error
    starts = tuple(accumulate((len(cell.text) + 1 for cell in cells), initial=0))[:-1]
    placed = list(enumerate(zip(starts, cells, strict=True), 1))
    empty = Document(
        str(file),
        "notebook",
        "\n".join(cell.text for cell in cells),
        (),
        cells=starts,
        programs=tuple(CodeCell(n, at, c.language, c.text) for n, (at, c) in placed if c.language),
    )
    parts = [(start, cell.text) for _, (start, cell) in placed if cell.is_markdown]
    definitions = [one for _, part in parts for one in tex.definitions(part, comment="(?!)")]
    return _scanned(empty, parts, tuple(definitions), ())


def _scanned(
    document: Document,
    parts: Sequence[tuple[int, str]],
    definitions: tuple[str, ...],
    notes: tuple[str, ...],
) -> Document:
    """The document with the formulas of its parts, each of which starts at a position."""
    form = known_formats()[document.kind]
    displays: list[Display] = []
    unread: dict[str, list[Place]] = {}
    result = (
        (offset, part, one)
        for offset, part in parts
        for one in with_plain_formulas(part, form.excerpts(part))
    )
    for count, (offset, part, one) in enumerate(result):
        if count == MAX_FORMULAS:
            raise InputError(f"{document.file} has more than {MAX_FORMULAS} formulas")
        if isinstance(one, UnreadDisplay):
            place = document.place(offset + one.start)
            unread.setdefault(one.reason, []).append(place)
        elif latex := _source(form, part, one).rstrip():
            start = offset + one.start + len(latex) - len(latex.lstrip())
            displays.append(_display(document, start, latex.lstrip(), offset, one))
    if sum(not one.is_inline for one in displays) > MAX_DISPLAYS:
        raise InputError(f"{document.file} has more than {MAX_DISPLAYS} displays")
    numbers = accumulate(int(not one.is_inline) for one in displays)
    numbered = (
        one if one.is_inline else replace(one, number=number)
        for one, number in zip(displays, numbers, strict=True)
    )
    return replace(
        document,
        displays=tuple(joined(numbered, document.text)),
        definitions=definitions,
        notes=(*notes, *(_note(reason, places) for reason, places in unread.items())),
    )


def _source(form: ModuleType, text: str, excerpt: Excerpt) -> str:
    """The formula of an excerpt; in plain text nothing is encoded."""
    is_plain = excerpt.delimiter == PLAIN
    return text[excerpt.start : excerpt.end] if is_plain else str(form.decoded(text, excerpt))


def _note(reason: str, places: Sequence[Place]) -> str:
    shown = [f"{f'cell {p.cell}, ' if p.cell else ''}line {p.line}" for p in places[:MAX_PLACES]]
    more = len(places) - len(shown)
    return f"{'; '.join(shown)}{f' and {more} more' if more else ''}: {reason}"


def _display(document: Document, start: int, latex: str, offset: int, excerpt: Excerpt) -> Display:
    line, column, cell = document.place(start)
    return Display(
        number=0,
        line=line,
        column=column,
        start=start,
        latex=latex,
        extent=(offset + excerpt.extent[0], offset + excerpt.extent[1]),
        delimiter=excerpt.delimiter,
        is_inline=excerpt.is_inline,
        cell=cell,
    )


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
            before = replace(
                before,
                latex=latex,
                extent=(before.extent[0], one.extent[1]),
                number=max(before.number, one.number),
            )
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
        and BETWEEN.match(text, before.extent[1], one.extent[0]) is not None
        and bool(ENDS.search(before.latex) or STARTS.match(one.latex))
    )
