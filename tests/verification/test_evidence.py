"""Which contradictions are evidence of a mistake, and which can have other reasons."""

from collections.abc import Sequence
from dataclasses import replace

import pytest

from derive.reading.latex.display_reader import formulas as statements_of
from derive.system.files.system_catalogue import load
from derive.verification.documents.judgement import _without_foreign
from derive.verification.documents.letters.candidates import BY_EQUATIONS, STATED, SystemCandidate
from derive.verification.documents.letters.known_systems.templates import named
from derive.verification.documents.letters.letter_roles import letters_of
from derive.verification.documents.letters.subjects import implied_rates
from derive.verification.documents.rules.consequences import (
    Contradictions,
    WithVerdict,
    without_sources,
)
from derive.verification.documents.rules.evidence.weighing import weighed
from derive.verification.documents.rules.side_verdict import plain
from derive.verification.documents.statements import (
    DocumentFormula,
    Occurrence,
    Translated,
    translated,
)
from derive.verification.judging.motion_verdicts import NOT_LINEAR
from derive.verification.judging.verdict import Correction


def formulas(*latex: str) -> tuple[DocumentFormula, ...]:
    places = [
        Occurrence(line, line, 1, 0, 100 * line, one, tree)
        for line, one in enumerate(latex, 1)
        for tree in statements_of(one)
    ]
    return translated(places).formulas


def with_verdict(formula: DocumentFormula, verdict: str, kind: str = "") -> WithVerdict:
    return formula, replace(plain(verdict, formula, ""), kind=kind)


def with_correction(
    formula: DocumentFormula, wrong: str, correct: str, kind: str = ""
) -> WithVerdict:
    _, result = with_verdict(formula, "wrong", kind)
    corrected = replace(result.verdict, corrections=(Correction(wrong, correct),))
    return formula, replace(result, verdict=corrected)


def verdicts(results: Sequence[WithVerdict]) -> list[tuple[str, str]]:
    return [(one.verdict.verdict, one.verdict.note) for _, one in results]


@pytest.mark.parametrize(("definition", "expected"), [
    (r"h = l\cos\phi", ("context", "line 1 defines h for another system")),
    ("h = 2 l", ("wrong", "")),  # it stays a parameter
    (r"b = l\cos\phi", ("wrong", "")),
])  # fmt: skip
def test_a_letter_that_another_part_defines_is_no_parameter(
    definition: str, expected: tuple[str, str]
) -> None:
    other, energy = formulas(definition, r"V = - m g h + k\phi^2 + \dot\phi")
    letters = letters_of((energy,), {})
    wrong = [with_verdict(energy, "wrong")]
    assert verdicts([*_without_foreign(wrong, letters, {other}, is_known=False)]) == [expected]
    assert verdicts([*_without_foreign(wrong, letters, set(), is_known=False)]) == [("wrong", "")]


def test_an_operator_is_no_parameter() -> None:
    letters = letters_of(formulas(r"L = m\mathbf{r}\times\dot{\mathbf{r}}"), {})
    assert {*letters.parameters} <= {"L", "m"}


@pytest.mark.parametrize(("definition", "is_known", "expected"), [
    (r"w = l\cos\theta", True, ("context", "line 1 defines w for another system")),
    (r"w = l\cos\theta", False, ("wrong", "")),  # it has its own energies
    (r"w = l\cos\phi", True, ("wrong", "")), ("w = 2 l", True, ("wrong", "")),
])  # fmt: skip
def test_a_coordinate_of_a_known_system_is_not_defined_by_those_of_others(
    definition: str, is_known: bool, expected: tuple[str, str]
) -> None:
    other, rates, energy = formulas(definition, r"v = l\dot\theta", r"V = - m g w + \dot w\dot\phi")
    letters = letters_of((energy,), {})
    assert {*letters.coordinates} == {"w", "phi"}
    wrong = [with_verdict(energy, "wrong")]
    assert verdicts([*_without_foreign(wrong, letters, {other, rates}, is_known)]) == [expected]
    behind = replace(other, occurrence=replace(other.occurrence, start=1000))  # another section
    assert verdicts([*_without_foreign(wrong, letters, {behind, rates}, is_known)]) == [
        ("wrong", "")
    ]


def stated(name: str, stating: frozenset[int] = frozenset()) -> SystemCandidate:
    """A candidate of two coordinates that a document states."""
    system = replace(load("double_pendulum"), name=name)
    return SystemCandidate(system, ("s", "y"), ((1, 0), (0, 1)), (0, 0), {}, stating=stating)


@pytest.mark.parametrize(("energy", "expected"), [
    (r"T = m\dot s^2", "context"), (r"T = m(\dot s^2 + \dot y^2)", "wrong"),
    (r"T = m(\dot s^2 + \dot y^2 + \dot z^2)", "context"),
])  # fmt: skip
def test_equations_of_a_further_coordinate_refute_no_energy(energy: str, expected: str) -> None:
    *equations, last = formulas(r"m\ddot s = - k s", r"\ddot y = - g", energy)
    results = [with_verdict(one, "verified") for one in equations]
    results.append(with_correction(last, "m", "m/2", "kinetic_energy"))
    candidate = stated(BY_EQUATIONS, frozenset({0, 1}))
    judged = [*weighed(results, candidate, Contradictions(), is_stated=False)]
    assert judged[-1][1].verdict.verdict == expected


@pytest.mark.parametrize(("holding", "expected"), [(3, "context"), (4, "wrong")])
def test_energies_of_which_most_formulas_are_another_case_refute_none(
    holding: int, expected: str
) -> None:
    latex = (rf"{n} m\ddot s = - {n} k s" for n in range(2, 6 + holding))
    energy, *equations = formulas(r"T = m\dot s^2", *latex)
    results = [with_verdict(energy, "definition")]
    results += [with_correction(one, "k", "2*k") for one in equations[:4]]
    results += [with_verdict(one, "verified") for one in equations[4:]]
    candidate = stated("stated_energies", frozenset({0}))
    judged = [*weighed(results, candidate, Contradictions(), is_stated=False)]
    assert {one.verdict.verdict for _, one in judged[1:5]} == {expected}


def known(name: str, coordinates: tuple[str, ...], **letters: str) -> SystemCandidate:
    """A candidate of a known system in its usual form."""
    count = range(len(coordinates))
    signs = tuple(tuple(int(i == k) for i in count) for k in count)
    return SystemCandidate(named(name), coordinates, signs, (0,) * len(coordinates), letters)


@pytest.mark.parametrize(("correct", "expected"), [
    ("2*w*y_dot*sin(s)", "context"), ("2*w*sin(w*s)", "wrong"),
])  # fmt: skip
def test_a_known_system_of_which_nothing_holds_adds_no_letters(correct: str, expected: str) -> None:
    (formula,) = formulas(r"\ddot x = -\frac gl x - c \dot x + \frac12\sin(w s)")
    letters = {"g": "g", "l": "l", "Omega": "w", "latitude": "s"}
    results = [with_correction(formula, "1/2*sin(w*s)", correct)]
    candidate = known("small_foucault", ("x", "y"), **letters)
    judged = [*weighed(results, candidate, Contradictions(), is_stated=False)]
    assert judged[0][1].verdict.verdict == expected


@pytest.mark.parametrize(("latex", "wrong", "correct", "expected"), [
    (r"m\ddot x = 0", "", "k*x", "context"),  # a free motion
    (r"m\ddot x = 0", "0", "-k*x", "context"),
    (r"m\ddot x + x = 0", "x", "k*x", "wrong"),
    (r"m\ddot x + k = 0", "", "k*x", "wrong"),
    (r"m\ddot x = - c \dot x", "", "k*x", "wrong"),  # with a force
    (r"m\ddot x = m", "", "k*x", "wrong"),
])  # fmt: skip
def test_a_free_motion_can_be_another_case_than_a_known_system(
    latex: str, wrong: str, correct: str, expected: str
) -> None:
    first, last = formulas(r"m\ddot x + k x = 0", latex)
    results = [with_verdict(first, "verified"), with_correction(last, wrong, correct)]
    candidate = known("oscillator", ("x",), m="m", k="k")
    judged = [*weighed(results, candidate, Contradictions(), is_stated=False)]
    assert judged[1][1].verdict.verdict == expected


@pytest.mark.parametrize(("latex", "kind", "expected"), [
    (r"\omega_1 = \sqrt 3", "", "context"), (r"\omega_1 = k\sqrt 3", "", "wrong"),
    (r"\ddot s = 3", "", "wrong"), ("s = 3", "", "wrong"), ("V = 3", "potential_energy", "wrong"),
])  # fmt: skip
def test_a_name_can_have_a_number_in_another_case(latex: str, kind: str, expected: str) -> None:
    (formula,) = formulas(latex)
    results = [with_correction(formula, formula.sides[-1].text, "k", kind)]
    judged = [*weighed(results, stated(STATED), Contradictions(), is_stated=False)]
    assert judged[0][1].verdict.verdict == expected


@pytest.mark.parametrize(("start", "kind", "expected"), [
    ("r = r_0", "", "context"), ("b = r_0", "", "wrong"), ("r = r_0", "lagrangian", "wrong"),
])  # fmt: skip
def test_a_value_of_a_function_of_time_is_no_definition(
    start: str, kind: str, expected: str
) -> None:
    first, last = formulas(start, r"r = r_0\cosh(\omega t)")
    wrong = with_correction(last, "cosh(omega*t)", "sinh(omega*t)", kind)
    results = [with_verdict(first, "definition"), wrong]
    judged = [*weighed(results, stated(STATED), Contradictions(), is_stated=False)]
    assert judged[-1][1].verdict.verdict == expected


@pytest.mark.parametrize(("latex", "term", "expected"), [
    (r"m\ddot s = - k s - 0.2", "- 0.2", "context"),
    (r"m\ddot s = - k s - 0.2 c", "- 0.2*c", "wrong"),
    (r"v = \dot s - 0.2", "- 0.2", "wrong"),  # no equation of motion
])  # fmt: skip
def test_a_number_that_is_added_can_be_a_force(latex: str, term: str, expected: str) -> None:
    (formula,) = formulas(latex)
    results = [with_correction(formula, term, "0")]
    judged = [*weighed(results, stated(STATED), Contradictions(), is_stated=False)]
    assert judged[-1][1].verdict.verdict == expected


@pytest.mark.parametrize(("note", "expected"), [(f"it {NOT_LINEAR}", "wrong"), ("", "context")])
def test_whatever_the_inertia_is_accelerations_have_no_squares(note: str, expected: str) -> None:
    energy, equation = formulas(r"L = \frac12 I_1\dot s^2", r"m\ddot s^2 = - k s")
    unknown = replace(plain("context", energy, ""), is_understood=False)
    results = [(energy, unknown), (equation, plain("wrong", equation, note))]
    judged = [*weighed(results, stated(STATED), Contradictions(), is_stated=False)]
    assert judged[-1][1].verdict.verdict == expected


def of_last(*results: WithVerdict) -> str:
    judged = [*weighed(results, stated(STATED), Contradictions(), is_stated=False)]
    return judged[-1][1].verdict.verdict


MOTIONS = [r"m\ddot s = - k s", r"\ddot y = - g", r"p = m\dot s", r"q = m\dot y"]


def test_a_formula_with_several_changes_is_wrong_if_all_others_hold() -> None:
    *others, parameter, last = formulas(*MOTIONS, "m = 2 k", r"m\ddot s = - 7 k y^3")
    held = [with_verdict(one, "verified") for one in others]
    wrong = with_correction(last, "7*k*y**3", "k*s")
    assert of_last(*held, wrong) == "wrong"
    assert of_last(wrong) == "wrong"  # by positions
    # what is undecided can be of the same system as the formula, unless nothing moves in it
    assert of_last(*held[1:], with_verdict(others[0], "context"), wrong) == "context"
    assert of_last(*held, with_verdict(parameter, "context"), wrong) == "wrong"


@pytest.mark.parametrize(("count", "expected"), [(7, "context"), (8, "wrong")])
def test_two_formulas_with_several_changes_are_wrong_beside_many(count: int, expected: str) -> None:
    *others, last = formulas(*(2 * MOTIONS), r"m\ddot s = - 7 k y^3")
    wrong = with_correction(last, "7*k*y**3", "k*s")
    held = [with_verdict(one, "verified") for one in others[:count]]
    assert of_last(*held, wrong, wrong) == expected


def test_an_energy_of_another_system_refutes_no_equation() -> None:
    first, energy, last = formulas(
        r"\ddot y = - g", r"L = m\dot s^2 + 7 k y^3", r"m\ddot s = - 2 k s"
    )
    undecided = with_verdict(first, "context")
    slip = with_correction(last, "2*k*s", "k*s")
    other = with_correction(energy, "7*k*y**3", "g*s", "lagrangian")
    assert of_last(undecided, slip) == "wrong"
    assert of_last(undecided, other, slip) == "context"
    assert of_last(undecided, with_correction(energy, "m", "m/2", "lagrangian"), slip) == "wrong"


def test_a_formula_with_several_changes_is_wrong_by_a_system_that_the_user_states() -> None:
    (formula,) = formulas(r"m\ddot s = - 7 k y^3")
    results = [with_correction(formula, "7*k*y**3", "k*s"), with_verdict(formula, "context")]
    for is_stated, expected in ((True, "wrong"), (False, "context")):
        judged = [*weighed(results, stated(STATED), Contradictions(), is_stated)]
        assert judged[0][1].verdict.verdict == expected


@pytest.mark.parametrize(("count", "expected"), [(3, "context"), (4, "wrong")])
def test_a_known_system_of_which_much_differs_refutes_nothing(count: int, expected: str) -> None:
    right, other, last = formulas(r"m\ddot x + k x = 0", r"\ddot x = 7 x^3 m", r"m\ddot x = k x")
    results = [with_verdict(right, "verified")] * count
    results += [with_correction(other, "7*x**3*m", "-k*x/m"), with_correction(last, "k*x", "-k*x")]
    results += [with_verdict(other, "context")]
    candidate = known("oscillator", ("x",), m="m", k="k")
    judged = [*weighed(results, candidate, Contradictions(), is_stated=False)]
    assert judged[-2][1].verdict.verdict == expected


@pytest.mark.parametrize(("latex", "expected"), [
    (r"T = m\dot s^2", "context"), (r"m\ddot s = - k s", "wrong"),
    (r"\frac{\partial L}{\partial s} = - k s", "wrong"),
])  # fmt: skip
def test_an_energy_alone_refutes_no_other_energy(latex: str, expected: str) -> None:
    energy, held, last = formulas(r"L = m\dot s^2 - k s^2", latex, r"V = 2 k s^2")
    results = [
        with_verdict(energy, "definition", "lagrangian"), with_verdict(held, "verified"),
        with_correction(last, "2*k*s**2", "k*s**2", "potential_energy"),
    ]  # fmt: skip
    candidate = stated("stated_energies", frozenset({0}))
    judged = [*weighed(results, candidate, Contradictions(), is_stated=False)]
    assert judged[-1][1].verdict.verdict == expected


@pytest.mark.parametrize(("place", "kind", "expected"), [
    ("x_1", "potential_energy", "context"), ("x_1", "", "wrong"),
    ("k_1", "potential_energy", "wrong"),
])  # fmt: skip
def test_a_place_without_a_rate_can_be_another_one(place: str, kind: str, expected: str) -> None:
    energy, held, last = formulas(r"L = m\dot s^2 - m g s", r"\ddot s = - g", f"V = m g {place}")
    results = [
        with_verdict(energy, "definition", "lagrangian"), with_verdict(held, "verified"),
        with_correction(last, f"m*g*{place}", "m*g*s", kind),
    ]  # fmt: skip
    candidate = stated("stated_energies", frozenset({0}))
    judged = [*weighed(results, candidate, Contradictions(), is_stated=False)]
    assert judged[-1][1].verdict.verdict == expected
    # positions that are stated show what it is
    by_positions = [*weighed(results, stated(STATED), Contradictions(), is_stated=False)]
    assert by_positions[-1][1].verdict.verdict == "wrong"


@pytest.mark.parametrize(("source", "expected"), [("wrong", "wrong"), ("context", "context")])
def test_what_follows_from_a_formula_is_wrong_if_this_is(source: str, expected: str) -> None:
    energies = formulas(r"L = \frac12 m\dot x^2 - k x^2", r"H = \frac12 m\dot x^2 + k x^2")
    (first, one), (second, other) = (with_verdict(formula, "wrong") for formula in energies)
    one = replace(one, verdict=replace(one.verdict, verdict=source))
    other = replace(other, source=first.occurrence.line)
    found = without_sources([(first, one), (second, other)])
    assert verdicts(found) == [(source, ""), (expected, "")]


@pytest.mark.parametrize(("relation", "expected"), [
    (r"s^2 + y^2 = (h^2 - q^2)/2", "wrong"),
    (r"s^2 + y^2 = k (h^2 - q^2)/2", "context"),  # with a parameter, it can be a condition
    (r"s^2 + y^2 = -q^2", "context"), ("s^2 = -y^2", "context"),  # at a place
])  # fmt: skip
def test_a_relation_of_defined_names_is_of_no_other_case(relation: str, expected: str) -> None:
    *names, L, one, two, last = formulas("h = s + y", "q = s - y", r"L = m\dot s^2 - k s^2",
        r"m\ddot s = - k y", r"m\ddot y = - k s", relation)  # fmt: skip
    if "q^2)" not in relation:
        names = names[2:]  # q is not defined
    results = [
        *(with_verdict(one, "definition") for one in names), with_verdict(L, "definition"),
        *(with_verdict(one, "wrong") for one in (one, two, one, two)),
        with_correction(last, "-q**2", "q**2"),
    ]  # fmt: skip
    candidate = stated("stated_energies", frozenset({len(names)}))
    judged = [*weighed(results, candidate, Contradictions(), is_stated=False)]
    assert judged[-1][1].verdict.verdict == expected


def test_a_column_has_the_order_of_coordinates_also_of_turned_ones() -> None:
    own = formulas(r"\ddot x + x = 0", r"\theta = \pi + \phi", r"\ddot\phi + \ddot\theta = x",
        r"q = \begin{bmatrix} \theta \\ x \end{bmatrix}")  # fmt: skip
    assert letters_of(own, {}).ordered == ("phi", "x")


def test_a_component_of_a_velocity_belongs_to_a_position_that_is_stated_once() -> None:
    T, one, two, v = r"T = \dot\phi^2", r"x_2 = l\sin\phi", r"x_2 = b\sin\phi", r"v_{x2} = l"
    for latex, count in (((T, one, v), 1), ((T, one, two, v), 0), ((T, one), 0)):
        read = Translated(formulas(*latex), (), {})
        implied = [one.text for one in implied_rates(read).formulas if one.occurrence.line == 0]
        assert implied == ["v_x2 = x_2_dot"] * count
