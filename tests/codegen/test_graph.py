"""Expressions as graphs: equal values, shared parts, fewest operations."""

import math
import random
from functools import cache

import pytest
import sympy as sp

from derive.codegen.expression_graph.graph import Graph
from derive.codegen.expression_graph.node import Node
from derive.codegen.expression_graph.sympy_translation import Translation, UnsupportedFunctionError
from derive.codegen.forms.factorisation import LARGE, Factorisation, factorisation
from derive.codegen.operations import operation as op
from derive.codegen.operations.assignments import Assignments, LanguageNotation
from derive.codegen.operations.lowering import Lowering

pi = sp.pi
a, b, c, d, x = sp.symbols("a b c d x", positive=True)
FUNCTIONS = {"sin": math.sin, "cos": math.cos, "sqrt": math.sqrt, "exp": math.exp}


def evaluated(lowering: Lowering, values: dict[str, float]) -> list[float]:
    """The outputs by plain recursion: no names, texts or order of the generator."""

    @cache
    def value(number: int) -> float:
        operation = lowering.operations[number]
        inner = [value(n) for n in operation.operands]
        match operation:
            case op.LeafOperation(name=name):
                return values[name]
            case op.ConstantOperation(value=constant):
                return float(constant)
            case op.SumOperation(coefficients=coefficients):
                return math.fsum(float(k) * v for k, v in zip(coefficients, inner, strict=True))
            case op.ProductOperation():
                return math.prod(inner)
            case op.QuotientOperation():
                return inner[0] / inner[1] if len(inner) == 2 else 1 / inner[0]
            case op.CallOperation(function=function):
                return FUNCTIONS[function](*inner)
        raise NotImplementedError(operation)

    return [value(n) for n in lowering.outputs]


def lowered(*expressions: sp.Expr, parameters: tuple[str, ...] = ()) -> Lowering:
    node = Translation(Graph())
    return Lowering([node(e) for e in expressions], parameters)


def random_expression(generator: random.Random, depth: int) -> sp.Expr:
    if depth == 0:
        return generator.choice([a, b, c, d, sp.Integer(generator.randint(-3, 3)), sp.S.Half])
    left, right = (random_expression(generator, depth - 1) for _ in range(2))
    return generator.choice(
        [
            left + right,
            left - right,
            left * right,
            left**2,
            sp.sin(left),
            sp.cos(left - right),
            left / (3 + sp.sin(right)),
            sp.sqrt(4 + sp.cos(left)),
            -left,
            left**3 * right,
            left - left * sp.cos(right) ** 2,
        ]
    )


@pytest.mark.long("more cases of the same kind", keep=8, daily=30)
@pytest.mark.parametrize("seed", range(60))
def test_lowered_expressions_have_the_value_of_the_original(seed: int) -> None:
    generator = random.Random(seed)
    expressions = [random_expression(generator, 4) for _ in range(4)]
    values = {s.name: generator.uniform(0.3, 2) for s in (a, b, c, d)}
    results = evaluated(lowered(*expressions, parameters=("a", "b")), values)
    for result, expression in zip(results, expressions, strict=True):
        exact = float(
            expression.evalf(30, subs={sp.Symbol(k, positive=True): v for k, v in values.items()})
        )
        assert result == pytest.approx(exact, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    ("expressions", "operations"),
    [
        ([a + b, 2 * (a + b)], 2),
        ([a * b * c, a * b * d], 3),
        ([a**2 * b**2, a * b * c], 3),
        ([a - b + c, b - a + d], 3),
        ([sp.sin(a - b), sp.sin(b - a)], 3),
        ([a**2 * b / (a * b**2)], 1),
        ([a * b + a * c], 2),
        ([a - a * sp.cos(x) ** 2], 3),
        ([b + a - a * sp.sin(x) ** 2], 4),
        ([a * sp.sin(x) ** 2 + b + a * sp.cos(x) ** 2], 1),
        ([sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1], 0),
        ([a / 2 + b / 2], 2),
        ([a / 2 + b], 2),
        ([-a - b], 2),
    ],
)
def test_common_parts_are_computed_once(expressions: list[sp.Expr], operations: int) -> None:
    assert lowered(*expressions).cost[0] == operations


def test_differences_that_would_cancel_become_squares() -> None:
    # a(1 - cos² x) at x = 1e-9 is 0 in double precision; a sin² x is right to the last digit
    value = evaluated(lowered(a - a * sp.cos(x) ** 2), {"a": 1.0, "x": 1e-9})[0]
    assert value == pytest.approx(1e-18, rel=1e-12)
    assert 1 - math.cos(1e-9) ** 2 == 0


def test_terms_of_parameters_alone_are_grouped() -> None:
    lowering = lowered(a * b * x / c + d * x, parameters=("a", "b", "c"))
    constant = [o for o in lowering.operations.values() if o.constant and op.cost(o)]
    assert sum(op.cost(o) for o in constant) == 3
    assert evaluated(lowering, {"a": 2, "b": 3, "c": 4, "d": 5, "x": 7})[0] == 45.5


def test_unknown_functions_are_refused_and_known_ones_listed() -> None:
    with pytest.raises(
        UnsupportedFunctionError, match=r"no generated code for 'gamma\(a\)'.*sin, cos"
    ):
        lowered(sp.gamma(a))
    with pytest.raises(UnsupportedFunctionError, match="no generated code"):
        lowered(sp.zeta(a))


def test_the_square_of_a_root_is_its_argument() -> None:
    graph = Graph()
    pair, r = graph.leaf("p") + graph.leaf("q"), graph.leaf("r")
    root = graph.call("sqrt", pair)
    assert root * root is pair
    assert root * (r * root * 3) is r * pair * 3
    assert graph.power(root, 3).exponents() == {root: 3}  # one product more otherwise


def test_a_mass_that_all_entries_have_in_common_cancels() -> None:
    graph = Graph()
    m, *entries, r = map(graph.leaf, "mabcr")
    a, b, c = (m * entry for entry in entries)
    lowering = Lowering(Factorisation(graph, [[a, b], [b, c]]).solve([m * r, m * r * 2]), ())
    assert "m" not in lowering.inputs
    values = {"a": 3.0, "b": 1.0, "c": 2.0, "r": 5.0}
    assert evaluated(lowering, values) == pytest.approx([0.0, 5.0], abs=1e-15)


@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_the_factorisation_solves_symmetric_systems(n: int) -> None:
    generator = random.Random(n)
    graph = Graph()
    root = [[generator.uniform(-1, 1) for _ in range(n)] for _ in range(n)]
    numbers = [
        [sum(u * v for u, v in zip(root[i], root[j], strict=True)) + (i == j) for j in range(n)]
        for i in range(n)
    ]
    values = {f"m{min(i, j)}{max(i, j)}": numbers[i][j] for i in range(n) for j in range(n)}
    values |= {f"r{i}": generator.uniform(-1, 1) for i in range(n)}
    matrix = [[graph.leaf(f"m{min(i, j)}{max(i, j)}") for j in range(n)] for i in range(n)]
    factors = Factorisation(graph, matrix)
    x = evaluated(Lowering(factors.solve([graph.leaf(f"r{i}") for i in range(n)]), ()), values)
    for i in range(n):
        assert sum(m * v for m, v in zip(numbers[i], x, strict=True)) == pytest.approx(
            values[f"r{i}"]
        )
    assert all(pivot > 0 for pivot in evaluated(Lowering(factors.pivots, ()), values))


def test_the_factorisation_of_a_ring_takes_operations_in_proportion_to_its_size() -> None:
    def solved(n: int) -> tuple[Lowering, dict[str, float]]:
        graph, beside = Graph(), {1, n - 1}
        names = [[f"m{min(i, j)}_{max(i, j)}" for j in range(n)] for i in range(n)]
        matrix = [
            [graph.leaf(names[i][j]) if abs(i - j) in {0, *beside} else graph.zero
             for j in range(n)] for i in range(n)
        ]  # fmt: skip
        values = {name: 4.0 - 3 * (i != j) for i, row in enumerate(names)
                  for j, name in enumerate(row)}  # fmt: skip
        right = [graph.leaf(f"r{i}") for i in range(n)]
        values |= {f"r{i}": float(i) for i in range(n)}
        return Lowering(factorisation(graph, matrix).solve(right), ()), values

    (small, _), (large, values) = solved(LARGE), solved(2 * LARGE)
    assert large.cost[0] < 2.2 * small.cost[0]
    x = evaluated(large, values)
    for i, value in enumerate(x):  # oracle: each row of the matrix
        assert x[i - 1] + 4 * value + x[(i + 1) % len(x)] == pytest.approx(i, abs=1e-12)


def test_common_lengths_of_rows_and_columns_are_factored_out() -> None:
    graph = Graph()
    l1, l2, m, cosine = (graph.leaf(name) for name in ("l1", "l2", "m", "cosine"))
    right = [graph.leaf("f1"), graph.leaf("f2")]
    matrix = [[m * l1 * l1, m * l1 * l2 * cosine], [m * l1 * l2 * cosine, m * l2 * l2]]
    pivots = Factorisation(graph, matrix).pivots
    assert leaves(pivots) == {"cosine"}
    assert len(Factorisation(graph, matrix).solve(right)) == 2


def leaves(nodes: list[Node]) -> set[str]:
    return {*Lowering(nodes, ()).inputs}


def test_equal_named_terms_and_factors_are_merged() -> None:
    graph = Graph()
    p, q = graph.leaf("p"), graph.leaf("q")
    named = graph.let(p + q)
    outputs = [
        graph.sum([(p + q, -1), (named, 2)]),  # p + q
        graph.sum([(p + q, 1), (named, -1)]),  # 0
        graph.sum([(p, 1), (named, 1), (p + q, -1)]),  # p
        named * q / (p + q),  # q
        named / (p + q),  # 1
    ]
    results = evaluated(Lowering(outputs, ()), {"p": 2.0, "q": 3.0})
    assert results == [5.0, 0.0, 2.0, 3.0, 1.0]


def test_a_sum_that_cancels_with_a_shared_pair_is_the_number_0() -> None:
    graph = Graph()
    p, q, r = map(graph.leaf, "pqr")
    named = graph.let(p + q)
    cancelling = graph.sum([(p, 1), (q, 1), (named, -1)])
    more = graph.sum([(p, 1), (q, 1), (r, 1), (named, -1)])
    lowering = Lowering([named * r, cancelling, more], ())
    assert evaluated(lowering, {"p": 2.0, "q": 3.0, "r": 7.0}) == [35.0, 0.0, 7.0]
    texts = Assignments(lowering, (), LanguageNotation()).outputs
    assert texts == ["r*(p + q)", "0.0", "r"]


def test_products_and_quotients_of_a_sum_that_cancels_are_numbers() -> None:
    graph = Graph()
    p, q, r = map(graph.leaf, "pqr")
    named = graph.let(p + q)
    cancelling = graph.sum([(p + q, 1), (named, -1)])
    quotient = graph.call("sin", named) / graph.call("sin", p + q)
    lowering = Lowering([cancelling * r, quotient], ())
    assert Assignments(lowering, (), LanguageNotation()).outputs == ["0.0", "1.0"]


def test_a_power_with_a_whole_exponent_is_a_product() -> None:
    graph = Graph()
    base = graph.leaf("p") + graph.leaf("q")
    assert graph.call("pow", base, graph.one + graph.one + graph.one) is base * base * base
    third = graph.call("pow", base, graph.one / (graph.one + graph.one + graph.one))
    assert Lowering([third], ()).functions == {"pow"}


def test_opposite_terms_cancel_within_shared_sums() -> None:
    graph = Graph()
    p, q, r = map(graph.leaf, "pqr")
    pair = p + q
    lowering = Lowering([r * pair, pair - p, p * r - r * pair], ())
    assert evaluated(lowering, {"p": 2.0, "q": 3.0, "r": 7.0}) == [35.0, 3.0, -21.0]
    texts = Assignments(lowering, (), LanguageNotation()).outputs
    assert texts == ["r*(p + q)", "q", "-r*q"]


@pytest.mark.parametrize("expression", [
    (a + b) * a + (a + b) * b,
    (a - b) * a * c - (a - b) * b * c,
    (a * x + b * c) ** 2 / 2 + (a * x + b * c) * a * x,
    (a + b) ** 2 * a + (a + b) ** 2 * b,
])  # fmt: skip
def test_a_sum_that_is_its_own_common_factor_keeps_all_its_powers(expression: sp.Expr) -> None:
    values = {"a": 1.3, "b": -0.7, "c": 2.1, "d": 0.4, "x": 1.9}
    (result,) = evaluated(lowered(expression), values)
    exact = expression.subs({sp.Symbol(k, positive=True): v for k, v in values.items()})
    assert result == pytest.approx(float(exact), rel=1e-13)


@pytest.mark.parametrize("number", [
    pi, pi / 3, 2 * pi, -pi / 7, pi**2, 1 / pi, sp.sqrt(2), 3 * sp.sqrt(5) / 7, sp.exp(1),
    sp.sqrt(pi), 1 + pi / 2, sp.cos(2), sp.log(2) - sp.Rational(1, 3),
])  # fmt: skip
def test_numbers_are_one_literal_right_to_the_last_bit(number: sp.Expr) -> None:
    lowering = lowered(number, number * a)
    exact = float(number.evalf(40))
    assert evaluated(lowering, {"a": 1.0}) == [exact, exact]
    assert lowered(abs(number), abs(number) * a).cost == (1, 0)


def test_irrational_factors_cancel() -> None:
    assert lowered(pi * a / (pi * b)).cost[0] == 1
    assert lowered(pi * a - pi * a + b).cost[0] == 0
    assert evaluated(lowered(pi * a + pi * b), {"a": 1.5, "b": 2.5}) == [4 * math.pi]


@pytest.mark.parametrize("rows", range(1, 6))
def test_the_cost_of_a_factorisation_is_that_of_its_loops(rows: int) -> None:
    # L D Lᵀ without square roots: G. H. Golub, C. F. Van Loan, Matrix Computations, § 4.1
    operations = 0
    for pivot in range(rows):
        operations += 1  # its reciprocal
        for i in range(pivot + 1, rows):
            operations += 1  # the multiple of the row of the pivot
            operations += 2 * len(range(i, rows))  # a product and a difference for each entry
    entries = tuple(range(rows * (rows + 1) // 2))
    assert op.cost(op.FactorisedOperation(entries, constant=False)) == operations
