"""The report read from LaTeX: its translations, and documents that contain its displays."""

import pytest

from derive.reading.latex.reader import formulas
from derive.reading.latex.tree import Statement
from derive.verification.documents.translation import Notation, Translator
from derive.verification.report.reading import read


def translated(latex: str, notation: Notation) -> str:
    (statement,) = formulas(latex)
    assert isinstance(statement, Statement)
    return " = ".join(Translator(notation).text(side).text for side in statement.sides)


@pytest.mark.parametrize(
    ("latex", "notation", "text"),
    [
        (r"k = f(t, w)", Notation(), "k = f"),
        (
            r"k = hf(t + \frac{h}{2}, w)",
            Notation(calls=frozenset({"f"})),
            "k = h*f(t + h/2, w)",
        ),
        (r"y(0) = 1", Notation(calls=frozenset({"y"})), "y(0) = 1"),
        (
            r"r = l(\sin a, \cos a)",
            Notation(factors=frozenset({"l"})),
            "r = l*(sin(a), cos(a))",
        ),
        (r"T = \frac{1}{2} m(x + y)", Notation(), "T = 1/2*m*(x + y)"),
        (r"\begin{pmatrix} x \\ y \end{pmatrix} = z", Notation(), "(x, y) = z"),
    ],
)
def test_brackets_behind_letters_hold_arguments_columns_or_factors(
    latex: str, notation: Notation, text: str
) -> None:
    assert translated(latex, notation) == text


@pytest.mark.parametrize(
    ("latex", "text"),
    [
        (r"\dot{\ell}_1 = l_1", "l1_dot = l1"),
        (
            r"\frac{d}{dt}\frac{\partial L}{\partial\dot\phi_2} : \dot{p}_{\phi_2}",
            "ddt(d(L, phi2_dot)) = p_phi2_dot",
        ),
        (r"w_{i+1} = w_i", "w_next = w_i"),
        (r"f_i(\phi_1) = A^{-1}", "only(f_i, phi1) = inverse(A)"),
        (r"x_1 = 1 \quad \text{for } i = 1, 2, \dots", "x1 = 1"),
        (r"a = b \implies \dot{q}_i = c", "a = b; q_i_dot = c"),
        (r"\nabla p = 0", r"\nabla p = 0"),
    ],
)
def test_letters_of_the_report_have_the_names_of_the_project(latex: str, text: str) -> None:
    assert read(latex) == text
