"""Documents of systems with constraints: multipliers, G and γ, and reasons; verified when read."""

import re
from pathlib import Path

import pytest

from derive import Derivation, load
from derive.handout.derivation_document import document, write_document
from derive.handout.document_model import Paragraph
from derive.reading.document_formats import read_document
from derive.verification.documents.judgement import judge_document
from derive.verification.documents.letters.hints import hints
from derive.verification.documents.pages.verdicts_in_place import DocumentVerdicts, FormulaVerdict

SWING = """
title = "Pendulum in Cartesian coordinates"
constraints = [{ formula = "x**2 + y**2 - l**2", name = "rod", unit = "N/m", meaning = "tension" }]
coordinates = { x = { unit = "m" }, y = { unit = "m" } }
[parameters]
m = { value = 1, unit = "kg" }
l = { value = 0.8, unit = "m" }
g = { value = 9.81, unit = "m/s^2" }
[[masses]]
mass = "m"
position = ["x", "y"]
"""
DISC = """
title = "A vertical rolling disc"
potential = "0"
constraints = ["x_dot - R*phi_dot*cos(theta)", "y_dot - R*phi_dot*sin(theta)"]
coordinates = { x = { unit = "m" }, y = { unit = "m" }, theta = {}, phi = {} }
[parameters]
m = { value = 1, unit = "kg" }
R = { value = 0.5, unit = "m" }
[[masses]]
mass = "m"
position = ["x + R*sin(phi)*cos(theta)", "y + R*sin(phi)*sin(theta)", "R*cos(phi)"]
[[masses]]
mass = "m"
position = ["x - R*sin(theta)", "y + R*cos(theta)", "0"]
"""


#: Of the slider-crank: formulas that follow from its constraints, and others, with corrections.
FOLLOWING = (
    r"u = \sqrt{(l - w)(l + w)}",
    r"u^2 + w^2 = l^2",
    r"\dot w = -r\dot\phi\cos\phi",
    r"\dot u = -\frac{r^2\dot\phi\sin\phi\cos\phi}{\sqrt{l^2 - r^2\sin^2\phi}}",
)
AGAINST = [
    (r"w = r\sin\phi", r"r\sin\phi", r"w = -r \sin\phi"),
    (r"u = \sqrt{l^2 + r^2\sin^2\phi}", r"r^2\sin^2\phi",
     r"u = \sqrt{l^2 - r^2 \sin^2\phi}"),
    (r"u^2 = l^2 + w^2", "w^2", "u^2 = l^2 - w^2"),
    (r"w + r\cos\phi = 0", r"r\cos\phi", r"w + r \sin\phi = 0"),
]  # fmt: skip


@pytest.fixture
def path(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    path = tmp_path / "system.toml"
    path.write_text(request.param)
    return path


def judged(path: Path, *changes: tuple[str, str]) -> DocumentVerdicts:
    """Verdicts on the document of a system, after changes of its LaTeX."""
    (written,) = write_document(Derivation(load(path)), path.with_suffix(".tex"))
    text = written.read_text(encoding="utf-8")
    for old, new in changes:
        assert text.count(old) == 1
        text = text.replace(old, new)
    written.write_text(text, encoding="utf-8")
    return judge_document(read_document(written), hints(str(path), None))


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("path", [SWING, DISC], indirect=True, ids=["swing", "disc"])
def test_a_document_is_verified_from_its_own_latex(path: Path) -> None:
    formulas = judged(path).formulas
    assert {one.verdict for one in formulas} == {"verified", "definition"}
    (motion,) = (one for one in formulas if "G^T" in one.latex)
    assert motion.verdict == "verified"
    with_multipliers = [one for one in formulas if r"\lambda_1 \frac{\partial \phi" in one.latex]
    assert [one.verdict for one in with_multipliers] == ["verified"] * 2


@pytest.fixture(scope="module")
def crank(tmp_path_factory: pytest.TempPathFactory) -> list[FormulaVerdict]:
    """Verdicts on the document of the slider-crank, with formulas that follow it."""
    path = tmp_path_factory.mktemp("crank") / "crank.tex"
    write_document(Derivation(load("slider_crank")), path)
    lines = "".join(f"\\[\n{one}\n\\]\n" for one in (*FOLLOWING, *(one for one, *_ in AGAINST)))
    text = path.read_text(encoding="utf-8").replace(r"\end{document}", lines + r"\end{document}")
    path.write_text(text, encoding="utf-8")
    return [*judge_document(read_document(path), hints("slider_crank", None)).formulas]


@pytest.mark.long("the document of a large system")
def test_formulas_of_eliminated_coordinates_are_listed_and_verified(
    crank: list[FormulaVerdict],
) -> None:
    listed = [one for one in crank if re.match(r"[wu] & = ", one.latex)]
    assert {one.latex: one.verdict for one in listed} == {
        r"w & = -r \sin\left(\phi\right)": "verified",
        r"u & = \sqrt{l^2 - r^2 \sin^2\left(\phi\right)}": "verified",
    }


@pytest.mark.long("the document of a large system")
def test_formulas_that_follow_from_the_constraints_are_verified(
    crank: list[FormulaVerdict],
) -> None:
    verdicts = {one.latex: one.verdict for one in crank}
    assert {verdicts[one] for one in FOLLOWING} == {"verified"}


@pytest.mark.long("the document of a large system")
@pytest.mark.parametrize(("wrong", "term", "correction"), AGAINST)
def test_a_formula_against_the_constraints_is_wrong(
    wrong: str, term: str, correction: str, crank: list[FormulaVerdict]
) -> None:
    (verdict,) = (one for one in crank if one.latex == wrong)
    assert (verdict.verdict, verdict.wrong_term) == ("wrong", term)
    assert re.sub(r"\\left\(|\\right\)", "", verdict.correction) == correction
    assert verdict.note == "it does not follow from the constraints"


@pytest.mark.parametrize("path", [SWING], indirect=True)
def test_a_root_holds_for_one_sign(path: Path) -> None:
    root = r"\begin{align} y = \sqrt{l^2 - x^2} \end{align}"
    (formula,) = (
        one
        for one in judged(path, (r"\end{document}", root + r"\end{document}")).formulas
        if "sqrt" in one.latex
    )
    assert (formula.verdict, formula.note) == ("verified", "it holds for one sign of the root")


@pytest.mark.parametrize("path", [SWING], indirect=True)
def test_another_sign_of_the_reactions_is_wrong(path: Path) -> None:
    wrong = [
        one.latex for one in judged(path, ("+ G^T", "- G^T")).formulas if one.verdict == "wrong"
    ]
    assert len(wrong) == 1
    assert "G^T" in wrong[0]


@pytest.mark.parametrize(
    ("path", "reason"),
    [(SWING, "momenta are not independent"), (DISC, "velocities are not integrable")],
    indirect=["path"],
)
def test_the_document_states_why_there_is_no_hamiltonian(path: Path, reason: str) -> None:
    sections = {one.title: one.blocks for one in document(Derivation(load(path))).sections}
    (paragraph,) = sections["Hamilton's equations"]
    assert isinstance(paragraph, Paragraph)
    assert reason in paragraph.text
    texts = "".join(one.text for one in sections["Constraints"] if isinstance(one, Paragraph))
    assert ("must not be used to remove velocities" in texts) == (path.read_text() == DISC)


@pytest.mark.parametrize("path", [SWING + '[equilibrium]\nx = "0"\ny = "-l"'], indirect=True)
def test_small_oscillations_are_those_of_independent_coordinates(path: Path) -> None:
    formulas = judged(path, (r"\frac{K_0}{M_0} = \frac{g}{l}", r"\frac{K_0}{M_0} = \frac{l}{g}"))
    (stiffness,) = (one for one in formulas.formulas if one.latex.startswith("K_0"))
    assert stiffness.latex == r"K_0 & = \frac{m g}{l}"
    assert [one.latex for one in formulas.formulas if one.verdict == "wrong"] == [
        r"\omega^2 & = \frac{K_0}{M_0} = \frac{l}{g}"
    ]


def test_other_documents_have_no_section_on_constraints() -> None:
    titles = [one.title for one in document(Derivation(load("single_pendulum"))).sections]
    assert "Constraints" not in titles


@pytest.mark.long("the document of a large system")
def test_positions_by_too_many_coordinates_are_no_system(tmp_path: Path) -> None:
    path = tmp_path / "body.md"
    path.write_text(
        r"The mass $m$ is at $\vec r = \begin{pmatrix} x + a\cos\theta \\ y + a\sin\theta"
        r" \end{pmatrix}$, with $m\ddot x = 0$, $m\ddot y = 0$ and $J\ddot\theta = 0$."
    )
    assert judge_document(read_document(path)).formulas
