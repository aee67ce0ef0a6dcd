"""Typeset formulas have the value of their text."""

import re
from collections.abc import Callable
from math import cos, isclose, sin
from random import Random
from typing import Any
from xml.etree import ElementTree

import pytest
import sympy as sp

from derive import Derivation
from derive.formulas.syntax import syntax_tree
from derive.formulas.typeset import typesetting
from derive.formulas.typeset.latex import latex
from derive.formulas.typeset.typesetting import Formula
from derive.verification.report.report_judgement import EQUATIONS

#: Names of the report, and their handwritten form: letter, dots, indices.
LETTERS = {
    "theta1": "θ1",
    "theta2": "θ2",
    "theta1_dot": "θ.1",
    "theta2_dot": "θ.2",
    "theta1_ddot": "θ..1",
    "theta2_ddot": "θ..2",
    "phi1": "φ1",
    "phi2": "φ2",
    "phi1_dot": "φ.1",
    "phi2_dot": "φ.2",
    "phi1_ddot": "φ..1",
    "phi2_ddot": "φ..2",
    "alpha": "α",
    "alpha1": "α1",
    "alpha2": "α2",
    "p_theta1": "pθ1",
    "p_theta2": "pθ2",
    "P_theta1": "Pθ1",
    "P_theta2": "Pθ2",
    "P_theta1_dot": "P.θ1",
    "P_theta2_dot": "P.θ2",
    "p_theta1_dot": "p.θ1",
    "p_theta2_dot": "p.θ2",
    "omega_x": "ωx",
    "omega_y": "ωy",
    "omega_z": "ωz",
    "omega_x_dot": "ω.x",
    "omega_y_dot": "ω.y",
    "omega_z_dot": "ω.z",
    "tau_x": "τx",
    "tau_y": "τy",
    "tau_z": "τz",
    "theta_ddot": "θ..",
    "theta": "θ",
    "theta0": "θ0",
    "omega": "ω",
    "psi": "ψ",
    "w_i": "wi",
    "w_next": "wi+1",
    "x1_dot": "x.1",
    "y1_dot": "y.1",
    "x2_dot": "x.2",
    "y2_dot": "y.2",
    "p_phi1_dot": "p.φ1",
    "p_phi2_dot": "p.φ2",
    **{f"I_{axis}": f"I{axis}" for axis in ("xx", "yy", "zz")},
    **{
        name: name
        for name in "x1 y1 x2 y2 m1 m2 m3 m4 l1 l2 g l t h h1 h2 f1 f2 g1 g2 v1 v2 K P L H v z "
        "w0".split()
    },
}


class Power:
    """The function sin²: a function, and then a power of its value."""

    def __init__(self, function: Callable[[float], float], exponent: float) -> None:
        self.function, self.exponent = function, exponent

    def __call__(self, x: float) -> float:
        return self.function(x) ** self.exponent


def as_python(element: ElementTree.Element) -> str:
    """Read MathML from left to right, without its source, and return Python."""
    parts = [as_python(child) for child in element]
    match element.tag:
        case "mi" if element.text in ("sin", "cos"):
            return str(element.text)
        case "mi" | "msub" | "mover":
            return f"name[{''.join(element.itertext())!r}]"
        case "mpadded":
            return parts[0]
        case "mn":
            return str(element.text)
        case "mo":
            return {"\u2062": "*", "\u2061": "", "−": "-"}.get(
                element.text or "", element.text or ""
            )
        case "mfrac":
            return f"(({parts[0]})/({parts[1]}))"
        case "msup" if parts[0] in ("sin", "cos"):
            return f"Power({parts[0]}, {parts[1]})"
        case "msup":
            return f"(({parts[0]})**({parts[1]}))"
        case "msubsup":
            letters = "".join([*element[0].itertext(), *element[1].itertext()])
            return f"(name[{letters!r}]**({parts[2]}))"
        case "mspace":
            return ""
    return "".join(parts)


def sides(html: str) -> list[str]:
    """The sides of an equation, as Python."""
    whole = ElementTree.fromstring(html)
    return "".join(map(as_python, whole)).split("=")


def is_arithmetic(text: str) -> bool:
    names = {*re.findall(r"[A-Za-z]\w*", text)}
    return names <= {*LETTERS, "sin", "cos"} and not re.search(r"[<>\[]|\([^()]*,", text)


ARITHMETIC = [
    part
    for equation in EQUATIONS.values()
    for part in f"{equation.printed};{equation.corrected}".split(";")
    if "=" in part and is_arithmetic(part)
]


def values(text: str) -> list[tuple[float, float]]:
    """The values of each side: of the text, and of its MathML."""
    random = Random(7)
    written = {letter: random.uniform(0.2, 1.9) for letter in LETTERS.values()}
    functions: dict[str, Any] = {"sin": sin, "cos": cos, "Power": Power}
    typed = {name: written[letter] for name, letter in LETTERS.items()}
    return [
        (eval(plain, functions | typed), eval(shown, functions | {"name": written}))
        for plain, shown in zip(text.split("="), sides(Formula(text).html), strict=True)
    ]


def test_there_are_enough_formulas() -> None:
    assert len(ARITHMETIC) > 70


@pytest.mark.parametrize("text", [*dict.fromkeys(ARITHMETIC)])
def test_a_formula_of_the_report_keeps_its_value(text: str) -> None:
    assert all(isclose(plain, shown, rel_tol=1e-12) for plain, shown in values(text))


@pytest.mark.parametrize("text", [
    "K - (P + L) = K - (P - L)*H", "-(K - P)**2 = -K**2", "(K*P)**2 = (K/P)**2",
    "K/(P/L) = K/P/L", "-K*(-P) = K*-P", "K*(-P) = -(K + P)/2", "sin(K)**2*P = (sin(K)*P)**2",
    "K**2**L = K**(P + L)", "-K/P - -L = (-K)**2", "3*K/4 = (K + P)/4*2", "K**-1 = 2*3*K",
])  # fmt: skip
def test_necessary_brackets_are_present(text: str) -> None:
    assert all(isclose(plain, shown, rel_tol=1e-12) for plain, shown in values(text))


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("a*b + c*d/e - f**2", 0),
        ("(a + b)*c", 1),
        ("a*(b*c)*d/(e + f)", 0),
        ("-(a*b)", 0),
        ("sin(a)**2", 1),
        ("(a/b)**2", 1),
        ("(a + b)/2", 1),
        ("f(a, b)", 1),
    ],
)
def test_unnecessary_brackets_are_absent(text: str, count: int) -> None:
    assert Formula(text).html.count(">(<") == count


def test_derived_formulas_keep_their_value(double: Derivation) -> None:
    energies = double.lagrangian, double.hamiltonian
    for value in (*energies, *double.hamilton_equations[1], *double.euler_lagrange):
        assert all(isclose(*pair, rel_tol=1e-12) for pair in values(f"{sp.sstr(value)} = 0"))


def test_missing_brackets_change_values(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(typesetting, "_operand", lambda node, _: typesetting._markup(node))
    wrong = [text for text in ARITHMETIC if any(not isclose(*pair) for pair in values(text))]
    assert len(wrong) > 20


def test_text_that_is_not_a_formula_is_unchanged() -> None:
    assert Formula("y' = f(t) <b>").html == (
        '<code class="formula">y&#x27; = f(t) &lt;b&gt;</code>'
    )


@pytest.mark.parametrize("text", ["x<script>", "a = '</math><script>'", "__import__('os')"])
def test_markup_in_formulas_is_escaped(text: str) -> None:
    assert "<script" not in Formula(text).html
    assert Formula(text).html.count("<code") <= 1


def test_derivatives_matrices_and_indices_are_typeset() -> None:
    assert sides(Formula("d(L, q_i) = 0").html)[0] == "((∂name['L'])/(∂name['qi']))"
    matrix = ElementTree.fromstring(Formula("M = [[a, b], [c, d]]").html)
    rows = [["".join(cell.itertext()) for cell in row] for row in matrix.iter("mtr")]
    assert rows == [["a", "b"], ["c", "d"]]
    column = ElementTree.fromstring(Formula("r = l*(sin(theta), 0)").html)
    assert len([*column.iter("mtr")]) == 2


def test_natural_logarithms_are_ln_as_in_latex() -> None:
    assert "<mi>ln</mi>" in Formula("log(x)").html
    assert latex(syntax_tree("log(x)")).startswith(r"\ln")


def test_too_long_text_is_unchanged() -> None:
    for text in ("x + " * 4000 + "x", "x + " * 40_000 + "x"):
        assert Formula(text).html.startswith("<code")
