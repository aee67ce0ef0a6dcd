"""Pairs of operands that several sums or products hold become operations of their own.

Greedy, as in two-term common-subexpression extraction for linear transforms:
the pair held most often goes first, the one with the lower numbers on a tie, so
that the result depends on the operations alone. A queue with late corrections
keeps the work near linear in the number of pairs.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from heapq import heapify, heappop, heappush
from itertools import combinations

from derive.codegen.operation import Operation

Pair = tuple[str, int, int, Fraction]


def share_pairs(operations: dict[int, Operation]) -> None:
    """Rewrite `operations` in place until no pair of operands is computed twice."""
    holders: dict[Pair, set[int]] = {}
    for number, operation in operations.items():
        for pair in _pairs(operation):
            holders.setdefault(pair, set()).add(number)
    queue = [(-len(numbers), pair) for pair, numbers in holders.items() if len(numbers) > 1]
    heapify(queue)
    known = {operation: number for number, operation in operations.items()}
    while queue:
        count, pair = heappop(queue)
        if -count != len(holders[pair]):
            if len(holders[pair]) > 1:
                heappush(queue, (-len(holders[pair]), pair))
            continue
        wanted = _operation_of(pair, operations)
        if wanted not in known:
            known[wanted] = len(operations)
            operations[len(operations)] = wanted
        number = known[wanted]
        for holder in sorted(holders[pair] - {number}):
            for old in _pairs(operations[holder]):
                holders[old].discard(holder)
            known.pop(operations[holder], None)
            operations[holder] = _without(operations[holder], pair, number)
            known.setdefault(operations[holder], holder)
            for new in _pairs(operations[holder]):
                holders.setdefault(new, set()).add(holder)
                if len(holders[new]) > 1:
                    heappush(queue, (-len(holders[new]), new))
        holders[pair] = {number}


def _pairs(operation: Operation) -> set[Pair]:
    if operation.kind == "product":
        return {
            ("product", a, b, Fraction(1)) for a, b in combinations(sorted(operation.operands), 2)
        }
    if operation.kind == "sum":
        terms = sorted(zip(operation.operands, operation.coefficients, strict=True))
        return {("sum", a, b, cb / ca) for (a, ca), (b, cb) in combinations(terms, 2)}
    return set()


def _operation_of(pair: Pair, operations: dict[int, Operation]) -> Operation:
    kind, a, b, ratio = pair
    coefficients = (Fraction(1), ratio) if kind == "sum" else ()
    constant = operations[a].constant and operations[b].constant
    return Operation(kind, (a, b), coefficients, constant=constant)


def _without(operation: Operation, pair: Pair, number: int) -> Operation:
    """`operation` with the pair's two operands replaced by the one that computes them."""
    kind, a, b, _ = pair
    if kind == "product":
        factors = list(operation.operands)
        factors.remove(a)
        factors.remove(b)
        return replace(operation, operands=tuple(sorted([*factors, number])))
    terms = dict(zip(operation.operands, operation.coefficients, strict=True))
    coefficient = terms.pop(a)
    del terms[b]
    terms[number] = terms.get(number, Fraction(0)) + coefficient
    operands, coefficients = zip(*sorted(terms.items()), strict=True)
    return replace(operation, operands=operands, coefficients=coefficients)
