"""Advice on wrong formulas names the wrong term, and mends them."""

import re
from collections import Counter
from functools import cache
from pathlib import Path
from typing import Any

import mpmath as mp
import pytest
import sympy as sp
from advice_campaign import Outcome, document, outcome
from formula_mutants import mutants
from formula_truth import formulas, is_right

from derive import Coordinate, Derivation, Parameter, PointMass, System, load
from derive.reading.document_formats import read_document
from derive.verification.corrections import advice
from derive.verification.corrections.advice import MAX_LENGTH
from derive.verification.documents.judgement import judge_document
from derive.verification.hand_derivation_files import judge
from derive.verification.judging import terms
from derive.verification.judging.reference_system import ReferenceSystem
from derive.verification.judging.verdict import Verdict
from derive.verification.quantity_verdicts import judge_formula


@cache
def model(name: str) -> ReferenceSystem:
    return ReferenceSystem(Derivation(load(name)), {})


def judged(system: str, kind: str, key: str, text: str) -> Verdict:
    result = judge_formula(model(system), "printed", text, kind, key)
    assert result.verdict == "wrong"
    return result


DOUBLE = (
    "m1*l1**2*theta1_dot**2/2 + m2*(l1**2*theta1_dot**2 + l2**2*theta2_dot**2 "
    "+ 2*l1*l2*cos(theta2 - theta1)*theta1_dot*theta2_dot)/2"
)
CHAIN = (
    "m1*l1**2*theta1_dot**2/2 + m2*((l1*theta1_dot*cos(theta1) + l2*theta2_dot*cos(theta2))**2"
    " + (l1*theta1_dot*sin(theta1) + l2*theta2_dot*sin(theta2))**2)/2"
    " + m3*((l1*theta1_dot*cos(theta1) + l2*theta2_dot*cos(theta2) + l3*theta3_dot*cos(theta3))**2"
    " + (l1*theta1_dot*sin(theta1) + l2*theta2_dot*sin(theta2) + l3*theta3_dot*sin(theta3))**2)"
)
ACCELERATION = (
    "(-g*(2*m1 + m2)*sin(theta1) - m2*g*sin(theta1 - 2*theta2) - 2*sin(theta1 - theta2)*m2"
    "*(theta2_dot**2*l2 + theta1_dot**2*l1*cos(theta1 - theta2)))"
    "/(l1*(2*m1 + m2 - m2*cos(2*theta1 - 2*theta2)))"
)


@pytest.mark.long("more cases of the same kind", keep=5)
@pytest.mark.parametrize(("system", "kind", "key", "text", "wrong", "correct"), [
    # g is missing in the last term of a web page: arsnumerandi.com/post/11
    ("double_pendulum", "lagrangian", "", f"{DOUBLE} + (m1 + m2)*g*l1*cos(theta1)"
     " + m2*l2*cos(theta2)", "m2*l2*cos(theta2)", "g*l2*m2*cos(theta2)"),
    ("double_pendulum", "lagrangian", "", f"{DOUBLE} - (m1 + m2)*g*l1*cos(theta1)"
     " + m2*g*l2*cos(theta2)", "-(m1 + m2)*g*l1*cos(theta1)", "(m1 + m2)*g*l1*cos(theta1)"),
    ("double_pendulum", "lagrangian", "", f"{DOUBLE} + (m1 + m2)*g*l1*cos(theta1)",
     "", "g*l2*m2*cos(theta2)"),
    ("double_pendulum", "lagrangian", "", f"{DOUBLE} + (m1 + m2)*g*l1*cos(theta1)"
     " + m2*g*l2*sin(theta2)", "m2*g*l2*sin(theta2)", "m2*g*l2*cos(theta2)"),
    ("double_pendulum", "euler_lagrange", "", "(m1 + m2)*l1*theta1_ddot"
     " + m2*l2*theta2_ddot*cos(theta1 - theta2) - m2*l2*theta2_dot**2*sin(theta1 - theta2)"
     " + (m1 + m2)*g*sin(theta1) = 0", "-m2*l2*theta2_dot**2*sin(theta1 - theta2)",
     "m2*l2*theta2_dot**2*sin(theta1 - theta2)"),
    ("double_pendulum", "euler_lagrange", "", "l2*theta2_ddot"
     " + l1*theta1_ddot*cos(theta1 - theta2) = l1*theta1_dot**2*sin(theta1 - theta2)"
     " + g*sin(theta2)", "g*sin(theta2)", "-g*sin(theta2)"),
    ("double_pendulum", "momenta", "theta2", "m2*l2**2*theta2_dot"
     " + m2*l1*l2*theta1_dot*cos(theta1 + theta2)", "m2*l1*l2*theta1_dot*cos(theta1 + theta2)",
     "m2*l1*l2*theta1_dot*cos(theta1 - theta2)"),
    # the sign of a term in two brackets, and in a denominator
    ("double_pendulum", "accelerations", "theta1", ACCELERATION.replace("l2 +", "l2 -"),
     "-theta1_dot**2*l1*cos(theta1 - theta2)", "theta1_dot**2*l1*cos(theta1 - theta2)"),
    ("double_pendulum", "accelerations", "theta1", ACCELERATION.replace("m2 - m2", "m2 + m2"),
     "m2*cos(2*theta1 - 2*theta2)", "-m2*cos(2*theta1 - 2*theta2)"),
    # one half is missing at the third mass
    ("chain_3", "kinetic_energy", "", CHAIN, "m3", "m3/2"),
    # the kinetic part stays
    ("single_pendulum", "lagrangian", "", "m*(l**2*theta_dot**2/2 + g*l*sin(theta))",
     "g*l*sin(theta)", "g*l*cos(theta)"),
    ("single_pendulum", "energy", "", "m*l**2*theta_dot**2/2 - m*g*l*cos(theta) + m*g*theta",
     "m*g*theta", "0"),
    # of two equal terms the shorter one is superfluous
    ("henon_heiles", "potential_energy", "", "x**2/2 + y**2/2 - y**3/3 + y*(x*x) + x**2*y",
     "x**2*y", "0"),
    # a square is missing in a bracket that is itself squared
    ("rotating_hoop", "kinetic_energy", "", "m*((R*theta_dot)**2 + (R*Omega*cos(theta))**2)/2",
     "(R*Omega*cos(theta))**2", "(R*Omega*sin(theta))**2"),
    ("elastic_pendulum", "accelerations", "theta", "(-g*sin(theta) - 2*r_dot*theta_dot)/(r + l)",
     "l", "0"),
    # a term that occurs twice is named by a larger one
    ("henon_heiles", "potential_energy", "", "(x**2 + x**2 + 2*x**2*y - 2*y**3/3)/2",
     "x**2 + x**2 + 2*x**2*y - 2*y**3/3", "y**2 + x**2 + 2*x**2*y - 2*y**3/3"),
    ("henon_heiles", "potential_energy", "", "(x**2 + y**2 + 2*x**2*y)/2", "", "-y**3/3"),
])  # fmt: skip
def test_one_wrong_term_is_named_with_its_correction(
    system: str, kind: str, key: str, text: str, wrong: str, correct: str
) -> None:
    (correction,) = judged(system, kind, key, text).corrections
    assert (correction.wrong, correction.correct) == (wrong, correct)
    assert text[slice(*correction.span)].replace(" ", "") == wrong.replace(" ", "")


def test_a_wave_of_half_the_angle_mends_a_formula() -> None:
    text = "2*m*g*l*sin(theta)**2 - m*g*l"
    (correction,) = judged("single_pendulum", "potential_energy", "", text).corrections
    assert correction.correct == "2*m*g*l*sin(theta/2)**2"


def test_several_wrong_terms_are_corrected_together() -> None:
    text = "m*l**2*theta_dot**2/3 + m*g*l*sin(theta)"
    result = judged("single_pendulum", "lagrangian", "", text)
    assert [one.wrong for one in result.corrections] == [
        "m*l**2*theta_dot**2/3",
        "m*g*l*sin(theta)",
    ]
    for one in result.corrections:
        assert text.count(one.wrong) == 1
        text = text.replace(one.wrong, one.correct)
    verdict = judge_formula(model("single_pendulum"), "mended", text, "lagrangian")
    assert verdict.verdict in ("verified", "equivalent")


def test_the_difference_is_given_where_no_term_mends_the_formula() -> None:
    text = ACCELERATION.replace("l2 +", "l2 -").replace("m2 - m2*cos", "m2 + 2*m2*cos")
    result = judged("double_pendulum", "accelerations", "theta1", text)
    assert result.corrections == ()
    right = f"{text} - ({result.difference})"
    for formula in (right, result.correction):
        verdict = judge_formula(model("double_pendulum"), "", formula, "accelerations", "theta1")
        assert verdict.verdict == "verified"


@pytest.mark.parametrize("term", [
    "sqrt(-2)*m*theta", "tan(theta)**90", "exp(exp(9)*theta)", "sqrt(sin(theta) - 2)",
    "log(-m)*theta", "(theta + m)**(1/3)", "sqrt(theta**2)*theta",
    "theta/(theta - theta_dot)**20", "cos(sin(theta))", "theta**2*0.1",
])  # fmt: skip
def test_unusual_terms_get_advice_that_mends_or_none(term: str) -> None:
    right = "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)"
    result = judge_formula(model("single_pendulum"), "", f"{right} + {term}", "lagrangian")
    assert result.verdict == "wrong"
    if result.corrections:
        assert [(one.wrong, one.correct) for one in result.corrections] == [(term, "0")]


@pytest.mark.long("a very long formula")
def test_a_very_long_formula_has_a_difference_only() -> None:
    text = str(model("chain_12").derivation.lagrangian).replace("cos(theta1)", "sin(theta1)", 1)
    assert len(text) > MAX_LENGTH
    result = judged("chain_12", "lagrangian", "", text)
    assert result.corrections == ()
    assert "sin(theta1)" in result.difference
    assert len(result.difference) < 200


@pytest.mark.parametrize("error", ["1e-3", "1e-9", "1e-25"])
def test_the_values_of_a_witness_differ(error: str) -> None:
    result = judged("single_pendulum", "momenta", "theta", f"m*l**2*theta_dot*(1 + {error})")
    printed, derived = result.witness.split(" instead of ")
    assert printed != derived
    state = dict(one.split(" = ") for one in result.state.split(", "))
    assert set(state) == {"m", "l", "theta_dot"}


def test_the_witness_of_an_equation_of_motion_is_its_value_along_a_motion() -> None:
    result = judged("single_pendulum", "euler_lagrange", "", "theta_ddot = 2*g/l*sin(theta)")
    assert result.witness.endswith(" instead of 0")
    state = numbers(result.state)
    along = -state["g"] / state["l"] * mp.sin(state["theta"])
    assert abs(state["theta_ddot"] - along) < 1e-8


def numbers(state: str) -> dict[str, Any]:
    """The numbers of a state as printed."""
    pairs = (one.split(" = ") for one in state.split(", "))
    return {name: mp.fdiv(*[*number.split("/"), "1"][:2]) for name, number in pairs}


def value(text: str, state: dict[str, Any]) -> Any:
    """Left minus right side of a formula, computed with the printed numbers alone."""
    functions = {name: getattr(mp, name) for name in ("sin", "cos", "exp", "sqrt", "pi")}
    sides = [eval(side.replace("\n", " "), {**functions, **state}) for side in text.split("=")]
    return sides[0] - sum(sides[1:])


WITNESSES = {
    "names": (
        'system = "double_pendulum"\neuler_lagrange = ["(m1 + m2)*l1*theta1_ddot'
        ' + m2*l2*(a2*cos(D) + theta2_dot**2*cos(D)) = -(m1 + m2)*g*sin(theta1)"]\n'
        '[names]\nD = "theta1 - theta2"\na2 = "theta2_ddot"'
    ),
    "momenta": (
        'system = "spherical_pendulum"\nhamiltonian = "p_theta**2/(2*m*l**2)'
        ' + p_phi**2/(m*l**2*sin(theta)**2) - m*g*l*cos(theta)"'
    ),
    "multiplier": (
        'system = "chaplygin_sleigh"\neuler_lagrange = ["m*x_ddot - m*a*theta_ddot*sin(theta)'
        ' - m*a*theta_dot**2*cos(theta) = -lambda*cos(theta)", "m*y_ddot'
        ' + m*a*theta_ddot*cos(theta) - m*a*theta_dot**2*sin(theta) = lambda*cos(theta)"]'
    ),
    "rates": (
        'system = "chaplygin_sleigh"\neuler_lagrange = ["v_dot = a*theta_dot"]\n'
        '[names]\nv = "x_dot*cos(theta) + y_dot*sin(theta)"'
    ),
    "large": 'system = "chain_5"\naccelerations = { theta1 = "-g*sin(theta1)/l1" }',
    "small": (
        'system = "single_pendulum"\neuler_lagrange = '
        '["l*theta_ddot + g*sin(theta)*(1 + 1e-25*theta_dot) = 0"]'
    ),
    "switch": 'system = "single_pendulum"\npotential_energy = "-m*g*l*cos(theta + 0*t)'
    ' + exp(theta - 70)/10**9"',
}


@pytest.mark.long("more cases of the same kind", keep=2)
@pytest.mark.parametrize("name", WITNESSES)
def test_witnesses_are_computed_again_from_the_printed_numbers(name: str, tmp_path: Path) -> None:
    path = tmp_path / "hand.toml"
    path.write_text(WITNESSES[name])
    result = next(one for one in judge(path).equations if one.verdict == "wrong")
    check_witness(result)


@pytest.mark.long("many mutants")
def test_witnesses_of_mutants_are_computed_again(tmp_path: Path) -> None:
    for mutant in mutants(3, 20):
        path = tmp_path / "mutant.toml"
        path.write_text(document(mutant))
        for result in judge(path).equations:
            check_witness(result)


def check_witness(result: Verdict) -> None:
    assert result.witness
    with mp.workdps(60):
        state = numbers(result.state)
        printed, derived = map(mp.mpf, result.witness.split(" instead of "))
        digits = len(result.witness.split(" ")[0].split("e")[0].strip("-0.").replace(".", ""))
        close = 1e-5 * abs(printed - derived) + abs(printed) * mp.mpf(10) ** (1 - digits)
        text = result.printed.replace("lambda", "multiplier")
        if "lambda" in state:
            state["multiplier"] = state.pop("lambda")
        assert abs(value(text, state) - printed) < close
        if result.correction and "=" not in result.correction:
            assert abs(value(result.correction, state) - derived) < close


@pytest.mark.long("other tests reach its code")
def test_witnesses_in_documents_are_computed_again(tmp_path: Path) -> None:
    # oracle: the wrong equations by hand, left minus right
    path = tmp_path / "skate.md"
    path.write_text(
        "A skate cannot slip sideways, which is the constraint"
        r" $\dot x\sin\phi - \dot y\cos\phi = 0$."
        r" $$ L = \frac12 m (\dot x^2 + \dot y^2) + \frac12 J \dot\phi^2 $$"
        r" $$ m \ddot x = \lambda\sin\phi, \quad m \ddot y = \lambda\cos\phi $$"
    )
    (one,) = (f for f in judge_document(read_document(path)).formulas if f.verdict == "wrong")
    state = numbers(one.state)
    a, force = state[r"\ddot y"], state[r"\lambda"]
    printed = mp.mpf(one.witness.split(" instead of ")[0])
    assert abs(state["m"] * a - force * mp.cos(state[r"\phi"]) - printed) < 1e-6


SHARE = 0.95  # of the rejected mutants; none has advice that does not mend it


def campaign(seed: int, count: int, path: Path) -> list[Outcome]:
    return [outcome(mutant, path / "mutant.toml") for mutant in mutants(seed, count)]


def check(outcomes: list[Outcome]) -> None:
    rejected = [one for one in outcomes if one.verdict == "wrong"]
    mended = [one for one in rejected if one.mends]
    print(f"{len(outcomes)} mutants, {len(rejected)} rejected; the advice mends {len(mended)}")
    single = [one for one in mended if len(one.advice) == 1]
    named = [one for one in mended if one.names_mistake]
    print(f"{len(single)} have one correction; {len(named)} corrections name the mistaken part")
    for one in rejected:
        if not one.mends:
            print(one.mutant.mistake, one.mutant.text, one.advice, sep=" | ")
    print(Counter(one.mutant.mistake for one in outcomes))
    assert {one.verdict for one in outcomes} == {"wrong"}
    assert not [one for one in rejected if one.advice and not one.mends]
    assert len(mended) >= SHARE * len(rejected)


@pytest.mark.long("other tests reach its code")
def test_the_judge_of_the_campaign_accepts_the_correct_formulas() -> None:
    assert all(is_right(formula, formula.text) for formula in formulas())


@pytest.mark.long("many mutants")
@pytest.mark.slow
def test_advice_mends_mutants(tmp_path: Path) -> None:
    check(campaign(0, 25, tmp_path))


@pytest.mark.campaign
@pytest.mark.timeout(3600)
def test_advice_mends_600_mutants(tmp_path: Path) -> None:
    check(campaign(1, 600, tmp_path))


TODA = """
title = "Toda chain of unit masses"
potential = "exp(a - b) + exp(b - c)"
parameters = {}
coordinates = { a = { unit = "m" }, b = { unit = "m" }, c = { unit = "m" } }
"""
TODA += "".join(f'[[masses]]\nmass = "1"\nposition = ["{q}", "0"]\n' for q in "abc")
SETS = {
    "toda.toml": [
        "a_ddot = -exp(a - b)",
        "b_ddot = exp(a - b) - exp(b - c)",
        "c_ddot = exp(b - c)",
    ],
    "chaplygin_sleigh": ["v_dot = a*omega**2", "(J + m*a**2)*omega_dot = -m*a*v*omega"],
}
NAMES = {
    "toda.toml": "",
    "chaplygin_sleigh": '[names]\nv = "x_dot*cos(theta) + y_dot*sin(theta)"\nomega = "theta_dot"\n',
}


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(("system", "index", "slip"), [
    ("toda.toml", 0, "a_ddot = -exp(a + b)"),
    ("toda.toml", 1, "b_ddot = exp(a + b) - exp(b - c)"),
    ("toda.toml", 1, "b_ddot = -exp(-c) + exp(a - b)"),
    ("toda.toml", 1, "b_ddot = exp(a - b)"),
    ("chaplygin_sleigh", 0, "v_dot = a*omega**6"),
    ("chaplygin_sleigh", 1, "m*a**2*omega_dot = -m*a*v*omega"),
])  # fmt: skip
def test_corrections_keep_the_set_of_equations_of_motion(
    system: str, index: int, slip: str, tmp_path: Path
) -> None:
    # oracle: in its own letters, the corrected set has the solution of the correct one
    (tmp_path / "toda.toml").write_text(TODA)
    equations = [*SETS[system]]
    equations[index] = slip
    path = tmp_path / "hand.toml"
    path.write_text(f"system = '{system}'\neuler_lagrange = {equations}\n{NAMES[system]}")
    result = judge(path).equations[index]
    assert result.verdict == "wrong"
    assert result.corrections or slip.startswith("m*a")  # none is known
    for one in result.corrections:
        assert slip.count(one.wrong) == 1 or not one.wrong
        new = one.correct if one.wrong else f" + {one.correct} ="
        slip = slip.replace(one.wrong or " =", new)
        equations[index] = slip
        assert solutions(equations) == solutions(SETS[system])


def solutions(equations: list[str]) -> dict[sp.Symbol, sp.Expr]:
    """The accelerations, or rates of velocities, that equations determine."""
    words = {*re.findall(r"[A-Za-z_]+", " ".join(equations))} - {"exp"}
    names = {word: sp.Symbol(word, real=True) for word in words}
    residuals = [sp.sympify(f"({one.replace(' = ', ') - (')})", names) for one in equations]
    rates = [names[word] for word in sorted(words) if word.endswith("dot")]
    (solution,) = sp.linsolve(residuals, rates)
    return {rate: sp.simplify(value) for rate, value in zip(rates, solution, strict=True)}


def test_long_equations_of_motion_are_no_correct_form(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fractions of 1,000 operations take minutes to cancel."""
    text = "m*l**2*theta_ddot - m*g*l*sin(theta) = 0"
    assert judged("single_pendulum", "euler_lagrange", "", text).corrections
    monkeypatch.setattr(advice, "MAX_OPERATIONS", 5)
    cancelled: list[sp.Expr] = []
    monkeypatch.setattr(terms, "coefficients", lambda *one: cancelled.append(one) or {})
    monkeypatch.setattr(advice, "coefficients", lambda one, _: cancelled.append(one) or {})
    assert judged("single_pendulum", "euler_lagrange", "", text).verdict == "wrong"
    assert len(cancelled) == 0


@pytest.mark.parametrize(("most", "is_compared"), [(100, True), (5, False)])
def test_terms_of_long_fractions_by_sums_are_not_compared(
    most: int, is_compared: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """137 operations with a few such fractions take minutes to cancel."""
    x, m, a = sp.Symbol("x", real=True), *sp.symbols("m a", positive=True)
    parameters = [Parameter(m, "kg", 1, "mass"), Parameter(a, "m", 1, "distance")]
    system = System(
        "pole", "Pole", [Coordinate(x, "m", "position")], parameters,
        [PointMass(m, (x, sp.S.Zero))], potential=m * a**2 / (x + a), gravity=(0, 0),
    )  # fmt: skip
    monkeypatch.setattr(advice, "MAX_OF_FRACTIONS", most)
    model = ReferenceSystem(Derivation(system), {})
    text = "m*x_ddot + m*a**2/(x + a)**2 = 0"
    verdict = judge_formula(model, "printed", text, "euler_lagrange", "")
    assert verdict.verdict == "wrong"
    assert bool(verdict.correction or verdict.difference) == is_compared
