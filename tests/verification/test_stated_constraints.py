"""Constraints that documents state themselves: multipliers are judged with them, or not at all."""

from dataclasses import replace
from pathlib import Path

import pytest
import sympy as sp

from derive import Coordinate, Derivation, Parameter, PointMass, System, load
from derive.handout.derivation_document import write_document
from derive.reading.document_formats import read_document
from derive.verification.documents.judgement import _read, judge_document
from derive.verification.documents.letters.candidates import SystemCandidate
from derive.verification.documents.letters.energies import has_rotations
from derive.verification.documents.letters.hints import hints
from derive.verification.documents.letters.letter_roles import letters_of
from derive.verification.documents.letters.stated_constraints import StatedConstraint
from derive.verification.documents.pages.verdicts_in_place import DocumentVerdicts
from derive.verification.documents.rules.consequences import Contradictions
from derive.verification.documents.rules.evidence.weighing import weighed
from derive.verification.documents.rules.side_verdict import plain
from derive.verification.documents.statements import translated
from derive.verification.judging.verdict import Correction

PENDULUM = r"""
A bob at $(x, y)$ is subject to the constraint $x^2 + y^2 = l^2$.
$$ L = \frac{1}{2} m (\dot x^2 + \dot y^2) - m g y $$
$$ m \ddot x = 2 \lambda x $$
$$ m \ddot y = -m g + 2 \lambda y $$
"""
AUGMENTED = r"""
Let $f(x, y) = x^2 + y^2 - l^2$. The Lagrangian with a multiplier is
$$ L = \frac{1}{2} m (\dot x^2 + \dot y^2) - m g y + \lambda (x^2 + y^2 - l^2) $$
$$ m \ddot x - 2 \lambda x = 0 $$
$$ m \ddot y + m g - 2 \lambda y = 0 $$
$$ \lambda = \frac{m}{2 l^2} (g y - \dot x^2 - \dot y^2) $$
"""
GRADIENT = r"""
A bead moves on the wire $f(x, y) = y - a x^2 = 0$ with $T = \frac{m}{2}(\dot x^2 + \dot y^2)$
and $V = m g y$:
$$ m \ddot x = \lambda \frac{\partial f}{\partial x} $$
$$ m \ddot y + m g = \lambda \frac{\partial f}{\partial y} $$
$$ \ddot y = 2 a (x \ddot x + \dot x^2) $$
"""
TENSION = r"""
The bob of a pendulum obeys the constraint $x^2 + y^2 = l^2$. With the tension $S$,
$$ m \ddot x = -S \frac{x}{l} $$
$$ m \ddot y = -m g - S \frac{y}{l} $$
and $E = \frac{m}{2} (\dot x^2 + \dot y^2) + m g y$ is constant.
"""
SKATE = r"""
A skate at $(x, y)$ has the direction $\phi$. It cannot slip sideways:
$$ \dot x \sin\phi - \dot y \cos\phi = 0. $$
$$ T = \frac12 m (\dot x^2 + \dot y^2) + \frac12 J \dot\phi^2 $$
$$ m \ddot x = \lambda \sin\phi $$
$$ m \ddot y = -\lambda \cos\phi $$
$$ J \ddot\phi = 0 $$
"""
SPHERE = r"""
A particle slides on a cylinder of radius $a$, with the constraint $r - a = 0$:
$$ T = \frac12 m (\dot r^2 + r^2 \dot\theta^2), \quad V = m g r \cos\theta $$
$$ m \ddot r - m r \dot\theta^2 + m g \cos\theta = \lambda $$
$$ \lambda = m g \cos\theta - m a \dot\theta^2 $$
"""
HOOP = r"""
A hoop rolls down a slope without slipping: $f = x - R\theta = 0$.
$$ T = \frac12 M \dot x^2 + \frac12 I \dot\theta^2, \quad V = -M g x \sin\alpha $$
$$ M \ddot x - M g \sin\alpha = \lambda $$
$$ I \ddot\theta = -R \lambda $$
$$ \ddot x = \frac{M g R^2 \sin\alpha}{I + M R^2} $$
"""
DISC = r"""
An upright disc rolls on a plane. The conditions of rolling without slipping are
$$ \dot x = R \dot\phi \cos\theta, \qquad \dot y = R \dot\phi \sin\theta $$
$$ L = \frac12 m (\dot x^2 + \dot y^2) + \frac12 C \dot\phi^2 + \frac12 A \dot\theta^2 $$
$$ m \ddot x = \lambda_1 $$
$$ m \ddot y = \lambda_2 $$
$$ C \ddot\phi = -R (\lambda_1 \cos\theta + \lambda_2 \sin\theta) $$
$$ (C + m R^2) \ddot\phi = 0 $$
"""
LOOP = r"""
The loop closes by the constraints
\begin{align}
 f_1 &= a\cos\alpha + b\cos\beta - c\cos\gamma - d = 0 \\
 f_2 &= a\sin\alpha + b\sin\beta - c\sin\gamma = 0
\end{align}
$$ L = \frac12 I_1 \dot\alpha^2 + \frac12 I_2 \dot\beta^2 + \frac12 I_3 \dot\gamma^2 $$
\begin{align}
 I_1 \ddot\alpha &= -\lambda_1 a\sin\alpha + \lambda_2 a\cos\alpha \\
 I_2 \ddot\beta &= -\lambda_1 b\sin\beta + \lambda_2 b\cos\beta \\
 I_3 \ddot\gamma &= \lambda_1 c\sin\gamma - \lambda_2 c\cos\gamma
\end{align}
"""
#: Each with slips: a sign, a lost term, a wrong function.
DOCUMENTS = {
    "pendulum": (PENDULUM, [("= 2 \\lambda x", "= -2 \\lambda x"), ("-m g + 2", "-2 m g + 2"),
                            ("-m g + 2 \\lambda", "2 \\lambda"), ("+ 2 \\lambda y", "")]),
    "augmented": (AUGMENTED, [("g y + \\lambda (x", "g y - \\lambda (x"),
                              ("m \\ddot x - 2", "m \\ddot x + 2"), ("(g y -", "(g x -")]),
    "gradient": (GRADIENT, [("= \\lambda \\frac{\\partial f}{\\partial x}",
                             "= -\\lambda \\frac{\\partial f}{\\partial x}"),
                            ("+ \\dot x^2)", "- \\dot x^2)")]),
    "skate": (SKATE, [("= -\\lambda \\cos", "= \\lambda \\cos"), ("J \\ddot\\phi = 0",
                                                                  "J \\ddot\\phi = \\lambda")]),
    "sphere": (SPHERE, [("- m r \\dot\\theta^2", "+ m r \\dot\\theta^2"),
                        ("- m a \\dot", "+ m a \\dot")]),
    "hoop": (HOOP, [("= -R \\lambda", "= R \\lambda"), ("{I + M R^2}", "{2 I + M R^2}")]),
    "disc": (DISC, [("+ \\lambda_2 \\sin", "- \\lambda_2 \\sin"),
                    ("\\ddot\\phi = 0", "\\ddot\\phi = m")]),
    "tension": (TENSION, []),
    "loop": (LOOP, [("- \\lambda_2 c\\cos", "+ \\lambda_2 c\\cos")]),
}  # fmt: skip
CORRECT = {"verified", "definition"}


def judged(folder: Path, text: str) -> DocumentVerdicts:
    path = folder / "page.md"
    path.write_text(text)
    return judge_document(read_document(path))


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize("name", DOCUMENTS)
def test_documents_with_their_own_constraints_are_verified(name: str, tmp_path: Path) -> None:
    document = judged(tmp_path, DOCUMENTS[name][0])
    assert {one.verdict for one in document.formulas} <= CORRECT
    assert document.system.endswith("with the constraints that the document states")


@pytest.mark.long("other tests reach its code")
def test_of_two_forms_of_a_constraint_the_multiplier_has_that_which_is_zero(tmp_path: Path) -> None:
    text = SKATE.replace("It cannot", "It has $\\dot y = \\dot x \\tan\\phi$, and cannot")
    document = judged(tmp_path, text)
    assert len(document.formulas) == 6
    assert {one.verdict for one in document.formulas} <= CORRECT


@pytest.mark.long("other tests reach its code", daily=9)
@pytest.mark.parametrize(
    ("name", "old", "new"),
    [(name, *slip) for name, (_, slips) in DOCUMENTS.items() for slip in slips],
)
def test_a_slip_is_wrong_with_a_witness(name: str, old: str, new: str, tmp_path: Path) -> None:
    text, _ = DOCUMENTS[name]
    assert text.count(old) == 1
    wrong = [one for one in judged(tmp_path, text.replace(old, new)).formulas
             if one.verdict not in CORRECT]  # fmt: skip
    assert [one.verdict for one in wrong] == ["wrong"]
    assert "instead of" in wrong[0].witness


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(
    "text",
    [
        PENDULUM[PENDULUM.index("$$ m") :],  # no constraint
        PENDULUM.replace("= l^2$", "= l^2$ and $x + 2 y = l$"),  # two for one multiplier
        PENDULUM.replace("subject to the constraint $x^2 + y^2 = l^2$", "on a curve $C$"),
    ],
)
def test_multipliers_without_certain_constraints_are_context(text: str, tmp_path: Path) -> None:
    with_multiplier = [one for one in judged(tmp_path, text).formulas if "lambda" in one.latex]
    assert {one.verdict for one in with_multiplier} == {"context"}
    assert all("constraints by --system FILE" in one.note for one in with_multiplier)


def test_a_constraint_that_coordinates_satisfy_changes_nothing(tmp_path: Path) -> None:
    text = r"""
The constraint $x^2 + y^2 = l^2$ suggests $x = l\sin\theta$ and $y = -l\cos\theta$, so that
$$ L = \frac12 m l^2 \dot\theta^2 + m g l \cos\theta $$
$$ \ddot\theta = -\frac{g}{l} \sin\theta $$
"""
    document = judged(tmp_path, text)
    assert document.system == "The system that the document states"
    assert [one.verdict for one in document.formulas].count("verified") == 3


def test_a_letter_lambda_that_is_defined_is_no_multiplier(tmp_path: Path) -> None:
    text = r"""
With $\lambda = g/l$, $\ddot\theta = -\lambda\sin\theta$
and $L = \frac12 m l^2 \dot\theta^2 + m g l\cos\theta$.
"""
    assert {one.verdict for one in judged(tmp_path, text).formulas} <= CORRECT


@pytest.mark.long("documents of large systems")
@pytest.mark.parametrize("name", ["chaplygin_sleigh", "four_bar", "heavy_top"])
def test_no_formula_of_a_correct_document_is_wrong(name: str, tmp_path: Path) -> None:
    path = tmp_path / "document.tex"
    write_document(Derivation(load(name)), path)
    assert "wrong" not in {one.verdict for one in judge_document(read_document(path)).formulas}
    own = judge_document(read_document(path), hints(name, None)).formulas
    assert {one.verdict for one in own} <= CORRECT


x, theta = sp.symbols("x theta", real=True)
m, a = sp.symbols("m a", positive=True)
CENTRE = System(
    "centre",
    "The centre of a body",
    [Coordinate(x, "m", "place"), Coordinate(theta, "rad", "angle")],
    [Parameter(m, "kg", 1.0, "mass"), Parameter(a, "m", 1.0, "length")],
    [PointMass(m, (x + a * sp.cos(theta), a * sp.sin(theta)))],
    potential=0,
    gravity=(0, 0),
)


@pytest.mark.parametrize(
    ("added", "is_rotation"),
    [
        ("", False),
        (r"+ \frac12 I\dot\theta^2", True),
        (r"+ \frac12 I\dot\theta^2 + \frac12 J\dot x^2", True),
        (r"- \frac12 I\dot\theta^2", False),
        (r"+ \frac12 m\dot\theta^2", False),  # of a mass
        (r"+ \frac12 I\theta\dot\theta^2", False),
        (r"+ \frac12 I\dot\theta^3", False),
        (r"+ \frac12 I\dot x\dot\theta", False),
    ],
)
def test_rotations_add_squares_of_velocities_to_energies_of_points(
    added: str, is_rotation: bool, tmp_path: Path
) -> None:
    path = tmp_path / "body.tex"
    path.write_text(rf"""
$$ T = \frac{{m}}{{2}} (\dot x^2 - 2 a\dot x\dot\theta\sin\theta + a^2\dot\theta^2) {added} $$
$$ V = m g a\sin\theta $$
""")
    statements = translated(_read(read_document(path))[0])
    letters = letters_of(statements.formulas, statements.derivatives)
    assert has_rotations(CENTRE, letters, statements.formulas) == is_rotation


@pytest.mark.parametrize(("constraint", "verdict"), [
    ((), "wrong"), ((StatedConstraint("x", frozenset("x"), 0),), "context"),
])  # fmt: skip
def test_a_known_system_with_a_stated_constraint_contradicts_no_single_formula(
    constraint: tuple[StatedConstraint, ...], verdict: str, tmp_path: Path
) -> None:
    (tmp_path / "a.md").write_text(r"$$x\dot x + y\dot y = x y + x^2 y$$", encoding="utf-8")
    (formula,) = translated(_read(read_document(tmp_path / "a.md"))[0]).formulas
    candidate = SystemCandidate(
        load("henon_heiles"), ("x", "y"), ((1, 0), (0, 1)), (0, 0), {}, constraints=constraint
    )
    result = plain("wrong", formula, "")
    corrected = replace(result.verdict, corrections=(Correction("x*y", "2*x*y"),))
    judged = [(formula, replace(result, verdict=corrected))]
    ((_, result),) = weighed(judged, candidate, Contradictions(), is_stated=False)
    assert result.verdict.verdict == verdict


@pytest.mark.long("other tests reach its code")
def test_a_constraint_of_no_coordinate_emits_no_warning(tmp_path: Path) -> None:
    (tmp_path / "a.md").write_text(
        r"""By the constraint $$\dot f = \omega\dot f$$
$$T = \frac12 m(\dot r^2 + r^2\dot\theta^2)$$
$$m\ddot r - m r\dot\theta^2 = - k f$$""",
        encoding="utf-8",
    )
    assert judge_document(read_document(tmp_path / "a.md")).formulas


@pytest.mark.parametrize(("formula", "is_one"), [
    (r"\dot x\sin\theta - \dot y\cos\theta = 0", True), (r"\dot x^2 + \dot y^2 = b^2", False),
    (r"(\sin^2\theta + \cos^2\theta - 1)\dot x^2 + \dot x\cos\theta = 0", True),
])  # fmt: skip
def test_constraints_are_linear_in_velocities(formula: str, is_one: bool, tmp_path: Path) -> None:
    text = (
        rf"With the constraint $${formula}$$ $$T = \frac12 m(\dot x^2 + \dot y^2 + b\dot\theta^2)$$"
    )
    (tmp_path / "a.md").write_text(text, encoding="utf-8")
    statements = translated(_read(read_document(tmp_path / "a.md"))[0])
    assert bool(letters_of(statements.formulas, statements.derivatives).constraints) == is_one
