"""Dimensions of letters decide which of two contrary formulas of a document is wrong."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from derive.reading.document_formats import read_document
from derive.reading.latex.display_reader import formulas as statements_of
from derive.reading.programs.program_reader import read_program
from derive.verification.documents.judgement import judge_document
from derive.verification.documents.letters.dimensions import inhomogeneous_formulas
from derive.verification.documents.letters.hints import without_meaning
from derive.verification.documents.letters.letter_roles import letters_of
from derive.verification.documents.pages.verdicts_in_place import FormulaVerdict
from derive.verification.documents.program_judgement import judge_program
from derive.verification.documents.rules.evidence.weighing import INHOMOGENEOUS
from derive.verification.documents.statements import Occurrence, translated

#: The note on formulas of no known system.
NO_SYSTEM = without_meaning(None)


def inhomogeneous(*formulas: str, are_of_program: bool = False, elsewhere: int = 0) -> list[int]:
    """The numbers of inhomogeneous formulas, of which the first ones can be elsewhere."""
    places = [
        Occurrence(number, number, 1, 0, 0, latex, tree)
        for number, latex in enumerate(formulas)
        for tree in statements_of(latex)
    ]
    read = translated(places)
    others, own = read.formulas[:elsewhere], read.formulas[elsewhere:]
    letters = letters_of(own, read.derivatives)
    letters = replace(letters, are_of_program=are_of_program)
    return [*inhomogeneous_formulas(letters, own, read.derivatives, others)]


def judged(folder: Path, *formulas: str) -> list[FormulaVerdict]:
    text = "\n".join(f"$$ {one} $$" for one in formulas)
    (folder / "a.md").write_text(text, encoding="utf-8")
    return [*judge_document(read_document(folder / "a.md")).formulas]


ENERGY = r"E = \frac{1}{2} m l^2 \dot\theta^2 - m g l \cos\theta + \frac{1}{2} c \theta^2"
EQUATION = r"m l^2 \ddot\theta = - m g l \sin\theta - c \theta"


#: Two masses on springs; velocities stand after positions.
PROGRAM = """
def rates(t, y):
    x1, x2, v1, v2 = y
    return [v1, v2, {}, {}]
"""


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(("rates", "notes"), [
    (("k*(k*(x2 - x1) - x1)/m", "-k*(x2 - x1) - k*x2"), (INHOMOGENEOUS, NO_SYSTEM)),
    (("k*(2*(x2 - x1) - x1)/m", "-k*(3*(x2 - x1) + x2)/m"), (NO_SYSTEM, NO_SYSTEM)),
])  # fmt: skip
def test_of_no_known_system_an_inhomogeneous_equation_is_noted_and_not_wrong(
    rates: tuple[str, str], notes: tuple[str, str], tmp_path: Path
) -> None:
    program = read_program(PROGRAM.format(*rates), "Python")
    spaced = [re.sub(r"x(\d)", r"x_\1", one).replace("*", " ") for one in rates]
    latex = [rf"\ddot x_{k} = {one}" for k, one in enumerate(spaced, 1)]
    for results in (judge_program(program).formulas, judged(tmp_path, *latex)):
        assert [(one.verdict, one.note) for one in results] == [("context", one) for one in notes]


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize(("energy", "equation", "term", "number"), [
    (ENERGY.replace(r"\dot\theta^2", r"\dot\theta^3"), EQUATION,
     r"\frac{1}{2} m l^2 \dot\theta^3", 0),
    (ENERGY.replace("m g l", "m g"), EQUATION, r"- m g \cos\theta", 0),
    (ENERGY, EQUATION.replace("m l^2", "m l"), r"m l \ddot\theta", 1),
    (ENERGY, EQUATION.replace("m g l", "m m l"), r"- m m l \sin\theta", 1),
    # a system of which I is the moment of inertia about the pivot has neither formula
    (r"E = \frac{1}{2} \dot\theta^2 (I + I^2 M) - M g d \cos\theta",
     r"\ddot\theta (I + d^2 M) = - M g d \sin\theta", "I^2 M", 0),
])  # fmt: skip
def test_of_an_energy_and_its_equation_the_inhomogeneous_one_is_wrong(
    energy: str, equation: str, term: str, number: int, tmp_path: Path
) -> None:
    results = judged(tmp_path, energy, equation)
    assert results[number].verdict == "wrong"
    assert results[number].wrong_term == term
    assert INHOMOGENEOUS in results[number].note
    assert results[1 - number].verdict != "wrong"
    # with the correction, both hold
    pair = [energy, equation]
    pair[number] = results[number].correction
    assert not {one.verdict for one in judged(tmp_path, *pair)} & {"wrong", "context"}


def test_a_canonical_equation_in_other_units_is_not_wrong(tmp_path: Path) -> None:
    hamiltonian = r"H = \frac{p^2}{2 m l^2} - m g l \cos\theta"
    canonical = (r"\dot\theta = \frac{p}{m l^2}", r"\dot p = - m g l \sin\theta")
    results = judged(tmp_path, hamiltonian, *canonical, r"\dot\theta = p")
    assert [one.verdict for one in results] == ["verified"] * 3 + ["context"]


@pytest.mark.long("other tests reach its code")
def test_a_potential_with_a_square_of_a_sine_is_corrected_in_one_term(tmp_path: Path) -> None:
    # that of the equation contains cos(2 theta), and differs by a constant
    kinetic = r"T = \frac{1}{2} m R^2 \dot\theta^2"
    potential = r"V = - \frac{1}{2} m \Omega^2 R^2 \sin^2\theta - m R \cos\theta"
    force = r"m \Omega^2 R^2 \sin\theta \cos\theta - m g R \sin\theta"
    results = judged(tmp_path, kinetic, potential, rf"m R^2 \ddot\theta = {force}")
    assert [one.verdict for one in results] == ["verified", "wrong", "definition"]
    assert results[1].wrong_term == r"- m R \cos\theta"


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize("equation", [
    EQUATION.replace("m g l", "2 m g l"),
    EQUATION.replace("sin", "cos"),
    EQUATION.replace("- c", "+ c"),
])  # fmt: skip
def test_of_two_homogeneous_formulas_that_differ_none_is_wrong(
    equation: str, tmp_path: Path
) -> None:
    results = judged(tmp_path, ENERGY, equation)
    assert "wrong" not in {one.verdict for one in results}
    assert INHOMOGENEOUS not in "".join(one.note for one in results)


@pytest.mark.parametrize("equation", [
    r"\ddot\theta = - \sin\theta",
    r"\ddot\theta = - \sin\theta - \gamma \dot\theta",
    r"\ddot\theta = - \sin\theta - \kappa \theta",
])  # fmt: skip
def test_an_equation_in_other_units_is_not_wrong(equation: str, tmp_path: Path) -> None:
    others = (r"T = \frac{1}{2} m l^2 \dot\theta^2", r"V = - m g l \cos\theta")
    ratio = r"\kappa = \frac{c}{m g l}"
    results = judged(tmp_path, *others, *[ratio] * ("kappa" in equation), equation)
    assert results[-1].verdict != "wrong"
    assert results[-1].note != INHOMOGENEOUS


@pytest.mark.parametrize("formulas", [
    # M is a torque, G the constant of gravitation, T a period, and K an abbreviation
    (r"T = \frac{1}{2} J \dot\alpha^2", r"V = \frac{1}{2} k \alpha^2 - M \alpha",
     r"J \ddot\alpha = M - k \alpha"),
    (r"T = \frac{1}{2} m (\dot r^2 + r^2 \dot\phi^2)", r"V = - \frac{G M m}{r}",
     r"m \ddot r = m r \dot\phi^2 - \frac{G M m}{r^2}"),
    (r"m l^2 \ddot\theta = - m g l \sin\theta", r"\ddot\theta = - \frac{g}{l} \sin\theta",
     r"T = 2 \pi \sqrt{\frac{l}{g}}"),
    (r"T = \frac{1}{2} K \dot\theta^2", r"V = - m g l \cos\theta", r"K = m l^2",
     r"K \ddot\theta = - m g l \sin\theta"),
    (r"m \ddot x + b \dot x + k x = 0", r"\omega_0 = \sqrt{\frac{k}{m}}",
     r"\zeta = \frac{b}{2 \sqrt{k m}}", r"\ddot x + 2 \zeta \omega_0 \dot x + \omega_0^2 x = 0"),
    (r"x = l \sin\theta", r"y = l \cos\theta", r"v^2 = \dot x^2 + \dot y^2",
     r"T = \frac{1}{2} m v^2", r"V = m g y", r"\frac{d}{dt} (m l^2 \dot\theta) = m g l \sin\theta"),
])  # fmt: skip
def test_letters_with_other_meanings_contradict_nothing(
    formulas: tuple[str, ...], tmp_path: Path
) -> None:
    results = judged(tmp_path, *formulas)
    assert INHOMOGENEOUS not in "".join(one.note for one in results)
    assert "wrong" not in {one.verdict for one in results}


@pytest.mark.parametrize("definition", ["K = m l^3", "K = g l^2", r"K = m \sqrt{l}", "K = l^2"])
def test_an_abbreviation_with_other_dimensions_is_not_verified(
    definition: str, tmp_path: Path
) -> None:
    results = judged(
        tmp_path, r"T = \frac{1}{2} K \dot\theta^2", r"V = - m g l \cos\theta", definition,
        r"K \ddot\theta = - m g l \sin\theta",
    )  # fmt: skip
    assert (results[2].verdict, results[2].note) == ("context", INHOMOGENEOUS)
    assert [one.verdict for one in results[:2] + results[3:]] == ["definition"] * 2 + ["verified"]


def test_what_one_of_two_contrary_formulas_states_is_not_verified(tmp_path: Path) -> None:
    results = judged(
        tmp_path, r"x = R \sin\alpha", r"y = R \cos\alpha",
        r"T = \frac{1}{2} m R^2 \dot\alpha^2",
        r"U = - m g R \cos\alpha + \frac{1}{2} k \alpha^3",
        r"m R^2 \ddot\alpha + m g R \sin\alpha + k \alpha = 0",
    )  # fmt: skip
    assert results[2].verdict == "verified"
    assert [one.verdict for one in results[3:]] == ["context", "context"]


WEDGE = (
    r"E = - g m_2 s \sin\alpha + \frac{1}{2} c s^2 + \frac{1}{2} m_2 \dot s^2"
    r" + m_2 \dot s \dot x \cos\alpha + \frac{1}{2} (m_1 + m_2) \dot x^2",
    r"m_2 \ddot s \cos\alpha + (m_1 + m_2) \ddot x = 0",
    r"m_2 \ddot s + m_2 \ddot x \cos\alpha = g m_2 \sin\alpha - c s",
)


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(("old", "new"), [("c s^2", "c s^3"), ("- c s", "- 3 c s")])
def test_an_energy_and_an_equation_that_another_one_does_not_decide_are_not_accused(
    old: str, new: str, tmp_path: Path
) -> None:
    assert [one.verdict for one in judged(tmp_path, *WEDGE)][1:] == ["verified"] * 2
    results = judged(tmp_path, *(one.replace(old, new) for one in WEDGE))
    assert "wrong" not in {one.verdict for one in results}


def test_a_known_system_by_which_no_formula_holds_accuses_none(tmp_path: Path) -> None:
    results = judged(
        tmp_path, r"E = - d g M \cos\theta - \frac{1}{2} \dot\theta^2 (I + d^2 M)",
        r"\ddot\theta (I + d^2 M) = - d g M \sin\theta",
    )  # fmt: skip
    assert "wrong" not in {one.verdict for one in results}


@pytest.mark.long("more cases of the same kind", keep=4)
@pytest.mark.parametrize("other", [
    *(sign.join(["x"] * count) + " = x" for sign, count in (("*", 1500), ("+", 1500), ("*", 199))),
    r"\theta^{1/0} = a", r"a^{\theta} = b", r"M \ddot q = f(q, t)",
    r"\begin{pmatrix} a \\ b \end{pmatrix} = l \begin{pmatrix} \sin\theta \\ 1 \end{pmatrix}",
])  # fmt: skip
def test_formulas_without_dimensions_do_not_disturb_those_of_others(
    other: str, tmp_path: Path
) -> None:
    energy = ENERGY.replace(r"\dot\theta^2", r"\dot\theta^3")
    results = judged(tmp_path, energy, EQUATION, other)
    assert results[0].verdict == "wrong"
    assert "wrong" not in {one.verdict for one in results[1:]}


T, V = r"T = \frac{1}{2} m l^2 \dot\theta^2", r"V = - m g l \cos\theta"


@pytest.mark.parametrize("formulas", [
    (T, V, EQUATION),
    (T, V, r"\ddot\theta = - \sin\theta"),  # in other units
    (T, V, r"\kappa = \frac{c}{m g l}", r"\ddot\theta = - \sin\theta - \kappa \theta"),
    (T, V, r"l = 1", EQUATION),
    (T.replace("m l^2", "K"), V, r"K = m l^2", r"T = \frac{1}{2} K \dot\theta^2"),
    (r"m l^2 \ddot\theta = - m g l \sin\theta", r"T = 2 \pi \sqrt{\frac{l}{g}}"),  # a period
    (r"T = \frac{1}{2} m \dot r^2", r"V = - \frac{G M m}{r}", r"p = m \dot r"),
    # either can be the one: c is a letter of both alone
    (r"m \ddot x = - c x^3", r"E = \frac{1}{2} m \dot x^2 + \frac{1}{2} c x^2"),
    (r"m \ddot x = - k x", r"p = m \dot x", r"\frac{d p}{d t} = - k x", r"x^2 + y^2 = a^2"),
    (r"\tanh(a x) = \sqrt{b} y", r"\frac{\partial T}{\partial \dot\theta} = m l^2 \dot\theta", T),
])  # fmt: skip
def test_formulas_with_the_same_dimensions_have_no_odd_one(formulas: tuple[str, ...]) -> None:
    assert inhomogeneous(*formulas) == []


@pytest.mark.parametrize(("number", "formulas"), [
    (0, (T.replace("l^2", "l"), V, EQUATION)),
    (1, (T, V.replace("m g l", "m l"), EQUATION)),
    (2, (T, V, EQUATION.replace(r"\ddot", r"\dot"))),
    (2, (T, V, r"\frac{\partial T}{\partial \dot\theta} = m l \dot\theta")),
    (2, (T, V, r"\frac{d}{dt}(m l \dot\theta) = - m g l \sin\theta")),
    (0, (r"x = l \sin(m \theta)", T, V)),
    (2, (T, V, r"\omega_0 = \sqrt{\frac{l}{g}}")),
    # by ω alone, by an angle alone, and by a length alone
    (0, (r"V = - \frac{1}{2} m l^2 \Omega^3 \sin^2\theta", T,
         r"m l^2 \ddot\theta = m l^2 \Omega^2 \sin\theta \cos\theta")),
    (0, (r"E = \frac{1}{2} m (\dot r^2 + r^2 \dot\phi^3)", r"m \ddot r = m r \dot\phi^2")),
    (1, (r"m \ddot x = - m b x", r"\dot x^2 + b x = b")),
    # of more than one equation the one that the others contradict
    (0, (r"E = \frac{1}{2} m \dot x^2 + \frac{1}{2} c x^3 + \frac{1}{2} c s^2",
         r"m \ddot x = - c x", r"m \ddot s = - c s")),
])  # fmt: skip
def test_the_odd_one_is_that_whose_dimensions_contradict_all_others(
    number: int, formulas: tuple[str, ...]
) -> None:
    assert inhomogeneous(*formulas) == [number]


@pytest.mark.parametrize(("term", "document", "program"), [
    ("", [], []),
    ("+ 2", [1], []),  # a program states a force by its number
    ("+ 2 m", [1], [1]),
    ("+ 0.5 m", [1], [1]),
    ("+ 9.81 m", [], []),  # a number of a unit
])  # fmt: skip
def test_numbers_can_have_units(term: str, document: list[int], program: list[int]) -> None:
    pair = (r"m\ddot x = - k x", rf"m\ddot y = - k y {term}")
    assert inhomogeneous(*pair) == document
    assert inhomogeneous(*pair, are_of_program=True) == program


HOOP = """
function derivatives(t, y) {
    return [y[1]/r, r*Math.sin(y[0])*(w*w*Math.cos(y[0]) - g/r) - k*y[1]];
}
"""


@pytest.mark.long("other tests reach its code")
def test_numbers_of_a_state_have_no_unit_by_their_letter() -> None:
    results = judge_program(read_program(HOOP, "JavaScript")).formulas
    assert len(results) == 2
    assert INHOMOGENEOUS not in {one.note for one in results}


#: A particle about a centre that no other formula describes: F is any force.
CENTRAL = (
    r"p = m r^2 \dot\phi", r"E = \frac{1}{2} m \dot r^2 + \frac{p^2}{2 m r^2} + U(r)",
    r"m \ddot r - \frac{p^2}{m r^3} = F(r)",
)  # fmt: skip


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(("number", "old", "new"), [
    (1, "2 m r^2", "2 m r"), (2, "m r^3", "m r^2"), (2, "m r^3", "m r^4"), (2, "p^2", "p"),
])  # fmt: skip
def test_the_only_other_power_that_restores_the_dimensions_is_the_correction(
    number: int, old: str, new: str, tmp_path: Path
) -> None:
    assert "wrong" not in [one.verdict for one in judged(tmp_path, *CENTRAL)]
    formulas = [*CENTRAL]
    formulas[number] = formulas[number].replace(old, new)
    (wrong,) = [one for one in judged(tmp_path, *formulas) if one.verdict == "wrong"]
    assert wrong.line == number + 1
    assert wrong.note.startswith(INHOMOGENEOUS)
    formulas[number] = wrong.correction
    assert "wrong" not in [one.verdict for one in judged(tmp_path, *formulas)]


def test_a_formula_that_agrees_with_others_elsewhere_is_not_the_odd_one() -> None:
    slips = CENTRAL[1].replace("2 m r^2", "2 m r^3"), r"m \ddot r - \frac{p^2}{m r^4} + k r = 0"
    part = slips[0], CENTRAL[2], slips[1]
    assert inhomogeneous(*part) == [1]
    assert inhomogeneous(CENTRAL[0], *part, elsewhere=1) == []


@pytest.mark.long("other tests reach its code")
def test_two_formulas_that_agree_with_two_others_each_are_not_wrong(tmp_path: Path) -> None:
    slips = CENTRAL[1].replace("2 m r^2", "2 m r^3"), r"m \ddot r - \frac{p^2}{m r^4} + k r = 0"
    results = judged(tmp_path, CENTRAL[0], slips[0], CENTRAL[2], slips[1])
    assert "wrong" not in [one.verdict for one in results]


@pytest.mark.long("other tests reach its code")
def test_two_formulas_with_a_wrong_power_each_are_wrong(tmp_path: Path) -> None:
    results = judged(
        tmp_path, CENTRAL[0], r"p^2 = m k r", r"\ddot r = r \dot\phi^2 - \frac{k}{m r^2}",
        r"E = \frac{1}{2} m \dot r^2 + \frac{p^2}{m r}",
        r"m \ddot r - \frac{p^2}{m r^4} = - \frac{k}{r^2}",
    )  # fmt: skip
    assert [one.line for one in results if one.verdict == "wrong"] == [4, 5]


@pytest.mark.parametrize("formulas", [
    # T is a tension beside an energy; a is no acceleration in one formula
    (r"T = \frac{1}{2} m \dot y^2", "V = m g y", r"m \ddot y = m g - T",
     r"J \ddot\phi = T R", r"J = \frac{1}{2} M R^2"),
    (r"a = \ddot x", r"m a = - \mu m g", r"m \ddot x = - k x",
     r"\mu = \frac{\mu_0}{1 + a v}", r"\dot x = v"),
])  # fmt: skip
def test_letters_with_two_meanings_make_no_formula_wrong(
    formulas: tuple[str, ...], tmp_path: Path
) -> None:
    assert "wrong" not in [one.verdict for one in judged(tmp_path, *formulas)]


def test_a_wrong_factor_of_what_vanishes_along_every_motion_is_wrong(tmp_path: Path) -> None:
    # without the force that the document applies, the angle has no acceleration
    results = judged(
        tmp_path, r"L = \frac{1}{2} m \dot x^2 + \frac{1}{2} (J + m l^2) \dot\phi^2",
        r"p = (J + m l^2) \dot\phi", r"(J + m l) \ddot\phi = 0",
    )  # fmt: skip
    assert [one.verdict for one in results] == ["definition", "definition", "wrong"]
    assert results[2].correction == r"(J + m l^2) \ddot\phi = 0"


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.parametrize(("terms", "correction"), [
    (r"\frac{1}{2} m \dot x^2 + m l \dot x \dot\theta \cos\theta + \frac{1}{2} l^2 \dot\theta^2",
     r"+ \frac{1}{2} m l^2 \dot\theta^2"),
    (r"\frac{1}{2} m \dot x^2 - \dot x \dot y + m \dot y^2", r"- m \dot x \dot y"),
    (r"\frac{1}{2} m \dot x^2 + \frac{1}{2} l^2 \dot\theta^2", ""),  # either can be the other
    (r"\frac{1}{2} m \dot x^2 + \frac{1}{2} M \dot y^2 + \frac{1}{2} l^2 \dot\theta^2", ""),
])  # fmt: skip
def test_a_factor_of_all_other_terms_is_lost(terms: str, correction: str, tmp_path: Path) -> None:
    results = judged(tmp_path, f"K_2 = {terms}", "K_2 = K - E", r"K - E = m b^2 \omega^2")
    assert (results[0].verdict == "wrong") == bool(correction)
    assert correction in results[0].correction
    assert "wrong" not in [one.verdict for one in results[1:]]


@pytest.mark.long("other tests reach its code")
def test_mu_is_no_mass(tmp_path: Path) -> None:
    orbit = (
        r"\ddot r - r\dot\theta^2 = -\frac{\mu}{r^2}", r"r\ddot\theta + 2\dot r\dot\theta = 0",
        r"h = r^2\dot\theta", r"\dot A = \frac{h}{2}", r"p = \frac{h^2}{\mu}",
    )  # fmt: skip
    assert inhomogeneous(*orbit) == []
    assert "wrong" not in {one.verdict for one in judged(tmp_path, *orbit)}


def test_a_letter_with_another_meaning_in_several_formulas_is_no_slip() -> None:
    damped = (r"R\ddot h + \gamma\dot h + g h = 0", r"R\ddot q + \gamma\dot q + g q = 0",
              r"R\ddot h = -\gamma\dot h - g h", r"l = R + R_1")  # fmt: skip
    divided = r"\ddot h + \gamma\dot h + \omega^2 h = 0", r"\ddot q + \gamma\dot q + \omega^2 q = 0"
    assert inhomogeneous(*damped, *divided) == []
    assert inhomogeneous(*damped, divided[0]) == [4]
