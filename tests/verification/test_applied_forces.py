"""Equations of motion with forces whose letters have no meaning, and columns of columns."""

from pathlib import Path

import pytest

from derive.formulas.expression import parse
from derive.verification.documents.pages.verdicts_in_place import FormulaVerdict
from derive.verification.source_files import judge_file
from solvers.runge_kutta.order_conditions import order

ROBOT = r"""
$$\mathbf q = \begin{pmatrix} q_1 \\ q_2\end{pmatrix}$$
$$\mathbf M = \begin{bmatrix} m_1 l_1^2 + m_2 (l_1^2 + 2 l_1 l_2 \cos q_2 + l_2^2) &
  m_2 (l_1 l_2 \cos q_2 + l_2^2)\\ m_2 (l_1 l_2 \cos q_2 + l_2^2) & m_2 l_2^2 \end{bmatrix}$$
$$V = -m_1 g l_1 \cos q_1 - m_2 g (l_1 \cos q_1 + l_2 \cos (q_1 + q_2))$$
$$\mathbf C = \begin{bmatrix} -m_2 l_1 l_2 \dot q_2\sin q_2 & -m_2 l_1 l_2
  (\dot q_1 + \dot q_2)\sin q_2 \\ m_2 l_1 l_2 \dot q_1 \sin q_2 & 0 \end{bmatrix}$$
$$\mathbf G = \begin{bmatrix} (m_1 + m_2) g l_1 \sin q_1 + m_2 g l_2 \sin(q_1 + q_2) \\
  m_2 g l_2 \sin(q_1 + q_2) \end{bmatrix}$$
"""


def judged(folder: Path, text: str) -> tuple[FormulaVerdict, ...]:
    path = folder / "document.md"
    path.write_text(text)
    return judge_file(str(path), order)[0].formulas


def last(folder: Path, text: str) -> FormulaVerdict:
    return judged(folder, text)[-1]


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize("equation", [
    r"\mathbf M\ddot{\mathbf q} + \mathbf C\dot{\mathbf q} + \mathbf G = \mathbf B\mathbf u - F",
    r"\ddot{\mathbf q} = \mathbf M^{-1}(\mathbf B\mathbf u - \mathbf C\dot{\mathbf q} - \mathbf G)",
    r"\mathbf x = \begin{pmatrix}\mathbf q\\ \dot{\mathbf q}\end{pmatrix}$$ $$\dot{\mathbf x} ="
    r"\begin{pmatrix}\dot{\mathbf q}\\ \mathbf M^{-1}(\mathbf u - \mathbf C\dot{\mathbf q} -"
    r"\mathbf G)\end{pmatrix}",
])  # fmt: skip
def test_unknown_terms_of_an_equation_are_applied_forces(equation: str, tmp_path: Path) -> None:
    one = last(tmp_path, f"{ROBOT}$${equation}$$")
    assert (one.verdict, one.note[-18:]) == ("verified", " as applied forces")


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("equation", [
    r"\mathbf M\ddot{\mathbf q} + \mathbf C\dot{\mathbf q} - \mathbf G = \mathbf B\mathbf u",
    r"\mathbf P\ddot{\mathbf q} + \mathbf C\dot{\mathbf q} + \mathbf G = 0",
    r"\mathbf B\mathbf u + \mathbf F = 0",
])  # fmt: skip
def test_equations_that_do_not_hold_otherwise_are_not_verified(
    equation: str, tmp_path: Path
) -> None:
    assert last(tmp_path, f"{ROBOT}$${equation}$$").verdict == "context"


CART = r"""
$$f_\theta = -\dot\theta$$
$$T = \frac12 \dot x^2 (M + m) + m l\dot x\dot\theta\cos\theta + \frac12 m l^2\dot\theta^2$$
$$U = -m g l\cos\theta$$
"""


@pytest.mark.long("other tests reach its code")
def test_an_equation_with_a_force_that_has_a_value_is_not_accused(tmp_path: Path) -> None:
    equation = r"$$m l\ddot x\cos\theta + m l^2\ddot\theta + m g l\sin\theta = f_\theta$$"
    one = last(tmp_path, CART + equation)
    assert one.verdict == "context"
    assert one.note == "it holds but for f_theta, which the system does not contain"
    assert last(tmp_path, CART + equation.replace("m g", "2 m g")).verdict == "wrong"


def test_a_column_of_columns_is_one_column() -> None:
    assert parse("((1, 2), (3, 4, 5))", {}).shape == (5, 1)


FREE_WHEEL = r"""
$$L = \frac12 J_1\dot\theta_1^2 + \frac12 J_2\dot\theta_2^2 + \frac12 J_3\dot\phi^2
  - \frac12 k(\theta_1 - \phi)^2$$
$$J_2\ddot\theta_2 = d f$$
$$J_3\ddot\phi = k(\theta_1 - \phi) + Q$$
"""


@pytest.mark.long("other tests reach its code")
def test_loads_of_a_free_body_verify_no_other_inertia(tmp_path: Path) -> None:
    found = judged(tmp_path, FREE_WHEEL)
    assert [(one.verdict, one.note) for one in found[1:]] == [
        ("verified", "with d, f as applied forces"),
        ("verified", "with Q as applied forces"),
    ]
    wrong = judged(tmp_path, FREE_WHEEL.replace(r"J_2\ddot", r"J_1\ddot"))
    assert [one.verdict for one in wrong[1:]] == ["context", "verified"]
    twice = FREE_WHEEL + r"$$J_1\ddot\theta_2 = d f$$"  # f is not the acceleration of theta_2
    assert [one.verdict for one in judged(tmp_path, twice)[1:]] == ["verified"] * 2 + ["context"]


def test_stated_values_verify_no_formula_that_is_written_with_their_letters(
    tmp_path: Path,
) -> None:
    text = r"""Let $m = 1$ and $\ell = 1$.
$$L = \frac12 m\ell^2\dot\theta^2 + m g\ell\cos\theta$$
$$\frac{\partial L}{\partial\dot\theta} = m\ell^2\dot\theta$$
$$\frac{\partial L}{\partial\theta} = -m g\ell\sin\theta$$
$$p = \ell^3 m\dot\theta$$"""
    assert [one.verdict for one in judged(tmp_path, text)[3:]] == ["verified"] * 2 + ["context"]


#: A pendulum with a wheel: equations of both coordinates, and solved for the accelerations.
WHEEL = r"""
$$T = \frac12 I\dot\alpha^2 + \frac12 J(\dot\alpha + \dot\beta)^2$$ $$V = m g l\cos\alpha$$
$$(I + J)\ddot\alpha + J\ddot\beta - m g l\sin\alpha = -c\dot\alpha$$
$$J(\ddot\alpha + \ddot\beta) = \tau - b\dot\beta$$
$$\ddot\alpha = \frac{m g l\sin\alpha - \tau + b\dot\beta - c\dot\alpha}{I}$$
$$\ddot\beta = \frac{\tau - b\dot\beta}{J}
  - \frac{m g l\sin\alpha - \tau + b\dot\beta - c\dot\alpha}{I}$$
"""


@pytest.mark.parametrize(("old", "new"), [
    (r"\sin\alpha - \tau", r"\sin\alpha + \tau"),
    (r"+ b\dot\beta - c", r"- b\dot\beta - c"),
])  # fmt: skip
def test_loads_are_those_that_other_equations_state(old: str, new: str, tmp_path: Path) -> None:
    right = judged(tmp_path, WHEEL)[2:]
    assert [one.verdict for one in right] == ["verified"] * 4
    found = judged(tmp_path, WHEEL.replace(old, new, 1))[2:]
    assert [one.verdict for one in found] == ["verified"] * 2 + ["wrong", "verified"]
    assert found[2].correction.replace(" ", "") == right[2].latex.replace(" ", "")


@pytest.mark.long("other tests reach its code")
def test_of_two_equations_with_contrary_loads_none_is_wrong(tmp_path: Path) -> None:
    text, *_ = WHEEL.partition(r"$$\ddot\beta")
    found = judged(tmp_path, text.replace(r"\sin\alpha - \tau", r"\sin\alpha + \tau"))[2:]
    assert "wrong" not in [one.verdict for one in found]


@pytest.mark.parametrize("load", ["R", "F_r"])  # the former can be a length
def test_a_load_with_another_sign_can_be_of_another_case(load: str, tmp_path: Path) -> None:
    text = rf"""
$$T = \frac12 m\dot s^2$$ $$V = m g s\sin\alpha$$
Upwards, $$m\ddot s = -m g\sin\alpha - {load}$$
and thus $$\ddot s = -g\sin\alpha - \frac{{{load}}}{{m}}$$
Downwards, $$m\ddot s = -m g\sin\alpha + {load}$$"""
    assert "wrong" not in [one.verdict for one in judged(tmp_path, text)]


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(("force", "term"), [("m g", "g m x"), ("k x^2", r"\frac{k x^3}{3}")])
def test_equations_refute_an_energy_that_lacks_another_force(
    force: str, term: str, tmp_path: Path
) -> None:
    text = rf"""
$$T = \frac12 m\dot x^2$$ $$V = \frac12 c x^2$$ $$m\ddot x = -c x - {force}$$
$$\ddot x = -\frac{{c}}{{m}} x - \frac{{{force}}}{{m}}$$ $$m\ddot x + c x + {force} = 0$$"""
    _, energy, *_ = judged(tmp_path, text)
    assert (energy.verdict, energy.correction.endswith(term)) == ("wrong", True)


def test_a_rate_is_no_applied_force(tmp_path: Path) -> None:
    text = r"""
$$T = \frac12 m\dot r^2$$ $$V = m g r$$ $$m\ddot r = - m g$$
$$m\ddot r - m r\dot\theta^2 = - m g$$"""
    assert [one.verdict for one in judged(tmp_path, text)[2:]] == ["verified", "context"]


def test_the_square_of_a_letter_is_no_applied_force(tmp_path: Path) -> None:
    hoop = r"""$$\vec r = R\sin\theta\,\hat i - R\cos\theta\,\hat k$$ $$V = -m g R\cos\theta$$
$$\ddot\theta = \Omega^2\sin\theta\cos\theta - \frac gR\sin\theta$$"""
    assert last(tmp_path, hoop).verdict == "context"
    assert last(tmp_path, hoop.replace(r"\Omega^2", "F")).verdict == "verified"
    pendulum = r"""$$x = b_W^2\sin\theta$$ $$y = -b_W^2\cos\theta$$ $$V = m g y$$
$$m b_W^4\ddot\theta = W - m g b_W^2\sin\theta$$"""
    assert last(tmp_path, pendulum).note == "with W as applied forces"  # b_W**2 is no square of W
