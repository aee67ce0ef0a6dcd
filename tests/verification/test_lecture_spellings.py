"""Spellings of lecture notes that were misread: powers of brackets, columns, operating points."""

from pathlib import Path

import pytest

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


@pytest.mark.long("other tests reach its code")
def test_a_kinetic_energy_can_be_a_matrix_between_columns(tmp_path: Path) -> None:
    assert kinds(tmp_path, ARM) == ["definition", "definition", "verified", "verified"]
    assert kinds(tmp_path, ARM.replace(r"+ \frac12 B", "+ B"))[3] == "wrong"


@pytest.mark.long("other tests reach its code")
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


@pytest.mark.long("other tests reach its code")
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


ROTOR = r"""
$$T = \frac12 m \left(\dot\theta\right)^2 a^2$$ $$V = - m g a\cos\theta$$
$$a \ddot\theta = - g\sin\theta$$
"""


def test_a_letter_before_a_rate_in_brackets_with_an_exponent_is_a_factor(tmp_path: Path) -> None:
    assert kinds(tmp_path, ROTOR) == ["verified"] * 3
    assert kinds(tmp_path, ROTOR.replace(r"\frac12 m", "m")) != ["verified"] * 3


ROD = r"""
$$L = T - V$$ $$T = \frac12 m \dot x^2 + \frac12 m L^2\dot\theta^2 - m L\dot x\dot\theta\cos\theta$$
$$V = m g L\cos\theta$$
$$\frac{d}{dt}\frac{\partial L}{\partial\dot\theta}
 = -m L (\ddot x\cos\theta - \dot x\dot\theta\sin\theta) + L^2\ddot\theta m$$
"""


@pytest.mark.long("other tests reach its code")
def test_a_length_called_l_can_stand_before_brackets_beside_the_lagrangian(tmp_path: Path) -> None:
    assert kinds(tmp_path, ROD) == ["verified", "definition", "definition", "verified"]
    assert kinds(tmp_path, ROD.replace(r"\cos\theta -", r"\cos\theta +"))[-1] == "wrong"


INVERSE = r"""
$$L = \frac12 m a^2\dot\phi^2 + m g a\cos\phi$$ $$a\ddot\phi = - g\sin\phi$$
$$p_\phi = m a^2\dot\phi$$ $$\dot\phi = p_\phi / m a^2$$
"""


def test_what_stands_below_a_slash_is_not_wrong_if_more_can_be_meant(tmp_path: Path) -> None:
    result = judged(tmp_path, INVERSE)[-1]
    assert (result.verdict, "ambiguous" in result.note) == ("context", True)
    assert kinds(tmp_path, INVERSE.replace("p_\\phi / m a^2", "p_\\phi / (2 m a^2)"))[-1] == "wrong"
    assert (
        kinds(tmp_path, INVERSE.replace("p_\\phi / m a^2", "p_\\phi / (m a^2)"))[-1] == "verified"
    )
    # one half is a factor of what follows
    half = INVERSE + r"$$T = 1/2 m a^2\dot\phi^2$$"
    assert kinds(tmp_path, half)[-1] == "verified"
    assert kinds(tmp_path, half.replace("1/2 m", "3/2 m"))[-1] == "wrong"
    # the sine belongs to no denominator
    sine = INVERSE.replace(r"a\ddot\phi = - g\sin\phi", r"\ddot\phi = - g / a \sin\phi")
    assert kinds(tmp_path, sine)[1] == "verified"
    assert kinds(tmp_path, sine.replace("g / a", "2 g / a"))[1] == "wrong"


TOP = r"""
$$H = \frac{p_\theta^2}{2 A} + \frac{(p_\phi - p_\psi\cos\theta)^2}{2 A\sin^2\theta}
 + \frac{p_\psi^2}{2 C} + M g h\cos\theta$$
$$\dot\theta = \frac{p_\theta}{A}$$
$$\dot\phi = \frac{p_\phi - p_\psi\cos\theta}{A\sin^2\theta}$$
$$\dot\psi = \frac{p_\psi}{C} - \frac{p_\phi - p_\psi\cos\theta}{A\sin^2\theta}\cos\theta$$
$$p_\phi = \text{const.}$$ $$p_\psi = \text{const.}$$
"""


def test_each_constant_of_the_motion_is_one_of_its_own(tmp_path: Path) -> None:
    assert kinds(tmp_path, TOP) == ["definition", *["verified"] * 5]
    results = judged(tmp_path, TOP + r"$$p_\theta = \text{const.}$$")
    assert (results[-1].verdict, results[-1].note) == ("context", "it changes along most motions")
