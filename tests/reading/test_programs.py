"""Equations and methods of programs follow from their text, in every language."""

import random
import re
from collections.abc import Mapping
from functools import cache

import pytest
import strange_programs as programs
import sympy as sp
from recording import Record

from derive import Derivation, load
from derive.formulas.expression import FUNCTIONS, parse
from derive.reading.programs.evaluation.counted_loops import bound
from derive.reading.programs.findings.degrees import starts_in_degrees
from derive.reading.programs.program import Finding, Program
from derive.reading.programs.program_reader import read_program
from derive.reading.programs.syntax.formula_text import cleaned
from derive.reading.programs.syntax.trees import (
    FunctionCall,
    Member,
    Name,
    NumberLiteral,
    OperatorExpression,
)


@cache
def derivation(system: str) -> Derivation:
    return Derivation(load(system))


def values(system: str, rng: random.Random) -> dict[str, sp.Expr]:
    """Numbers for all names of a system: a state, its accelerations, and parameters."""
    derived = derivation(system)
    own = derived.system
    symbols = [*own.q, *own.qdot, *(one.symbol for one in own.parameters)]
    state = {symbol: sp.Rational(rng.randint(20, 199), 100) for symbol in symbols}
    found = {symbol.name: value for symbol, value in state.items()}
    for q, acceleration in zip(own.q, derived.accelerations, strict=True):
        found[f"{q.name}_ddot"] = acceleration.subs(state).evalf(30)
    return found


def residuals(program: Program, system: str, names: Mapping[str, str]) -> list[float]:
    """Left minus right side of each equation; `names` has the formulas of its names."""
    own = values(system, random.Random(20))
    namespace = FUNCTIONS | {name: sp.sympify(value) for name, value in own.items()}
    for name, formula in names.items():
        sign = "-" if formula.startswith("-") else ""
        for order in ("", "_dot", "_ddot"):
            if not order or f"{formula.removeprefix('-')}{order}" in own:
                namespace[name + order] = parse(
                    f"{sign}{formula.removeprefix('-')}{order}", namespace
                )
    found = []
    for equation in program.equations:
        left, right = equation.text.split(" = ")
        found.append(float(abs((parse(left, namespace) - parse(right, namespace)).evalf(20))))
    return found


def kinds(program: Program, *, faults: bool = True) -> set[str]:
    return {one.kind for one in program.findings if one.is_fault or not faults}


def finding(program: Program, kind: str) -> Finding:
    return next(one for one in program.findings if one.kind == kind)


def line_of(text: str, part: str) -> int:
    return text[: text.index(part)].count("\n") + 1


ENTRIES = {"y_0": "theta1", "y_1": "theta2"}
ENTRIES_FROM_1 = {"y_1": "theta1", "y_2": "theta2"}
CASES = {
    "array of rates": (
        "Python",
        programs.ARRAY_OF_RATES,
        "double_pendulum",
        {"state_0": "theta1", "state_2": "theta2", "M1": "m1", "M2": "m2", "L1": "l1", "L2": "l2"}
        | {"G": "g"},
        2,
    ),
    "linear system": ("Python", programs.LINEAR_SYSTEM, "double_pendulum", {}, 2),
    "sketch": (
        "JavaScript",
        programs.SKETCH,
        "double_pendulum",
        {"p1": "theta1", "p2": "theta2"},
        2,
    ),
    "browser": (
        "JavaScript",
        programs.BROWSER,
        "double_pendulum",
        {"a": "theta1", "b": "theta2"},
        2,
    ),
    "typed": (
        "TypeScript",
        programs.TYPED,
        "single_pendulum",
        {"gravity": "g", "length": "l"},
        1,
    ),
    "history": ("Python", programs.HISTORY, "single_pendulum", {"L": "l"}, 1),
    "scalar steps": (
        "Python",
        programs.SCALAR_STEPS,
        "double_pendulum",
        {"t1": "theta1", "t2": "theta2"},
        2,
    ),
    "C": ("C++", programs.C_PROGRAM, "double_pendulum", ENTRIES | {"G": "g"}, 2),
    "C++": ("C++", programs.CPP_PROGRAM, "elastic_pendulum", {"mass": "m", "rest": "l"}, 2),
    "MATLAB": ("MATLAB", programs.MATLAB_PROGRAM, "double_pendulum", ENTRIES_FROM_1, 2),
    "Octave": (
        "MATLAB",
        programs.OCTAVE_PROGRAM,
        "single_pendulum",
        {"phi": "theta", "len": "l"},
        1,
    ),
    "Fortran": (
        "Fortran",
        programs.FORTRAN_PROGRAM,
        "double_pendulum",
        {"y_1": "theta1", "y_3": "theta2"},
        2,
    ),
    "fixed form": ("Fortran 77", programs.FIXED_FORM, "single_pendulum", {}, 1),
    "state with parameters": (
        "MATLAB",
        programs.STATE_WITH_PARAMETERS,
        "single_pendulum",
        {"x_1": "theta", "x_3": "g", "x_4": "l"},
        1,
    ),
    "Julia": ("Julia", programs.JULIA_PROGRAM, "double_pendulum", {}, 2),
    "macros in Julia": (
        "Julia",
        programs.JULIA_MACROS,
        "double_pendulum",
        {"th1": "theta1", "th2": "theta2"},
        2,
    ),
    "matrices in Julia": (
        "Julia",
        programs.JULIA_MATRIX,
        "double_pendulum",
        {"u_1": "theta1", "u_2": "theta2"},
        2,
    ),
    "cart": (
        "Python",
        programs.CART,
        "cart_1",
        {"M": "m0", "m": "m1", "l": "l1", "theta": "theta1"},
        2,
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_equations_agree_with_the_derived_ones(name: str) -> None:
    language, text, system, names, count = CASES[name]
    program = read_program(text, language)
    assert program.language == language
    assert not program.unread
    found = residuals(program, system, names)
    assert len(found) == count
    assert max(found) < 1e-12


@pytest.mark.parametrize("name", CASES)
def test_a_changed_sign_changes_an_equation(name: str) -> None:
    language, text, system, names, _ = CASES[name]
    wrong = re.sub(r"(?<![\w.:])((?:Math\.|np\.|math\.|std::)?)sin\(", r"2*\1sin(", text, count=1)
    assert wrong != text
    assert max(residuals(read_program(wrong, language), system, names)) > 1e-3


def test_readings_of_programs_are_as_recorded(record: Record) -> None:
    texts = {}
    for name, (language, text, *_) in CASES.items():
        one = read_program(text, language)
        parts = [*one.functions, *one.constants, *one.findings, *one.unread]
        texts[name] = "\n\n".join(map(repr, parts))
    record.check_digests(texts)


def test_a_state_can_be_separate_parameters_with_time_before_them() -> None:
    for parameters in ("x, v, k", "t, x, v, k", "t, k, x, v"):
        text = f"def f({parameters}):\n    return v, -k*x\n"
        texts = [one.text for one in read_program(text, "Python").equations]
        assert texts == ["x_ddot = -k*x"], parameters


def test_parameters_without_a_name_keep_their_place() -> None:
    text = "y = y + h*f(0, y);\nfunction d = f(~, y)\n  d = [y(2); -sin(y(1))];\nend\n"
    program = read_program(text, "MATLAB")
    assert [one.text for one in program.equations] == ["y_1_ddot = -sin(y_1)"]
    assert kinds(program, faults=False) == {"explicit_euler"}


def test_momenta_give_rates() -> None:
    program = read_program(programs.CANONICAL, "Python")
    assert [one.text for one in program.equations] == [
        "theta_dot = p/(m*l**2)",
        "p_dot = -m*g*l*sin(theta)",
    ]
    assert {one.kind for one in program.equations} == {"rate"}


def test_names_lines_and_constants_are_those_of_the_program() -> None:
    text = programs.SKETCH
    program = read_program(text, "JavaScript")
    (function,) = program.functions
    assert function.name == "draw"
    first, second = function.equations
    assert (first.coordinate, first.velocity, first.kind) == ("p1", "v1", "acceleration")
    assert first.line == line_of(text, "let acc1")
    assert second.line == line_of(text, "let acc2")
    assert function.names["v1"] == "p1_dot"
    given = {one.name: one.value for one in program.constants}
    assert given == {"l1": "150", "l2": "120", "m1": "20", "m2": "10", "g": "1"}


def test_names_of_one_function_are_not_those_of_another() -> None:
    text = """
class Model:
    def __init__(self, a, b):
        self.given = (a, b)
    def rates(self, t, y):
        b, a = self.given
        return [y[1], -a*y[0] - b*y[1]]
"""
    (function,) = read_program(text, "Python").functions
    assert function.equations[0].text == "y_0_ddot = -b*y_0 - a*y_0_dot"
    text = "struct P { double m, l, g = 9.81; };"
    (constant,) = read_program(text, "C++").constants
    assert (constant.name, constant.value) == ("g", "9.81")


def test_methods_call_those_of_their_own_class() -> None:
    text = """
double Weak::force(double x) { return -5*x; }
double Strong::force(double x) { return -3*x; }
double Strong::pull(double x) { return force(x); }
void step(double &x, double &v, double dt) { v += pull(x)*dt; x += v*dt; }
"""
    (function,) = read_program(text, "C++").functions
    assert [one.text for one in function.equations] == ["x_ddot = -3*x"]


def test_parts_of_equations_have_their_lines() -> None:
    program = read_program(programs.SKETCH, "JavaScript")
    first = program.equations[0]
    lines = {first.text[one.start : one.end]: one.line for one in first.origins}
    assert lines["-g*(2*m1 + m2)*sin(p1)"] == line_of(programs.SKETCH, "let part1")
    assert lines["2*m1 + m2 - m2*cos(2*(p1 - p2))"] == line_of(programs.SKETCH, "let below")


def test_methods_are_reported_and_no_method_that_can_be_meant_is_a_fault() -> None:
    sketch = read_program(programs.SKETCH, "JavaScript")
    assert kinds(sketch, faults=False) == {"frame_step", "damping", "semi_implicit_euler"}
    assert not kinds(sketch)
    assert finding(sketch, "semi_implicit_euler").line == line_of(programs.SKETCH, "p1 += v1")
    assert finding(sketch, "damping").line == line_of(programs.SKETCH, "v2 *= 0.999")
    browser = read_program(programs.BROWSER, "JavaScript")
    assert kinds(browser, faults=False) == {"explicit_euler", "degrees"}
    assert kinds(browser) == {"degrees"}
    assert finding(browser, "degrees").line == line_of(programs.BROWSER, "this.a = 45")
    assert kinds(read_program(programs.CART, "Python"), faults=False) == {"explicit_euler"}
    for text, language in ((programs.HISTORY, "Python"), (programs.TYPED, "TypeScript")):
        assert kinds(read_program(text, language), faults=False) == {"semi_implicit_euler"}
    library = finding(read_program(programs.ARRAY_OF_RATES, "Python"), "library")
    assert "DOP853" in library.text


def test_angles_in_degrees_are_right_where_sines_take_degrees() -> None:
    text = "let a = 90, v = 0;\nfunction draw() { v -= g*sin(a)*dt; a += v*dt; }\n"
    assert kinds(read_program(text, "JavaScript")) == {"degrees"}
    text += "function setup() { angleMode(DEGREES); }\n"
    assert not kinds(read_program(text, "JavaScript"))


@pytest.mark.parametrize(("argument", "is_fault"), [
    ("theta_deg", True), ("theta_deg*pi/180", False), ("theta_deg + theta", True),
])  # fmt: skip
def test_a_name_in_degrees_needs_a_conversion(argument: str, is_fault: bool) -> None:
    text = f"def f(t, y):\n    theta, v = y\n    return [v, -g*sin({argument})]\n"
    assert kinds(read_program("theta_deg = 45\n" + text, "Python")) == (
        {"degrees"} if is_fault else set()
    )
    page = f"let a = 45, v = 0;\nfunction draw() {{ v -= g*sin({argument})*dt; a += v*dt; }}\n"
    page = page.replace("theta_deg", "a").replace(" + theta", " + b")
    assert kinds(read_program(page, "JavaScript")) == ({"degrees"} if is_fault else set())


def test_commands_of_notebooks_are_left_out() -> None:
    text = "%matplotlib inline\n!pip install numpy\nf = lambda t, y: (y[1], -sin(y[0]))\n"
    program = read_program(text, "Python")
    assert not program.unread
    assert [(one.line, one.text) for one in program.equations] == [(3, "y_0_ddot = -sin(y_0)")]


#: A function of rates with an expression, in each language, and the values of expressions.
TEMPLATES = {
    "Python": "def f(t, y, k):\n    x, v = y\n    return [v, EXPRESSION]\n",
    "C": "void f(double *y, double *d, double k) {\n  double x = y[0];\n  d[0] = y[1];\n"
    "  d[1] = EXPRESSION;\n}",
    "MATLAB": "function d = f(t, y, k)\n  x = y(1);\n  d = [y(2); EXPRESSION];\nend",
    "Fortran": "subroutine f(t, y, k, d)\n real :: y(2), d(2), t, k, x\n x = y(1)\n d(1) = y(2)\n"
    " d(2) = EXPRESSION\nend subroutine",
    "Julia": "function f(y, k, t)\n  x, v = y\n  [v, EXPRESSION]\nend",
    "Java": "class A { double[] f(double[] y, double k) { double x = y[0];\n"
    "  return new double[] {y[1], EXPRESSION}; } }",
    "Go": "func f(y []float64, k float64) []float64 {\n  x, v := y[0], y[1]\n"
    "  return []float64{v, EXPRESSION}\n}",
    "Rust": "fn f(y: [f64; 2], k: f64) -> [f64; 2] {\n let [x, v] = y;\n [v, EXPRESSION]\n}",
}
MEANINGS = [
    ("Python", "-x**2 - -k", "-x**2 + k"),
    ("Python", "x**k**2/2*k", "x**k**2/2*k"),
    ("Python", "x^2", ""),  # exclusive or
    ("C", "1/2*x", "0*x"),  # the quotient of whole numbers
    ("C", "1.0f/2*x - 7/2*k", "1.0/2*x - 3*k"),
    ("C", "x^2", ""),
    ("C", "tau - x", "tau - x"),  # a torque
    ("Python", "math.tau*x", "2*pi*x"),
    ("MATLAB", "-x^2 + k", "-x**2 + k"),
    ("MATLAB", "x^k^2", "(x**k)**2"),
    ("MATLAB", "k*sind(x')", "k*sin(x*(pi/180))"),
    ("Fortran", "-x**k**2", "-x**k**2"),
    ("Fortran", "x**(1/2)*1.5d0", "x**0*1.5e0"),
    ("Julia", "-x^2 + 2x^2", "-x**2 + 2*x**2"),
    ("Julia", "-3x^2k^2", "-3*x**(2*k)**2"),
    ("Julia", "1/2k*x", "1/(2*k)*x"),
    ("Julia", "3(x + k)", "3*(x + k)"),
    ("Julia", "k + 3*(x + k)", "k + 3*(x + k)"),  # the grammar reads *(x + k)
    ("MATLAB", "k*cot(x)", "k*(cos(x)/sin(x))"),
    ("MATLAB", "sec(x)/csc(k)", "1/cos(x)/(1/sin(k))"),
    ("Java", "1/2*x - (float) (k*Math.pow(x, 2))", "0*x - k*x**2"),
    ("Java", "k*Math.sin(Math.toRadians(x))/1.5e1d", "k*sin(x*(pi/180))/1.5e1"),
    ("Java", "x^2", ""),
    ("Java", "k > 0 ? x : k", ""),
    ("Processing", "-k*sq(x) + HALF_PI*float(2)", "-k*x**2 + 0.5*pi*2"),
    ("Go", "float64(1)/2*x - k*math.Pow(x, 2)", "1/2*x - k*x**2"),
    ("Go", "1/2*x + math.Pi*k", "0*x + pi*k"),
    ("Go", "x^2", ""),
    ("Go", "-k*math.Sqrt(math.Exp(x)) + 0x10", ""),
    ("Rust", "-x.powi(2) - k as f64", "-x**2 - k"),
    ("Rust", "-(x + k).sin().powf(1.5_f64)", "-sin(x + k)**1.5"),
    ("Rust", "k*f64::ln(x) + 2f64*x.sqrt()", "k*log(x) + 2*sqrt(x)"),
    ("Rust", "(2.0*x).mul_add(k, 1.0) - x.recip()", "2.0*x*k + 1.0 - 1/x"),
    ("Rust", "std::f64::consts::PI*x + 1_000.0", "pi*x + 1000.0"),
    ("Rust", "if k > 0.0 { x } else { k }", ""),
    ("Rust", "x.atan2(k)", ""),
    ("Rust", "x*(1/2) as f64", "x*0"),
    ("Rust", "x^2", ""),
]


@pytest.mark.parametrize(("language", "expression", "meaning"), MEANINGS)
def test_expressions_have_the_meaning_of_their_language(
    language: str, expression: str, meaning: str
) -> None:
    template = TEMPLATES["Java" if language == "Processing" else language]
    program = read_program(template.replace("EXPRESSION", expression), language)
    assert [one.text for one in program.equations] == [f"x_ddot = {meaning}"] * bool(meaning)
    assert bool(program.unread) != bool(meaning)


def test_methods_are_found_in_all_languages() -> None:
    for text, language in ((programs.C_PROGRAM, "C"), (programs.FORTRAN_PROGRAM, "Fortran")):
        assert "order 4" in finding(read_program(text, language), "runge_kutta").text
        wrong = read_program(text.replace("2*k3", "k3"), language)
        assert finding(wrong, "runge_kutta").is_fault
    arrays = programs.ARRAY_STEPS
    assert "order 4" in finding(read_program(arrays, "JavaScript"), "runge_kutta").text
    wrong = arrays.replace("moved(y, k3, h)", "moved(y, k2, h)")
    assert finding(read_program(wrong, "JavaScript"), "runge_kutta").is_fault
    matlab = read_program(programs.MATLAB_PROGRAM, "MATLAB")
    assert kinds(matlab, faults=False) == {"library", "degrees"}
    assert finding(matlab, "degrees").line == line_of(programs.MATLAB_PROGRAM, "y0 = [30")
    julia = read_program(programs.JULIA_PROGRAM, "Julia")
    assert kinds(julia, faults=False) == {"library", "degrees"}
    assert "120" in finding(julia, "degrees").text
    octave = read_program(programs.OCTAVE_PROGRAM, "octave")
    assert kinds(octave, faults=False) == {"explicit_euler"}
    cpp = read_program(programs.CPP_PROGRAM, "C++")
    assert kinds(cpp, faults=False) == {"semi_implicit_euler"}


def test_parts_that_are_not_followed_are_reported_and_never_guessed() -> None:
    text = programs.UNREADABLE
    program = read_program(text, "Python")
    assert not program.equations
    reasons = {one.function: (one.line, one.reason) for one in program.unread}
    assert reasons["chain"] == (line_of(text, "for i in"), "a loop is not followed")
    assert reasons["table"][1] == "the function lookup is not followed"
    assert reasons["early"] == (line_of(text, "if y[0]"), "the value depends on a condition")
    assert "is not understood" in reasons["broken"][1]
    assert reasons["verlet"][1] == "the update of x has the acceleration a of another step"


def test_a_member_whose_value_is_missing_is_reported() -> None:
    text = (
        "class A {\n k = VALUE;\n step(h) { this.v -= this.k*this.x*h; this.x += this.v*h; }\n}\n"
    )
    missing = read_program(text.replace("VALUE", "-"), "JavaScript")
    assert not missing.equations
    assert [one.reason for one in missing.unread] == ["line 2: '' is not followed"]
    unclosed = read_program(text.replace("VALUE", "(2"), "JavaScript")
    assert [(one.name, one.value) for one in unclosed.constants] == [("this.k", "2")]


def test_conditions_on_the_method_give_both_methods_and_those_on_formulas_none() -> None:
    program = read_program(programs.CONDITIONAL, "Python")
    assert [one.text for one in program.equations] == ["x_ddot = (kick - k*x)/m"]
    found = {one.kind: one.line for one in program.findings}
    text = programs.CONDITIONAL
    assert found["explicit_euler"] == line_of(text, "x = x + self.h*v")
    assert found["semi_implicit_euler"] > found["explicit_euler"]
    (unread,) = program.unread
    assert unread.function == "Model.other"
    assert "conditional" in unread.reason


def test_accelerations_with_values_after_the_step_are_reported() -> None:
    program = read_program(programs.MIXED, "JavaScript")
    mixed = finding(program, "mixed_update")
    assert mixed.text == "the acceleration for w2 uses values after the step: w1"
    assert mixed.line == line_of(programs.MIXED, "w2 +=")
    assert not mixed.is_fault  # a consistent step of the first order
    assert [one.text for one in program.equations] == [
        "t1_ddot = -sin(t1) - k*t2_dot",
        "t2_ddot = -sin(t2) - k*t1_dot",
    ]


def test_coefficients_of_runge_kutta_methods_are_checked() -> None:
    right = finding(read_program(programs.LINEAR_SYSTEM, "Python"), "runge_kutta")
    assert "4 stages and order 4" in right.text
    assert not right.is_fault
    for old, new in (("h / 6", "h / 5"), ("2 * k3", "k3"), ("h / 2 * k2", "h * k2")):
        text = programs.LINEAR_SYSTEM.replace(old, new)
        wrong = finding(read_program(text, "Python"), "runge_kutta")
        assert wrong.is_fault, new
        assert "order 4 is possible" in wrong.text


#: The methods of Kutta of order 3, in two ways to write a stage, and of Gill of order 4.
KUTTA = """
def step(f, y, h):
    k1 = f(y)
    k2 = f(y + h/2*k1)
    k3 = f(y + h*(2*k2 - k1))
    return y + h/6*(k1 + 4*k2 + k3)
"""
GILL = """
def step(f, y, h):
    k1 = f(y)
    k2 = f(y + h/2*k1)
    k3 = f(y + h*((sqrt(2) - 1)/2*k1 + (1 - sqrt(2)/2)*k2))
    k4 = f(y + h*(-sqrt(2)/2*k2 + (1 + sqrt(2)/2)*k3))
    return y + h/6*(k1 + (2 - sqrt(2))*k2 + (2 + sqrt(2))*k3 + k4)
"""


@pytest.mark.parametrize(("text", "order"), [
    (KUTTA, 3), (KUTTA.replace("2*k2 - k1", "-k1 + 2*k2"), 3), (GILL, 4),
])  # fmt: skip
def test_methods_with_negative_and_irrational_coefficients_have_their_order(
    text: str, order: int
) -> None:
    found = finding(read_program(text, "Python"), "runge_kutta")
    assert f"order {order} is written out" in found.text
    assert not found.is_fault


def test_wrong_weights_have_order_0_also_beside_a_wrong_stage() -> None:
    text = """
def step(f, x, v, h):
    k1 = f(x, v)
    k2 = f(x + h/2*k1, v + h/2*k1)
    k3 = f(x + h/2*k2, v + h/2*k2)
    k4 = f(x + h*k3, v + h*k2)
    return v + h/6*k1 + 2*k2 + 2*k3 + k4
"""
    wrong = finding(read_program(text, "Python"), "runge_kutta")
    assert wrong.is_fault
    assert "order 0 is written out: weights 0.1667, 2, 2, 1" in wrong.text


def test_a_method_may_return_the_state_after_a_step() -> None:
    text = "def step(f, y, h):\n    k1 = f(y)\n    k2 = f(y + h/2*k1)\n    return y + h*k2\n"
    right = finding(read_program(text, "Python"), "runge_kutta")
    assert "2 stages and order 2" in right.text
    assert not right.is_fault
    wrong = finding(read_program(text.replace("h/2", "h"), "Python"), "runge_kutta")
    assert wrong.is_fault


#: Programs in the forms of Julia, and their equations.
OF_JULIA = {
    "the value of the last assignment": (
        "function f(x, u)\n  q, v = x\n  out = [v; 2*(u - q)]\nend\n",
        ["q_ddot = 2*(u - q)"],
    ),
    "a function that is returned": (
        "function f(p, ::Free)\n  (; m, k) = p\n  return function (x, _)\n    q, v = x\n"
        "    return [v, -k/m*q]\n  end\nend\n",
        ["q_ddot = -k/m*q"],
    ),
    "a minus before a bracket": (
        "function f(y, k)\n  [y[2], c*y[2] + -(k*y[1])]\nend\n",
        ["y_1_ddot = c*y_1_dot - k*y_1"],
    ),
    "macros, views and signs in rows": (
        "H(p, x) = @SMatrix [\n  p.M p.m*cos(x[2])\n  p.m*cos(x[2]) p.J\n]\n"
        "function f(p, y, u)\n  C = @SMatrix [0 -p.m*y[4]*sin(y[2]); 0 0]\n  B = [1.0, 0.0]\n"
        "  a = SVector{2}(-H(p, y)\\(C*view(y, 3:4) - B*u))\n"
        "  return @SVector [y[3], y[4], a[1], a[2]]\nend\n",
        [
            "-M*y_1_ddot - m*cos(y_2)*y_2_ddot = 0*y_1_dot - m*y_2_dot*sin(y_2)*y_2_dot - 1.0*u",
            "-m*cos(y_2)*y_1_ddot - J*y_2_ddot = 0*y_1_dot + 0*y_2_dot - 0.0*u",
        ],
    ),
}


@pytest.mark.parametrize("name", OF_JULIA)
def test_forms_of_julia_are_followed(name: str) -> None:
    text, equations = OF_JULIA[name]
    program = read_program(text, "Julia")
    assert [one.text for one in program.equations] == equations
    assert not program.unread


#: Programs in the forms of Python, and their equations.
OF_PYTHON = {
    "a row as a column": (
        "def f(t, y):\n    s = np.array([[a, b], [c, d]]) @ np.array([[y[0], y[1]]]).T\n"
        "    return [y[2], y[3], s[0], s[1]]\n",
        ["y_0_ddot = a*y_0 + b*y_1", "y_1_ddot = c*y_0 + d*y_1"],
    ),
    "a matrix with rows and columns exchanged, twice": (
        "def f(t, y):\n    A = np.array([[a, b], [c, d]])\n    x = np.array([y[0], y[1]])\n"
        "    s, r = A.T @ x, A.transpose() @ x\n    return [y[2], y[3], s[0], r[1]]\n",
        ["y_0_ddot = a*y_0 + c*y_1", "y_1_ddot = b*y_0 + d*y_1"],
    ),
    "the inverse of a matrix": (
        "def f(t, y):\n    q, w, dq, dw = y\n    M = np.array([[m, c], [c, n]])\n"
        "    a = np.linalg.inv(M) @ np.array([-k*q, -s*w])\n    return [dq, dw, a[0], a[1]]\n",
        ["m*q_ddot + c*w_ddot = -k*q", "c*q_ddot + n*w_ddot = -s*w"],
    ),
    "the sum of an array as its method": (
        "def f(t, y):\n    x, v = y\n    F = np.array([-k*x, -c*v])\n    return [v, F.sum()/m]\n",
        ["x_ddot = (-k*x - c*x_dot)/m"],
    ),
    "the product of columns as a method": (
        "def f(t, y):\n    x, v = y\n    F = np.array([k, c])\n"
        "    return [v, -F.dot(np.array([x, v]))]\n",
        ["x_ddot = -(k*x + c*x_dot)"],
    ),
    "a column in another shape": (
        "def f(t, y):\n    q, w, dq, dw = y\n    a = np.array([-k*q, -s*w]).reshape(2, 1)\n"
        "    return [dq, dw, a[0], a[1]]\n",
        ["q_ddot = -k*q", "w_ddot = -s*w"],
    ),
    "rows as a column": (
        "def f(t, y):\n    q, w, dq, dw = y\n    a = np.array([[-k*q], [-s*w]]).reshape(-1)\n"
        "    return [dq, dw, a[0], a[1]]\n",
        ["q_ddot = -k*q", "w_ddot = -s*w"],
    ),
    "the last entry": (
        "def f(t, y):\n    x, v = y\n    a = [k*x, c*x]\n    return [v, -a[-1]]\n",
        ["x_ddot = -c*x"],
    ),
    "all entries but the first": (
        "def f(t, y):\n    x, v = y\n    a = [m, k*x, c*v]\n    b = a[1:]\n"
        "    return [v, -b[0] - b[1]]\n",
        ["x_ddot = -k*x - c*x_dot"],
    ),
    "an argument by its name": (
        "def force(x, s=1.0):\n    return -s*x\n"
        "def f(t, y):\n    x, v = y\n    return [v, force(x, s=k/m)]\n",
        ["x_ddot = -k/m*x"],
    ),
    "one value for two names": (
        "def f(t, y):\n    x, v = y\n    a = b = -k*x\n    return [v, a/m + b]\n",
        ["x_ddot = -k*x/m - k*x"],
    ),
    "values by their names in quotes": (
        "def step(s, dt):\n    s['v'] += -k*s['x']*dt\n    s['x'] += s['v']*dt\n",
        ["x_ddot = -k*x"],
    ),
    "masses from an index on, of two bodies for any number": (
        "def f(t, y, n, m):\n    d = np.zeros(2*n)\n    for i in range(n):\n"
        "        d[i] = y[n+i]\n        d[n+i] = -g*np.sum(m[i:])*np.sin(y[i])\n    return d\n",
        ["y_0_ddot = -g*(m_0 + m_1)*sin(y_0)", "y_1_ddot = -g*m_1*sin(y_1)"],
    ),
}


@pytest.mark.parametrize("name", OF_PYTHON)
def test_forms_of_python_are_followed(name: str) -> None:
    text, equations = OF_PYTHON[name]
    program = read_program(text, "Python")
    assert [one.text for one in program.equations] == equations
    assert not program.unread


def test_a_column_as_a_row_is_not_followed() -> None:
    text = (
        "def f(t, y):\n    a = np.array([-k*y[0], -c*y[1]]).reshape(1, 2)\n"
        "    return [y[2], y[3], a[0], a[1]]\n"
    )
    program = read_program(text, "Python")
    assert not program.equations
    assert [one.reason for one in program.unread] == ["another shape is not followed"]


def test_arrays_of_unknown_length_are_not_followed() -> None:
    text = (
        "def f(t, q, w):\n    a = np.array([-k*q[0], -c*q[1]])\n    return np.concatenate([w, a])\n"
    )
    program = read_program(text, "Python")
    assert not program.equations


def test_nothing_follows_two_branches_that_return() -> None:
    text = """
def step(x, v, h):
    if x > 0:
        return x
    else:
        return v
    v += -k*x*h
    x += v*h
"""
    assert not read_program(text, "Python").equations


#: Programs in the forms of other compiled languages, and their equations.
COMPILED = {
    "a new object has fields of its own": (
        "Java",
        "class S { double x, v; S(double a, double b) { x = a; v = b; }\n"
        " void step(double k, double h) { S old = new S(0, 1); v -= h*k*x; x += h*v; } }",
        ["x_ddot = -k*x"],
    ),
    "a member and a variable of one name": (
        "Java",
        "class S { double x, v, w; void step(double h) { double v = this.v;\n"
        " this.v = v - h*k*x; this.w = w - h*v*w; x += h*v; } }",
        [],
    ),
    "a method without a body is none": (
        "Java",
        "interface F { double of(double x); }\nclass G implements F {\n"
        " public double of(double x) { return -3*x; }\n"
        " void step(double h) { v += h*of(x); x += h*v; } }",
        ["x_ddot = -3*x"],
    ),
    "a function that is not known fills an array": (
        "Java",
        "class A { double[] f(double[] y) {\n"
        " double[] a = new double[1], d = new double[2];\n force.at(y, a);\n"
        " d[0] = y[1]; d[1] = -y[0] + a[0]; return d; } }",
        [],
    ),
    "the second arm of a condition": (
        "Java",
        "class A { void step(double h) {\n if (x > 9) { return; }\n"
        " else { v -= h*k*x; x += h*v; } } }",
        ["x_ddot = -k*x"],
    ),
    "a method that returns an entry": (
        "Java",
        "class A { double[] f(List<Double> y) {\n return new double[] {y.get(1), -k*y.get(0)}; } }",
        ["y_0_ddot = -k*y_0"],
    ),
    "an index that goes back by one": (
        "C",
        "void f(double *y, double *d) { int i = 1; d[0] = y[i]; i--; d[1] = -k*y[i]; }",
        ["y_0_ddot = -k*y_0"],
    ),
    "the difference of two numbers as an index": (
        "C",
        "void f(double *y, double *d) { d[0] = y[4 - 3]; d[1] = -k*y[4 - 4]; }",
        ["y_0_ddot = -k*y_0"],
    ),
    "the inverse of a matrix of Eigen": (
        "C++",
        "void f(const double *y, double *d) {\n Matrix2d M; M << m, c, c, n;\n"
        " Vector2d F(-k*y[0], -s*y[1]), a = M.inverse()*F;\n"
        " d[0] = y[2]; d[1] = y[3]; d[2] = a(0); d[3] = a(1); }",
        ["m*y_0_ddot + c*y_1_ddot = -k*y_0", "c*y_0_ddot + n*y_1_ddot = -s*y_1"],
    ),
    "a loop over entries in round brackets": (
        "Fortran",
        "subroutine f(n, x, v, h)\n integer :: n, i\n real :: x(n), v(n), a(n), h\n"
        " do i = 1, n\n  a(i) = -k*x(i)\n end do\n v = v + h*a\n x = x + h*v\nend subroutine\n",
        ["x_ddot = -k*x"],
    ),
    "statements behind a return": (
        "Fortran",
        "subroutine f(y, d)\n real :: y(2), d(2)\n d(1) = y(2)\n d(2) = -k*y(1)\n"
        " return\n d(2) = 0\nend subroutine\n",
        ["y_1_ddot = -k*y_1"],
    ),
    "a function with a variable for its result": (
        "Fortran",
        "function force(x) result(r)\n real :: x, r\n r = -k*x\n return\nend function\n"
        "subroutine f(y, d)\n real :: y(2), d(2)\n d(1) = y(2)\n d(2) = force(y(1))\n"
        "end subroutine\n",
        ["y_1_ddot = -k*y_1"],
    ),
    "a function that is its own result": (
        "Fortran",
        "real function force(x)\n real :: x\n force = -k*x\n return\nend function\n"
        "subroutine f(y, d)\n real :: y(2), d(2)\n d(1) = y(2)\n d(2) = force(y(1))\n"
        "end subroutine\n",
        ["y_1_ddot = -k*y_1"],
    ),
    "a function with a statement behind its result": (
        "Fortran",
        "real function force(x)\n real :: x, n\n force = -k*x\n n = n + 1\nend function\n"
        "subroutine f(y, d)\n real :: y(2), d(2)\n d(1) = y(2)\n d(2) = force(y(1))\n"
        "end subroutine\n",
        ["y_1_ddot = -k*y_1"],
    ),
    "slices with one bound": (
        "Go",
        "func f(y []float64) []float64 {\n q, w := y[:2], y[2:]\n"
        " return []float64{w[0], w[1], -k*q[0], -c*q[1]}\n}",
        ["y_0_ddot = -k*y_0", "y_1_ddot = -c*y_1"],
    ),
    "a copy of a slice": (
        "Go",
        "func f(y []float64) []float64 {\n z := make([]float64, 2)\n copy(z, y)\n"
        " return []float64{y[1], -k * z[0]}\n}",
        ["y_0_ddot = -k*y_0"],
    ),
    "results with names": (
        "Go",
        "func f(x, v float64) (dx, dv float64) {\n dx, dv = v, -k*x\n return\n}",
        ["x_ddot = -k*x"],
    ),
    "a declaration before a condition": (
        "Go",
        "func (s *S) step(h float64) {\n"
        " if a := -k * s.x; h > 0 {\n  s.v += h * a\n  s.x += h * s.v\n }\n}",
        ["x_ddot = -k*x"],
    ),
    "variables of one declaration": (
        "Go",
        "var v, x float64\nfunc step(h float64) {\n v -= h*k*x\n x += h*v\n}",
        ["x_ddot = -k*x"],
    ),
    "a statement with no value at the end": (
        "Rust",
        "fn step(s: &mut S, h: f64) { s.v -= h*k*s.x; s.x += h*s.v; }",
        ["x_ddot = -k*x"],
    ),
    "patterns of a caller and a called function": (
        "Rust",
        "fn g(y: &[f64; 2]) -> f64 { let (a, b) = (y[0], 2.0); a*b }\n"
        "fn f(y: &[f64; 2]) -> [f64; 2] { let [a, b] = [3.0, k]; [y[1], -a*b*g(y)] }",
        ["y_0_ddot = -a*k*(y_0*b)"],
    ),
    "the pattern of a reference": (
        "Rust",
        "fn f(&[x, v]: &[f64; 2]) -> [f64; 2] { [v, -k*x] }",
        ["x_ddot = -k*x"],
    ),
    "functions of a type": (
        "Rust",
        "struct A; impl A { fn force(&self, x: f64) -> f64 { -5.0*x } }\n"
        "struct B; impl B { fn force(&self, x: f64) -> f64 { -3.0*x }\n"
        " fn rates(&self, y: [f64; 2]) -> [f64; 2] { [y[1], Self::force(self, y[0])] } }",
        ["y_0_ddot = -3.0*y_0"],
    ),
    "several variables of a loop": (
        "Rust",
        "fn f(y: &[f64], d: &mut [f64]) { for (i, v) in y.iter().enumerate() { d[i] = -k*v; } }",
        [],
    ),
}


@pytest.mark.parametrize("name", COMPILED)
def test_forms_of_compiled_languages_are_followed_or_left_out(name: str) -> None:
    language, text, equations = COMPILED[name]
    assert [one.text for one in read_program(text, language).equations] == equations


def test_a_copy_of_an_array_is_another_array() -> None:
    text = """
function rates(s, k)
    ds = copy(s)
    ds[1] = s[2]
    ds[2] = -k*s[1]
    return ds
end
function step(y, h, k)
    a = rates(y, k)
    b = rates(y + h*a, k)
    y += h/2*(a + b)
end
"""
    assert [one.text for one in read_program(text, "Julia").equations] == ["s_1_ddot = -k*s_1"]


def test_solutions_can_be_columns_and_cyclic_coordinates_can_occur_in_no_rate() -> None:
    text = """
for i in range(n - 1):
    x[i+1] = x[i] + v[i]*dt
    y[i+1] = y[i] + w[i]*dt
    s = np.linalg.solve(np.array([[m, c], [c, k]]), np.array([[-x[i]], [-y[i]]]))
    v[i+1] = v[i] + s[0][0]*dt
    w[i+1] = w[i] + s[1][0]*dt
"""
    found = [one.text for one in read_program(text, "Python").equations]
    assert found == ["m*x_ddot + c*y_ddot = -x", "c*x_ddot + k*y_ddot = -y"]
    text = """
def rates(t, y):
    r, p_r, phi, p_phi = y
    return np.array([p_r/m, p_phi**2/(m*r**3) - k*r, p_phi/(m*r**2), 0])
"""
    found = [one.text for one in read_program(text, "Python").equations]
    assert found == [
        "r_dot = p_r/m",
        "p_r_dot = p_phi**2/(m*r**3) - k*r",
        "phi_dot = p_phi/(m*r**2)",
        "p_phi_dot = 0",
    ]


def test_declared_variables_of_a_called_function_are_not_those_of_its_caller() -> None:
    text = """
double force(double x) { double b = 2; return b*x; }
void f(double *y, double *d) { double b = k; d[0] = y[1]; d[1] = -b*force(y[0]); }
"""
    assert [one.text for one in read_program(text, "C").equations] == ["y_0_ddot = -k*(b*y_0)"]
    text = """
function force(x) { const [a, b] = [x, x*x]; return b; }
function f(t, y) { const b = k*y[0], p = force(y[0]); return [y[1], -b - p]; }
"""
    found = [one.text for one in read_program(text, "JavaScript").equations]
    assert found == ["y_0_ddot = -k*y_0 - y_0*y_0"]


COMPONENTS = """
const int D = 2;
double pull(double q[D], int i) { return -k*q[i]/pow(q[0]*q[0] + q[1]*q[1], 1.5); }
void step(double h, double (&q)[D], double (&p)[D]) {
    for (int i = 0; i < D; ++i) p[i] = p[i] + h*pull(q, i);
    for (int i = 0; i < D; ++i) q[i] = q[i] + h*p[i];
}
"""


def test_loops_over_components_of_vectors_are_followed_and_those_over_steps_are_not() -> None:
    program = read_program(COMPONENTS, "C++")
    assert [one.text for one in program.equations] == [
        f"q_{i}_ddot = -k*q_{i}/(q_0*q_0 + q_1*q_1)**1.5" for i in (0, 1)
    ]
    text = "function draw() {\n for (let i = 0; i < 2; i++) { v -= k*x*dt; x += v*dt; }\n}\n"
    assert [one.text for one in read_program(text, "JavaScript").equations] == ["x_ddot = -k*x"]


SCALAR_STAGES = """
double rate(double t, double x, double v) { return v; }
double force(double t, double x, double v) { return -k/m*x; }
void step(double *t, double *x, double *v) {
    double h = 100.0/n;
    k1 = rate(*t, *x, *v);
    j1 = force(*t, *x, *v);
    k2 = rate(*t + h, *x + h*k1, *v + h*j1);
    j2 = force(*t + h, *x + h*k1, *v + h*j1);
    *x = *x + h/2*(k1 + k2);
    *v = *v + h/2*(j1 + j2);
}
"""


def test_stages_of_one_variable_each_give_equations_for_any_step_size() -> None:
    program = read_program(SCALAR_STAGES, "C")
    assert [one.text for one in program.equations] == ["x_ddot = -k/m*x"]
    assert not finding(program, "runge_kutta").is_fault
    wrong = read_program(SCALAR_STAGES.replace("h/2*(j1", "h/2*(3*j1"), "C")
    assert any(one.is_fault for one in wrong.findings if one.kind == "runge_kutta")


@pytest.mark.parametrize(
    ("name", "identifier"),
    [("θ₁", "theta1"), ("Θ", "Theta"), ("ϼ", "rho"), ("x\u0307", "x_dot"), ("x\u0308", "x_ddot")],
)
def test_names_of_programs_become_identifiers(name: str, identifier: str) -> None:
    assert cleaned(name) == identifier


def test_a_start_in_degrees_is_found_through_names_of_names() -> None:
    values = {"start": Name(2, "initial"), "initial": NumberLiteral(1, "120")}
    (found,) = starts_in_degrees("theta", Name(3, "start"), values, "main")
    assert "theta starts at 120" in found.text
    assert not [*starts_in_degrees("theta", Name(3, "other"), values, "main")]


def test_lengths_of_one_array_are_one_bound_in_every_language() -> None:
    y, one = Name(0, "y"), NumberLiteral(0, "1")
    lengths = [
        *(FunctionCall(0, Name(0, name), (y,)) for name in ("len", "length", "numel", "size")),
        *(FunctionCall(0, Member(0, y, name), ()) for name in ("size", "length")),
        *(Member(0, y, name) for name in ("length", "size")),
    ]
    for tree in lengths:
        assert bound(tree) == bound(OperatorExpression(0, "+", (tree, one))) == "len(y)"
    assert bound(y) == "y"
    assert bound(NumberLiteral(0, "4")) == "4"
    for other in (FunctionCall(0, Name(0, "sum"), (y,)), FunctionCall(0, Member(0, y, "sum"), ())):
        assert bound(other) != "len(y)"
