"""Verdicts on documents whose letters and conventions are found by structure."""

import json
from collections import defaultdict
from pathlib import Path
from random import Random

import pytest
from derivations import DERIVATIONS
from document_mutants import Mutant, mutants
from shared_documents import shared

from derive.reading.document_formats import read_document
from derive.verification.documents.letters.hints import hints
from derive.verification.documents.pages.verdict_page import page
from derive.verification.documents.pages.verdicts_in_place import DocumentVerdicts
from derive.verification.source_files import judge_file
from solvers.io.toml_input import InputError
from solvers.runge_kutta.order_conditions import order

CORRECT = ("verified", "equivalent", "definition")
SYSTEMS = {
    "double": "Double pendulum",
    "cart": "The system that the document states",
    "spring": "Elastic pendulum",
    "robot": "Double pendulum",
    "hamilton": "Spherical pendulum",
    "columns": "The system that the document states",
}


def judged(folder: Path, text: str, name: str = "a.md") -> DocumentVerdicts:
    (folder / name).write_text(text, encoding="utf-8")
    return judge_file(str(folder / name), order)[0]


def verdicts(folder: Path, text: str, name: str = "a.md") -> list[str]:
    return [one.verdict for one in judged(folder, text, name).formulas]


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("name", DERIVATIONS)
def test_right_derivations_in_any_letters_are_verified(name: str, tmp_path: Path) -> None:
    document = judged(tmp_path, DERIVATIONS[name])
    assert document.system.startswith(SYSTEMS[name])
    assert {one.verdict for one in document.formulas if one.display} <= {*CORRECT}
    assert sum(one.verdict == "verified" for one in document.formulas) >= 3


def problem(mutant: Mutant, document: DocumentVerdicts) -> str:
    """Why a mistake is not found at its place; "" if it is."""
    near = [one for one in document.formulas if abs(one.span[0] - mutant.formula) < 3]
    if [one.verdict for one in near] != ["wrong"]:
        return f"{[one.verdict for one in near]}"
    one = near[0]
    if not one.wrong_term:
        return "" if mutant.kind == "omission" and one.correction else "no term"
    is_found = any(start - 3 <= mutant.place <= end + 1 for start, end in one.wrong_spans)
    return "" if is_found else f"elsewhere: {one.wrong_term}"


def missed(folder: Path, chosen: list[tuple[str, Mutant]]) -> list[str]:
    found = []
    for name, mutant in chosen:
        if reason := problem(mutant, judged(folder, mutant.text)):
            around = mutant.text[mutant.place - 20 : mutant.place + 20]
            found.append(f"{name}: {mutant.kind} {mutant.change} in {around!r}: {reason}")
    return found


def sampled(folder: Path, count: int) -> list[tuple[str, Mutant]]:
    """So many mistakes of each kind, from all derivations."""
    kinds = defaultdict(list)
    for name, text in DERIVATIONS.items():
        (folder / "a.md").write_text(text)
        for mutant in mutants(read_document(folder / "a.md")):
            kinds[mutant.kind].append((name, mutant))
    return [one for group in kinds.values() for one in Random(2).sample(group, count)]


@pytest.mark.long("many planted mistakes")
def test_planted_mistakes_are_found_at_their_place(tmp_path: Path) -> None:
    assert missed(tmp_path, sampled(tmp_path, 1)) == []


@pytest.mark.campaign
def test_most_planted_mistakes_are_found_at_their_place(tmp_path: Path) -> None:
    chosen = sampled(tmp_path, 12)
    assert len(missed(tmp_path, chosen)) <= len(chosen) // 20


@pytest.mark.long("many corrections")
def test_a_correction_is_the_formula_with_another_term(tmp_path: Path) -> None:
    wrong = DERIVATIONS["double"].replace(r"- m g b \cos\beta", r"- m g b \sin\beta")
    document = judged(tmp_path, wrong)
    (one,) = (one for one in document.formulas if one.verdict == "wrong")
    assert (one.line, one.display) == (6, 2)
    assert r"m g b \sin\beta" in one.wrong_term
    assert verdicts(tmp_path, wrong.replace(one.latex, one.correction)) == ["verified"] * 6


def test_a_wrong_term_that_also_stands_elsewhere_is_marked_at_its_place(tmp_path: Path) -> None:
    kinetic, term = r"\tfrac12 m l^2\dot\theta^2", r"- m g l\cos\theta"
    text = rf"$$L = {kinetic} - ({term}) = {kinetic} {term}, \quad l\ddot\theta = -g\sin\theta$$"
    (one, _) = judged(tmp_path, text).formulas
    second = text.rindex(term)
    assert one.wrong_spans == ((second, second + len(term)),)
    (tmp_path / "a.md").write_text(text)
    document, read = judge_file(str(tmp_path / "a.md"), order)
    *_, last = page([(document, read)]).partition("should be")[0].split("<wbr>")
    assert last.startswith('<math displaystyle="true"><mrow class="wrong-term">')


SLIP = r"""
$$x = l\sin\theta,\quad y = -l\cos\theta$$
$$\dot x = l\dot\theta\cos t1,\quad \dot y = l\dot\theta\sin t1$$
$$\ddot\theta = -\frac gl\sin\theta$$
"""


@pytest.mark.long("many meanings of letters")
def test_a_letter_without_a_meaning_is_none_of_another_index(tmp_path: Path) -> None:
    assert verdicts(tmp_path, SLIP) == ["definition"] * 2 + ["verified"] * 3
    unknown = DERIVATIONS["robot"].replace("l_2 s_{12}", "l_3 s_{12}")
    last = judged(tmp_path, unknown).formulas[-1]
    assert (last.verdict, last.note) == ("context", "no meaning was found for l_3")


@pytest.mark.parametrize(("text", "note"), [
    (r"$$\ddot\theta = -\sin\theta$$", ""),
    (r"$$H = \tfrac12 p^2 - \cos\theta, \quad \ddot\theta = -\frac gl\sin\theta$$", "it holds for"),
])  # fmt: skip
def test_formulas_in_units_of_the_system_are_recognised(
    text: str, note: str, tmp_path: Path
) -> None:
    first = judged(tmp_path, text).formulas[0]
    assert first.verdict in CORRECT
    assert note in first.note


def test_values_approximations_and_foreign_formulas_are_not_judged(tmp_path: Path) -> None:
    text = r"""
$$\ddot\theta + \frac gl\sin\theta = 0$$
$$\theta = 0, \quad E = m c^2, \quad \theta < \pi, \quad \sin\theta\approx\theta, \quad x_n\to 0$$
"""
    assert verdicts(tmp_path, text) == [
        "verified", "context", "context", "context", "verified", "context",
    ]  # fmt: skip


def test_a_document_without_mechanics_has_no_verdicts(tmp_path: Path) -> None:
    document = judged(tmp_path, r"$$E = mc^2$$ $$a^2 + b^2 = c^2$$ $$\int_0^1 x\,dx = \frac12$$")
    assert document.system == ""
    assert {one.verdict for one in document.formulas} <= {"context", "unreadable"}


PROGRAM = """
import numpy as np

def rates(t, state, m1, m2, a, b, g):
    p, dp, q, dq = state
    s, c = np.sin(p - q), np.cos(p - q)
    f1 = -m2*b*dq**2*s - (m1 + m2)*g*np.sin(p)
    f2 = a*dp**2*s - g*np.sin(q)
    d = (m1 + m2*s**2)
    ddp = (f1 - m2*c*f2)/(a*d)
    ddq = ((m1 + m2)*f2 - c*f1)/(b*d)
    return dp, ddp, dq, ddq
"""


@pytest.mark.long("other tests reach its code")
def test_programs_are_judged_at_the_lines_of_their_mistakes(tmp_path: Path) -> None:
    assert verdicts(tmp_path, PROGRAM, "a.py") == ["verified"] * 2
    wrong = PROGRAM.replace("- g*np.sin(q)", "+ g*np.sin(q)")
    document = judged(tmp_path, wrong, "a.py")
    assert {one.verdict for one in document.formulas} == {"wrong"}
    assert 8 in {one.line for one in document.formulas}


@pytest.mark.long("eight whole documents")
@pytest.mark.parametrize("name", ["verdicts.json"])
def test_public_documents_have_the_verdicts_of_an_independent_reader(name: str) -> None:
    folder = shared("documents")
    problems = []
    for document in json.loads((folder / name).read_text()):
        judgement = judge_file(str(folder / document["file"]), order)[0]
        for display in document["displays"]:
            own = [one for one in judgement.formulas if one.display == display["n"]]
            is_wrong = any(one.verdict == "wrong" for one in own)
            if is_wrong != (display["verdict"] == "wrong"):
                problems.append((document["file"], display["n"], [one.verdict for one in own]))
    assert problems == []


HINTED = r"$$\ddot A = -\frac{G}{w}\cos A$$"


@pytest.mark.long("other tests reach its code")
def test_hints_settle_the_letters(tmp_path: Path) -> None:
    assert verdicts(tmp_path, HINTED) == ["context"]
    names = tmp_path / "names.toml"
    names.write_text('system = "single_pendulum"\n[names]\nA = "theta"\nG = "g"\nw = "l"\n')
    (tmp_path / "a.md").write_text(HINTED)
    document, _ = judge_file(str(tmp_path / "a.md"), order, hints(None, names))
    (one,) = document.formulas
    assert (one.verdict, one.correction) == ("wrong", r"\ddot A = -\frac{G}{w} \sin\left(A\right)")
    for angle, verdict in (("theta - pi/2", "verified"), ("pi/2 - theta", "wrong")):
        names.write_text(f'[names]\nA = "{angle}"\nG = "g"\nw = "l"\n')
        document, _ = judge_file(str(tmp_path / "a.md"), order, hints("single_pendulum", names))
        assert [one.verdict for one in document.formulas] == [verdict]


def test_letters_of_hints_that_no_formula_has_are_reported(tmp_path: Path) -> None:
    (tmp_path / "a.md").write_text(HINTED)
    names = tmp_path / "names.toml"
    names.write_text('system = "single_pendulum"\n[names]\nA = "theta"\nGG = "g"\nw = "l"\n')
    document, _ = judge_file(str(tmp_path / "a.md"), order, hints(None, names))
    assert document.notes == ("names.GG: no formula has this letter (did you mean 'G'?)",)


def test_inputs_of_a_stated_system_have_letters(tmp_path: Path) -> None:
    """By Newton's second law; the document calls the force f."""
    (tmp_path / "cart.toml").write_text(
        'title = "A cart"\nforces = { x = "F" }\npotential = 0\n'
        '[coordinates]\nx = { unit = "m" }\n[inputs]\nF = { unit = "N" }\n'
        '[parameters]\nm = { value = 1, unit = "kg" }\n'
        '[[masses]]\nmass = "m"\nposition = ["x", "0"]\n'
    )
    (tmp_path / "a.md").write_text(r"$$m\ddot x = f, \quad \ddot x = m f$$")
    stated = hints(str(tmp_path / "cart.toml"), None)
    document, _ = judge_file(str(tmp_path / "a.md"), order, stated)
    assert [one.verdict for one in document.formulas] == ["verified", "wrong"]


@pytest.mark.parametrize(("text", "message"), [
    ('system = "single_pendulum"\n[names]\nA = "thetta"', "names.A: .*'thetta'"),
    ('system = "single_pendulum"\n[names]\nA = "2"', "'2' is neither a parameter nor"),
    ('sistem = "single_pendulum"', "sistem"),
])  # fmt: skip
def test_wrong_hints_are_refused(text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "names.toml").write_text(text)
    with pytest.raises(InputError, match=message):
        hints(None, tmp_path / "names.toml")


@pytest.mark.long("other tests reach its code")
def test_formulas_that_follow_from_a_wrong_one_are_reported_as_such(tmp_path: Path) -> None:
    text = r"""
$$T = \frac12 m l^2\dot\theta^2,\quad V = -m g\cos\theta$$
$$L = \frac12 m l^2\dot\theta^2 + m g\cos\theta$$
$$\frac{\partial L}{\partial\theta} = -m g\sin\theta$$
$$m l^2\ddot\theta + m g\sin\theta = 0$$
$$\ddot\theta = -\frac gl\sin\theta,\quad m l^2\ddot\theta + 2 m g l\sin\theta = 0$$
$$x = l\sin\theta,\quad y = -l\cos\theta$$
"""
    document = judged(tmp_path, text)
    notes = [(one.line, one.note) for one in document.formulas if one.verdict == "wrong"]
    follows = "it follows from line 2"
    assert notes == [(2, ""), (3, follows), (4, follows), (5, follows), (6, "")]
    # a wrong momentum between them is no source
    between = text.replace("\n$$L", "\n$$p_\\theta = 2 m l^2\\dot\\theta$$\n$$L")
    document = judged(tmp_path, between)
    notes = [(one.line, one.note) for one in document.formulas if one.verdict == "wrong"]
    assert notes == [(2, ""), (3, ""), (4, follows), (5, follows), (6, follows), (7, "")]


HOOP = r"""
$$ T = \frac12 m R^2 (\dot\theta^2 + \Omega^2 \sin^2\theta), \quad V = -m g R \cos\theta $$
$$ L = \frac12 m R^2 (\dot\theta^2 + \Omega^2 \sin^2\theta) + m g R \cos\theta $$
$$ E = \frac12 m R^2 (\dot\theta^2 + \Omega^2 \sin^2\theta) - m g R \cos\theta $$
$$ H = \frac12 m R^2 (\dot\theta^2 - \Omega^2 \sin^2\theta) - m g R \cos\theta $$
"""


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize(("text", "verdict"), [
    (r"H = E - m R^2 \Omega^2 \sin^2\theta", "verified"),
    (r"E - H = m R^2 \Omega^2 \sin^2\theta", "verified"),
    (r"H = T + V - m R^2 \Omega^2 \sin^2\theta + m g R", "equivalent"),
    (r"H = E - 2 \frac{m R^2 \Omega^2}{2}", "wrong"),
    (r"E = H + m R^2 \Omega^2", "wrong"),
    (r"H = T + V - m R^2 \Omega^2", "wrong"),
    ("H = T + V", "wrong"),
])  # fmt: skip
def test_the_energy_of_a_rotating_system_is_not_its_hamiltonian_plus_a_constant(
    text: str, verdict: str, tmp_path: Path
) -> None:
    # E - H = 2 T_0, the part of T without velocities: H. Goldstein, Classical Mechanics, § 2.7
    *stated, last = verdicts(tmp_path, f"{HOOP}$$ {text} $$\n")
    assert stated == ["verified"] * 5
    assert last == verdict
