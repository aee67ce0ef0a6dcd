"""Wrong terms in products of matrices, in roots, in rates and in terms that vanish."""

from pathlib import Path

import pytest

from derive.verification.source_files import judge_file
from solvers.runge_kutta.order_conditions import order

CART = r"""
$$(M+m)\ddot x + m l\ddot\theta\cos\theta - m l\dot\theta^2\sin\theta = F$$
$$l\ddot\theta + \ddot x\cos\theta - g\sin\theta = 0$$
$$\begin{pmatrix}\ddot x\\ \ddot\theta\end{pmatrix} =
  \begin{pmatrix} 0 & -\frac{m g}{M} \\ 0 & \frac{(M+m) g}{M l}\end{pmatrix}
  \begin{pmatrix} x \\ \theta \end{pmatrix} +
  \begin{pmatrix}\frac1M \\ -\frac{1}{M l}\end{pmatrix} F$$
"""
FIELD = r"""
$$L = \frac m2 (\dot r^2 + r^2\dot\theta^2) + \frac{k}{r}, \qquad \ell = m r^2\dot\theta$$
$$E = \frac m2\dot r^2 + \frac{\ell^2}{2 m r^2} - \frac kr$$
$$\dot r = \sqrt{\frac{2}{m}\left(E + \frac kr - \frac{\ell^2}{2 m r^2}\right)}$$
"""
POSITIONS = r"""
$$x_1 = a\sin\alpha, \quad y_1 = -a\cos\alpha$$
$$\vec r_2 = \begin{pmatrix} a\sin\alpha + b\sin\beta \\ -a\cos\alpha - b\cos\beta\end{pmatrix}$$
$$\dot x_1 = a\dot\alpha\cos\alpha$$
$$T = \tfrac12 (M + m) a^2 \dot\alpha^2 + \tfrac12 m b^2 \dot\beta^2
     + m a b \dot\alpha \dot\beta \cos(\alpha - \beta)$$
$$V = -(M + m) g a \cos\alpha - m g b \cos\beta$$
"""
VANISHING = r"""
$$(m_1+m_2) a \ddot\theta_1 + m_2 b \ddot\theta_2 \cos(\theta_1-\theta_2)
 + m_2 b \dot\theta_2^2\sin(\theta_1-\theta_2) + (m_1+m_2) g \sin\theta_1 = 0$$
$$b \ddot\theta_2 + a \ddot\theta_1 \cos(\theta_1-\theta_2)
 - a \dot\theta_1^2\sin(\theta_1-\theta_2) + g \sin\theta_2 = 0$$
"""
POLAR = r"""
$$L = \frac12 m\dot r^2 + \frac12 m\dot\phi^2 r^2$$
$$\frac{d}{dt} \frac{\partial L}{\partial \dot r} = m\ddot r$$
$$p_r = m\dot r, \quad p_\phi = m r^2\dot\phi$$
$$H = \frac{1}{2 m r^2}\left(p_\phi^2 + p_r^2 r^2\right)$$
$$\dot r = \frac{p_r}{m}, \quad
\dot p_r = -\frac{p_r^2}{m r} + \frac{1}{m r^3}\left(p_\phi^2 + p_r^2 r^2\right)$$
"""
SPRINGS = r"""
$$T = \frac12 m_1\dot x_1^2 + \frac12 m_2\dot x_2^2$$
$$V = \frac12 x_1^2\left(k_1 + k_2\right) - k_2 x_1 x_2 + \frac12 k_2 x_2^2$$
$$L = \frac12 m_1\dot x_1^2 + \frac12 m_2\dot x_2^2
     - \frac12 x_1^2\left(k_1 + k_2\right) + k_2 x_1 x_2 - \frac12 k_2 x_2^2$$
$$m_1\ddot x_1 + (k_1 + k_2) x_1 - k_2 x_2 = 0$$
$$m_2\ddot x_2 - k_2 x_1 + k_2 x_2 = 0$$
"""
TRACK = r"""
$$L = \frac12 m\dot r^2\left(\frac{a^2}{r^4} + 1\right)$$
$$\frac{d}{dt}\frac{\partial L}{\partial\dot r}
  = -\frac{4 a^2 m\dot r^2}{r^5} + m\ddot r (\frac{a^2}{r^4} + 1)$$
$$m (\frac{a^2}{r^4} + 1) \ddot r = \frac{2 a^2 m\dot r^2}{r^5}$$
"""
INERTIA = r"""
$$T = \frac12 \left(J + a^2 m\right) \dot\theta^2, \quad V = -a g m\cos\theta$$
$$\left(J + a^2 m\right) \ddot\theta + a g m\sin\theta = 0$$
$$\ddot\theta = - \frac{a g m\sin\theta}{J + a^2 m}$$
"""
SPHERE = r"""
$$L = \frac12 m l^2\left(\dot\theta^2 + \dot\phi^2\sin^2\theta\right) + m g l\cos\theta$$
$$m l^2\ddot\theta = -m g l\sin\theta + m l^2\dot\phi^2\sin\theta\cos\theta$$
$$p_\phi = m l^2\dot\phi\sin^2\theta$$
"""
STRETCHED = r"""
$$L = a k r + g m r\cos\theta - \frac{k r^2}{2}
  + \frac{m r^2\dot\theta^2}{2} + \frac{m\dot r^2}{2}$$
$$\frac{\partial L}{\partial r} = a k + g m\cos\theta - k r + m r\dot\theta^2$$
$$\frac{\partial L}{\partial\dot\theta} = m r^2\dot\theta$$
$$-a k - g m\cos\theta + k r - m r\dot\theta^2 + m\ddot r = 0$$
$$g m r\sin\theta + m r^2\ddot\theta + 2 m r\dot r\dot\theta = 0$$
"""


def wrong(folder: Path, text: str) -> list[tuple[str, str]]:
    """The wrong terms of wrong formulas, and their corrections."""
    path = folder / "document.md"
    path.write_text(text)
    formulas = judge_file(str(path), order)[0].formulas
    assert {one.verdict for one in formulas} <= {"verified", "equivalent", "definition", "wrong"}
    return [(one.wrong_term, one.correction) for one in formulas if one.verdict == "wrong"]


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("text", [CART, FIELD, POSITIONS, POLAR, SPRINGS, TRACK, SPHERE, STRETCHED])
def test_correct_formulas_are_verified(text: str, tmp_path: Path) -> None:
    assert wrong(tmp_path, text) == []


@pytest.mark.long("more cases of the same kind", keep=1, daily=10)
@pytest.mark.parametrize(
    ("text", "old", "new", "term", "correct"),
    [
        (CART, r"-\frac{m g}{M}", r"\frac{m g}{M}", r"\frac{m g}{M}", r"-\frac{"),
        (CART, r"-\frac{1}{M l}\end", r"\frac{1}{M l}\end", r"\frac{1}{M l}", r"-\frac{1}{M l}"),
        (CART, r"\frac1M", r"\frac2M", r"\frac2M", r"\frac{1}{M}"),
        (CART, r"\end{pmatrix} +", r"\end{pmatrix} -", r"\begin{pmatrix}\frac1M", "+"),
        (FIELD, r"\frac{2}{m}", r"\frac{3}{m}", r"\frac{3}{m}", r"\frac{2}{m}"),
        (FIELD, r"2 m r^2}\right", r"2 m r^3}\right", r"\frac{\ell^2}{2 m r^3}", "r^2"),
        (POSITIONS, r"x_1 = a\sin", r"x_1 = a\cos", r"a\cos\alpha", r"a \sin"),
        (POSITIONS, r"y_1 = -a", r"y_1 = -b", r"b", r"-a"),
        (POSITIONS, r"- b\cos\beta\end", r"+ b\cos\beta\end", r"b\cos\beta", r"- b"),
        (VANISHING, r"^2\sin(\theta_1-\theta_2) + (m", r"^2\sin(\theta_1-\theta_1) + (m",
         r"m_2 b \dot\theta_2^2\sin(\theta_1-\theta_1)", r"\sin\left("),
        (VANISHING, r"- a \dot\theta_1^2\sin(\theta_1-\theta_2)",
         r"- a \dot\theta_1^2\sin(\theta_2-\theta_2)",
         r"- a \dot\theta_1^2\sin(\theta_2-\theta_2)", r"\sin\left("),
        (FIELD, r"(E + \frac kr", r"(E - \frac kr", r"- \frac kr", r"\frac{k}{r}"),
        (POLAR, r"\dot r} = m\ddot", r"\dot r} = 2 m\ddot", r"2 m\ddot r", r"= m "),
        (POLAR, r"\frac{1}{m r^3}", r"\frac{1}{2 m r^3}", r"\frac{1}{2 m r^3}", r"{m r^3}"),
        (POLAR, r"$$\dot r = \frac", r"$$r = \frac", "r", r"\dot r = "),
        (SPRINGS, r"- k_2 x_1 + k_2 x_2 =", r"- k_2 x_1 =", "", r"+ k_2 x_2 = 0"),
        (TRACK, r"+ m\ddot r (", r"+ a\ddot r (", r"a\ddot r", r"m \ddot"),
        (STRETCHED, r"\frac{m r^2\dot\theta^2}", r"\frac{m r^3\dot\theta^2}",
         r"\frac{m r^3\dot\theta^2}{2}", r"+ \frac{m r^2 \dot\theta^2}{2} + \frac{m\dot r^2}"),
        (INERTIA, r"{a g m", "{a g", r"a g\sin\theta", r"= - \frac{a g m"),
        (SPHERE, r"$$m l^2\ddot", r"$$m l^5\ddot", r"m l^5\ddot\theta", r"l^2 m"),
    ],
)  # fmt: skip
def test_the_wrong_part_is_found(
    text: str, old: str, new: str, term: str, correct: str, tmp_path: Path
) -> None:
    assert text.count(old) == 1
    ((found, correction),) = wrong(tmp_path, text.replace(old, new))
    assert term in found
    assert correct in correction
