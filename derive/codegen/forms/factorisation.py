"""Symmetric elimination, also with constraints, as straight-line operations.

M = c S U D Uᵀ S with U unit upper triangular, D diagonal, S the diagonal matrix
of common factors of rows and columns (mostly lengths), and c the common factor
of all entries (a number, and the mass if there is one). It runs from the last
coordinate to the first, since in a chain the last mass moves with the fewest
others: its entries are the shortest.

M x - Gᵀ μ = r and G x = s are solved through G M⁻¹ Gᵀ, of one row a constraint. Where M is
singular, as for a unit quaternion, M + Gᵀ G and r + Gᵀ s take the places of M and r: since
G x = s, x and μ remain the same (M. Benzi, G. H. Golub, J. Liesen, Acta Numerica 14 (2005), 3.5).
"""

from collections.abc import Sequence
from fractions import Fraction
from functools import reduce
from math import gcd, lcm
from typing import Protocol, Self

from derive.codegen.expression_graph.graph import Graph
from derive.codegen.expression_graph.node import LeafNode, LetNode, Node

Rows = Sequence[Sequence[Node]]

#: From this size on a loop is as fast as straight-line code, which grows with the cube, unless
#: most entries are 0.
LARGE = 16
MOST_UPDATES = sum(k**2 for k in range(LARGE))

#: Multipliers with more factors than this are named.
SHORT = 3


def factorisation(graph: Graph, matrix: Rows) -> "Loops | Factorisation":
    """The factorisation of a symmetric positive definite matrix; its updates decide which."""
    return (Loops if _updates(matrix) >= MOST_UPDATES else Factorisation)(graph, matrix)


def _updates(matrix: Rows) -> int:
    """Entries that the elimination changes: few, if most entries are 0 and remain so."""
    coupled = [{i for i in range(k) if not row[i].is_number(0)} for k, row in enumerate(matrix)]
    for others in reversed(coupled):
        for i in others:
            coupled[i] |= {j for j in others if j < i}
    return sum(len(others) ** 2 for others in coupled)


class Loops:
    """L D Lᵀ by loops, in functions of the generated module."""

    def __init__(self, graph: Graph, matrix: Rows) -> None:
        self._graph = graph
        self._factors = graph.factorised(entry for i, row in enumerate(matrix) for entry in row[i:])

    def solve(self, right: Sequence[Node]) -> list[Node]:
        """The solution x of M x = `right`."""
        return self._graph.solution(self._factors, right)


class Factorisation:
    """U D Uᵀ of a symmetric positive definite matrix of nodes."""

    def __init__(self, graph: Graph, matrix: Rows) -> None:
        n, zero = len(matrix), graph.zero
        self._graph, self._content = graph, _content(matrix)
        self._scale = scale = _common_scale(graph, matrix)
        rows = [[matrix[i][j] / (scale[i] * scale[j]) for j in range(n)] for i in range(n)]
        self._common = common = graph.common_factor(entry for row in rows for entry in row)
        self._rows = rows = [[entry / (common * self._content) for entry in row] for row in rows]
        self.pivots, self._inverses = [zero] * n, [zero] * n  # all pivots are positive
        self._multipliers: dict[tuple[int, int], Node] = {}
        for k in reversed(range(n)):
            # products of parameters are not named, so that they are cancelled
            is_short = all(isinstance(factor, LeafNode) for factor in rows[k][k].exponents())
            self.pivots[k] = rows[k][k] if is_short else graph.let(rows[k][k])
            coupled = [i for i in range(k) if not rows[i][k].is_number(0)]
            self._inverses[k] = self._inverse(self.pivots[k], bool(coupled))
            for i in coupled:
                multiplier = rows[i][k] * self._inverses[k]
                short = len(multiplier.factors()) <= SHORT
                self._multipliers[i, k] = multiplier if short else graph.let(multiplier)
            for i in coupled:
                for j in (j for j in coupled if j >= i):
                    rows[i][j] = rows[i][j] - self._multipliers[i, k] * rows[j][k]
                    rows[j][i] = rows[i][j]

    def _inverse(self, pivot: Node, is_shared: bool) -> Node:
        inverse = self._graph.power(pivot, -1)
        # one division instead of several, if no factors cancel
        return self._graph.let(inverse) if is_shared and isinstance(pivot, LetNode) else inverse

    def solve(self, right: Sequence[Node]) -> list[Node]:
        """The solution x of M x = `right`."""
        n = len(right)
        scales = [scale * self._common for scale in self._scale]
        scaled = (node / scale for node, scale in zip(right, scales, strict=True))
        y = [self._graph.spread(node, 1 / self._content) for node in scaled]
        for k in reversed(range(n)):
            y[k] = y[k] * self._inverses[k]
            for i in range(k):
                if (i, k) in self._multipliers:
                    y[i] = y[i] - self._rows[i][k] * y[k]
        x: list[Node] = []
        for k in range(n):
            coupled = [i for i in range(k) if (i, k) in self._multipliers]
            known = [(x[i] * self._multipliers[i, k], -1) for i in coupled]
            x.append(self._graph.let(self._graph.sum([(y[k], 1), *known])))
        return [node / scale for node, scale in zip(x, self._scale, strict=True)]


def _content(matrix: Rows) -> Fraction:
    """The largest number of which all entries are integer multiples."""
    numbers = [abs(entry.scaled()[0]) for row in matrix for entry in row]
    return Fraction(
        reduce(gcd, (number.numerator for number in numbers)),
        reduce(lcm, (number.denominator for number in numbers)),
    )


def _common_scale(graph: Graph, matrix: Rows) -> list[Node]:
    """Factors s of each row such that s_i s_j divides every entry (i, j)."""
    scales = [
        {f: p // 2 for f, p in row[i].exponents().items() if p > 1} for i, row in enumerate(matrix)
    ]
    for i, row in enumerate(matrix):
        for j, entry in enumerate(row):
            if not entry.is_number(0):
                scales[i] = {
                    f: p
                    for f, p in scales[i].items()
                    if entry.exponents().get(f, 0) >= p + scales[j].get(f, 0)
                }
    return [graph.product(scale.items()) for scale in scales]


class Solver(Protocol):
    """A factorised matrix M."""

    def solve(self, right: Sequence[Node]) -> list[Node]:
        """The solution x of M x = `right`."""


class ConstrainedFactorisation:
    """The factorisation of M, and that of G M⁻¹ Gᵀ."""

    def __init__(
        self, graph: Graph, inertia: Solver, constraints: Rows, *, singular: bool = False
    ) -> None:
        self._graph, self._constraints, self._singular = graph, constraints, singular
        self._inertia, m = inertia, range(len(constraints))
        self._columns = [self._inertia.solve(row) for row in constraints]
        upper = {
            (i, j): graph.let(self._product(constraints[i], self._columns[j]))
            for i in m
            for j in m[i:]
        }
        if m:
            rows = [[upper[min(i, j), max(i, j)] for j in m] for i in m]
            self._compliance = factorisation(graph, rows)

    @classmethod
    def of_matrix(cls, graph: Graph, matrix: Rows, constraints: Rows, *, singular: bool) -> Self:
        """The factorisation of M given by its entries."""
        if singular:
            n = range(len(matrix))
            matrix = [[_shifted(graph, matrix, constraints, i, j) for j in n] for i in n]
        return cls(graph, factorisation(graph, matrix), constraints, singular=singular)

    def _product(self, row: Sequence[Node], column: Sequence[Node]) -> Node:
        return self._graph.sum([(a * x, 1) for a, x in zip(row, column, strict=True)])

    def solve(self, forces: Sequence[Node], rates: Sequence[Node]) -> tuple[list[Node], list[Node]]:
        """The solution x and the multipliers μ for the right sides r and s."""
        rows, n = self._constraints, range(len(forces))
        if not rows:
            return self._inertia.solve(forces), []
        if self._singular:
            forces = [
                self._graph.sum(
                    [(r, 1), *((row[i] * s, 1) for row, s in zip(rows, rates, strict=True))]
                )
                for i, r in enumerate(forces)
            ]
        free = self._inertia.solve(forces)
        missing = [s - self._product(row, free) for s, row in zip(rates, rows, strict=True)]
        multipliers = self._compliance.solve(missing)
        pairs = [*zip(self._columns, multipliers, strict=True)]
        x = [self._graph.sum([(free[i], 1), *((c[i] * mu, 1) for c, mu in pairs)]) for i in n]
        return [self._graph.let(entry) for entry in x], multipliers


def _shifted(graph: Graph, matrix: Rows, constraints: Rows, i: int, j: int) -> Node:
    squares = ((row[i] * row[j], 1) for row in constraints)
    return graph.sum([(matrix[i][j], 1), *squares])
