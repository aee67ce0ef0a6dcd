"""The LaTeX of mechanics becomes the syntax tree that it shows, or is reported as unreadable."""

import re
import sys
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from itertools import pairwise
from typing import Any

import latex_formulas
import pytest
from counting import assert_linear
from hypothesis import example, given, settings
from hypothesis import strategies as st
from latex_trees import show
from latex_writing import written_trees
from shared_documents import shared

from derive.reading.document_formats import read_document
from derive.reading.latex import display_reader
from derive.reading.latex.display_reader import formulas, macros_of
from derive.reading.latex.tree import Node, Statement, Unreadable


def read(latex: str, definitions: str = "") -> str:
    """The statements of a display as text, separated by bars."""
    return " | ".join(map(show, formulas(latex, macros_of(definitions))))


def cases(table: str) -> list[tuple[str, str]]:
    return [tuple(line.split("  ⟶  ")) for line in table.strip().splitlines()]


READABLE = [
    case
    for name, table in vars(latex_formulas).items()
    if name.isupper() and name != "UNREADABLE"
    for case in cases(table)
]


@pytest.mark.parametrize(("latex", "tree"), READABLE)
def test_formulas_are_read_as_they_are_printed(latex: str, tree: str) -> None:
    assert read(latex) == tree


@pytest.mark.parametrize(
    "latex",
    [
        r"a & = 2 \bigl( b \\ & \quad + c \bigr) \\ & \quad - d = 0",
        r"a &= 2 \Bigl(b \notag \\ &\qquad + c\Bigr) \notag \\ &\qquad - d = 0 \tag{3}",
        r"\begin{align} a =& 2 ( b \\ & + c ) \\ & - d = 0 \end{align}",
    ],
)
def test_a_statement_may_be_broken_inside_brackets_and_before_any_sign(latex: str) -> None:
    assert read(latex) == "a = (2 (b + c) - d) = 0"


def test_two_signs_are_read_as_the_upper_and_the_lower_ones() -> None:
    (statement,) = formulas(r"\lambda_\pm = -a \pm \sqrt{b \mp c}")
    assert isinstance(statement, Statement)
    sides = statement.sides, statement.other_sides
    assert [[show(side) for side in one] for one in sides] == [
        ["lambda_+", "(- a + root2(b - c))"], ["lambda_-", "(- a - root2(b + c))"],
    ]  # fmt: skip
    assert all(isinstance(one, Statement) and not one.other_sides for one in formulas("a = b"))


def test_rows_of_a_matrix_inside_brackets_remain() -> None:
    latex = r"a = 2 \bigl( b \\ & + \begin{pmatrix} c \\ d \end{pmatrix} \bigr)"
    assert read(latex) == read(latex.replace(r"b \\ &", "b")) == "a = 2 (b + [c; d])"


@pytest.mark.parametrize(("latex", "reason"), cases(latex_formulas.UNREADABLE))
def test_formulas_that_are_ambiguous_or_broken_are_reported(latex: str, reason: str) -> None:
    assert read(latex) == reason


#: The same cases in every run; the first one waits for the parser.
SAME = settings(derandomize=True, database=None, deadline=None)


@SAME
@given(written_trees())
def test_trees_in_any_spelling_are_read_back(case: tuple[Node, str]) -> None:
    tree, latex = case
    assert read(latex) == show(tree), latex


PIECES = sorted({p for latex, _ in READABLE for p in re.findall(r"\\[A-Za-z]+|\\.|.", latex)})


@SAME
@given(st.lists(st.sampled_from(PIECES)).map("".join))
@example(r"x > 0\\~(1)")
def test_any_text_is_read_or_reported_within_its_length(latex: str) -> None:
    for found in formulas(latex):
        start, end = found.span
        assert 0 <= start <= end <= len(latex)


def nodes(value: Any, around: tuple[int, int] = (-1, -1)) -> Iterator[Node]:
    """All nodes within a node whose span is not that of the node around them."""
    parts = value if isinstance(value, tuple) else [getattr(value, f.name) for f in fields(value)]
    for part in parts:
        if is_dataclass(part):
            if part.span != around:
                yield part
            yield from nodes(part, part.span)
        elif isinstance(part, tuple):
            yield from nodes(part, around)


#: Formulas of which a part has no text of its own: ``1, 2`` of ``i = 1, 2``, and ``t`` of ``dt``.
WITHOUT_TEXT = (
    r"\sqrt{g\over l}",
    r"\text{friction of",
    "multline",
    r"\dot\theta^2_1",
    r"\mathrm{dt}",
    r"\pdv",
    "i = 1",
    *"²½⅞",
)


@pytest.mark.parametrize("latex", [latex for latex, _ in READABLE])
def test_the_text_at_a_span_is_the_node(latex: str) -> None:
    if not any(part in latex for part in WITHOUT_TEXT):
        for node in (node for statement in formulas(latex) for node in nodes(statement)):
            text = latex[slice(*node.span)]
            assert read(text) == show(node), text


def test_spans_of_statements_are_their_places_in_the_display() -> None:
    latex = r"""\begin{aligned}
      x &= \frac{a}{b}, \label{a} \\
        &= c \\
      y &= \foo % a comment
    \end{aligned}"""
    first, second = formulas(latex)
    assert latex[slice(*first.span)].startswith("x &=")
    assert latex[slice(*first.span)].endswith("&= c")
    assert latex[slice(*second.span)] == r"y &= \foo"


@pytest.mark.parametrize(
    ("definitions", "latex", "tree"),
    [
        (r"\newcommand{\q}{\theta_1}", r"\dot\q^2", "theta_1.^2"),
        (r"\newcommand{\vect}[1]{\boldsymbol{#1}}", r"\vect{q}\vect p", "bold q bold p"),
        (r"\newcommand\dq{\dot q}", r"\dq\dq", "q. q."),
        (r"\def\half{\frac12}", r"\half m", "[1 / 2] m"),
        (r"\def\pd#1#2{\frac{\partial #1}{\partial #2}}", r"\pd L{\dot q}", "∂(L; q.)"),
        (r"\DeclareMathOperator{\sgn}{sgn}", r"\sgn(x)", "sign(x)"),
        (r"\newcommand{\ddt}[1][L]{\frac{d #1}{dt}}", r"\ddt + \ddt[x]", "(d(L; t) + d(x; t))"),
        (r"\newcommand{\a}{b} \renewcommand*{\a}{c}", r"\a", "c"),
        (r"% \newcommand{\a}{b}", r"\a", r"unreadable: the command \a is not known"),
        (r"\renewcommand{\vec}[1]{\mathbf{#1}}", r"\vec{q}", "bold q"),
        (r"\newcommand{\be}{\begin{aligned}}", r"\be x &= a \end{aligned}", "x = a"),
        (r"\newcommand{\a}{\b}\newcommand{\b}{x}", r"\a", "x"),
        ("", r"\newcommand{\a}{b} \a = c", "b = c"),
        ("", r"\newcommand{\a}[1]{\dot{#1}}", ""),
        ("", r"\abs{x} + \qty(a + b) \dd{t}", "(|x| + (a + b) d t)"),
        ("", r"\dv{t}\left(\pdv{L}{\dot q}\right) + \dv[2]{x}{t}", "(d(∂(L; q.); t) + d(x; t, t))"),
        ("", r"\pdv{L}{x}{y} - \pdv[2]{L}{x}", "(∂(L; x, y) - ∂(L; x, x))"),
        ("", r"a \qand* b = c \qq*{so that} d = e", "a | b = c | d = e"),
        ("", r"\mqty(a & (b) \\ c & d) = \mqty*{x \\ y}", "[a, b; c, d] = [x; y]"),
        ("", r"\abs*{x} + \underline{y}", "(|x| + yunder)"),
        ("", r"\vb*{q}\va p + \pdv*{L}{x} - \PD{L}{y}", "(bold q bold p + ∂(L; x) - ∂(L; y))"),
        ("", r"\eval{x}_0", "at(x)"),
        ("", r"\underline{\underline{x = y}}", "x = y"),
        ("", r"1 - \cos[2](\theta)\qty(a)", "(1 - cos(theta)^2 a)"),
        ("", r"\sin [2] + \cos[x](a)", "(sin(2) + cos(x) a)"),
        (r"\newcommand{\abs}[1]{#1^2}", r"\abs{x}", "x^2"),
        ("", r"\half\thetadot^2 + \xddot\ddotalpha_1", "([1 / 2] theta.^2 + x.. alpha_1..)"),
        ("", r"\frac{\d x}{\d t} + \Vec{q}\Ddot y \mbf{p}", "(d(x; t) + bold q y.. bold p)"),
        ("", r"b\cdot\ddot a + \dots", "(b a.. + dots)"),
        ("", r"\ddt{x} + \inv{2} y", "(d(x; t) + [1 / 2] y)"),
        ("", r"\bf M(\bf q) \bf{\ddot q} = {\bf B}", "bold M@(bold q) bold q.. = bold B"),
        ("", r"a \odot b", r"unreadable: the command \odot is not known"),
        (r"\newcommand{\rdot}{\dot R}\def\d{\delta}", r"\rdot\d", "R. delta"),
    ],
)
def test_macros_are_expanded(definitions: str, latex: str, tree: str) -> None:
    assert read(latex, definitions) == tree


def test_parts_of_a_macro_have_the_span_of_its_call() -> None:
    latex = r"x + \pd{L}{q}"
    macros = macros_of(r"\newcommand{\pd}[2]{\frac{\partial #1}{\partial #2}}")
    (statement,) = formulas(latex, macros)
    (total,) = statement.sides
    assert [term.span for _, term in total.terms] == [(0, 1), (4, len(latex))]


@pytest.mark.long("more cases of the same kind", keep=6)
@pytest.mark.parametrize(
    ("definitions", "latex"),
    [
        (r"\def\a{\a}", r"\a"),
        (r"\def\a{\b}\def\b{\a\a}", r"\a"),
        (
            "".join(rf"\def\a{c}{{\a{d}\a{d}}}" for c, d in pairwise("abcdefghijklmnopqrstuvw")),
            r"\aa",
        ),
        (r"\newcommand{\a}[1]{#1#1}", r"\a{" * 50 + "x" + "}" * 50),
        (r"\newcommand{\a}[2]{#1}", r"\a{x}"),
        (r"\newcommand{\a}[1]{#2}", r"\a{x}"),
        (r"\newcommand{\a", r"\a"),
        ("", "{" * 1_000_000),
        ("", "{" * 50_000),
        ("", "(" * 50_000),
        ("", "|" * 50_000),
        ("", "{" * 40_000 + "}" * 40_000),
        ("", "x + " * 1_000_000),
        ("", r"\frac" * 15_000),
        ("", r"\dot" * 15_000 + "x"),
        ("", r"\mathbf" * 10_000 + "x"),
        ("", r"\sin" * 15_000 + "x"),
        ("", "x^" * 9_000 + "x"),
        ("", "x_" * 20_000 + "x"),
        ("", "x/" * 9_000 + "x"),
        ("", r"\sum" * 20_000 + "x"),
        ("", r"\underbrace{" * 5_000 + "x"),
        ("", r"\underbrace" * 9_000 + "x"),
        ("", r"\text{" * 9_000),
        ("", r"\begin{aligned}" * 5_000),
        ("", r"\begin{pmatrix}" * 5_000 + r"\end{pmatrix}" * 5_000),
        ("", r"\newcommand" * 5_000),
        ("", r"\input{/etc/passwd}"),
        ("", r"\left" * 20_000),
        ("", "\u0307" * 20_000),
        ("", "\0"),
        ("", "\\"),
    ],
    ids=lambda text: text[:12],
)
def test_hostile_displays_end_soon_and_are_unreadable(definitions: str, latex: str) -> None:
    (only,) = formulas(latex, macros_of(definitions))
    assert isinstance(only, Unreadable)


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(
    "piece",
    ["a", "x,", r"x = a \\ ", "a'", "&", ".", r"\\", "+1", "{}", r"\quad x", "x_1^2"],
)
def test_long_displays_take_linear_work(piece: str) -> None:
    assert_linear(lambda size: formulas(piece * (size // len(piece))), 2_000)


@pytest.mark.parametrize("piece", [r"\newcommand", r"\newcommand{\a}{"])
def test_many_definitions_take_linear_work(piece: str) -> None:
    assert_linear(lambda size: macros_of(piece * size), 300)


def test_without_the_parsing_library_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    display_reader._parser.cache_clear()
    monkeypatch.setitem(sys.modules, "lark", None)
    with pytest.raises(OSError, match=r"pip install 'holonomic\[documents\]'"):
        formulas("x")


@pytest.mark.parametrize("folder", ["documents", "report"])
def test_at_least_98_percent_of_the_displays_of_public_documents_are_read(folder: str) -> None:
    count, misses = 0, []
    for path in sorted(shared(folder).iterdir()):
        if path.suffix not in (".md", ".rst", ".txt"):
            continue
        document = read_document(path)
        macros = macros_of("\n".join(document.definitions))
        for display in (d for d in document.displays if not d.is_inline):
            count += 1
            found = formulas(display.latex, macros)
            misses += [(path.name, display.number, s) for s in found if isinstance(s, Unreadable)]
    assert count > 80
    assert len(misses) <= 0.02 * count, misses
