"""Documents about systems with constraints: multipliers, and substitution into the Lagrangian."""

from pathlib import Path

import pytest

from derive.reading.document_formats import read_document
from derive.verification.documents.judgement import judge_document
from derive.verification.documents.letters.hints import hints
from derive.verification.documents.pages.verdicts_in_place import DocumentVerdicts

# the shipped disc, with the lean phi, the heading psi and the turn chi
MULTIPLIERS = r"""
\begin{document}
A disc rolls on a plane, with the constraints
\[ \dot x\cos\psi + \dot y\sin\psi = R\dot\chi \]
\[ \dot y\cos\psi = \dot x\sin\psi \]
The equations of motion are
\begin{align}
 m\ddot x + m R\frac{d}{dt}\left(\dot\phi\sin\psi\cos\phi + \dot\psi\sin\phi\cos\psi\right)
   &= \lambda_1\cos\psi - \lambda_2\sin\psi \\
 m\ddot y + m R\frac{d}{dt}\left(\dot\psi\sin\phi\sin\psi - \dot\phi\cos\phi\cos\psi\right)
   &= \lambda_1\sin\psi + \lambda_2\cos\psi \\
 2 k m R^2\left(\ddot\chi + \ddot\psi\sin\phi + \dot\psi\dot\phi\cos\phi\right) &= -R\lambda_1
\end{align}
and, without multipliers,
\[ (k + 1)\ddot\phi + k\dot\psi^2\sin\phi\cos\phi
 - (2k + 1)\dot\psi(\dot\chi + \dot\psi\sin\phi)\cos\phi = \frac{g}{R}\sin\phi \]
\[ \ddot\psi\cos\phi - 2\dot\psi\dot\phi\sin\phi
 + 2\dot\phi(\dot\chi + \dot\psi\sin\phi) = 0 \]
\end{document}
"""
# L without x_dot and y_dot: of its own equations, that of phi holds
SUBSTITUTION = r"""
\begin{document}
With $\dot x = R\dot\chi\cos\psi$ and $\dot y = R\dot\chi\sin\psi$, the Lagrangian is
\[ L = \frac{1}{2} m R^2\left((2k + 1)(\dot\chi + \dot\psi\sin\phi)^2
 + (k + 1)\dot\phi^2 + k\dot\psi^2\cos^2\phi\right) - m g R\cos\phi \]
so that the equations of motion are
\[ (2k + 1)\frac{d}{dt}(\dot\chi + \dot\psi\sin\phi) = 0 \]
\[ k\ddot\psi\cos^2\phi - 2k\dot\psi\dot\phi\sin\phi\cos\phi
 + (2k + 1)\frac{d}{dt}\left((\dot\chi + \dot\psi\sin\phi)\sin\phi\right) = 0 \]
\[ (k + 1)\ddot\phi + k\dot\psi^2\sin\phi\cos\phi
 - (2k + 1)\dot\psi(\dot\chi + \dot\psi\sin\phi)\cos\phi = \frac{g}{R}\sin\phi \]
\end{document}
"""


def judged(folder: Path, text: str, system: str) -> DocumentVerdicts:
    path = folder / "paper.tex"
    path.write_text(text)
    return judge_document(read_document(path), hints(system, None))


@pytest.mark.long("the document of a rolling disc")
def test_a_rolling_disc_with_multipliers_is_verified(tmp_path: Path) -> None:
    formulas = judged(tmp_path, MULTIPLIERS, "rolling_disc").formulas
    assert [one.verdict for one in formulas] == ["verified"] * 7


@pytest.mark.long("the document of a linkage")
def test_another_sign_of_a_multiplier_is_wrong(tmp_path: Path) -> None:
    text = MULTIPLIERS.replace(r"-R\lambda_1", r"R\lambda_1")
    wrong = [one for one in judged(tmp_path, text, "rolling_disc").formulas
             if one.verdict == "wrong"]  # fmt: skip
    assert len(wrong) == 1
    assert r"\lambda_1" in wrong[0].wrong_term


@pytest.mark.long("a long substitution")
def test_a_rolling_disc_by_substitution_is_wrong(tmp_path: Path) -> None:
    formulas = judged(tmp_path, SUBSTITUTION, "rolling_disc").formulas
    verdicts = [one.verdict for one in formulas]
    assert verdicts == ["verified", "verified", "wrong", "wrong", "wrong", "verified"]
    lagrangian, turn, heading = (one.note for one in formulas[2:5])
    assert lagrangian.startswith("it is the Lagrangian of motions alone")
    for note in (turn, heading):
        assert note.startswith("it follows from the Lagrangian without x_dot, y_dot; ")
        assert "must not be used before the Lagrangian is differentiated" in note
