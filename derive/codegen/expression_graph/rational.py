"""The rational form: sines and cosines as state variables, without function calls.

Sines and cosines of integer combinations of angles are polynomials in the sines
and cosines of the angles. Where equations depend on a coordinate in no other
way, the pair (sin q, cos q) can replace it in the state.
"""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from functools import cache
from types import MappingProxyType

from derive.codegen.expression_graph.graph import Graph
from derive.codegen.expression_graph.node import (
    CallNode,
    ComponentNode,
    ConstantNode,
    FactorisedNode,
    IrrationalNode,
    LeafNode,
    LetNode,
    Node,
    ProductNode,
    RewrittenNode,
    SumNode,
    SwitchNode,
    operands,
)

Pair = tuple[Node, Node]

#: The sum of the multiples of angles that is expanded, such as 3 for sin(a + 2*b).
MAX_MULTIPLE = 20


def angles(nodes: Sequence[Node], coordinates: Collection[str]) -> frozenset[str]:
    """Those of `coordinates` on which `nodes` depend only by sines and cosines of their sums."""
    candidates = frozenset(coordinates)
    while True:
        # a coordinate that occurs otherwise excludes those in the same argument
        excluded = {name for node in nodes for name in _other_leaves(node, candidates, set())}
        if not excluded & candidates:
            return candidates
        candidates -= excluded


def rationalised(nodes: Sequence[Node], angles: Collection[str]) -> list[Node]:
    """`nodes` in a new graph, with leaves ``sin_q`` and ``cos_q`` for each of the `angles`."""
    return list(map(_Rewriting(angles).node, nodes))


def with_fewest_calls(nodes: Sequence[Node], angles: Collection[str]) -> list[Node]:
    """`nodes`, with sines and cosines of sums expanded in a new graph if that needs fewer calls."""
    # a long chain has differences of all its angles, whose sines follow without further calls
    rewritten = list(map(_Rewriting(angles, as_calls=True).node, nodes))
    return rewritten if _calls(rewritten) < _calls(nodes) else list(nodes)


def substitution(graph: Graph, known: Mapping[str, Node]) -> Callable[[Node], Node]:
    """The function that replaces leaves by the `known` nodes of their names."""
    return _Rewriting((), graph=graph, known=known).node


def _calls(nodes: Sequence[Node]) -> int:
    """Number of function calls."""
    visited: set[Node] = set()
    waiting = list(nodes)
    while waiting:
        node = waiting.pop()
        if node not in visited:
            visited.add(node)
            waiting += operands(node)
    return sum(isinstance(node, CallNode) for node in visited)


def _other_leaves(node: Node, names: frozenset[str], visited: set[Node]) -> Iterator[str]:
    """Leaves outside the sines and cosines of integer combinations of `names`."""
    if node in visited:
        return
    visited.add(node)
    if isinstance(node, LeafNode):
        yield node.name
    elif _multiples(node, names) is None:
        for operand in operands(node):
            yield from _other_leaves(operand, names, visited)


def _multiples(node: Node, names: Collection[str]) -> dict[str, int] | None:
    """The coefficients if `node` is the sine or cosine of a small combination of `names`."""
    if not isinstance(node, CallNode) or node.function not in ("sin", "cos"):
        return None
    coefficient, rest = node.arguments[0].scaled()
    multiples: dict[str, int] = {}
    for term, number in rest.terms if isinstance(rest, SumNode) else ((rest, 1),):
        multiple = coefficient * number
        if not isinstance(term, LeafNode) or term.name not in names or multiple.denominator != 1:
            return None
        multiples[term.name] = int(multiple)
    return multiples if sum(map(abs, multiples.values())) <= MAX_MULTIPLE else None


class _Rewriting:
    """Sums of angles expanded: their sines and cosines become leaves, or calls of their own."""

    def __init__(
        self,
        names: Collection[str],
        *,
        as_calls: bool = False,
        graph: Graph | None = None,
        known: Mapping[str, Node] = MappingProxyType({}),
    ) -> None:
        self._graph, self._names, self._as_calls = graph or Graph(), names, as_calls
        self._known = known
        self.node, self._pair = cache(self._rewritten), cache(self._waves)

    def _rewritten(self, node: Node) -> Node:
        graph = self._graph
        match node:
            case LeafNode(name):
                return self._known.get(name) or graph.leaf(name)
            case ConstantNode(value):
                return graph.node(value)
            case IrrationalNode(value):
                return graph.irrational(value)
            case LetNode(value):
                return graph.let(self.node(value))
            case SwitchNode(index, value):
                return graph.switch(index, self.node(value))
            case RewrittenNode(value, short):
                return graph.rewritten(self.node(value), self.node(short))
            case CallNode(function, arguments):
                multiples = _multiples(node, self._names)
                if multiples is None:
                    return graph.call(function, *map(self.node, arguments))
                return self._pair(tuple(multiples.items()))[function == "cos"]
            case SumNode(terms):
                return graph.sum([(self.node(term), number) for term, number in terms])
            case ProductNode(powers):
                return graph.product([(self.node(factor), power) for factor, power in powers])
            case FactorisedNode(upper):
                return graph.factorised([self.node(entry) for entry in upper])
            case ComponentNode(solution, index):
                matrix, *right = (self.node(operand) for operand in operands(solution))
                return graph.solution(matrix, right)[index]
            case _:
                raise NotImplementedError(f"no rational form of a {type(node).__name__} node")

    def _waves(self, multiples: tuple[tuple[str, int], ...]) -> Pair:
        """Sine and cosine of an integer combination of angles, by the addition theorems."""
        if len(multiples) > 2:  # the sum of all but the last is often used, too
            multiples = (multiples[-1], *multiples[:-1])
        (name, multiple), *others = multiples
        sign = 1 if multiple > 0 else -1
        sine, cosine = (self._wave(function, name) for function in ("sin", "cos"))
        a = (sine, cosine) if sign == 1 else (-sine, cosine)
        rest = (*([(name, multiple - sign)] if multiple != sign else []), *others)
        if not rest:
            return a
        b, let = self._pair(rest), self._graph.let  # most equations use both more than once
        return let(a[0] * b[1] + a[1] * b[0]), let(a[1] * b[1] - a[0] * b[0])

    def _wave(self, function: str, name: str) -> Node:
        if self._as_calls:
            return self._graph.call(function, self._graph.leaf(name))
        return self._graph.leaf(f"{function}_{name}")
