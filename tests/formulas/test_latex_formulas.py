"""Formulas as LaTeX: in textbook order, in plain commands, and broken where they are long."""

import pytest
import sympy as sp
from matplotlib.mathtext import MathTextParser

from derive.formulas.syntax import syntax_tree
from derive.formulas.typeset.latex import latex
from derive.formulas.typeset.lettering import name_latex
from derive.formulas.typeset.line_breaks import SIGN, latex_rows, width_of
from derive.formulas.typeset.textbook_order import TextbookOrder

m, g, length, x, y, v, a = sp.symbols("m g l x y v a", positive=True)
ORDER = TextbookOrder(
    {
        m: "mass",
        g: "gravity",
        length: "parameter",
        x: "coordinate",
        y: "coordinate",
        v: "rate",
        a: "acceleration",
    }
)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("theta1_dot", r"\dot{\theta}_1"),
        ("x_ddot", r"\ddot{x}"),
        ("p_theta1", r"p_{\theta_1}"),
        ("pdot_theta1", r"\dot{p}_{\theta_1}"),
        ("r2_vector_dot", r"\dot{\vec{r}}_2"),
        ("latitude", r"\mathrm{latitude}"),
        ("k_spring", r"k_{\mathrm{spring}}"),
        ("l12", "l_{12}"),
        ("M_1_12", "M_{1,12}"),
    ],
)
def test_names_are_letters_with_dots_and_indices(name: str, text: str) -> None:
    assert name_latex(name) == text


@pytest.mark.parametrize(
    ("formula", "text"),
    [
        ("m1*l1**2*theta1_dot**2", r"m_1 l_1^2 \dot{\theta}_1^2"),
        ("a - (b + c)*d", r"a - \left(b + c\right) d"),
        ("a - (b - c)", r"a - \left(b - c\right)"),
        ("-a*b + c", "-a b + c"),
        ("(a + b)**2", r"\left(a + b\right)^2"),
        ("sin(theta)**2*cos(a - b)", r"\sin^2\left(\theta\right) \cos\left(a - b\right)"),
        ("2*3*a", r"2 \cdot 3 a"),
        ("sqrt(a)/b**10", r"\frac{\sqrt{a}}{b^{10}}"),
        ("ddt(d(L, x_dot))", r"\frac{d}{d t}\left(\frac{\partial L}{\partial \dot{x}}\right)"),
        ("ddt(E)", r"\frac{d E}{d t}"),
        ("log(x)", r"\ln\left(x\right)"),
        ("(a, b)", r"\begin{pmatrix} a \\ b \end{pmatrix}"),
        ("[[a, b], [c, d]]", r"\begin{pmatrix} a & b \\ c & d \end{pmatrix}"),
    ],
)
def test_formulas_are_plain_latex(formula: str, text: str) -> None:
    assert latex(syntax_tree(formula)) == text


@pytest.mark.parametrize(
    ("letter", "text"), [(r"\phi_a", r"\dot{\phi}_a"), (r"\psi", r"\dot{\psi}")]
)
def test_the_rate_of_a_letter_has_a_dot_and_its_index(letter: str, text: str) -> None:
    assert latex(syntax_tree("q_dot"), {"q": letter}) == text


@pytest.mark.parametrize("letter", [r"\frac{d x}{dt}", "x'"])
def test_the_square_of_a_rate_with_another_notation_has_brackets(letter: str) -> None:
    assert latex(syntax_tree("m*x_dot**2"), {"x_dot": letter}) == rf"m \left({letter}\right)^2"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (sp.sin(x) * length * g * m, r"m g l \sin\left(x\right)"),
        (v**2 * m / 2, r"\frac{1}{2} m v^2"),
        (v * sp.cos(x) + a * length - x, r"l a + v \cos\left(x\right) - x"),
        (1 - sp.cos(x), r"1 - \cos\left(x\right)"),
        (-x + y, "y - x"),
        (-x - y, "-x - y"),
        (sp.cos(x) * length + y, r"y + l \cos\left(x\right)"),
        (-g * sp.sin(x) / (2 * length), r"-\frac{g \sin\left(x\right)}{2 l}"),
        (sp.Rational(-3, 4) * x, r"-\frac{3}{4} x"),
        (1 / sp.sqrt(x), r"\frac{1}{\sqrt{x}}"),
        (x ** sp.Rational(3, 2), r"x^{\frac{3}{2}}"),
        (sp.exp(-x / length), r"\exp\left(-\frac{x}{l}\right)"),
        (sp.pi * sp.tan(x), r"\pi \tan\left(x\right)"),
        (sp.S.Zero, "0"),
        (sp.Integer(-2), "-2"),
    ],
)
def test_factors_and_terms_are_in_the_order_of_textbooks(value: sp.Expr, text: str) -> None:
    assert latex(ORDER.tree(value)) == text


LONG = " + ".join(f"a{k}*cos(b{k})" for k in range(30))


@pytest.mark.parametrize(
    "formula",
    [
        LONG,
        f"-({LONG})",
        f"m*({LONG})",
        f"({LONG})*m",
        f"({LONG})/m",
        f"x - ({LONG})/(a + b)",
        f"({LONG})/({LONG})",
        f"sqrt({LONG})",
        f"({LONG})**2",
        f"sin({LONG})",
        f"m*(a - 2*({LONG}))",
    ],
)
def test_long_formulas_are_broken_before_signs(formula: str) -> None:
    width = 60
    rows = latex_rows([syntax_tree("L"), syntax_tree(formula)], width)
    assert rows[0].startswith("L & = ")
    assert len(rows) > 3
    for row in rows[1:]:
        assert row.startswith((r"& \quad +", r"& \quad -"))
    for row in rows:
        assert row.count(r"\left") == row.count(r"\right")
        assert row.count("{") == row.count("}")
        assert row.count(r"\cos") <= 60 / width_of(syntax_tree("a1*cos(b1)"))
    whole = " ".join(rows)
    assert whole.count("igl(") == whole.count("igr)")
    assert whole.count(r"\cos") == formula.count("cos")


@pytest.mark.parametrize(("more", "count"), [(0.5, 1), (-0.5, 2)])
def test_a_negative_product_is_broken_where_it_is_too_wide(more: float, count: int) -> None:
    left, right = map(syntax_tree, ("L", "-m*(a1 + a2 + a3 + a4)"))
    width = width_of(left) + SIGN + width_of(right) + more
    assert len(latex_rows([left, right], width)) == count


FORMULAS = ["x", "theta1", "123", "-(a + b)", "a + b - c", "a*b*c*d*x", "a*(b + c)", "a/(c*d*x*y)",
    "(a + b)/m", "a**2", "x**n_spring", "(a + b)**12", "sin(x)", "arctan(x)", "sqrt(a + b)",
    "ddt(x + y)", "d(L, theta1_dot)", "d(L + x*y*m, x)", "k_spring", "l12", "M_1_12", "latitude",
    "-a*b + c/d - sin(x)*cos(y)**2"]  # fmt: skip


def test_formulas_are_at_most_as_wide_as_estimated_and_at_least_half() -> None:
    """Against Matplotlib, which typesets formulas with the letters of another font."""
    parse = MathTextParser("path").parse
    digit = parse(f"${'0' * 100}$").width / 100
    for formula in FORMULAS:
        tree = syntax_tree(formula)
        assert 0.95 < width_of(tree) * digit / parse(f"${latex(tree)}$").width < 2.1, formula
