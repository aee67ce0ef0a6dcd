"""SymPy scripts are judged by what they state: positions, energies, equations."""

import pytest

from derive.reading.programs.program_reader import read_program
from derive.verification.documents.program_judgement import judge_program

SPRING = """
import sympy as sp
from sympy.physics.mechanics import dynamicsymbols
t = sp.symbols('t')
m, k, l0, g = sp.symbols('m k l_0 g', positive=True)
r, theta = dynamicsymbols('r theta')
rd = r.diff(t)
T = sp.Rational(1, 2)*m*(rd**2 + r**2*theta.diff(t)**2)
V = -m*g*r*sp.cos(theta) + sp.Rational(1, 2)*k*(r - l0)**2
L = T - V
radial = sp.Eq(m*sp.diff(r, t, 2), m*r*theta.diff(t)**2 + m*g*sp.cos(theta) - k*(r - l0))
angular = sp.Eq((m*r**2*theta.diff(t)).diff(t), -m*g*r*sp.sin(theta))
"""
POSITIONS = """
from sympy import *
t, m, l, g = symbols('t m l g')
a = Function('a')(t)
x, y = l*sin(a), -l*cos(a)
T = simplify(m*(diff(x, t)**2 + diff(y, t)**2)/2)
V = m*g*y
answer = solve([Eq(l*Derivative(a, (t, 2)) + g*sin(a), 0)], [a])
open('/tmp/never', 'w')
"""


def verdicts(text: str) -> list[tuple[int, str]]:
    formulas = judge_program(read_program(text, "Python")).formulas
    return [(one.line, one.verdict) for one in formulas]


@pytest.mark.parametrize(("text", "count"), [(SPRING, 5), (POSITIONS, 5)])
def test_right_statements_hold(text: str, count: int) -> None:
    found = [verdict for _, verdict in verdicts(text)]
    assert len(found) == count
    assert {*found} <= {"verified", "definition"}


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize(("text", "old", "new", "line"), [
    (SPRING, ", m*r*theta.diff", ", 2*m*r*theta.diff", 11),
    (SPRING, "-m*g*r*sp.sin", "-m*g*sp.sin", 12),
    (POSITIONS, "+ g*sin(a)", "- g*sin(a)", 8),
    (POSITIONS, "V = m*g*y", "V = 2*m*g*y", 7),
])  # fmt: skip
def test_slips_are_found(text: str, old: str, new: str, line: int) -> None:
    assert text.count(old) == 1
    wrong = [at for at, verdict in verdicts(text.replace(old, new)) if verdict == "wrong"]
    assert wrong == [line]


@pytest.mark.parametrize("text", [
    "import sympy\nx = (", "import sympy\nx = sympy.Function('x')(sympy.Symbol('t'))",
    "import sympy as s\nt = s.Symbol('t')\nx = s.Function('x')(t)\nE = s.Eq(x, 1)",
    "import sympy as s\nx = s.Function('x')(t)\nE = s.Eq(s.diff(x, t, 999999999), 1)",
    "import sympy\nx = " + "(" * 900,
])  # fmt: skip
def test_scripts_without_statements_are_silent(text: str) -> None:
    assert verdicts(text) == []
