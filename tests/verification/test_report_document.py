"""The report read from LaTeX: its translations, and documents that contain its displays."""

import json
import re
from pathlib import Path

import pytest
from shared_documents import shared

from derive.reading.document_formats import read_document
from derive.reading.latex.display_reader import formulas
from derive.reading.latex.tree import Statement
from derive.verification.documents.formula_translation import FormulaTranslator, LetterNotation
from derive.verification.documents.pages.verdicts_in_place import FormulaVerdict
from derive.verification.report.report_document import OTHER, judge_report
from derive.verification.report.report_equations import FILE
from derive.verification.report.report_judgement import EQUATIONS, verdict
from derive.verification.report.report_latex import read
from solvers.app.cli import main
from solvers.runge_kutta.order_conditions import order


def translated(latex: str, notation: LetterNotation) -> str:
    (statement,) = formulas(latex)
    assert isinstance(statement, Statement)
    return " = ".join(FormulaTranslator(notation).text(side).text for side in statement.sides)


@pytest.mark.parametrize(
    ("latex", "notation", "text"),
    [
        (r"k = f(t, w)", LetterNotation(), "k = f"),
        (
            r"k = hf(t + \frac{h}{2}, w)",
            LetterNotation(calls=frozenset({"f"})),
            "k = h*f(t + h/2, w)",
        ),
        (r"y(0) = 1", LetterNotation(calls=frozenset({"y"})), "y(0) = 1"),
        (
            r"r = l(\sin a, \cos a)",
            LetterNotation(factors=frozenset({"l"})),
            "r = l*(sin(a), cos(a))",
        ),
        (r"T = \frac{1}{2} m(x + y)", LetterNotation(), "T = 1/2*m*(x + y)"),
        (r"\begin{pmatrix} x \\ y \end{pmatrix} = z", LetterNotation(), "(x, y) = z"),
    ],
)
def test_brackets_behind_letters_hold_arguments_columns_or_factors(
    latex: str, notation: LetterNotation, text: str
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
        (r"\alpha_1(\phi_1, \phi_2) = 0", "only(alpha1, phi1, phi2) = 0"),
        (r"f_i(\phi_1) = A^{-1}", "only(f_i, phi1) = inverse(A)"),
        (r"x_1 = 1 \quad \text{for } i = 1, 2, \dots", "x1 = 1"),
        (r"a = b \implies \dot{q}_i = c", "a = b; q_i_dot = c"),
        (r"\nabla p = 0", r"\nabla p = 0"),
    ],
)
def test_letters_of_the_report_have_the_names_of_the_project(latex: str, text: str) -> None:
    assert read(latex) == text


@pytest.fixture(params=["project", "shared"])
def report(request: pytest.FixtureRequest) -> str:
    """A text with all equations of the report."""
    if request.param == "project":
        return FILE.read_text(encoding="utf-8")
    (path,) = shared("report").glob("*.txt")
    return path.read_text(encoding="utf-8")


def judged(folder: Path, text: str) -> list[FormulaVerdict]:
    """The verdicts on the report's equations in a text."""
    path = folder / "report.txt"
    path.write_text(text, encoding="utf-8")
    result = judge_report(read_document(path), order)
    assert result
    assert result.system.startswith("Double pendulum")
    assert [one.span for one in result.formulas] == sorted(one.span for one in result.formulas)
    for one in result.formulas:
        assert text[slice(*one.span)].strip() == one.latex
        assert text[: one.span[0]].count("\n") + 1 == one.line
    return [one for one in result.formulas if one.note != OTHER]


def planted(text: str, number: int, old: str, new: str) -> str:
    """A text with another part in the display with a number."""
    end = re.search(rf"(?:\\tag{{|\\quad \(){number}[)}}]", text)
    assert end
    start = text.rindex("$$", 0, end.start())
    display = text[start : end.start()]
    assert display.count(old) == 1
    return text[:start] + display.replace(old, new) + text[end.start() :]


@pytest.mark.long("more cases of the same kind", keep=1)
def test_verdicts_on_the_text_are_those_of_the_table(report: str, tmp_path: Path) -> None:
    found = judged(tmp_path, report)
    expected = [verdict(equation, order) for equation in EQUATIONS.values()]
    assert [(one.verdict, one.note) for one in found] == [(v.verdict, v.note) for v in expected]
    for one, equation, result in zip(found, EQUATIONS.values(), expected, strict=True):
        if result.verdict == "misprint":
            assert one.correction == equation.equation.format(equation.corrected_latex)
            assert one.witness == f"{result.residual} = {result.witness}"
            assert one.wrong_term in one.latex
            assert one.wrong_term
    terms = {key: one.wrong_term for key, one in zip(EQUATIONS, found, strict=True)}
    assert terms["A10"] == r"\dot{\phi}_1"
    assert terms["eq81"].startswith("-m_2")
    assert terms["eq81"].endswith(r"\theta_2)")
    assert terms["eq64"] == r"\dot{\phi}_1"


@pytest.mark.long("more cases of the same kind", keep=1, daily=10)
@pytest.mark.parametrize(
    ("number", "old", "new", "term"),
    [
        (6, r"\sin", r"\cos", r"\cos \theta"),
        (24, "m_3", "m_2", "m_2"),
        (34, r"- \ell_1 \sin", r"+ \ell_1 \sin", None),
        (56, r"- m_2", r"+ m_2", r"+ m_2g\ell_2 \cos \theta_2"),
        (65, r"\dot{\phi}_1^2", r"\dot{\phi}_1", None),
        (70, r"-\alpha_2", r"\alpha_2", r"\alpha_2 f_1"),
        (67, r"\alpha_2(\phi_1", r"\alpha_2(\phi_2", r"\phi_2"),
        (84, r"P_{\theta_1}^2", r"P_{\theta_2}^2", r"P_{\theta_2}"),
        (93, r"- \theta_2) \\", r"- \theta_2) + m_1 \\", "+ m_1"),
        (116, r"& m_2\ell_2^2", r"& m_2\ell_1^2", r"\ell_1"),
    ],
)
def test_a_planted_mistake_is_wrong_and_nothing_else_changes(
    report: str, tmp_path: Path, number: int, old: str, new: str, term: str | None
) -> None:
    before = judged(tmp_path, report)
    after = judged(tmp_path, planted(report, number, old, new))
    pairs = zip(before, after, strict=True)
    ((correct, wrong),) = [pair for pair in pairs if pair[0].latex != pair[1].latex]
    assert [*EQUATIONS][before.index(correct)] == f"eq{number}"
    assert wrong.verdict == "wrong"
    assert wrong.correction == EQUATIONS[f"eq{number}"].corrected_latex
    assert wrong.witness or wrong.note
    assert new in wrong.latex
    assert term in (None, wrong.wrong_term)
    others = [one.verdict for one in after if one is not wrong]
    assert others == [one.verdict for one in before if one is not correct]


def test_corrected_misprints_are_verified(report: str, tmp_path: Path) -> None:
    (change,) = EQUATIONS["eq64"].changes
    found = judged(tmp_path, planted(report, 64, *change))
    assert found[[*EQUATIONS].index("eq64")].verdict == "verified"


@pytest.mark.long("other tests reach its code")
def test_spelling_does_not_matter(report: str, tmp_path: Path) -> None:
    text = report.replace(r"\ell_1", "l_{1}").replace(r"\dot{\theta}_1", r"\dot{\theta_1}")
    before, after = judged(tmp_path, report), judged(tmp_path, text)
    assert [one.verdict for one in after] == [one.verdict for one in before]


def test_an_undefined_letter_is_wrong(tmp_path: Path) -> None:
    text = planted(FILE.read_text(encoding="utf-8"), 47, r"\theta_1", r"\vartheta_1")
    one = judged(tmp_path, text)[[*EQUATIONS].index("eq47")]
    assert one.verdict == "wrong"
    assert "unknown name 'vartheta1'" in one.note
    assert one.wrong_term == r"\vartheta_1"


def test_unreadable_displays_and_others_are_reported(tmp_path: Path) -> None:
    text = planted(FILE.read_text(encoding="utf-8"), 47, r"\sin", r"\frac{1}")
    path = tmp_path / "report.md"
    path.write_text(f"$$ x = y $$\n\n{text}\n$$ x = \\nabla $$\n", encoding="utf-8")
    result = judge_report(read_document(path), order)
    assert result
    unread = [one for one in result.formulas if one.verdict == "unreadable"]
    assert len(result.formulas) == len(EQUATIONS) + 2
    assert [result.formulas.index(one) for one in unread] == [47, len(EQUATIONS) + 1]
    assert (result.formulas[0].verdict, result.formulas[0].note) == ("context", OTHER)


def test_formulas_beside_a_missing_or_unreadable_equation_are_others(tmp_path: Path) -> None:
    text = FILE.read_text(encoding="utf-8")
    beside = r"-mg(\sin\theta)l = ml^2\frac{d^2\theta}{dt^2}"
    equation = EQUATIONS["eq6"].latex
    for instead in ("v = v", equation.replace("^2", "", 1)):
        path = tmp_path / "report.md"
        changed = text.replace(equation, f"{beside} \\\\ {instead}")
        path.write_text(changed, encoding="utf-8")
        result = judge_report(read_document(path), order)
        assert result
        (one,) = [one for one in result.formulas if "mg(" in one.latex and "sin" in one.latex]
        assert (one.verdict, one.note) == ("context", OTHER)
        assert "wrong" not in {one.verdict for one in result.formulas}


def test_other_documents_are_not_the_report(tmp_path: Path) -> None:
    path = tmp_path / "other.md"
    parts = FILE.read_text(encoding="utf-8").split("\n\n")
    for text in ("\n\n".join(parts[:60]), "$$ x = y $$\n\n" * 150):
        path.write_text(text, encoding="utf-8")
        assert judge_report(read_document(path), order) is None


def test_the_command_recognises_the_report(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, page = tmp_path / "copy.md", tmp_path / "page.html"
    text = FILE.read_text(encoding="utf-8")
    path.write_text(text, encoding="utf-8")
    assert main(["verify", str(path), "--json", "--annotate", str(page)]) == 0
    (document,) = json.loads(capsys.readouterr().out)["documents"]
    assert len(document["formulas"]) == len(EQUATIONS)
    assert document["formulas"][8]["wrong_term"] == "v"
    assert page.read_text(encoding="utf-8").count("misprint") >= 23
    path.write_text(planted(text, 47, r"\sin", r"\cos"), encoding="utf-8")
    assert main(["verify", str(path)]) == 1
    assert r"wrong term: \cos \theta_1" in capsys.readouterr().out
