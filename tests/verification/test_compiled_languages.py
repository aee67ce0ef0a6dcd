"""Programs in Java, Go and Rust are verified, also exported ones, and slips are found."""

from dataclasses import replace
from functools import cache

import compiled_programs as programs
import pytest

from derive import load
from derive.codegen.export.language_export import exported_text
from derive.reading.programs.program_reader import read_program
from derive.verification.documents.program_judgement import judge_program

SYSTEMS, TARGETS = ("double_pendulum", "cart_1"), ("java", "go", "rust")


def verdicts(text: str, language: str, function: str = "") -> list[tuple[int, str]]:
    """Lines and verdicts of the equations of a program, or of one of its functions."""
    program = read_program(text, language)
    chosen = tuple(one for one in program.functions if one.name.endswith(function))
    document = judge_program(replace(program, functions=chosen))
    formulas = (one for one in document.formulas if one.latex != "method of integration")
    return [(one.line, one.verdict) for one in formulas]


@cache
def exported(system: str, target: str) -> str:
    return exported_text(load(system), target, None)[1]


@pytest.mark.long("more cases of the same kind")
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("system", SYSTEMS)
def test_exported_equations_are_read_back_and_verified(system: str, target: str) -> None:
    found = verdicts(exported(system, target), target, "rhs")
    assert [verdict for _, verdict in found] == ["verified"] * 2


#: A sign of each system, which stands in all languages.
SIGNS = {"double_pendulum": ("c3*(x1 + ", "c3*(x1 - "), "cart_1": (" = -c0*(", " = c0*(")}


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("system", SYSTEMS)
def test_a_sign_in_an_exported_equation_is_wrong(system: str, target: str) -> None:
    text = exported(system, target)
    right, wrong = SIGNS[system]
    line = text[: text.index(right)].count("\n") + 1
    found = verdicts(text.replace(right, wrong, 1), target, "rhs")
    assert [verdict for _, verdict in found] == ["verified", "wrong"]
    assert found[1][0] == line


#: Language, text, and the number of equations.
PROGRAMS = {
    "fields": ("Java", programs.FIELDS, 4),  # also in the loop that calls the method
    "stages": ("Java", programs.STAGES, 2),
    "sketch": ("Processing", programs.SKETCH, 2),
    "receivers": ("Go", programs.RECEIVERS, 2),
    "closure": ("Go", programs.CLOSURE, 2),
    "pairs": ("Go", programs.PAIRS, 2),
    "methods": ("Rust", programs.METHODS, 2),
    "patterns": ("Rust", programs.PATTERNS, 2),
    "trait": ("Rust", programs.TRAIT, 2),
}
#: A part of each program, and a slip in its place.
SLIPS = {
    "fields": ("num3 = G * (m1 + m2) * Math.cos(a1)", "num3 = G * (m1 - m2) * Math.cos(a1)"),
    "stages": ("(M + m) * G", "(M - m) * G"),
    "sketch": ("- 2 * rVelocity", "- rVelocity"),
    "receivers": ("-(g*sin + a*cos)", "-(g*sin - a*cos)"),
    "closure": ("p.m2*p.l2*w2*w2*math.Sin(d)*", "p.m2*p.l1*w2*w2*math.Sin(d)*"),
    "pairs": ("2*x.vr*x.vphi", "x.vr*x.vphi"),
    "methods": ("w1 * s - G", "w1 * c - G"),
    "patterns": ("r * omega * omega", "r * omega"),
    "trait": ("-2.0 * w * p", "-w * p"),
}


@pytest.mark.long("more cases of the same kind", keep=5)
@pytest.mark.parametrize("name", PROGRAMS)
def test_right_programs_are_verified(name: str) -> None:
    language, text, count = PROGRAMS[name]
    assert not read_program(text, language).unread
    assert [verdict for _, verdict in verdicts(text, language)] == ["verified"] * count


@pytest.mark.long("slips in programs whose reading the test above shows", daily=5)
@pytest.mark.parametrize("name", SLIPS)
def test_slips_are_found(name: str) -> None:
    language, text, _ = PROGRAMS[name]
    old, new = SLIPS[name]
    assert text.count(old) == 1
    line = text[: text.index(old)].count("\n") + 1
    found = verdicts(text.replace(old, new), language)
    assert {one for one, verdict in found if verdict == "wrong"} >= {line}
