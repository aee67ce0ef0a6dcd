"""Newton's laws of a document, with reactions that its positions or energies determine."""

from pathlib import Path

import pytest

from derive.verification.documents.pages.verdicts_in_place import FormulaVerdict
from derive.verification.documents.rules.side_verdict import CORRECT
from derive.verification.source_files import judge_file
from solvers.runge_kutta.order_conditions import order

PENDULUMS = r"""
$$x_1 = l_1 \sin\theta_1,\quad y_1 = -l_1\cos\theta_1$$
$$x_2 = x_1 + l_2 \sin\theta_2,\quad y_2 = y_1 - l_2\cos\theta_2$$
$$T = \frac12 m_1(\dot x_1^2 + \dot y_1^2) + \frac12 m_2(\dot x_2^2 + \dot y_2^2)$$
$$V = m_1 g y_1 + m_2 g y_2$$
"""
RATES = r"""
$$\dot x_1 = l_1\dot\theta_1\cos\theta_1, \quad \dot x_2 = \dot x_1 + l_2\dot\theta_2\cos\theta_2$$
"""
LAWS = (
    r"m_1 \ddot x_1 = -T_1 \sin\theta_1 + T_2 \sin\theta_2",
    r"m_1 \ddot y_1 = T_1\cos\theta_1 - T_2\cos\theta_2 - m_1 g",
    r"m_2 \ddot x_2 = -T_2\sin\theta_2",
    r"m_2 \ddot y_2 = T_2\cos\theta_2 - m_2 g",
)
BOB = r"""
$$x = l\sin\theta, \quad y = -l\cos\theta$$
$$T = \frac12 m l^2\dot\theta^2,\qquad V = -m g l\cos\theta$$
"""
BOB_LAWS = (
    r"m l\dot\theta^2 = S - m g\cos\theta",
    r"m\ddot x = -S\sin\theta",
    r"m\ddot y = S\cos\theta - m g",
)
DISC = r"""
A disc rolls down an incline of angle $\alpha$: $\dot x = R\dot\varphi$.
$$T = \frac12 m \dot x^2 + \frac12 J\dot\varphi^2, \quad V = - m g x\sin\alpha, \quad
  J = \frac12 m R^2$$
"""
DISC_LAWS = (r"m\ddot x = m g\sin\alpha - F", r"J\ddot\varphi = F R")
BLOCKS = r"$$T = \frac12 (m_1 + m_2)\dot x^2, \quad V = - m_2 g x$$"


def judged(folder: Path, text: str, *laws: str) -> list[FormulaVerdict]:
    """The verdicts on formulas behind a text."""
    path = folder / "document.md"
    path.write_text(text + "".join(f"\n$${law}$$" for law in laws))
    return [*judge_file(str(path), order)[0].formulas][-len(laws) :]


@pytest.mark.parametrize("text", [PENDULUMS, PENDULUMS + RATES])
def test_laws_hold_together_with_their_reactions(text: str, tmp_path: Path) -> None:
    found = judged(tmp_path, text, *LAWS)
    assert [one.verdict for one in found] == ["verified"] * 4
    assert [one.note for one in found] == [
        *["with T_1, T_2 as reactions"] * 2, *["with T_2 as a reaction"] * 2
    ]  # fmt: skip


@pytest.mark.parametrize(("number", "slip", "term"), [
    (3, ("m_2 g", "m_1 g"), "- m_1 g"),
    (0, ("+ T_2", "- T_2"), r"- T_2 \sin\theta_2"),
    (1, ("- m_1 g", "+ m_1 g"), "m_1 g"),
    (2, (r"\sin", r"\cos"), r"-T_2\cos\theta_2"),
])  # fmt: skip
def test_the_law_with_a_slip_is_wrong_and_no_other(
    number: int, slip: tuple[str, str], term: str, tmp_path: Path
) -> None:
    laws = [law.replace(*slip) if k == number else law for k, law in enumerate(LAWS)]
    found = judged(tmp_path, PENDULUMS + RATES, *laws)
    assert [k for k, one in enumerate(found) if one.verdict == "wrong"] == [number]
    assert found[number].wrong_term == term
    # with the correction, all hold
    right = judged(tmp_path, PENDULUMS + RATES, *laws[:number], found[number].correction,
                   *laws[number + 1 :])  # fmt: skip
    assert [one.verdict for one in right] == ["verified"] * 4


def test_of_laws_that_follow_from_each_other_all_hold_or_that_with_a_slip_is_wrong(
    tmp_path: Path,
) -> None:
    found = judged(tmp_path, BOB, *BOB_LAWS)
    assert [one.verdict for one in found] == ["verified"] * 3
    found = judged(tmp_path, BOB, BOB_LAWS[0].replace("-", "+"), *BOB_LAWS[1:])
    assert [one.verdict for one in found] == ["wrong", "verified", "verified"]
    assert found[0].wrong_term == r"m g\cos\theta"


@pytest.mark.parametrize("law", [
    r"S - m g = m l\dot\theta^2",  # at the lowest point
    r"S + m g = m l\dot\theta^2",  # and at the highest one
    r"S = m g\cos\theta",  # at rest
])  # fmt: skip
def test_a_law_at_a_place_or_at_rest_is_not_wrong(law: str, tmp_path: Path) -> None:
    found = judged(tmp_path, BOB, *BOB_LAWS, law)
    assert "wrong" not in {one.verdict for one in found}


@pytest.mark.parametrize("laws", [
    BOB_LAWS[1:2],
    (BOB_LAWS[1], r"-S\sin\theta = m\ddot x", r"2 m\ddot x = -2 S\sin\theta"),
    (BOB_LAWS[1].replace("-S", "S"), BOB_LAWS[1].replace("-S", "2 S")),
    (*BOB_LAWS[1:2], BOB_LAWS[2].replace("- m g", "- 2 m g")),
])  # fmt: skip
def test_laws_that_determine_their_reaction_alone_are_not_judged(
    laws: tuple[str, ...], tmp_path: Path
) -> None:
    # one law, copies of one, other signs of S, or two of which either can be wrong
    found = judged(tmp_path, BOB, *laws)
    assert not any(one.verdict == "wrong" or "reaction" in one.note for one in found)


def test_friction_of_a_rolling_disc_is_no_applied_force(tmp_path: Path) -> None:
    motion = r"\ddot x = \frac23 g\sin\alpha"
    assert [one.verdict for one in judged(tmp_path, DISC, *DISC_LAWS, motion)] == ["verified"] * 3
    force = r"F = \frac13 m g\sin\alpha"
    found = judged(tmp_path, DISC, *DISC_LAWS, motion, force)
    assert [one.verdict for one in found] == [*["verified"] * 3, "definition"]
    wrong = DISC_LAWS[1].replace("F", "2 F")
    found = judged(tmp_path, DISC, DISC_LAWS[0], wrong, motion, force)
    assert [one.verdict for one in found] == ["verified", "wrong", "verified", "definition"]
    assert found[1].correction == r"J\ddot\varphi = F R"


@pytest.mark.parametrize("tension", ["T_1", "S"])
def test_a_tension_that_a_law_defines_is_that_of_the_next(tension: str, tmp_path: Path) -> None:
    laws = rf"m_1\ddot x = {tension}", rf"m_2\ddot x = m_2 g - {tension}"
    found = judged(tmp_path, BLOCKS, *laws)
    assert [one.verdict for one in found] == ["definition", "verified"]


def test_a_thread_on_a_drum_is_a_constraint(tmp_path: Path) -> None:
    text = r"""
A reel of mass $m$ falls, and its thread unwinds from an axle of radius $b$: $\dot y = b\dot\phi$.
$$E = \frac12 m\dot y^2 + \frac12 I\dot\phi^2 - m g y$$
"""
    laws = r"m\ddot y = m g - S", r"I\ddot\phi = S b", r"\ddot y = \frac{m g b^2}{I + m b^2}"
    assert [one.verdict for one in judged(tmp_path, text, *laws)] == ["verified"] * 3
    wrong = laws[2].replace("m g b^2", "m g b")
    found = judged(tmp_path, text, *laws[:2], wrong)
    assert [one.verdict for one in found] == ["verified", "verified", "wrong"]


def test_momenta_that_cancel_are_no_constraint(tmp_path: Path) -> None:
    text = r"""
$$T = \frac12 m\dot x^2 + \frac12 M\dot z^2, \quad V = \frac12 k (x - z)^2, \quad
  m\dot x = -M\dot z$$
"""
    laws = r"m\ddot x = -k (x - z)", r"M\ddot z = k (x - z)"
    assert [one.verdict for one in judged(tmp_path, text, *laws)] == ["verified"] * 2


ROLLER = r"""
A cylinder of radius $r$ rolls inside another one: $(R - r)\dot\theta = r\dot\phi$.
$$T = \frac12 m (R - r)^2\dot\theta^2 + \frac14 m r^2\dot\phi^2, \quad V = -m g (R - r)\cos\theta$$
"""
REDUCED = (
    r"p_\theta = \frac32 m (R - r)^2\dot\theta",
    r"H = \frac{p_\theta^2}{3 m (R - r)^2} - m g (R - r)\cos\theta",
    r"\dot p_\theta = -m g (R - r)\sin\theta",
    r"\frac{d}{dt}\frac{\partial L}{\partial\dot\theta} = \frac32 m (R - r)^2\ddot\theta",
)


def test_momenta_can_be_those_after_the_constraint_is_substituted(tmp_path: Path) -> None:
    found = judged(tmp_path, ROLLER, *REDUCED)
    assert {(one.verdict, one.note) for one in found} == {
        ("verified", "with the constraints substituted")
    }


@pytest.mark.parametrize(("number", "slip"), [
    (0, (r"\frac32", r"\frac52")), (1, ("{3 m", "{2 m")), (2, ("-m g", "m g")),
    (3, (r"\frac32", r"\frac52")),
])  # fmt: skip
def test_other_momenta_of_a_rolling_body_do_not_hold(
    number: int, slip: tuple[str, str], tmp_path: Path
) -> None:
    laws = [law.replace(*slip) if k == number else law for k, law in enumerate(REDUCED)]
    found = judged(tmp_path, ROLLER, *laws)
    assert [k for k, one in enumerate(found) if one.verdict not in CORRECT] == [number]
