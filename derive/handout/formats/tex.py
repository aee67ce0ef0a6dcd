"""Documents as LaTeX, for the packages of texlive-latex-base."""

import unicodedata
from collections.abc import Callable, Iterable, Sequence
from textwrap import TextWrapper

from derive.formulas.typeset.latex import latex
from derive.formulas.typeset.lettering import GREEK
from derive.formulas.typeset.line_breaks import latex_rows
from derive.handout.document_model import (
    WIDTH,
    Block,
    Code,
    HandoutDocument,
    HandoutTable,
    NumberedEquation,
    Paragraph,
    pieces,
)

SPECIAL = {
    **{character: rf"\{character}" for character in "#$%&_{}"},
    "\\": r"\textbackslash{}",
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
    **{character: f"${character}$" for character in "<>|"},
}
#: Characters that LaTeX sets itself.
KNOWN = set("–—‘’“”…")
#: Accents after the letter in decomposed characters, and their commands.
ACCENTS = dict(zip("\u0300\u0301\u0302\u0303\u0308\u030a\u030c\u0327", "`'^~\"rvc", strict=True))
#: Letters with a command of their own.
LETTERS = dict(zip("ßæÆœŒøØłŁ", "ss ae AE oe OE o O l L".split(), strict=True))
MATHEMATICS = {
    **{letter: rf"\{name}" for name, letter in GREEK.items()},
    **{
        character: f"^{{{digit}}}"
        for character, digit in zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-", strict=True)
    },
    **{character: f"_{digit}" for digit, character in enumerate("₀₁₂₃₄₅₆₇₈₉")},
    **dict(zip("·×−°±≤≥", r"\cdot \times - ^\circ \pm \le \ge".split(), strict=True)),
    **dict(zip("≠≈→∞∂′", r"\ne \approx \to \infty \partial '".split(), strict=True)),
    **dict(zip("½Σµᵀ", r"\frac12 \Sigma \mu ^T".split(), strict=True)),
}


def escaped(text: str) -> str:
    """`text` with the characters that have a meaning in LaTeX as commands."""
    return "".join(SPECIAL.get(character, character) for character in text)


def declarations(texts: Iterable[str]) -> list[str]:
    """LaTeX that declares the other characters of texts, in the order of their numbers.

    A character without a command is shown by its number.
    """
    characters = {c for text in texts for c in text if not c.isascii()} - KNOWN
    return [
        rf"\DeclareUnicodeCharacter{{{ord(character):04X}}}{{{_command(character)}}}"
        for character in sorted(characters)
    ]


def _command(character: str) -> str:
    if character in MATHEMATICS:
        return rf"\ensuremath{{{MATHEMATICS[character]}}}"
    if character in LETTERS:
        return rf"\{LETTERS[character]}{{}}"
    decomposed = unicodedata.normalize("NFD", character)
    base, mark = decomposed[0], decomposed[1:]
    if base.isascii() and base.isalpha() and mark in ACCENTS:
        return rf"\{ACCENTS[mark]}{{{base}}}"
    return f"[U+{ord(character):04X}]"


DOCUMENT = r"""\documentclass[11pt,a4paper,fleqn]{article}
\usepackage[margin=22mm]{geometry}
\usepackage{amsmath,longtable}
\setlength{\parindent}{0pt}
\setlength{\parskip}{0.5\baselineskip}
\allowdisplaybreaks
@declarations@\title{@title@}
\author{}
\date{}
\begin{document}
\maketitle
\abovedisplayskip 6pt plus 3pt
\belowdisplayskip 6pt plus 3pt
@body@
\end{document}
"""

#: The space for a line of a formula that is left blank, and its width.
BLANK, LINE = r"\underline{\hspace{24em}}", r"2\baselineskip"


#: Characters of the longest line of code.
CODE_WIDTH = 96
#: Characters of the longest text in the last column of a table that is not wrapped.
WIDE = 50


def tex(document: HandoutDocument) -> str:
    """The text of a ``.tex`` file."""
    parts: list[str] = []
    for section in document.sections:
        parts.append(f"\n\\section{{{escaped(section.title)}}}\n")
        parts += map(_block, section.blocks)
    body = "\n".join(parts)
    declared = "".join(f"{line}\n" for line in declarations([document.title, body]))
    filled = DOCUMENT.replace("@declarations@", declared)
    return filled.replace("@title@", escaped(document.title)).replace("@body@", body)


def equation_rows(equation: NumberedEquation) -> list[str]:
    """The rows of a formula for ``aligned``; a blank takes the place of the derived side."""
    if not equation.is_blank:
        return latex_rows(equation.sides, WIDTH)
    before, after = equation.known
    first, *others = map(latex, before)
    return [" = ".join([f"{first} & ", *others, BLANK, *map(latex, after)])]


def aligned(equation: NumberedEquation) -> str:
    """A formula in one environment, for a display without numbers of its own."""
    rows = " \\\\\n".join(equation_rows(equation))
    return f"\\begin{{aligned}}\n{rows}\n\\end{{aligned}}"


def _block(block: Block) -> str:
    match block:
        case Paragraph(text):
            return f"\n{_text(text)}"
        case NumberedEquation(number=number):
            text = " \\notag \\\\\n".join(f"  {row}" for row in equation_rows(block))
            display = f"\\begin{{align}}\n{text} \\tag{{{number}}}\n\\end{{align}}"
            return display + rf"\vspace{{{LINE}}}" * block.is_blank
        case HandoutTable(head, rows):
            return _table(head, rows)
        case Code(language, text):
            code = "\n".join(map(_wrapped, text.splitlines()))
            verbatim = f"\\begin{{verbatim}}\n{code}\n\\end{{verbatim}}"
            return f"\n{escaped(language)}:\n\n{{\\footnotesize\n{verbatim}\n}}"


def with_formulas(text: str, escape: Callable[[str], str]) -> str:
    """Text with its formulas between dollar signs, the rest with characters escaped."""
    return "".join(
        f"${latex(piece.tree)}$" if piece.tree else escape(piece.text) for piece in pieces(text)
    )


def _text(text: str) -> str:
    return with_formulas(text, escaped)


def _wrapped(line: str) -> str:
    """A line of code, continued after a backslash where it is too long."""
    indent = " " * (len(line) - len(line.lstrip()) + 4)
    wrapper = TextWrapper(CODE_WIDTH, subsequent_indent=indent, break_on_hyphens=False)
    return " \\\n".join(wrapper.wrap(line)) if len(line) > CODE_WIDTH else line


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    is_wide = max(len(row[-1]) for row in rows) > WIDE
    columns = "l" * (len(head) - 1) + (r"p{0.55\linewidth}" if is_wide else "l")
    lines = [" & ".join(map(_text, row)) + r" \\" for row in (head, *rows)]
    body = "\n".join([lines[0], r"\hline", r"\endhead", *lines[1:]])
    return f"\\begin{{longtable}}[l]{{{columns}}}\n{body}\n\\end{{longtable}}"
