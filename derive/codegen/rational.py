"""The rational form: sines and cosines as coordinates, no function left to call.

Sines and cosines of integer sums of angles are polynomials in the sines and
cosines of the angles. Where equations know a coordinate in no other way, the
pair (sin q, cos q) can take its place in the state.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

from derive.codegen.graph import Graph, Node

Pair = tuple[Node, Node]


def angles(nodes: Sequence[Node], coordinates: Collection[str]) -> frozenset[str]:
    """Those of `coordinates` that `nodes` know through sines and cosines of their sums only."""
    found = frozenset(coordinates)
    while True:
        # a sum that holds one coordinate known otherwise spoils those beside it
        spoilt = {name for node in nodes for name in _seen_plainly(node, found, set())}
        if not spoilt & found:
            return found
        found -= spoilt


def rationalised(nodes: Sequence[Node], names: Collection[str]) -> list[Node]:
    """`nodes` in a new graph, with leaves ``sin_q`` and ``cos_q`` for each q of `names`.

    These are the state of the rational form.

    Parameters
    ----------
    nodes : sequence of Node
        What knows the coordinates in `names` through sines and cosines of their sums only.
    names : collection of str
        Names of such coordinates, as `angles` finds them.

    Returns
    -------
    list of Node
        One for each of `nodes`.
    """
    rewriting = _Rewriting(Graph(), names)
    return [rewriting(node) for node in nodes]


def opened(nodes: Sequence[Node], names: Collection[str]) -> list[Node]:
    """`nodes`, or if that calls fewer functions, the same with sums of angles opened.

    A long chain knows all differences of its angles; their sines and cosines follow from
    those of the angles themselves by sums and products, which are quicker.

    Parameters
    ----------
    nodes : sequence of Node
        Of one graph.
    names : collection of str
        Names of the coordinates that are angles.

    Returns
    -------
    list of Node
        One for each of `nodes`; those that are opened are in a new graph.
    """
    rewriting = _Rewriting(Graph(), names, called=True)
    rewritten = [rewriting(node) for node in nodes]
    return rewritten if _calls(rewritten) < _calls(nodes) else list(nodes)


def _calls(nodes: Sequence[Node]) -> int:
    """How many functions are called."""
    visited: set[Node] = set()
    waiting = list(nodes)
    while waiting:
        node = waiting.pop()
        if node not in visited:
            visited.add(node)
            waiting += node.operands()
    return sum(node.kind == "call" for node in visited)


def _seen_plainly(node: Node, names: frozenset[str], visited: set[Node]) -> Iterator[str]:
    if node in visited:
        return
    visited.add(node)
    if node.kind == "leaf":
        yield node.content
    elif _multiples(node, names) is None:
        for operand in node.operands():
            yield from _seen_plainly(operand, names, visited)


def _multiples(node: Node, names: Collection[str]) -> dict[str, int] | None:
    """The integer coefficients of a sine's or cosine's argument, if that is what `node` is."""
    if node.kind != "call" or node.content[0] not in ("sin", "cos"):
        return None
    coefficient, rest = node.content[1].scaled()
    if rest is None:
        return None
    terms = rest.content if rest.kind == "sum" else ((rest, 1),)
    multiples = {term.content: coefficient * number for term, number in terms}
    whole = all(m.denominator == 1 for m in multiples.values())
    if whole and all(term.kind == "leaf" and term.content in names for term, _ in terms):
        return {name: int(multiple) for name, multiple in multiples.items()}
    return None


class _Rewriting:
    def __init__(self, graph: Graph, names: Collection[str], *, called: bool = False) -> None:
        self._graph, self._names, self._called = graph, names, called
        self._nodes: dict[Node, Node] = {}
        self._pairs: dict[tuple[tuple[str, int], ...], Pair] = {}

    def __call__(self, node: Node) -> Node:
        if node not in self._nodes:
            self._nodes[node] = self._rewritten(node)
        return self._nodes[node]

    def _rewritten(self, node: Node) -> Node:
        multiples = _multiples(node, self._names)
        if multiples is not None:
            sine, cosine = self._pair(tuple(multiples.items()))
            return sine if node.content[0] == "sin" else cosine
        match node.kind:
            case "leaf":
                return self._graph.leaf(node.content)
            case "number":
                return self._graph.node(node.content)
            case "let":
                return self._graph.let(self(node.content))
            case "call":
                return self._graph.call(node.content[0], self(node.content[1]))
            case "factors":
                return self._graph.factors([self(entry) for entry in node.content])
            case "component":
                solved, index = node.content
                factors, right = solved.content
                return self._graph.solution(self(factors), [self(part) for part in right])[index]
            case "sum":
                return self._graph.sum([(self(term), number) for term, number in node.content])
            case _:
                return self._graph.product([(self(factor), p) for factor, p in node.content])

    def _pair(self, multiples: tuple[tuple[str, int], ...]) -> Pair:
        """Sine and cosine of a sum of multiples of angles, by the addition theorems."""
        if multiples not in self._pairs:
            (name, multiple), *others = multiples
            step = 1 if multiple > 0 else -1
            sine, cosine = (self._wave(function, name) for function in ("sin", "cos"))
            first = (sine, cosine) if step == 1 else (-sine, cosine)
            rest = tuple([(name, multiple - step)] if multiple != step else []) + tuple(others)
            self._pairs[multiples] = self._added(first, self._pair(rest)) if rest else first
        return self._pairs[multiples]

    def _wave(self, function: str, name: str) -> Node:
        if self._called:
            return self._graph.call(function, self._graph.leaf(name))
        return self._graph.leaf(f"{function}_{name}")

    def _added(self, a: Pair, b: Pair) -> Pair:
        # under names of their own, since both are used more than once in most equations
        return (
            self._graph.let(a[0] * b[1] + a[1] * b[0]),
            self._graph.let(a[1] * b[1] - a[0] * b[0]),
        )
