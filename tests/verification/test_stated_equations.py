"""Documents that state equations of motion alone, with reactions, friction and forces."""

from pathlib import Path

import pytest

from derive.reading.document_formats import read_document
from derive.verification.documents.judgement import _read, judge_document
from derive.verification.documents.letters import stated_equations
from derive.verification.documents.letters.letter_roles import letters_of
from derive.verification.documents.pages.verdicts_in_place import FormulaVerdict
from derive.verification.documents.statements import translated


def judged(folder: Path, text: str) -> tuple[FormulaVerdict, ...]:
    (folder / "a.md").write_text(text, encoding="utf-8")
    return judge_document(read_document(folder / "a.md")).formulas


def verdicts(folder: Path, text: str) -> list[str]:
    return [one.verdict for one in judged(folder, text)]


RODS = r"""With the force $S$ in the rod,
$$M\ddot x = F - S\sin\theta$$
$$m(\ddot x + l\ddot\theta\cos\theta - l\dot\theta^2\sin\theta) = S\sin\theta$$
$$-m l\ddot\theta\sin\theta - m l\dot\theta^2\cos\theta = S\cos\theta - m g$$
The sum is
$$(M + m)\ddot x + m l\ddot\theta\cos\theta - m l\dot\theta^2\sin\theta = F$$
and without the force
$$l\ddot\theta + \ddot x\cos\theta = g\sin\theta .$$
The force follows:
$$S = \frac{F - M\ddot x}{\sin\theta}$$
"""
CAR = r"""
$$m\ddot a = -k (a - b) - d(\dot a - \dot b) + u$$
$$n\ddot b = k (a - b) + d(\dot a - \dot b) - c b - h\dot b - u$$
With $x = (a, b, \dot a, \dot b)^T$
$$\dot x = A x + B u$$
$$A = \begin{bmatrix} 0 & 0 & 1 & 0\\ 0 & 0 & 0 & 1\\ -k/m & k/m & -d/m & d/m\\
 k/n & -(k+c)/n & d/n & -(d+h)/n\end{bmatrix}$$
$$B = \begin{bmatrix}0\\0\\1/m\\-1/n\end{bmatrix}$$
"""
MODES = r"""$$m\ddot x_1 = -k x_1 + c (x_2 - x_1)$$ $$m\ddot x_2 = -k x_2 - c (x_2 - x_1)$$
With $$q_+ = x_1 + x_2$$ $$q_- = x_1 - x_2$$ we have
$$m\ddot q_+ = -k q_+$$ $$m\ddot q_- = -(k + 2c) q_-$$
"""


@pytest.mark.long("other tests reach its code")
def test_forces_of_rods_are_eliminated(tmp_path: Path) -> None:
    assert verdicts(tmp_path, RODS) == ["definition"] * 3 + ["verified"] * 3


@pytest.mark.long("other tests reach its code")
def test_a_state_space_follows_from_equations_with_friction(tmp_path: Path) -> None:
    assert verdicts(tmp_path, CAR) == ["definition"] * 3 + ["verified"] * 3


@pytest.mark.long("other tests reach its code")
def test_other_coordinates_follow(tmp_path: Path) -> None:
    assert verdicts(tmp_path, MODES) == ["definition"] * 4 + ["verified"] * 2


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(("text", "old", "new", "term"), [
    (RODS, r"l\ddot\theta + \ddot x\cos", r"l\ddot\theta - \ddot x\cos", r"\ddot x\cos\theta"),
    (CAR, "& -(d+h)/n", "& -(d-h)/n", ""),
])  # fmt: skip
def test_one_slip_is_found(text: str, old: str, new: str, term: str, tmp_path: Path) -> None:
    assert text.count(old) == 1
    formulas = judged(tmp_path, text.replace(old, new))
    (wrong,) = [one for one in formulas if one.verdict == "wrong"]
    assert new.split("&")[-1].split("/")[0].strip() in wrong.latex
    assert term in wrong.wrong_term


def test_two_cases_do_not_accuse_each_other(tmp_path: Path) -> None:
    text = r"""Without friction $$m\ddot x + k x = 0$$ $$\ddot x = -\frac km x$$
$$\ddot x + \omega^2 x = 0, \quad \omega^2 = \frac km$$
and with friction $$m\ddot x + c\dot x + k x = 0$$ $$m\ddot x + c\dot x + k x = F\cos\Omega t$$"""
    assert "wrong" not in verdicts(tmp_path, text)


@pytest.mark.long("other tests reach its code")
def test_a_slip_in_the_first_of_two_equations_is_not_decided(tmp_path: Path) -> None:
    text = r"""$$m\ddot x_1 = -k x_1 + c (x_2 + x_1)$$ $$m\ddot x_2 = -k x_2 - c (x_2 - x_1)$$
$$\ddot x_1 = -\frac km x_1 + \frac cm (x_2 - x_1)$$"""
    assert "wrong" not in verdicts(tmp_path, text)


ATWOOD = r"""$$m_1 a = m_1 g - T$$ $$m_2 a = T - m_2 g$$
$$a = \frac{(m_1 - m_2) g}{m_1 + m_2}, \quad T = \frac{2 m_1 m_2 g}{m_1 + m_2}$$"""
TOP = r"""$$A\dot\omega_1 = (A - C)\omega_2\omega_3$$ $$A\dot\omega_2 = (C - A)\omega_3\omega_1$$
$$C\dot\omega_3 = 0$$ With $$\Omega = \frac{C - A}{A}\omega_3$$ $$\dot\omega_1 = -\Omega\omega_2$$
$$\dot\omega_2 = \Omega\omega_1$$ $$\frac{d}{dt}(\omega_1^2 + \omega_2^2) = 0$$"""


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(("text", "first"), [(ATWOOD, 2), (TOP, 4)])
def test_letters_can_be_accelerations_or_velocities(text: str, first: int, tmp_path: Path) -> None:
    found = verdicts(tmp_path, text)
    assert found == ["definition"] * first + ["verified"] * (len(found) - first)


@pytest.mark.long("other tests reach its code")
def test_a_wrong_sign_in_a_body_frame_is_found(tmp_path: Path) -> None:
    formulas = judged(tmp_path, TOP.replace(r"\dot\omega_1 = -\Omega", r"\dot\omega_1 = \Omega"))
    assert [one.latex for one in formulas if one.verdict == "wrong"] == [
        r"\dot\omega_1 = \Omega\omega_2"
    ]


def test_reactions_can_have_letters_of_their_own(tmp_path: Path) -> None:
    text = r"""$$N - m g\cos\theta = 0$$ $$m g\sin\theta - F_s = m a$$ $$F_s r = \frac12 m r a$$
$$a = \frac23 g\sin\theta, \quad N = m g\cos\theta$$"""
    assert verdicts(tmp_path, text)[-2:] == ["verified"] * 2


def test_the_rate_of_an_energy_gives_no_mass_matrix(tmp_path: Path) -> None:
    text = r"""
$$ m \dot x \ddot x + k x \dot x = 0 $$
$$ \ddot x = -\frac{k}{m} x $$
"""
    (tmp_path / "a.md").write_text(text, encoding="utf-8")
    formulas = judge_document(read_document(tmp_path / "a.md")).formulas
    assert [one.verdict for one in formulas] == ["verified", "verified"]


SEVERAL = r"""
$$x_b = x + \frac{L}{2}\sin\theta$$ $$y_b = \frac{L}{2}\cos\theta$$
$$m_w\ddot x = f_w + R_x + H_w$$ $$R_x = f_b - m_b\ddot x_b$$ $$R_y = m_b\ddot y_b + m_b g$$
$$(m_w + m_b + \frac{I_w}{r^2})\ddot x
  = m_b l\sin\theta\,\dot\theta^2 - m_b l\cos\theta\,\ddot\theta + \frac{\tau}{r} + f_w$$
$$I_b\ddot\theta = R_x l\cos\theta + R_y l\sin\theta - \tau$$
"""


def test_equations_with_large_solutions_are_no_system(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.md").write_text(SEVERAL, encoding="utf-8")
    statements = translated(_read(read_document(tmp_path / "a.md"))[0])
    letters = letters_of(statements.formulas, statements.derivatives)
    stated = stated_equations.StatedEquations(letters, statements.formulas)
    assert not [*stated.candidates()]  # with each of which a comparison takes seconds
    monkeypatch.setattr(stated_equations, "MAX_SOLVED", 10_000)
    assert [*stated.candidates()]
