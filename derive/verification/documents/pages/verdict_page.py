"""A page that shows documents with the verdicts on their formulas, in one file."""

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import TypeAlias, get_args

from derive.reading.document import CodeCell, Display, Document
from derive.reading.formats.tex import DEFINITION
from derive.reading.latex.display_reader import Macro, formulas, macros_of
from derive.reading.latex.tree import Span, Statement
from derive.reading.prose import FormulaMarkup, prose
from derive.verification.documents.pages.mathml import statement_html
from derive.verification.documents.pages.verdicts_in_place import (
    REFUTED,
    DocumentVerdicts,
    FormulaVerdict,
    one_line,
)
from derive.verification.judging.verdict import VerdictName
from solvers.io.html_page import html_page

#: The macros of a document in LaTeX; None for a program.
Macros: TypeAlias = Mapping[str, Macro] | None

STYLE = Path(__file__).with_name("page.css")
#: Marks of what verdicts rest on.
BASES = {
    "document": ("●", "by the document's own positions, energies or equations, or the options"),
    "known system": ("○", "by a known system that fits other formulas of the document"),
}
#: Parts of LaTeX that are compared.
TOKEN = re.compile(r"\\[A-Za-z]+|\\.|[^\s\\]")


def page(documents: Sequence[tuple[DocumentVerdicts, Document]]) -> str:
    """The page, as HTML without references to other files.

    It has the text of documents, their formulas, and the verdicts in the margin.

    Parameters
    ----------
    documents
        The verdicts on each document, and the document as read.
    """
    names = ", ".join(Path(verdicts.file).name for verdicts, _ in documents)
    title = f"Verdicts on {names}"
    sections = "\n".join(
        _section(*one, f"<h2>{escape(Path(one[0].file).name)}</h2>" if len(documents) > 1 else "")
        for one in documents
    )
    counts = Counter(one.verdict for verdicts, _ in documents for one in verdicts.formulas)
    style = STYLE.read_text(encoding="utf-8") + "\n".join(map(_hidden, counts))
    body = f"""<header>
<h1>{escape(title)}</h1>
<p>Each formula is judged by computation. A term that is <span class="wrong-term">wrong</span> is
marked, and below it stands the <span class="right-term">correct</span> formula.</p>
{_legend(documents)}<form aria-label="Verdicts that are shown">{"".join(_switches(counts))}</form>
</header>
<main>
{sections}
</main>"""
    return html_page(title, body, style)


def _legend(documents: Sequence[tuple[DocumentVerdicts, Document]]) -> str:
    """The meaning of the marks beside verdicts."""
    used = {one.basis for verdicts, _ in documents for one in verdicts.formulas}
    words = "; ".join(f"{mark} {text}" for key, (mark, text) in BASES.items() if key in used)
    return f"<p>Judged {escape(words)}.</p>\n" if words else ""


def _switches(counts: Mapping[VerdictName, int]) -> Iterator[str]:
    """A switch with its number for each verdict."""
    for verdict in get_args(VerdictName):
        if number := counts.get(verdict):
            box = f'<input type="checkbox" id="show-{verdict}" checked>'
            yield f'<label class="{verdict}">{box} <b>{number}</b> {verdict}</label> '


def _hidden(verdict: VerdictName) -> str:
    return f"body:has(#show-{verdict}:not(:checked)) .formulas > .{verdict} {{ display: none; }}"


def _section(verdicts: DocumentVerdicts, document: Document, title: str) -> str:
    is_program = document.kind == "program"
    macros = None if is_program else macros_of("\n".join(document.definitions))
    remarks = [f"System: {verdicts.system}" if verdicts.system else "", *verdicts.remarks]
    remarks += [] if verdicts.formulas else ["It has no formulas."]
    notes = "".join(f"<p>{escape(one)}</p>" for one in remarks if one)
    text = _items(verdicts.formulas, None) if is_program else _text(verdicts, document, macros)
    return f"<section>{title}{notes}{text}</section>"


def _text(verdicts: DocumentVerdicts, document: Document, macros: Macros) -> str:
    """The text of a document, with its formulas and their verdicts."""
    remaining = dict.fromkeys(verdicts.formulas)

    def taken(is_own: Callable[[FormulaVerdict], bool]) -> list[FormulaVerdict]:
        own = [one for one in remaining if is_own(one)]
        for one in own:
            remaining.pop(one)
        return own

    def formula(display: Display) -> FormulaMarkup:
        own = taken(lambda one: one.is_in(display))
        if not own and not re.sub(DEFINITION, "", display.latex).strip():
            return FormulaMarkup("")
        if not display.is_inline:
            return FormulaMarkup(_items(own, macros) or _math(display.latex, macros))
        whole = ", ".join(_statements(display.latex, macros))
        words = " ".join(dict.fromkeys(one.verdict for one in own))
        shown = f'<span class="inline {words}" title="{words}">{whole}</span>' if own else whole
        return FormulaMarkup(shown, _items([one for one in own if one.verdict in REFUTED], macros))

    def program(cell: CodeCell) -> str:
        return _items(taken(lambda one: one.cell == cell.number), None)

    shown = prose(document, formula, program)
    return f'<div class="prose">{shown}</div>{_items([*remaining], macros)}'


def _items(formulas: Sequence[FormulaVerdict], macros: Macros) -> str:
    """Formulas with their verdicts, below each other."""
    if not formulas:
        return ""
    items = "\n".join(_item(one, macros) for one in formulas)
    return f'<ol class="formulas">\n{items}\n</ol>'


def _item(one: FormulaVerdict, macros: Macros) -> str:
    """A formula, with its verdict in the margin and details below it."""
    cell = f"cell {one.cell}, " if one.cell else ""
    display = f", display {one.display}" if one.display else ""
    mark, meaning = BASES.get(one.basis, ("", ""))
    basis = f' <abbr title="{escape(meaning)}">{mark}</abbr>' if mark else ""
    margin = (
        f'<div class="margin"><span class="word">{one.verdict}{basis}</span> '
        f"<span>{cell}line {one.line}{display}</span></div>"
    )
    wrong = [(a - one.span[0], b - one.span[0]) for a, b in one.wrong_spans]
    shown = _math(one.latex, macros, wrong, "wrong-term")
    details = "".join(
        f"<div><dt>{title}</dt><dd>{text}</dd></div>"
        for title, text in _details(one, macros)
        if text
    )
    return (
        f'<li class="{one.verdict}">{margin}<div class="statement">{shown}'
        f"{f'<dl>{details}</dl>' if details else ''}</div></li>"
    )


def _details(one: FormulaVerdict, macros: Macros) -> Iterator[tuple[str, str]]:
    if one.correction:
        changed = _changed(one.latex, one.correction)
        yield "should be", _math(one.correction, macros, changed, "right-term")
    yield "value", escape(one.witness)
    yield "state", ", ".join(_statements(one.state, macros)) if one.state else ""
    yield "note", escape(one.note)


def _math(latex: str, macros: Macros, marked: Sequence[Span] = (), word: str = "") -> str:
    """The statements of a formula, one below the other."""
    lines = _statements(latex, macros, marked, word)
    return "".join(f'<div class="formula">{line}</div>' for line in lines)


def _statements(
    latex: str, macros: Macros, marked: Sequence[Span] = (), word: str = ""
) -> list[str]:
    """The statements of a formula as MathML; its source if it is a program or cannot be read."""
    if macros is None:
        return [f"<code>{escape(latex)}</code>"]
    statements = formulas(latex, macros)
    read = [one for one in statements if isinstance(one, Statement)]
    if not read or len(read) < len(statements):
        return [f"<code>{escape(one_line(latex))}</code>"]
    return [statement_html(latex, one, marked, word) for one in read]


def _changed(latex: str, correction: str) -> list[Span]:
    """The part of a correction between the parts that it shares with the formula."""
    old, new = TOKEN.findall(latex), list(TOKEN.finditer(correction))
    words = [one.group() for one in new]
    start = 0
    while start < min(len(old), len(words)) and old[start] == words[start]:
        start += 1
    end = 0
    while end < min(len(old), len(words)) - start and old[-1 - end] == words[-1 - end]:
        end += 1
    last = len(words) - end
    return [(new[start].start(), new[last - 1].end())] if start < last else []
