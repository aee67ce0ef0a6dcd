"""Verdicts on documents whose system is stated: energies by parts, and what follows from them."""

from pathlib import Path

import pytest
from derivations import DERIVATIONS

from derive.reading.document_formats import read_document
from derive.system.files.system_catalogue import load
from derive.verification.documents.judgement import judge_document
from derive.verification.documents.letters.hints import Hints, hints
from derive.verification.documents.pages.verdicts_in_place import FormulaVerdict


def judged(folder: Path, text: str, system: str, **names: str) -> tuple[FormulaVerdict, ...]:
    (folder / "a.md").write_text(text, encoding="utf-8")
    return judge_document(read_document(folder / "a.md"), Hints(load(system), names)).formulas


PARTS = r"""
$$T_1 = \frac12 m_1 l_1^2\dot\theta_1^2$$
$$T_2 = \frac12 m_2\left(l_1^2\dot\theta_1^2 + l_2^2\dot\theta_2^2
        + 2 l_1 l_2\dot\theta_1\dot\theta_2\cos(\theta_1-\theta_2)\right)$$
$$V_1 = -m_1 g l_1\cos\theta_1$$
$$V_2 = -m_2 g (l_1\cos\theta_1 + l_2\cos\theta_2)
      = -m_2 g l_1\cos\theta_1 - m_2 g l_2\cos\theta_2$$
$$T = T_1 + T_2, \quad V = V_1 + V_2$$
"""


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize(
    ("old", "new", "name"),
    [
        (r"T_1 = \frac12 m_1", r"T_1 = m_1", "T_1"),
        (r"2 l_1 l_2", r"l_1 l_2", "T_2"),
        (r"-m_1 g l_1", r"-m_1 g l_2", "V_1"),
        (r"l_1\cos\theta_1 + l_2\cos", r"l_1\cos\theta_1 + 2 l_2\cos", "V_2"),
    ],
)
def test_the_partial_energy_that_is_wrong_is_found_and_its_sum_is_right(
    old: str, new: str, name: str, tmp_path: Path
) -> None:
    formulas = judged(tmp_path, PARTS.replace(old, new), "double_pendulum")
    (wrong,) = (one for one in formulas if one.verdict == "wrong")
    assert wrong.latex.startswith(f"{name} = ")
    text = PARTS.replace(old, new).replace(wrong.latex, wrong.correction)
    assert {one.verdict for one in judged(tmp_path, text, "double_pendulum")} == {
        "definition",
        "verified",
    }


def test_of_two_sides_that_differ_the_one_that_is_a_part_of_the_energy_is_right(
    tmp_path: Path,
) -> None:
    text = PARTS.replace("V = V_1 + V_2", "x = 1")
    text += r"$$V = -(m_1 + m_2) g l_1\cos\theta_1 - m_2 g l_2\cos\theta_2$$"
    text = text.replace(r"l_1\cos\theta_1 + l_2\cos", r"l_1\cos\theta_1 + 2 l_2\cos")
    (wrong,) = (o for o in judged(tmp_path, text, "double_pendulum") if o.verdict == "wrong")
    assert wrong.wrong_term == r"2 l_2\cos\theta_2"


def test_of_two_wrong_partial_energies_none_is_guessed(tmp_path: Path) -> None:
    text = PARTS.replace(r"T_1 = \frac12", r"T_1 = ").replace("2 l_1 l_2", "l_1 l_2")
    formulas = judged(tmp_path, text, "double_pendulum")
    assert "wrong" not in {one.verdict for one in formulas}
    (total,) = (one for one in formulas if one.latex == "T = T_1 + T_2")
    assert (total.verdict, total.note[:19]) == ("context", "it contradicts line")


def test_the_energy_of_all_bodies_is_no_energy_of_one(tmp_path: Path) -> None:
    text = PARTS + r"$$T_{12} = T_1 + T_2$$"
    assert "wrong" not in {one.verdict for one in judged(tmp_path, text, "double_pendulum")}


PENDULUM = r"""
$$T = \frac12 m l^2\dot\theta^2, \quad V = -m g l\cos\theta$$
$$\ddot\theta = -\frac gl\sin\theta$$ $$\frac{\partial V}{\partial\theta} = m g l\sin\theta$$
"""
CART = r"""
$$T = \frac12(M+m)\dot x^2 + \frac12 m l^2\dot\theta^2 + m l\dot x\dot\theta\cos\theta$$
$$(M+m)\ddot x + m l\ddot\theta\cos\theta - m l\dot\theta^2\sin\theta = F$$
"""


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(
    ("system", "right", "wrong", "following"),
    [
        (
            "single_pendulum",
            PENDULUM,
            r"L = \frac12 m l^2\dot\theta^2 - m g l\cos\theta",
            r"m l^2\ddot\theta - m g l\sin\theta = 0",
        ),
        ("single_pendulum", PENDULUM, r"T = m l^2\dot\theta^2", r"p_\theta = 2 m l^2\dot\theta"),
        (
            "single_pendulum",
            PENDULUM,
            r"T = m l^2\dot\theta^2",
            r"E = m l^2\dot\theta^2 - m g l\cos\theta",
        ),
        (
            "cart_1",
            CART,
            r"T = \frac12(M+m)\dot x^2 + \frac12 m l^2\dot\theta^2 + 2ml\dot x\dot\theta\cos\theta",
            r"(M+m)\ddot x + 2 m l\ddot\theta\cos\theta - 2 m l\dot\theta^2\sin\theta = F",
        ),
    ],
)
def test_what_follows_from_a_wrong_energy_names_its_line(
    system: str, right: str, wrong: str, following: str, tmp_path: Path
) -> None:
    line = right.count("\n") + 1
    text = f"{right}$${wrong}$$\n$${following}$$\n"
    *_, source, last = judged(tmp_path, text, system)
    assert (source.line, source.verdict, source.note) == (line, "wrong", "")
    assert (last.verdict, last.note) == ("wrong", f"it follows from line {line}")
    *_, other = judged(tmp_path, text.replace(following, f"{following} + 1"), system)
    assert (other.verdict, other.note) == ("wrong", "")


def test_formulas_follow_from_the_last_side_of_a_wrong_energy(tmp_path: Path) -> None:
    wrong = r"$$T = \frac12 m l^2\dot\theta^2 = m l^2\dot\theta^2$$"
    following = r"$$p_\theta = 2 m l^2\dot\theta$$"
    *_, last = judged(tmp_path, f"{PENDULUM}{wrong}\n{following}\n", "single_pendulum")
    assert (last.verdict, last.note) == ("wrong", "it follows from line 4")


ROBOT = DERIVATIONS["robot"]
CORIOLIS = ROBOT[ROBOT.index("$$C") : ROBOT.index("$$G")]


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize(
    ("old", "new"),
    [
        (r"s_2 \dot q_1 & 0", r"c_2 \dot q_1 & 0"),
        (r"(\dot q_1 + \dot q_2)", r"(\dot q_1 - \dot q_2)"),
        (r"\\ m_2 g l_2 s_{12}", r"\\ m_2 g l_1 s_{12}"),
    ],
)
def test_the_wrong_entry_of_a_matrix_is_corrected(old: str, new: str, tmp_path: Path) -> None:
    text = ROBOT.replace(old, new)
    (wrong,) = (o for o in judged(tmp_path, text, "double_pendulum") if o.verdict == "wrong")
    text = text.replace(wrong.latex, wrong.correction)
    assert {one.verdict for one in judged(tmp_path, text, "double_pendulum")} == {"verified"}


@pytest.mark.parametrize(
    ("old", "new", "verdict"),
    [
        # another matrix with the same C q̇
        (
            CORIOLIS,
            r"$$C = \begin{bmatrix} -2 m_2 l_1 l_2 s_2 \dot q_2 & -m_2 l_1 l_2 s_2 \dot q_2 \\"
            r" m_2 l_1 l_2 s_2\dot q_1 & 0 \end{bmatrix}$$",
            "verified",
        ),
        # a matrix without velocities is not that of the forces of inertia
        (CORIOLIS, r"$$C = \begin{bmatrix} c_1 & 0 \\ 0 & c_2 \end{bmatrix}$$", "definition"),
    ],
)
def test_matrices_of_manipulators_are_not_unique(
    old: str, new: str, verdict: str, tmp_path: Path
) -> None:
    formulas = judged(tmp_path, ROBOT.replace(old, new), "double_pendulum")
    assert {one.verdict for one in formulas} - {"verified"} == {verdict} - {"verified"}


def test_the_gravity_of_a_manipulator_can_stand_on_either_side(tmp_path: Path) -> None:
    start = ROBOT.index("$$G")
    column = ROBOT[start : ROBOT.index("$$", start + 2)]
    negative = column.replace("(m_1", "-(m_1").replace("+ m_2 g l_2", "- m_2 g l_2")
    negative = negative.replace(r"\\ m_2", r"\\ -m_2")
    formulas = judged(tmp_path, ROBOT.replace(column, negative), "double_pendulum")
    assert {one.verdict for one in formulas} == {"verified"}


MATRICES = r"""
$$M = \begin{pmatrix} m_c + m & m l\cos\theta \\ m l\cos\theta & m l^2 \end{pmatrix}, \quad
  C = \begin{pmatrix} 0 & -m l\dot\theta\sin\theta \\ 0 & 0 \end{pmatrix}$$
$$(m_c+m)\ddot x + m l\ddot\theta\cos\theta - m l\dot\theta^2\sin\theta = F$$
"""


def test_the_rows_of_matrices_have_the_order_with_which_they_hold(tmp_path: Path) -> None:
    formulas = judged(tmp_path, MATRICES, "cart_1")
    assert [one.verdict for one in formulas] == ["verified"] * 3
    (wrong, *_) = judged(tmp_path, MATRICES.replace("& m l^2", "& m l"), "cart_1")
    assert (wrong.verdict, wrong.wrong_term) == ("wrong", "m l")


@pytest.mark.parametrize("term", ["l", r"\dot\theta^2", "m g l"])
def test_a_wrong_term_that_is_also_a_factor_is_corrected_as_a_term(
    term: str, tmp_path: Path
) -> None:
    text = rf"{PENDULUM}$$L = \frac12 m l^2\dot\theta^2 + {term}$$"
    *_, wrong = judged(tmp_path, text, "single_pendulum")
    assert (wrong.verdict, wrong.wrong_term) == ("wrong", term)
    formulas = judged(tmp_path, text.replace(wrong.latex, wrong.correction), "single_pendulum")
    assert formulas[-1].verdict == "verified"


@pytest.mark.long("other tests reach its code")
def test_a_stated_letter_is_no_other_parameter(tmp_path: Path) -> None:
    text = r"$$\ddot\theta = -\frac gl\sin\theta$$ $$b\ddot\theta = -b\sin\theta$$"
    assert judged(tmp_path, text, "single_pendulum", l="l")[0].verdict == "verified"
    assert judged(tmp_path, text, "single_pendulum", b="l")[0].verdict == "context"


OWN = """
title = "Own"
potential = "0"
[coordinates]
x = { unit = "m" }
[parameters]
m = { value = 1, unit = "kg" }
[[masses]]
mass = "m"
position = ["x", "0"]
"""


def test_the_system_of_a_file_of_names_is_found_beside_it(tmp_path: Path) -> None:
    folder = tmp_path / "names"
    folder.mkdir()
    (folder / "own.toml").write_text(OWN)
    (folder / "names.toml").write_text('system = "own.toml"\n[names]\ns = "x"\n')
    found = hints(None, folder / "names.toml")
    assert found is not None
    assert found.system.title == "Own"


ENERGIES = r"""
$$T = \frac12(m_1+m_2) l_1^2\dot\theta_1^2 + \frac12 m_2 l_2^2\dot\theta_2^2
  + m_2 l_1 l_2\dot\theta_1\dot\theta_2\cos(\theta_1-\theta_2)$$
$$V = -(m_1+m_2) g l_1\cos\theta_1 - m_2 g l_2\cos\theta_2$$
"""
OTHER = ENERGIES.replace("theta", "phi")


@pytest.mark.parametrize(
    ("text", "verdict"),
    [(OTHER, "verified"), (r"$$\dot\phi_1 = 2\dot\phi_2$$", "context")],
)
def test_other_letters_of_coordinates_have_a_meaning_if_formulas_hold_with_them(
    text: str, verdict: str, tmp_path: Path
) -> None:
    *_, last = judged(tmp_path, ENERGIES + text, "double_pendulum")
    assert last.verdict == verdict


def test_names_of_rates_follow_from_that_of_their_coordinate(tmp_path: Path) -> None:
    text = r"""
$$x = l\sin\theta, \quad y = -l\cos\theta, \quad \ddot\theta = -\frac gl\sin\theta$$
$$\dot x = l\dot\theta\cos t1, \quad \dot y = l\dot\theta\sin t1$$
$$\ddot x = -l\,td1^2\sin t1 + l\,tdd1\cos t1$$
"""
    assert judged(tmp_path, text, "single_pendulum")[-1].verdict == "verified"


def test_a_letter_can_be_the_sum_of_relative_angles(tmp_path: Path) -> None:
    text = ROBOT.replace("(l_1 c_1 + l_2 c_{12})", r"(l_1 c_1 + l_2\cos\psi)")
    formulas = judged(tmp_path, text, "double_pendulum")
    assert {one.verdict for one in formulas} == {"verified"}


@pytest.mark.parametrize(
    ("formula", "verdict"),
    [
        (r"\ddot\theta + g\sin\theta = 0", "equivalent"),
        (r"m\ddot\theta + m g\sin\theta = 0", "equivalent"),
        (r"\ddot\theta + g\cos\theta = 0", "wrong"),
        (r"\ddot\theta + 2 g\sin\theta = 0", "wrong"),
    ],
)
def test_formulas_hold_for_values_that_the_document_states(
    formula: str, verdict: str, tmp_path: Path
) -> None:
    text = rf"{PENDULUM}$$m = l = 1$$ $${formula}$$"
    last = judged(tmp_path, text, "single_pendulum")[-1]
    assert last.verdict == verdict
    other = judged(tmp_path, text.replace("m = l = 1", "x = 1"), "single_pendulum")[-1]
    assert other.verdict == "wrong"


def test_definitions_can_stand_after_their_use_and_have_norms(tmp_path: Path) -> None:
    text = r"""
$$T = \frac12 m v^2, \quad v^2 = w^2, \quad w = l\dot\theta, \quad T = m v^2$$
$$\vec r = \begin{pmatrix} l\sin\theta\\ -l\cos\theta\end{pmatrix}$$
$$T = \frac12 m |\dot{\vec r}|^2, \quad T = m |\dot{\vec r}|^2$$
$$\ddot\theta = -\frac gl\sin\theta$$
"""
    formulas = judged(tmp_path, text, "single_pendulum")
    verdicts = [one.verdict for one in formulas if one.latex.startswith("T")]
    assert verdicts == ["verified", "wrong", "verified", "wrong"]


def test_derivatives_of_the_hamiltonian_have_their_signs(tmp_path: Path) -> None:
    text = r"""
$$H = \frac{p_\theta^2}{2 m l^2} - m g l\cos\theta$$
$$\frac{\partial H}{\partial\theta} = m g l\sin\theta, \quad
  \frac{\partial H}{\partial\theta} = -m g l\sin\theta$$
$$\frac{\partial H}{\partial p_\theta} = \frac{p_\theta}{m l^2}, \quad
  \frac{\partial H}{\partial p_\theta} = -\frac{p_\theta}{m l^2}$$
$$\dot p_\theta = -m g l\sin\theta, \quad \dot p_\theta = m g l\sin\theta$$
"""
    _, *others = judged(tmp_path, text, "single_pendulum")
    assert [one.verdict for one in others] == ["verified", "wrong"] * 3


def test_generalized_forces_are_those_on_their_coordinates(tmp_path: Path) -> None:
    rate = r"\frac{d}{dt}\frac{\partial T}{\partial\dot x}"
    text = rf"{CART}$${rate} - Q_x = 0, \quad {rate} + Q_x = 0$$"
    *_, right, wrong = judged(tmp_path, text, "cart_1")
    assert [right.verdict, wrong.verdict] == ["verified", "wrong"]


def test_all_sides_can_differ_by_a_constant(tmp_path: Path) -> None:
    text = rf"{PENDULUM}$$V = m g l(1 - \cos\theta) = m g l - m g l\cos\theta$$"
    assert judged(tmp_path, text, "single_pendulum")[-1].verdict == "equivalent"


@pytest.mark.long("other tests reach its code")
def test_another_system_is_sought_for_formulas_that_are_left(tmp_path: Path) -> None:
    text = PENDULUM + r"$$m\ddot s + k s = 0, \quad E = \frac12 m\dot s^2 + \frac12 k s^2$$"
    (tmp_path / "a.md").write_text(text, encoding="utf-8")
    document = judge_document(read_document(tmp_path / "a.md"))
    assert {one.verdict for one in document.formulas} == {"verified"}
    assert {one.partition(":")[0] for one in document.system.split("; ")} == {
        "Single pendulum",
        "Mass on a spring",
    }


def test_two_wrong_terms_are_corrected_together(tmp_path: Path) -> None:
    text = rf"{PENDULUM}$$L = 3 m l^2\dot\theta^2 + 5 m g l\cos\theta$$"
    wrong = judged(tmp_path, text, "single_pendulum")[-1]
    assert wrong.wrong_term == r"3 m l^2\dot\theta^2; 5 m g l\cos\theta"
    assert [text[slice(*one)] for one in wrong.wrong_spans] == wrong.wrong_term.split("; ")
    formulas = judged(tmp_path, text.replace(wrong.latex, wrong.correction), "single_pendulum")
    assert formulas[-1].verdict == "verified"


@pytest.mark.parametrize("letter", ["d", r"\kappa"])
def test_an_abbreviation_in_an_energy_may_be_any_letter(letter: str, tmp_path: Path) -> None:
    """Also one that is no differential: equations with its value and with its letter hold."""
    text = rf"""
$$T = \frac12 J\dot\alpha^2, \quad {letter} = k a^2$$
$$V = \frac12 {letter} \alpha^2 + \beta\alpha^4$$
$$J\ddot\alpha = -k a^2\alpha - 4\beta\alpha^3$$
$$J\ddot\alpha + {letter}\alpha + 4\beta\alpha^3 = 0$$
$$J\ddot\alpha + {letter}\alpha + 2\beta\alpha^3 = 0$$
"""
    (tmp_path / "a.md").write_text(text, encoding="utf-8")
    verdicts = [one.verdict for one in judge_document(read_document(tmp_path / "a.md")).formulas]
    assert verdicts == [*["definition"] * 3, "verified", "verified", "wrong"]
