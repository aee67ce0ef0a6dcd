"""Formulas that follow from a document's definitions, whatever the motion is."""

from pathlib import Path

import pytest

from derive.reading.document_formats import read_document
from derive.verification.documents.judgement import judge_document


def verdicts(folder: Path, text: str, name: str = "a.md") -> list[str]:
    (folder / name).write_text(text, encoding="utf-8")
    return [one.verdict for one in judge_document(read_document(folder / name)).formulas]


PERIODS = r"""$$ \omega = \sqrt{\frac{k}{m}} $$
$$ f = \frac{\omega}{2\pi} = \frac{1}{2\pi}\sqrt{\frac{k}{m}} $$
$$ T = \frac{2\pi}{\omega} = 2\pi\sqrt{\frac{m}{k}} $$"""


def test_chains_follow_from_definitions(tmp_path: Path) -> None:
    assert verdicts(tmp_path, PERIODS) == ["definition", "verified", "verified"]


@pytest.mark.parametrize(("old", "new", "expected"), [
    (r"2\pi\sqrt{\frac{m}{k}}", r"2\pi\sqrt{\frac{k}{m}}", ["definition", "verified", "wrong"]),
    (r"\frac{1}{2\pi}\sqrt", r"\frac{1}{\pi}\sqrt", ["definition", "wrong", "verified"]),
    # all others contradict the first one, which can be the right one
    (r"\omega = \sqrt{\frac{k}{m}}", r"\omega = \sqrt{\frac{m}{k}}", ["context"] * 3),
    # another oscillator with other letters
    (r"2\pi\sqrt{\frac{m}{k}}", r"2\pi\sqrt{\frac{l}{g}}", ["definition", "verified", "context"]),
])  # fmt: skip
def test_a_chain_is_wrong_if_another_confirms_its_definitions(
    old: str, new: str, expected: list[str], tmp_path: Path
) -> None:
    assert verdicts(tmp_path, PERIODS.replace(old, new)) == expected


def test_a_name_with_two_definitions_accuses_nothing(tmp_path: Path) -> None:
    text = PERIODS.replace(r"\sqrt{\frac{m}{k}}", r"\sqrt{\frac{m}{2 k}}")
    text += "with two springs, where $\\omega = \\sqrt{\\frac{2 k}{m}}$"
    assert "wrong" not in verdicts(tmp_path, text)


POLAR = r"""$$ \mathbf r = r\,\hat{\mathbf r} $$
$$ \dot{\mathbf r} = \dot r\,\hat{\mathbf r} + r\dot\theta\,\hat{\boldsymbol\theta} $$
$$ \ddot{\mathbf r} = (\ddot r - r\dot\theta^2)\,\hat{\mathbf r}
 + (r\ddot\theta + 2\dot r\dot\theta)\,\hat{\boldsymbol\theta} $$
$$ \dot{\hat{\mathbf r}} = \dot\theta\,\hat{\boldsymbol\theta} $$"""


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(("old", "new", "number"), [
    ("", "", 0),
    (r"2\dot r\dot\theta", r"\dot r\dot\theta", 2),
    (r"\ddot r - r", r"\ddot r + r", 2),
    (r"r\dot\theta\,\hat", r"r^2\dot\theta\,\hat", 1),
])  # fmt: skip
def test_velocities_and_accelerations_by_unit_vectors(
    old: str, new: str, number: int, tmp_path: Path
) -> None:
    expected = ["definition", "verified", "verified", "verified"]
    if old:
        expected[number] = "wrong"
    assert verdicts(tmp_path, POLAR.replace(old, new)) == expected


@pytest.mark.long("other tests reach its code")
def test_unit_vectors_can_be_written_out(tmp_path: Path) -> None:
    text = r"""
.. math::

    \mathbf{e_r} = \langle \cos\theta, \sin\theta \rangle

    \mathbf{e_\theta} = \langle -\sin\theta, \cos\theta \rangle

    \mathbf r = r\,\mathbf{e_r}

    \mathbf v = \dot{\mathbf r} = \dot r\,\mathbf{e_r} + r\dot\theta\,\mathbf{e_\theta}
"""
    assert verdicts(tmp_path, text, "a.rst")[-1] == "verified"
    assert verdicts(tmp_path, text.replace(r"{e_r} + r\dot", r"{e_r} - r\dot"), "a.rst")[-1] in (
        "wrong",
        "context",
    )


GENERAL = r"""$$ %s $$ $$ \dot p_i = -\frac{\partial H}{\partial q_i} $$"""


@pytest.mark.parametrize(("formula", "expected"), [
    (r"\dot q_i = \frac{\partial H}{\partial p_i}", "verified"),
    (r"\dot q_i = -\frac{\partial H}{\partial p_i}", "context"),
    (r"\dot q_i = \frac{\partial H}{\partial q_i}", "wrong"),
])  # fmt: skip
def test_general_equations_hold_for_any_motion(formula: str, expected: str, tmp_path: Path) -> None:
    assert verdicts(tmp_path, GENERAL % formula)[0] == expected


@pytest.mark.long("other tests reach its code")
def test_components_of_a_position_have_its_index(tmp_path: Path) -> None:
    text = r"""$$ \vec x_p = \begin{pmatrix} x + l\sin\theta \\ -l\cos\theta \end{pmatrix} $$
$$ T = \frac12 M\dot x^2 + \frac12 m(\dot x^2 + 2 l\dot x\dot\theta\cos\theta + l^2\dot\theta^2) $$
$$ V = m g y_p = -m g l\cos\theta $$
$$ \ddot x\cos\theta + l\ddot\theta + g\sin\theta = 0 $$"""
    assert verdicts(tmp_path, text)[2:] == ["verified", "verified"]
    assert verdicts(tmp_path, text.replace("= m g y_p", "= 2 m g y_p"))[2] == "wrong"


AREA = r"""$$\hat r = \cos\phi\,\hat x + \sin\phi\,\hat y$$
$$\hat\phi = -\sin\phi\,\hat x + \cos\phi\,\hat y$$
$$\frac{d\hat r}{dt} = (-\sin\phi\,\hat x + \cos\phi\,\hat y)\dot\phi = \dot\phi\,\hat\phi$$
$$\vec r = r\hat r$$
$$\vec v = \dot r\hat r + r\dot\phi\,\hat\phi$$ $$v_\phi = r\dot\phi$$
$$\vec J = \vec r\times m\vec v = m r^2\dot\phi\,\hat z$$
$$\vec a = (\ddot r - r\dot\phi^2)\hat r + (r\ddot\phi + 2\dot r\dot\phi)\hat\phi$$
$$\vec a = \ddot r\,\hat r - r\dot\phi^2\,\hat r
 + r\ddot\phi\,\hat\phi + 2\dot r\dot\phi\,\hat\phi$$"""


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize(("old", "new", "number"), [
    ("", "", 0),
    (r"= \dot\phi\,\hat\phi", r"= -\dot\phi\,\hat\phi", 2),
    (r"m r^2", "m r", 6),
    (r"+ 2\dot r\dot\phi)", r"+ \dot r\dot\phi)", 7),
    (r"- r\dot\phi^2\,\hat r", r"- r\dot\phi^2\,\hat\phi", 8),
])  # fmt: skip
def test_unit_vectors_along_fixed_axes_and_vector_products(
    old: str, new: str, number: int, tmp_path: Path
) -> None:
    found = verdicts(tmp_path, AREA.replace(old, new))
    assert [k for k, one in enumerate(found) if one == "wrong"] == [number] * bool(old)
    assert old or {*found} == {"definition", "verified"}


def test_components_of_vectors_that_are_not_known_are_not_compared(tmp_path: Path) -> None:
    text = r"""$$\vec r = \vec r\,' - \vec r_0$$ $$\vec v = \dot{\vec r}$$
$$\vec\omega = \omega\hat z$$ in the directions $\hat x$, $\hat y$:
$$\dot v_x = -2(\omega_y v_z - \omega_z v_y)$$"""
    assert verdicts(tmp_path, text)[2:] == ["context"] * 2


SUM = r"""
$$\frac{d}{dt}\left(L - \sum_i\frac{\partial L}{\partial\dot q_i}\dot q_i\right)
 = \frac{\partial L}{\partial t}$$
$$T = \frac12 m l^2(\dot{A}^2 + \dot{B}^2), \qquad V = - m g l\cos A$$
$$\ddot{A} = - \frac gl\sin A$$
"""


def test_a_sum_over_coordinates_without_numbers_is_not_judged(tmp_path: Path) -> None:
    named = SUM.replace("A", r"\theta").replace("B", r"\phi")
    assert verdicts(tmp_path, named) == ["context", "definition", "definition", "verified"]
    # a sum of forces is one force more
    force = named + r"$$- m g l\sin\theta = \sum_i F_i = m l^2\ddot\theta$$"
    assert verdicts(tmp_path, force)[-1] == "verified"
    numbered = SUM.replace("A", r"\theta_1").replace("B", r"\theta_2")
    assert verdicts(tmp_path, numbered.replace("q_i", r"\theta_i"))[0] == "verified"


ARM = r"""$$ r_1^0 = \begin{bmatrix} a\cos q_1 + b\cos(q_1 + q_2) \\ a\sin q_1 + b\sin(q_1 + q_2)
\\ 0 \end{bmatrix} $$
$$ \dot r_1^0 = \begin{bmatrix} -a\sin(q_1)\dot q_1 - b\sin(q_1 + q_2)(\dot q_1 + \dot q_2) \\
a\cos(q_1)\dot q_1 + b\cos(q_1 + q_2)(\dot q_1 + \dot q_2) \\ 0 \end{bmatrix} $$
$$ \|\dot r_1^0\|^2 = a^2\dot q_1^2 + b^2(\dot q_1 + \dot q_2)^2
+ 2 a b\cos(q_2)\dot q_1(\dot q_1 + \dot q_2) $$"""


def test_columns_have_their_norms_and_their_rates_in_the_fixed_frame(tmp_path: Path) -> None:
    """The angle q_1 drops out of the square of the velocity."""
    assert verdicts(tmp_path, ARM) == ["definition", "verified", "verified"]
    (tmp_path / "a.md").write_text(ARM.replace(r"\cos(q_2)", r"\sin(q_2)"), encoding="utf-8")
    *_, last = judge_document(read_document(tmp_path / "a.md")).formulas
    assert last.verdict == "wrong"
    assert last.note.endswith("it contradicts the definition of r_1")
    assert last.wrong_term == r"2 a b\sin(q_2)\dot q_1"
    assert r"+ 2 a b \cos\left(q_2\right) \dot q_1" in last.correction
    # nothing else confirms the column
    alone = ARM.partition(r"$$ \dot r")
    text = alone[0] + ARM[ARM.index(r"$$ \|") :].replace(r"\cos(q_2)", r"\sin(q_2)")
    assert verdicts(tmp_path, text) == ["context", "context"]


ENTRIES = r"""$$ D_{11} = I + 2 c\cos q_2 $$ $$ D_{12} = J + c\cos q_2 $$
$$ \frac{\partial D_{11}}{\partial q_1} = 0 $$
$$ \frac{\partial D_{11}}{\partial q_2} = -2 c\sin q_2 $$
$$ \dot q_2 \frac{\partial D_{11}}{\partial q_2} = -2 c\sin(q_2) \dot q_2 $$
$$ \dot q_1 \frac{\partial D_{12}}{\partial q_2} = -c\sin(q_2) \dot q_1 $$"""


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(("old", "new", "expected"), [
    ("", "", ["definition"] * 2 + ["verified"] * 4),
    # a definition that other formulas confirm
    ("-2 c\\sin q_2", "2 c\\sin q_2",
     ["definition"] * 2 + ["verified", "wrong"] + ["verified"] * 2),
    # one that nothing confirms
    ("-c", "c", ["definition", "context"] + ["verified"] * 3 + ["context"]),
    # two that contradict it alike
    ("-2 c", "2 c", ["definition"] * 2 + ["verified"] + ["context"] * 2 + ["verified"]),
])  # fmt: skip
def test_partial_derivatives_are_those_of_definitions(
    old: str, new: str, expected: list[str], tmp_path: Path
) -> None:
    assert verdicts(tmp_path, ENTRIES.replace(old, new) if old else ENTRIES) == expected


def test_a_partial_derivative_by_the_time_is_that_of_a_letter_that_depends_on_it(
    tmp_path: Path,
) -> None:
    text = r"""$$ H = \frac{p^2}{2 m} + \frac12 m\omega(t)^2 q^2 $$
$$ \frac{dH}{dt} = \frac{\partial H}{\partial t}
= \frac{\partial}{\partial t}\left(\frac12 m\omega(t)^2 q^2\right) = m\omega\dot\omega q^2 $$"""
    assert verdicts(tmp_path, text) == ["context", "verified"]


@pytest.mark.parametrize(("chain", "expected"), [
    (r"v_a = \frac12 r^2\dot\phi = \frac12\frac lm = \frac lm", "wrong"),
    (r"v_a = \frac12 r^2\dot\phi = \frac12\frac lm = \frac{l}{2 m}", "context"),
    (r"v_a = \frac lm = -\frac lm", "wrong"),
    (r"a_1 = -a_1 = 0", "context"),  # a_1 vanishes
    (r"\frac12\frac lm = \frac lm", "context"),
    # by another frequency of the document
    (r"T = \frac{2\pi}{\omega} = \pi\sqrt{\frac mk}", "context"),
    (r"n = 2 = 3", "context"),
])  # fmt: skip
def test_a_chain_with_a_side_and_its_multiple_is_wrong(
    chain: str, expected: str, tmp_path: Path
) -> None:
    text = (
        rf"$${chain}$$ with $\omega = \sqrt{{\frac km}}$ or $\omega = \sqrt{{\frac{{4 k}}{{m}}}}$"
    )
    assert verdicts(tmp_path, text)[0] == expected


@pytest.mark.parametrize(("motion", "verdict"), [
    (r"z(t) = z_0\cos(n t) + \frac{v_0}{n}\sin(n t)", "wrong"),
    (r"z(t) = z_0\cos(n t) + v_0\sin(n t)", "context"),  # its rate at 0 is n v_0
    (r"z(t) = z_0\cos(n t)", "context"),
    (r"z(t) = z_0\cos(n t) + \frac{v_0}{n}\sin(n t)$$ $$z(t) = \sin(n t)", "context"),
])  # fmt: skip
def test_a_rate_is_wrong_beside_a_motion_with_initial_values(
    motion: str, verdict: str, tmp_path: Path
) -> None:
    text = rf"$$\ddot y + q\dot x^2 = 0$$ $${motion}$$ $$\dot z(t) = -z_0\sin(n t) + v_0\cos(n t)$$"
    (tmp_path / "a.md").write_text(text, encoding="utf-8")
    formula = judge_document(read_document(tmp_path / "a.md")).formulas[-1]
    assert formula.verdict == verdict
    assert formula.wrong_term == r"-z_0\sin(n t)" * (verdict == "wrong")
