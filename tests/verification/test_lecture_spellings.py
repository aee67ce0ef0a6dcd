"""Spellings of lecture notes that were misread: powers of brackets, columns, operating points."""

from pathlib import Path

from derive.reading.document_formats import read_document
from derive.verification.documents.judgement import judge_document
from derive.verification.documents.pages.verdicts_in_place import FormulaVerdict


def judged(folder: Path, text: str) -> list[FormulaVerdict]:
    (folder / "a.md").write_text(text, encoding="utf-8")
    return [*judge_document(read_document(folder / "a.md")).formulas]


def kinds(folder: Path, text: str) -> list[str]:
    return [one.verdict for one in judged(folder, text)]


ARM = r"""
$$T = \frac12 \dot q^T \begin{bmatrix} A + B\cos q_2 & C \\ C & D \end{bmatrix} \dot q$$
$$V = k q_2^2$$
$$(A + B\cos q_2)\ddot q_1 + C\ddot q_2 - B\sin q_2\,\dot q_1\dot q_2 = \tau_1$$
$$C\ddot q_1 + D\ddot q_2 + \frac12 B\sin q_2\,\dot q_1^2 + 2 k q_2 = 0$$
"""


def test_a_kinetic_energy_can_be_a_matrix_between_columns(tmp_path: Path) -> None:
    assert kinds(tmp_path, ARM) == ["definition", "definition", "verified", "verified"]
    assert kinds(tmp_path, ARM.replace(r"+ \frac12 B", "+ B"))[3] == "wrong"


def test_a_letter_before_brackets_is_squared_with_them(tmp_path: Path) -> None:
    text = r"""$$T = \frac12 m (a(\dot\alpha + \dot\beta))^2
 = \frac12 m a^2 (\dot\alpha + \dot\beta)^2$$
$$T = \frac12 m (a (\dot\alpha + \dot\beta))^2$$ $$V = \frac14 c\alpha^4 + c\beta^2$$"""
    assert "verified" in kinds(tmp_path, text)[:2]
    assert "wrong" not in kinds(tmp_path, text)


PENDULUM = r"""
$$\dot\phi = w$$ $$\dot w = -\frac{g}{a}\sin\phi - \frac{b}{m a^2}w + \frac{u}{m a^2}$$
The state is $$x = \begin{bmatrix}\phi\\ w\end{bmatrix}$$ and near $(\phi, w, u) = (0, 0, 0)$
$$\dot x = A x + B u$$
$$A = \begin{bmatrix} 0 & 1 \\ -\frac{g}{a} & -\frac{b}{m a^2} \end{bmatrix}$$
$$B = \begin{bmatrix} 0 \\ \frac{1}{m a^2} \end{bmatrix}$$
"""


def test_a_column_of_numbers_is_a_place(tmp_path: Path) -> None:
    assert kinds(tmp_path, PENDULUM)[3] == "context"
    assert "wrong" not in kinds(tmp_path, PENDULUM)


def test_a_step_with_a_speed_leaves_the_others_to_be_judged(tmp_path: Path) -> None:
    text = r"""$$T = \frac12 m v^2 = \frac12 m a^2\dot\phi^2$$ $$\bold U = -m g a\cos\phi$$
$$a\ddot\phi = -g\sin\phi$$"""
    found = judged(tmp_path, text)
    assert (found[0].verdict, found[0].note) == ("verified", "the side with v is not judged")
    assert judged(tmp_path, text.replace("a^2", "a"))[0].verdict != "verified"


def test_a_function_is_known_by_its_derivative(tmp_path: Path) -> None:
    text = r"""$$V_1 = -m g a\cos\phi$$ $$V_2 = -\frac12 m w^2 a^2\sin^2\phi$$
$$W(\phi) = V_1 + V_2 = -m g a\cos\phi - \frac12 m w^2 a^2\sin^2\phi$$
so that $$\frac{dW}{d\phi} = m g a\sin\phi - m w^2 a^2\sin\phi\cos\phi$$"""
    assert kinds(tmp_path, text)[:3] == ["definition", "definition", "verified"]
