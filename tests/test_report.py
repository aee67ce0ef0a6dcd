"""The report's equations: all are there, each verdict is earned, and mistakes are caught."""

import ast
import re
from collections import Counter
from collections.abc import Iterator

import pytest

from derive.formulas.expression import ExpressionError
from derive.verification.report.equation import Equation, Stated
from derive.verification.report.judgement import EQUATIONS, judged, named, verdict
from derive.verification.report.programs import programs
from derive.verification.statement import RELATION
from solvers.runge_kutta.order_conditions import order

JUDGED = [equation for equation in EQUATIONS if isinstance(equation, Equation)]

#: Found by reading the report beside a textbook, before anything was computed.
MISPRINTS = {
    "eq9", "eq13", "eq27", "eq28", "eq29", "eq32", "eq64", "eq65", "eq69", "eq71", "eq78", "eq79",
    "eq81", "A10", "eq97", "eq98", "eq105", "eq106", "A15", "A16", "eq114", "eq117", "eq119",
}  # fmt: skip


def test_every_numbered_equation_and_every_display_of_appendix_a_is_judged_once() -> None:
    ids = [equation.id for equation in EQUATIONS]
    assert [i for i in ids if i.startswith("eq")] == [f"eq{n}" for n in range(1, 129)]
    assert sorted(i for i in ids if i.startswith("A")) == sorted(f"A{n}" for n in range(1, 23))


@pytest.mark.parametrize("equation", EQUATIONS, ids=lambda equation: equation.id)
def test_the_verdict_is_what_a_careful_reader_finds(equation: Equation | Stated) -> None:
    found = verdict(equation, order)
    if isinstance(equation, Stated):
        assert found.verdict in ("definition", "context")
        assert found.note
    elif equation.id in MISPRINTS:
        assert found.verdict == "misprint"
        assert found.correction
        assert found.residual not in ("", "0")
        assert abs(float(found.witness)) > 1e-6
    else:
        assert found.verdict == "verified"
        assert not equation.corrected


def test_only_definitions_and_other_subjects_are_not_computed() -> None:
    assert Counter(e.verdict for e in EQUATIONS if isinstance(e, Stated)) == {
        "definition": 6,
        "context": 2,
    }


def mutants(text: str) -> Iterator[str]:
    """`text` with one planted mistake: a sign, an index, a power, a function or a number."""
    for part_number, part in enumerate(parts := text.split(";")):
        pieces = RELATION.split(part)
        for place in range(0, len(pieces), 2):
            bound = len(pieces) > 1 and re.fullmatch(r"\s*\d+\s*", pieces[place])
            if bound and pieces[place - 1] != "=":
                continue  # a looser bound is no mistake
            if place == 0:
                negative = f"-({pieces[0].strip()}) {''.join(pieces[1:])}"
                yield ";".join([*parts[:part_number], negative, *parts[part_number + 1 :]])
            count = sum(1 for _ in sites(ast.parse(pieces[place].strip(), mode="eval")))
            for k in range(count):
                tree = ast.parse(pieces[place].strip(), mode="eval")
                list(sites(tree))[k]()
                changed = [*pieces[:place], f" {ast.unparse(tree)} ", *pieces[place + 1 :]]
                yield ";".join([*parts[:part_number], "".join(changed), *parts[part_number + 1 :]])


def sites(tree: ast.AST) -> Iterator["Plant"]:
    symbols_only = {
        id(argument)
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
        for argument in (node.args[1:] if node.func.id in ("d", "only", "at") else [])
    }
    functions = {id(node.func) for node in ast.walk(tree) if isinstance(node, ast.Call)}
    for parent in ast.walk(tree):
        for field, value in ast.iter_fields(parent):
            for index, node in enumerate(value if isinstance(value, list) else [value]):
                place = Plant(parent, field, index if isinstance(value, list) else None)
                match node:
                    case ast.BinOp(op=ast.Add()):
                        yield place.of(ast.BinOp(node.left, ast.Sub(), node.right))
                    case ast.BinOp(op=ast.Sub()):
                        yield place.of(ast.BinOp(node.left, ast.Add(), node.right))
                    case ast.BinOp(op=ast.Pow()):
                        yield place.of(node.left)
                    case ast.UnaryOp():
                        yield place.of(node.operand)
                    case ast.Name(id="sin" | "cos" as name) if id(node) in functions:
                        yield place.of(ast.Name("cos" if name == "sin" else "sin"))
                    case ast.Name(id=name) if id(node) not in functions:
                        other = re.sub(r"[12](?=_|$)", lambda m: str(3 - int(m.group())), name)
                        if other != name:
                            yield place.of(ast.Name(other))
                        if id(node) not in symbols_only and not name.endswith(("_i", "_vector")):
                            yield place.of(ast.BinOp(node, ast.Pow(), ast.Constant(2)))
                    case ast.Constant(value=int() as number):
                        yield place.of(ast.Constant(number + 1))


class Plant:
    """Where a node hangs, and what to hang there instead."""

    def __init__(self, parent: ast.AST, field: str, index: int | None) -> None:
        self.parent, self.field, self.index = parent, field, index
        self.node: ast.AST | None = None

    def of(self, node: ast.AST) -> "Plant":
        self.node = node
        return self

    def __call__(self) -> None:
        if self.index is None:
            setattr(self.parent, self.field, self.node)
        else:
            getattr(self.parent, self.field)[self.index] = self.node


@pytest.mark.parametrize(
    "equation", [e for e in JUDGED if e.id not in MISPRINTS], ids=lambda equation: equation.id
)
def test_every_mistake_planted_in_a_verified_equation_is_caught(equation: Equation) -> None:
    survivors, count = [], 0
    for text in mutants(equation.printed):
        count += 1
        try:
            holds = judged(equation, text, order).holds
        except (ValueError, TypeError):  # no formula any more: a column squared, say
            holds = False
        if holds:
            survivors.append(text)
    assert not survivors
    assert count >= 2


@pytest.mark.parametrize(
    ("key", "text"),
    [
        ("eq47", "x1 = 1.00000000000000000001*l1*sin(theta1)"),
        ("eq47", "x1 = l1*sin(theta1) + 1/10**60"),
        ("eq47", "(x1, x1) = l1*sin(theta1)"),
        ("eq22", "m_2 = h*f(t_i + h/2, w_i + m_1/2, wrong=5)"),
        ("eq8", "theta = theta0*cos(omega*t + psi) + 7*sin(omega*t + psi)"),
        ("eq101", "alpha1 = 0; f1 = phi1_ddot"),
        ("eq8", "theta = t*theta0; stiffness = 0; omega = -psi"),
    ],
)
def test_subtle_mistakes_are_caught(key: str, text: str) -> None:
    equation = next(e for e in JUDGED if e.id == key)
    assert not judged(equation, text, order).holds


@pytest.mark.parametrize(
    ("key", "text"),
    [
        ("eq47", "l1*sin(theta1)"),
        ("eq47", "x1 = l1*sin(theta1) # + l2"),
        ("eq47", "x1 = [5]"),
        ("eq116", "B = [[m1, m2], [7*m1]]"),
        ("eq47", "ddt(theta1_ddot) = 0"),
        ("eq64", "E1 = E1*(1 - 1/l1)"),
        ("eq47", "x1 = x1 + 0/0"),
    ],
)
def test_what_states_nothing_is_refused(key: str, text: str) -> None:
    equation = next(e for e in JUDGED if e.id == key)
    with pytest.raises(ExpressionError):
        judged(equation, text, order)


def test_right_equations_in_another_dress_are_accepted() -> None:
    equation = next(e for e in JUDGED if e.id == "eq47")
    assert judged(equation, "x1 = 2*l1*sin(theta1/2)*cos(theta1/2)", order).holds
    assert judged(equation, "l1*sin(theta1) = x1", order).holds


def test_the_programs_are_read_as_they_are() -> None:
    first, second, third = programs()
    assert first.scene.lengths == (1, 1)
    assert any("never closed" in reason for reason in first.stops)
    assert any("time itself" in reason for reason in first.stops)
    assert first.differs == ("lengths: (1, 1) instead of (2, 2)",)
    assert "right Lagrangian" in second.solves
    assert second.stops == ()
    assert any("sol2" in reason for reason in second.differs)
    assert any("velocities: (pi, 2*pi)" in reason for reason in second.differs)
    assert "the first is right for equal masses only" in third.solves
    assert "the second is right" in third.solves
    assert any("too many" in reason for reason in third.stops)
    assert "it assigns to its functions f1, f2, f3, f4" in third.stops
    assert "it never assigns to j1, j2, j3, j4, which it needs" in third.stops
    assert any("duration: 50 instead of 5" in reason for reason in third.differs)


def test_an_equation_that_is_not_there_is_named_with_its_nearest() -> None:
    assert named("eq33").id == "eq33"
    with pytest.raises(LookupError, match=r"no equation 'eq333' .did you mean 'eq33'"):
        named("eq333")
