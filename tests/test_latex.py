"""The LaTeX of mechanics becomes the syntax tree that it shows, or is reported as unreadable."""

import pytest
from latex_trees import show
from shared_documents import shared

from derive.reading.documents import read_document
from derive.reading.latex.reader import formulas, macros_of
from derive.reading.latex.tree import Unreadable


def read(latex: str, definitions: str = "") -> str:
    """The statements of a display as text, separated by bars."""
    return " | ".join(map(show, formulas(latex, macros_of(definitions))))


@pytest.mark.parametrize(
    ("latex", "tree"),
    [
        (r"\dot{\theta}_1 \dot{\theta_2}", "theta_1. theta_2."),
        (r"\dot\theta_1^2", "{theta_1.}^2"),
        (r"\sin^2\theta_1 l_2", "{sin(theta_1)}^2 l_2"),
        (r"\cos(\theta_1-\theta_2)\dot\theta_1", "cos((theta_1 - theta_2)) theta_1."),
        (r"1/2 m v^2", "[1 / 2] m {v}^2"),
        (r"\frac{d}{dt}\left(\frac{\partial L}{\partial\dot q}\right)=0", "d(∂(L; q.); t) = 0"),
    ],
)
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


def test_rows_of_a_matrix_inside_brackets_remain() -> None:
    latex = r"a = 2 \bigl( b \\ & + \begin{pmatrix} c \\ d \end{pmatrix} \bigr)"
    assert read(latex) == read(latex.replace(r"b \\ &", "b"))
    assert not any(isinstance(one, Unreadable) for one in formulas(latex))


@pytest.mark.parametrize("folder", ["documents", "report"])
def test_at_least_98_percent_of_the_displays_of_public_documents_are_read(folder: str) -> None:
    suffixes = (".md", ".rst", ".txt")
    count, misses = 0, []
    for path in sorted(p for p in shared(folder).iterdir() if p.suffix in suffixes):
        document = read_document(path)
        macros = macros_of("\n".join(document.definitions))
        for display in (d for d in document.displays if not d.is_inline):
            count += 1
            failures = [s for s in formulas(display.latex, macros) if isinstance(s, Unreadable)]
            if failures:
                misses.append((path.name, display.number, failures))
    assert count > 80
    assert len(misses) <= 0.02 * count, misses
