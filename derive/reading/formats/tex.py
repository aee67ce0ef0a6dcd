r"""LaTeX: displays, inline formulas, definitions of macros.

Comments and verbatim text are skipped. ``\input`` and ``\include`` are not followed.
"""

import re
from collections.abc import Iterator
from html import escape
from unicodedata import normalize

from derive.reading.scanning import (
    BLANK_LINE,
    Delimiter,
    Excerpt,
    UnreadDisplay,
    environment,
    scanned,
)

KIND, SUFFIXES = "latex", (".tex",)
#: Escaped characters, which are no delimiters; comments, up to the end of the line.
ESCAPED, COMMENT = r"\\[\\$%]", r"%[^\n]*+"
VERBATIM = r"\\begin[ \t]*+\{(?:(?:verbatim|Verbatim|lstlisting|minted|comment|filecontents)\*?)\}"
DISPLAYS = (
    r"\\begin[ \t]*+\{(?:(?:equation|align|gather|multline|eqnarray|flalign|x?alignat|dmath|"
    r"IEEEeqnarray)\*?|displaymath|empheq)\}"
)
BRACES = "[^{}]*+"
for _ in range(4):  # nested to this depth
    BRACES = rf"(?:[^{{}}]|\{{{BRACES}\}})*+"
MACRO = r"\\[A-Za-z@]++"
DEFINITION = (
    rf"(?:\\(?:(?:re|provide)?newcommand|DeclareRobustCommand|DeclareMathOperator)\*?\s*+"
    rf"(?:\{{\s*+{MACRO}\s*+\}}|{MACRO})\s*+(?:\[\d\]\s*+)?(?:\[[^\]\n]*+\]\s*+)?"
    rf"|\\g?def\s*+{MACRO}[#\d]*+)(?:\{{{BRACES}\}}|{MACRO})"
)
SHORTHAND = re.compile(rf"({MACRO})[ \t}}]*+\{{\s*+(\\(begin|end)\s*+\{{([a-z]+\*?)\}})\s*+\}}")
BODY = re.compile(r"^[^%\n]*?\\begin\{document\}", re.M)
BODY_END = re.compile(r"^[^%\n]*?(?=\\end\{document\})", re.M)
INCLUDED = re.compile(r"^[^%\n]*?(\\(?:input|include|subfile)\b[^%\n]{0,80})", re.M)


ARGUMENT = rf"\{{({BRACES})\}}"
#: Text in LaTeX, after escapes of HTML, and what stands for it in a page, in this order.
PROSE = (
    (rf"\\(?:title|part|chapter|(?:sub)*section|paragraph)\*?\s*(?:\[[^\]]*\]\s*)?{ARGUMENT}",
     r"\n\n<h3>\1</h3>\n\n"),
    (r"\\begin\s*\{(?:itemize|enumerate|description)\}(?:\[[^\]]*\])?", "\n\n<ul>"),
    (r"\\end\s*\{(?:itemize|enumerate|description)\}", "</ul>\n\n"),
    (r"\\item(?![A-Za-z])\s*(?:\[([^\]]*)\])?", r"<li>\1 "),
    (r"\\begin\s*\{abstract\}", r"\n\n"),
    (rf"\\begin\s*\{{[^{{}}]*\}}(?:\[[^\]]*\])?(?:{ARGUMENT})?", r"\n\n"),
    (r"\\end\s*\{[^{}]*\}", r"\n\n"),
    (rf"\\(?:label|index|bibliography|bibliographystyle|[vh]space|includegraphics|input|include|"
     rf"usepackage|documentclass|pagestyle|thispagestyle|setlength|setcounter|hypersetup|"
     rf"newtheorem)\*?(?:\[[^\]]*\]|{ARGUMENT})*", ""),
    (rf"\\(?:eq|auto|c|C)?ref\*?{ARGUMENT}", r"(\1)"),
    (rf"\\[a-z]*cite[a-z]*\*?(?:\[[^\]]*\])*{ARGUMENT}", r"[\1]"),
    (rf"\\href\s*\{{[^{{}}]*\}}{ARGUMENT}", r"\1"),
    (rf"\\footnote{ARGUMENT}", r" (\1)"),
    *((rf"\\(?:{command}){ARGUMENT}", rf"<{tag}>\1</{tag}>")
      for command, tag in (("emph|textit|textsl", "em"), ("textbf", "strong"), ("texttt", "code"))
      for _ in range(2)),  # nested
    (r"\\\\\*?(?:\[[^\]]*\])?", "<br>"), (r"(?<!\\)&amp;", " "), ("(?<!\\\\)~", "\u00a0"),
    *((rf"\\{mark}\s*(?:\{{\\?(\w)\}}|\\?(\w))", rf"\1\2{accent}") for mark, accent in (
        ("`", "\u0300"), ("'", "\u0301"), (r"\^", "\u0302"), ("~", "\u0303"), ('"', "\u0308"))),
    ("``", "\u201c"), ("''", "\u201d"), ("`", "\u2018"), ("---", "\u2014"), ("--", "\u2013"),
    (r"\\c\s*\{(\w)\}", "\\1\u0327"), (r"\\ss(?![A-Za-z])\s*", "\u00df"),
    (r"\\([%$#_{}])", r"\1"), (r"\\&amp;", "&amp;"), (r"\\[,;:! ]", " "),
    (r"\\[A-Za-z@]+\*?[ \t]*|[{}]", ""),
)  # fmt: skip


def definitions(text: str, comment: str = COMMENT) -> tuple[str, ...]:
    """The definitions of macros outside of comments."""
    result = re.finditer(rf"(?s){ESCAPED}|{comment}|(?P<definition>{DEFINITION})", text)
    return tuple(one["definition"] for one in result if one["definition"])


def environments(passed: str) -> tuple[Delimiter, ...]:
    """Environments of formulas, at whose end `passed` is passed over."""

    def closing(opening: re.Match[str]) -> str:
        return rf"{passed}|(?P<end>\\end[ \t]*+\{{{re.escape(environment(opening))}\}})"

    inline = r"\\begin[ \t]*+\{math\}"
    return (
        Delimiter(DISPLAYS, closing, r"\begin", is_environment=True),
        Delimiter(inline, closing, r"\begin", is_inline=True, is_environment=True),
    )


def excerpts(text: str) -> Iterator[Excerpt | UnreadDisplay]:
    """The formulas of a text in LaTeX: between the document's begin and end if it has them."""
    passed = rf"{ESCAPED}|{COMMENT}"
    tokens = (
        Delimiter(ESCAPED),
        Delimiter(COMMENT),
        Delimiter(DEFINITION),
        Delimiter(r"\\(?:verb|lstinline)\*?[^\w\s*]", _verb),
        Delimiter(VERBATIM, lambda one: rf"(?P<end>\\end\{{{re.escape(environment(one))}\}})"),
        Delimiter(r"\\iffalse\b", r"(?P<end>\\fi\b)"),
        Delimiter(r"\$\$", rf"{passed}|(?P<end>\$\$)", "$$"),
        Delimiter(r"\$", rf"{passed}|(?P<end>\$)|(?P<stop>{BLANK_LINE})", "$", is_inline=True),
        Delimiter(r"\\\[", rf"{passed}|(?P<end>\\\])|(?P<stop>\\\[)", r"\["),
        Delimiter(
            r"\\\(", rf"{passed}|(?P<end>\\\))|(?P<stop>\\\(|{BLANK_LINE})", r"\(", is_inline=True
        ),
        *environments(passed),
        *_shorthands(text, passed),
    )
    begin, end = BODY.search(text), BODY_END.search(text)
    start = begin.end() if begin else 0
    yield from scanned(text, tokens, start, end.end() if end else None)


def notes(text: str) -> tuple[str, ...]:
    """Files that the document includes, which are not read."""
    result = [one[1].strip() for one in INCLUDED.finditer(text)]
    more = f" and {len(result) - 5} more" if len(result) > 5 else ""
    return (f"not followed: {', '.join(result[:5])}{more}",) if result else ()


def prose(text: str) -> str:
    """The text of the document's body as HTML; commands of other packages leave their arguments."""
    begin, end = BODY.search(text), BODY_END.search(text)
    text = text[begin.end() if begin else 0 : end.end() if end else None]
    text = re.sub(rf"(?<!\\){COMMENT}\n?[ \t]*", "", text)
    pieces = re.split(rf"{VERBATIM}((?:.|\n)*?)\\end\{{\w+\*?\}}", re.sub(DEFINITION, "", text))
    return "".join(
        f"<pre>{escape(piece)}</pre>" if k % 2 else _paragraphs(piece)
        for k, piece in enumerate(pieces)
    )


def _paragraphs(text: str) -> str:
    text = escape(text, quote=False)
    for pattern, replacement in PROSE:
        text = re.sub(pattern, replacement, text)
    return "".join(f"<p>{one}" for one in re.split(BLANK_LINE, normalize("NFC", text)))


def _verb(opening: re.Match[str]) -> str:
    return rf"(?P<end>{re.escape(opening.group()[-1])}|$)"


def _shorthands(text: str, passed: str) -> Iterator[Delimiter]:
    r"""Delimiters such as ``\be`` and ``\ee`` that the document defines for environments."""
    macros: dict[tuple[str, str], list[str]] = {}
    for definition in definitions(text):
        if result := SHORTHAND.search(definition):
            macros.setdefault((result[3], result[4]), []).append(re.escape(result[1]))
    for (word, name), opening in macros.items():
        if word == "begin" and (end := macros.get(("end", name))):
            closing = rf"{passed}|(?P<end>(?:{'|'.join(end)})(?![A-Za-z]))"
            yield Delimiter(rf"(?:{'|'.join(opening)})(?![A-Za-z])", closing, name)


def decoded(text: str, excerpt: Excerpt) -> str:
    """The LaTeX as it stands, with its comments."""
    return text[excerpt.start : excerpt.end]
