r"""Markdown: ``$$``, ``\[``, fences, environments, and formulas in plain text in blocks of code."""

import re
from collections.abc import Iterator
from dataclasses import replace

from derive.reading.formats import html, restructuredtext
from derive.reading.formats.tex import environments
from derive.reading.plain_formulas import BLOCK, LANGUAGES, SPAN
from derive.reading.scanning import BLANK_LINE, Delimiter, Excerpt, UnreadDisplay, scanned

KIND, SUFFIXES = "markdown", (".md", ".markdown", ".txt")
#: The start of a line in a list or a quotation; an item of a list up to its text.
MARGIN = r"^[ \t>]*+(?:(?:[-*+]|\d{1,9}[.)])[ \t]++)?"
LIST_ITEM = re.compile(r"[ \t]*+(?:[-*+]|\d{1,9}[.)])[ \t]++(?=\S)")
INDENTED = "    "
INDENTED_ENVIRONMENT = re.compile(
    r"[ \t]*+\\begin\{(?:equation|align|gather|multline)\*?\}[ \t]*+$", re.MULTILINE
)
QUOTED = re.compile(r"^[ \t]*+>[ \t>]*+", re.M)
#: Backslashes that Markdown renderers remove, and the characters that they leave.
SINGLE = r"(?<!\\)\\([_*])|\\\\(\\\\)"
DOUBLED = re.compile(SINGLE + r"|\\(\\[{}|,;:!%&_#$])")
ESCAPES = re.compile(SINGLE)
#: Brackets in a text may be escaped; a formula has a relation or a command.
FORMULA = re.compile(r"=|\\[A-Za-z]")
#: Services that draw the formula in the address of an image.
SERVICE = (
    r"https?://(?:render\.githubusercontent\.com/render/math\?math=|"
    r"(?:latex|tex)\.[\w.-]{1,40}/[\w./-]{1,40}\?)"
)
IMAGE, ENCODED = "image", re.compile("%([0-7][0-9A-Fa-f])")
#: Characters in which text beside a formula is looked for.
NEAR = 100
#: A fence of code, and the name of a box of MyST, such as a note or a proof, which holds text.
FENCE = re.compile(MARGIN + r"(?P<mark>`{3,}|~{3,})[ \t]*+(?P<name>[^`\n]*+)$", re.MULTILINE)
BOX = re.compile(r"\{(?!code|math|eval|jupyter|literal|mermaid|raw)[\w:-]++\}")
#: A tag on one line.
TAG = r"</?[A-Za-z][^<>$\n]*+>"


def _fence_end(opening: re.Match[str]) -> str:
    mark = re.findall(r"`{3,}|~{3,}", opening.group())[0]
    return rf"(?P<end>^[ \t>]*+{mark[0]}{{{len(mark)},}}[ \t]*+$)"


def _code_end(opening: re.Match[str]) -> str:
    return rf"{_fence_end(opening)}|(?P<stop>\Z)"


def _span_end(opening: re.Match[str]) -> str:
    return rf"(?P<end>(?<!`){opening.group()}(?!`))|(?P<stop>{BLANK_LINE})"


MATH_BLOCK = Delimiter(
    MARGIN + r"(?:`{3,}|~{3,})[ \t]*+(?:math|\{math\})[ \t]*+$", _fence_end, "```math"
)
#: Code of no language; whether it contains formulas is seen below.
PLAIN_BLOCK = Delimiter(
    MARGIN + rf"(?:`{{3,}}|~{{3,}})[ \t]*+{LANGUAGES}[ \t]*+$", _code_end, BLOCK, is_inline=True
)
CODE_BLOCK = Delimiter(MARGIN + r"(?:`{3,}[^`\n]*+|~{3,}[^\n]*+)$", _code_end)
TOKENS = (
    Delimiter("<!--", "(?P<end>-->)"),
    Delimiter(rf"(?i:<img\b[^<>\n]{{0,200}}?src=\"){SERVICE}", r"(?P<end>\")|(?P<stop>\n)", IMAGE),
    Delimiter(
        rf"!\[[^\]\n]{{0,200}}\]\({SERVICE}", r"(?P<end>\)(?=[\s.,;:!?|]|\Z))|(?P<stop>\s)", IMAGE
    ),
    *html.MATH,
    Delimiter(html.RAW, html.raw_end),
    Delimiter(TAG),
    # inline formulas of GitHub and of Documenter.jl; code
    Delimiter(r"\$`", rf"(?P<end>`\$)|(?P<stop>{BLANK_LINE})", "$`", is_inline=True),
    Delimiter(r"(?<!`)``(?!`)(?=[^`\n]*\\[A-Za-z])", _span_end, "``", is_inline=True),
    Delimiter(r"(?<!`)`{1,3}(?!`)", _span_end, SPAN, is_inline=True),
    # brackets whose backslash is escaped
    Delimiter(r"\\\\\[", r"\\{4}|(?P<end>\\\\\])|(?P<stop>\\\\\[)", r"\\["),
    Delimiter(r"\\\\\(", rf"\\{{4}}|(?P<end>\\\\\))|(?P<stop>\\\\\(|{BLANK_LINE})", r"\\(", True),
    # dollars with a backslash each, as some sites need them
    Delimiter(r"^[ \t>]*+\\\$\$", rf"(?P<end>\\\$\$)|(?P<stop>{BLANK_LINE})", "$$"),
    Delimiter(r"\\[\\$`]"),
    Delimiter(r"\$\$", r"\\.|(?P<end>\$\$)", "$$"),
    Delimiter(r"\\\[", r"\\\\|(?P<end>\\\])|(?P<stop>\\\[)", r"\["),
    Delimiter(r"\\\(", rf"\\\\|(?P<end>\\\))|(?P<stop>\\\(|{BLANK_LINE})", r"\(", is_inline=True),
    # a price ends with a space or before a digit, and so does no formula
    Delimiter(
        r"\$(?=[^\s$])",
        rf"\\.|(?P<end>(?<!\s)\$(?![\d$]))|(?P<stop>\$|{BLANK_LINE})",
        "$",
        is_inline=True,
    ),
    Delimiter(
        r"\$(?=[ \t])", r"\\.|(?P<end>(?<=[ \t])\$(?!\d))|(?P<stop>\$|\n)", "$", is_inline=True
    ),
    *environments(r"\\\\"),
)


def excerpts(text: str) -> Iterator[Excerpt | UnreadDisplay]:
    """The formulas of a text."""
    code = _indented_code(text)
    indented = Delimiter(
        "^(?: {4}| {0,3}\t)", "(?P<end>$)", BLOCK, True, applies=lambda one: one.start() in code
    )
    fences = _fences_of_boxes(text)
    blocks = (
        replace(one, applies=lambda one: one.start() not in fences)
        for one in (PLAIN_BLOCK, CODE_BLOCK)
    )
    for result in scanned(text, (indented, MATH_BLOCK, *blocks, *TOKENS)):
        if isinstance(result, UnreadDisplay):
            yield result
        elif result.delimiter in ("$$", IMAGE):
            yield replace(result, is_inline=_is_in_sentence(text, result))
        elif result.delimiter != r"\[" or FORMULA.search(text, result.start, result.end):
            yield result


def _is_in_sentence(text: str, excerpt: Excerpt) -> bool:
    """Whether it is no equation, with text on its line: some renderers know no other delimiter."""
    start, end = excerpt.extent
    before = text[max(0, start - NEAR) : start].rpartition("\n")[2]
    after = text[end : end + NEAR].partition("\n")[0]
    has_text = any(map(str.isalnum, before + after))
    return has_text and not set("=\n") & set(text[excerpt.start : excerpt.end])


def _indented_code(text: str) -> frozenset[int]:
    """Where lines of indented code start: after an empty line, and four columns into the text.

    A block with an environment of formulas is none.
    """
    blocks, end = list[list[int]](), -1
    for start in _indented_lines(text):
        if end < 0 or text[end:start].strip():
            blocks.append([])
        blocks[-1].append(start)
        end = start + len(text[start:].partition("\n")[0])
    return frozenset(
        start
        for block in blocks
        if not any(INDENTED_ENVIRONMENT.match(text, start) for start in block)
        for start in block
    )


def _indented_lines(text: str) -> list[int]:
    starts, position, margin = list[int](), 0, 0
    is_code_allowed = True
    for line in text.split("\n"):
        spaced = line.expandtabs(4)
        indentation = len(spaced) - len(spaced.lstrip())
        if not line.strip():
            is_code_allowed = True
        elif item := LIST_ITEM.match(spaced):
            if indentation < margin + 4 or not is_code_allowed:
                margin, is_code_allowed = item.end(), False
            else:
                starts.append(position)
        else:
            if is_code_allowed and indentation < margin:
                margin = 0
            if is_code_allowed and indentation >= margin + 4:
                starts.append(position)
            else:
                is_code_allowed = False
        position += len(line) + 1
    return starts


def _fences_of_boxes(text: str) -> frozenset[int]:
    """Where the first and last lines of boxes start, in which there can be code and others."""
    result, opened = list[int](), list[tuple[str, bool]]()
    for fence in FENCE.finditer(text):
        mark, name = fence["mark"], fence["name"].strip()
        closes = bool(opened) and mark.startswith(opened[-1][0]) and not name
        if closes:
            _, is_box = opened.pop()
        elif opened and not opened[-1][1]:
            continue  # a line of code
        else:
            opened.append((mark, is_box := bool(BOX.match(name))))
        if is_box:
            result.append(fence.start())
    return frozenset(result)


def decoded(text: str, excerpt: Excerpt) -> str:
    """The LaTeX after Markdown's own escapes; the length stays the same."""
    latex = text[excerpt.start : excerpt.end]
    if "\n" in latex and QUOTED.match(text, text.rfind("\n", 0, excerpt.start) + 1):
        latex = QUOTED.sub(lambda margin: " " * len(margin[0]), latex)
    if excerpt.delimiter == "```math":
        return restructuredtext.with_rows(restructuredtext.options_removed(latex))
    if excerpt.delimiter == IMAGE:
        return ENCODED.sub(lambda code: chr(int(code[1], 16)).rjust(3), latex)
    escapes = DOUBLED if excerpt.delimiter in (r"\\[", r"\\(") else ESCAPES
    return html.characters(escapes.sub(_unescaped, latex))


def prose(text: str) -> str:
    """The text as HTML."""
    try:
        from markdown_it import MarkdownIt
    except ModuleNotFoundError as error:
        raise OSError(
            "markdown-it-py is not installed: pip install 'holonomic[documents]'"
        ) from error
    return str(MarkdownIt().enable("table").render(text))


def _unescaped(escaped: re.Match[str]) -> str:
    kept = next(filter(None, escaped.groups()))
    return kept.rjust(len(escaped[0]))
