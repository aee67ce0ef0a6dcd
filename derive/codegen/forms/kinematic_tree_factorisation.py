"""Elimination along a kinematic tree: a number of operations that grows with that of branches.

M is that of ½ Σ m a·a with a_k = a_p + Σ E_i x_i at the end of branch k: from the ends of the tree
to its root, a branch's inertia is added to that of its parent, and a variable is eliminated when no
other branch depends on it. What is left at a point is its articulated-body inertia, μ - B with the
inertia μ beyond the point (R. Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 7).
"""

from collections.abc import Iterable, Mapping, Sequence

from derive.codegen.expression_graph.graph import Graph
from derive.codegen.expression_graph.node import Node
from derive.mechanics.energies.kinematic_tree import Elimination, KinematicTree

Vector = list[Node]
#: By branch and variable.
Tangents = Mapping[tuple[int, int], Vector]
#: Products of two tangents of one branch: by branch, and both variables.
Products = Mapping[tuple[int, int, int], Node]


class TreeFactorisation:
    """The mass matrix of the variables of a kinematic tree, eliminated.

    Parameters
    ----------
    graph : Graph
    tree : KinematicTree
    inertia : sequence of Node
        Inertia at the end of each branch and beyond.
    tangents, products
        Derivatives of increments, and their products.
    """

    def __init__(
        self,
        graph: Graph,
        tree: KinematicTree,
        inertia: Sequence[Node],
        tangents: Tangents,
        products: Products,
    ) -> None:
        self._graph, self._tree = graph, tree
        self._scale = scale = _common_factors(graph, len(tree.variables), tangents)
        self._tangents = {(k, i): [x / scale[i] for x in E] for (k, i), E in tangents.items()}
        self._inertia = inertia
        self._products = {(k, i, j): x / (scale[i] * scale[j]) for (k, i, j), x in products.items()}
        self._lost = [_zeros(graph, branch.increment) for branch in tree.branches]  # B
        self._couplings: dict[tuple[int, int], Vector] = {}  # of variables with ends of branches
        self._entries: dict[tuple[int, int], Node] = {}
        self._inverses: dict[int, Node] = {}
        for step in tree.steps:
            if isinstance(step, Elimination):
                self._eliminate(step)
            else:
                self._move(step)

    def _move(self, k: int) -> None:
        """Add the inertia of a branch's end to its parent's end and to its variables."""
        branch, let = self._tree.branches[k], self._graph.let
        size = range(len(branch.increment))
        remaining = {i for i, end in self._couplings if end == k} - {*self._inverses}
        coupled = {i: self._couplings[i, k] for i in sorted(remaining)}
        moved: dict[int, Vector] = {}
        for j in branch.variables:
            E = self._tangents[k, j]
            lost = [self._dot([self._lost[k][min(a, b)][max(a, b)] for b in size], E) for a in size]
            for i in (i for i in branch.variables if i <= j):
                product = self._products[k, i, j] * self._inertia[k]
                self._add(i, j, product - self._dot(self._tangents[k, i], lost))
            moved[j] = [let(e * self._inertia[k] - b) for e, b in zip(E, lost, strict=True)]
            for i, c in coupled.items():
                product = self._dot(E, c)
                self._add(min(i, j), max(i, j), product if i != j else product * 2)
        if branch.parent is not None:
            for a in size:
                for b in size[a:]:
                    total = self._lost[branch.parent][a][b] + self._lost[k][a][b]
                    self._lost[branch.parent][a][b] = total
            for vectors in (moved, coupled):
                for i, c in vectors.items():
                    self._couple(i, branch.parent, c)

    def _eliminate(self, step: Elimination) -> None:
        i, k, let = step.variable, step.branch, self._graph.let
        pivot = let(self._entry(i, i))
        inverse = self._inverses[i] = let(self._graph.power(pivot, -1))
        multipliers = {j: let(self._entry(i, j) * inverse) for j in step.others}
        if k is not None:
            c = self._couplings[i, k] = [*map(let, self._couplings.get((i, k), self._zero(k)))]
            lost = self._lost[k]
            for a, x in enumerate(c):
                for b, y in enumerate(c[a:], a):
                    lost[a][b] = let(lost[a][b] + x * inverse * y)
            for j, multiplier in multipliers.items():
                self._couple(j, k, [-(x * multiplier) for x in c])
        for j, multiplier in multipliers.items():
            for other in (one for one in step.others if one >= j):
                self._add(j, other, -(multiplier * self._entry(i, other)))

    def _zero(self, k: int) -> Vector:
        return [self._graph.zero for _ in self._tree.branches[k].increment]

    def _entry(self, i: int, j: int) -> Node:
        return self._entries.get((min(i, j), max(i, j)), self._graph.zero)

    def _add(self, i: int, j: int, value: Node) -> None:
        self._entries[i, j] = self._entry(i, j) + value

    def _couple(self, i: int, k: int, vector: Vector) -> None:
        pairs = zip(self._couplings.get((i, k), self._zero(k)), vector, strict=True)
        self._couplings[i, k] = [a + b for a, b in pairs]

    def _sum(self, terms: Iterable[Node]) -> Node:
        return self._graph.sum([(term, 1) for term in terms])

    def _dot(self, a: Vector, b: Vector) -> Node:
        return self._sum(x * y for x, y in zip(a, b, strict=True))

    def solve(self, right: Sequence[Node]) -> list[Node]:
        """The solution x of M x = `right`, for the variables of the tree."""
        let, branches = self._graph.let, self._tree.branches
        f = [node / scale for node, scale in zip(right, self._scale, strict=True)]
        forces = [self._zero(k) for k in range(len(branches))]  # at the ends of branches
        for step in self._tree.steps:
            match step:
                case Elimination(i, k, others):
                    f[i] = let(f[i] * self._inverses[i])
                    if k is not None:
                        pairs = zip(forces[k], self._couplings[i, k], strict=True)
                        forces[k] = [let(force - c * f[i]) for force, c in pairs]
                    for j in others:
                        f[j] = f[j] - self._entry(i, j) * f[i]
                case int(k):
                    branch = branches[k]
                    for i in branch.variables:
                        f[i] = f[i] + self._dot(self._tangents[k, i], forces[k])
                    if branch.parent is not None:
                        pairs = zip(forces[branch.parent], forces[k], strict=True)
                        forces[branch.parent] = [a + b for a, b in pairs]
        ends = [self._zero(k) for k in range(len(branches))]
        for step in reversed(self._tree.steps):
            match step:
                case Elimination(i, k, others):
                    rest = [self._entry(i, j) * f[j] for j in others]
                    if k is not None:
                        rest.append(self._dot(self._couplings[i, k], ends[k]))
                    f[i] = let(f[i] - self._sum(rest) * self._inverses[i])
                case int(k):
                    branch = branches[k]
                    changes = [[e * f[i] for e in self._tangents[k, i]] for i in branch.variables]
                    if branch.parent is not None:
                        changes.insert(0, ends[branch.parent])
                    ends[k] = [let(self._sum(terms)) for terms in zip(*changes, strict=True)]
        return [let(node / scale) for node, scale in zip(f, self._scale, strict=True)]


def _zeros(graph: Graph, increment: Sequence[object]) -> list[Vector]:
    return [[graph.zero for _ in increment] for _ in increment]


def _common_factors(graph: Graph, n: int, tangents: Tangents) -> list[Node]:
    """The factor that all tangents of each variable have."""
    entries = ([x for (_, j), E in tangents.items() if j == i for x in E] for i in range(n))
    return [*map(graph.common_factor, entries)]
