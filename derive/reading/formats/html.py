"""HTML: formulas as MathJax and KaTeX find them, and the LaTeX that stands beside MathML."""

import re
from collections.abc import Iterator
from html import unescape

from derive.reading.formats.tex import environments
from derive.reading.plain_formulas import BLOCK
from derive.reading.scanning import BLANK_LINE, Delimiter, Excerpt, UnreadDisplay, scanned

KIND, SUFFIXES = "html", (".html", ".htm")
#: Elements whose text is shown as it stands, or not at all.
RAW = r"(?i:<(?:script|style|pre|code|textarea|noscript|svg|head|title)\b[^<>]*+>)"
#: Text as it stands, in which there can be formulas.
PREFORMATTED = r"(?i:<pre\b[^<>]*+>(?:\s*<code>)?)"
#: Tags, comments, and the ends of blocks of text, at which a formula ends.
TAG, COMMENT = r"</?[A-Za-z][^<>]*+>", "<!--"
BLOCK_END = r"(?i:</(?:p|div|li|td|body|h\d)\b)"
ENTITY = re.compile(r"&(?:#\d{1,7}|#[xX][\dA-Fa-f]{1,6}|[A-Za-z]\w{1,31});")
MATHML, LATEX = "(?P<end>(?i:</math\\s*+>))", r"application/x-tex[^<>]*+>([^<]*+)"
SCRIPT = r"(?i:<script\b[^<>]{0,200}?math/tex"


def raw_end(opening: re.Match[str]) -> str:
    """The closing tag of the element that `opening` starts."""
    name = re.findall("[A-Za-z]+", opening.group())[0]
    return rf"(?P<end>(?i:</{name}\b))"


#: Elements of the class ``math`` that hold LaTeX without delimiters, as KaTeX gets it of Pandoc.
CLASS, BARE = r"\b[^<>]{0,200}?\bclass=[\"'][^\"'<>]*\bmath", r"\b[^<>]*+>)(?!\s*(?:\\[(\[]|[$<]))"
ELEMENTS = (
    Delimiter(rf"(?i:<(?:div{CLASS}|span{CLASS}[ -]display){BARE}", raw_end, "math/tex"),
    Delimiter(rf"(?i:<span{CLASS}{BARE}", raw_end, "math/tex", is_inline=True),
)
#: Formulas in MathML.
MATH = (
    Delimiter(r"(?i:<math\b[^<>]{0,300}?display=[\"']?block[^<>]*+>)", MATHML, "math", inner=LATEX),
    Delimiter(r"(?i:<math\b[^<>]*+>)", MATHML, "math", is_inline=True, inner=LATEX),
)

TOKENS = (
    Delimiter(COMMENT, r"(?P<end>-->)"),
    Delimiter(SCRIPT + r";\s*mode=display[^<>]*+>)", r"(?P<end>(?i:</script))", "math/tex"),
    Delimiter(SCRIPT + r"[^<>]*+>)", r"(?P<end>(?i:</script))", "math/tex", is_inline=True),
    *MATH,
    *ELEMENTS,
    Delimiter(PREFORMATTED, raw_end, BLOCK, is_inline=True),
    Delimiter(RAW, raw_end),
    Delimiter(TAG),
    Delimiter(r"\\[\\$]"),
    Delimiter(r"\$\$", rf"\\[\\$]|(?P<end>\$\$)|(?P<stop>{BLOCK_END})", "$$"),
    Delimiter(r"\\\[", rf"\\\\|(?P<end>\\\])|(?P<stop>\\\[|{BLOCK_END})", r"\["),
    Delimiter(r"\\\(", rf"\\\\|(?P<end>\\\))|(?P<stop>\\\(|{BLANK_LINE}|{BLOCK_END})", r"\(", True),
    Delimiter(
        r"\$(?![\s$])",
        rf"\\.|(?P<end>(?<!\s)\$(?![\d$]))|(?P<stop>\$|{BLANK_LINE}|<(?!br)[A-Za-z/!])",
        "$",
        is_inline=True,
    ),
    *environments(r"\\\\"),
)


def excerpts(text: str) -> Iterator[Excerpt | UnreadDisplay]:
    """The formulas of a page."""
    return scanned(text, TOKENS)


def decoded(text: str, excerpt: Excerpt) -> str:
    """Characters in place of entities, and spaces in place of tags and comments."""
    latex = text[excerpt.start : excerpt.end]
    spaced = re.sub(rf"{TAG}|<!--.*?-->", lambda tag: " " * len(tag[0]), latex, flags=re.S)
    return characters(spaced)


def prose(text: str) -> str:
    """The text as HTML."""
    return text


def characters(latex: str) -> str:
    """Characters in place of entities; the length stays the same."""
    return ENTITY.sub(lambda one: unescape(one[0]).rjust(len(one[0])), latex)
