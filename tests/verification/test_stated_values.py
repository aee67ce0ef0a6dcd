"""Values and relations that documents state beside a motion, and terms of their Lagrangians."""

from pathlib import Path

from derive.reading.document_formats import read_document
from derive.verification.documents.judgement import judge_document
from derive.verification.documents.pages.verdicts_in_place import DocumentVerdicts

CORRECT = {"verified", "definition"}


def judged(folder: Path, text: str) -> DocumentVerdicts:
    (folder / "a.md").write_text(text, encoding="utf-8")
    return judge_document(read_document(folder / "a.md"))


def verdicts(folder: Path, text: str) -> list[str]:
    return [one.verdict for one in judged(folder, text).formulas]


def test_a_length_l_beside_a_difference_of_energies(tmp_path: Path) -> None:
    text = r"""With $L = 2b$, $$I = \frac13 m L^2 = \frac43 m b^2$$
$$T = \frac12 I\dot\theta^2$$ $$V = -m g b\cos\theta$$ $$L = T - V$$"""
    assert {*verdicts(tmp_path, text)} <= CORRECT


def test_a_difference_of_lengths_is_a_factor(tmp_path: Path) -> None:
    text = r"""$$L = T - V$$ $$T = \frac12 m\dot r^2$$
$$V = m g (L - r)\sin\alpha + \frac12 k r^2$$
$$\frac{\partial L}{\partial r} = m g\sin\alpha - k r$$ $$m\ddot r = m g\sin\alpha - k r$$"""
    assert {*verdicts(tmp_path, text)} <= CORRECT
    assert verdicts(tmp_path, text.replace("= m g\\sin", "= -m g\\sin", 1))[3] == "wrong"
