"""All equations of the report are judged, with correct verdicts, and mutations are rejected."""

import ast
import json
import math
import re
from collections import Counter
from collections.abc import Iterator
from difflib import SequenceMatcher
from itertools import pairwise

import pytest

from derive.formulas.syntax import ExpressionError
from derive.verification.judging.engine import RELATION
from derive.verification.report.equation import ReportEquation
from derive.verification.report.programs import programs
from derive.verification.report.report_equations import translations
from derive.verification.report.report_judgement import EQUATIONS, check, equation_by_id, verdict
from derive.verification.report.report_latex import STORED, read, translation
from solvers.runge_kutta.order_conditions import order

JUDGED = [equation for equation in EQUATIONS.values() if not equation.exempt]

#: Identified by reading the report beside a textbook, before any computation.
MISPRINTS = {
    *"eq9 eq13 eq27 eq28 eq29 eq32 eq64 eq65 eq69 eq71 eq78 eq79 eq81 A10 eq97 eq98".split(),
    *"eq105 eq106 A15 A16 eq114 eq117 eq119".split(),
}


def test_every_numbered_equation_and_every_display_of_appendix_a_is_judged_once() -> None:
    ids = [*EQUATIONS]
    assert [i for i in ids if i.startswith("eq")] == [f"eq{n}" for n in range(1, 129)]
    assert sorted(i for i in ids if i.startswith("A")) == sorted(f"A{n}" for n in range(1, 23))


@pytest.mark.parametrize("name", EQUATIONS)
def test_verdicts_agree_with_a_careful_reader(name: str) -> None:
    equation = EQUATIONS[name]
    result = verdict(equation, order)
    if equation.exempt:
        assert result.verdict == equation.exempt
        assert result.note
    elif name in MISPRINTS:
        assert result.verdict == "misprint"
        assert result.correction
        assert result.residual not in ("", "0")
        assert abs(float(result.witness)) > 1e-6
        # Python's value of the residual at the printed state
        numbers = dict(one.split(" = ") for one in result.state.split(", ") if one)
        values = {name: eval(number) for name, number in numbers.items()}
        functions = {"sin": math.sin, "cos": math.cos, "Abs": abs}
        value = eval(result.residual, functions | values)
        assert math.isclose(value, float(result.witness), rel_tol=1e-4)
    else:
        assert result.verdict == "verified"
        assert not equation.corrected


def test_only_definitions_and_other_subjects_are_exempt() -> None:
    counts = Counter(equation.exempt for equation in EQUATIONS.values() if equation.exempt)
    assert counts == {"definition": 6, "context": 2}


def mutants(text: str) -> Iterator[str]:
    """`text` with one mutation: a sign, an index, a power, a function or a number."""
    for part_number, part in enumerate(parts := text.split(";")):
        pieces = RELATION.split(part)
        for index in range(0, len(pieces), 2):
            bound = len(pieces) > 1 and re.fullmatch(r"\s*\d+\s*", pieces[index])
            if bound and pieces[index - 1] != "=":
                continue  # a looser bound is not wrong
            if index == 0:
                negative = f"-({pieces[0].strip()}) {''.join(pieces[1:])}"
                yield ";".join([*parts[:part_number], negative, *parts[part_number + 1 :]])
            count = sum(1 for _ in sites(ast.parse(pieces[index].strip(), mode="eval")))
            for k in range(count):
                tree = ast.parse(pieces[index].strip(), mode="eval")
                list(sites(tree))[k]()
                changed = [*pieces[:index], f" {ast.unparse(tree)} ", *pieces[index + 1 :]]
                yield ";".join([*parts[:part_number], "".join(changed), *parts[part_number + 1 :]])


def sites(tree: ast.AST) -> Iterator["Site"]:
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
                site = Site(parent, field, index if isinstance(value, list) else None)
                match node:
                    case ast.BinOp(op=ast.Add()):
                        yield site.with_node(ast.BinOp(node.left, ast.Sub(), node.right))
                    case ast.BinOp(op=ast.Sub()):
                        yield site.with_node(ast.BinOp(node.left, ast.Add(), node.right))
                    case ast.BinOp(op=ast.Pow()):
                        yield site.with_node(node.left)
                    case ast.UnaryOp():
                        yield site.with_node(node.operand)
                    case ast.Name(id="sin" | "cos" as name) if id(node) in functions:
                        yield site.with_node(ast.Name("cos" if name == "sin" else "sin"))
                    case ast.Name(id=name) if id(node) not in functions:
                        other = re.sub(r"[12](?=_|$)", lambda m: str(3 - int(m.group())), name)
                        if other != name:
                            yield site.with_node(ast.Name(other))
                        if id(node) not in symbols_only and not name.endswith(("_i", "_vector")):
                            yield site.with_node(ast.BinOp(node, ast.Pow(), ast.Constant(2)))
                    case ast.Constant(value=int() as number):
                        yield site.with_node(ast.Constant(number + 1))


class Site:
    """A child of a syntax tree, and its replacement."""

    def __init__(self, parent: ast.AST, field: str, index: int | None) -> None:
        self.parent, self.field, self.index = parent, field, index
        self.node: ast.AST | None = None

    def with_node(self, node: ast.AST) -> "Site":
        self.node = node
        return self

    def __call__(self) -> None:
        if self.index is None:
            setattr(self.parent, self.field, self.node)
        else:
            getattr(self.parent, self.field)[self.index] = self.node


@pytest.mark.long("more cases of the same kind", keep=4, daily=60)
@pytest.mark.parametrize(
    "equation", [e for e in JUDGED if e.id not in MISPRINTS], ids=lambda equation: equation.id
)
def test_every_mutation_of_a_verified_equation_is_rejected(equation: ReportEquation) -> None:
    survivors, count = [], 0
    for text in mutants(equation.printed):
        count += 1
        try:
            holds = check(equation, text, order).holds
        except (ValueError, TypeError):  # not a formula, such as the square of a column
            holds = False
        if holds:
            survivors.append(text)
    assert survivors == []
    assert count >= 2


def squeezed(text: str) -> str:
    return text.replace(" ", "")


def changes_of_text(equation: ReportEquation) -> list[tuple[str, str]]:
    """The parts of the printed equation that its changes replace, each printed once."""
    texts = equation.printed, equation.corrected
    printed, correct = (re.findall(r"\w+|\*\*|\S", text) for text in texts)
    changes, before = [], 0
    codes = [*SequenceMatcher(None, printed, correct, False).get_opcodes(), ("", 0, 0, 0, 0)]
    for (tag, a, b, c, d), (_, _, following, _, _) in pairwise(codes):
        if tag != "equal":
            # with at least two words and signs on both sides, as far as they do not change
            after = max(following - b, 0)
            parts = [
                ("".join(printed[a - left : b + right]), "".join(correct[c - left : d + right]))
                for left, right in ((min(k, before), min(k, after)) for k in range(2, 9))
            ]
            changes += [one for one in parts if squeezed(texts[0]).count(one[0]) == 1][:1]
        before = b - a if tag == "equal" else 0
    return changes


def changed(text: str, changes: list[tuple[str, str]]) -> str:
    """A text with changes; blanks, which mutants lack, do not matter."""
    text = squeezed(text)
    for wrong, right in changes:
        if text.count(wrong) != 1:
            raise ValueError(f"{wrong!r} is not printed once")
        text = text.replace(wrong, right)
    return text


@pytest.mark.long("more cases of the same kind", keep=4)
@pytest.mark.parametrize("name", sorted(MISPRINTS))
def test_a_misprint_differs_from_its_correction_by_the_stated_changes_alone(name: str) -> None:
    equation = EQUATIONS[name]
    changes = changes_of_text(equation)
    assert changed(equation.printed, changes) == squeezed(equation.corrected)
    survivors, count = [], 0
    for text in mutants(equation.printed):
        count += 1
        try:
            correct = changed(text, changes)
            holds = check(equation, text, order).holds or check(equation, correct, order).holds
        except (ValueError, TypeError):  # not a formula, or a part to change is missing
            continue
        if holds:
            survivors.append(text)
    assert survivors == []
    assert count >= 2


def test_a_part_to_change_must_be_printed_once() -> None:
    for printed, count in (("x_1 = l_1", 0), ("x_1 = l_2 + l_2", 2)):
        with pytest.raises(ValueError, match=f"eq47: .* 'l_2' is printed {count} times, not once"):
            ReportEquation("eq47", printed, changes=(("l_2", "l_1"),))


@pytest.mark.parametrize(
    ("key", "text"),
    [
        ("eq47", "x1 = 1.00000000000000000001*l1*sin(theta1)"),
        ("eq47", "x1 = l1*sin(theta1) + 1/10**60"),
        ("eq47", "(x1, x1) = l1*sin(theta1)"),
        ("eq22", "m2 = h*f(t_i + h/2, w_i + m1/2, wrong=5)"),
        ("eq8", "theta = theta0*cos(omega*t + psi) + 7*sin(omega*t + psi)"),
        ("eq101", "alpha1 = 0; f1 = phi1_ddot"),
        ("eq8", "theta = t*theta0; stiffness = 0; omega = -psi"),
    ],
)
def test_subtle_errors_are_rejected(key: str, text: str) -> None:
    equation = EQUATIONS[key]
    assert not check(equation, text, order).holds


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
def test_invalid_statements_are_rejected(key: str, text: str) -> None:
    equation = EQUATIONS[key]
    with pytest.raises(ExpressionError):
        check(equation, text, order)


def test_equivalent_forms_are_accepted() -> None:
    equation = EQUATIONS["eq47"]
    assert check(equation, "x1 = 2*l1*sin(theta1/2)*cos(theta1/2)", order).holds
    assert check(equation, "l1*sin(theta1) = x1", order).holds


def test_programs_have_the_known_errors() -> None:
    first, second, third = programs()
    assert first.scene.lengths == (1, 1)
    assert any("never closed" in reason for reason in first.stops)
    assert any("time itself" in reason for reason in first.stops)
    assert first.differs == ("lengths: (1, 1) instead of (2, 2)",)
    assert "the correct Lagrangian" in second.solves
    assert second.stops == ()
    assert any("sol2" in reason for reason in second.differs)
    assert any("velocities: (pi, 2*pi)" in reason for reason in second.differs)
    assert "the first is correct for equal masses only" in third.solves
    assert "the second is correct" in third.solves
    assert any("unmatched" in reason for reason in third.stops)
    assert "it assigns to its functions f1, f2, f3, f4" in third.stops
    assert "it never assigns to j1, j2, j3, j4, which it needs" in third.stops
    assert any("duration: 50 instead of 5" in reason for reason in third.differs)


def test_an_unknown_id_is_reported_with_a_suggestion() -> None:
    assert equation_by_id("eq33").id == "eq33"
    with pytest.raises(LookupError, match=r"no equation 'eq333' .did you mean 'eq33'"):
        equation_by_id("eq333")


def test_stored_translations_are_those_of_the_latex() -> None:
    command = "python -m derive.verification.report.report_equations"
    assert json.loads(STORED.read_text(encoding="utf-8")) == translations(), f"run: {command}"
    assert all(translation(one.latex) == read(one.latex) for one in EQUATIONS.values())
