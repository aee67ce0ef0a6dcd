"""Documents with which several meanings of the letters agree."""

import json
from pathlib import Path

import pytest

from derive.verification.documents.letters.hints import hints
from derive.verification.documents.pages.verdicts_in_place import DocumentVerdicts
from derive.verification.documents.rules.consequences import opposed
from derive.verification.source_files import judge_file
from solvers.app.cli import main
from solvers.runge_kutta.order_conditions import order

FIRST = r"""$$(m_1+m_2) l_1 \ddot\theta_1 + m_2 l_2 \ddot\theta_2 \cos(\theta_1-\theta_2)
 + m_2 l_2 \dot\theta_2^2\sin(\theta_1-\theta_2) + (m_1+m_2) g \sin\theta_1 = 0$$"""
SECOND = r"""$$l_2 \ddot\theta_2 + l_1 \ddot\theta_1 \cos(\theta_1-\theta_2)
 - l_1 \dot\theta_1^2\sin(\theta_1-\theta_2) + g \sin\theta_2 = 0$$"""
WRONG_FIRST = FIRST.replace("+ (m_1+m_2) g", "- (m_1+m_2) g")
WRONG_SECOND = SECOND.replace("+ g", "- g")
PENDULUM = r"$$\ddot\theta = -\frac gl\sin\theta$$"


def judged(folder: Path, text: str) -> DocumentVerdicts:
    path = folder / "document.md"
    path.write_text(text)
    return judge_file(str(path), order)[0]


def verdicts(document: DocumentVerdicts) -> list[str]:
    return [one.verdict for one in document.formulas]


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize("text", [
    f"{FIRST}\n\n{SECOND}",
    PENDULUM,
    r"$$x = l\sin\theta, y = l\cos\theta, V = m g y$$ $$\ddot\theta = \frac gl\sin\theta$$",
    r"$$V = -m g l\cos\theta$$ $$\ddot\theta = -\frac gl\sin\theta + \theta$$",
])  # fmt: skip
def test_a_document_with_one_meaning_has_no_remarks(text: str, tmp_path: Path) -> None:
    assert judged(tmp_path, text).remarks == ()


@pytest.mark.long("other tests reach its code")
def test_equations_that_are_both_wrong_hold_with_another_convention(tmp_path: Path) -> None:
    document = judged(tmp_path, f"{WRONG_FIRST}\n\n{WRONG_SECOND}")
    assert verdicts(document) == ["verified", "verified"]
    assert document.convention == (
        "theta_1 = pi - theta1, theta_2 = pi - theta2 (angles from upright)"
    )
    (usual,) = document.alternatives
    assert usual.convention == "theta_1 = theta1, theta_2 = theta2 (angles from hanging)"
    assert [(one.line, one.verdict, one.instead_of) for one in usual.differences] == [
        (1, "wrong", "verified"), (4, "wrong", "verified"),
    ]  # fmt: skip
    assert r"+ g \sin" in usual.differences[1].correction


@pytest.mark.long("other tests reach its code")
def test_of_two_equations_that_contradict_each_other_either_can_be_wrong(tmp_path: Path) -> None:
    document = judged(tmp_path, f"{FIRST}\n\n{WRONG_SECOND}")
    assert verdicts(document) == ["verified", "context"]
    assert "holds with others" in document.formulas[1].note
    assert document.convention == ""
    (other,) = document.alternatives
    assert [(one.line, one.verdict) for one in other.differences] == [(1, "wrong"), (4, "verified")]


CART = r"$$(M+m)\ddot x + m l\ddot\theta\cos\theta - m l\dot\theta^2\sin\theta = F$$"


def test_a_formula_that_each_meaning_refutes_is_wrong_if_terms_differ(tmp_path: Path) -> None:
    text = r"$$l\ddot\theta - \ddot x\cos\theta - g\sin\theta = 0$$"
    document = judged(tmp_path, f"{CART}\n{text}")
    assert verdicts(document) == ["verified", "wrong"]
    (other,) = document.alternatives
    (changed,) = other.differences
    assert changed.text == "line 2 (display 2) has another correction"
    assert changed.correction not in ("", document.formulas[1].correction)


@pytest.mark.long("other tests reach its code")
def test_a_term_that_each_meaning_refutes_is_wrong_with_two_corrections(tmp_path: Path) -> None:
    document = judged(tmp_path, f"{CART}\n$$V = m g\\cos\\theta$$")
    assert verdicts(document) == ["verified", "wrong"]
    assert document.formulas[1].wrong_term == r"m g\cos\theta"
    (other,) = document.alternatives
    (changed,) = other.differences
    assert changed.text == "line 2 (display 2) has another correction"
    assert changed.correction not in ("", document.formulas[1].correction)


@pytest.mark.long("other tests reach its code")
def test_the_names_of_an_alternative_settle_it(tmp_path: Path) -> None:
    document = judged(tmp_path, f"{WRONG_FIRST}\n\n{WRONG_SECOND}")
    (usual,) = document.alternatives
    path = tmp_path / "names.toml"
    lines = [f'{letter} = "{text}"' for letter, text in usual.names.items()]
    path.write_text("\n".join([f'system = "{usual.name}"', "[names]", *lines]))
    settled = judge_file(document.file, order, hints(None, path))[0]
    assert verdicts(settled) == ["wrong", "wrong"]
    assert settled.alternatives == ()


def test_names_hold_for_an_elongation(tmp_path: Path) -> None:
    path, names = tmp_path / "document.md", tmp_path / "names.toml"
    path.write_text(r"$$m\ddot x = m(\ell+x)\dot\theta^2 - k x + m g\cos\theta$$")
    names.write_text('system = "elastic_pendulum"\n[names]\nx = "r - l"')
    assert verdicts(judge_file(str(path), order, hints(None, names))[0]) == ["verified"]


def test_systems_that_do_not_ship_have_names(tmp_path: Path) -> None:
    path = tmp_path / "document.md"
    path.write_text(r"$$m\ddot x + k x = 0$$")
    document = judge_file(str(path), order, hints("oscillator", None))[0]
    assert (document.system, verdicts(document)) == ("Mass on a spring", ["verified"])


@pytest.mark.long("other tests reach its code")
def test_alternatives_stand_in_text_json_and_pages(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "document.md"
    path.write_text(PENDULUM.replace("-", ""))
    for name in ("page.html", "page.tex"):
        page = tmp_path / name
        assert main(["verify", str(path), "--annotate", str(page)]) == 0
        output = " ".join(capsys.readouterr().out.split())
        assert "Letters: theta = pi - theta (angles from upright)" in output
        assert "Ambiguous: with theta = theta (angles from hanging): line 1" in output
        assert "Ambiguous: with theta = theta" in page.read_text()
    assert main(["verify", str(path), "--json"]) == 0
    (document,) = json.loads(capsys.readouterr().out)["documents"]
    assert document["convention"] == "theta = pi - theta (angles from upright)"
    (other,) = document["alternatives"]
    assert (other["name"], other["names"]["theta"]) == ("single_pendulum", "theta")
    assert other["differences"][0]["verdict"] == "wrong"


@pytest.mark.long("other tests reach its code")
def test_readings_of_programs_that_contradict_each_other_accuse_none(tmp_path: Path) -> None:
    path = tmp_path / "a.m"
    path.write_text("""function dx = f(t, x, m1, m2, l1, l2, g)
d = x(1) - x(2);
M = [(m1 + m2)*l1, m2*l2*cos(d); l1*cos(d), l2];
f = [-m2*l2*x(4)^2*sin(d) - (m1 + m2)*g*sin(x(1)); l1*x(3)^2*sin(d) + g*sin(x(2))];
dx = [x(3:4); M \\ f];
end
""")
    document = judge_file(str(path), order)[0]
    assert verdicts(document) == ["verified", "context"]
    assert document.alternatives


@pytest.mark.long("other tests reach its code")
def test_angles_from_the_horizontal_oppose_no_usual_ones(tmp_path: Path) -> None:
    text = r"""$$\ddot\theta_1 = \frac{-g(2m_1+m_2)\sin\theta_1 - m_2 g\sin(\theta_1-2\theta_2)
 - 2\sin(\theta_1-\theta_2) m_2(\dot\theta_2^2 l_2 + \dot\theta_1^2 l_1\cos(\theta_1-\theta_2))}
 {l_1(2m_1+m_2-m_2\cos(2\theta_1-2\theta_2))}$$
$$\ddot\theta_2 = \frac{2\sin(\theta_1-\theta_2)(\dot\theta_1^2 l_1(m_1+m_2)
 + g(m_1+m_2)\sin\theta_1 + \dot\theta_2^2 l_2 m_2\cos(\theta_1-\theta_2))}
 {l_2(2m_1+m_2-m_2\cos(2\theta_1-2\theta_2))}$$"""
    document = judged(tmp_path, text)
    assert verdicts(document) == ["verified", "wrong"]
    assert document.formulas[1].wrong_term == r"\sin\theta_1"


SLIP = r"""$$x_p = x - l\sin\theta, \quad y_p = -l\cos\theta$$
$$\dot x_p = \dot x + l\dot\theta\cos\theta, \quad \dot y_p = l\dot\theta\sin\theta$$
$$T = \frac12 (M+m)\dot x^2 + m l\dot x\dot\theta\cos\theta + \frac12 m l^2\dot\theta^2$$
$$V = -m g l\cos\theta$$"""
#: The same of an ellipse, which no known system has.
ELLIPSE = SLIP.replace(r"l\sin\theta,", r"b\sin\theta,").replace(
    r"\dot x + l", r"\dot x + b"
).replace("m l\\dot x", "m b\\dot x").replace(
    r"\frac12 m l^2\dot\theta^2", r"\frac12 m \dot\theta^2 (b^2\cos^2\theta + l^2\sin^2\theta)"
)  # fmt: skip


def test_a_position_that_all_others_contradict_is_wrong_by_a_known_system(tmp_path: Path) -> None:
    document = judged(tmp_path, SLIP)
    assert verdicts(document) == [
        "wrong", "definition", "verified", "verified", "verified", "verified",
    ]  # fmt: skip
    assert document.formulas[0].wrong_term == r"- l\sin\theta"


@pytest.mark.long("other tests reach its code")
def test_a_position_that_a_rate_and_an_energy_contradict_is_wrong(tmp_path: Path) -> None:
    document = judged(tmp_path, ELLIPSE)
    assert verdicts(document) == [
        "wrong", "definition", "verified", "verified", "verified", "verified",
    ]  # fmt: skip
    assert document.formulas[0].wrong_term == r"- b\sin\theta"
    # an energy alone is
    right = ELLIPSE.replace("x - b", "x + b")
    assert {*verdicts(judged(tmp_path, right))} == {"definition", "verified"}
    wrong = judged(tmp_path, right.replace("+ m b", "- m b"))
    assert verdicts(wrong)[2:] == ["verified", "verified", "wrong", "verified"]


@pytest.mark.long("other tests reach its code")
def test_a_rate_in_another_form_than_its_position_is_one(tmp_path: Path) -> None:
    text = r"""$$x = a\sin\alpha - b\sin(\alpha+\beta)$$
$$y = -a\cos\alpha - b\cos(\alpha+\beta)$$
$$\dot x = a\dot\alpha\cos\alpha + b\dot\alpha\cos(\alpha+\beta)
 + b\dot\beta(\cos\alpha\cos\beta - \sin\alpha\sin\beta)$$
$$T = \frac12 m (a^2\dot\alpha^2 + b^2(\dot\alpha+\dot\beta)^2
 + 2 a b\dot\alpha(\dot\alpha+\dot\beta)\cos\beta)$$"""
    assert verdicts(judged(tmp_path, text)) == ["wrong", "definition", "verified", "verified"]
    # the rate of no position
    wrong = judged(tmp_path, text.replace(r"b\dot\beta(", r"2 b\dot\beta("))
    assert verdicts(wrong)[2] == "wrong"


PAIR = r"""
$$L = \frac12 m\dot x^2 (1 + a x) - k x^5$$
$$m\ddot x (1 + a x) + \frac12 m a\dot x^2 = - 5 k x^4$$
"""


@pytest.mark.long("other tests reach its code")
def test_two_formulas_that_contradict_each_other_name_each_other(tmp_path: Path) -> None:
    assert verdicts(judged(tmp_path, PAIR)) == ["definition", "verified"]
    slip = judged(tmp_path, PAIR.replace("- 5 k", "- 4 k")).formulas
    assert [(one.verdict, one.note) for one in slip] == [
        ("context", opposed(3)),
        ("context", opposed(2)),
    ]


@pytest.mark.long("other tests reach its code")
def test_a_formula_that_several_contradict_is_not_said_to_contradict_one(tmp_path: Path) -> None:
    slip = PAIR.replace("- 5 k", "- 4 k") + r"$$m\ddot x = - k x^4 - \frac12 m a\dot x^2$$"
    assert {one.note for one in judged(tmp_path, slip).formulas}.isdisjoint(map(opposed, (2, 3, 4)))
