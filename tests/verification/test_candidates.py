"""What speaks for a meaning of letters: the formulas that hold, and a usual convention."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from derive.reading.programs.program import ProgramEquation
from derive.system.files.system_catalogue import load
from derive.system.system import System
from derive.verification.documents import letter_meanings, program_judgement
from derive.verification.documents.formula_translation import is_derivative, order, stem
from derive.verification.documents.judges import Judges
from derive.verification.documents.letters import candidates as module
from derive.verification.documents.letters.candidates import SystemCandidate, candidates, loads
from derive.verification.documents.letters.document_system import system_letters
from derive.verification.documents.letters.known_systems.templates import named
from derive.verification.documents.letters.letters import Letters
from derive.verification.documents.letters.stated_constraints import StatedConstraint
from derive.verification.documents.numbers.matching import Match, best_matches, trivial_comparisons
from derive.verification.documents.statements import Translated

USUAL = SystemCandidate(
    load("single_pendulum"), ("phi",), ((1,),), (0,), {"m": "m", "l": "l", "g": "g"}
)
UPRIGHT = replace(USUAL, offsets=(2,))
MIRRORED = replace(USUAL, signs=((-1,),))
LETTERS = Letters(("phi",), {}, {}, ("a", "g", "m", "F", "c"), ("phi",), {}, ("phi",))


def test_a_usual_convention_decides_between_equal_support_only() -> None:
    assert USUAL.is_usual
    assert not UPRIGHT.is_usual
    assert not MIRRORED.is_usual
    assert Match(USUAL, 3, 4).score > Match(UPRIGHT, 3, 4).score
    assert Match(USUAL, 3, 4).score > Match(MIRRORED, 3, 4).score
    assert Match(UPRIGHT, 4, 4).score > Match(USUAL, 3, 4).score


def test_formulas_that_do_not_hold_speak_against_a_meaning() -> None:
    assert Match(USUAL, 3, 3).score > Match(USUAL, 3, 6).score
    assert Match(USUAL, 6, 8).score > Match(USUAL, 3, 3).score


@pytest.mark.parametrize(("failed", "is_enough"), [(6, True), (7, False)])
def test_two_fifths_of_the_formulas_hold_for_a_known_system(failed: int, is_enough: bool) -> None:
    match = Match(USUAL, 3, 11, frozenset(range(failed)))
    assert letter_meanings._is_supported(match, letter_meanings.LEAST) is is_enough
    stated = replace(match, candidate=replace(USUAL, stating=frozenset({10})))
    assert letter_meanings._is_supported(stated, letter_meanings.LEAST)


def test_parameters_can_be_required_to_have_letters() -> None:
    letters = replace(LETTERS, parameters=("g", "m"))
    assert {one.lacking for one in candidates(USUAL.system, letters)} == {1}
    assert not [*candidates(USUAL.system, letters, has_all=True)]
    assert {one.lacking for one in candidates(USUAL.system, LETTERS, has_all=True)} == {0}


@pytest.mark.parametrize("text", ["-g*sin(phi)/l", "g*sin(phi)/l", "-g*sin(phi)/l**2", "0"])
def test_a_system_is_left_out_only_if_all_its_candidates_have_less_support(text: str) -> None:
    equation = ProgramEquation(1, "acceleration", "phi", "", f"phi_ddot = {text}")
    formulas = (program_judgement._formula(equation),)
    letters = replace(LETTERS, parameters=("g", "l"))
    tried = [*candidates(USUAL.system, letters)]
    whole = best_matches(tried, letters, formulas, {}, frozenset())
    most = max(match.support for match in whole)
    assert best_matches(tried, letters, formulas, {}, frozenset(), most) == whole
    assert not best_matches(tried, letters, formulas, {}, frozenset(), 1.1)


def test_only_a_usual_system_with_which_all_formulas_hold_ends_a_search() -> None:
    whole = Match(USUAL, 2, 2, is_of_all_formulas=True)
    assert whole.is_complete
    assert not replace(whole, candidate=UPRIGHT).is_complete
    assert not replace(whole, candidate=replace(USUAL, numbers={"g": "1"})).is_complete
    assert not replace(whole, candidate=replace(USUAL, parameters={"l": "l"})).is_complete
    assert not replace(whole, holding=1, failed=frozenset({1})).is_complete


@pytest.mark.parametrize(("formulas", "ends"), [
    (["V = -m*g*l*cos(phi)"], True),
    (["L = m*l**2*phi_dot**2/2 - V", "V = -m*g*l*cos(phi)"], True),
    (["phi_dot**2/2 = phi_dot*phi_dot/2"], True),  # for any motion
    (["V = -m*g*l*sin(phi)"], False),
    (["0 = phi_ddot + zeta"], False),  # it is not compared
])  # fmt: skip
def test_a_search_goes_on_where_a_formula_was_not_compared_or_does_not_hold(
    formulas: list[str], ends: bool
) -> None:
    quantities = {"V": "potential_energy", "L": "lagrangian"}
    letters = replace(LETTERS, parameters=("g", "l", "m"), quantities=quantities)
    texts = ("phi_ddot = -g*sin(phi)/l", *formulas)
    statements = [
        program_judgement._formula(ProgramEquation(1, "acceleration", "phi", "", text))
        for text in texts
    ]
    tried = [*candidates(USUAL.system, letters)]
    trivial = trivial_comparisons(letters, statements, {})
    match, *_ = best_matches(tried, letters, statements, {}, trivial)
    assert match.is_complete == ends


def test_a_rival_with_the_support_of_the_best_is_not_left_out() -> None:
    least = letter_meanings._least_support([Match(USUAL, 2, 2)], letter_meanings.LEAST)
    assert Match(USUAL, 1, 2, frozenset({1})).support < least <= Match(UPRIGHT, 2, 2).score


def test_candidates_begin_with_the_usual_convention_and_the_same_indices() -> None:
    first = next(candidates(USUAL.system, LETTERS))
    assert first.is_usual
    assert first.parameters == {"m": "m", "l": "a", "g": "g"}
    assert not first.forces
    names = ("theta_1", "theta_2")
    own = Letters(names, {}, {}, ("m_2", "m_1", "l_2", "l_1", "g"), names, {}, names)
    first = next(candidates(load("double_pendulum"), own))
    assert first.coordinates == names
    assert first.parameters == {"m1": "m_1", "m2": "m_2", "l1": "l_1", "l2": "l_2", "g": "g"}


def test_one_letter_can_stand_for_all_parameters_of_a_kind() -> None:
    names = ("theta_1", "theta_2")
    own = Letters(names, {}, {}, ("m", "M", "l", "g"), names, {}, names)
    choices = [one.parameters for one in candidates(load("double_pendulum"), own)]
    equal = {"m1": "m", "m2": "m", "l1": "l", "l2": "l", "g": "g"}
    assert equal in choices
    assert equal | {"m2": "M"} in choices


def test_forces_act_on_one_coordinate_or_on_none() -> None:
    assert loads(LETTERS, "force", 2) == [(), (("F", 0),), (("F", 1),)]
    assert loads(LETTERS, "damping", 1) == [(), (("c", 0),)]


@pytest.mark.parametrize(
    ("name", "whole", "number"),
    [("x", "x", 0), ("x_dot", "x", 1), ("x_1_ddot", "x_1", 2), ("x_dddot", "x", 3)],
)
def test_names_of_rates_have_a_stem_and_an_order(name: str, whole: str, number: int) -> None:
    assert (stem(name), order(name)) == (whole, number)


def test_one_letter_can_stand_for_a_length_and_an_amplitude() -> None:
    parameters, numbers = {"l": "a", "a": "a", "c": "b"}, {"m": "1", "Omega": "1", "g": "1"}
    system = load("driven_pendulum")
    driven = replace(USUAL, system=system, parameters=parameters, numbers=numbers)
    own = system_letters(driven).system
    assert {symbol.name: symbol.is_positive for symbol in own.params} == {"a": True, "b": None}


def test_only_the_conventions_that_can_be_tried_are_listed(monkeypatch: pytest.MonkeyPatch) -> None:
    # with six lengths as coordinates and eight as parameters there are some 10**7
    listed = 0
    every = module._conventions

    def counted(system: System, letters: Letters) -> Iterator[Any]:
        nonlocal listed
        for listed, one in enumerate(every(system, letters), 1):  # noqa: B007
            yield one

    monkeypatch.setattr(module, "_conventions", counted)
    names = ("x_1", "y_1", "x_2", "y_2", "x_3", "y_3")
    letters = Letters(names, {}, {}, tuple(f"l_{k}" for k in range(8)), names, {}, names)
    next(candidates(named("bodies_3_2"), letters))
    assert listed <= module.MAX_CANDIDATES


def test_constraints_without_a_motion_belong_to_no_meaning() -> None:
    names = ("f", "h")
    letters = Letters(names, {}, {}, (), names, {}, names)
    formula = program_judgement._formula(ProgramEquation(1, "rate", "f", "", "f = 0"))
    judges = Judges(Translated((formula,), (), {}), letters)
    free = SystemCandidate(named("polar_mass"), names, ((1, 0), (0, 1)), (0, 0), {})
    assert judges.has_motions(free)
    at_centre = StatedConstraint("f", frozenset({"f"}), 0)  # where the radius is not positive
    assert not judges.has_motions(replace(free, constraints=(at_centre,)))
    of_nothing = StatedConstraint("f - f", frozenset({"f"}), 0)
    assert not judges.has_motions(replace(free, constraints=(of_nothing,)))


def test_a_system_is_refuted_by_one_other_formula() -> None:
    stating = replace(USUAL, stating=frozenset({0}))
    failed = [{1}, {0}, {1, 2}, set[int]()]
    matches = [Match(stating, 1, 3, frozenset(one)) for one in failed]
    assert [one.is_refuted_by_one for one in matches] == [True, False, False, False]


@pytest.mark.parametrize(("name", "expected"), [
    ("dL_dtheta", True), ("dL_dx_dot", True), ("delta_dot", False), ("d_dot", False),
    ("x_d", False),
])  # fmt: skip
def test_names_of_derivatives_are_no_rates(name: str, expected: bool) -> None:
    assert is_derivative(name) == expected
