"""Formulas that would never end are refused at once, in system files and hand derivations."""

from pathlib import Path
from resource import RUSAGE_SELF, getrusage

import pytest
import sympy as sp

from derive import Coordinate, Parameter, PointMass, System, write
from derive.codegen.expression_graph.sympy_translation import UnsupportedFunctionError
from derive.formulas.expression import FUNCTIONS, number, parse
from derive.formulas.syntax import ExpressionError
from solvers.app.cli import main

x, k = sp.symbols("x k", real=True)
SCOPE = FUNCTIONS | {"x": x, "k": k}

SYSTEM = """
{head}
gravity = ["0", "-g"]
[coordinates]
x = {{ unit = "m" }}
[parameters]
m = {{ value = 1, unit = "kg" }}
k = {{ value = 2, unit = "1/m" }}
g = {{ value = 9.81, unit = "m/s^2" }}
[definitions]
{definitions}
[[masses]]
mass = "m"
position = ["x", "{height}"]
"""


def nested(depth: int, function: str = "sin", inner: str = "x") -> str:
    return f"{function}(" * depth + inner + ")" * depth


def chain(rule: str, length: int = 40) -> str:
    steps = (f"d{i} = '{rule.replace('D', f'd{i - 1}')}'\n" for i in range(1, length + 1))
    return "d0 = 'x'\n" + "".join(steps)


@pytest.mark.parametrize(("formula", "message"), [
    ("exp(exp(exp(100)))*x", r"exp\(exp\(100\)\) is out of range: numbers are from 1e-300 to"),
    ("exp(-exp(exp(100)))*x", "is out of range"),
    ("exp(1000)*x", r"exp\(1000\) is out of range: .*choose other units"),
    ("exp(10**30)*x", "is out of range"),
    ("exp(-1000)*x", "is out of range"),
    ("exp(-(10**30))*x", "is out of range"),
    ("exp(500)*x*exp(500)", r"exp\(1000\) is out of range"),
    ("exp(600)/exp(-600)*x", "is out of range"),
    ("exp(100)**100*x", "is out of range"),
    ("(pi**100)**100*x", "is out of range"),
    ("((x + 1)**100)**100", "exponent 10000: at most 100"),
    ("((x + k)**2 + k)**60", "exponent 120: at most 100"),
    ("(10**70*x)**50", r"10\*.* has more than 400 bits|\*\*50 has more than 400 bits"),
    (nested(13), "more than 12 functions and roots are within each other: simplify the formula"),
    (nested(13, "sqrt", "1 + x"), "more than 12 functions and roots|denominator is at most 100"),
    (nested(190), "more than 12 functions and roots|nested too deeply"),
    (nested(60, "sqrt"), "exponent 1/128: its denominator is at most 100"),
    ("1/(k + " * 25 + "x" + ")" * 25, "more than 30 levels"),
    ("*".join(f"(x + {n}*k)" for n in range(1, 60)), "second derivatives have more than"),
    ("/".join(f"(x + {n}*k)" for n in range(1, 60)), "second derivatives have more than"),
    ("+".join(f"sin({n}*x)*k" for n in range(1, 900)), "more than 5000 numbers, names and op"),
    ("*".join(["[[x, k], [k, x]]"] * 50), "is out of bounds"),
    (f"[[{'x], [' * 100}x]]*[[{'x, ' * 100}x]]", "a product of matrices has some .* operands"),
    ("sin(sqrt(-1))*x", "I is not a real number"),
    ("(1 + sqrt(-1))**(1/2)*x", "1 [+] I is not a real number"),
    (nested(20, "log", "2"), "is not a real number"),
])  # fmt: skip
def test_formulas_beyond_the_limits_are_refused(formula: str, message: str) -> None:
    with pytest.raises(ExpressionError, match=message):
        parse(formula, SCOPE)


@pytest.mark.parametrize("formula", [
    "(x + k)**100", "(x + k)**-100", "sin(x)**50*cos(x)**50", "exp(600)*x", nested(12),
    "sqrt(1234567891234567891234567891234567891234567)*x", "(1 + sqrt(2))**100*x",
    "sin(1000*x)**20", "sin(10**60*x)", "x**(1/2)**3",
])  # fmt: skip
def test_large_formulas_within_the_limits_become_code(formula: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    head = f'potential = "{formula}"'
    path.write_text(SYSTEM.format(head=head, definitions="", height="k*x**2"))
    assert main(["derive", str(path), "--output", str(tmp_path)]) == 0


@pytest.mark.parametrize(
    "rule", ["D + sin(D)", "D*(D + 1)", "D**2", "exp(D)", "1/(D + 1/D)", "(D + k)**3/(D - k)"]
)
def test_chains_of_definitions_are_refused_where_they_grow_too_large(
    rule: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(SYSTEM.format(head="", definitions=chain(rule), height="d40"))
    assert main(["derive", str(path), "--output", str(tmp_path)]) == 2
    message = capsys.readouterr().err
    assert f"{path}: definitions.d" in message
    assert "is out of bounds" in message or "is not a real number" in message


def test_all_formulas_of_a_file_share_one_budget(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = "+".join(f"sin({n}*x)" for n in range(1, 300))
    definitions = f"whole = '{whole}'\n" + "".join(f"d{n} = 'whole*{n}'\n" for n in range(1000))
    path = tmp_path / "mine.toml"
    path.write_text(SYSTEM.format(head="", definitions=definitions, height="k*x**2"))
    assert main(["derive", str(path), "--output", str(tmp_path)]) == 2
    assert "the formulas of the file have more than 100000 numbers" in capsys.readouterr().err


@pytest.mark.long("more cases of the same kind", keep=8)
@pytest.mark.parametrize("formula", [
    "(m1 + m2 + l1 + l2 + g)**30", "m1/(m1 + m2 + l1 + l2 + g)**60", nested(14, inner="theta1"),
    "exp(exp(exp(100)))*theta1", nested(190, inner="theta1"), "cos(100*theta1 + 99*theta2)**50",
])  # fmt: skip
@pytest.mark.parametrize("equation", [
    'lagrangian = "{}"', 'euler_lagrange = ["theta1_ddot*({}) = 0"]', 'hamiltonian = "{}"',
    'lagrangian = "q_ddot + q"\n[names]\nq = "{}"',
])  # fmt: skip
def test_hand_derivations_have_the_same_limits(
    formula: str, equation: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "page.toml"
    path.write_text(f'system = "double_pendulum"\n{equation.format(formula)}\n')
    assert main(["verify", str(path)]) in (1, 2)
    output = capsys.readouterr()
    assert any(word in output.out + output.err for word in ("wrong", "unreadable", "out of bounds"))
    assert getrusage(RUSAGE_SELF).ru_maxrss < 2e6  # kB


@pytest.mark.parametrize("value", [10**400, sp.exp(1000), sp.Integer(10) ** 400 * sp.pi])
def test_numbers_beyond_those_of_a_type_are_refused_in_python(
    value: sp.Expr, tmp_path: Path
) -> None:
    m = sp.Symbol("m", positive=True)
    system = System(
        name="far",
        title="",
        coordinates=[Coordinate(x, "m", "")],
        parameters=[Parameter(m, "kg", 1.0, "")],
        masses=[PointMass(m, (x, x**2))],
        potential=value * x**2,
    )
    with pytest.raises(UnsupportedFunctionError, match="number out of range: numbers are from"):
        write(system, tmp_path)


def test_equal_definitions_are_no_second_way_around_the_limit() -> None:
    inner = number(nested(10), SCOPE)
    with pytest.raises(ExpressionError, match="more than 12 functions and roots"):
        number(nested(10, inner="y"), SCOPE | {"y": inner})


@pytest.mark.parametrize(
    "rule", ["sin({}*x)", "(x + {}*k)", "sqrt(x**2 + {})", "sin(x + sin({}*x))"]
)
def test_products_of_many_formulas_are_refused_in_systems(
    rule: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.toml"
    product = "*".join(rule.format(n) for n in range(1, 14))
    path.write_text(SYSTEM.format(head="", definitions="", height=product))
    assert main(["derive", str(path), "--output", str(tmp_path)]) == 2
    assert "a product has more than 12 factors that are formulas" in capsys.readouterr().err


def test_equations_that_are_too_long_to_read_are_not_computed(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    height = "sin(" * 8 + "k*x" + " + k*x)" * 8
    for text, is_short in ((height, False), ("k*x**2", True)):
        path.write_text(SYSTEM.format(head="", definitions="", height=text))
        assert main(["derive", str(path), "--output", str(tmp_path)]) == 0
        assert ("Equations of motion:" in (tmp_path / "mine.py").read_text()) is is_short


@pytest.mark.parametrize("digits", ["1.2345678901234567e-100", "9.999999999999999e100"])
def test_decimals_of_the_whole_range_are_read(digits: str) -> None:
    assert float(number(digits, FUNCTIONS)) == float(digits)
