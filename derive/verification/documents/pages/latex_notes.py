"""Verdicts in LaTeX: as notes in the margin of a document, or as a list of its formulas."""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import get_args

from derive.reading.document import Document
from derive.reading.formats.tex import BODY
from derive.reading.latex.display_reader import Macro, macros_of
from derive.verification.documents.pages.latex_text import COMMANDS, code, escaped, formula
from derive.verification.documents.pages.verdicts_in_place import (
    REFUTED,
    DocumentVerdicts,
    FormulaVerdict,
)
from derive.verification.judging.verdict import VerdictName

#: A note in the margin; in the line where there is no margin, as in boxes, floats and slides.
NOTE = r"""% Verdicts of holonomic verify
\usepackage{amsmath}
\makeatletter
\newcommand{\formulaverdict@inline}[1]{{\normalfont\scriptsize\ [#1]}}
\DeclareRobustCommand{\formulaverdict}[1]{%
  \ifmmode\else
    \ifinner\formulaverdict@inline{#1}%
    \else\marginpar{\normalfont\scriptsize\raggedright #1}\fi
  \fi}
\g@addto@macro\@arrayparboxrestore{\let\formulaverdict\formulaverdict@inline}
\@ifclassloaded{beamer}{\let\formulaverdict\formulaverdict@inline}{}
\makeatother
"""
HEAD = r"""\documentclass{article}
\usepackage{amsmath}
\setlength{\parindent}{0pt}
"""
BEGIN, END = r"\begin{document}", r"\end{document}"


def latex_notes(verdicts: DocumentVerdicts, document: Document) -> str:
    """The document with its verdicts in the margin and their details at its end.

    Of a document that is no complete LaTeX, the formulas are listed instead. The result compiles
    if the document does, with amsmath.
    """
    text = document.text
    opening, end = BODY.search(text), text.rfind(END)
    if document.kind != "latex" or not opening or end < opening.end():
        return _listed(verdicts, document)
    position = opening.end()
    pieces = [text[: position - len(BEGIN)], NOTE, BEGIN]
    for place, note in sorted(_notes(verdicts, document)):
        if place > position:
            pieces += [text[position:place], note]
            position = place
    macros = macros_of("\n".join(document.definitions))
    details = "\n".join(
        _entry(one, macros) for one in verdicts.formulas if one.verdict in REFUTED or one.note
    )
    name = escaped(Path(verdicts.file).name)
    title = rf"\clearpage\noindent\textbf{{Verdicts on the formulas of {name}}}"
    closing = f"\n{title}\n{_summary(verdicts)}\n{details}\n"
    return "".join([*pieces, text[position:end], closing, text[end:]])


def _notes(verdicts: DocumentVerdicts, document: Document) -> Iterator[tuple[int, str]]:
    """Places and texts of notes: before displays, and after inline formulas."""
    for display in document.displays:
        within = [one for one in verdicts.formulas if one.is_in(display)]
        if within:
            lines = dict.fromkeys(_short(one) for one in within)
            start, end = display.extent
            yield end if display.is_inline else start, _note(r"\newline ".join(lines))


def _note(text: str) -> str:
    return rf"\formulaverdict{{{text}}}"


def _short(one: FormulaVerdict) -> str:
    text = f"{one.line}: {one.verdict}"
    return rf"\textbf{{{text}}}" if one.verdict in REFUTED else text


def _listed(verdicts: DocumentVerdicts, document: Document) -> str:
    """A document that lists the formulas with their verdicts."""
    definitions = _provided(document.definitions)
    is_program = document.kind == "program"
    macros = None if is_program else macros_of("\n".join(definitions))
    entries = "\n".join(_entry(one, macros) for one in verdicts.formulas)
    title = rf"\textbf{{\large Verdicts on the formulas of {escaped(Path(verdicts.file).name)}}}"
    body = f"{title}\n{_summary(verdicts)}\n{entries}"
    return "\n".join([HEAD + "\n".join(definitions), BEGIN, body, END, ""])


def _provided(definitions: Sequence[str]) -> list[str]:
    """Definitions of macros by known commands, which leave alone those that LaTeX has."""
    provided: dict[str, None] = {}
    for definition in definitions:
        words = re.findall(r"\\([A-Za-z]+)", definition)
        is_command = words[0] in ("newcommand", "renewcommand", "providecommand")
        if is_command and COMMANDS.issuperset(words[2:]):
            provided[definition.replace(words[0], "providecommand", 1)] = None
    return list(provided)


def _summary(verdicts: DocumentVerdicts) -> str:
    counts = Counter(one.verdict for one in verdicts.formulas)
    numbers = ", ".join(f"{counts[one]} {one}" for one in get_args(VerdictName) if counts[one])
    system = [f"System: {escaped(verdicts.system)}."] if verdicts.system else []
    lines = [*system, f"Formulas: {numbers or 'none'}.", *map(escaped, verdicts.remarks)]
    return "".join(f"\n\\par\\noindent {line}" for line in lines)


def _entry(one: FormulaVerdict, macros: Mapping[str, Macro] | None) -> str:
    """A formula with its verdict and all details."""
    place = f"Cell {one.cell}, line {one.line}" if one.cell else f"Line {one.line}"
    details = [
        _written(one.latex, macros),
        *(f"{title}: {text}" for title, text in _details(one, macros) if text),
    ]
    lines = "".join(f"\n\\par\\noindent {detail}" for detail in details)
    head = f"{place}: {one.verdict}" + (f" (display {one.display})" if one.display else "")
    return rf"\par\medskip{{\raggedright\noindent\textbf{{{head}}}{lines}\par}}"


def _written(text: str, macros: Mapping[str, Macro] | None) -> str:
    """A formula in LaTeX, or one of a program, which has no macros."""
    return formula(text, macros) if macros is not None else code(text)


def _details(one: FormulaVerdict, macros: Mapping[str, Macro] | None) -> Iterator[tuple[str, str]]:
    yield "wrong term", _written(one.wrong_term, macros)
    yield "correct formula", _written(one.correction, macros)
    yield "value", escaped(one.witness)
    yield "state", ", ".join(_written(number, macros) for number in one.state.split(", ") if number)
    yield "note", escaped(one.note)
