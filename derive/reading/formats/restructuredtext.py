"""reStructuredText: the directive ``math`` and the role ``math``."""

import re
from collections.abc import Iterator

from derive.reading.plain_formulas import BLOCK
from derive.reading.scanning import BLANK_LINE, Delimiter, Excerpt, UnreadDisplay, scanned

KIND, SUFFIXES = "restructuredtext", (".rst",)
CODE = (
    "code|code-block|sourcecode|literalinclude|parsed-literal|highlight|raw|ipython|doctest|"
    "testcode|testsetup|testoutput|plot|jupyter-execute|csv-table|graphviz|tikz"
)
OPTION = re.compile(r"^[ \t]*+:[\w-]++:[^\n]*+$", re.M)
#: Blank lines between two equations.
BLANK = re.compile(r"(?<=\S)[ \t]*\n(?:[ \t]*\n)+(?=[ \t]*\S)")


def _block_end(opening: re.Match[str]) -> str:
    """The first line with text that is indented no more than the opening."""
    line = opening.group()
    indentation = line[: len(line) - len(line.lstrip(" \t"))]
    return rf"(?P<end>^(?!{indentation}[ \t]|[ \t]*+$)|\Z)"


TOKENS = (
    Delimiter(r"^[ \t]*+\.\.[ \t]++math::", _block_end, ".. math::"),
    Delimiter(rf"^[ \t]*+\.\.[ \t]++(?:{CODE})::[^\n]*+\n", _block_end),
    # a comment: no directive, target, footnote or substitution
    Delimiter(r"^[ \t]*+\.\.(?![^ \t\n])(?![ \t]++(?:[\w:-]+::|[\[_|]))[^\n]*+\n", _block_end),
    # a paragraph that introduces a literal block
    Delimiter(
        r"^(?![ \t]*+\.\.)[^\n]*?::[ \t]*+\n(?=[ \t]*+\n)", _block_end, BLOCK, is_inline=True
    ),
    Delimiter(r":math:`", rf"(?P<end>`)|(?P<stop>{BLANK_LINE})", ":math:", is_inline=True),
    Delimiter(r"``", rf"(?P<end>``)|(?P<stop>{BLANK_LINE})"),
)


def excerpts(text: str) -> Iterator[Excerpt | UnreadDisplay]:
    """The formulas of a text."""
    return scanned(text, TOKENS)


def decoded(text: str, excerpt: Excerpt) -> str:
    """The LaTeX without the options of a directive; the length stays the same.

    Behind blank lines a row begins, as Sphinx reads them.
    """
    return with_rows(options_removed(text[excerpt.start : excerpt.end]))


def prose(text: str) -> str:
    """The text as HTML, without files that it includes."""
    try:
        from docutils.core import publish_parts
    except ModuleNotFoundError as error:
        raise OSError("docutils is not installed: pip install 'holonomic[documents]'") from error
    settings = {
        "file_insertion_enabled": False,
        "raw_enabled": False,
        "report_level": 5,
        "halt_level": 5,
        "_disable_config": True,
        "syntax_highlight": "none",
    }
    return str(publish_parts(text, writer="html5", settings_overrides=settings)["html_body"])


def with_rows(latex: str) -> str:
    r"""Ends of rows, ``\\``, in place of blank lines, as Sphinx reads them; the length stays."""
    return BLANK.sub(lambda blank: r"\\".ljust(len(blank[0])), latex)


def options_removed(latex: str) -> str:
    """Spaces in place of lines such as ``:label: energy``."""
    return OPTION.sub(lambda option: " " * len(option[0]), latex)
