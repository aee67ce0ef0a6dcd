"""Documents: every delimiter of formulas with its place, and the traps of each format."""

import json
import re
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from counting import assert_linear
from shared_documents import shared

from derive.reading.document import Document
from derive.reading.document_formats import MAX_BYTES, MAX_NOTEBOOK_BYTES, read_document
from derive.reading.formats import tex
from solvers.io.toml_input import InputError

KINDS = {"$$": "$$", "```math": "fence", ".. math::": "rst-math"}


def read(folder: Path, name: str, text: str) -> Document:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return read_document(path)


def compared(latex: str) -> str:
    """LaTeX without spaces and without Markdown's escapes."""
    return re.sub(r"\s+|\\(?=[_*])", "", latex)


def test_displays_of_public_documents_are_those_of_their_verdicts() -> None:
    folder = shared("documents")
    for document in json.loads((folder / "verdicts.json").read_text()):
        expected = [(d["n"], d["kind"], compared(d["latex"])) for d in document["displays"]]
        displays = [d for d in read_document(folder / document["file"]).displays if d.number]
        assert [(d.number, KINDS[d.delimiter], compared(d.latex)) for d in displays] == expected


def test_the_report_has_equations_1_to_128_and_20_more_displays() -> None:
    (path,) = shared("report").glob("*.txt")
    displays = [one for one in read_document(path).displays if not one.is_inline]
    ends = [re.search(r"(?:\\quad |\\tag\{)\(?(\d+)[)}]$", one.latex) for one in displays]
    assert [int(end[1]) for end in ends if end] == list(range(1, 129))
    assert len(displays) == 148


# File, text in which « and » enclose the LaTeX, delimiter, whether the formula is inline
DELIMITERS = [
    ("a.tex", r"so $$«x = 1»$$", "$$", False),
    ("a.tex", r"so \[ «x = 1 \\[2pt] y = 2» \]", r"\[", False),
    ("a.tex", r"\begin{document} \[«x = 1»\] \end{document} \[y = 2\]", r"\[", False),
    ("a.tex", r"so $«x = \$1»$", "$", True),
    ("a.tex", r"so \(«x = 1»\)", r"\(", True),
    ("a.tex", r"so «\begin{align*} x \\[1ex] \end{align*}» on", "align*", False),
    ("a.tex", r"«\begin{equation}\begin{aligned}x\end{aligned}\end{equation}»", "equation", False),
    ("a.tex", "«\\begin {eqnarray}x % \\end{eqnarray}\n\\end{eqnarray}»", "eqnarray", False),
    ("a.tex", "\\[ «x = 1 \\text{ if $x$} % \\]\n= y» \\]", r"\[", False),
    ("a.tex", r"«\begin{math}x\end{math}»", "math", True),
    ("a.tex", r"\def\be{\begin{align}}\newcommand{\ee}{\end{align}}\be «x»\ee", "align", False),
    ("a.md", "so $$«x = 1»$$", "$$", False),
    ("a.md", "so\n\n$$\n\n«x\n\n= 1»\n$$", "$$", False),
    ("a.md", "where $$«x»$$ is a length", "$$", True),
    ("a.md", r"so \[ «x = 1» \]", r"\[", False),
    ("a.md", r"so \(«x»\)", r"\(", True),
    ("a.md", r"so \\[ «x = 1» \\]", r"\\[", False),
    ("a.md", r"so \\(«x»\\)", r"\\(", True),
    ("a.md", "- text\n\n    $$«x = 1»$$", "$$", False),
    ("a.md", "```math\n«x = 1»\n```", "```math", False),
    ("a.md", "~~~ {math}\n«x = 1»\n~~~", "```math", False),
    ("a.md", "so $«x = 1»$", "$", True),
    ("a.md", "so $ «x = 1» $", "$", True),
    ("a.md", "so $`«x = 1»`$", "$`", True),
    ("a.md", r"so ``«\dot x = 1»`` and ``x = 1``", "``", True),
    ("a.md", "«\\begin{gather}\nx\n\\end{gather}»", "gather", False),
    (
        "a.md",
        '<img src="https://render.githubusercontent.com/render/math?math=«x = 1»">',
        "image",
        False,
    ),
    ("a.md", "![x](https://latex.codecogs.com/svg.latex?«x=(1)»)", "image", False),
    ("a.md", "the length ![](https://latex.codecogs.com/png.latex?«l») is", "image", True),
    ("a.txt", "so $$«x = 1»$$", "$$", False),
    ("a.rst", ".. math:: «x = 1»", ".. math::", False),
    ("a.rst", ".. note::\n\n  .. math::\n\n     «x\n     y»\n\n  more", ".. math::", False),
    ("a.rst", ".. math::\n   :label: a\n   :nowrap:\n\n   «x»\n", ".. math::", False),
    ("a.rst", "so :math:`«x = 1»`, ``:math:`y```", ":math:", True),
    ("a.html", "<p>$$«x = 1»$$</p>", "$$", False),
    ("a.html", r"<p>\[«x = 1»\]</p>", r"\[", False),
    ("a.html", r"<p>\(«x = 1»\)</p>", r"\(", True),
    ("a.html", "<p>$«x = 1»$</p>", "$", True),
    ("a.html", r"<p>«\begin{multline}x\end{multline}»", "multline", False),
    ("a.html", '<SCRIPT type="math/tex; mode=display">«x = 1»</SCRIPT>', "math/tex", False),
    ("a.html", '<script type="math/tex">«x = 1»</script>', "math/tex", True),
    ("a.html", '<div id="e" class="math-display">«x = 1»</div>', "math/tex", False),
    ("a.html", '<span class="math display">«x = 1»</span>', "math/tex", False),
    ("a.html", '<span class="math inline">«x = 1»</span>', "math/tex", True),
    ("a.html", '<span class="math inline">\\(«x = 1»\\)</span>', r"\(", True),
    (
        "a.html",
        '<math display="block"><mi>x</mi><annotation encoding="application/x-tex">«x = 1»'
        "</annotation></math>",
        "math",
        False,
    ),
]


@pytest.mark.parametrize(("name", "marked", "delimiter", "is_inline"), DELIMITERS)
def test_each_delimiter_with_its_place(
    tmp_path: Path, name: str, marked: str, delimiter: str, is_inline: bool
) -> None:
    text = marked.replace("«", "").replace("»", "")
    (one,) = read(tmp_path, name, text).displays
    before, latex = marked.partition("»")[0].split("«")
    assert (one.latex, one.delimiter, one.is_inline) == (latex, delimiter, is_inline)
    assert one.number == int(not is_inline)
    assert one.start == len(before)
    assert one.line == before.count("\n") + 1
    assert one.column == len(before) - before.rfind("\n")


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.tex", "% $$x = 1$$\n5\\% and \\$x = 1\\$"),
        ("a.tex", r"\begin{verbatim}$$x = 1$$\end{verbatim} \verb|$x = 1$|"),
        ("a.tex", r"\newcommand{\energy}{$T = 1$} \iffalse $x = 1$ \fi"),
        ("a.tex", "$x = 1$ \\begin{document} text \\end{document} $$x = 1$$"),
        ("a.md", "It costs $5, not $6 = $2 x $3."),
        ("a.md", "It costs \\$5 and `$x = 1$`, ``a $$ b`` and ``` $y$ ```."),
        ("a.md", "```python\n$$x = 1$$\n```\n~~~~\n~~~\n$$x = 1$$\n~~~~"),
        ("a.md", "text\n\n    $$x = 1$$\n\n- item\n\n        $$x = 1$$\n"),
        ("a.md", "<!-- $$x = 1$$ --><pre>\n$$x = 1$$</pre><script>$$x = 1$$</script>"),
        ("a.md", r"\[1\] is a reference, \[see below\] too"),
        ("a.md", "an $x\n\n= 1$"),
        ("a.rst", ".. a comment\n   .. math:: x = 1"),
        ("a.rst", ".. code-block:: rst\n\n   .. math:: x = 1"),
        ("a.rst", "An example::\n\n   .. math:: x = 1"),
        ("a.html", "<head><title>$x$</title></head><!-- $$x = 1$$ --><pre>$$x = 1$$</pre>"),
        ("a.html", '<img alt="$x = 1$"> <style>$$x = 1$$</style> It costs $5 or $6.'),
        ("a.html", "<script>let a = '$$x = 1$$'</script><code>\\(x = 1\\)</code>"),
    ],
)
def test_text_that_is_no_formula(tmp_path: Path, name: str, text: str) -> None:
    assert not read(tmp_path, name, text).displays


@pytest.mark.parametrize(
    ("name", "text", "latex"),
    [
        ("a.md", r"$$\dot x\_p = T\_{cart} \\\\ q\*y$$", r"\dot x _p = T _{cart}   \\ q *y"),
        ("a.md", r"\\[ a\_1 = \\{2\\} \\\\ b \\]", r"a _1 =  \{2 \}   \\ b"),
        ("a.md", "![](https://latex.codecogs.com/svg.latex?%5Cdot%20x=1)", r"\dot   x=1"),
        ("a.md", r"$$a \\* b &lt; c$$", r"a \\* b    < c"),
        ("a.md", "> $$\n> x\n> = 1\n> $$", "x\n  = 1"),
        ("a.html", "<p>$$a &amp;= b<br>c &#x3B8;$$", "a     &= b    c       θ"),
        (
            "a.rst",
            ".. math:: x = 1\n   :label: a\n\n   y = 2",
            "x = 1\\\\" + " " * 16 + "y = 2",
        ),
    ],
)
def test_spaces_replace_characters_that_are_not_latex(
    tmp_path: Path, name: str, text: str, latex: str
) -> None:
    (one,) = read(tmp_path, name, text).displays
    assert one.latex == latex


def test_displays_are_counted_and_inline_formulas_are_not(tmp_path: Path) -> None:
    document = read(tmp_path, "a.md", "$a$ $$b = 1$$ $c$\n```math\nd = 1\n```\n$$ $$ $$e = 1$$")
    assert [(one.number, one.latex) for one in document.displays] == [
        (0, "a"), (1, "b = 1"), (0, "c"), (2, "d = 1"), (3, "e = 1"),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("name", "display"),
    [
        ("a.tex", "$$ x = 1 $$"),
        ("a.tex", r"\begin{align} x \end{align}"),
        ("a.md", "```math\nx = 1\n```"),
        ("a.html", '<script type="math/tex">x = 1</script'),
    ],
)
def test_the_extent_of_a_display_includes_its_delimiters(
    tmp_path: Path, name: str, display: str
) -> None:
    (one,) = read(tmp_path, name, f"so\n{display}\nis").displays
    assert one.extent == (3, 3 + len(display))


def test_positions_within_a_display_have_lines_and_columns(tmp_path: Path) -> None:
    document = read(tmp_path, "a.md", "a\r\n> $$\r\n> x &lt; y\\_1\r\n> z\r\n> $$\r\n")
    (display,) = document.displays
    place = {c: document.place(display.start + display.latex.index(c)) for c in "x<yz"}
    assert place == {"x": (3, 3, 0), "<": (3, 8, 0), "y": (3, 10, 0), "z": (4, 3, 0)}


def notebook(cells: Sequence[tuple[str, str | list[str]]], **metadata: object) -> str:
    return json.dumps(
        {
            "cells": [{"cell_type": kind, "source": text, "outputs": []} for kind, text in cells],
            "metadata": metadata,
        }
    )


def test_formulas_of_notebooks_have_places_in_their_cells(tmp_path: Path) -> None:
    text = notebook(
        [
            ("markdown", ["# Title\n", "so $$x = 1$$\n"]),
            ("code", "x = '$$y = 1$$'\nprint(x)"),
            ("raw", "$$z = 1$$"),
            ("markdown", "\n\nand $u = 1$"),
        ],
        kernelspec={"name": "julia-1.9", "language": "julia"},
    )
    document = read(tmp_path, "a.ipynb", text)
    found = [(one.cell, one.line, one.column, one.latex) for one in document.displays]
    assert found == [(1, 2, 6, "x = 1"), (4, 3, 6, "u = 1")]
    for one in document.displays:
        assert document.place(one.start) == (one.line, one.column, one.cell)
    (program,) = document.programs
    assert (program.number, program.language) == (2, "julia")
    assert document.text[program.start :].startswith(program.text)
    assert document.place(program.start + program.text.index("print")) == (2, 1, 2)


def test_definitions_of_macros_are_kept(tmp_path: Path) -> None:
    text = r"""
\newcommand{\q}{\theta_1} % \newcommand{\no}{x}
\renewcommand*\vect [1]{\boldsymbol{\mathrm{#1}}}
\def\half#1{\frac{#1}{2}} \DeclareMathOperator{\sign}{sign}
"""
    document = read(tmp_path, "a.tex", text)
    assert document.definitions == (
        r"\newcommand{\q}{\theta_1}",
        r"\renewcommand*\vect [1]{\boldsymbol{\mathrm{#1}}}",
        r"\def\half#1{\frac{#1}{2}}",
        r"\DeclareMathOperator{\sign}{sign}",
    )
    assert read(tmp_path, "a.md", r"$$\def\q{x} \q = 1$$").definitions == (r"\def\q{x}",)


@pytest.mark.parametrize(
    "text", ["Length of a rod", r"\title{a} \begin{document}Length of a rod\end{document} no"]
)
def test_the_text_of_latex_is_its_body_or_all_of_it(text: str) -> None:
    assert tex.prose(text) == "<p>Length of a rod"


def test_unread_parts_are_noted(tmp_path: Path) -> None:
    document = read(tmp_path, "a.tex", "\\input{part}\n% \\input{no}\n\\include{next}\n\\[ x = 1")
    included, unclosed = document.notes
    assert included == r"not followed: \input{part}, \include{next}"
    assert unclosed == r"line 4: \[ is not closed"
    unclosed = read(tmp_path, "a.md", r"\begin{align} x").notes[0]
    assert unclosed == r"line 1: \begin{align} is not closed"
    page = read(tmp_path, "a.html", "<math><mi>x</mi></math>\n" * 7)
    assert page.notes == (
        "line 1; line 2; line 3; line 4; line 5 and 2 more: <math> contains no LaTeX",
    )
    assert read(tmp_path, "a.md", "<math><mi>$x</mi></math>$").notes


def test_latin_1_is_read(tmp_path: Path) -> None:
    path = tmp_path / "a.tex"
    path.write_bytes("für $$x = 1$$".encode("latin-1"))
    assert read_document(path).displays[0].column == 7


@pytest.mark.long("more cases of the same kind", keep=40)
@pytest.mark.parametrize("name", ["a.md", "a.tex", "a.html", "a.rst"])
@pytest.mark.parametrize(
    "piece",
    ["$", "$$ ", "$x ", "\\[", "\\(", "\\begin{align}", "\\def\\a{", "{", "<a ", "<!--", "<math>",
     "`", "` `` ", "````\n```\n", "\\", "\n", " \n", "    x\n", "> ", "- ", ".. math::\n", "..\n",
     "a::\n\n", "    x' = y\n", "    x  ", "`x' = y` ", "<pre>x' = y</pre>", "&#", "\\verb|",
     "%$", "\\newcommand{\\b}{\\begin{align}}"],
)  # fmt: skip
def test_repeated_delimiters_take_linear_work(tmp_path: Path, name: str, piece: str) -> None:
    def read_repeated(size: int) -> None:
        with suppress(InputError):  # too many formulas
            read(tmp_path, name, piece * (size // len(piece)))

    assert_linear(read_repeated, 4_000)


REFUSED: dict[str, tuple[str, bytes, str]] = {
    "kind": ("a.pdf", b"", "documents end in .html, .htm, .md"),
    "length": ("a.md", b" " * (MAX_BYTES + 1), f"more than {MAX_BYTES} bytes"),
    "notebook": ("a.ipynb", b" " * (MAX_NOTEBOOK_BYTES + 1), "bytes"),
    "formulas": ("a.md", b"$x=1$ " * 21_000, "more than 20000 formulas"),
    "displays": ("a.md", b"$$x=1$$ " * 2_001, "more than 2000 displays"),
    "binary": ("a.tex", b"$$x\0$$", "is no text"),
    "nesting": ("a.ipynb", b"[" * 100_000, "no Jupyter notebook"),
    "no JSON": ("a.ipynb", b"x", "no Jupyter notebook"),
    "no cells": ("a.ipynb", b'{"cells": [{}]}', "no Jupyter notebook"),
    "a list": ("a.ipynb", b"[1]", "no Jupyter notebook"),
    "old": ("a.ipynb", b'{"worksheets": []}', "no Jupyter notebook of format 4"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_hostile_files_are_refused(tmp_path: Path, case: str) -> None:
    name, content, message = REFUSED[case]
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=message):
        read_document(tmp_path / name)


def test_missing_files_and_folders_are_refused(tmp_path: Path) -> None:
    (tmp_path / "folder.md").mkdir()
    for name in ("absent.md", "folder.md"):
        with pytest.raises(InputError, match=name):
            read_document(tmp_path / name)


def test_outputs_of_notebooks_are_not_read(tmp_path: Path) -> None:
    output: Any = {"data": {"text/latex": ["$$y = 1$$"] * 100_000}}
    cell = {"cell_type": "code", "source": "x", "outputs": [output]}
    text = json.dumps({"cells": [cell, {"cell_type": "markdown", "source": "$$x = 1$$"}]})
    assert [one.latex for one in read(tmp_path, "a.ipynb", text).displays] == ["x = 1"]


def test_boxes_of_myst_hold_text_and_code(tmp_path: Path) -> None:
    text = """````{dropdown} Steps
$$a = 1$$

```{note}
$$b = 2$$
```

```python
"$$c = 3$$"
```

```{code-block} python
"$$d = 4$$"
```
````

$$e = 5$$
"""
    displays = read(tmp_path, "a.md", text).displays
    assert [one.latex for one in displays] == ["a = 1", "b = 2", "e = 5"]


def test_dollars_can_have_backslashes(tmp_path: Path) -> None:
    text = "Then\n\\$$ a = 1 \\$$\nand\n\\$$b = 2,\\$$\nfor \\$5 and \\$$ alone"
    displays = read(tmp_path, "a.md", text).displays
    assert [one.latex.strip() for one in displays] == ["a = 1", "b = 2,"]
