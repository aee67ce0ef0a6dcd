"""Matrices and columns of documents: by their entries, of small motions, of state spaces."""

from pathlib import Path

import pytest

from derive.verification.documents.pages.verdicts_in_place import FormulaVerdict
from derive.verification.documents.rules.frequencies import OF_DETERMINANT
from derive.verification.source_files import judge_file
from solvers.runge_kutta.order_conditions import order

CART = r"""
$$(M+m)\ddot x + m l\ddot\theta\cos\theta - m l\dot\theta^2\sin\theta = F$$
$$l\ddot\theta + \ddot x\cos\theta - g\sin\theta = 0$$
$$\ddot\theta = \frac{(M+m) g}{M l}\theta - \frac{F}{M l}$$
"""
STATES = r"""
$$A = \begin{bmatrix} 0 & 0 & 1 & 0 \\ 0 & 0 & 0 & 1 \\ 0 & -\frac{m g}{M} & 0 & 0 \\
  0 & \frac{(M+m) g}{M l} & 0 & 0 \end{bmatrix}$$
$$B = \begin{bmatrix} 0 \\ 0 \\ \frac{1}{M} \\ -\frac{1}{M l} \end{bmatrix}$$
"""
PAIRS = r"""
$$A = \begin{bmatrix} 0 & 1 & 0 & 0 \\ 0 & 0 & -\frac{m g}{M} & 0 \\ 0 & 0 & 0 & 1 \\
  0 & 0 & \frac{(M+m) g}{M l} & 0 \end{bmatrix}$$
"""
ENTRIES = r"""
$$V = -m_1 g a\cos\alpha - m_2 g (a\cos\alpha + b\cos\beta)$$
$$T = \tfrac12 m_1 a^2\dot\alpha^2 + \tfrac12 m_2 (a^2\dot\alpha^2 + b^2\dot\beta^2
  + 2 a b\dot\alpha\dot\beta\cos(\alpha-\beta))$$
$$D_{11} = (m_1 + m_2) a^2, \quad D_{12} = m_2 a b\cos(\alpha-\beta), \quad D_{22} = m_2 b^2$$
$$f_1 = -m_2 a b\dot\beta^2\sin(\alpha-\beta) - (m_1 + m_2) g a\sin\alpha$$
$$f_2 = m_2 a b\dot\alpha^2\sin(\alpha-\beta) - m_2 g b\sin\beta$$
$$D\begin{pmatrix}\ddot\alpha\\ \ddot\beta\end{pmatrix} = \vec f$$
"""
SMALL = r"""
$$M_0 = \begin{pmatrix} (m_1 + m_2) a^2 & m_2 a b \\ m_2 a b & m_2 b^2 \end{pmatrix}$$
$$K = \begin{pmatrix} (m_1 + m_2) g a & 0 \\ 0 & m_2 g b \end{pmatrix}$$
$$M_0\ddot{\vec u} + K\vec u = 0$$
"""


def judged(folder: Path, text: str) -> list[FormulaVerdict]:
    path = folder / "document.md"
    path.write_text(text)
    return list(judge_file(str(path), order)[0].formulas)


def wrong(folder: Path, text: str) -> list[str]:
    """The wrong terms, after a check that all other formulas are correct."""
    formulas = judged(folder, text)
    verdicts = {one.verdict for one in formulas}
    assert verdicts <= {"verified", "definition", "wrong"}, formulas
    return [one.wrong_term for one in formulas if one.verdict == "wrong"]


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("text", [CART + STATES, CART + PAIRS, ENTRIES, ENTRIES + SMALL])
def test_matrices_of_the_system_are_verified(text: str, tmp_path: Path) -> None:
    assert wrong(tmp_path, text) == []
    assert judged(tmp_path, text)[-1].verdict == "verified"


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(
    ("text", "old", "new", "term"),
    [
        (CART + STATES, r"-\frac{m g}{M}", r"\frac{m g}{M}", r"\frac{m g}{M}"),
        (CART + STATES, r"-\frac{1}{M l}", r"-\frac{1}{m l}", "m"),
        (CART + PAIRS, r"(M+m) g}{M l} & 0", r"(M+m) g}{M} & 0", "g"),
        (ENTRIES, r"D_{12} = m_2", r"D_{12} = m_1", "m_1"),
        (ENTRIES, r"f_2 = m_2 a", r"f_2 = -m_2 a", r"-m_2 a b\dot\alpha^2\sin(\alpha-\beta)"),
        (ENTRIES + SMALL, r"& m_2 b^2 \end", r"& m_2 b^3 \end", "b^3"),
        (ENTRIES + SMALL, r"& m_2 g b \end", r"& m_1 g b \end", "m_1"),
    ],
)
def test_wrong_entries_are_found(text: str, old: str, new: str, term: str, tmp_path: Path) -> None:
    assert text.count(old) == 1
    assert term in wrong(tmp_path, text.replace(old, new))[0]


def test_a_letter_of_a_state_is_defined(tmp_path: Path) -> None:
    text = CART + r"$$x = [x, \dot x, \theta, \dot\theta]$$"
    assert judged(tmp_path, text)[-1].note == "x denotes a state here"


@pytest.mark.long("other tests reach its code")
def test_other_matrices_are_definitions(tmp_path: Path) -> None:
    text = CART + r"$$Q = \begin{pmatrix} 1 & 0 \\ 0 & m \end{pmatrix}$$"
    assert judged(tmp_path, text)[-1].verdict == "definition"


def test_the_rate_of_a_state_can_be_a_column_with_accelerations(tmp_path: Path) -> None:
    text = r"""$$m\ddot x = -k x - b\dot x$$
$$\begin{bmatrix} \dot x\\ \ddot x \end{bmatrix} = \begin{bmatrix} 0 & 1\\
  -\frac km & -\frac bm \end{bmatrix}\begin{bmatrix} x\\ \dot x \end{bmatrix}$$"""
    assert [one.verdict for one in judged(tmp_path, text)] == ["verified"] * 2
    assert judged(tmp_path, text.replace(r"-\frac km", r"\frac km"))[1].verdict != "verified"


COUPLED = r"""
$$T = \frac12 m\dot x_1^2 + \frac12 m\dot x_2^2$$
$$V = \frac12 k x_1^2 + \frac12 k (x_2 - x_1)^2 + \frac12 k x_2^2$$
$$m\ddot x_1 = -2 k x_1 + k x_2$$
"""
OSCILLATOR = r"""
$$T = \frac12 m\dot x^2$$ $$V = \frac12 k x^2$$ $$m\ddot x + b\dot x + k x = 0$$
"""


@pytest.mark.parametrize(("system", "right", "slip", "term"), [
    (COUPLED, r"(2 k - m\omega^2)^2 - (-k)^2 = 0", r"(2 k - m\omega^2)^2 + (-k)^2 = 0", "(-k)^2"),
    (COUPLED, r"(2 k - m\omega^2 - k)(2 k - m\omega^2 + k) = 0",
     r"(2 k - m\omega^2 - k)(k - m\omega^2 + k) = 0", r"(k - m\omega^2 + k)"),
    (COUPLED, r"(k - m\omega^2)(3 k - m\omega^2) = 0",
     r"(k - m\omega^2)(2 k - m\omega^2) = 0", "2 k"),
    (COUPLED, r"m^2\lambda^2 - 4 k m\lambda + 3 k^2 = 0",
     r"m^2\lambda^2 - 2 k m\lambda + 3 k^2 = 0", r"- 2 k m\lambda"),
    (COUPLED, r"3 k - m\omega^2 = 0", "", ""),  # a factor
    (OSCILLATOR, r"m s^2 + b s + k = 0", "m s^2 - b s + k = 0", "- b s"),
    (OSCILLATOR, r"\lambda^2 + \frac bm\lambda + \frac km = 0",
     r"\lambda^2 + \frac{2 b}m\lambda + \frac km = 0", r"\frac{2 b}m\lambda"),
])  # fmt: skip
def test_equations_of_frequencies_are_determinants_of_small_motions(
    system: str, right: str, slip: str, term: str, tmp_path: Path
) -> None:
    result = judged(tmp_path, f"{system}$${right}$$")[-1]
    assert (result.verdict, result.note) == ("verified", OF_DETERMINANT)
    if slip:
        result = judged(tmp_path, f"{system}$${slip}$$")[-1]
        assert (result.verdict, result.wrong_term) == ("wrong", term)


@pytest.mark.parametrize("other", [
    r"2 k - m\omega^2 = 0", r"k x_1 - m\omega^2 = 0", r"\omega^2 - \kappa = 0",
    r"\omega - 1 = 0", r"k - m\omega^2 = k = 0", r"\mu k - 3 m\mu^2 = 0",
])  # fmt: skip
def test_other_equations_of_a_frequency_are_not_wrong(other: str, tmp_path: Path) -> None:
    assert judged(tmp_path, f"{COUPLED}$${other}$$")[-1].verdict in ("definition", "context")


def test_a_product_of_columns_is_a_number(tmp_path: Path) -> None:
    verdicts = judged(tmp_path, r"""
$$ T = \frac12 m (\dot x^2 + \dot y^2), \qquad V = \frac12 k (x^2 + y^2) $$
$$ m \ddot x = -k x, \qquad m \ddot y = -k y $$
$$ \mathbf{q} = \begin{pmatrix} x \\ y \end{pmatrix} $$
$$ T = m \dot{\mathbf{q}}^T \dot{\mathbf{q}} $$
""")  # fmt: skip
    assert verdicts[-1].correction == r"T = \frac{1}{2} m \dot{\mathbf{q}}^T \dot{\mathbf{q}}"


def test_a_product_of_columns_across_their_plane_is_a_number(tmp_path: Path) -> None:
    text = r"""
$$ T = \frac12 m (\dot x^2 + \dot y^2), \qquad V = \frac12 k (x^2 + y^2) $$
$$ m \ddot x = -k x, \qquad m \ddot y = -k y $$
$$ \mathbf{r} = \begin{pmatrix} x \\ y \end{pmatrix}, \quad
\mathbf{v} = \begin{pmatrix} \dot x \\ \dot y \end{pmatrix} $$
$$ m \mathbf{r} \times \mathbf{v} = m (x\dot y - y\dot x) $$
"""
    assert judged(tmp_path, text)[-1].verdict == "verified"
    slip = judged(tmp_path, text.replace(r"(x\dot y - y", r"(x\dot y + y"))
    assert slip[-1].verdict != "verified"


ARM = r"""
$$M(q)\ddot q + C(q, \dot q)\dot q + g(q) = \tau$$
$$M_{11} = a + 2 b\cos q_2, \quad M_{12} = M_{21} = d + b\cos q_2, \quad M_{22} = d$$
$$C_{11} = -b\sin(q_2)\dot q_2, \quad C_{12} = -b\sin(q_2)(\dot q_1 + \dot q_2)$$
$$C_{21} = b\sin(q_2)\dot q_1, \quad C_{22} = 0$$
$$g_1 = m_1 g l_1\cos q_1 + m_2 g l_2\cos(q_1 + q_2), \quad g_2 = m_2 g l_2\cos(q_1 + q_2)$$
The error is $e = q_d - q$, and $M(q)\ddot q = M(q) u$.
"""


@pytest.mark.long("both rows are judged alike", keep=1)
@pytest.mark.parametrize(("right", "slip"), [
    (r"C_{11} = -b\sin(q_2)\dot q_2", r"C_{11} = b\sin(q_2)\dot q_2"),
    (r"C_{21} = b\sin(q_2)\dot q_1", r"C_{21} = b\cos(q_2)\dot q_1"),
])  # fmt: skip
def test_entries_of_matrices_state_a_system(right: str, slip: str, tmp_path: Path) -> None:
    assert not any(one.verdict == "wrong" for one in judged(tmp_path, ARM))
    assert judged(tmp_path, ARM)[0].verdict == "verified"
    (one,) = (one for one in judged(tmp_path, ARM.replace(right, slip)) if one.verdict == "wrong")
    assert one.latex == slip


COLUMNS = r"""
$$M(q)\ddot q + C(q, \dot q)\dot q + G(q) = \tau, \quad q = [q_1, q_2]^T \in \mathbb{R}^2$$
$$M(q) = \begin{bmatrix} M_{11} & M_{12} \\ M_{21} & M_{22} \end{bmatrix}
= \begin{bmatrix} a + 2 b\cos q_2 & d + b\cos q_2 \\ d + b\cos q_2 & d \end{bmatrix}$$
$$C(q, \dot q)\dot q = \begin{bmatrix} H_1 \\ H_2 \end{bmatrix} = b\begin{bmatrix}
-2\dot q_1\dot q_2 - \dot q_2^2 \\ \dot q_1^2 \end{bmatrix}\sin q_2$$
$$G(q) = \begin{bmatrix} G_1 \\ G_2 \end{bmatrix}
= \begin{bmatrix} s\cos q_1 + c\cos(q_1 + q_2) \\ c\cos(q_1 + q_2) \end{bmatrix}$$
$$E = \frac12\dot q^T M(q)\dot q + P(q), \quad P(q) = s\sin q_1 + c\sin(q_1 + q_2)$$
$$\Delta = M_{11} M_{22} - M_{12} M_{21} = (a - d) d - b^2\cos^2 q_2 > 0$$
"""


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(("right", "slip"), [
    (r"-2\dot q_1\dot q_2 - ", r"-\dot q_1\dot q_2 - "),
    (r"- b^2\cos^2 q_2 > 0", r"- b\cos^2 q_2 > 0"),
])  # fmt: skip
def test_matrices_that_are_written_out_twice(right: str, slip: str, tmp_path: Path) -> None:
    verdicts = [one.verdict for one in judged(tmp_path, COLUMNS)]
    assert "wrong" not in verdicts
    assert verdicts.count("verified") >= 4
    (one,) = (
        one for one in judged(tmp_path, COLUMNS.replace(right, slip)) if one.verdict == "wrong"
    )
    assert slip in one.latex


def test_the_column_of_gravity_is_the_gradient_of_the_potential(tmp_path: Path) -> None:
    text = COLUMNS.replace(r"s\cos q_1 + c\cos(q_1", r"s\sin q_1 + c\cos(q_1")
    (one,) = (one for one in judged(tmp_path, text) if one.verdict == "wrong")
    assert one.wrong_term == r"s\sin q_1"


def test_entries_beside_their_matrix_are_those_of_the_mass_matrix(tmp_path: Path) -> None:
    text = r"""$$T = \frac12 (a + 2 b\cos q_2)\dot q_1^2 + (d + b\cos q_2)\dot q_1\dot q_2
+ \frac12 d\dot q_2^2, \quad V = c\cos q_1$$
$$M = \begin{bmatrix} M_{11} & M_{12} \\ M_{21} & M_{22} \end{bmatrix}$$
$$M_{11} = a + 2 b\cos q_2, \quad M_{12} = M_{21} = d + b\cos q_2, \quad M_{22} = d$$"""
    assert [one.verdict for one in judged(tmp_path, text)][3:] == ["verified"] * 3
    slip = judged(
        tmp_path, text.replace(r"d + b\cos q_2, \quad M_{22}", r"d + b\sin q_2, \quad M_{22}")
    )
    assert [one.verdict for one in slip].count("wrong") == 1
