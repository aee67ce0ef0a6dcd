"""Formulas in plain text are read from blocks of code, and nothing else is."""

from pathlib import Path

import pytest

from derive.reading.document_formats import read_document
from derive.reading.latex.display_reader import formulas
from derive.reading.latex.tree import Statement
from derive.reading.plain_formulas import MAX_LENGTH
from derive.verification.documents.formula_translation import FormulaTranslator
from derive.verification.documents.judgement import judge_document
from derive.verification.documents.pages.latex_text import escaped, formula
from derive.verification.documents.pages.markdown_notes import markdown_notes
from derive.verification.documents.pages.verdict_page import page

PENDULUM = """
A bob on a rod.

```
x = l sin θ,   y = -l cos θ
T = ½ m l² θ̇²          (1)
L = T + m g l cos θ
  = ½ m l² θ̇² + m g l cos θ

Euler-Lagrange: d/dt(∂L/∂θ̇) - ∂L/∂θ = 0
θ̈ = -(g/l) cos θ       # a slip
```

Small angles:

    theta'' = -(g/l) theta

```
git clone pendulum
```

Then
```
y1 = -l*cos(theta)
```
"""


def displays(text: str, folder: Path) -> list[str]:
    path = folder / "page.md"
    path.write_text(text, encoding="utf-8")
    return [one.latex for one in read_document(path).displays]


@pytest.mark.parametrize(
    ("plain", "latex"),
    [
        ("x = l sin θ", r"x = l\sin\theta"),
        ("θ₁'' = -(g/L₁) sin θ₁", r"\theta_1'' = -(g/L_1)\sin\theta_1"),
        ("theta1_dot = omega1", r"\dot\theta_1 = \omega_1"),
        ("theta_dot_1 = thetaddot", r"\dot\theta_1 = \ddot\theta"),
        ("x_1_ddot = xdot", r"\ddot x_1 = \dot x"),
        ("theta_dot_dot = -g/l*sin(theta)", r"\ddot\theta = -\frac gl \sin(\theta)"),
        ("d2x/dt2 = -k/m x", r"\ddot x = -k/m x"),
        ("d²θ/dt² + b dθ/dt = 0", r"\ddot\theta + b\dot\theta = 0"),
        ("dtheta/dt = omega", r"\dot\theta = \omega"),
        ("d/dt(∂L/∂q_dot) = F", r"\frac{d}{dt}\frac{\partial L}{\partial\dot q} = F"),
        ("H = p**2/(2*m)", r"H = \frac{p^2}{2m}"),
        ("r = (x^2 + y^2)^(3/2)", r"r = (x^2 + y^2)^{3/2}"),
        ("r = sqrt(x**2 + y**2)", r"r = \sqrt{x^2 + y^2}"),
        ("KE + PE = I*alpha", r"\text{KE} + \text{PE} = I\alpha"),
        ("½ m (ẋ² + ẏ²) = mgh", r"\frac12 m(\dot x^2 + \dot y^2) = m g h"),
    ],
)
def test_plain_text_has_the_meaning_of_latex(plain: str, latex: str) -> None:
    translator = FormulaTranslator()
    one, other = (
        [translator.text(side).text for part in formulas(text) for side in part.sides]
        for text in (plain, latex)
        if all(isinstance(part, Statement) for part in formulas(text))
    )
    assert one == other


def test_products_of_letters_are_no_words() -> None:
    translator = FormulaTranslator()
    for text, expected in (
        ("F = mu", "m*u"), ("F = nu d", "n*u*d"), ("F = bd o t", "b*d*o*t"), ("x = d_2 x", "d_2*x")
    ):  # fmt: skip
        (statement,) = formulas(text)
        assert isinstance(statement, Statement)
        assert translator.text(statement.sides[1]).text == expected


def test_lines_of_code_blocks_are_displays(tmp_path: Path) -> None:
    assert displays(PENDULUM, tmp_path) == [
        "x = l sin θ,   y = -l cos θ",
        "T = ½ m l² θ̇²",
        "L = T + m g l cos θ\n  = ½ m l² θ̇² + m g l cos θ",
        "d/dt(∂L/∂θ̇) - ∂L/∂θ = 0",
        "θ̈ = -(g/l) cos θ",
        "theta'' = -(g/l) theta",
        "y1 = -l*cos(theta)",
    ]


@pytest.mark.parametrize(
    "block",
    [
        "pip install thing\npython run.py --x=3 --theta'' = 3",
        "x = x + v*dt\nθ = θ + ω*dt",
        "for i in range(3):\n    θ'' = -(g/l) sin θ",
        "θ'' = -(g/l) sin θ;",
        "double θ'' = 3",
        "├── src = main θ\n└── data",
        "x = 3\ny = 4",  # nothing shows that it is mechanics
        "the angle θ = length of the rod",
        "name = 'x''",
        "a='hi'",
        "m1 = 851/500, phi1_dot = 441/1250",
        "y[0]'' = θ",
        "θ̈ = np.sin(θ)",
        "E == m c²",
    ],
)
def test_what_is_no_formula_is_skipped(block: str, tmp_path: Path) -> None:
    assert displays(f"Text.\n\n```\n{block}\n```\n", tmp_path) == []
    indented = "\n".join(f"    {line}" for line in block.splitlines())
    assert displays(f"Text.\n\n{indented}\n", tmp_path) == []


def test_spans_of_code_are_inline_formulas(tmp_path: Path) -> None:
    text = (
        "- `θ'' = -(g/l) cos θ` (slip)\n- `θ = l` `x = 3` `x = y`"
        " `L = ½ m l² θ̇² + m g l cos θ`, `a'b`\n"
    )
    path = tmp_path / "page.md"
    path.write_text(text, encoding="utf-8")
    document = read_document(path)
    shown = [one.latex for one in document.displays]
    assert shown == ["θ'' = -(g/l) cos θ", "θ = l", "L = ½ m l² θ̇² + m g l cos θ"]
    assert all(one.is_inline for one in document.displays)
    verdicts = judge_document(document)
    assert "(**wrong**, should be `θ'' = -g/l*sin(θ)`" in markdown_notes(verdicts, document)
    assert page([(verdicts, document)]).count("inline wrong") == 1


def test_long_lines_of_code_are_skipped(tmp_path: Path) -> None:
    sum_of_terms = " + ".join(["θ'"] * 80)
    assert len(sum_of_terms) > MAX_LENGTH
    line = f"x'' = {sum_of_terms}"
    assert displays(f"```\n{line}\nθ'' = x\n```\n`{line}`\n", tmp_path) == ["θ'' = x"]


@pytest.mark.parametrize("language", ["python", "c", "matlab", "bash"])
def test_code_of_a_language_is_skipped(language: str, tmp_path: Path) -> None:
    assert displays(f"```{language}\nθ'' = -(g/l) sin θ\n```\n", tmp_path) == []
    assert displays("```text\nθ'' = -(g/l) sin θ\n```\n", tmp_path) == ["θ'' = -(g/l) sin θ"]


def test_a_slip_is_corrected_in_plain_text(tmp_path: Path) -> None:
    path = tmp_path / "page.md"
    path.write_text(PENDULUM, encoding="utf-8")
    document = read_document(path)
    verdicts = judge_document(document)
    wrong = [one for one in verdicts.formulas if one.verdict == "wrong"]
    assert [(one.line, one.correction) for one in wrong] == [(11, "θ̈ = -g/l*sin(θ)")]
    assert {one.verdict for one in verdicts.formulas} == {"wrong", "definition", "verified"}
    note = "(wrong, should be θ̈ = -g/l*sin(θ)"
    assert f"θ̈ = -(g/l) cos θ   {note}" in markdown_notes(verdicts, document)
    shown = page([(verdicts, document)])
    assert shown.count("<pre>") == shown.count("</pre>")
    assert "a slip" in shown
    assert shown.index("Small angles") < shown.index("line 16")


def test_latex_notes_show_plain_text_as_it_stands() -> None:
    assert escaped("½ m l²") == r"1/2 m l\ensuremath{{}^{2}}"
    assert formula("theta_dot = 1") == r"\texttt{theta\_dot = 1}"
    assert formula("x = v t") == r"$\displaystyle x = v t$"


@pytest.mark.parametrize(
    ("name", "text"),
    [
        (
            "page.html",
            "<p>So</p><pre class='eq'><code>\nθ'' = -(g/l) sin θ\n</code></pre><pre>ls</pre>",
        ),
        ("page.rst", "So::\n\n    θ'' = -(g/l) sin θ\n\nand::\n\n    ls\n"),
        ("page.txt", "So\n\n    θ'' = -(g/l) sin θ\n"),
    ],
)
def test_blocks_of_other_formats_are_read(name: str, text: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text, encoding="utf-8")
    document = read_document(tmp_path / name)
    assert [one.latex for one in document.displays] == ["θ'' = -(g/l) sin θ"]
    assert "<math" in page([(judge_document(document), document)])
