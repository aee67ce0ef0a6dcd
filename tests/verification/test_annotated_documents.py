"""Verdicts on documents as a page and as LaTeX, from verdicts made by hand."""

import json
import re
import shutil
import subprocess
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

from derive.formulas.typeset.typesetting import Formula
from derive.reading.document import Document
from derive.reading.document_formats import read_document
from derive.reading.latex.display_reader import macros_of
from derive.verification.documents.pages.annotation import annotate, check_annotation
from derive.verification.documents.pages.latex_notes import latex_notes
from derive.verification.documents.pages.latex_text import escaped, formula
from derive.verification.documents.pages.markdown_notes import markdown_notes
from derive.verification.documents.pages.verdict_page import page
from derive.verification.documents.pages.verdicts_in_place import DocumentVerdicts, FormulaVerdict
from solvers.io.toml_input import InputError

HOSTILE = r"\input{x} & 100% of {it_is} <script>alert(1)</script> # ~ ^ θ̇ ẋ é \end{document} 中"
ENERGY = r"T = \half m l^2\dot\q^2 + m l \dot x\dot\q\sin\q"
BODY = r"""
\newcommand{\q}{\theta} \newcommand{\half}{\tfrac{1}{2}}
\begin{document}
\section{With $V = -mgl\cos\q$}
The energy is
\begin{equation} \label{a}
  T = \half m l^2\dot\q^2 + m l \dot x\dot\q\sin\q
\end{equation}
\begin{table}\begin{tabular}{lp{3cm}}$V = 1$ & $V = 2$\end{tabular}\caption{A caption.}\end{table}
A note\footnote{It has $V = 3$ and \[ V = 4 \]} and \parbox{4cm}{a box: $V = 5$}.
\begin{itemize} \item $$ V = 6 $$ \end{itemize}
\begin{align*} V &= 7 \\ V &= 8 \end{align*}

\[ V = 9 \]
\end{document}
"""


def document(folder: Path, text: str, name: str = "a.tex") -> Document:
    (folder / name).write_text(text, encoding="utf-8")
    return read_document(folder / name)


def judged(read: Document, *formulas: tuple[str, dict[str, Any]]) -> DocumentVerdicts:
    rows = []
    for latex, fields in formulas:
        start = read.text.index(latex)
        line, column, cell = read.place(start)
        extents = {one.number: one.extent for one in read.displays}
        display = next((n for n, (a, b) in extents.items() if a <= start < b), 0)
        span = (start, start + len(latex))
        wrong = fields.get("wrong_term", "")
        first = start + latex.rfind(wrong)
        marked = ((first, first + len(wrong)),) if wrong and wrong in latex else ()
        fields = {"verdict": "verified", "wrong_spans": marked, **fields}
        rows.append(FormulaVerdict(line, column, display, latex, span=span, cell=cell, **fields))
    return DocumentVerdicts(read.file, read.kind, "pendulum & cart", tuple(rows), ("line 1: <b>",))


WRONG = (
    ENERGY,
    {
        "verdict": "wrong",
        "wrong_term": r"m l \dot x\dot\q\sin\q",
        "correction": ENERGY.replace("sin", "cos"),
        "witness": "1.5 instead of 2",
        "note": HOSTILE,
    },
)


def formulas_of_body() -> list[tuple[str, dict[str, Any]]]:
    others = [r"V = -mgl\cos\q", *(f"V = {k}" for k in (1, 2, 3, 4, 5, 6, 9)), "V &= 7", "V &= 8"]
    return [WRONG, *((latex, {}) for latex in others)]


class Elements(HTMLParser):
    """The elements of a page, all of which must be closed in order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.starts: list[tuple[str, dict[str, str | None]]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.starts.append((tag, dict(attrs)))
        if tag not in ("meta", "link", "input", "wbr", "br", "hr"):
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.starts.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_the_page_is_one_closed_file_without_scripts(tmp_path: Path) -> None:
    read = document(tmp_path, r"\documentclass{article}" + BODY)
    text = page([(judged(read, *formulas_of_body()), read)])
    elements = Elements(text)
    assert not elements.open
    assert "script" not in {tag for tag, _ in elements.starts}
    addresses = [a[key] for _, a in elements.starts for key in ("href", "src") if key in a]
    assert addresses == ["data:,"]
    assert "url(" not in text
    assert "&lt;script&gt;alert(1)" in text
    assert "default-src 'none'" in text


def test_the_page_marks_the_wrong_term_and_the_correct_one(tmp_path: Path) -> None:
    read = document(tmp_path, r"\documentclass{article}" + BODY)
    text = page([(judged(read, WRONG), read)])
    (wrong,) = re.findall(r'<math[^>]*><mrow class="wrong-term">(.*?)</mrow></math>', text)
    assert "<mi>sin</mi>" in wrong
    assert "<mi>θ</mi>" in wrong  # the document's own macro
    (right,) = re.findall(r'<mrow class="right-term">(.*?)</mrow>', text)
    assert "<mi>cos</mi>" in right
    assert "<mi>m</mi>" not in right
    assert "1.5 instead of 2" in text


@pytest.mark.parametrize(
    ("latex", "wrong", "marked"),
    [
        (r"x = a - b + c", "- b", "−</mo><mi>b</mi>"),
        (r"x = a - b + c", "b", "−</mo><mi>b</mi>"),
        (r"x = a (b + c)^2", "2", "<mn>2</mn>"),
        (r"x = a\left(b + c\right)", r"b + c", "<mi>b</mi>"),
        (r"b = x - b", "- b", "−</mo><mi>b</mi>"),
        (r"x = -a + b", "-a", "−</mo><mi>a</mi>"),
        (r"x = l_1 \dot\theta_2", r"\dot\theta_2", "<mn>2</mn>"),
        (r"x = l_1 \dot\theta_2", r"_2", "<mi>θ</mi>"),  # the smallest part with a meaning
        (r"x = \frac{a}{b + c}", r"b + c", "<mi>c</mi>"),
        (r"x = a", "b", ""),  # not in the formula
    ],
)
def test_wrong_terms_are_marked(tmp_path: Path, latex: str, wrong: str, marked: str) -> None:
    read = document(tmp_path, f"$${latex}$$", "a.md")
    fields = {"verdict": "wrong", "wrong_term": wrong}
    text = page([(judged(read, (latex, fields)), read)])
    found = text.partition('<mrow class="wrong-term">')[2].partition("</math>")[0]
    assert bool(marked) == bool(found)
    assert marked in found


def test_the_source_of_an_unreadable_formula_is_shown(tmp_path: Path) -> None:
    read = document(tmp_path, r"$$\foo < 1$$", "a.md")
    text = page([(judged(read, (r"\foo < 1", {"verdict": "unreadable"})), read)])
    assert r"<code>\foo &lt; 1</code>" in text


def test_a_hostile_formula_is_cut(tmp_path: Path) -> None:
    read = document(tmp_path, f"$${'{' * 500_000}$$", "a.md")
    verdicts = judged(read, ("{" * 500_000, {"verdict": "unreadable"}))
    assert len(page([(verdicts, read)])) < 20_000
    assert len(latex_notes(verdicts, read)) < 10_000


def test_the_page_fits_narrow_screens_and_hides_verdicts(driver: Any, tmp_path: Path) -> None:
    long = " + ".join(rf"\frac{{m_{{{k}}} l^2 + I}}{{2}}\dot\theta_{{{k}}}^2" for k in range(30))
    wide = rf"x = \frac{{{long}}}{{2}}"
    read = document(tmp_path, f"$$T = {long}$$ $${wide}$$ $$y = 1$$", "a.md")
    rows = [(f"T = {long}", {}), (wide, {}), ("y = 1", {"verdict": "wrong"})]
    annotate(tmp_path / "a.html", [(judged(read, *rows), read)])
    driver.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": 390, "height": 800, "deviceScaleFactor": 1, "mobile": False},
    )
    driver.get((tmp_path / "a.html").as_uri())
    assert driver.execute_script("return document.documentElement.scrollWidth") <= 390
    items = driver.find_elements("css selector", "li")
    assert [item.is_displayed() for item in items] == [True] * 3
    assert items[0].rect["height"] > 60  # the sum has several lines
    driver.find_element("css selector", "#show-verified").click()
    assert [item.is_displayed() for item in items] == [False, False, True]
    assert driver.get_log("browser") == []


def test_dots_stand_below_the_line_of_a_fraction(driver: Any, tmp_path: Path) -> None:
    latex = r"p = \frac{\partial L}{\partial\dot\phi}"
    read = document(tmp_path, f"$${latex}$$", "a.md")
    text = page([(judged(read, (latex, {})), read)]) + Formula("p = d(L, phi_dot)").html
    (tmp_path / "page.html").write_text(text, encoding="utf-8")
    driver.get((tmp_path / "page.html").as_uri())
    tops = driver.execute_script("""
        const top = (element) => element.getBoundingClientRect().top;
        return [...document.querySelectorAll("mfrac")].map(
            (fraction) => [top(fraction.children[1]), top(fraction.querySelector("mover"))]);
    """)
    assert len(tops) == 2
    assert all(dots >= below for below, dots in tops)


def test_dots_between_letters_are_shown_as_dots(tmp_path: Path) -> None:
    latex = r"q = (q_1, \ldots, q_n)"
    text = page([(judged(read := document(tmp_path, f"$${latex}$$", "a.md"), (latex, {})), read)])
    assert "<mi>…</mi>" in text


def test_several_documents_stand_on_one_page(tmp_path: Path) -> None:
    names = ("a.md", "b.md")
    reads = [document(tmp_path, "$$x = 1$$", name) for name in names]
    text = page([(judged(read, ("x = 1", {})), read) for read in reads])
    assert re.findall("<h2>(.*?)</h2>", text) == ["a.md", "b.md"]
    assert "<b>2</b> verified" in text


#: A text in each format: a heading, formulas in a line and in a list, a program, and markup that
#: must not be executed.
TEXTS = {
    "a.tex": r"""\documentclass{article} \begin{document}
\section{Head \label{s}} First \emph{word} of $V = 1$, Schr\"odinger's % secret
\begin{equation} V = 2 \end{equation} middle 5\,\% ``quoted''
\begin{itemize} \item entry \[ V = 3 \] end \end{itemize}
\begin{verbatim} a < b \end{verbatim} \end{document} secret""",
    "a.md": """# Head\n\nFirst **word** of $V = 1$, <b onclick="secret()">Schrödinger's</b>
\n$$ V = 2 $$\n\nmiddle 5 % <script>secret</script>“quoted”\n\n- entry
\n  $$ V = 3 $$\n\n  end\n\n```\na < b\n```\n<!-- secret -->""",
    "a.rst": """Head\n====\n\nFirst **word** of :math:`V = 1`, Schrödinger's\n\n.. math:: V = 2
\nmiddle 5 % “quoted”\n\n- entry\n\n  .. math:: V = 3\n\n  end\n\n::\n\n  a < b
\n.. raw:: html\n\n   <script>secret</script>\n""",
    "a.html": """<html><head><title>secret</title><style>secret</style></head><body onload="secret">
<h1>Head</h1><p>First <em>word</em> of \\(V = 1\\), <a href="secret">Schrödinger's</a>
<p>$$ V = 2 $$ middle 5 % “quoted”<ul><li>entry \\[ V = 3 \\] end</ul><pre>a &lt; b</pre>
<iframe src="secret">secret</iframe></body></html>""",
}
TEXTS["a.ipynb"] = json.dumps(
    {
        "nbformat": 4,
        "nbformat_minor": 5,
        "metadata": {},
        "cells": [
            {"cell_type": "markdown", "id": "a", "metadata": {}, "source": source}
            for source in TEXTS["a.md"].split("\n\n", 2)
        ],
    }
)


VERDICTS = [(1, "wrong"), (2, "verified"), (3, "context")]


@pytest.mark.parametrize("name", TEXTS)
def test_the_page_has_the_text_of_the_document_around_its_formulas(
    tmp_path: Path, name: str
) -> None:
    read = document(tmp_path, TEXTS[name], name)
    rows = [(f"V = {k}", {"verdict": verdict}) for k, verdict in VERDICTS]
    whole = page([(judged(read, *rows), read)])
    assert not Elements(whole).open
    text = whole.partition("<main>")[2]
    assert "secret" not in text
    plain = re.sub(r"<[^>]*>|\s|\xa0", "", text)
    pieces = ["Head", "Firstwordof", "V=1", "Schrödinger's", "wrong", "V=2", "middle5%", "“quoted”"]
    pieces += ["entry", "V=3", "end", "a&lt;b"]
    assert re.search(".*".join(map(re.escape, pieces)), plain)
    marks = re.findall(r'<(?:li|span) class="(?:inline )?(verified|wrong|context)"', text)
    assert marks == ["wrong", "wrong", "verified", "context"]  # in the text, below it, displays


def test_a_copy_in_markdown_has_notes_below_its_formulas(tmp_path: Path) -> None:
    text = "In $x = 1$.\n\n1. item\n   $$y = 2$$\n   goes on\n\n> $$z = 3$$\n"
    read = document(tmp_path, text, "a.md")
    wrong = {"verdict": "wrong", "correction": "x = *", "note": "a_b"}
    rows = [("x = 1", wrong), ("y = 2", {}), ("z = 3", {"verdict": "wrong"})]
    notes = markdown_notes(judged(read, *rows), read)
    assert notes.startswith(
        r"In $x = 1$ (**wrong**, should be $x = *$, a\_b)." "\n\n1. item\n   $$y = 2$$\n\n"
        "   > - line 4: verified\n\n   goes on\n\n> $$z = 3$$\n>\n> > - line 7: **wrong**\n\n"
    )  # fmt: skip
    assert notes.count("line ") == 3  # with the remark of the summary


def test_a_copy_of_a_notebook_keeps_its_cells(tmp_path: Path) -> None:
    nbformat = pytest.importorskip("nbformat")
    book = nbformat.v4.new_notebook()
    book.cells = [
        nbformat.v4.new_markdown_cell("$$x = 1$$"),
        nbformat.v4.new_code_cell("x = 2", outputs=[]),
    ]
    nbformat.write(book, tmp_path / "a.ipynb")
    read = read_document(tmp_path / "a.ipynb")
    verdicts = judged(read, ("x = 1", {}))
    program = FormulaVerdict(1, 1, 0, "x = 2", "wrong", cell=2, correction="x = 3")
    verdicts = replace(verdicts, formulas=(*verdicts.formulas, program))
    annotate(tmp_path / "b.ipynb", [(verdicts, read)])
    copy = nbformat.read(tmp_path / "b.ipynb", 4)
    nbformat.validate(copy)
    kinds = [one.cell_type for one in copy.cells]
    assert kinds == ["markdown", "code", "markdown", "markdown"]
    assert copy.cells[0].source.startswith("$$x = 1$$\n\n> - line 1: verified")
    assert copy.cells[1] == book.cells[1]
    assert copy.cells[2].source == "- line 1: **wrong**, should be `x = 3`"


@pytest.mark.parametrize(
    "text",
    [
        "<p>a</div></p></li><td>$$x = 1$$",
        "<ul><li>a<li>$x = 1$<ul><li>b</ul></ul><table><tr><td>c<td>d<tr><td>e</table>",
        "<svg><p>secret</svg><math display='block'><mi>secret</mi></math>a $x = 1$",
        "\ue0000\ue001 and $x = 1$ and \ue0009\ue001",
    ],
)
def test_pages_are_closed_whatever_the_document_is(tmp_path: Path, text: str) -> None:
    read = document(tmp_path, f"<body>{text}</body>", "a.html")
    result = page([(judged(read, ("x = 1", {"verdict": "wrong"})), read)])
    assert not Elements(result).open
    assert "secret" not in result
    assert result.count('<li class="wrong"') == 1


def test_definitions_of_macros_are_not_shown(tmp_path: Path) -> None:
    read = document(tmp_path, "$$\\newcommand{\\q}{\\theta}$$ text $\\newcommand{\\r}{r}$", "a.md")
    assert "newcommand" not in page([(judged(read), read)])


def test_formulas_in_parts_that_are_left_out_are_listed(tmp_path: Path) -> None:
    read = document(tmp_path, "<p>text</p><button>$x = 1$</button>", "a.html")
    text = page([(judged(read, ("x = 1", {"verdict": "wrong"})), read)])
    assert text.count('<li class="wrong"') == 1


def test_marks_state_what_verdicts_rest_on(tmp_path: Path) -> None:
    read = document(tmp_path, "$$x = 1$$ $$y = 1$$ $$z = 1$$", "a.md")
    rows = [("x = 1", {"basis": "document"}), ("y = 1", {"basis": "known system"}), ("z = 1", {})]
    text = page([(judged(read, *rows), read)])
    assert re.findall(r"<abbr[^>]*>(.)</abbr>", text) == ["●", "○"]
    assert "Judged ● by the document&#x27;s own" in text


def test_the_copy_of_a_document_has_notes_at_its_formulas(tmp_path: Path) -> None:
    read = document(tmp_path, r"\documentclass{article}" + BODY)
    notes = latex_notes(judged(read, *formulas_of_body()), read)
    assert r"\formulaverdict{\textbf{7: wrong}}\begin{equation}" in notes
    assert r"$V = 5$\formulaverdict{10: verified}" in notes
    assert r"\formulaverdict{12: verified}\begin{align*}" in notes
    body, end = notes.split(r"\clearpage")
    assert re.sub(r"\\formulaverdict\{[^{}]*(\{[^{}]*\})?\}", "", body).endswith(
        read.text.partition(r"\begin{document}")[2].partition(r"\end{document}")[0] + "\n"
    )
    assert end.count(r"\end{document}") == 1
    assert r"\label" not in end


def test_details_are_those_of_wrong_formulas_and_of_notes(tmp_path: Path) -> None:
    text = r"\documentclass{article}\begin{document}$a = 1$ $b = 1$ $c = 1$ $d = 1$\end{document}"
    read = document(tmp_path, text)
    rows = [("a = 1", {"verdict": "wrong"}), ("b = 1", {"note": "known"}), ("c = 1", {}),
        ("d = 1", {"verdict": "wrong", "note": "seen"})]  # fmt: skip
    details = latex_notes(judged(read, *rows), read).split(r"\clearpage")[1]
    assert re.findall(r"[abcd] = 1", details) == ["a = 1", "b = 1", "d = 1"]


def test_notes_name_the_line_and_the_display_of_a_wrong_formula(tmp_path: Path) -> None:
    read = document(
        tmp_path, "Energies:\n$$ T = 1 $$\nand, in a line, $V = 2$, then\n$$ E = 3 $$\n"
    )
    wrong = {"verdict": "wrong"}
    notes = latex_notes(
        judged(read, *((text, wrong) for text in ("T = 1", "V = 2", "E = 3"))), read
    )
    assert re.findall(r"\\textbf\{(Line .*?)\}", notes) == [
        "Line 2: wrong (display 1)",
        "Line 3: wrong",
        "Line 4: wrong (display 2)",
    ]


def test_formulas_of_other_documents_are_listed(tmp_path: Path) -> None:
    text = f"$$\\newcommand{{\\q}}{{\\theta}}\\newcommand{{\\half}}{{\\frac12}}\n{ENERGY}$$"
    read = document(tmp_path, text, "a.md")
    listed = latex_notes(judged(read, WRONG), read)
    assert listed.startswith(r"\documentclass")
    assert r"\providecommand{\q}{\theta}" in listed
    assert rf"correct formula: $\displaystyle {ENERGY.replace('sin', 'cos')}$" in listed


CLASSES = [r"\documentclass{article}", r"\documentclass[twocolumn]{article}",
           r"\documentclass[twoside]{book}", r"\documentclass{article}\usepackage{amsmath}",
           r"\documentclass{report}\usepackage{multicol}\usepackage{hyperref}"]  # fmt: skip


@pytest.mark.parametrize("head", [*CLASSES, "list"])
def test_notes_compile(tmp_path: Path, head: str) -> None:
    program = shutil.which("pdflatex")
    if program is None:
        pytest.skip("needs LaTeX: apt-get install texlive-latex-base")
    packages = re.findall(r"usepackage\{(\w+)\}", head)
    if any(subprocess.run(["kpsewhich", f"{p}.sty"], capture_output=True).returncode
           for p in packages):  # fmt: skip
        pytest.skip(f"needs the packages {packages}")
    read = document(tmp_path, (CLASSES[0] if head == "list" else head) + BODY)
    verdicts = judged(read, *formulas_of_body())
    if head == "list":
        read = replace(read, kind="markdown")
    (tmp_path / "notes.tex").write_text(latex_notes(verdicts, read), encoding="utf-8")
    command = [program, "-interaction=nonstopmode", "-halt-on-error", "notes.tex"]
    run = subprocess.run(command, capture_output=True, cwd=tmp_path, check=False)
    assert run.returncode == 0, run.stdout.decode("latin-1")[-2000:]


def test_text_is_escaped() -> None:
    assert escaped(r"\input{a_b}") == r"\textbackslash{}input\{a\_b\}"
    assert escaped("θ̇ ẋ é 5%") == r"\ensuremath{\dot{\theta}} \.{x} \'{e} 5\%"
    assert escaped(HOSTILE).isascii()


@pytest.mark.parametrize(
    ("latex", "typeset"),
    [
        (r"x^2 \label{a} % c", r"$\displaystyle x^2$"),
        (r"x &= 1 \\ &= 2", r"$\displaystyle\begin{aligned}x &= 1 \\ &= 2\end{aligned}$"),
        (r"\input{x}", r"\texttt{\textbackslash{}input\{x\}}"),
        (r"\frac{a}{b", r"\texttt{\textbackslash{}frac\{a\}\{b}"),
        (r"\left( a } \right)", r"\texttt{\textbackslash{}left( a \} \textbackslash{}right)}"),
        (r"x $ y", r"\texttt{x \$ y}"),
        (r"\begin{verbatim}x", r"\texttt{\textbackslash{}begin\{verbatim\}x}"),
        ("θ", r"\texttt{\ensuremath{\theta}}"),
        (r"\q + \r", r"\texttt{\textbackslash{}q + \textbackslash{}r}"),
        (r"\q + x", r"$\displaystyle \q + x$"),
        (r"\dot\frac{a}{b}", r"\texttt{\textbackslash{}dot\textbackslash{}frac\{a\}\{b\}}"),
        (r"\big x", r"\texttt{\textbackslash{}big x}"),
        ("x^{2 & 3}", r"\texttt{x\textasciicircum{}\{2 \& 3\}}"),
        ("x^2^3", r"\texttt{x\textasciicircum{}2\textasciicircum{}3}"),
        ("", ""),
    ],
)
def test_only_known_formulas_are_typeset(latex: str, typeset: str) -> None:
    assert formula(latex, macros_of(r"\newcommand{\q}{\theta}")) == typeset


def test_the_file_is_chosen_by_its_suffix(tmp_path: Path) -> None:
    read = document(tmp_path, "$$x = 1$$", "a.md")
    verdicts = judged(read, ("x = 1", {}))
    for name, start in (("a.html", "<!DOCTYPE html>"), ("a.tex", r"\documentclass")):
        check_annotation(tmp_path / name, [read.file])
        annotate(tmp_path / name, [(verdicts, read)])
        assert (tmp_path / name).read_text().startswith(start)


@pytest.mark.parametrize(
    ("name", "files", "message"),
    [
        ("a.pdf", ["a.md"], "must end in .html or .tex"),
        ("a.ipynb", ["a.md"], "must end in .html or .tex"),
        ("a.tex", ["a.md", "b.md"], "shows one document"),
        ("a.tex", ["a.tex"], "is the document itself"),
        ("a.html", [], "give a document"),
    ],
)
def test_files_that_cannot_show_the_documents_are_refused(
    name: str, files: list[str], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        check_annotation(Path(name), files)
