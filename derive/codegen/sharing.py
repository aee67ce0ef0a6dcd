"""Pairs of operands that several sums or products contain become separate operations.

Greedy, as in two-term common-subexpression extraction for linear transforms:
the most frequent pair comes first, on a tie the one with the lower numbers, so
that the result depends on the operations alone. A queue with deferred
corrections keeps the work nearly linear in the number of pairs.
"""

from dataclasses import replace
from fractions import Fraction
from heapq import heapify, heappop, heappush
from itertools import combinations

from derive.codegen.operation import Operation, Product, Sum

#: Whether it is in a sum, two operands, and in a sum the ratio of their coefficients.
Pair = tuple[bool, int, int, Fraction]
ONE = Fraction(1)


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
        shared = _operation_of(pair, operations)
        if shared not in known:
            known[shared] = len(operations)
            operations[len(operations)] = shared
        number = known[shared]
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
    match operation:
        case Product(operands):
            return {(False, a, b, ONE) for a, b in combinations(sorted(operands), 2)}
        case Sum(operands, _, coefficients):
            terms = sorted(zip(operands, coefficients, strict=True))
            return {(True, a, b, cb / ca) for (a, ca), (b, cb) in combinations(terms, 2)}
        case _:
            return set()


def _operation_of(pair: Pair, operations: dict[int, Operation]) -> Operation:
    in_sum, a, b, ratio = pair
    constant = operations[a].constant and operations[b].constant
    return Sum((a, b), constant, (ONE, ratio)) if in_sum else Product((a, b), constant)


def _without(operation: Operation, pair: Pair, number: int) -> Operation:
    """`operation` with the two operands of `pair` replaced by operation `number`."""
    _, a, b, _ = pair
    if not isinstance(operation, Sum):
        factors = [*operation.operands, number]
        factors.remove(a)
        factors.remove(b)
        return replace(operation, operands=tuple(sorted(factors)))
    terms = dict(zip(operation.operands, operation.coefficients, strict=True))
    coefficient = terms.pop(a)
    del terms[b]
    terms[number] = terms.get(number, Fraction(0)) + coefficient
    operands, coefficients = zip(*sorted(terms.items()), strict=True)
    return replace(operation, operands=operands, coefficients=coefficients)
