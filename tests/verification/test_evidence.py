"""Which contradictions are evidence of a mistake, and which can have other reasons."""

from collections.abc import Sequence
from dataclasses import replace

import pytest

from derive.reading.latex.display_reader import formulas as statements_of
from derive.system.files.system_catalogue import load
from derive.verification.documents.judgement import _without_foreign
from derive.verification.documents.letters.candidates import BY_EQUATIONS, STATED, SystemCandidate
from derive.verification.documents.letters.letter_roles import letters_of
from derive.verification.documents.rules.consequences import Contradictions, WithVerdict
from derive.verification.documents.rules.evidence import weighed
from derive.verification.documents.rules.side_verdict import plain
from derive.verification.documents.statements import DocumentFormula, Occurrence, translated
from derive.verification.judging.motion_verdicts import NOT_LINEAR
from derive.verification.judging.verdict import Correction


def formulas(*latex: str) -> tuple[DocumentFormula, ...]:
    places = [
        Occurrence(line, line, 1, 0, 0, one, tree)
        for line, one in enumerate(latex, 1)
        for tree in statements_of(one)
    ]
    return translated(places).formulas


def with_verdict(formula: DocumentFormula, verdict: str, kind: str = "") -> WithVerdict:
    return formula, replace(plain(verdict, formula, ""), kind=kind)


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
    assert verdicts([*_without_foreign(wrong, letters, {other})]) == [expected]
    assert verdicts([*_without_foreign(wrong, letters, set())]) == [("wrong", "")]


def stated(name: str, stating: frozenset[int] = frozenset()) -> SystemCandidate:
    """A candidate of two coordinates that a document states."""
    system = replace(load("double_pendulum"), name=name)
    return SystemCandidate(system, ("s", "y"), ((1, 0), (0, 1)), (0, 0), {}, stating=stating)


@pytest.mark.parametrize(("energy", "expected"), [
    (r"T = m\dot s^2", "context"), (r"T = m(\dot s^2 + \dot y^2)", "wrong"),
])  # fmt: skip
def test_equations_of_a_further_coordinate_refute_no_energy(energy: str, expected: str) -> None:
    *equations, last = formulas(r"m\ddot s = - k s", r"\ddot y = - g", energy)
    wrong, result = with_verdict(last, "wrong", "kinetic_energy")
    corrected = replace(result.verdict, corrections=(Correction("m", "m/2"),))
    results = [with_verdict(one, "verified") for one in equations]
    results.append((wrong, replace(result, verdict=corrected)))
    candidate = stated(BY_EQUATIONS, frozenset({0, 1}))
    judged = [*weighed(results, candidate, Contradictions(), is_stated=False)]
    assert judged[-1][1].verdict.verdict == expected


@pytest.mark.parametrize(("start", "kind", "expected"), [
    ("r = r_0", "", "context"), ("b = r_0", "", "wrong"), ("r = r_0", "lagrangian", "wrong"),
])  # fmt: skip
def test_a_value_of_a_function_of_time_is_no_definition(
    start: str, kind: str, expected: str
) -> None:
    first, last = formulas(start, r"r = r_0\cosh(\omega t)")
    results = [with_verdict(first, "definition"), with_verdict(last, "wrong", kind)]
    judged = [*weighed(results, stated(STATED), Contradictions(), is_stated=False)]
    assert judged[-1][1].verdict.verdict == expected


@pytest.mark.parametrize(("latex", "term", "expected"), [
    (r"m\ddot s = - k s - 0.2", "- 0.2", "context"),
    (r"m\ddot s = - k s - 0.2 c", "- 0.2*c", "wrong"),
    (r"v = \dot s - 0.2", "- 0.2", "wrong"),  # no equation of motion
])  # fmt: skip
def test_a_number_that_is_added_can_be_a_force(latex: str, term: str, expected: str) -> None:
    (formula,) = formulas(latex)
    _, result = with_verdict(formula, "wrong")
    corrected = replace(result.verdict, corrections=(Correction(term, "0"),))
    results = [(formula, replace(result, verdict=corrected))]
    judged = [*weighed(results, stated(STATED), Contradictions(), is_stated=False)]
    assert judged[-1][1].verdict.verdict == expected


@pytest.mark.parametrize(("note", "expected"), [(f"it {NOT_LINEAR}", "wrong"), ("", "context")])
def test_whatever_the_inertia_is_accelerations_have_no_squares(note: str, expected: str) -> None:
    energy, equation = formulas(r"L = \frac12 I_1\dot s^2", r"m\ddot s^2 = - k s")
    unknown = replace(plain("context", energy, ""), is_understood=False)
    results = [(energy, unknown), (equation, plain("wrong", equation, note))]
    judged = [*weighed(results, stated(STATED), Contradictions(), is_stated=False)]
    assert judged[-1][1].verdict.verdict == expected
