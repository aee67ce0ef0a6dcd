"""Elimination for motions with constraints, as straight-line operations.

M x - Gᵀ μ = r and G x = s are solved through G M⁻¹ Gᵀ, of one row a constraint. Where M is
singular, as for a unit quaternion, M + Gᵀ G and r + Gᵀ s take the places of M and r: since
G x = s, x and μ remain the same (M. Benzi, G. H. Golub, J. Liesen, Acta Numerica 14 (2005), 3.5).
"""

from collections.abc import Sequence
from typing import Protocol, Self

from derive.codegen.elimination.factorisation import Rows, factorisation
from derive.codegen.expression_graph.graph import Graph
from derive.codegen.expression_graph.node import Node


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
